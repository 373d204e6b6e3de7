//! The law of one picture: its bits depend on the scene, resolution, bounces, seed and methods, and on
//! nothing else: not on lanes, threads, tiles, or in how many calls the samples are taken.

use crate::common::*;
use octray::integrate::pipeline_for;
use octray::render::RenderObserver;
use octray::scene::{LightShape, Portal, PunctualLight, builtin_names};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

fn colored(rng: &mut Rng, kinds: impl IntoIterator<Item = MaterialKind>) -> Vec<Material> {
    let mut color = || vec3(rng.unit() as f32, rng.unit() as f32, rng.unit() as f32) * 0.5 + 0.5;
    kinds.into_iter().map(|kind| Material { color: color(), ..material(kind) }).collect()
}

/// Spheres and triangles in front of the camera, wearing the materials by turns.
fn furnished(rng: &mut Rng, materials: Vec<Material>, spheres: usize, triangles: usize, uvs: bool) -> Scene {
    let count = materials.len();
    let mut scene = Scene { camera: camera(vec3(0.3, 0.8, 6.0), Vec3::ZERO, 45.0), materials, ..empty() };
    for i in 0..spheres {
        let center = (rng.in_cube() * 2.0).as_vec3();
        let ball = sphere(center, rng.scale(0.3, 0.9) as f32, (i % count) as u32);
        let texture_side = [Side::Outside, Side::Inside][i % 2];
        scene.spheres.push(Sphere { texture_turn: rng.unit() as f32, texture_side, ..ball });
    }
    for i in 0..triangles {
        let center = rng.in_cube() * 2.0;
        let vertices = [(); 3].map(|()| (center + rng.in_cube() * 1.5).as_vec3());
        scene.triangles.push(triangle(vertices, ((i + 1) % count) as u32));
        if uvs {
            scene.uvs.push([(); 3].map(|()| vec2(3.0 * rng.signed() as f32, 3.0 * rng.signed() as f32)));
        }
    }
    // A floor, so that paths bounce.
    if triangles > 0 {
        scene.triangles.push(triangle(ground(20.0, -2.0), 0));
        if uvs {
            scene.uvs.push([Vec2::ZERO, vec2(20.0, 0.0), vec2(0.0, 20.0)]);
        }
    }
    scene
}

/// A lamp that paths look for, the first sphere, beside triangles that shine with a picture, which they do
/// not look for.
fn lamp_and_sign() -> Scene {
    let mut rng = Rng(88);
    let sign = Material { texture: Some(0), ..lamp(2.0) };
    let materials = vec![lamp(9.0), sign, material(Diffuse)];
    let mut scene = furnished(&mut rng, materials, 3, 5, true);
    scene.textures = vec![noise(&mut rng, 8, 8, Filter::Nearest)];
    scene.spheres.iter_mut().skip(1).for_each(|sphere| sphere.material = 2);
    scene.triangles.iter_mut().for_each(|triangle| triangle.material = triangle.material.clamp(1, 2));
    Scene { sky: Sky::Color(Vec3::ZERO), ..scene }
}

/// A ball that fills the view, in a dome that shines with a picture: every path ends there after one bounce.
fn ball_in_a_dome() -> Scene {
    Scene {
        camera: camera(Vec3::Z * 6.0, Vec3::ZERO, 45.0),
        materials: vec![material(Diffuse), Material { texture: Some(0), ..lamp(2.0) }],
        spheres: vec![sphere(Vec3::ZERO, 5.0, 0), sphere(Vec3::ZERO, 50.0, 1)],
        textures: vec![noise(&mut Rng(31), 8, 8, Filter::Nearest)],
        ..empty()
    }
}

/// So many triangles that they go through the hierarchy, and fewer.
const CROWD: usize = 61;
const FEW: usize = 12;

