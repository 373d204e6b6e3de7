//! Every ray against every primitive: fastest for small scenes, and the result that every other traversal
//! must equal.
//!
//! Quadrics and triangles have a loop over the rays each. In short loops the processor works on several
//! packets at a time, and what a ray needs stays in registers: with 16 lanes 1.03 to 1.1 times as fast as one
//! loop in scenes that have both; with 8 there is no difference.

use super::candidates::Candidates;
use super::counter::Counter;
use super::quadrics::{Quadrics, SphereTest};
use super::rays::{Hits, Rays};
use crate::coordinates::Coordinates;
use crate::geometry::Geometry;
use crate::kernel::ray_box::{BoxRay, Padding, own_box};
use crate::kernel::ray_triangle::{MollerTrumbore, PairHit, TriangleHit, TriangleMethod, Woop};
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

/// All primitives, in the order of their numbers.
pub struct List {
    quadrics: Quadrics,
    triangles: Triangles,
    padding: Padding,
    /// Where the coordinates of the primitives are in the world.
    pub(super) coordinates: Coordinates,
}

/// The triangles as the chosen method stores them.
enum Triangles {
    Woop(Vec<<Woop as TriangleMethod>::Stored>),
    MollerTrumbore(Vec<<MollerTrumbore as TriangleMethod>::Stored>),
}

impl List {
    /// Stores all primitives for these intersection methods.
    pub fn new(geometry: &Geometry, (sphere, triangle): (SphereTest, TriangleTest)) -> Self {
        Self {
            quadrics: Quadrics::new(geometry, sphere),
            triangles: match triangle {
                TriangleTest::Woop => Triangles::Woop(store_triangles::<Woop>(geometry)),
                TriangleTest::MollerTrumbore => {
                    Triangles::MollerTrumbore(store_triangles::<MollerTrumbore>(geometry))
                }
            },
            padding: geometry.padding(),
            coordinates: geometry.coordinates,
        }
    }

    /// The numbers of quadrics and triangles that [`List::trace`] tests each ray against.
    fn tests(&self, listed: Option<&Candidates>) -> [usize; 2] {
        if let Some(listed) = listed {
            return [listed.spheres.len(), listed.triangles.len()];
        }
        let triangles = match &self.triangles {
            Triangles::Woop(stored) => stored.len(),
            Triangles::MollerTrumbore(stored) => stored.len(),
        };
        [self.quadrics.len(), triangles]
    }

    /// Finds the nearest hit of each ray by testing every primitive, or those that are `listed`: then they
    /// hold all that the rays can hit. A `counter` counts the tests.
    pub fn trace<L: Lane>(
        &self,
        rays: &Rays,
        hits: &mut Hits,
        listed: Option<&Candidates>,
        counter: Option<&Counter>,
    ) {
        let [quadrics, triangles] = self.tests(listed);
        if let Some(counter) = counter {
            counter.list([quadrics, triangles], rays.len().div_ceil(L::WIDTH), rays.len());
        }
        // Without any candidate, the loop over none of the quadrics stores the misses.
        if quadrics > 0 || triangles == 0 {
            self.quadrics.trace::<L>(rays, hits, listed.map(|listed| listed.spheres.as_slice()));
        }
        if triangles > 0 {
            let hits = (quadrics > 0, hits);
            match &self.triangles {
                Triangles::Woop(stored) => self.trace_triangles::<L, Woop>(stored, rays, hits, listed),
                Triangles::MollerTrumbore(stored) => {
                    self.trace_triangles::<L, MollerTrumbore>(stored, rays, hits, listed);
                }
            }
        }
    }

    fn trace_triangles<L: Lane, T: TriangleMethod>(
        &self,
        all: &[T::Stored],
        rays: &Rays,
        hits: (bool, &mut Hits),
        listed: Option<&Candidates>,
    ) {
        let first = self.quadrics.len() as u32;
        match listed {
            None => trace_triangles::<L, T>((first..).zip(all), self.padding, rays, hits),
            Some(Candidates { triangles, .. }) => {
                let listed = triangles.iter().map(|&index| (first + index, &all[index as usize]));
                trace_triangles::<L, T>(listed, self.padding, rays, hits);
            }
        }
    }
}

/// Returns the triangles as an intersection method stores them, those that share an edge linked in pairs.
fn store_triangles<T: TriangleMethod>(geometry: &Geometry) -> Vec<T::Stored> {
    let mut stored: Vec<_> = geometry.triangles.iter().map(|&vertices| T::store(vertices)).collect();
    T::link_pairs(&mut stored);
    stored
}

/// Finds the nearest of the triangles that each ray hits; `after_quadrics`, keeps what it has hit before
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
    (after_quadrics, hits): (bool, &mut Hits),
) {
    for at in (0..rays.len()).step_by(L::WIDTH) {
        let (t, primitive) = match after_quadrics {
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
