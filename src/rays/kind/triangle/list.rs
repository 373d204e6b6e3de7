//! Rays against a list of triangles.

use crate::candidates::Candidates;
use crate::columns::{Hits, Rays};
use crate::kernel::ray_box::{BoxRay, Padding, own_box};
use crate::kernel::ray_triangle::{MollerTrumbore, PairHit, TriangleHit, TriangleMethod, Woop};
use crate::kind::Kind;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, MISS, Ray, Vec3};

/// A ray–triangle intersection method of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TriangleTest {
    /// [`Woop`]: the default.
    #[default]
    Woop,
    /// [`MollerTrumbore`]: the classic, for contrast.
    MollerTrumbore,
}

/// All triangles, in the order of their numbers.
pub struct List {
    stored: Stored,
    /// The number of the first triangle.
    first: u32,
    padding: Padding,
}

/// The triangles as the intersection method stores them.
enum Stored {
    Woop(Vec<<Woop as TriangleMethod>::Stored>),
    MollerTrumbore(Vec<<MollerTrumbore as TriangleMethod>::Stored>),
}

impl List {
    /// Stores all triangles, of which the first has the number `first`, for an intersection method.
    pub fn new(
        (first, triangles): (usize, &[[glam::Vec3; 3]]),
        test: TriangleTest,
        padding: Padding,
    ) -> Self {
        let stored = match test {
            TriangleTest::Woop => Stored::Woop(store::<Woop>(triangles)),
            TriangleTest::MollerTrumbore => Stored::MollerTrumbore(store::<MollerTrumbore>(triangles)),
        };
        Self { stored, first: first as u32, padding }
    }

    /// Returns the number of triangles.
    pub(crate) fn len(&self) -> usize {
        match &self.stored {
            Stored::Woop(stored) => stored.len(),
            Stored::MollerTrumbore(stored) => stored.len(),
        }
    }

    /// Finds the nearest hit of each ray among all triangles or those `listed`. With `has_hits`, keeps what
    /// the ray has hit before where no triangle is strictly nearer; else overwrites the hits.
    pub fn trace<L: Lane>(
        &self,
        rays: &Rays,
        (has_hits, hits): (bool, &mut Hits),
        listed: Option<&Candidates>,
    ) {
        match &self.stored {
            Stored::Woop(stored) => self.trace_by::<L, Woop>(stored, rays, (has_hits, hits), listed),
            Stored::MollerTrumbore(stored) => {
                self.trace_by::<L, MollerTrumbore>(stored, rays, (has_hits, hits), listed);
            }
        }
    }

    fn trace_by<L: Lane, T: TriangleMethod>(
        &self,
        all: &[T::Stored],
        rays: &Rays,
        hits: (bool, &mut Hits),
        listed: Option<&Candidates>,
    ) {
        match listed {
            None => trace_triangles::<L, T>((self.first..).zip(all), self.padding, rays, hits),
            Some(candidates) => {
                let listed = candidates.of_kind(Kind::Triangle).iter();
                let listed = listed.map(|&index| (self.first + index, &all[index as usize]));
                trace_triangles::<L, T>(listed, self.padding, rays, hits);
            }
        }
    }
}

/// Returns the triangles as an intersection method stores them, those that share an edge linked in pairs.
fn store<T: TriangleMethod>(triangles: &[[glam::Vec3; 3]]) -> Vec<T::Stored> {
    let mut stored: Vec<_> = triangles.iter().map(|&vertices| T::store(vertices)).collect();
    T::link_pairs(&mut stored);
    stored
}

