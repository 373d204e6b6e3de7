//! The laws of points, spots and directional lights: the closed form of each kind, the reference for every
//! material, and the same mean whatever else emits and however it is found.

use crate::common::statistics::mean_and_error;
use crate::common::*;
use octray::scene::{LightShape, PunctualLight};
use std::f64::consts::PI;

fn point(position: Vec3) -> LightShape {
    LightShape::Point { position, intensity: vec3(5.0, 2.0, 1.0), range: f32::INFINITY }
}

fn spot(position: Vec3, direction: Vec3, [inner_degrees, outer_degrees]: [f32; 2]) -> LightShape {
    let intensity = vec3(5.0, 2.0, 1.0);
    LightShape::Spot { position, direction, intensity, range: f32::INFINITY, inner_degrees, outer_degrees }
}

fn sun(direction: Vec3, angular_diameter_degrees: f32) -> LightShape {
    LightShape::Directional { direction, irradiance: vec3(5.0, 2.0, 1.0), angular_diameter_degrees }
}

/// A white floor around the origin under some lights.
fn under(lights: Vec<LightShape>) -> Scene {
    Scene { lights: lights.into_iter().map(PunctualLight::from).collect(), ..floor(Vec3::ZERO, 1.0) }
}

/// The mean of the red channel, and its standard error.
fn red(scene: &Scene, lights: LightChoice, samples: u32) -> (f64, f64) {
    let picture = render_by_random(scene, lights, samples);
    mean_and_error(&picture.pixels.iter().map(|pixel| f64::from(pixel[0])).collect::<Vec<_>>())
}

#[test]
fn each_kind_has_its_closed_form() {
    let place = vec3(1.0, 2.0, -0.5);
    let (distance2, cosine) = (5.25, 2.0 / 5.25_f64.sqrt());
    let of_point = 5.0 * cosine / distance2 / PI;
    let ranged = LightShape::Point { position: place, intensity: vec3(5.0, 2.0, 1.0), range: 3.0 };
    // Spots straight down from 2 above the floor, 1 to the side: the foot lies at atan(1/2) = 26.565°.
    let aside = |degrees| spot(vec3(1.0, 2.0, 0.0), Vec3::NEG_Y, degrees);
    let of_aside = 5.0 * (2.0 / 5.0_f64.sqrt()) / 5.0 / PI;
    let cos = |degrees: f64| degrees.to_radians().cos();
    let between = (((2.0 / 5.0_f64.sqrt()) - cos(40.0)) / (cos(20.0) - cos(40.0))).powi(2);
    let aslant = vec3(3.0, -4.0, 0.0);
    let narrow = spot(100.0 * Vec3::Y, -Vec3::Y, [0.05, 0.1]);
    let cases = [
        (point(place), of_point),
        (ranged, of_point * (1.0 - (distance2 / 9.0).powi(2))),
        (LightShape::Point { position: place, intensity: Vec3::X, range: 2.0 }, 0.0),
        (aside([27.0, 40.0]), of_aside),
        (aside([20.0, 40.0]), of_aside * between),
        (aside([10.0, 26.0]), 0.0),
        (aside([26.0, 26.0]), 0.0),
        (aside([27.0, 27.0]), of_aside),
        (narrow, 5.0 / 1e4 / PI),
        (sun(aslant, 0.0), 5.0 * 0.8 / PI),
        (sun(aslant, 1e-4), 5.0 * 0.8 / PI),
        (sun(aslant, 0.53), 5.0 * 0.8 / PI),
        (sun(aslant, 60.0), 5.0 * 0.8 / PI),
        (sun(Vec3::NEG_Y, 180.0), 5.0 / PI),
        (sun(Vec3::Y, 1.0), 0.0),
    ];
    for (shape, expected) in cases {
        let scene = under(vec![shape]);
        for lights in [LightChoice::Auto, LightChoice::On, LightChoice::Power] {
            let (mean, _) = red(&scene, lights, 64);
            assert!((mean - expected).abs() <= 0.01 * expected, "{shape:?}, {lights:?}: {mean}, {expected}");
        }
        let judge = Reference::new(&scene).pixel(path_settings(Settings::of(&scene)), 4, 4, 4000)[0];
        // Paths find discs by chance.
        let is_found = !matches!(shape, LightShape::Directional { angular_diameter_degrees, .. }
            if angular_diameter_degrees > 0.0 && angular_diameter_degrees < 50.0);
        assert!(!is_found || (judge - expected).abs() <= 0.07 * expected, "{shape:?}: {judge}, {expected}");
        let picture = |lanes| bits(&render(&scene, Settings { lanes, ..Settings::of(&scene) }, 4));
        assert!(WIDTHS.iter().all(|&lanes| picture(lanes) == picture(1)), "{shape:?}: widths differ");
    }
}

/// Rays leave a huge primitive a fifth of the light's distance above it.
#[test]
fn points_near_a_huge_floor_keep_their_closed_form() {
    for height in [0.2_f32, 0.02] {
        let triangles = vec![triangle(ground(1e4, 0.0), 0)];
        let scene = Scene { triangles, ..under(vec![point(height * Vec3::Y)]) };
        let (mean, _) = red(&scene, LightChoice::Auto, 16);
        let expected = 5.0 / f64::from(height * height) / PI;
        assert!((mean - expected).abs() < 0.1 * expected, "{height}: {mean}, {expected}");
    }
}

#[test]
fn shadows_end_at_the_light() {
    let blocked = |height: f32| {
        let mut scene = under(vec![point(2.0 * Vec3::Y)]);
        // It does not hide the floor from the camera, which is below.
        scene.triangles.push(triangle(ground(1.0, height), 0));
        red(&scene, LightChoice::Auto, 4).0
    };
    assert_eq!(blocked(1.5), 0.0);
    assert!((blocked(2.5) / (5.0 / 4.0 / PI) - 1.0).abs() < 0.01);
}