/// Every kind of everything, more of it than fits a register table.
fn everything(triangles: usize) -> Scene {
    let mut rng = Rng(51);
    let kinds = [Diffuse, Diffuse, Diffuse, Emitter].into_iter().chain(KINDS);
    let mut materials = colored(&mut rng, kinds);
    materials[0].texture = Some(0);
    materials[0].normal_map = Some(2);
    materials[1].texture = Some(1);
    materials[1].opacity = 0.6;
    materials[4].opacity_map = Some(1);
    materials[2].emission = vec3(0.2, 0.1, 0.4);
    materials[3].emission = vec3(3.0, 2.0, 1.0);
    materials[3].texture = Some(0);
    // Metal, smooth and rough; glass; the fuzzy mirror; rough plastic; and what lies between.
    materials[5].normal_map = Some(1);
    materials[6].roughness_map = Some(2);
    materials[8].normal_map = Some(2);
    materials[10].texture = Some(1);
    materials[10].roughness_map = Some(1);
    materials[12].roughness_map = Some(0);
    materials[13].emission = vec3(0.3, 0.2, 0.1);
    materials[13].emission_map = Some(2);
    materials[14].roughness_map = Some(1);
    materials[14].normal_map = Some(1);
    materials[13].extras.clearcoat = 0.5;
    materials[14].extras.transmission = 0.7;
    materials[15].extras.attenuation = Some(Attenuation { color: vec3(0.2, 0.6, 0.8), distance: 2.0 });
    materials[15].roughness_map = Some(1);
    let mut scene = furnished(&mut rng, materials, 20, triangles, true);
    // Every other triangle is smooth.
    scene.normals = (0..scene.triangles.len())
        .map(|i| [(); 3].map(|()| if i % 2 == 0 { rng.direction().as_vec3() } else { Vec3::ZERO }))
        .collect();
    scene.textures = vec![
        noise(&mut rng, 5, 3, Filter::Nearest),
        noise(&mut rng, 4, 7, Filter::Bilinear),
        noise(&mut rng, 16, 8, Filter::Trilinear),
    ];
    scene.textures[0].wrap = [Wrap::Clamp, Wrap::Mirror];
    scene.textures[1].wrap = [Wrap::Mirror, Wrap::Clamp];
    scene.sky = Sky::Texture { texture: 2, color: vec3(1.0, 0.9, 0.8), turn: 0.4 };
    // Two openings that overlap.
    scene.portals = [Vec3::ZERO, vec3(0.4, 0.0, 0.3)]
        .map(|at| Portal {
            vertices: [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(|[x, z]| at + vec3(x as f32, 2.0, -z as f32)),
        })
        .into();
    let (position, intensity, range) = (vec3(0.5, 1.5, 1.0), vec3(2.0, 1.0, 0.5), 9.0);
    let (direction, irradiance) = (vec3(0.3, -1.0, -0.2), vec3(0.5, 0.7, 0.9));
    scene.lights = [
        LightShape::Point { position, intensity, range },
        LightShape::Spot { position, direction, intensity, range, inner_degrees: 9.0, outer_degrees: 60.0 },
        LightShape::Directional { direction, irradiance, angular_diameter_degrees: 0.0 },
        LightShape::Directional { direction, irradiance, angular_diameter_degrees: 30.0 },
    ]
    .map(PunctualLight::from)
    .into();
    scene
}

/// What the pipeline for matt and mirroring spheres draws.
fn matt_and_mirror() -> Scene {
    let mut rng = Rng(52);
    let materials = colored(&mut rng, [Diffuse, Metal { roughness: 0.0 }, Diffuse]);
    Scene {
        sky: Sky::Gradient { bottom: Vec3::ONE, top: vec3(0.5, 0.7, 1.0) },
        ..furnished(&mut rng, materials, 7, 0, false)
    }
}

/// A handful of spheres and triangles with nearest textures: the thesis's kind of scene.
fn few_textured() -> Scene {
    let mut rng = Rng(53);
    let [fuzzy, metal] = [FuzzyMirror { roughness: 1.5 }, Metal { roughness: 0.0 }];
    let mut materials = colored(&mut rng, [Diffuse, fuzzy, Emitter, metal]);
    materials[0].texture = Some(0);
    materials[2].emission = Vec3::splat(2.0);
    let textures = vec![noise(&mut rng, 6, 6, Filter::Nearest)];
    Scene { textures, sky: Sky::Color(vec3(0.4, 0.5, 0.6)), ..furnished(&mut rng, materials, 6, 2, true) }
}

/// Triangles alone, without texture coordinates, under a sky that is read at the nearest texel.
fn triangles_alone() -> Scene {
    let mut rng = Rng(54);
    let mut materials = colored(&mut rng, [Diffuse, Glass { ior: 1.3 }]);
    materials[1].emission = vec3(0.0, 0.3, 0.0);
    let textures = vec![noise(&mut rng, 9, 5, Filter::Nearest)];
    let sky = Sky::Texture { texture: 0, color: Vec3::ONE, turn: 0.0 };
    Scene { textures, sky, ..furnished(&mut rng, materials, 0, 25, false) }
}

/// A tilted mirror, seen so much from the side that rounding points some reflections below it, and behind it
/// a red light that shows what starts below the mirror.
fn grazed_mirror() -> Scene {
    let materials = vec![material(Metal { roughness: 0.0 }), emitter(Vec3::X * 5.0)];
    let along = vec3(0.6, 0.3, -0.7).normalize();
    let across = along.cross(vec3(0.2, 0.9, 0.1)).normalize();
    let above = across.cross(along);
    let point =
        |forwards: f32, sideways: f32, height: f32| along * forwards + across * sideways + above * height;
    let far = 1e5;
    let mirror = [point(-far, -far, 0.0), point(far, 3.0 * far, 0.0), point(far, -3.0 * far, 0.0)];
    // Paths leave the mirror about one unit from it; the light ends a little below it.
    let light =
        [point(2.0 * far, -3.0 * far, -0.4), point(2.0 * far, 3.0 * far, -0.4), point(2.0 * far, 0.0, -far)];
    let position = point(0.0, 0.0, 1e-3);
    Scene {
        camera: Camera::pinhole(position, position + along * 100.0, above, 5e-5),
        materials,
        triangles: vec![triangle(mirror, 0), triangle(light, 1)],
        ..empty()
    }
}

fn scenes() -> [Scene; 6] {
    [
        everything(FEW),
        everything(CROWD),
        matt_and_mirror(),
        few_textured(),
        triangles_alone(),
        lamp_and_sign(),
    ]
}

/// A picture's bits, and how many rays it took.
#[derive(PartialEq)]
struct Print {
    pixels: Vec<[u32; 3]>,
    rays: u64,
}

impl Print {
    /// Takes the samples in so many calls.
    fn of(scene: &Scene, settings: Settings, calls: &[u32]) -> Self {
        let renderer = methods::renderer(scene, settings);
        let mut film = renderer.film();
        calls.iter().for_each(|&samples| renderer.add_samples(&mut film, samples));
        assert_eq!(film.discarded(), 0, "{settings:?}");
        assert_eq!(film.samples(), calls.iter().sum::<u32>());
        Self { pixels: bits(&film.picture()), rays: film.rays() }
    }
}

/// Asserts that with each of these settings, so many samples in each call give the picture and the rays of
/// all samples at once with `base`.
#[track_caller]
fn assert_same(scene: &Scene, base: Settings, calls: &[u32], others: impl IntoIterator<Item = Settings>) {
    let expected = Print::of(scene, base, &[calls.iter().sum()]);
    for settings in others {
        let found = Print::of(scene, settings, calls);
        let differs = expected.pixels.iter().zip(&found.pixels).position(|(a, b)| a != b);
        let place = differs.map(|index| places(settings.resolution).nth(index));
        let same_rays = expected.rays == found.rays;
        assert!(
            place.is_none() && same_rays,
            "{settings:?}, calls {calls:?}: {place:?} differs; {same_rays}"
        );
    }
}

/// With tiles of 11 columns the last one begins between two blocks and is a whole block wide.
const TILES: [[u32; 2]; 6] = [[1, 1], [7, 3], [16, 16], [32, 8], [240, 1], [11, 19]];

fn base(scene: &Scene, resolution: [u32; 2], max_bounces: u32) -> Settings {
    Settings { resolution, max_bounces, seed: 5, lanes: 1, threads: 1, ..Settings::of(scene) }
}

#[test]
fn test_scenes_need_every_feature_together() {
    let needs = |scene: &Scene| Renderer::new(scene, Settings::of(scene)).needs();
    // The law of cameras has those that are no pinholes.
    let all = needs(&everything(CROWD)).with(Features::SKY_GRADIENT).with(Features::RAY_ORIGINS);
    assert!(all.contains(Features::ALL), "{:?}", all.names());
    assert!(needs(&matt_and_mirror()).contains(Features::SKY_GRADIENT));
    assert!(!needs(&few_textured()).contains(Features::MANY_TRIANGLES));
    assert!(!needs(&everything(FEW)).contains(Features::HIERARCHY));
}

#[test]
fn picture_is_the_same_for_all_lanes_threads_tiles_and_calls() {
    for scene in scenes() {
        // Every width, tile and number of threads, not every combination.
        check_ways(&scene, |threads, tile, call| threads == 1 + (tile + call) % 3 && call == tile % 2);
    }
    check_ways(&everything(FEW), |threads, tile, call| call == (threads + tile) % 2);
}

#[test]
#[ignore = "minutes: run by .ci/run"]
fn picture_is_the_same_for_every_combination_of_lanes_threads_tiles_and_calls() {
    for scene in scenes() {
        check_ways(&scene, |_, _, _| true);
    }
    check_ways(&everything(FEW), |threads, tile, call| call == (threads + tile) % 2);
}

/// Renders at every width with those combinations of threads, tiles and calls (by their numbers) that are
/// wanted.
fn check_ways(scene: &Scene, wanted: impl Fn(usize, usize, usize) -> bool) {
    let base = base(scene, [37, 23], 4);
    for (call, calls) in [&[8][..], &[3, 5]].into_iter().enumerate() {
        let mut others = Vec::new();
        for (lanes, threads) in WIDTHS.into_iter().flat_map(|lanes| [1, 2, 3].map(|threads| (lanes, threads)))
        {
            let tiles = TILES.into_iter().enumerate().filter(|&(tile, _)| wanted(threads, tile, call));
            others.extend(tiles.map(|(_, tile_size)| Settings { lanes, threads, tile_size, ..base }));
        }
        assert_same(scene, base, calls, others);
    }
}

/// Where culling begins depends on the width and the method.
#[test]
fn picture_is_the_same_for_all_lanes_with_every_number_of_spheres() {
    for count in 1..=20 {
        let materials = vec![material(Diffuse), material(Metal { roughness: 0.0 })];
        let scene = furnished(&mut Rng(60 + count as u64), materials, count, 0, false);
        for choice in SphereChoice::ALL {
            let mut scalar = base(&scene, [48, 32], 4);
            scalar.methods.sphere = choice;
            assert_same(&scene, scalar, &[2], WIDTHS.map(|lanes| Settings { lanes, ..scalar }));
        }
    }
}

#[test]
fn picture_is_the_same_however_many_tiles_are_traced_together() {
    // One thread traces five of these tiles together, six threads one. Paths of three tiles fill the queue if
    // they all go on.
    for scene in [everything(FEW), ball_in_a_dome(), lamp_and_sign(), matt_and_mirror(), everything(CROWD)] {
        for max_bounces in [1, 2, 6] {
            let alone = Settings { threads: 6, lanes: 8, ..base(&scene, [160, 140], max_bounces) };
            let together = |lanes| Settings { threads: 1, lanes, ..alone };
            assert_same(&scene, alone, &[1], WIDTHS.map(together));
        }
    }
}

#[test]
fn tiles_with_different_numbers_of_samples_are_those_of_films_with_one() {
    let scene = few_textured();
    let renderer = Renderer::new(&scene, Settings { lanes: 8, ..base(&scene, [160, 140], 4) });
    let films = [0, 1, 2, 3].map(|samples| {
        let mut film = renderer.film();
        renderer.add_samples(&mut film, samples);
        film
    });
    let mut mixed = renderer.film();
    // Runs of two, three and five tiles, so that some groups are equal and others are not.
    let goal = |tile: usize| [1, 1, 3, 3, 3, 2, 2, 2, 2, 2][tile % 10];
    for round in 1..=2 {
        renderer.sample_tiles_to(&mut mixed, |tile, _| goal(tile).min(2 * round), &());
    }
    let check = |mixed: &Film, goal: &dyn Fn(usize) -> u32| {
        for (tile, sums) in mixed.tiles().iter().enumerate() {
            let same = &films[goal(tile) as usize].tiles()[tile];
            assert_eq!(sums.samples, goal(tile));
            for slot in 0..sums.tile.pixels() {
                assert_eq!(sums.mean(slot).map(f64::to_bits), same.mean(slot).map(f64::to_bits), "{tile}");
            }
        }
    };
    check(&mixed, &goal);
    // The same goal, but not as many samples to begin with.
    renderer.sample_tiles_to(&mut mixed, |_, _| 3, &());
    check(&mixed, &|_| 3);
}

/// Stops after so many calls, each for a sample of the tiles that are traced together.
struct StopAfter {
    calls: AtomicU32,
    rays: AtomicU64,
}

impl RenderObserver for StopAfter {
    fn is_cancelled(&self) -> bool {
        self.calls.load(Ordering::SeqCst) == 0
    }
    fn sample_done(&self, _pixels: usize, rays: u64) {
        // Other threads may be at work on one more when the last one is counted.
        let _ = self.calls.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |left| left.checked_sub(1));
        self.rays.fetch_add(rays, Ordering::SeqCst);
    }
}

