//! The kinds of primitives.
//!
//! Each kind is a module with its geometry, its tests in a leaf of a hierarchy, and its tests in a list. The
//! code that distinguishes kinds is [`Shape`], [`List`] and [`Leaves`]. Triangles have more: traversals also
//! test them in ways of their own.

pub mod geometry;
pub mod sphere;
pub mod triangle;

pub use crate::numbering::{Kind, KindCounts};
pub use geometry::{Geometry, Shape};

use crate::columns::{Hits, Rays};
use crate::coordinates::Coordinates;
use crate::kernel::ray_box::Padding;
use crate::lane::{Bits, Lane, Mask, NATIVE_WIDTH};
use crate::math::{Hit, Ray};
use crate::numbering::Candidates;
use crate::prepared::SingleRay;
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use sphere::SphereLeaf;
use triangle::{Layout, MIN_LEAVES_PER_THREAD, TriangleLeaves, intersect_one};

/// The largest number of primitives in a leaf: as many as one vector tests at once.
pub const LEAF: usize = NATIVE_WIDTH;

/// Up to [`LEAF`] primitives of one kind, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Leaf {
    /// The numbers, ascending; [`Leaf::NONE`] fills the unused entries at the end.
    pub primitives: [u32; LEAF],
}

impl Leaf {
    /// Marks an unused entry.
    pub const NONE: u32 = u32::MAX;
    /// Returns the numbers of the primitives.
    pub fn primitives(&self) -> &[u32] {
        let len = self.primitives.iter().position(|&one| one == Self::NONE).unwrap_or(LEAF);
        &self.primitives[..len]
    }
}

/// Returns a limit that admits hits at `t` itself: among equal distances the lowest number wins, in any order
/// of tests.
#[inline(always)]
pub(crate) fn inclusive(t: f32) -> f32 {
    // Not next_up: its special cases cost branches. t is positive, or −∞ for rays that are done.
    if (0.0..f32::INFINITY).contains(&t) { f32::from_bits(t.to_bits() + 1) } else { t }
}

/// Keeps hits that are nearer, or equally near with a lower number. Returns whether any lane's hit was kept.
#[inline(always)]
pub fn keep_if_nearer<L: Lane>(mask: L::Mask, primitive: u32, [t, u, v]: [L; 3], hit: &mut Hit<L>) -> bool {
    // MISS is the largest number: plus one it wraps to 0, below all others, so a hit at t_max is a miss.
    let (number, one) = (L::Bits::splat(primitive), L::Bits::splat(1));
    let lower = number.wrapping_add(one).less(hit.primitive.wrapping_add(one));
    let nearer = mask & (t.lt(hit.t) | (t.eq(hit.t) & lower));
    hit.replace(nearer, &Hit { t, primitive: number, u, v });
    nearer.any()
}

/// All primitives, in the order of their numbers: every ray is tested against each.
///
/// Each kind of primitive has a loop over the rays. In short loops the processor works on several packets at
/// a time, and a ray's values stay in registers: with 16 lanes this is 1.03 to 1.1 times as fast as one loop
/// in scenes that have both kinds; with 8 there is no difference.
pub struct List {
    spheres: sphere::List,
    triangles: triangle::List,
    /// The place of the primitives' coordinates in the world.
    pub(crate) coordinates: Coordinates,
}

impl List {
    /// Stores all primitives.
    pub fn new(geometry: &Geometry) -> Self {
        let triangles = (geometry.counts().first(Kind::Triangle), geometry.triangles.as_slice());
        Self {
            spheres: sphere::List::new(&geometry.spheres),
            triangles: triangle::List::new(triangles, geometry.padding()),
            coordinates: geometry.coordinates,
        }
    }

    /// Returns the numbers of primitives by kind.
    pub fn counts(&self) -> KindCounts {
        KindCounts([self.spheres.len(), self.triangles.len()])
    }

    /// Returns the padding that rays are prepared with.
    pub fn padding(&self) -> Padding {
        self.triangles.padding
    }

    /// Calls `visit` with each hit of a ray with any primitive, in no order.
    pub fn visit(&self, ray: &SingleRay, visit: &mut impl FnMut(Hit<f32>)) {
        let Self { spheres, triangles, coordinates: _ } = self;
        spheres.visit(&ray.ray, visit);
        triangles.visit(ray, visit);
    }

    /// Finds the nearest hit of each ray by testing every primitive, or only the `listed` ones, which must
    /// include all that the rays can hit; overwrites the hits.
    pub fn trace<L: Lane>(&self, rays: &Rays, hits: &mut Hits, listed: Option<&Candidates>) {
        let [spheres, triangles] = listed.map_or(self.counts(), Candidates::counts).0;
        // If there are no candidates, the loop over zero spheres stores the misses.
        if spheres > 0 || triangles == 0 {
            self.spheres.trace::<L>(rays, hits, listed.map(|listed| listed.of_kind(Kind::Sphere)));
        }
        if triangles > 0 {
            self.triangles.trace::<L>(rays, (spheres > 0, hits), listed);
        }
    }
}

