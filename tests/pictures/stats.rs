//! What `--stats` counts is what happens: counts by hand, sums that agree, and nothing else changed by
//! counting.

use crate::common::*;
use octray::integrate::stats::{RayKind, Segment, Stage, Stats};
use octray::measure::stats::FrameStats;
use octray::rays::bvh::check::check_geometry;
use octray::rays::bvh::{Bvh, LEAF, slots};
use octray::rays::traverse::Tracer;
use octray::rays::traverse::counter::{Counts, Tests};
use octray::rays::{Hits, Kind, Rays};

/// Two triangles far from each other in the plane z = 0, around (−3, 0) and (3, 0).
fn two_triangles() -> Scene {
    let around = |x: f32| [vec3(x - 1.0, -1.0, 0.0), vec3(x + 1.0, -1.0, 0.0), vec3(x, 1.0, 0.0)];
    Scene { triangles: [-3.0, 3.0].map(|x| triangle(around(x), 0)).to_vec(), ..diffuse() }
}

/// What is counted for rays that start at (x, 0, 5) and run almost along −z, and how many of them hit
/// something.
fn counted<const ANY: bool>(scene: &Scene, traversal: Traversal, starts: &[f32]) -> (Counts, usize) {
    let hierarchy = Hierarchy::new(&scene.geometry(), Trees::WideAndBinary);
    let count = starts.len();
    let tilt: Vec<f32> = (0..count).map(|at| at as f32 * 1e-3).collect();
    let (zeros, ones) = (vec![0.0; count], vec![-1.0; count]);
    let fives = vec![5.0; count];
    let origin = [starts, &zeros, &fives];
    count_rays::<ANY>(&hierarchy, traversal, &Rays::new(origin, [&tilt, &zeros, &ones]))
}

/// What is counted for these rays, and how many of them hit something.
fn count_rays<const ANY: bool>(hierarchy: &Hierarchy, traversal: Traversal, rays: &Rays) -> (Counts, usize) {
    let (count, mut tracer) = (rays.len(), Tracer::new());
    tracer.start_counting();
    let (mut t, mut primitive) = (vec![f32::INFINITY; count], vec![MISS; count]);
    let [mut u, mut v] = [(); 2].map(|()| vec![0.0; count]);
    let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
    tracer.trace::<ANY>(traversal, hierarchy, rays, &mut hits);
    (tracer.take_counts(), primitive.iter().filter(|&&one| one != MISS).count())
}

fn tests(tests: u64, steps: u64) -> Tests {
    Tests { tests, steps }
}

/// What is counted for the triangles that a tile of 16×16 rays from one point meets: they fill a plane of so
/// many squares a side, of two triangles each.
fn counted_in_tile(squares: usize, traversal: Traversal) -> Tests {
    let corner = |x: usize, y: usize| {
        let [x, y] = [x, y].map(|step| 2.0 * step as f32 / squares as f32 - 1.0);
        vec3(x, y, 0.0)
    };
    let square = |x: usize, y: usize| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [triangle([a, b, c], 0), triangle([a, c, d], 0)]
    };
    let squares = (0..squares).flat_map(|y| (0..squares).flat_map(move |x| square(x, y)));
    let scene = Scene { triangles: squares.collect(), ..diffuse() };
    let hierarchy = Hierarchy::new(&scene.geometry(), Trees::Wide);
    // Blocks of 4×4 rays, as in tiles of primary rays.
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for ray in 0..256 {
        let (block, inside) = (ray / 16, ray % 16);
        x.push(((4 * (block % 4) + inside % 4) as f32 - 7.5) / 38.5);
        y.push(((4 * (block / 4) + inside / 4) as f32 - 7.5) / 38.5);
    }
    let (zeros, fives, ones) = (vec![0.0; 256], vec![5.0; 256], vec![-1.0; 256]);
    let rays = Rays::new([&zeros, &zeros, &fives], [&x, &y, &ones]);
    let (counts, hits) = count_rays::<false>(&hierarchy, traversal, &rays);
    assert_eq!(hits, 256);
    counts.of_kind(Kind::Triangle)
}

