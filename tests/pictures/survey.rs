//! What the survey tells of pixels: guides against primary rays and the scene itself, costs against the
//! tallies of whole frames, shapes of paths against the counts of rays.

use crate::common::*;
use octray::integrate::aovs::Aovs;
use octray::render::aovs::Map;

const SIZE: [u32; 2] = [61, 35];

fn settings(scene: &Scene) -> Settings {
    Settings { resolution: SIZE, ..Settings::of(scene) }
}
fn guides_of(renderer: &Renderer) -> Aovs {
    let mut guides = Aovs::default();
    renderer.aovs_into(&mut guides);
    guides
}
fn scenes() -> impl Iterator<Item = Scene> {
    let names = octray::scene::builtin_names().map(|name| format!("builtin:{name}"));
    names.chain(["builtin:knot:3000".to_string()]).map(|name| load(&name).unwrap())
}

/// The middle of a pixel lies among the points that samples go through: what most samples of a pixel see, its
/// guide sees, but at edges.
#[test]
fn guides_are_what_primary_rays_see() {
    for scene in scenes() {
        let renderer = Renderer::new(&scene, settings(&scene));
        let guides = guides_of(&renderer);
        let (mut agree, mut all) = (0, 0);
        for hit in (0..4).flat_map(|sample| renderer.primary_hits(sample)) {
            let guide = guides.pixel(hit.x, hit.y);
            all += 1;
            if (hit.primitive == MISS) != (guide.object == MISS) {
                continue;
            }
            if guide.object == MISS {
                assert_eq!((guide.distance, guide.normal), (f32::INFINITY, glam::Vec3::ZERO));
            } else {
                assert!((guide.normal.length() - 1.0).abs() < 1e-5, "{}", scene.name);
                let forward = scene.camera.look_at - scene.camera.position;
                let toward = guide.normal.dot(forward.normalize());
                assert!(toward < 0.99, "normals face the camera: {toward}");
                if (hit.t / guide.distance - 1.0).abs() > 0.1 {
                    continue;
                }
            }
            let mut shares = guide.albedo.iter().chain([&guide.lobe]);
            assert!(shares.all(|share| (0.0..=1.0).contains(share)), "{}: {guide:?}", scene.name);
            agree += 1;
        }
        assert!(agree * 100 > all * 88, "{}: {agree} of {all}", scene.name);
    }
}

#[test]
fn guides_do_not_depend_on_threads_tiles_or_the_way_rays_go() {
    for scene in scenes() {
        let way =
            |traversal| Settings { methods: Methods { traversal, ..Methods::default() }, ..settings(&scene) };
        let linear = guides_of(&Renderer::new(&scene, way(TraversalChoice::Linear)));
        for traversal in Traversal::ALL {
            let plain = way(TraversalChoice::Through(traversal));
            let settings = Settings { threads: 3, lanes: traversal.lanes(), tile_size: [8, 5], ..plain };
            let other = guides_of(&Renderer::new(&scene, settings));
            for (x, y) in places(SIZE) {
                assert_eq!(linear.pixel(x, y), other.pixel(x, y), "{} {traversal:?} {x} {y}", scene.name);
            }
        }
    }
}

#[test]
fn materials_show_in_guides() {
    let scene = load("builtin:three").unwrap();
    let renderer = Renderer::new(&scene, settings(&scene));
    let guides = guides_of(&renderer);
    let mut seen = std::collections::BTreeMap::new();
    for guide in places(SIZE).map(|(x, y)| guides.pixel(x, y)) {
        seen.entry(guide.object).or_insert(guide);
    }
    for (&object, guide) in seen.iter().filter(|&(&object, _)| object != MISS) {
        let material = &scene.materials[scene.spheres[object as usize].material as usize];
        assert_eq!(guide.albedo, material.color.to_array(), "{}", material.name);
        let mirror = material.kind == Metal { roughness: 0.0 };
        assert_eq!(guide.lobe == 0.0, mirror, "{}", material.name);
        assert_eq!(guide.weights, [0.0; 2]);
    }
    assert_eq!(seen.len(), 4, "three spheres and the sky");
    for (kind, lobe) in [
        (Diffuse, 1.0),
        (Metal { roughness: 0.5 }, 0.25),
        (Metal { roughness: 0.0 }, 0.0),
        (Glass { ior: 1.5 }, 0.0),
        (FuzzyMirror { roughness: 3.0 }, 1.0),
    ] {
        let mut scene = load("builtin:three").unwrap();
        scene.materials.iter_mut().for_each(|material| material.kind = kind);
        let guides = guides_of(&Renderer::new(&scene, settings(&scene)));
        for guide in places(SIZE).map(|(x, y)| guides.pixel(x, y)).filter(|guide| guide.object != MISS) {
            assert_eq!(guide.lobe, lobe, "{kind:?}");
        }
    }
}