/// Finds the nearest of the triangles that each ray hits; with `has_hits`, keeps what it has hit before
/// where no triangle is strictly nearer. An iterator and no closure gives the triangles: a test is so much
/// code that a closure with it would not be inlined into the loop (4 % more instructions in boxes).
///
/// Shapes: packets of `WIDTH` rays; one triangle, or two that share an edge, at a time is broadcast to all
/// lanes.
#[inline(never)]
fn trace_triangles<'a, L: Lane, T: TriangleMethod>(
    triangles: impl Iterator<Item = (u32, &'a T::Stored)> + Clone,
    padding: Padding,
    rays: &Rays,
    (has_hits, hits): (bool, &mut Hits),
) {
    for at in (0..rays.len()).step_by(L::WIDTH) {
        let (t, primitive) = match has_hits {
            true => hits.nearest(at),
            false => (rays.t_max(at), L::Bits::splat(MISS)),
        };
        let (ray, mut hit) = (rays.packet::<L>(at), Hit { t, primitive, u: L::zero(), v: L::zero() });
        let precalculated = T::precalculate(&ray);
        let mut triangles = triangles.clone().peekable();
        while let Some((number, triangle)) = triangles.next() {
            if T::is_linked(triangle)
                && let Some(&(next, second)) = triangles.peek()
                && next == number + 1
                && let Some(found) = T::test_pair(&precalculated, [triangle, second])
            {
                triangles.next();
                keep_pair_if_nearer::<L, T>(&mut hit, &ray, padding, number, [triangle, second], found);
            } else {
                test_triangle::<L, T>(&mut hit, &ray, &precalculated, padding, number, triangle);
            }
        }
        hits.store(at, &hit);
    }
}

/// Keeps the hits of one triangle that are nearer than those found before.
#[inline(always)]
fn test_triangle<L: Lane, T: TriangleMethod>(
    hit: &mut Hit<L>,
    ray: &Ray<L>,
    precalculated: &T::Precalculated<L>,
    padding: Padding,
    number: u32,
    triangle: &T::Stored,
) {
    let corners = T::own_box(triangle);
    let limit = if corners.is_some() { L::splat(f32::INFINITY) } else { hit.t };
    let found = T::test(precalculated, triangle, limit);
    if found.mask.any() {
        let corners = corners.map(|[lo, hi]| [Vec3::splat(lo), Vec3::splat(hi)]);
        keep_if_nearer(hit, ray, padding, L::Bits::splat(number), corners, found);
    }
}

/// [`test_triangle`] of a pair that was tested.
#[inline(always)]
fn keep_pair_if_nearer<L: Lane, T: TriangleMethod>(
    hit: &mut Hit<L>,
    ray: &Ray<L>,
    padding: Padding,
    number: u32,
    [first, second]: [&T::Stored; 2],
    PairHit { hit: found, is_second }: PairHit<L>,
) {
    if !found.mask.any() {
        return;
    }
    let of = |first: f32, second: f32| L::select(is_second, L::splat(second), L::splat(first));
    let corner = |first: glam::Vec3, second: glam::Vec3| {
        Vec3::new(of(first.x, second.x), of(first.y, second.y), of(first.z, second.z))
    };
    let corners = match (T::own_box(first), T::own_box(second)) {
        (Some(first), Some(second)) => Some([corner(first[0], second[0]), corner(first[1], second[1])]),
        _ => None,
    };
    let number = L::Bits::select(is_second, L::Bits::splat(number + 1), L::Bits::splat(number));
    keep_if_nearer(hit, ray, padding, number, corners, found);
}

/// Keeps what was found where it is nearer than what was found before, within the triangles' own boxes.
#[inline(always)]
fn keep_if_nearer<L: Lane>(
    hit: &mut Hit<L>,
    ray: &Ray<L>,
    padding: Padding,
    number: L::Bits,
    corners: Option<[Vec3<L>; 2]>,
    found: TriangleHit<L>,
) {
    let (mask, t) = match corners {
        // Computed here and not once a packet: few packets hit a triangle's plane inside its edges.
        Some([lo, hi]) => own_box(&BoxRay::new(ray, padding), (lo, hi), found.mask, found.t, hit.t),
        None => (found.mask & found.t.lt(hit.t), found.t),
    };
    hit.replace(mask, &Hit { t, primitive: number, u: found.u, v: found.v });
}