/// Of 40 leaves, each of which six rays meet, and of 600, each of which less than one meets.
#[test]
fn tiles_of_small_leaves_are_left_to_streams() {
    let [large, small] = if LEAF == 8 { [11, 45] } else { [16, 64] };
    let [packets, streams] = [Traversal::Packet, Traversal::Stream];
    assert_eq!(counted_in_tile(large, Traversal::Hybrid), counted_in_tile(large, packets));
    assert_eq!(counted_in_tile(small, Traversal::Hybrid), counted_in_tile(small, streams));
    for squares in [large, small] {
        assert_ne!(counted_in_tile(squares, packets), counted_in_tile(squares, streams), "{squares}");
    }
}

#[test]
fn tests_of_two_triangles_are_those_counted_by_hand() {
    let scene = two_triangles();
    let bvh = Hierarchy::new(&scene.geometry(), Trees::WideAndBinary).bvh;
    assert_eq!((bvh.wide[0].filled(), bvh.binary.len()), (1, 1), "both triangles are in one leaf");
    // One ray at the left triangle, one at nothing between them, one past everything: the box for all three,
    // the triangles for two.
    let starts = [-3.0, 0.0, 50.0];
    let none = tests(0, 0);
    let one_by_one = Counts { boxes: tests(3, 3), primitives: [none, tests(4, 4)] };
    assert_eq!(counted::<false>(&scene, Traversal::Scalar, &starts), (one_by_one, 1));
    for traversal in [Traversal::Single, Traversal::Stream, Traversal::Packet, Traversal::Hybrid] {
        let expected = Counts { boxes: tests(3, 3), primitives: [none, tests(4, 2)] };
        assert_eq!(counted::<false>(&scene, traversal, &starts), (expected, 1), "{traversal:?}");
    }
    // A packet that sees the left triangle alone. The frustum of its tile meets the leaf's box, and so does
    // its own, which then is held against both triangles' boxes, in a step each; then all eight rays meet one
    // triangle.
    for traversal in [Traversal::Packet, Traversal::Hybrid] {
        let expected = Counts { boxes: tests(4, 3), primitives: [none, tests(8, 1)] };
        assert_eq!(counted::<false>(&scene, traversal, &[-3.0; 8]), (expected, 8), "{traversal:?}");
    }
}

/// Small triangles where the rays of [`counted`] go at z = 0 and below.
fn small_ones(across: usize, layers: usize) -> Scene {
    let mut scene = diffuse();
    for (i, layer) in (0..across).flat_map(|i| (0..layers).map(move |layer| (i, layer))) {
        let (x, z) = (1.3 * i as f32 / across as f32, -0.01 * layer as f32);
        let corner = |x: f32, y: f32| vec3(x, y, z);
        let size = 0.5 / across as f32;
        scene.triangles.push(triangle([corner(x, -size), corner(x + size, -size), corner(x, size)], 0));
    }
    scene
}

#[test]
fn hybrid_goes_in_streams_where_a_tile_sees_much_and_in_packets_where_it_sees_little() {
    let starts = [0.0; 256];
    for (across, as_one, unlike) in
        [(5000, Traversal::Stream, Traversal::Packet), (20, Traversal::Packet, Traversal::Stream)]
    {
        let scene = small_ones(across, 1);
        let triangles = |traversal| counted::<false>(&scene, traversal, &starts).0.of_kind(Kind::Triangle);
        assert_eq!(triangles(Traversal::Hybrid), triangles(as_one), "{across}");
        assert_ne!(triangles(Traversal::Hybrid), triangles(unlike), "{across}");
    }
}

#[test]
fn packets_leave_out_what_is_behind_a_wall() {
    let starts = [0.0; 64];
    let mut scene = small_ones(40, 10);
    let triangles =
        |scene: &Scene| counted::<false>(scene, Traversal::Packet, &starts).0.of_kind(Kind::Triangle).tests;
    let open = triangles(&scene);
    let wall = [vec3(-9.0, -9.0, 4.0), vec3(9.0, -9.0, 4.0), vec3(0.0, 9.0, 4.0)];
    scene.triangles.push(triangle(wall, 0));
    let behind = triangles(&scene);
    assert!(0 < behind && behind * 4 < open, "{behind} tests of triangles behind a wall, {open} without");
}