/// Every material beside the reference, on the same paths. Rough glass is lit from one side at a time.
#[test]
fn every_material_shows_them_as_in_the_reference() {
    let (mut paths, mut lit) = (0, 0);
    for kind in KINDS.into_iter().filter(|kind| !matches!(kind, RoughGlass { .. })) {
        for ball in [round_ball(kind), smooth_ball(kind)] {
            for shape in
                [point(vec3(2.0, 2.5, 2.0)), spot(vec3(0.5, 3.0, 2.0), vec3(-0.2, -1.0, -0.6), [5.0, 35.0])]
            {
                let scene = Scene { lights: vec![shape.into()], ..ball.clone() };
                let methods = Methods { sampler: Sampler::Random, ..Methods::default() };
                let settings = Settings { resolution: [24, 16], methods, ..Settings::of(&scene) };
                let (mut renderer, judge) = (Renderer::new(&scene, settings), Reference::new(&scene));
                for (x, y) in places([24, 16]).step_by(3) {
                    let (f32, f64) =
                        (renderer.path([x, y], 0), judge.vertices(path_settings(settings), x, y, 0));
                    let seen = f32.iter().map(|vertex| (vertex.primitive, vertex.lobe));
                    if !f64.iter().map(|vertex| (vertex.primitive, vertex.lobe)).eq(seen) {
                        continue;
                    }
                    paths += 1;
                    for (at, (f32, f64)) in f32.iter().zip(&f64).enumerate() {
                        let [f32, f64] =
                            [f32.light.map_or(0.0, |l| f64::from(l[0])), f64.light.map_or(0.0, |l| l[0])];
                        lit += usize::from(f64 > 0.0);
                        let close = (f32 - f64).abs() <= 0.01 * f64 + 1e-4;
                        assert!(close, "{kind:?}, {x},{y}, vertex {at}: {f32} and {f64}");
                    }
                }
            }
        }
    }
    assert!(paths > 4000 && lit > 500, "{paths} paths, {lit} lit vertices");
}

/// Beside emitters of which hits decide, a sky with a texture, and each other.
#[test]
fn other_lights_and_other_estimators_keep_the_mean() {
    let mut scene = under(vec![
        point(vec3(0.4, 0.7, 0.1)),
        spot(vec3(-0.5, 0.9, 0.2), vec3(0.6, -1.0, -0.2), [10.0, 50.0]),
        sun(vec3(0.2, -1.0, 0.3), 0.0),
        sun(vec3(-0.2, -1.0, 0.3), 40.0),
        sun(vec3(-0.8, -1.0, 0.3), 25.0),
    ]);
    scene.materials.push(Material { texture: Some(0), ..lamp(3.0) });
    scene.triangles.push(triangle(ground(0.3, 1.5), 1));
    scene.textures = vec![noise(&mut Rng(5), 6, 4, Filter::Bilinear)];
    scene.uvs = vec![[Vec2::ZERO, vec2(1.0, 0.0), vec2(0.0, 1.0)]; 2];
    let skies = [Sky::Color(Vec3::ZERO), Sky::Texture { texture: 0, color: Vec3::splat(0.3), turn: 0.2 }];
    for (sky, has_lamp) in [(skies[0], true), (skies[1], true), (skies[1], false)] {
        let mut scene = Scene { sky, ..scene.clone() };
        if !has_lamp {
            scene.triangles.pop();
            scene.uvs.pop();
        }
        assert_eq!(Lights::new(&scene, LightChoice::On).needs_hits(), has_lamp);
        let (hit, hit_error) = red(&scene, LightChoice::Off, 1024);
        for lights in [LightChoice::On, LightChoice::Power] {
            let (sampled, error) = red(&scene, lights, 256);
            let apart = (sampled - hit).abs();
            assert!(
                apart < 4.0 * error.hypot(hit_error),
                "{lights:?}: {sampled} ± {error}, {hit} ± {hit_error}"
            );
        }
        assert!(hit_error < 0.02 * hit, "{hit} ± {hit_error}");
        let picture = |lanes, traversal| {
            let methods = Methods { traversal, ..Methods::default() };
            bits(&render(&scene, Settings { lanes, methods, ..Settings::of(&scene) }, 4))
        };
        let own = picture(1, TraversalChoice::Linear);
        for traversal in [TraversalChoice::Linear, TraversalChoice::Through(Traversal::Hybrid)] {
            assert!(WIDTHS.iter().all(|&lanes| picture(lanes, traversal) == own), "{traversal:?} differs");
        }
    }
}

#[test]
fn mirrors_show_discs_and_nothing_else() {
    let mut scene = under(vec![sun(vec3(0.0, -1.0, 0.0), 20.0), sun(Vec3::NEG_Y, 0.0), point(5.0 * Vec3::Y)]);
    scene.materials[0].kind = Metal { roughness: 0.0 };
    let radiance = 5.0 / (PI * 10.0_f64.to_radians().sin().powi(2));
    let (mean, _) = red(&scene, LightChoice::Auto, 4);
    assert!((mean / radiance - 1.0).abs() < 1e-4, "{mean} for {radiance}");
    // And the camera sees them.
    scene.camera = camera(Vec3::Y, 2.0 * Vec3::Y, 0.5);
    scene.camera.up = Vec3::Z;
    let (mean, _) = red(&scene, LightChoice::Auto, 4);
    assert!((mean / radiance - 1.0).abs() < 1e-4, "{mean} for {radiance}");
}
