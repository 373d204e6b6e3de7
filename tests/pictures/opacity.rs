//! Laws of surfaces that rays pass: closed forms, the reference, lights on and off, nothing at opacity 0.

use crate::common::statistics::{allowed, mean_and_error};
use crate::common::*;
use crate::judged::assert_is_the_references;
use octray::integrate::aovs::Aovs;

fn pane(opacity: f32) -> Material {
    Material { opacity, color: Vec3::ZERO, ..material(Diffuse) }
}

/// A wall across the view at a distance from the camera of [`empty`], of two triangles.
fn wall(scene: &mut Scene, distance: f32, material: u32) {
    let at = |x: f32, y: f32| vec3(40.0 * x, 40.0 * y, 5.0 - distance);
    let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    scene.triangles.extend([triangle([a, b, c], material), triangle([a, c, d], material)]);
    if !scene.textures.is_empty() {
        let [a, b, c, d] = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        scene.uvs.extend([[a, b, c], [a, c, d]]);
    }
}

#[test]
fn black_panes_let_powers_of_the_sky_through_without_bounces() {
    for (opacity, count, balls) in [(0.25, 1, 0), (0.25, 4, 0), (0.5, 3, 0), (0.75, 2, 0), (0.5, 0, 2)] {
        let mut scene = Scene { materials: vec![pane(opacity)], max_bounces: 0, ..empty() };
        (0..count).for_each(|number| wall(&mut scene, 1.0 + number as f32, 0));
        // A ball is two surfaces, one around the camera a single one.
        scene.spheres.extend((0..balls).map(|number| sphere(Vec3::Z * 5.0, 3.0 + number as f32, 0)));
        scene.spheres.extend((balls > 0).then(|| sphere(Vec3::Z * -40.0, 30.0, 0)));
        let surfaces = count + balls + 2 * balls.min(1);
        let film = film(&scene, Settings::of(&scene), 256);
        let through = f64::from(1.0 - opacity);
        let (expected, samples) = (through.powi(surfaces), film.pixel_samples() as f64);
        let error = (expected * (1.0 - expected) / samples).sqrt();
        let off = (mean(&film.picture()) - expected) / error;
        assert!(off.abs() < allowed(10), "{surfaces} surfaces of {opacity}: {off:.1} standard errors");
        // A ray is asked again each time that it passes a surface.
        let rays: f64 = (0..=surfaces).map(|passed| through.powi(passed)).sum();
        let rays = rays / (film.rays() as f64 / samples);
        assert!((rays - 1.0).abs() < 0.02, "{surfaces} surfaces of {opacity}: {rays} times as many rays");
    }
}

/// A texture of one row with these alphas.
fn alphas(filter: Filter, alphas: &[u8]) -> Texture {
    let texels = alphas.iter().map(|&alpha| [alpha, 7, 9, 0]).collect();
    texture([alphas.len() as u32, 1], filter, Texels::Unorm8(texels))
}

#[test]
fn masks_are_opaque_from_the_cutoff_on_and_aovs_see_through_them() {
    let cutoff = 102.0 / 255.0;
    let mask = Material { opacity_map: Some(0), alpha_cutoff: Some(cutoff), ..pane(1.0) };
    let mut scene = Scene { materials: vec![mask, lamp(2.0)], ..empty() };
    scene.textures = vec![alphas(Filter::Nearest, &[101, 102])];
    wall(&mut scene, 2.0, 0);
    wall(&mut scene, 4.0, 1);
    let renderer = Renderer::new(&scene, Settings::of(&scene));
    let mut aovs = Aovs::default();
    renderer.aovs_into(&mut aovs);
    let picture = render(&scene, Settings::of(&scene), 4);
    for ((x, y), pixel) in places(scene.resolution).zip(&picture.pixels) {
        // Columns 11 and 12 meet at the middle of the wall.
        let is_hole = x < 12;
        assert_eq!(pixel[0], if is_hole { 2.0 } else { 0.0 }, "{x}, {y}");
        let distance = aovs.pixel(x, y).distance;
        assert_eq!(distance >= 4.0, is_hole, "{x}, {y}: {distance}");
    }
    // A factor at which no texel reaches the cutoff.
    scene.materials[0].opacity = 0.99;
    let picture = render(&scene, Settings::of(&scene), 1);
    assert!(picture.pixels.iter().all(|pixel| *pixel == [2.0; 3]));
}

/// Panes, a cut-out card, transparent lamps of both kinds, one with a map, glass: under a dim sky.
fn mixed() -> Scene {
    let mut scene = Scene {
        camera: camera(vec3(0.3, 0.8, 6.0), Vec3::ZERO, 45.0),
        resolution: [24, 16],
        max_bounces: 3,
        sky: Sky::Color(Vec3::splat(0.1)),
        textures: vec![
            alphas(Filter::Bilinear, &[0, 255, 90, 200, 30]),
            alphas(Filter::Nearest, &[255, 0, 140]),
        ],
        materials: vec![
            Material { color: Vec3::splat(0.6), ..material(Diffuse) },
            Material { opacity: 0.4, ..emitter(vec3(6.0, 4.0, 2.0)) },
            Material { opacity_map: Some(1), opacity: 0.9, ..emitter(vec3(3.0, 5.0, 8.0)) },
            Material { opacity: 0.5, color: vec3(0.9, 0.4, 0.2), ..material(Metal { roughness: 0.4 }) },
            Material { opacity_map: Some(0), alpha_cutoff: Some(0.5), ..material(Diffuse) },
            Material { opacity: 0.7, ..material(Glass { ior: 1.5 }) },
        ],
        spheres: vec![
            sphere(vec3(-1.2, 0.6, 0.5), 0.4, 1),
            sphere(vec3(0.2, -0.3, 0.0), 0.7, 5),
            sphere(vec3(-0.9, -0.8, 1.2), 0.5, 3),
        ],
        ..empty()
    };
    for (corners, material) in [
        (ground(9.0, -1.4), 0),
        ([vec3(1.0, 0.2, 0.4), vec3(1.9, 0.3, 0.2), vec3(1.2, 1.3, 0.1)], 2),
        ([vec3(-2.0, -1.2, -0.5), vec3(2.0, -1.2, -0.5), vec3(0.0, 2.0, -0.6)], 3),
        ([vec3(-1.6, -0.9, 0.9), vec3(0.9, -0.9, 1.4), vec3(-0.3, 0.9, 1.0)], 4),
    ] {
        scene.triangles.push(triangle(corners, material));
        scene.uvs.push([vec2(0.1, 0.1), vec2(1.7, 0.2), vec2(0.3, 1.4)]);
    }
    scene
}