#[test]
fn tests_of_a_leaf_are_its_primitives_and_no_empty_lane() {
    // Three spheres so near each other that nothing divides them.
    let spheres: Vec<_> = [0.0, 0.01, 0.02].map(|x| sphere(vec3(x, 0.0, 0.0), 1.0, 0)).into();
    let scene = Scene { spheres, ..diffuse() };
    let boxes = |traversal, starts: &[f32]| counted::<false>(&scene, traversal, starts).0;
    let none = tests(0, 0);
    for traversal in [Traversal::Single, Traversal::Stream] {
        let expected = Counts { boxes: tests(2, 2), primitives: [tests(3, 1), none] };
        assert_eq!(boxes(traversal, &[0.0, 9.0]), expected, "{traversal:?}");
    }
    let expected = Counts { boxes: tests(2, 2), primitives: [tests(3, 3), none] };
    assert_eq!(boxes(Traversal::Scalar, &[0.0, 9.0]), expected);
    let expected = Counts { boxes: tests(2, 2), primitives: [tests(24, 3), none] };
    assert_eq!(boxes(Traversal::Packet, &[0.0; 8]), expected);
}

/// Big triangles across the way of the rays of [`counted`], or big spheres around their start. Every ray hits
/// all of them and starts in all their boxes: nothing but an end at the first hit spares a test.
fn all_in_the_way(count: usize, triangles: bool) -> Scene {
    let mut scene = diffuse();
    for i in 0..count {
        let share = i as f32 / count as f32;
        if triangles {
            // Through (0, 0, z), in a plane as steep as 3 in 10, from below z = 4 to above z = 5.
            let (z, turn) = (4.9 - 0.8 * share, 2.4 * i as f32);
            let corner = |third: f32| {
                let angle = turn + third * std::f32::consts::TAU / 3.0;
                vec3(10.0 * angle.cos(), 10.0 * angle.sin(), z + 3.0 * (angle - 2.0 * turn).cos())
            };
            scene.triangles.push(triangle([0.0, 1.0, 2.0].map(corner), 0));
        } else {
            let center = vec3(0.3 * (7.0 * share).sin(), 0.3 * (9.0 * share).cos(), 5.0);
            scene.spheres.push(sphere(center, 1.0 + share, 0));
        }
    }
    scene
}

/// Most nodes that a ray of a list tests before and after it ends at its first leaf, if it passes all boxes:
/// those on the way down, and once each of their other children, whose lists it joined before it ended.
fn most_nodes(bvh: &Bvh, node: usize) -> u64 {
    let node = &bvh.wide[node];
    let nodes = node.nodes().count_ones() as usize;
    let below = |slot: usize| most_nodes(bvh, node.children()[slot].index()) - 1;
    let has_leaf = node.filled() > nodes;
    let deepest = if has_leaf { 0 } else { slots(node.nodes()).map(below).max().unwrap_or(0) };
    1 + nodes as u64 + deepest
}

