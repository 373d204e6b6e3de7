//! Runs queries on whole batches of rays: closest hit and any hit.

use super::beyond::{self, ROUNDING};
use super::counter::{Counter, CounterSink, Counts};
use super::hierarchy::Hierarchy;
use super::stack::Stack;
use super::stream::{BATCH, Stream};
use super::structure::{Primitives, Structure};
use super::tile::{self, Packets, TILE};
use super::{scalar, single};
use crate::bvh::Trees;
use crate::columns::{Hits, LowerBounds, Rays};
use crate::kind::{List, inclusive};
use crate::lane::{F32x8, F32x16, NATIVE_WIDTH};
use crate::math::{Hit, MISS, Ray};
use crate::numbering::Candidates;
use crate::prepared::SingleRay;

/// A traversal of the hierarchy. All give the same hits, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Traversal {
    /// One ray at a time through the binary tree, without SIMD: the baseline.
    Scalar,
    /// One ray at a time, against all boxes of a node, or all primitives of a leaf, at once.
    Single,
    /// Tiles of camera rays in a frustum; all other rays in streams.
    Packet,
    /// Many rays together, down the tree.
    Stream,
    /// The traversal that measured fastest for the rays at hand.
    #[default]
    Hybrid,
}

impl Traversal {
    /// All traversals, the baseline first.
    pub const ALL: [Self; 5] = [Self::Scalar, Self::Single, Self::Packet, Self::Stream, Self::Hybrid];

    /// Returns the number of lanes of the traversal.
    pub fn lanes(self) -> usize {
        if self == Self::Scalar { 1 } else { NATIVE_WIDTH }
    }
    /// Returns the trees that the traversal reads.
    pub fn trees(self) -> Trees {
        if self == Self::Scalar { Trees::WideAndBinary } else { Trees::Wide }
    }
}

/// The working memory of one thread, and the queries that use it.
///
/// Queries improve hits: a ray ends at its t_max ([`Rays::until`]), or at the initial `t` of its hit if that
/// is less. A ray that hits nothing nearer keeps its hit. Of equally near hits the lower number wins.
#[derive(Default)]
pub struct Tracer {
    memory: Memory,
    counter: Option<Counter>,
}

/// The memory of the traversals.
#[derive(Default)]
struct Memory {
    stack: Stack,
    /// The memory of streams: two MiB, allocated at first use.
    stream: Option<Box<Stream>>,
}

impl Tracer {
    /// The number of primary rays of which queries are best multiples: a tile of pixels that share a frustum.
    pub const TILE: usize = TILE;
    /// The largest number of rays that share reads of the hierarchy. More in one query gain nothing.
    pub const BATCH: usize = BATCH;

    /// Creates a tracer, which allocates nothing until it is first used.
    pub fn new() -> Self {
        Self::default()
    }

    /// Finds the closest hit of each ray, in world coordinates ([`crate::Coordinates`]). `hits` hold infinity
    /// and [`MISS`] at first, or earlier hits. Directions may have any length from 10⁻³⁰ to 10³⁰, which is
    /// then the unit of `t`; a length within 10⁻⁶ of 1 counts as 1. Other directions hit nothing.
    pub fn closest(&mut self, structure: &Structure, rays: &Rays, hits: &mut Hits) {
        self.in_world::<false>(structure, rays, hits);
    }

    /// Tests which rays hit anything, in world coordinates: their `primitive` is not [`MISS`]. Everything
    /// else in the hits is unspecified. Rays are tested against all primitives, even those that
    /// [`Structure::with_targets`] excludes.
    pub fn occluded(&mut self, structure: &Structure, rays: &Rays, hits: &mut Hits) {
        self.in_world::<true>(structure, rays, hits);
    }

