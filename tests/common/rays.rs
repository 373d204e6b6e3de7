//! Sets of rays, what every traversal finds for them, and what testing every primitive finds.

use super::{Rng, empty, material, sphere, triangle};
use glam::Vec3;
use octray::buffers::Buffers;
use octray::bvh::Trees;
use octray::math::{Hit, MISS, Ray};
use octray::scene::{MaterialKind, Scene};
use octray::traverse::batch::{Tracer, Traversal};
use octray::traverse::hierarchy::Hierarchy;
use octray::traverse::rays::{Hits, Rays};
use octray::traverse::stack::Stack;
use octray::traverse::stream::Stream;
use octray::traverse::tile::{self, Packets};
use octray::traverse::{Batch, Layout, Methods, Primitives, TraversalChoice};

/// t, primitive, u and v of each ray, as bits.
pub type Answers = Vec<[u32; 4]>;

/// Rays, and what is known of their hits before.
#[derive(Default)]
pub struct Set {
    pub origin: [Vec<f32>; 3],
    pub direction: [Vec<f32>; 3],
    /// How far each ray reaches: in units of t, where it has hit before or where it ends.
    pub t_max: Vec<f32>,
    /// What it has hit there; [`MISS`] for nothing.
    pub primitive: Vec<u32>,
}

/// The weights that hits from before come with.
const BEFORE: [f32; 2] = [0.125, 0.25];

