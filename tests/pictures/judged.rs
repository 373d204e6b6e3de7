//! Law: the estimator's picture is the reference's, path by path, whatever the material; rounding may send a
//! few paths elsewhere. Both follow the same random numbers, so the difference of a pixel has far less noise
//! than the pixel.

use crate::common::statistics::mean_and_error;
use crate::common::*;

/// Two balls, one in front of the other, on a floor; the balls of one kind.
pub fn balls(kind: MaterialKind) -> Scene {
    Scene {
        camera: camera(vec3(0.5, 1.0, 6.0), Vec3::ZERO, 40.0),
        sky: Sky::Gradient { bottom: vec3(0.1, 0.3, 0.2), top: vec3(1.0, 0.8, 0.6) },
        max_bounces: 6,
        materials: vec![
            Material { color: vec3(0.9, 0.8, 0.7), emission: vec3(0.0, 0.1, 0.0), ..material(kind) },
            Material { color: vec3(0.3, 0.5, 0.8), ..material(Diffuse) },
        ],
        spheres: vec![sphere(Vec3::ZERO, 1.0, 0), sphere(vec3(-1.3, 0.2, -1.5), 1.2, 0)],
        triangles: vec![triangle(ground(30.0, -1.0), 1)],
        ..empty()
    }
}

/// Asserts that the picture of so many samples is the reference's: at most one pixel in a hundred is off by
/// more than a thousandth, because one of its paths went elsewhere; the means agree within five standard
/// errors and the rounding of the other paths.
#[track_caller]
pub fn assert_is_the_references(name: &str, scene: &Scene, samples: u32) {
    // The reference samples no lights.
    let settings = Settings { resolution: [48, 32], seed: 3, ..with_lights(scene, LightChoice::Off) };
    let (picture, reference) = (render(scene, settings, samples), Reference::new(scene));
    let (mut differences, mut means, mut off) = (Vec::new(), Vec::new(), 0);
    for (pixel, (x, y)) in picture.pixels.iter().zip(places(settings.resolution)) {
        let truth = reference.pixel(path_settings(settings), x, y, samples);
        let difference = [0, 1, 2].map(|channel| f64::from(pixel[channel]) - truth[channel]);
        off += usize::from(difference.iter().any(|difference| difference.abs() > 1e-3));
        // One number a pixel: its channels are not independent.
        differences.push(difference.iter().sum::<f64>() / 3.0);
        means.push(truth.iter().sum::<f64>() / 3.0);
    }
    let ((mean, error), (_, noise)) = (mean_and_error(&differences), mean_and_error(&means));
    assert!(off <= 15, "{name}: {off} of 1,536 pixels are off by more than a thousandth");
    assert!(mean.abs() <= 5.0 * error + 1e-6, "{name}: the mean is off by {mean}, standard error {error}");
    assert!(error <= 0.2 * noise + 1e-7, "{name}: standard errors {error} and {noise}: paths are not paired");
}

#[test]
fn picture_is_the_references_for_every_kind_of_material_on_spheres_and_smooth_triangles() {
    let more = [Metal { roughness: 0.2 }, Metal { roughness: 1.0 }, FuzzyMirror { roughness: 2.5 }];
    for kind in KINDS.into_iter().chain(more) {
        assert_is_the_references(&format!("{kind:?}"), &balls(kind), 8);
        assert_is_the_references(&format!("smooth {kind:?}"), &smooth_ball(kind), 8);
    }
}

/// Smooth noise, as relief maps are: slopes up to about 30°.
fn relief(rng: &mut Rng) -> Texture {
    let mut near = |middle: f64, width: f64| (middle + width * rng.signed()) as f32;
    let texels = (0..24).map(|_| [near(0.5, 0.25), near(0.5, 0.25), near(0.95, 0.05), 0.0]).collect();
    texture([6, 4], Filter::Bilinear, Texels::Float32(texels))
}

#[test]
fn picture_is_the_references_with_maps_of_normals_and_roughness() {
    let mut rng = Rng(81);
    let bytes = (0..35).map(|_| [(rng.bits() >> 24) as u8, 7, 200, 0]).collect();
    let textures = vec![relief(&mut rng), texture([7, 5], Filter::Bilinear, Texels::Unorm8(bytes))];
    for kind in KINDS {
        let worn = |scene: Scene| {
            let mut scene = Scene { textures: textures.clone(), ..scene };
            scene.materials[0].normal_map = Some(0);
            scene.materials[0].roughness_map = Some(1);
            scene.materials[0].emission = vec3(0.5, 0.2, 0.1);
            scene.materials[0].emission_map = Some(0);
            scene
        };
        let mut round = worn(balls(kind));
        round.spheres[0].texture_turn = 0.3;
        round.spheres[1].texture_side = Side::Inside;
        // The floor too.
        round.materials[1].normal_map = Some(0);
        round.uvs = vec![[Vec2::ZERO, vec2(30.0, 3.0), vec2(-4.0, 40.0)]];
        assert_is_the_references(&format!("relief on balls, {kind:?}"), &round, 2);
        let mut faceted = worn(smooth_ball(kind));
        // Mirrored coordinates on every other triangle, none on some.
        faceted.uvs = (0..faceted.triangles.len())
            .map(|i| match i % 7 {
                0 => [Vec2::ONE; 3],
                i => [Vec2::ZERO, vec2(1.3, 0.2), vec2(0.1, if i % 2 == 0 { 0.9 } else { -0.9 })],
            })
            .collect();
        assert_is_the_references(&format!("relief on triangles, {kind:?}"), &faceted, 2);
    }
}