    /// Traces copies of the rays in the coordinates of the structure, with directions of unit length. Ends
    /// there are a few roundings too far, and hits at or behind the end that the caller gave are dropped.
    fn in_world<const ANY: bool>(&mut self, structure: &Structure, rays: &Rays, hits: &mut Hits) {
        let coordinates = structure.coordinates();
        let (mut columns, mut ends) = ([const { Vec::new() }; 6], Vec::new());
        for at in 0..rays.len() {
            let Ray { origin, direction } = rays.packet::<f32>(at);
            let origin = coordinates.to_scene(origin.get(0).into()).as_vec3().to_array();
            let direction = direction.get(0).as_dvec3();
            let length = Some(direction.length()).filter(|length| (length - 1.0).abs() > 1e-6).unwrap_or(1.0);
            let of_ray = origin.into_iter().chain((direction / length).as_vec3().to_array());
            columns.iter_mut().zip(of_ray).for_each(|(column, x)| column.push(x));
            let (end, scale) = (rays.t_max::<f32>(at), length / coordinates.unit);
            let earlier = hits.t[at];
            let end = if end > earlier { earlier } else { end };
            let slack = if scale == 1.0 { 1.0 } else { f64::from(ROUNDING) };
            // A NaN, as from a direction of length 0, is no hit.
            hits.t[at] = if length > 0.0 { (f64::from(end) * scale * slack) as f32 } else { f32::NAN };
            let before = std::mem::replace(&mut hits.primitive[at], MISS);
            ends.push((end, earlier, before, scale));
        }
        let [x, y, z, dx, dy, dz] = &columns;
        let copies = Rays::new([x, y, z], [dx, dy, dz]);
        if let Some(bounds) = rays.lower_bound() {
            self.improve_beyond::<false>(structure, bounds, &copies, hits, |at: usize| ends[at].3);
        } else if ANY && ends.iter().all(|(.., scale)| *scale == 1.0) {
            self.improve::<true>(structure, &copies, hits);
        } else {
            // With rounded ends, only the closest hit tells whether there is one before the end.
            self.improve::<false>(structure, &copies, hits);
        }
        for (at, (end, earlier, before, scale)) in ends.into_iter().enumerate() {
            let t = (f64::from(hits.t[at]) / scale) as f32;
            // A hit as near as an earlier one counts if its number is lower.
            let (found, lower) = (hits.primitive[at], if end == earlier { before } else { 0 });
            let is_new = found != MISS && (t < end || t == end && lower != MISS && found < lower);
            (hits.t[at], hits.primitive[at]) = if is_new { (t, found) } else { (end, before) };
        }
    }

    /// Finds the closest hit of each ray up to its t_max, in the coordinates of the structure and with
    /// directions of unit length; overwrites the hits. Rays that are [`Rays::among`] candidates hit no other
    /// primitive. A list reads and writes whole packets: see [`Rays::first`].
    pub fn closest_in_scene(&mut self, structure: &Structure, rays: &Rays, hits: &mut Hits) {
        if let (Primitives::List(list), None) = (&structure.primitives, rays.lower_bound()) {
            return trace_list(list, structure.lanes, rays, hits, rays.candidates(), self.counter.as_ref());
        }
        hits.reset(rays);
        self.improve::<false>(structure, rays, hits);
    }

    /// Tests which rays hit anything, in the coordinates of [`Tracer::closest_in_scene`]. With
    /// [`Structure::with_targets`], primitives that cannot lie between a surface and a target are left out.
    pub fn occluded_in_scene(&mut self, structure: &Structure, rays: &Rays, hits: &mut Hits) {
        if let (Primitives::List(list), None) = (&structure.primitives, rays.lower_bound()) {
            return trace_list(
                list,
                structure.lanes,
                rays,
                hits,
                structure.occluders(),
                self.counter.as_ref(),
            );
        }
        hits.reset(rays);
        let occluders = structure.occluders.as_ref().and_then(|few| few.hierarchy.as_ref());
        match (&structure.primitives, occluders.filter(|_| rays.lower_bound().is_none())) {
            (Primitives::Tree(_, traversal), Some(few)) => self.trace::<true>(*traversal, few, rays, hits),
            _ => self.improve::<true>(structure, rays, hits),
        }
    }

