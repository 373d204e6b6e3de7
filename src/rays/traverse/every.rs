//! Visits more than the nearest hit of rays, one by one or in batches: every hit in f32, and every triangle
//! that a ray in doubles may hit.

use super::hierarchy::Hierarchy;
use super::single::descend;
use super::stack::Stack;
use super::stream::{BatchHits, LeafTests, ListedRay, Padded, Stream};
use super::structure::{Primitives, Structure};
use crate::columns::Rays;
use crate::kernel::ray_box::Padding;
use crate::kind::triangle::{Candidate, TriangleLeaf, sheared_error};
use crate::kind::{Kind, LEAF, List};
use crate::lane::set_bits;
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::prepared::SingleRay;
use glam::DVec3;

/// The working memory of a thread.
#[derive(Default)]
pub struct Memory {
    stack: Stack,
    /// Two MiB, allocated at first use.
    stream: Option<Box<Stream>>,
}

impl Memory {
    fn stream(&mut self) -> &mut Stream {
        self.stream.get_or_insert_default()
    }
}

/// Calls `visit` with every hit of a ray before `end`, in no order, in one descent. The ray is in the
/// coordinates of the structure, with a direction of unit length.
///
/// # Panics
/// If the structure has the caller's tests, which find one hit of each primitive at most.
pub fn visit_every_hit(
    structure: &Structure,
    memory: &mut Memory,
    ray: Ray<f32>,
    end: f32,
    visit: &mut impl FnMut(Hit<f32>),
) {
    let mut within = |hit: Hit<f32>| {
        if hit.t < end {
            visit(hit);
        }
    };
    match &structure.primitives {
        Primitives::List(list) => list.visit(&SingleRay::new(ray, List::padding(list)), &mut within),
        Primitives::Tree(tree, _) => {
            let ray = SingleRay::new(ray, tree.padding);
            let mut hit = Hit { t: end, primitive: MISS, u: 0.0, v: 0.0 };
            descend(tree, &ray, &mut memory.stack, &mut hit, (), |leaf, _| {
                tree.visit_leaf(leaf, &ray, &mut within);
                false
            });
        }
        Primitives::Custom(_) => panic!("the caller's tests find one hit of each primitive"),
    }
}

/// Calls `visit` with up to [`super::Tracer::BATCH`] rays, by index, and each of their hits before `ends`, in
/// no order: [`visit_every_hit`] for many rays at once. Returns false, without a visit, if the structure is
/// no hierarchy of triangles.
pub fn visit_every_hit_of_batch(
    structure: &Structure,
    memory: &mut Memory,
    rays: &Rays,
    ends: &mut [f32],
    visit: impl FnMut(usize, Hit<f32>),
) -> bool {
    let Primitives::Tree(hierarchy, _) = &structure.primitives else { return false };
    if !hierarchy.bvh.leaves[Kind::Sphere as usize].is_empty() {
        return false;
    }
    let padded = Padded { hierarchy, padding: hierarchy.padding };
    memory.stream().visit_hits(padded, rays, ends, visit);
    true
}

/// From so many extents of rounding on, no f32 says where a ray runs.
const TOO_FAR: f64 = (1_u64 << 30) as f64;
/// A ray in doubles, rounded to f32 for a structure; with its padding, rounding loses no hit.
///
/// Vertices, origin and direction are rounded to f32, by ε of each component: the planes of a box along an
/// axis are then off by ε (2 |o| + 2 |p|) in units of 1 / d. The roundings of
/// [`crate::kernel::ray_box::BoxRay`] are below ε (4 |o| + 3 |p|), and its padding is 8 ε (|o| + the largest
/// |p|). A component of the direction below 2⁻⁶⁰ of its length moves the ray by less than 2⁻⁵⁸ of that. The
/// test in leaves has a bound of its own ([`sheared_error`]).
///
/// An origin O beyond four times the extent E of all vertices is moved along the ray in f64, to twice the
/// radius R = √3 E before the point nearest to the middle. Its error, some roundings of f64, is less than ε
/// times `extra` = 2⁻²² |O|, which counts as extent. A ray that starts before R then passes the ball of R
/// from less than 8 E; others hit nothing.
pub struct RoundedRay {
    /// The ray, in the coordinates of the structure.
    pub ray: Ray<f32>,
    /// The length of the direction in units of the structure, and how far the origin was moved.
    scale: f64,
    moved: f64,
    /// The extent to add.
    extra: f64,
}

/// The extent to add for moved origins, in units of the distance from which they were moved.
pub const EXTRA: f64 = 1.0 / (1_u64 << 22) as f64;

/// Origins with a coordinate beyond so many extents are moved, to so many before the point nearest to the
/// middle.
pub const FAR: f64 = 4.0;
pub const BEFORE: f64 = 2.0 * 1.75;

/// Returns the largest coordinate of a structure that has a hierarchy.
pub fn extent(structure: &Structure) -> f64 {
    hierarchy(structure).padding.extent().into()
}

/// Returns the hierarchy of a structure that has one.
fn hierarchy(structure: &Structure) -> &Hierarchy {
    let Primitives::Tree(hierarchy, _) = &structure.primitives else { panic!("exact rays need a hierarchy") };
    hierarchy
}

/// Returns the padding of boxes and the error in leaves, with some extent to add, for rays from up to this
/// distance.
fn padding(hierarchy: &Hierarchy, extra: f64, distance: f64) -> (Padding, f32) {
    let room = (f64::from(hierarchy.padding.extent()) + extra) * (1.0 + f64::from(f32::EPSILON));
    (Padding::new(room as f32), sheared_error((room + distance) as f32))
}

