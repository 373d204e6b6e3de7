//! Frames of the built-in scenes on one thread, at each width that `octray bench` measures on this machine:
//! one sample per pixel at 240×135, up to 4 bounces.
//!
//! Before a scene is timed, its frame is held against what is known of it: so many primary hits, so many
//! rays, and the same picture from every width, bit by bit. An engine that skips work fails here instead of
//! looking fast.

use criterion::{BatchSize, Criterion, Throughput};
use octray_engine::lane::WIDTHS;
use octray_engine::render::{Renderer, Settings};
use octray_formats::scene;
use std::time::Duration;

/// What sample 0 at seed 0 finds in a scene.
struct Expected {
    scene: &'static str,
    primary_hits: u64,
    rays: u64,
}

/// Taken from a run of the release build, and checked in a build without FMA. Mend a line only when a scene
/// or the meaning of a random number has changed; never for a change that was meant to be one of speed.
const EXPECTED: [Expected; 9] = [
    Expected { scene: "thesis", primary_hits: 32_400, rays: 59_478 },
    Expected { scene: "three", primary_hits: 21_466, rays: 63_589 },
    Expected { scene: "spheres", primary_hits: 22_770, rays: 98_289 },
    Expected { scene: "cornell", primary_hits: 32_400, rays: 200_964 },
    Expected { scene: "cornell-spheres", primary_hits: 32_400, rays: 204_688 },
    Expected { scene: "balls", primary_hits: 26_888, rays: 75_747 },
    Expected { scene: "materials", primary_hits: 24_776, rays: 94_322 },
    Expected { scene: "chess", primary_hits: 32_400, rays: 46_589 },
    Expected { scene: "far", primary_hits: 15_282, rays: 56_336 },
];

/// Builds with and without FMA round differently: so many rays at silhouettes may fall on the other side.
const HITS_TOLERANCE: u64 = 4;
/// A path that turns off at a silhouette may end some bounces earlier or later: one ray in a thousand.
const RAYS_TOLERANCE: f64 = 1e-3;

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1_500))
        .configure_from_args();
    let scenes: Vec<Ready> = scene::builtin_names().map(Ready::new).collect();
    let faults: Vec<String> = scenes.iter().filter_map(|scene| scene.check().err()).collect();
    assert!(faults.is_empty(), "nothing is timed before this is mended:\n{}", faults.join("\n"));
    for scene in &scenes {
        let mut group = criterion.benchmark_group(format!("frame/{}", scene.name));
        group.throughput(Throughput::Elements(scene.engines[0].1.rays));
        for (renderer, _) in &scene.engines {
            // Sample 0 every time: the frame that was checked.
            group.bench_function(format!("{}-lanes", renderer.settings().lanes), |bencher| {
                bencher.iter_batched_ref(
                    || renderer.film(),
                    |film| renderer.add_samples(film, 1),
                    BatchSize::PerIteration,
                );
            });
        }
        group.finish();
    }
    criterion.final_summary();
}

/// A scene made ready for each width, the widest first, and what each sees in it.
struct Ready {
    name: &'static str,
    engines: Vec<(Renderer, Frame)>,
}

/// What sample 0 gave.
#[derive(PartialEq)]
struct Frame {
    primary_hits: u64,
    rays: u64,
    picture_bits: Vec<[u32; 3]>,
}

impl Ready {
    fn new(name: &'static str) -> Self {
        let scene = scene::load(&format!("builtin:{name}")).expect("the scenes inside the program load");
        let engines = WIDTHS.into_iter().rev().map(|lanes| {
            let settings = Settings {
                resolution: [240, 135],
                max_bounces: 4,
                lanes,
                threads: 1,
                ..Settings::of(&scene)
            };
            let renderer = Renderer::new(&scene, settings);
            let first = Frame::first(&renderer);
            (renderer, first)
        });
        Self { name, engines: engines.collect() }
    }

    /// Holds the first frames against each other and against [`EXPECTED`].
    fn check(&self) -> Result<(), String> {
        let Self { name, engines } = self;
        let [(_, simd), .., (_, scalar)] = &engines[..] else { unreachable!("packets and scalar") };
        let line = |frame: &Frame| {
            let Frame { primary_hits, rays, .. } = frame;
            format!("Expected {{ scene: {name:?}, primary_hits: {primary_hits}, rays: {rays} }},")
        };
        if let Some((renderer, frame)) = engines.iter().find(|(_, frame)| frame != scalar) {
            let (lanes, wrong, right) = (renderer.settings().lanes, line(frame), line(scalar));
            return Err(format!("frames of {lanes} lanes and of one differ:\n    {wrong}\n    {right}"));
        }
        let found = line(simd);
        let Some(expected) = EXPECTED.iter().find(|expected| expected.scene == *name) else {
            return Err(format!(
                "not in the table of expected counts; if the picture is right, add\n    {found}"
            ));
        };
        let hits_off = simd.primary_hits.abs_diff(expected.primary_hits);
        let rays_off = simd.rays.abs_diff(expected.rays) as f64 / expected.rays as f64;
        if hits_off > HITS_TOLERANCE || rays_off > RAYS_TOLERANCE {
            return Err(format!(
                "off by {hits_off} primary hits ({HITS_TOLERANCE} allowed) and {:.3} % of the rays ({} % allowed); found\n    {found}",
                rays_off * 100.0,
                RAYS_TOLERANCE * 100.0
            ));
        }
        Ok(())
    }
}

impl Frame {
    fn first(renderer: &Renderer) -> Self {
        let hits = renderer.primary_hits(0);
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 1);
        Self {
            primary_hits: hits.iter().filter(|hit| hit.t.is_finite()).count() as u64,
            rays: film.rays(),
            picture_bits: film.picture().pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect(),
        }
    }
}