impl Set {
    pub fn push(&mut self, origin: Vec3, direction: Vec3, t_max: f32) {
        for axis in 0..3 {
            self.origin[axis].push(origin[axis]);
            self.direction[axis].push(direction[axis]);
        }
        self.t_max.push(t_max);
        self.primitive.push(MISS);
    }
    pub fn len(&self) -> usize {
        self.t_max.len()
    }
    pub fn rays(&self) -> Rays<'_> {
        Rays {
            origin: self.origin.each_ref().map(Vec::as_slice),
            direction: self.direction.each_ref().map(Vec::as_slice),
        }
    }
    /// Runs something on columns of hits as they are before tracing; returns what it returns, and the hits.
    fn with_hits<R>(&self, run: impl FnOnce(&mut Hits) -> R) -> (R, Answers) {
        let weight = |i: usize| {
            let of_hit = |&one: &u32| if one == MISS { 0.0 } else { BEFORE[i] };
            self.primitive.iter().map(of_hit).collect::<Vec<f32>>()
        };
        let (mut t, mut primitive, mut u, mut v) =
            (self.t_max.clone(), self.primitive.clone(), weight(0), weight(1));
        let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
        let result = run(&mut hits);
        let bits = |i: usize| [t[i].to_bits(), primitive[i], u[i].to_bits(), v[i].to_bits()];
        (result, (0..self.len()).map(bits).collect())
    }
    pub fn through<const ANY: bool>(&self, hierarchy: &Hierarchy, traversal: Traversal) -> Answers {
        self.through_by::<ANY>(&mut Tracer::new(), hierarchy, traversal)
    }
    /// By a tracer that may have traced other rays before.
    fn through_by<const ANY: bool>(
        &self,
        tracer: &mut Tracer,
        hierarchy: &Hierarchy,
        traversal: Traversal,
    ) -> Answers {
        self.with_hits(|hits| tracer.trace::<ANY>(traversal, hierarchy, &self.rays(), hits)).1
    }
    /// Some pieces alone, in streams.
    pub fn pieces(&self, hierarchy: &Hierarchy, pieces: u32) -> Answers {
        self.with_hits(|hits| {
            Stream::default().trace_pieces::<false>(hierarchy, &self.rays(), hits, pieces, ())
        })
        .1
    }
    /// Are the first rays, a tile at most, ones for which there is a frustum?
    pub fn goes_in_a_frustum(&self, hierarchy: &Hierarchy) -> bool {
        let tile = 0..self.len().min(tile::TILE);
        let rays = self.rays().range(tile.clone());
        self.with_hits(|hits| {
            tile::trace(hierarchy, &rays, &mut hits.range(tile), &mut Stack::new(), Packets::Always, ())
        })
        .0
    }
    /// Every primitive tested in order, at a width of one.
    pub fn linear(&self, scene: &Scene) -> Answers {
        struct All<'a>(&'a Set, Answers, &'a mut Answers);
        impl Batch<f32> for All<'_> {
            fn run(self, closest: impl Fn(&Ray<f32>) -> Hit<f32>) {
                let Self(set, before, answers) = self;
                for (at, before) in before.into_iter().enumerate() {
                    let Hit { t, primitive, u, v } = closest(&set.rays().packet::<f32>(at));
                    // Testing everything knows no t_max: there and beyond it nothing was to be found, but
                    // what is as far as the hit from before and has a lower number.
                    let t_max = set.t_max[at];
                    let known = set.primitive[at];
                    let lower = known != MISS && primitive < known;
                    answers.push(match primitive != MISS && (t < t_max || (t == t_max && lower)) {
                        true => [t.to_bits(), primitive, u.to_bits(), v.to_bits()],
                        false => before,
                    });
                }
            }
        }
        let methods = Methods { traversal: TraversalChoice::Linear, ..Methods::default() };
        let mut answers = Vec::new();
        let before = self.with_hits(|_| ()).1;
        let primitives = Primitives::new(scene, methods, 1);
        primitives.for_batch::<f32>(&Buffers::new(scene), None, All(self, before, &mut answers));
        answers
    }
    /// Asserts that every traversal finds what testing everything finds, in both layouts of the leaves;
    /// returns how many rays hit something.
    pub fn check(&self, scene: &Scene, what: &str) -> usize {
        let expected = self.linear(scene);
        for layout in [Layout::Full, Layout::Compact] {
            let hierarchy = Hierarchy::in_layout(scene, Trees::WideAndBinary, Some(layout));
            self.check_in(&hierarchy, &expected, &format!("{what}, {layout:?}"));
        }
        expected.iter().filter(|answer| answer[1] != MISS).count()
    }
    fn check_in(&self, hierarchy: &Hierarchy, expected: &Answers, what: &str) {
        let mut tracer = Tracer::new();
        for traversal in Traversal::ALL {
            let name = traversal.name();
            let found = self.through_by::<false>(&mut tracer, hierarchy, traversal);
            for (at, (found, expected)) in found.iter().zip(expected).enumerate() {
                let ray = self.rays().packet::<f32>(at);
                let t_max = self.t_max[at];
                assert_eq!(found, expected, "{what}, {name}: ray {at}, {ray:?} to {t_max}");
            }
            let found = self.through_by::<true>(&mut tracer, hierarchy, traversal);
            for (at, (found, expected)) in found.iter().zip(expected).enumerate() {
                assert_eq!(found[1] == MISS, expected[1] == MISS, "{what}, any hit, {name}: ray {at}");
            }
        }
    }
}

/// Triangles and spheres over `scales` powers of ten around a centre, slivers among them.
pub fn mixture(rng: &mut Rng, triangles: usize, spheres: usize, scales: f64, offset: f32) -> Scene {
    let mut scene = Scene { materials: vec![material(MaterialKind::Diffuse)], ..empty() };
    let mut number = |range: f64| ((2.0 * rng.unit() - 1.0) * range) as f32;
    let mut point = |range: f32| Vec3::new(number(1.0), number(1.0), number(1.0)) * range;
    for i in 0..triangles + spheres {
        let size = 10f32.powf(-(scales as f32) * (i % 7) as f32 / 6.0);
        let center = point(4.0) + offset;
        if i < spheres {
            scene.spheres.push(sphere(center, 0.3 * size, 0));
        } else {
            let long = if i % 5 == 0 { 1e-4 } else { 1.0 };
            let (a, b) = (point(size), point(size * long));
            if a.cross(b).length() > 0.0 {
                scene.triangles.push(triangle([center, center + a, center + a * 0.5 + b], 0));
            }
        }
    }
    scene
}