#[test]
fn picture_that_was_stopped_midway_is_of_whole_samples_and_goes_on_to_the_same() {
    let scene = everything(FEW);
    // 156 tiles: one thread traces eight together, two four, three three.
    let base = Settings { tile_size: [3, 2], lanes: 8, ..base(&scene, [37, 23], 4) };
    let prints: Vec<Print> = (0..=5).map(|samples| Print::of(&scene, base, &[samples])).collect();
    for (threads, calls) in [(1, 0), (1, 1), (1, 17), (2, 30), (1, 70), (3, 150)] {
        let renderer = Renderer::new(&scene, Settings { threads, ..base });
        let mut film = renderer.film();
        let watch = StopAfter { calls: calls.into(), rays: 0.into() };
        renderer.add_samples(&mut film, 1);
        renderer.add_samples_observed(&mut film, 4, &watch);
        let (least, most) = (film.samples(), film.most_samples());
        assert!(least >= 1 && most <= 5 && (calls == 0) == (most == 1), "{least} to {most} samples");
        assert!(least < 5, "it was stopped");
        for (index, pixel) in bits(&film.picture()).into_iter().enumerate() {
            let known = (least..=most).any(|samples| prints[samples as usize].pixels[index] == pixel);
            assert!(known, "pixel {index} is not that of {least} to {most} samples");
        }
        assert_eq!(film.rays(), prints[1].rays + watch.rays.into_inner(), "what was taken was counted");
        renderer.add_samples(&mut film, 5 - least);
        assert_eq!((film.samples(), film.most_samples()), (5, 5));
        let end = Print { pixels: bits(&film.picture()), rays: film.rays() };
        assert!(end == prints[5], "{threads} threads, {calls} calls");
    }
}

