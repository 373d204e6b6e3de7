//! Sets of rays, what every traversal finds for them, and what testing every primitive finds.

use super::*;
use octray::methods::{MethodTests, Robust, Woop};
use octray::rays::kind::triangle::Layout;
use octray::rays::traverse::stack::Stack;
use octray::rays::traverse::tile::{self, Packets};
use octray::rays::{Candidates, Hits, Rays, Structure, Tracer};
use std::sync::Arc;

/// t, primitive, u and v of each ray, as bits.
pub type Answers = Vec<[u32; 4]>;

/// Rays, and what is known of their hits before.
#[derive(Clone, Default)]
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

/// Runs something on columns of hits; returns what it returns, and the hits.
fn with_columns<R>(
    mut t: Vec<f32>,
    mut primitive: Vec<u32>,
    [mut u, mut v]: [Vec<f32>; 2],
    run: impl FnOnce(&mut Hits) -> R,
) -> (R, Answers) {
    let result = run(&mut Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v });
    let bits = |i: usize| [t[i].to_bits(), primitive[i], u[i].to_bits(), v[i].to_bits()];
    (result, (0..t.len()).map(bits).collect())
}

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
        Rays::new(self.origin.each_ref().map(Vec::as_slice), self.direction.each_ref().map(Vec::as_slice))
    }
    /// Runs something on columns of hits as they are before tracing; returns what it returns, and the hits.
    fn with_hits<R>(&self, run: impl FnOnce(&mut Hits) -> R) -> (R, Answers) {
        let weight = |weight: f32| {
            let of_hit = |&one: &u32| if one == MISS { 0.0 } else { weight };
            self.primitive.iter().map(of_hit).collect::<Vec<f32>>()
        };
        with_columns(self.t_max.clone(), self.primitive.clone(), BEFORE.map(weight), run)
    }
    pub fn through<const ANY: bool>(&self, hierarchy: &Hierarchy, traversal: Traversal) -> Answers {
        self.with_hits(|hits| Tracer::new().trace::<ANY>(traversal, hierarchy, &self.rays(), hits)).1
    }
    /// Are the first rays, a tile at most, ones for which there is a frustum?
    pub fn goes_in_a_frustum(&self, hierarchy: &Hierarchy) -> bool {
        let tile = 0..self.len().min(tile::TILE);
        let rays = self.rays().range(tile.clone());
        self.with_hits(|hits| {
            let hits = &mut hits.range(tile);
            tile::trace(hierarchy, &rays, hits, &mut Stack::new(), Packets::Always, ())
        })
        .0
    }
    /// Rays of any length, before they hit anything.
    pub fn of(rays: &[Ray<f32>]) -> Self {
        let mut set = Self::default();
        for &Ray { origin, direction } in rays {
            set.push(origin.get(0), direction.get(0), f32::INFINITY);
        }
        set
    }
    /// What is nearest of every primitive, or of every one that is listed, before the rays end; whatever they
    /// have hit before.
    pub fn nearest<L: Lane>(&self, list: &List, listed: Option<&Candidates>) -> Answers {
        self.nearest_by(L::WIDTH, |rays, hits| list.trace::<L>(rays, hits, listed))
    }
    /// What is nearest in a structure, before the rays end.
    pub fn nearest_in(&self, structure: &Structure) -> Answers {
        self.nearest_by(16, |rays, hits| Tracer::new().closest_in_scene(structure, rays, hits))
    }
    fn nearest_by(&self, lanes: usize, trace: impl FnOnce(&Rays, &mut Hits)) -> Answers {
        let count = self.len().next_multiple_of(lanes);
        let padded = |column: &[f32]| -> Vec<f32> {
            let last = column.last().copied().into_iter().cycle();
            column.iter().copied().chain(last).take(count).collect()
        };
        let [origin, direction] =
            [&self.origin, &self.direction].map(|of| of.each_ref().map(|column| padded(column)));
        let [of_origin, of_direction] = [&origin, &direction].map(|of| of.each_ref().map(Vec::as_slice));
        let t_max = padded(&self.t_max);
        let rays = Rays::new(of_origin, of_direction).first(self.len()).until(&t_max);
        let weights = [(); 2].map(|()| vec![0.0; count]);
        // Whatever was there before is overwritten.
        let mut answers = with_columns(vec![0.0; count], vec![7; count], weights, |hits| trace(&rays, hits));
        answers.1.truncate(self.len());
        answers.1
    }
    /// Every primitive tested in order: at any width the same, see `tests/laws/traversal_laws.rs`.
    pub fn linear(&self, scene: &Scene) -> Answers {
        let endless = Self { t_max: vec![f32::INFINITY; self.len()], ..self.clone() };
        let nearest = endless.nearest::<F32x8>(&List::new(&scene.geometry()), None);
        let before = self.with_hits(|_| ()).1;
        let answer = |at: usize| {
            let [t, primitive, ..] = nearest[at];
            let (t, t_max, known) = (f32::from_bits(t), self.t_max[at], self.primitive[at]);
            // At and beyond t_max nothing was to be found, but what is as far as the hit from before and has
            // a lower number.
            let lower = known != MISS && primitive < known;
            let counts = primitive != MISS && (t < t_max || (t == t_max && lower));
            if counts { nearest[at] } else { before[at] }
        };
        (0..self.len()).map(answer).collect()
    }
    /// Asserts that every traversal finds what testing everything finds, in both layouts of the leaves and
    /// with the default methods as the caller's own tests; returns how many rays hit something.
    pub fn check(&self, scene: &Scene, what: &str) -> usize {
        let expected = self.linear(scene);
        for layout in [Layout::Full, Layout::Compact] {
            let hierarchy = Hierarchy::in_layout(&scene.geometry(), Trees::WideAndBinary, Some(layout));
            self.check_in(&hierarchy, &expected, &format!("{what}, {layout:?}"));
        }
        let (geometry, mut tracer) = (scene.geometry(), Tracer::new());
        let tests = Arc::new(MethodTests::<Robust, Woop>::new(&geometry));
        for lanes in [1, NATIVE_WIDTH] {
            for structure in [
                Structure::list_with(&geometry, tests.clone(), lanes),
                Structure::tree_with(&geometry, tests.clone(), lanes),
            ] {
                let by = |any: bool, hits: &mut Hits| match any {
                    true => tracer.improve::<true>(&structure, &self.rays(), hits),
                    false => tracer.improve::<false>(&structure, &self.rays(), hits),
                };
                self.check_by(by, &expected, &format!("{what}, the caller's tests, {lanes} lanes"));
            }
        }
        expected.iter().filter(|answer| answer[1] != MISS).count()
    }
    fn check_in(&self, hierarchy: &Hierarchy, expected: &Answers, what: &str) {
        let mut tracer = Tracer::new();
        for traversal in Traversal::ALL {
            let by = |any: bool, hits: &mut Hits| match any {
                true => tracer.trace::<true>(traversal, hierarchy, &self.rays(), hits),
                false => tracer.trace::<false>(traversal, hierarchy, &self.rays(), hits),
            };
            self.check_by(by, expected, &format!("{what}, {}", TraversalChoice::Through(traversal).name()));
        }
    }
    /// `trace` takes whether any hit will do.
    fn check_by(&self, mut trace: impl FnMut(bool, &mut Hits), expected: &Answers, what: &str) {
        let found = self.with_hits(|hits| trace(false, hits)).1;
        for (at, (found, expected)) in found.iter().zip(expected).enumerate() {
            let ray = self.rays().packet::<f32>(at);
            assert_eq!(found, expected, "{what}: ray {at}, {ray:?} to {}", self.t_max[at]);
        }
        let found = self.with_hits(|hits| trace(true, hits)).1;
        for (at, (found, expected)) in found.iter().zip(expected).enumerate() {
            assert_eq!(found[1] == MISS, expected[1] == MISS, "{what}, any hit: ray {at}");
            // Some hit, so none nearer than the nearest.
            let [found, nearest] = [found, expected].map(|answer| f32::from_bits(answer[0]));
            assert!(found >= nearest, "{what}, any hit: ray {at} at {found} before {nearest}");
        }
    }
}

/// The list of a scene's primitives for any methods.
pub fn list_of(scene: &Scene, methods: Methods, lanes: usize) -> Structure {
    match methods::tests(&methods, scene) {
        None => Structure::list(&scene.geometry(), lanes),
        Some(tests) => Structure::list_with(&scene.geometry(), tests, lanes),
    }
}

/// Triangles and spheres over `scales` powers of ten around a centre, slivers among them.
pub fn mixture(rng: &mut Rng, triangles: usize, spheres: usize, scales: f64, offset: f32) -> Scene {
    let mut scene = Scene { materials: vec![material(Diffuse)], ..empty() };
    let mut number = |range: f64| ((2.0 * rng.unit() - 1.0) * range) as f32;
    let mut point = |range: f32| vec3(number(1.0), number(1.0), number(1.0)) * range;
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