#[test]
fn lights_on_and_off_expect_the_same_through_surfaces_and_on_transparent_lamps() {
    let scenes = [
        ("mixed", mixed()),
        ("opaque lamps", {
            let mut scene = mixed();
            scene.materials[1].opacity = 1.0;
            (scene.materials[2].opacity, scene.materials[2].opacity_map) = (1.0, None);
            scene
        }),
    ];
    for (name, scene) in scenes {
        let runs = |lights, samples: u32, first: u32| -> (f64, f64) {
            let run = |seed| mean(&render(&scene, Settings { seed, ..with_lights(&scene, lights) }, samples));
            mean_and_error(&(first..first + 16).map(run).collect::<Vec<_>>())
        };
        let (on, off) = (runs(LightChoice::On, 16, 1), runs(LightChoice::Off, 64, 101));
        let error = on.1.hypot(off.1);
        assert!(error < 0.01 * on.0, "{name}: an error of {error} at {}", on.0);
        assert!((on.0 - off.0).abs() < 4.5 * error, "{name}: {on:?} and {off:?}");
    }
}

#[test]
fn picture_is_the_references_through_surfaces() {
    for sampler in [Filter::Nearest, Filter::Trilinear] {
        let mut scene = mixed();
        scene.textures[0].filter = sampler;
        assert_is_the_references("opacity", &scene, 4);
    }
}

#[test]
fn opacity_of_1_or_a_cutoff_of_0_changes_no_bit_and_0_is_not_there() {
    let bits_of = |scene: &Scene, lights| bits(&render(scene, with_lights(scene, lights), 4));
    for lights in [LightChoice::On, LightChoice::Off] {
        let mut plain = mixed();
        plain
            .materials
            .iter_mut()
            .for_each(|m| (m.opacity, m.opacity_map, m.alpha_cutoff) = (1.0, None, None));
        let mut cut = plain.clone();
        (cut.materials[3].opacity_map, cut.materials[3].alpha_cutoff) = (Some(0), Some(0.0));
        assert!(!Renderer::new(&cut, Settings::of(&cut)).needs().contains(Features::OPACITY));
        assert_eq!(bits_of(&cut, lights), bits_of(&plain, lights));
        // Behind the others, so that no primitive has another number.
        let mut with = plain.clone();
        with.materials.push(Material { opacity: 0.0, ..lamp(5.0) });
        wall(&mut with, 0.5, 6);
        wall(&mut with, 7.0, 6);
        assert!(Renderer::new(&with, Settings::of(&with)).needs().contains(Features::OPACITY));
        assert_eq!(bits_of(&with, lights), bits_of(&plain, lights), "{lights:?}");
    }
}

#[test]
fn bits_depend_on_no_width_traversal_thread_or_tile_and_other_tests_take_the_same_layers() {
    let mut scene = mixed();
    let mut rng = Rng(5);
    for number in 0..60 {
        let place = rng.in_cube() * 2.0;
        let corners = [(); 3].map(|()| (place + rng.in_cube()).as_vec3());
        scene.triangles.push(triangle(corners, 2 + number % 4));
        scene.uvs.push([(); 3].map(|()| vec2(rng.unit() as f32, rng.unit() as f32)));
    }
    let settings = |lanes, traversal, tile: u32, threads| Settings {
        lanes,
        tile_size: [tile, tile],
        threads,
        methods: Methods { traversal, ..Methods::default() },
        ..Settings::of(&scene)
    };
    let (auto, linear) = (TraversalChoice::Auto, TraversalChoice::Linear);
    let first = render(&scene, settings(1, auto, 16, 1), 4);
    let others = Traversal::ALL.map(TraversalChoice::Through);
    for (lanes, traversal, tile, threads) in
        [(8, linear, 16, 1), (NATIVE_WIDTH, linear, 4, 2), (1, linear, 8, 1)]
            .into_iter()
            .chain(others.map(|traversal| (NATIVE_WIDTH, traversal, 8, 2)))
    {
        let other = render(&scene, settings(lanes, traversal, tile, threads), 4);
        assert_eq!(bits(&other), bits(&first), "{lanes} {traversal:?} {tile} {threads}");
    }
    // The tests of other methods know no lower bounds; the picture is nearly the same.
    let methods = Methods {
        sphere: SphereChoice::Naive,
        triangle: TriangleChoice::MollerTrumbore,
        ..Methods::default()
    };
    let renderer = methods::renderer(&scene, Settings { methods, ..Settings::of(&scene) });
    let mut film = renderer.film();
    renderer.add_samples(&mut film, 4);
    let (a, b) = (mean(&film.picture()), mean(&first));
    assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
}
