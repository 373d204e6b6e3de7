//! The law of choosing among lights: each is drawn as often as its chance says, however unlike their powers
//! are; the number that chose is as well spread over the chosen light as over all of them; nothing is
//! overlooked on the way there, by any equations.

use crate::common::*;
use crate::light_laws::polygon_irradiance;
use octray::primitives::LightTable;

/// Round lamps in a row, each at its own number, of these radiances.
fn lamps(radiances: &[f32]) -> Scene {
    let mut scene = diffuse();
    for (number, &radiance) in radiances.iter().enumerate() {
        scene.materials.push(lamp(radiance));
        scene.spheres.push(sphere(Vec3::X * number as f32, 0.1, number as u32 + 1));
    }
    scene
}

/// Candles beside one lamp, and lamps of all powers.
fn radiances(count: usize) -> [Vec<f32>; 2] {
    let mut rng = Rng(81);
    let candles = (0..count).map(|number| if number == count / 2 { 1e9 } else { 1.0 });
    let unlike = (0..count).map(|_| rng.scale(1e-9, 1e9) as f32);
    [candles.collect(), unlike.collect()]
}

#[test]
fn one_number_chooses_each_of_a_few_lights_by_its_chance_and_a_point_all_over_it() {
    const NUMBERS: u32 = 1 << 24;
    for count in [2, 5, 64] {
        for radiances in radiances(count) {
            let lights = Lights::new(&lamps(&radiances), LightChoice::On);
            assert_eq!(lights.len(), count);
            // How often each light was drawn, and the moments of what was left of the number.
            let mut seen = vec![[0.0; 3]; count];
            let never = || -> f32 { unreachable!("one number is enough") };
            // Every number there is.
            for number in 0..NUMBERS {
                let u = number as f32 / NUMBERS as f32;
                let (light, rest) = lights.choose_by_power::<f32>(u, never, never, count <= LightTable::FEW);
                assert!((0.0..1.0).contains(&rest), "{count} lights: {rest} left of {u}");
                let rest = f64::from(rest);
                let sums = seen[light.at.x as usize].iter_mut();
                sums.zip([1.0, rest, rest * rest]).for_each(|(sum, more)| *sum += more);
            }
            for (number, [drawn, sum, squares]) in seen.into_iter().enumerate() {
                let what = format!("light {number} of {count}, radiance {:e}", radiances[number]);
                let chance = f64::from(lights.probabilities[number]);
                // A border of a slot and one within it may each be off by one number; the least chance is
                // 1/4096 or 4096 numbers.
                let off = drawn / f64::from(NUMBERS) / chance - 1.0;
                assert!(off.abs() < 1e-3, "{what}: drawn {drawn} times, {off:e} off");
                let (mean, square) = (sum / drawn, squares / drawn);
                assert!((mean - 0.5).abs() < 1e-3, "{what}: mean {mean} over the light");
                assert!((square - 1.0 / 3.0).abs() < 1e-3, "{what}: mean square {square} over the light");
            }
        }
    }
}

#[test]
fn two_other_numbers_choose_among_many_lights_by_their_chances() {
    const PARTS: u32 = 1 << 12;
    for count in [65, 1000, 4097] {
        for radiances in radiances(count) {
            let lights = Lights::new(&lamps(&radiances), LightChoice::On);
            assert_eq!(lights.len(), count);
            let mut drawn = vec![0u32; count];
            // A number in each slot, and with it a fine grid of the other.
            for slot in 0..count {
                let number = ((slot as f64 + 0.5) / count as f64) as f32;
                for part in 0..PARTS {
                    let more = (part as f32 + 0.5) / PARTS as f32;
                    let (light, rest) = lights.choose_by_power::<f32>(0.3, || number, || more, false);
                    assert_eq!(rest, 0.3, "{count} lights: the point's number is left whole");
                    drawn[light.at.x as usize] += 1;
                }
            }
            let draws = f64::from(PARTS) * count as f64;
            for (number, drawn) in drawn.into_iter().enumerate() {
                let chance = f64::from(lights.probabilities[number]);
                // The least share of a slot is 1/64, and the grid is off by half a part at its border.
                let off = f64::from(drawn) / draws / chance - 1.0;
                let what = format!("light {number} of {count}, radiance {:e}", radiances[number]);
                assert!(off.abs() < 0.01, "{what}: drawn {drawn} times, {off:e} off");
            }
        }
    }
}

#[test]
fn chances_sum_to_one_and_rows_hold_those_of_their_own_light() {
    for radiances in [2, 4, 5, 64, 65, 5000].map(radiances).into_iter().flatten() {
        let scene = lamps(&radiances);
        let lights = Lights::new(&scene, LightChoice::On);
        let sum: f64 = lights.probabilities.iter().map(|&chance| f64::from(chance)).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        let mut rng = Rng(82);
        for _ in 0..1000 {
            let [u, number, more] = [(); 3].map(|()| (rng.bits() >> 8) as f32 / 16_777_216.0);
            let (light, _) =
                lights.choose_by_power::<f32>(u, || number, || more, radiances.len() <= LightTable::FEW);
            let at = light.at.x as usize;
            assert_eq!((light.probability, light.emission.x), (lights.probabilities[at], radiances[at]));
        }
    }
}

