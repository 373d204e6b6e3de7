//! The primitives that rays are tested against one by one: all of a scene, or those of a list.

use crate::buffers::Spheres;
use crate::kernel::sphere_culling::{CulledSphere, SphereCulling};
use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// Spheres to test rays against, by ascending number.
pub trait SphereCandidates {
    /// How many there are.
    fn count(&self) -> usize;
    /// Calls `f` with each sphere's number, centre and squared radius.
    fn for_each<L: Lane>(&self, f: impl FnMut(u32, Vec3<L>, L));
    /// [`SphereCandidates::for_each`] of those that any of the rays may hit.
    fn for_each_near<L: Lane>(&self, rays: &SphereCulling<L>, f: impl FnMut(u32, Vec3<L>, L));
}

/// Every sphere of a scene.
#[derive(Clone, Copy)]
pub struct AllSpheres<'a> {
    /// All spheres.
    pub spheres: &'a Spheres,
    /// The same, for culling.
    pub culled: &'a [CulledSphere],
}

/// Those spheres of a scene that are listed.
#[derive(Clone, Copy)]
pub struct ListedSpheres<'a> {
    /// Every sphere.
    pub all: AllSpheres<'a>,
    /// The numbers of those that can be hit.
    pub listed: &'a [u32],
}

/// Triangles to test rays against, by ascending number, as a method stores them.
pub trait TriangleCandidates<Stored> {
    /// Each triangle and its number. An iterator and no closure: a test is so much code that a closure with
    /// it would not be inlined into the loop (4 % more instructions in boxes).
    fn iter<'a>(&'a self) -> impl Iterator<Item = (u32, &'a Stored)>
    where
        Stored: 'a;
}

/// Every triangle of a scene.
#[derive(Clone, Copy)]
pub struct AllTriangles<'a, Stored> {
    /// The number of the first one: triangles are counted after spheres.
    pub first: u32,
    /// All triangles.
    pub triangles: &'a [Stored],
}

/// Those triangles of a scene that are listed.
#[derive(Clone, Copy)]
pub struct ListedTriangles<'a, Stored> {
    /// Every triangle.
    pub all: AllTriangles<'a, Stored>,
    /// The indices of those that can be hit, among the triangles.
    pub listed: &'a [u32],
}

impl SphereCandidates for AllSpheres<'_> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.spheres.len()
    }
    #[inline(always)]
    fn for_each<L: Lane>(&self, mut f: impl FnMut(u32, Vec3<L>, L)) {
        self.spheres.for_each(|index, center, radius2| f(index as u32, center, radius2));
    }
    #[inline(always)]
    fn for_each_near<L: Lane>(&self, rays: &SphereCulling<L>, mut f: impl FnMut(u32, Vec3<L>, L)) {
        for (chunk, spheres) in self.culled.chunks(CHUNK).enumerate() {
            let numbers = (chunk * CHUNK) as u32..;
            for_each_near_of_chunk(rays, numbers.zip(spheres), self.spheres, &mut f);
        }
    }
}

impl SphereCandidates for ListedSpheres<'_> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.listed.len()
    }
    #[inline(always)]
    fn for_each<L: Lane>(&self, mut f: impl FnMut(u32, Vec3<L>, L)) {
        for &index in self.listed {
            let (center, radius2) = self.all.spheres.splat(index as usize);
            f(index, center, radius2);
        }
    }
    #[inline(always)]
    fn for_each_near<L: Lane>(&self, rays: &SphereCulling<L>, mut f: impl FnMut(u32, Vec3<L>, L)) {
        for listed in self.listed.chunks(CHUNK) {
            let culled = |&number: &u32| (number, &self.all.culled[number as usize]);
            for_each_near_of_chunk(rays, listed.iter().map(culled), self.all.spheres, &mut f);
        }
    }
}

/// How many spheres are culled at a time.
const CHUNK: usize = 64;

/// Calls `f` with those of up to [`CHUNK`] spheres that some ray may hit.
#[inline(always)]
fn for_each_near_of_chunk<'a, L: Lane>(
    rays: &SphereCulling<L>,
    chunk: impl Iterator<Item = (u32, &'a CulledSphere)>,
    spheres: &Spheres,
    f: &mut impl FnMut(u32, Vec3<L>, L),
) {
    let (mut near, mut count) = ([0; CHUNK], 0);
    for (number, sphere) in chunk {
        // Always written, and counted only if it is near: no branch.
        near[count % CHUNK] = number;
        count += usize::from(rays.may_hit(sphere).any());
    }
    for &number in &near[..count.min(CHUNK)] {
        let (center, radius2) = spheres.splat(number as usize);
        f(number, center, radius2);
    }
}

impl<Stored> TriangleCandidates<Stored> for AllTriangles<'_, Stored> {
    #[inline(always)]
    fn iter<'a>(&'a self) -> impl Iterator<Item = (u32, &'a Stored)>
    where
        Stored: 'a,
    {
        (self.first..).zip(self.triangles)
    }
}

impl<Stored> TriangleCandidates<Stored> for ListedTriangles<'_, Stored> {
    #[inline(always)]
    fn iter<'a>(&'a self) -> impl Iterator<Item = (u32, &'a Stored)>
    where
        Stored: 'a,
    {
        let AllTriangles { first, triangles } = self.all;
        self.listed.iter().map(move |&index| (first + index, &triangles[index as usize]))
    }
}
