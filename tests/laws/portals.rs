//! The laws of portals: directions are drawn through them as their density says, from one side only; they
//! change no expectation, whatever they cover; and in a room they take most of the noise away.

use crate::common::statistics::{allowed, mean_and_error};
use crate::common::*;
use crate::light_laws::polygon_irradiance;
use octray::openings;
use octray::rays::Structure;
use octray::scene::{Portal, builtin_names};
use std::path::Path;

const ALL: u64 = Features::ALL.0;

/// A rectangle in the plane x = 0, between these z and y, lit from +x.
fn window([from, to]: [f32; 2], [low, high]: [f32; 2]) -> Portal {
    Portal {
        vertices: [vec3(0.0, low, to), vec3(0.0, low, from), vec3(0.0, high, from), vec3(0.0, high, to)],
    }
}

#[test]
fn directions_through_portals_are_spread_as_their_density_says_and_only_from_the_lit_side() {
    let floor = Scene { triangles: vec![triangle(ground(1.0, -9.0), 0)], ..diffuse() };
    let mut rng = Rng(31);
    let mut far = 0;
    for round in 0..60 {
        // They overlap in a third of their union, which is a rectangle.
        let portals = vec![window([-1.0, 1.0], [0.0, 1.5]), window([0.0, 2.0], [0.0, 1.5])];
        let lights = Lights::new(&Scene { portals, ..floor.clone() }, LightChoice::On);
        assert_eq!(lights.portals.len(), 2);
        // From edges and corners, from near and far.
        let side = if round % 4 == 3 { -1.0 } else { 1.0 };
        let at = dvec3(side * rng.scale(0.01, 1000.0), 4.0 * rng.unit() - 2.0, 6.0 * rng.unit() - 3.0);
        let origin = math::Vec3::splat(at.as_vec3());
        let (mut mean, mut lit) = (DVec3::ZERO, 0);
        const SIDE: u32 = 192;
        let middle = |i: u32| (i as f32 + 0.5) / SIDE as f32;
        for (u, v) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (middle(i), middle(j)))) {
            let (light, u) = lights.choose_by_power(u, || 0.0, || 0.0, true);
            let sample = lights.sample::<f32, ALL>(&light, origin, (u, v), true);
            let pdf = lights.sky_pdf::<f32, ALL>(origin, sample.wi).unwrap();
            if sample.pdf > 0.0 {
                assert!(sample.t == f32::INFINITY && pdf >= 0.999 * sample.pdf * light.probability);
                mean += sample.wi.get(0).as_dvec3() / f64::from(pdf) / f64::from(SIDE * SIDE);
                lit += 1;
            }
        }
        if side < 0.0 {
            assert_eq!(lit, 0, "from behind, at {at}");
            continue;
        }
        let union = [[2.0, 0.0], [-1.0, 0.0], [-1.0, 1.5], [2.0, 1.5]].map(|[z, y]| dvec3(0.0, y, z) - at);
        let truth = polygon_irradiance(&union);
        let error = (mean.length() - truth.length()).abs() / truth.length();
        assert!(error < 0.01 && lit > SIDE * SIDE * 99 / 100, "{at}: {error:e}, {lit} of {}", SIDE * SIDE);
        // The integral of the density over the portals' area is 1.
        let area = 4.5 / f64::from(SIDE * SIDE);
        let mut integral = 0.0;
        for (along, up) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (middle(i), middle(j)))) {
            let to = dvec3(0.0, 1.5 * f64::from(up), 3.0 * f64::from(along) - 1.0) - at;
            let wi = math::Vec3::splat(to.normalize().as_vec3());
            let pdf = f64::from(lights.sky_pdf::<f32, ALL>(origin, wi).unwrap());
            integral += pdf * area * at.x / to.length().powi(3);
        }
        far += usize::from(at.x > 60.0);
        // Near the plane, the grid is coarse.
        let most = if at.x < 0.1 { 1.0 } else { 0.02 };
        assert!((integral - 1.0).abs() < most, "{at}: {integral}");
    }
    assert!(far > 5, "few are sampled by area: {far}");
}

/// Places a portal in the coordinates of a scene.
fn placed(portal: Portal, scene: &Scene) -> Portal {
    let origin = scene.coordinates.to_scene(DVec3::ZERO).as_vec3();
    Portal { vertices: portal.vertices.map(|vertex| vertex + origin) }
}

/// The room of `scenes/window.json`, in a small picture.
fn room() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/window.json");
    Scene { resolution: [16, 9], max_bounces: 4, ..load(path.to_str().unwrap()).unwrap() }
}

/// The mean of pictures of independent numbers, and its standard error.
fn mean_of_runs(scene: &Scene, lights: LightChoice, samples: u32, first: u32) -> (f64, f64) {
    let settings = |seed| Settings { seed, ..with_lights(scene, lights) };
    let means: Vec<f64> =
        (first..first + 16).map(|seed| mean(&render(scene, settings(seed), samples))).collect();
    mean_and_error(&means)
}