#[test]
fn picture_is_the_same_from_the_pipeline_with_every_feature() {
    let builtin = builtin_names().map(|name| load(&format!("builtin:{name}")).unwrap());
    let mut specialised = 0;
    for scene in builtin.chain(scenes()).chain([grazed_mirror()]) {
        for lanes in WIDTHS {
            let needed = Settings { lanes, ..base(&scene, [61, 37], 6) };
            let general = Settings { pipeline: PipelineChoice::General, ..needed };
            assert_same(&scene, needed, &[5], [general]);
            let pipelines = [Features::of(&scene), Features::ALL].map(|needs| pipeline_for(needs, lanes).0);
            specialised += u32::from(pipelines[0] != pipelines[1]);
        }
    }
    // The test means something only where there are two pipelines.
    assert!(specialised >= 8, "only {specialised} scenes and widths have a pipeline of their own");
}

#[test]
fn picture_is_the_same_at_odd_resolutions_and_every_number_of_bounces() {
    for scene in [everything(FEW), matt_and_mirror(), few_textured(), triangles_alone()] {
        for resolution in [[37, 23], [1, 1], [9, 1], [1, 9]] {
            for max_bounces in [0, 1, 4, 20] {
                let base = base(&scene, resolution, max_bounces);
                let others = [(1, [16, 16]), (2, [7, 3]), (3, [1, 1])];
                let others =
                    others.map(|(threads, tile_size)| Settings { lanes: 8, threads, tile_size, ..base });
                assert_same(&scene, base, &[1, 3], others);
            }
        }
    }
}

