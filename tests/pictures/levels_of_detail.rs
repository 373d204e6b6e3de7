//! Laws: levels of detail show what the reference sees, path by path; they make far textures less noisy, and
//! change nothing near by.

use crate::common::*;

/// Black and white fields.
fn board(filter: Filter) -> Texture {
    let field = |index: u32| if (index % 32 / 4 + index / 32 / 4).is_multiple_of(2) { 255 } else { 0 };
    let texels = (0..32 * 32).map(|index| [field(index), field(index), field(index), 0]).collect();
    texture([32, 32], filter, Texels::Srgb8(texels))
}

/// A plane of fields of one unit up to the horizon, seen from `height`, that emits what its texture shows.
fn plain(filter: Filter, height: f32) -> Scene {
    let corners = [vec3(-1e3, 0.0, 1e3), vec3(1e3, 0.0, 1e3), vec3(0.0, 0.0, -1e3)];
    Scene {
        camera: camera(Vec3::Y * height, vec3(0.0, 0.0, -4.0 * height), 40.0),
        sky: Sky::Color(Vec3::ZERO),
        materials: vec![Material { texture: Some(0), emission: Vec3::ONE, ..material(Emitter) }],
        textures: vec![board(filter)],
        triangles: vec![triangle(corners, 0)],
        uvs: vec![corners.map(|corner| vec2(corner.x, -corner.z) / 8.0)],
        ..empty()
    }
}

fn settings(scene: &Scene, seed: u32) -> Settings {
    Settings { resolution: [96, 64], max_bounces: 2, seed, ..Settings::of(scene) }
}

/// Of a checkerboard whose fields are mostly smaller than pixels. Measured: 0.66 and 0.46 of bilinear's
/// error.
#[test]
fn far_checkerboard_has_less_error_in_one_sample_than_bilinear() {
    let [bilinear, trilinear] = [Filter::Bilinear, Filter::Trilinear].map(|filter| plain(filter, 12.0));
    let truth = render(&bilinear, settings(&bilinear, 9), 1024);
    let error = |scene: &Scene, samples| rmse(&render(scene, settings(scene, 1), samples), &truth);
    for (samples, most) in [(1, 0.75), (4, 0.6)] {
        let errors = [error(&bilinear, samples), error(&trilinear, samples)];
        assert!(errors[1] < most * errors[0], "{samples} samples: {errors:?}");
    }
    // Light is neither lost nor added.
    let means = [&truth, &render(&trilinear, settings(&trilinear, 2), 16)].map(mean);
    assert!((means[1] / means[0] - 1.0).abs() < 0.02, "{means:?}");
}

#[test]
fn texels_wider_than_pixels_are_bilinear_in_every_bit() {
    let [mut bilinear, mut trilinear] =
        [Filter::Bilinear, Filter::Trilinear].map(|filter| plain(filter, 4.0));
    for scene in [&mut bilinear, &mut trilinear] {
        scene.camera.look_at = Vec3::ZERO;
        scene.camera.up = Vec3::Z;
    }
    assert!(render(&bilinear, settings(&bilinear, 1), 2) == render(&trilinear, settings(&trilinear, 1), 2));
}

/// From near the centre of a hollow mirror, on a plane behind the camera: cones are thin again there. Bent
/// the other way, they would be four times as wide as at the mirror, or five texels.
#[test]
fn texels_behind_a_hollow_mirror_are_bilinear_in_every_bit() {
    let pictures = [Filter::Bilinear, Filter::Trilinear].map(|filter| {
        let mut scene = plain(filter, 4.0);
        scene.camera = camera(Vec3::Z * 0.2, Vec3::ZERO, 40.0);
        scene.materials.push(material(Metal { roughness: 0.0 }));
        scene.spheres = vec![sphere(Vec3::ZERO, 4.0, 1)];
        let corners = [vec3(-9.0, -9.0, 0.5), vec3(9.0, -9.0, 0.5), vec3(0.0, 9.0, 0.5)];
        scene.triangles = vec![triangle(corners, 0)];
        // Texels of a fiftieth.
        scene.uvs = vec![corners.map(|corner| vec2(corner.x, corner.y) * 50.0 / 32.0)];
        render(&scene, settings(&scene, 1), 2)
    });
    assert!(mean(&pictures[0]) > 0.3 && pictures[0] == pictures[1]);
}

/// In mirrors, in glass and behind rough surfaces; on spheres, triangles and the sky.
#[test]
fn picture_is_the_references_with_levels_of_detail() {
    for kind in KINDS {
        let mut rng = Rng(17);
        let bytes = (0..60 * 45).map(|_| [(rng.bits() >> 24) as u8, 90, 210, 0]).collect();
        let grain = texture([60, 45], Filter::Trilinear, Texels::Unorm8(bytes));
        let mut scene = plain(Filter::Trilinear, 2.0);
        scene.materials = vec![
            Material { texture: Some(0), ..material(Diffuse) },
            Material { texture: Some(1), roughness_map: Some(3), ..material(kind) },
        ];
        let of_noise =
            [[61, 33], [64, 32]].map(|[width, height]| noise(&mut rng, width, height, Filter::Trilinear));
        scene.textures.extend(of_noise.into_iter().chain([grain]));
        scene.spheres = vec![sphere(vec3(-1.2, 1.0, -6.0), 1.0, 1), sphere(vec3(1.2, 1.0, -7.0), 1.0, 1)];
        scene.sky = Sky::Texture { texture: 2, color: Vec3::ONE, turn: 0.2 };
        scene.max_bounces = 4;
        crate::judged::assert_is_the_references(&format!("levels, {kind:?}"), &scene, 2);
    }
}