impl RoundedRay {
    /// Rounds a ray; returns `None` if it hits nothing. Domain: finite, and the direction is not zero.
    ///
    /// # Panics
    /// If the structure is no hierarchy.
    pub fn new(structure: &Structure, mut origin: DVec3, direction: DVec3) -> Option<Self> {
        let tree = hierarchy(structure);
        let extent = f64::from(tree.padding.extent());
        let length = direction.length();
        let unit_direction = direction / length;
        origin = tree.coordinates.to_scene(origin);
        let (mut moved, mut extra, mut scale) = (0.0, 0.0, length / tree.coordinates.unit);
        let distance = origin.abs().max_element();
        if distance > FAR * extent {
            moved = (-origin.dot(unit_direction) - BEFORE * extent).max(0.0);
            origin += moved * unit_direction;
            extra = distance * EXTRA;
            if origin.abs().max_element() > 8.0 * extent + extra {
                return None;
            }
            if extra > TOO_FAR * extent {
                // Every box and every triangle is a candidate, at any distance.
                (origin, extra) = (DVec3::ZERO, TOO_FAR * extent);
                (moved, scale) = (0.0, f64::INFINITY);
            }
        }
        let ray =
            Ray { origin: Vec3::splat(origin.as_vec3()), direction: Vec3::splat(unit_direction.as_vec3()) };
        Some(Self { ray, scale, moved, extra })
    }

    /// Returns a distance in the structure that is not before `t` of the ray.
    pub fn end(&self, t: f64) -> f32 {
        let t = t * self.scale;
        ((t - self.moved + (t + self.moved) * f64::powi(0.5, 48)) as f32).next_up()
    }

    /// Calls `visit` with every triangle, by its number, that the ray may hit before `end`, nearest first as
    /// far as boxes tell. `visit` may return a new end, below 0 to end the search.
    #[inline]
    pub fn visit_candidates(
        &self,
        structure: &Structure,
        memory: &mut Memory,
        end: f32,
        mut visit: impl FnMut(u32) -> Option<f32>,
    ) {
        let tree = hierarchy(structure);
        let Vec3 { x, y, z } = self.ray.origin;
        let distance = x.abs().max(y.abs()).max(z.abs());
        let (padding, delta) = padding(tree, self.extra, distance.into());
        let ray = SingleRay::new(self.ray, padding);
        let mut hit = Hit { t: end, primitive: MISS, u: 0.0, v: 0.0 };
        descend(tree, &ray, &mut memory.stack, &mut hit, (), |leaf, hit| match leaf.kind() {
            Kind::Sphere => false,
            Kind::Triangle => tree.with_triangles(leaf.index(), |leaf| {
                let found = leaf.conservative(ray.woop.stored(), &delta);
                let candidates = found.candidates(&delta, hit.t);
                for lane in set_bits(candidates) {
                    let primitive = leaf.primitives.primitives[lane & (LEAF - 1)];
                    if hit.t >= 0.0 {
                        hit.t = visit(primitive).unwrap_or(hit.t);
                    }
                }
                hit.t < 0.0
            }),
        });
    }
}

/// Visits rays and the triangles that they may hit.
pub trait VisitCandidates {
    /// Visits a triangle that a ray, by its index, may hit; returns a new end of the ray, below 0 to end its
    /// search, or `None` to keep the end.
    fn visit(&mut self, ray: usize, candidate: Candidate) -> Option<f32>;
    /// Ends the visits of one node; calls `set_end` with rays and new ends.
    fn finish(&mut self, set_end: impl FnMut(usize, f32));
}

/// Visits up to [`super::Tracer::BATCH`] rays, by index, and the triangles that they may hit before their
/// `ends`.
///
/// The rays are rounded to f32, and moved, as by [`RoundedRay::new`]. No coordinate of their origins is above
/// `distance`, and no extent to add above `extra`. With `ANY`, the order does not matter.
pub fn visit_candidates_of_batch<const ANY: bool>(
    structure: &Structure,
    [extra, distance]: [f64; 2],
    memory: &mut Memory,
    rays: &Rays,
    ends: &mut [f32],
    visitor: impl VisitCandidates,
) {
    let tree = hierarchy(structure);
    let (padding, delta) = padding(tree, extra, distance);
    let padded = Padded { hierarchy: tree, padding };
    memory.stream().visit_leaves::<ANY>(padded, rays, ends, Candidates { delta, visitor });
}

struct Candidates<V> {
    delta: f32,
    visitor: V,
}

impl<V: VisitCandidates> LeafTests for Candidates<V> {
    #[inline(always)]
    fn candidates(&self, listed: &ListedRay, leaf: &TriangleLeaf) -> u32 {
        leaf.conservative(listed.stored_woop(), &self.delta).candidates(&self.delta, listed.stream_ray.t)
    }
    #[inline(always)]
    fn take<const ANY: bool>(
        &mut self,
        entry: u16,
        (leaf, candidates): (&TriangleLeaf, u32),
        batch: &mut BatchHits,
    ) {
        let listed = ListedRay::new(entry, batch.stream_rays);
        if ANY && listed.stream_ray.t < 0.0 {
            return;
        }
        let (mut end, ray, visitor) = (None, listed.ray(), &mut self.visitor);
        let found = leaf.conservative(listed.stored_woop(), &self.delta);
        leaf.visit_candidates(candidates, &found, &self.delta, &mut |candidate| {
            end = visitor.visit(ray, candidate).or(end);
        });
        if let Some(end) = end {
            batch.stream_rays[ray].t = end;
        }
    }
    #[inline(always)]
    fn finish<const ANY: bool>(&mut self, batch: &mut BatchHits) {
        self.visitor.finish(|ray, end| batch.stream_rays[ray].t = end);
    }
}