#[test]
fn picture_is_the_same_for_all_lanes_with_every_choice_of_methods() {
    let scene = everything(FEW);
    let of_triangle = |triangle| SphereChoice::ALL.map(|sphere| (sphere, triangle));
    for traversal in [TraversalChoice::Linear, TraversalChoice::Through(Traversal::Hybrid)] {
        for (sphere, triangle) in TriangleChoice::ALL.into_iter().flat_map(of_triangle) {
            let methods = Methods { sphere, triangle, traversal, ..Methods::default() };
            let base = Settings { methods, ..base(&scene, [37, 23], 4) };
            let settings = Settings { lanes: 8, threads: 2, tile_size: [7, 3], ..base };
            assert_same(&scene, base, &[2], [settings]);
        }
    }
}

#[test]
fn picture_is_the_same_through_every_traversal() {
    for scene in scenes() {
        let by = |traversal, lanes| Settings {
            methods: Methods { traversal, ..Methods::default() },
            lanes,
            ..base(&scene, [37, 23], 4)
        };
        let through = Traversal::ALL.map(TraversalChoice::Through);
        let all = through.into_iter().chain([TraversalChoice::Linear, TraversalChoice::Auto]);
        let others = all.flat_map(|traversal| WIDTHS.map(|lanes| by(traversal, lanes)));
        assert_same(&scene, by(TraversalChoice::Linear, 1), &[4], others);
    }
}