#[test]
fn any_hit_ends_at_the_first_and_the_nearest_does_not() {
    let mut faults = Vec::new();
    for triangles in [true, false] {
        let scene = all_in_the_way(600, triangles);
        let bvh = Hierarchy::new(&scene.geometry(), Trees::WideAndBinary).bvh;
        let statistics = check_geometry(&bvh, &scene.geometry()).unwrap();
        let [levels, nodes] = [statistics.wide_depth, statistics.wide_nodes].map(|count| count as u64);
        let [binary_levels, binary_nodes] =
            [statistics.binary_depth, statistics.binary_nodes].map(|count| count as u64);
        let most_nodes = most_nodes(&bvh, 0);
        assert!(most_nodes < nodes, "{most_nodes} of {nodes} nodes");
        let kind = if triangles { Kind::Triangle } else { Kind::Sphere };
        let met = |counts: &Counts| counts.of_kind(kind).tests;
        for traversal in Traversal::ALL {
            for rays in [1, 2, 16] {
                let starts = vec![0.0; rays];
                let (nearest, hit_nearest) = counted::<false>(&scene, traversal, &starts);
                let (any, hit_any) = counted::<true>(&scene, traversal, &starts);
                let count = rays as u64;
                let what = format!(
                    "{traversal:?}, {rays} rays, triangles {triangles}: {any:?}, nearest {nearest:?}"
                );
                assert_eq!((met(&nearest), hit_nearest, hit_any), (600 * count, rays, rays), "{what}");
                // Any hit: one leaf, and the way down to it, with both children a level in the binary tree; a
                // packet also tests the boxes of a leaf's triangles. The nearest hit: every node, which rays
                // in a frustum share.
                let (most, all) = match traversal {
                    Traversal::Scalar => (1 + 2 * binary_levels, binary_nodes),
                    Traversal::Single => (levels, nodes),
                    Traversal::Stream => (most_nodes, nodes),
                    Traversal::Packet | Traversal::Hybrid => (most_nodes + 1, 0),
                };
                let ends = met(&any) <= LEAF as u64 * count && any.boxes.steps <= most * count;
                if !ends || nearest.boxes.steps < all * count {
                    faults.push(what);
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The picture and the rays of some samples, and what was noted meanwhile, if that was asked for.
fn rendered(scene: &Scene, settings: Settings, with: bool) -> (Picture, u64, Stats) {
    let renderer = Renderer::new(scene, settings);
    let mut film = renderer.film();
    if with {
        renderer.start_stats();
    }
    renderer.add_samples(&mut film, 3);
    let stats = renderer.take_stats();
    assert_eq!(renderer.take_stats(), Stats::default(), "it was taken");
    (film.picture(), film.rays(), stats)
}

fn settings(scene: &Scene, traversal: TraversalChoice, lanes: usize, threads: usize) -> Settings {
    let methods = Methods { traversal, ..Methods::default() };
    Settings { resolution: [50, 35], max_bounces: 3, methods, lanes, threads, ..Settings::of(scene) }
}

fn ways() -> impl Iterator<Item = TraversalChoice> {
    Traversal::ALL.map(TraversalChoice::Through).into_iter().chain([TraversalChoice::Linear])
}

#[test]
fn counting_changes_no_bit_and_no_number_of_threads_changes_the_counts() {
    // Twelve tiles are so few that each goes on alone, whatever the number of threads.
    for name in ["builtin:three", "builtin:cornell-spheres", "builtin:knot:500"] {
        let scene = load(name).unwrap();
        for (way, lanes) in ways().flat_map(|way| [(way, 1), (way, 8)]) {
            let of = |threads, with| rendered(&scene, settings(&scene, way, lanes, threads), with);
            let (plain, counted, on_three) = (of(1, false), of(1, true), of(3, true));
            assert!(plain.0 == counted.0 && plain.0 == on_three.0, "{name}, {way:?}, {lanes} lanes");
            assert_eq!(plain.2, Stats::default());
            let timeless = |stats: &Stats| Stats { times: Default::default(), ..stats.clone() };
            assert_eq!(timeless(&counted.2), timeless(&on_three.2), "{name}, {way:?}, {lanes} lanes");
        }
    }
}

#[test]
fn tiles_that_go_on_together_have_the_same_rays_in_fewer_packets() {
    let scene = load("builtin:three").unwrap();
    // Of 90 tiles one thread traces five together, three threads one.
    let [together, alone] = [1, 3].map(|threads| {
        let of_threads = settings(&scene, TraversalChoice::Auto, 8, threads);
        rendered(&scene, Settings { resolution: [160, 140], ..of_threads }, true).2.segments
    });
    assert_eq!((together.len(), alone.len()), (4, 4));
    for (bounces, (together, alone)) in together.iter().zip(&alone).enumerate() {
        assert_eq!(together.rays, alone.rays, "after {bounces} bounces");
        assert_eq!(together.packets < alone.packets, bounces >= 2, "after {bounces} bounces");
        assert!(together.packets * 8 >= together.rays, "after {bounces} bounces");
    }
}

#[test]
fn rays_by_kind_are_all_rays_and_packets_hold_them() {
    for name in ["builtin:three", "builtin:cornell", "builtin:knot:500"] {
        let scene = load(name).unwrap();
        for lanes in WIDTHS {
            let settings = settings(&scene, TraversalChoice::Auto, lanes, 2);
            let (_, rays, stats) = rendered(&scene, settings, true);
            assert_eq!(stats.rays(RayKind::Primary), 3 * 50 * 35, "{name}");
            assert_eq!(RayKind::ALL.map(|kind| stats.rays(kind)).iter().sum::<u64>(), rays, "{name}");
            // Only the box has a lamp: at most one ray to it from each event, and tested like others.
            let [bounced, to_lights] = [RayKind::Bounce, RayKind::Shadow].map(|kind| stats.rays(kind));
            assert_eq!(to_lights > 0, name.contains("cornell"));
            assert!(to_lights <= stats.rays(RayKind::Primary) + bounced, "{name}");
            assert!(stats.shadow_rays.packets * lanes as u64 >= to_lights, "{name}");
            // Of the box, all but ten triangles of walls and two of the lamp: the others occlude nothing.
            let triangles = to_lights * 20;
            assert_eq!(
                stats.counts[RayKind::Shadow as usize].of_kind(Kind::Triangle).tests,
                triangles,
                "{name}"
            );
            assert_eq!(stats.segments.len(), 4, "{name}: one segment more than bounces");
            assert!(stats.segments.is_sorted_by(|a, b| a.rays >= b.rays), "{name}");
            // Each of 12 tiles, in each of 3 samples, leaves at most one packet unfilled.
            let unfilled = 12 * 3 * (lanes as u64 - 1);
            for Segment { rays, packets } in &stats.segments {
                assert!((*rays..=rays + unfilled).contains(&(packets * lanes as u64)), "{name}");
            }
            let report = FrameStats::of(&stats, lanes, 2, 3);
            assert_eq!((report.rays, report.kinds[0].rays), (rays, stats.rays(RayKind::Primary)));
            assert!(report.bounces.iter().all(|bounce| bounce.simd_utilisation <= 1.0), "{name}");
            let shares: f64 = report.stages.iter().map(|stage| stage.share).sum();
            assert!((shares - 1.0).abs() < 1e-9 && report.seconds > 0.0, "{name}: {shares}");
            assert!(stats.times[Stage::Trace as usize].as_nanos() > 0, "{name}");
            assert_eq!(stats.counts[0].boxes.tests > 0, name.contains("knot"), "{name}");
        }
    }
}

#[test]
fn simd_utilisation_is_full_before_the_first_bounce_of_whole_tiles() {
    let scene = load("builtin:spheres").unwrap();
    let settings = Settings { resolution: [64, 48], lanes: 8, ..Settings::of(&scene) };
    let stats = rendered(&scene, settings, true).2;
    assert_eq!(stats.segments[0], Segment { rays: 3 * 64 * 48, packets: 3 * 64 * 48 / 8 });
    assert_eq!(FrameStats::of(&stats, 8, 1, 3).bounces[0].simd_utilisation, 1.0);
}

#[test]
fn first_hits_are_found_in_the_stage_trace() {
    let scene = load("builtin:spheres").unwrap();
    let settings = Settings { resolution: [64, 48], max_bounces: 0, ..Settings::of(&scene) };
    let [generate, trace] =
        [Stage::Generate, Stage::Trace].map(|stage| rendered(&scene, settings, true).2.times[stage as usize]);
    assert!(!generate.is_zero() && !trace.is_zero(), "no other rays are traced: {generate:?}, {trace:?}");
}

#[test]
fn testing_everything_tests_every_primitive() {
    let scene = load("builtin:cornell-spheres").unwrap();
    let [spheres, triangles] = [scene.spheres.len() as u64, scene.triangles.len() as u64];
    for lanes in WIDTHS {
        let stats = rendered(&scene, settings(&scene, TraversalChoice::Linear, lanes, 1), true).2;
        let packets: u64 = stats.segments[1..].iter().map(|segment| segment.packets).sum();
        let of = |each: u64| tests(stats.rays(RayKind::Bounce) * each, packets * each);
        let expected = Counts { boxes: tests(0, 0), primitives: [of(spheres), of(triangles)] };
        assert_eq!(stats.counts[1], expected);
        // Primary rays meet only what their tile can see.
        let primary = stats.counts[0].primitives.map(|tests| tests.tests);
        let rays = stats.rays(RayKind::Primary);
        assert!(primary[0] <= rays * spheres && primary[1] < rays * triangles && primary[1] > rays);
    }
}