/// All leaves of a hierarchy, in one array for each kind.
pub struct Leaves {
    spheres: Vec<SphereLeaf>,
    pub(crate) triangles: TriangleLeaves,
}

impl Leaves {
    /// Stores the primitives of all `leaves`, which are given for each kind. The hierarchy's nodes take
    /// `node_bytes`. If there is no `layout` for triangles, sizes decide.
    pub fn new(
        geometry: &Geometry,
        leaves: &[Vec<Leaf>; Kind::ALL.len()],
        node_bytes: usize,
        layout: Option<Layout>,
    ) -> Self {
        let [spheres, triangles] = leaves;
        let spheres = spheres.par_iter().with_min_len(MIN_LEAVES_PER_THREAD);
        let vertices = (geometry.counts().first(Kind::Triangle), geometry.triangles.as_slice());
        Self {
            spheres: spheres.map(|leaf| SphereLeaf::new(&geometry.spheres, leaf)).collect(),
            triangles: TriangleLeaves::new(vertices, triangles, node_bytes, layout),
        }
    }

    /// Returns the size of all leaves in bytes.
    pub fn bytes(&self) -> usize {
        let Self { spheres, triangles } = self;
        size_of_val(spheres.as_slice()) + triangles.bytes()
    }

    /// Tests one ray against all primitives of a leaf at once.
    #[inline(always)]
    pub fn intersect(&self, kind: Kind, index: usize, ray: &SingleRay, hit: &mut Hit<f32>) {
        match kind {
            Kind::Triangle => self.triangles.with(index, |leaf| {
                leaf.accept(leaf.candidates(ray.woop.stored()), &ray.woop, &ray.box_ray, hit);
            }),
            Kind::Sphere => self.intersect_ray(kind, index, &ray.ray, hit),
        }
    }

    /// Tests one ray against the primitives of a leaf, one after the other: for the scalar baseline.
    #[inline(always)]
    pub fn intersect_one_by_one(
        &self,
        (kind, index): (Kind, usize),
        leaf: &Leaf,
        ray: &SingleRay,
        hit: &mut Hit<f32>,
    ) {
        match kind {
            Kind::Sphere => {
                self.spheres[index].intersect_packet(&ray.ray, hit);
            }
            Kind::Triangle => {
                for (lane, &primitive) in leaf.primitives().iter().enumerate() {
                    let corners = self.triangles.corners(index, lane);
                    intersect_one(corners, primitive, &ray.woop, &ray.box_ray, hit);
                }
            }
        }
    }

    /// Calls `visit` with each hit of a ray with the primitives of a leaf, in no order.
    pub fn visit(&self, kind: Kind, index: usize, ray: &SingleRay, visit: &mut impl FnMut(Hit<f32>)) {
        match kind {
            Kind::Sphere => self.spheres[index].visit(&ray.ray, visit),
            Kind::Triangle => self.triangles.with(index, |leaf| {
                let candidates = leaf.candidates(ray.woop.stored());
                leaf.visit(candidates, (&ray.woop, &ray.box_ray), visit);
            }),
        }
    }

    /// Improves the hit of one ray with the primitives of a leaf.
    ///
    /// # Panics
    /// If the leaf has triangles, whose tests need a prepared ray.
    #[inline(always)]
    pub fn intersect_ray(&self, kind: Kind, index: usize, ray: &Ray<f32>, hit: &mut Hit<f32>) {
        match kind {
            Kind::Sphere => self.spheres[index].intersect(ray, hit),
            Kind::Triangle => unreachable!("triangles are tested with prepared rays"),
        }
    }

    /// Improves the hits of a packet with the primitives of a leaf, one after the other. Returns whether any
    /// hit was nearer.
    ///
    /// # Panics
    /// If the leaf has triangles, whose tests need a prepared packet.
    #[inline(always)]
    pub fn intersect_packet<L: Lane>(
        &self,
        kind: Kind,
        index: usize,
        ray: &Ray<L>,
        hit: &mut Hit<L>,
    ) -> bool {
        match kind {
            Kind::Sphere => self.spheres[index].intersect_packet(ray, hit),
            Kind::Triangle => unreachable!("triangles are tested with prepared packets"),
        }
    }

    /// Fetches the cache lines of a leaf of triangles ahead of its visit. Leaves of spheres are few, and not
    /// fetched.
    #[inline(always)]
    pub fn prefetch(&self, kind: Kind, index: usize) {
        match kind {
            Kind::Sphere => {}
            Kind::Triangle => self.triangles.prefetch(index),
        }
    }
}