    /// Finds the closest hits of rays one by one: to count each ray's tests, or for so few rays that they
    /// share nothing. The result is that of [`Tracer::closest_in_scene`].
    pub fn closest_one_by_one(&mut self, structure: &Structure, rays: &Rays, hits: &mut Hits) {
        if rays.lower_bound().is_some() {
            return self.closest_in_scene(structure, rays, hits);
        }
        let Self { memory, counter } = self;
        match &structure.primitives {
            Primitives::List(list) => trace_list(list, 1, rays, hits, rays.candidates(), counter.as_ref()),
            Primitives::Tree(tree, traversal) => {
                let single = if *traversal == Traversal::Scalar { *traversal } else { Traversal::Single };
                hits.reset(rays);
                memory.trace::<false>(single, tree, rays, hits, counter.as_ref());
            }
            Primitives::Custom(custom) => {
                hits.reset(rays);
                custom.trace(false, 1, rays, hits, counter.as_ref());
            }
        }
    }

    /// Improves the hits of rays in the coordinates of the structure, with directions of unit length. The
    /// initial `t` of a hit is its ray's only end. With `ANY`, each ray ends at the first hit found: then
    /// only whether `primitive` is [`MISS`] is defined.
    pub fn improve<const ANY: bool>(&mut self, structure: &Structure, rays: &Rays, hits: &mut Hits) {
        if let Some(bounds) = rays.lower_bound() {
            return self.improve_beyond::<ANY>(structure, bounds, rays, hits, |_| 1.0);
        }
        let Self { memory, counter } = self;
        match &structure.primitives {
            Primitives::List(list) => improve_by_list(list, structure.lanes, rays, hits, counter.as_ref()),
            Primitives::Tree(tree, traversal) => {
                memory.trace::<ANY>(*traversal, tree, rays, hits, counter.as_ref());
            }
            Primitives::Custom(custom) => custom.trace(ANY, structure.lanes, rays, hits, counter.as_ref()),
        }
    }

    /// Runs [`Tracer::improve`] on rays with lower bounds, each in units of `1 / scale(ray)`.
    #[cold]
    fn improve_beyond<const ANY: bool>(
        &mut self,
        structure: &Structure,
        bounds: LowerBounds,
        rays: &Rays,
        hits: &mut Hits,
        scale: impl Fn(usize) -> f64,
    ) {
        let Self { memory, counter } = self;
        let primitives = (&structure.primitives, &mut memory.stack);
        beyond::improve::<ANY>(primitives, bounds, rays, hits, scale, counter.as_ref());
    }

    /// Applies [`Tracer::improve`] to a hierarchy with any traversal. Without a binary tree,
    /// [`Traversal::Scalar`] is [`Traversal::Single`]: the hits are the same.
    pub fn trace<const ANY: bool>(
        &mut self,
        traversal: Traversal,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
    ) {
        self.memory.trace::<ANY>(traversal, hierarchy, rays, hits, self.counter.as_ref());
    }

    /// Counts the tests of boxes and primitives from now on, from 0.
    pub fn start_counting(&mut self) {
        self.counter = Some(Counter::default());
    }

    /// Stops counting.
    pub fn stop_counting(&mut self) {
        self.counter = None;
    }

    /// Runs queries without counting their tests.
    pub fn without_counting<R>(&mut self, run: impl FnOnce(&mut Self) -> R) -> R {
        let counter = self.counter.take();
        let result = run(self);
        self.counter = counter;
        result
    }

    /// Returns the tests since the last call or since counting began; zeros if tests are not counted.
    pub fn take_counts(&mut self) -> Counts {
        self.counter.as_ref().map(Counter::take).unwrap_or_default()
    }
}

/// Runs [`List::trace`] in packets of `lanes` rays. A `counter` counts the tests.
fn trace_list(
    list: &List,
    lanes: usize,
    rays: &Rays,
    hits: &mut Hits,
    candidates: Option<&Candidates>,
    counter: Option<&Counter>,
) {
    if let Some(counter) = counter {
        let tested = candidates.map_or(list.counts(), Candidates::counts);
        counter.list(tested, rays.len().div_ceil(lanes), rays.len());
    }
    match lanes {
        1 => list.trace::<f32>(rays, hits, candidates),
        8 => list.trace::<F32x8>(rays, hits, candidates),
        _ => list.trace::<F32x16>(rays, hits, candidates),
    }
}