#[test]
fn tables_hold_as_many_lights_as_they_promise() {
    for count in 1..=10 {
        let mut scene = floor(Vec3::ZERO, 2.0);
        scene.camera.vertical_fov = 60.0;
        for number in 0..count {
            scene.materials.push(lamp(1.0 + number as f32));
            let at = vec3(0.2 * number as f32 - 1.0, 0.5, 0.1);
            let corners = [Vec3::ZERO, Vec3::X, Vec3::Z].map(|corner| at + 0.1 * corner);
            scene.triangles.push(triangle(corners, number + 1));
        }
        let needed = Settings::of(&scene);
        let many = Renderer::new(&scene, needed).needs().contains(Features::MANY_LIGHTS);
        assert_eq!(many, count as usize > LightTable::FEW, "{count} lights");
        let general = Settings { pipeline: PipelineChoice::General, ..needed };
        assert_eq!(render(&scene, needed, 16), render(&scene, general, 16), "{count} lights");
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Sphere,
    Triangle,
    Quad,
}

/// A lamp over the floor's middle, at `foot`, and what the floor there gets of it.
fn under_a_lamp(foot: Vec3, scale: f32, shape: Shape) -> (Scene, f64) {
    let mut scene = floor(foot, 2.0 * scale);
    scene.materials.push(lamp(50.0));
    if shape == Shape::Sphere {
        scene.spheres = vec![sphere(foot + vec3(0.6, 0.8, 0.0) * scale, 0.1 * scale, 1)];
        // Radiance 50, sin² = 0.01, cos = 0.8, of π / π.
        return (scene, 0.4);
    }
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let corners = corners.map(|[x, z]| vec3(0.6, 0.8, 0.0) + vec3(x, 0.0, z) * 0.05);
    let outline = if shape == Shape::Quad { &corners[..] } else { &corners[..3] };
    for end in 2..outline.len() {
        let vertices = [outline[0], outline[end - 1], outline[end]];
        scene.triangles.push(triangle(vertices.map(|corner| foot + corner * scale), 1));
    }
    let outline: Vec<_> = outline.iter().map(|corner| corner.as_dvec3()).collect();
    (scene, 50.0 / std::f64::consts::PI * polygon_irradiance(&outline).y.abs())
}

#[test]
fn lamps_light_and_are_shaded_at_every_scale() {
    for scale in [1e-10, 1e-8, 1e-5, 1.0, 1e5, 1e9] {
        let feet = [Vec3::ZERO, vec3(30.0, -20.0, 50.0) * scale];
        let shapes = [(Shape::Sphere, 2e-3), (Shape::Triangle, 4e-3), (Shape::Quad, 4e-3)];
        for (foot, (shape, most)) in feet.into_iter().flat_map(|foot| shapes.map(|shape| (foot, shape))) {
            let (open, truth) = under_a_lamp(foot, scale, shape);
            let got = mean(&render(&open, Settings::of(&open), 64));
            assert!((got / truth - 1.0).abs() < most, "{scale:e}, {foot}, {shape:?}: {got} of {truth}");
            // A black sheet so close to the lamp that a ray which ends a thousandth too early overlooks it.
            let mut shaded = open;
            shaded.materials.push(Material { color: Vec3::ZERO, ..material(Diffuse) });
            let height = if shape == Shape::Sphere { 0.7 } else { 0.8 } - 4e-4;
            let corners = [[-0.2, -3.0], [-0.2, 3.0], [3.0, 0.0]];
            let corners = corners.map(|[x, z]| foot + vec3(0.2 + x, height, z) * scale);
            shaded.triangles.push(triangle(corners, 2));
            let got = mean(&render(&shaded, Settings::of(&shaded), 64));
            assert_eq!(got, 0.0, "{scale:e}, {foot}, {shape:?}: light through the sheet");
        }
    }
}

/// The sky's chance counts on both sides, by search and by chance: here it is about two thirds.
#[test]
fn a_sky_beside_a_lamp_gives_what_both_closed_forms_say() {
    let (mut scene, lamp) = under_a_lamp(Vec3::ZERO, 1.0, Shape::Sphere);
    let corners = [vec3(-0.3, 0.0, -0.3), vec3(0.0, 0.0, 0.5), vec3(0.3, 0.0, -0.3)];
    scene.triangles[0] = triangle(corners, 0);
    // A picture of even light all around.
    scene.textures = vec![texture([8, 4], Filter::Nearest, Texels::Float32(vec![[1.0; 4]; 32]))];
    scene.sky = Sky::Texture { texture: 0, color: Vec3::ONE, turn: 0.0 };
    let lights = Lights::new(&scene, LightChoice::On);
    let (_, chance) = lights.sky.as_ref().unwrap();
    assert!((0.4..0.8).contains(chance), "{chance}");
    // The lamp hides what it fills of the sky.
    let truth = 1.0 - 0.008 + lamp;
    let got = mean(&render(&scene, with_lights(&scene, LightChoice::On), 1024));
    assert!((got / truth - 1.0).abs() < 0.01, "{got} of {truth}");
}
