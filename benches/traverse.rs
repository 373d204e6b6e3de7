//! The hierarchy alone: building it, and every way through it, as the time of one ray.
//!
//! The rays are those of `octray rays` on a knot of 20,000 triangles at 240×135: from the camera, to find
//! shadows, and from bounces. Before a way is timed, its hits are held against those of one scalar ray at a
//! time, bit by bit.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput};
use octray_engine::lane::NATIVE_WIDTH;
use octray_engine::math::MISS;
use octray_engine::rays::{Geometry, Structure, Tracer, Traversal};
use octray_engine::render::TraversalChoice;
use octray_formats::scene;
use octray_laboratory::measure::ray_sets::{Answers, Kind, RaySet, RaysWithHits};
use octray_laboratory::measure::rays;
use octray_laboratory::measure::trace::{Accelerators, TracePool};
use octray_laboratory::methods::{self, MethodTests, TriangleMethod};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

const SCENE: &str = "builtin:knot:20000";
const SIZE: [u32; 2] = [240, 135];

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800))
        .configure_from_args();
    let scene = scene::load(SCENE).expect("a scene inside the program");

    let geometry = scene.geometry();

    let mut group = criterion.benchmark_group("build");
    group.throughput(Throughput::Elements(scene.triangles.len() as u64));
    group.bench_function("all-threads", |bencher| {
        bencher.iter(|| Structure::tree_for_all(black_box(&geometry)))
    });
    group.finish();

    let structures = Accelerators::new(&geometry, Structure::tree_for_all(&geometry));
    let pool = TracePool::new(1);
    let sets = rays::prepare(
        &scene,
        &scene.overview().expect("the scene has an outside"),
        &structures,
        &pool,
        SIZE,
        0,
    );
    for rays in &sets {
        let kind = rays.set.kind;
        let mut group = criterion.benchmark_group(kind.name());
        group.throughput(Throughput::Elements(rays.set.len() as u64));
        for traversal in Traversal::ALL {
            // Rays that do not run together have no frustum: `packet` is `stream` then.
            if traversal == Traversal::Packet && kind != Kind::Primary {
                continue;
            }
            let way = TraversalChoice::Through(traversal);
            let mut answers = Answers::none(&rays.set);
            trace(way, &pool, &structures, rays, &mut answers);
            check(way, rays, &answers);
            group.bench_function(BenchmarkId::from_parameter(way.name()), |bencher| {
                bencher.iter(|| trace(way, &pool, &structures, black_box(rays), &mut answers));
            });
        }
        group.finish();
    }
    for rays in sets.iter().filter(|rays| !rays.set.kind.any_hit()) {
        let mut group = criterion.benchmark_group(format!("{}-by-triangle-method", rays.set.kind.name()));
        group.throughput(Throughput::Elements(rays.set.len() as u64));
        by_method::<methods::Woop>(&mut group, "woop", &geometry, &rays.set);
        by_method::<methods::WoopContracted>(&mut group, "woop-contracted", &geometry, &rays.set);
        by_method::<methods::MollerTrumbore>(&mut group, "moller-trumbore", &geometry, &rays.set);
        by_method::<methods::BaldwinWeber>(&mut group, "baldwin-weber", &geometry, &rays.set);
        by_method::<methods::Plucker>(&mut group, "plucker", &geometry, &rays.set);
        group.finish();
    }
    criterion.final_summary();
}

/// Times a triangle method in the same hierarchy as the others.
fn by_method<T: TriangleMethod>(
    group: &mut BenchmarkGroup<WallTime>,
    name: &str,
    geometry: &Geometry,
    set: &RaySet,
) {
    let tests = Arc::new(MethodTests::<methods::Robust, T>::new(geometry));
    let structure = Structure::tree_with(geometry, tests, NATIVE_WIDTH);
    let mut tracer = Tracer::new();
    group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
        bencher.iter(|| {
            let mut answers = Answers::none(set);
            tracer.improve::<false>(&structure, &set.rays(), &mut answers.hits());
            answers
        });
    });
}

fn trace(
    way: TraversalChoice,
    pool: &TracePool,
    structures: &Accelerators,
    rays: &RaysWithHits,
    answers: &mut Answers,
) {
    pool.clear(&rays.set, answers);
    pool.trace(way, structures, &rays.set, answers, rays.set.kind.any_hit());
}

/// # Panics
/// If the way finds other hits than one scalar ray at a time.
fn check(way: TraversalChoice, rays: &RaysWithHits, answers: &Answers) {
    let (kind, nearest) = (rays.set.kind, &rays.nearest);
    assert!(nearest.count() > rays.set.len() / 100, "{}: {} hits are too few", kind.name(), nearest.count());
    if kind.any_hit() {
        let hit = |answers: &Answers| -> Vec<bool> {
            answers.primitive.iter().map(|&primitive| primitive != MISS).collect()
        };
        assert!(hit(answers) == hit(nearest), "{}: {} hits otherwise", kind.name(), way.name());
    } else {
        assert!(answers == nearest, "{}: {} hits otherwise", kind.name(), way.name());
    }
}