/// Improves hits by [`List::trace`] for whole packets, and one by one for the remaining rays.
fn improve_by_list(list: &List, lanes: usize, rays: &Rays, hits: &mut Hits, counter: Option<&Counter>) {
    let before: Vec<_> = (0..rays.len()).map(|at| hits.get(at)).collect();
    // A hit as near as that before counts if its number is lower.
    let end = |hit: &Hit<f32>| if hit.primitive == MISS { hit.t } else { inclusive(hit.t) };
    let ends: Vec<f32> = before.iter().map(end).collect();
    let rays = rays.until(&ends);
    for (range, lanes) in rays.in_packets(lanes) {
        trace_list(list, lanes, &rays.range(range.clone()), &mut hits.range(range), None, counter);
    }
    for (at, before) in before.iter().enumerate() {
        let found = hits.get(at);
        if found.primitive == MISS || found.t == before.t && found.primitive >= before.primitive {
            hits.set(at, before);
        }
    }
}

impl Memory {
    fn trace<const ANY: bool>(
        &mut self,
        traversal: Traversal,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        counter: Option<&Counter>,
    ) {
        match counter {
            None => self.trace_counted::<ANY>(traversal, hierarchy, rays, hits, ()),
            Some(counter) => self.trace_counted::<ANY>(traversal, hierarchy, rays, hits, counter),
        }
    }

    #[inline(always)]
    fn trace_counted<const ANY: bool>(
        &mut self,
        traversal: Traversal,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        counter: impl CounterSink,
    ) {
        match traversal {
            Traversal::Scalar if !hierarchy.bvh.binary.is_empty() => {
                one_by_one(hierarchy, rays, hits, move |ray, hit| {
                    scalar::trace::<ANY>(hierarchy, ray, hit, counter)
                });
            }
            Traversal::Scalar | Traversal::Single => {
                let stack = &mut self.stack;
                one_by_one(hierarchy, rays, hits, move |ray, hit| {
                    single::trace::<ANY>(hierarchy, ray, stack, hit, counter)
                });
            }
            Traversal::Stream => self.stream().trace::<ANY>(hierarchy, rays, hits, counter),
            Traversal::Packet => self.tiles::<ANY>(hierarchy, rays, hits, Packets::Always, counter),
            Traversal::Hybrid => {
                self.tiles::<ANY>(hierarchy, rays, hits, Packets::WherePaying, counter);
            }
        }
    }

    /// Traces tiles for which there is a frustum as packets, and consecutive other tiles in streams.
    fn tiles<const ANY: bool>(
        &mut self,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        packets: Packets,
        counter: impl CounterSink,
    ) {
        let mut left = 0..0;
        let tiles = (0..rays.len()).step_by(TILE).map(|first| first..rays.len().min(first + TILE));
        for tile in tiles {
            let is_done = !ANY && {
                let (rays, hits) = (&rays.range(tile.clone()), &mut hits.range(tile.clone()));
                tile::trace(hierarchy, rays, hits, &mut self.stack, packets, counter)
            };
            if is_done {
                let (rays, hits) = (&rays.range(left.clone()), &mut hits.range(left));
                self.stream().trace::<ANY>(hierarchy, rays, hits, counter);
                left = tile.end..tile.end;
            } else {
                left.end = tile.end;
            }
        }
        let (rays, hits) = (&rays.range(left.clone()), &mut hits.range(left));
        self.stream().trace::<ANY>(hierarchy, rays, hits, counter);
    }

    fn stream(&mut self) -> &mut Stream {
        self.stream.get_or_insert_with(Box::default)
    }
}

fn one_by_one(
    hierarchy: &Hierarchy,
    rays: &Rays,
    hits: &mut Hits,
    mut trace: impl FnMut(&SingleRay, &mut Hit<f32>),
) {
    for at in 0..rays.len() {
        let mut hit = hits.get(at);
        trace(&SingleRay::new(rays.packet(at), hierarchy.padding), &mut hit);
        hits.set(at, &hit);
    }
}