#[test]
fn primary_hits_are_the_same_for_all_lanes_and_tiles() {
    for scene in [everything(FEW), triangles_alone()] {
        let hits = |lanes, tile_size| {
            let settings = Settings { lanes, tile_size, ..base(&scene, [37, 23], 0) };
            let mut hits = Renderer::new(&scene, settings).primary_hits(3);
            hits.sort_by_key(|hit| (hit.y, hit.x));
            hits
        };
        let expected = hits(1, [16, 16]);
        assert_eq!(expected.len(), 37 * 23);
        for tile_size in TILES {
            assert_eq!(hits(8, tile_size), expected, "{tile_size:?}");
        }
    }
}

#[test]
fn seed_samples_and_bounces_change_the_picture() {
    let scene = everything(FEW);
    let base = base(&scene, [37, 23], 4);
    let one = Print::of(&scene, base, &[8]);
    // At the fifth segment most paths have ended.
    for (other, calls, least) in [
        (Settings { seed: 6, ..base }, 8, 0.5),
        (base, 7, 0.5),
        (Settings { max_bounces: 1, ..base }, 8, 0.2),
        (Settings { max_bounces: 3, ..base }, 8, 0.03),
    ] {
        let other = Print::of(&scene, other, &[calls]);
        let differ = one.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count();
        assert!(differ as f64 > least * one.pixels.len() as f64, "only {differ} pixels differ");
    }
}