/// A view set later is the view that a new renderer has.
#[test]
fn a_camera_set_later_gives_the_bits_of_a_new_renderer() {
    for scene in scenes() {
        let mut other = scene.clone();
        other.camera.position += glam::Vec3::new(0.3, 0.2, -0.1);
        other.camera.vertical_fov *= 0.8;
        let mut moved = Renderer::new(&scene, Settings { threads: 2, ..Settings::of(&scene) });
        moved.add_samples(&mut moved.film(), 2);
        moved.set_view(&other.camera, SIZE, 3);
        let mut film = moved.film();
        moved.add_samples(&mut film, 1);
        film.clear();
        assert_eq!((film.samples(), film.rays(), film.pixel_samples()), (0, 0, 0));
        moved.add_samples(&mut film, 2);
        let of_new = Settings { max_bounces: 3, ..settings(&other) };
        let (new, expected) = (Renderer::new(&other, of_new), self::film(&other, of_new, 2));
        assert_eq!(film.picture(), expected.picture(), "{}", scene.name);
        assert_eq!(film.rays(), expected.rays());
        let (mut guides, expected) = (guides_of(&moved), guides_of(&new));
        assert_eq!(guides.pixel(30, 20), expected.pixel(30, 20));
        moved.set_view(&scene.camera, [7, 5], 3);
        moved.aovs_into(&mut guides);
        assert_eq!(guides.resolution(), [7, 5]);
    }
}

#[test]
fn costs_are_what_rays_are_tested_against() {
    let scene = load("builtin:knot:3000").unwrap();
    for (traversal, boxes) in [(TraversalChoice::Linear, false), (TraversalChoice::Auto, true)] {
        let methods = Methods { traversal, ..Methods::default() };
        let renderer = Renderer::new(&scene, Settings { methods, threads: 2, ..settings(&scene) });
        let mut costs = Map::default();
        renderer.costs_into(&mut costs);
        assert_eq!(costs.pixels.len(), (SIZE[0] * SIZE[1]) as usize);
        let guides = guides_of(&renderer);
        for (cost, (x, y)) in costs.pixels.iter().zip(places(SIZE)) {
            let hit = guides.pixel(x, y).object != MISS;
            assert!(!hit || cost.primitives >= 1, "what was hit was tested");
            assert_eq!(cost.boxes > 0, boxes);
        }
        let most = costs.pixels.iter().map(|cost| cost.primitives).max().unwrap();
        let spread = costs.pixels.iter().any(|cost| cost.primitives < most);
        assert!(spread, "not all pixels cost the same");
        assert_eq!(boxes, most < 300, "{most} tests: a hierarchy spares nearly all");
    }
}

/// Where every primitive is tested, that is those which the pixel's tile can see.
#[test]
fn pixels_of_one_tile_cost_the_same_where_there_is_no_hierarchy() {
    let scene = load("builtin:spheres").unwrap();
    let methods = Methods { traversal: TraversalChoice::Linear, ..Methods::default() };
    let renderer = Renderer::new(&scene, Settings { methods, ..settings(&scene) });
    let mut costs = Map::default();
    renderer.costs_into(&mut costs);
    let at = |x: u32, y: u32| costs.pixels[(y * SIZE[0] + x) as usize];
    let [across, down] = Settings::TILE_SIZE;
    for (x, y) in places(SIZE) {
        assert_eq!(at(x, y), at(x - x % across, y - y % down), "{x} {y}");
    }
    assert!(costs.pixels.iter().any(|cost| *cost != at(0, 0)), "tiles differ");
}

#[test]
fn shapes_of_paths_are_at_their_pixels_whatever_the_tiles() {
    let scene = load("builtin:three").unwrap();
    let segments = |tile_size| {
        let mut shapes = Map::default();
        Renderer::new(&scene, Settings { tile_size, ..settings(&scene) }).path_shapes_into(0, &mut shapes);
        shapes.pixels.iter().map(|shape| shape.segments).collect::<Vec<_>>()
    };
    let each_alone = segments([1, 1]);
    for tile_size in [[16, 16], [7, 5], [64, 1]] {
        assert_eq!(segments(tile_size), each_alone, "tiles of {tile_size:?}");
    }
}

#[test]
fn shapes_of_paths_add_up_to_the_rays_of_the_sample() {
    for lanes in WIDTHS {
        for name in ["builtin:three", "builtin:spheres", "builtin:knot:3000"] {
            let scene = load(name).unwrap();
            let by_chance = with_lights(&scene, LightChoice::Off);
            let settings = Settings { resolution: SIZE, lanes, threads: 2, ..by_chance };
            let renderer = Renderer::new(&scene, settings);
            let mut shapes = Map::default();
            renderer.path_shapes_into(0, &mut shapes);
            let film = film(&scene, settings, 1);
            let rays: u64 = shapes.pixels.iter().map(|shape| u64::from(shape.segments)).sum();
            assert_eq!(rays, film.rays(), "{name}, {lanes} lanes");
            for shape in &shapes.pixels {
                assert!((1..=scene.max_bounces + 1).contains(&shape.segments));
                assert!((shape.segments..=shape.segments * lanes as u32).contains(&shape.lanes));
            }
            if lanes == 1 {
                assert!(shapes.pixels.iter().all(|shape| shape.lanes == shape.segments));
            }
        }
    }
}
