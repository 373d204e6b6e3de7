//! The law of lamps: the choice of estimator never changes a mean, however lamps touch, overlap and repeat.

use crate::common::statistics::mean_and_error;
use crate::common::*;

/// A lamp or a panel for a random scene: on one of two planes, so that many share one, or around one of two
/// points.
fn add_shape(rng: &mut Rng, scene: &mut Scene) {
    let pick = |rng: &mut Rng, numbers: [f32; 3]| numbers[rng.index(3)];
    let material = [1, 1, 2, 3, 4][rng.index(5)];
    let height = [2.0, 2.5][rng.index(2)];
    if rng.index(4) == 0 {
        let radius = pick(rng, [0.4, 0.4, 0.7]);
        let center = vec3(pick(rng, [-0.8, 0.8, 0.9]), height, 0.0);
        return scene
            .spheres
            .push(Sphere { texture_turn: rng.unit() as f32, ..sphere(center, radius, material) });
    }
    let (x, z) = (pick(rng, [-1.0, 0.0, -0.3]), pick(rng, [-1.0, -0.5, 0.1]));
    let (width, depth) = (pick(rng, [0.5, 1.0, 1.2]), pick(rng, [0.5, 1.0, 0.7]));
    let corners =
        [[x, z], [x + width, z], [x + width, z + depth], [x, z + depth]].map(|[x, z]| vec3(x, height, z));
    let turned = rng.index(4);
    let corner = |at: usize| corners[(at + turned) % 4];
    let mut halves = vec![[corner(0), corner(1), corner(2)], [corner(0), corner(2), corner(3)]];
    halves.truncate(1 + rng.index(4).min(1));
    for mut vertices in halves {
        if rng.index(3) == 0 {
            vertices.swap(1, 2);
        }
        scene.uvs.push(vertices.map(|vertex| vec2(vertex.x, vertex.z)));
        scene.triangles.push(triangle(vertices, material));
        if rng.index(6) == 0 {
            scene.uvs.push(scene.uvs[scene.uvs.len() - 1]);
            scene.triangles.push(triangle(vertices, [1, 2, 3][rng.index(3)]));
        }
    }
}

/// A texture that is black but for one texel.
fn spot(width: u32, height: u32) -> Texture {
    let texel = |index: u32| if index == width + 2 { [255; 4] } else { [0, 0, 0, 255] };
    let texels = Texels::Srgb8((0..width * height).map(texel).collect());
    Texture { texels, ..noise(&mut Rng(1), width, height, Filter::Bilinear) }
}

/// A floor under some lamps and panels.
fn lamps(rng: &mut Rng) -> Scene {
    let gray = Material { color: Vec3::splat(0.5), ..material(Diffuse) };
    let painted = Material { texture: Some(rng.index(2) as u32), ..lamp(2.0) };
    let shining = Material { emission: Vec3::ONE, emission_map: Some(0), ..gray.clone() };
    let wraps = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror];
    let wrap = [rng.index(3), rng.index(3)].map(|wrap| wraps[wrap]);
    let mut scene = Scene {
        materials: vec![gray.clone(), lamp(1.0), gray, painted, shining],
        textures: vec![noise(rng, 4, 3, Filter::Bilinear), Texture { wrap, ..spot(6, 8) }],
        resolution: [16, 16],
        ..floor(vec3(0.2, 0.0, -0.1), 1.0)
    };
    scene.uvs = vec![[Vec2::ZERO; 3]; scene.triangles.len()];
    (0..2 + rng.index(4)).for_each(|_| add_shape(rng, &mut scene));
    scene
}

/// The mean of a picture's red channel, and its standard error.
fn mean_of(scene: &Scene, lights: LightChoice, samples: u32) -> (f64, f64) {
    let picture = render_by_random(scene, lights, samples);
    mean_and_error(&picture.pixels.iter().map(|pixel| f64::from(pixel[0])).collect::<Vec<_>>())
}

#[test]
fn lamps_that_are_bright_in_one_place_are_sampled_there() {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, z]| vec3(x, 2.0, z));
    let halves = [[0, 1, 2], [0, 2, 3]];
    let mut scene = floor(vec3(0.2, 0.0, -0.1), 1.0);
    let lamp = scene.materials.len() as u32;
    scene.materials.push(Material { texture: Some(0), ..emitter(Vec3::splat(50.0)) });
    scene.uvs = vec![[Vec2::ZERO; 3]; scene.triangles.len()];
    for half in halves {
        let vertices = half.map(|corner| corners[corner]);
        scene.triangles.push(triangle(vertices, lamp));
        scene.uvs.push(vertices.map(|vertex| 0.5 * vec2(vertex.x, vertex.z) + 0.5));
    }
    scene.resolution = [32, 32];
    // Down to one texel of 65,536, which lies between all points of a coarse grid, also where the texture is
    // turned.
    let turned = scene.uvs.clone().into_iter().map(|uvs| uvs.map(|uv| vec2(uv.x + uv.y, uv.y - uv.x)));
    let turned: Vec<_> = turned.collect();
    for size in [8, 64, 256, 250] {
        if size == 250 {
            scene.uvs.clone_from(&turned);
        }
        scene.textures = vec![spot(size, size)];
        let picture = |lanes| bits(&render(&scene, Settings { lanes, ..Settings::of(&scene) }, 4));
        assert!(WIDTHS.iter().all(|&lanes| picture(lanes) == picture(1)), "widths differ");
        let [(in_pieces, error), (whole, whole_error)] =
            [LightChoice::Auto, LightChoice::Power].map(|lights| mean_of(&scene, lights, 64));
        let apart = (in_pieces - whole).abs();
        assert!(apart < 4.0 * error.hypot(whole_error), "{size}: {in_pieces} and {whole}");
        assert!(error < 0.3 * whole_error, "{size}: {error} in pieces, {whole_error} of the whole");
    }
}

fn means_agree(scenes: u64, samples: u32) {
    let (mut textured, mut deciding) = (0, 0);
    for number in 0..scenes {
        let scene = lamps(&mut Rng(1000 + number));
        let lights = Lights::new(&scene, LightChoice::On);
        deciding += u32::from(lights.needs_hits());
        textured += u32::from(scene.triangles.iter().any(|triangle| triangle.material > 2));
        let (sought, sought_error) = mean_of(&scene, LightChoice::On, samples);
        let (hit, hit_error) = mean_of(&scene, LightChoice::Off, 4 * samples);
        let apart = (sought - hit).abs();
        let error = sought_error.hypot(hit_error);
        assert!(apart <= 4.0 * error + 1e-6, "scene {number}: {sought} and {hit}, {} errors", apart / error);
    }
    assert!(u64::from(textured.min(deciding)) > scenes / 4, "{textured} with textures, {deciding} deciding");
}

#[test]
fn sampling_lamps_keeps_the_mean() {
    means_agree(60, 64);
}

#[test]
#[ignore = "minutes: run by .ci/run"]
fn sampling_lamps_keeps_the_mean_of_many_scenes() {
    means_agree(1000, 256);
}