#[test]
fn portals_change_no_expectation_whatever_they_cover() {
    let gradient = room();
    let opening = window([-0.7, 0.7], [0.9, 2.2]);
    let origin = gradient.coordinates.to_scene(DVec3::ZERO).as_vec3();
    assert!(gradient.portals[0].vertices[1].abs_diff_eq(placed(opening, &gradient).vertices[1], 1e-5));
    // Under a texture with a sun, the sky as a whole is a light too; a lamp with a picture is hit by shadow
    // rays; outside, the portal is seen from behind.
    let mut sunny = gradient.clone();
    let texels = (0..32).map(|at| if at == 11 { [90.0, 80.0, 60.0, 0.0] } else { [0.5, 0.7, 1.0, 0.0] });
    sunny.textures.push(texture([8, 4], Filter::Nearest, Texels::Float32(texels.collect())));
    sunny.sky = Sky::Texture { texture: 0, color: Vec3::ONE, turn: 0.1 };
    let mut shining = sunny.clone();
    shining.textures.push(noise(&mut Rng(5), 4, 4, Filter::Nearest));
    shining.materials.push(Material { texture: Some(1), ..lamp(4.0) });
    shining.spheres.push(sphere(origin + vec3(2.5, 2.0, -1.0), 0.2, shining.materials.len() as u32 - 1));
    let outside = Scene {
        camera: camera(origin + vec3(-3.0, 2.0, 3.0), origin + vec3(0.0, 1.5, 0.0), 60.0),
        ..sunny.clone()
    };
    let away = Scene {
        camera: camera(origin + vec3(1.0, 1.5, 0.0), origin + vec3(4.0, 1.0, 1.0), 60.0),
        ..gradient.clone()
    };
    let mut deviations = Vec::new();
    for (name, scene) in
        [("gradient", gradient), ("sunny", sunny), ("shining", shining), ("outside", outside), ("away", away)]
    {
        let plain = Scene { portals: Vec::new(), ..scene.clone() };
        let (truth, of_truth) = mean_of_runs(&plain, LightChoice::Off, 1024, 1000);
        let half = window([-0.7, 0.1], [0.9, 2.2]);
        let backwards = Portal { vertices: [3, 2, 1, 0].map(|at| opening.vertices[at]) };
        for (number, portals) in [
            vec![opening],
            vec![window([-1.5, 0.9], [0.2, 2.5])],
            vec![half],
            vec![opening, half, window([-0.2, 2.0], [0.1, 1.4])],
            vec![backwards],
        ]
        .into_iter()
        .enumerate()
        {
            let portals = portals.into_iter().map(|portal| placed(portal, &scene)).collect();
            let scene = Scene { portals, ..scene.clone() };
            let choice = [LightChoice::Auto, LightChoice::On, LightChoice::Power][number % 3];
            let (mean, error) = mean_of_runs(&scene, choice, 64, 1 + 16 * number as u32);
            deviations
                .push((((mean - truth) / error.hypot(of_truth)), format!("{name} {number}: {mean} {truth}")));
        }
    }
    for (deviation, what) in &deviations {
        assert!(deviation.abs() < allowed(deviations.len()), "{what}: {deviation:.1} standard errors");
    }
}

#[test]
fn a_portal_more_than_halves_the_median_error_of_a_room_with_a_window() {
    let wanted = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases/wanted/window-room.json");
    if !wanted.is_file() {
        return skipped::skip("there is no ../shared/cases/wanted/window-room.json");
    }
    let plain = Scene { resolution: [48, 27], ..load(wanted.to_str().unwrap()).unwrap() };
    let with = Scene { portals: vec![placed(window([-3.5, -1.5], [0.8, 2.1]), &plain)], ..plain.clone() };
    let of = |scene: &Scene, seed, samples| render(scene, Settings { seed, ..Settings::of(scene) }, samples);
    let truth = of(&with, 9, 2048);
    let median = |scene: &Scene| {
        let picture = of(scene, 1, 16);
        let pairs = picture.pixels.as_flattened().iter().zip(truth.pixels.as_flattened());
        let mut errors: Vec<f32> = pairs.map(|(one, other)| (one - other).abs()).collect();
        errors.sort_by(f32::total_cmp);
        errors[errors.len() / 2]
    };
    let (with, without) = (median(&with), median(&plain));
    assert!(with < 0.4 * without, "{with} of {without}");
}

#[test]
fn rooms_without_their_portal_are_told_its_corners_and_open_scenes_nothing() {
    let advice = |scene: &Scene| openings::advice(scene, &Structure::new(&scene.geometry()));
    for name in builtin_names() {
        assert_eq!(advice(&load(&format!("builtin:{name}")).unwrap()), None, "{name}");
    }
    let marked = room();
    assert_eq!(advice(&marked), None);
    let plain = Scene { portals: Vec::new(), ..marked };
    let told = advice(&plain).unwrap();
    let corners = "[[0.0, 0.9, -0.7], [0.0, 2.2, -0.7], [0.0, 2.2, 0.7], [0.0, 0.9, 0.7]]";
    assert!(told.contains(corners), "{told}");
    // Its front wall away, the room is open.
    let mut open = plain.clone();
    open.triangles.retain(|triangle| {
        triangle.vertices.iter().any(|v| (v.x - plain.triangles[8].vertices[0].x).abs() > 1e-3)
    });
    assert!(open.triangles.len() == plain.triangles.len() - 2);
    assert_eq!(advice(&open), None);
}
