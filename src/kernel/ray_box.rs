//! Rays against boxes along the axes.
//!
//! The law of a hierarchy is that it loses no hit. Two things together keep it:
//!
//! - A box is padded for the ray, by more than rounding can move a hit out of it ([`Slabs::new`]).
//! - A triangle is hit only where the ray also passes the triangle's own box, by the same formula, and its t is moved into the box's
//!   interval ([`own_box`]): on slivers the computed t may lie far off. The formula is monotone in the planes, so boxes that contain
//!   each other have intervals that contain each other exactly, and a hit in a box is in every box around it.
//!
//! Source: the slab test of Kay, Kajiya, 1986, as one FMA a plane; padding instead of Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.

use crate::lane::Lane;
use crate::math::{EPSILON, Ray, Vec3};

/// What a scene adds to the padding of its boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reach {
    /// The largest absolute coordinate of any box.
    extent: f32,
    /// Largest 1/2r, |c|/2r and |c|²/2r of the spheres: see [`Reach::of_spheres`].
    spheres: [f32; 3],
}

impl Reach {
    pub const fn new(extent: f32) -> Self {
        Self { extent, spheres: [0.0; 3] }
    }
    /// Makes room for a sphere's hits. Its discriminant is off by up to 32 ε D², D the distance of ray origin and centre: it
    /// is hit as if its radius were larger by 16 ε D² / r. With D ≤ |o| + |c| that is a polynomial in |o|.
    pub fn with_sphere(mut self, center: glam::Vec3, radius: f32) -> Self {
        let distance = center.length();
        let curvature = 1.0 / (2.0 * radius);
        for (largest, own) in
            self.spheres.iter_mut().zip([curvature, curvature * distance, curvature * distance * distance])
        {
            *largest = largest.max(own);
        }
        self
    }
    /// All that padding is measured against for a ray from here, without |o| itself: E, and what spheres need, in units of 2⁻²¹.
    #[inline(always)]
    pub fn room<L: Lane>(&self, origin: Vec3<L>) -> L {
        L::splat(self.extent) + self.of_spheres(origin) * L::splat(f32::powi(2.0, 21))
    }
    /// How much larger spheres may seem to rays from this far off the scene's origin.
    #[inline(always)]
    fn of_spheres<L: Lane>(&self, origin: Vec3<L>) -> L {
        let [square, linear, constant] = self.spheres.map(L::splat);
        let far = origin.x.abs() + origin.y.abs() + origin.z.abs();
        let sum = square.mul_add(far, linear + linear).mul_add(far, constant);
        sum * L::splat(32.0 * EPSILON)
    }
}

/// A ray made ready for boxes: the intervals of t within pairs of planes are `plane · inverse + near` to `plane · inverse + far`.
#[derive(Clone, Copy, Debug)]
pub struct Slabs<L> {
    /// 1 / direction; directions along an axis are turned off it by 2⁻⁶⁰ of their length.
    pub inverse: Vec3<L>,
    /// −origin / direction, less the padding.
    pub near: Vec3<L>,
    /// −origin / direction, and the padding.
    pub far: Vec3<L>,
}

impl<L: Lane> Slabs<L> {
    /// Padding, in units of t: (|o| + E) 2⁻²¹ |1/d| along each axis, E the scene's extent: eight roundings of everything that the FMA
    /// adds up. No hit is lost: `tests/hierarchy_laws.rs`, at corners, in the planes of faces, in awkward directions.
    #[inline(always)]
    pub fn new(ray: &Ray<L>, reach: Reach) -> Self {
        let d = ray.direction;
        let least = d.x.abs().max(d.y.abs()).max(d.z.abs()) * L::splat(f32::powi(0.5, 60));
        let room = reach.room(ray.origin);
        let axis = |origin: L, direction: L| {
            let inverse = L::one() / direction.abs().max(least).copysign(direction);
            let middle = -(origin * inverse);
            let padding = (origin.abs() + room) * inverse.abs() * L::splat(f32::powi(0.5, 21));
            (inverse, middle - padding, middle + padding)
        };
        let (x, y, z) = (axis(ray.origin.x, d.x), axis(ray.origin.y, d.y), axis(ray.origin.z, d.z));
        Self {
            inverse: Vec3::new(x.0, y.0, z.0),
            near: Vec3::new(x.1, y.1, z.1),
            far: Vec3::new(x.2, y.2, z.2),
        }
    }

    /// Where each ray enters and leaves its box, from its planes in the order in which the ray meets them. It passes the box if the
    /// first is not above the second; the first may be negative.
    #[inline(always)]
    pub fn interval(&self, first: Vec3<L>, second: Vec3<L>) -> (L, L) {
        let plane = |plane: L, inverse: L, rest: L| plane.mul_add(inverse, rest);
        let near = plane(first.x, self.inverse.x, self.near.x)
            .max(plane(first.y, self.inverse.y, self.near.y))
            .max(plane(first.z, self.inverse.z, self.near.z));
        let far = plane(second.x, self.inverse.x, self.far.x)
            .min(plane(second.y, self.inverse.y, self.far.y))
            .min(plane(second.z, self.inverse.z, self.far.z));
        (near, far)
    }

    /// The same for boxes given by their lower and upper corners.
    #[inline(always)]
    pub fn pass(&self, lo: Vec3<L>, hi: Vec3<L>) -> (L, L) {
        let backwards = |inverse: L| inverse.lt(L::zero());
        let [x, y, z] = [self.inverse.x, self.inverse.y, self.inverse.z].map(backwards);
        let pick = |a: Vec3<L>, b: Vec3<L>| {
            Vec3::new(L::select(x, b.x, a.x), L::select(y, b.y, a.y), L::select(z, b.z, a.z))
        };
        self.interval(pick(lo, hi), pick(hi, lo))
    }
}

/// The rule of the own box: of lanes that hit a triangle at `t`, those that pass its box in front of `limit`, and t moved into it.
#[inline(always)]
pub fn own_box<L: Lane>(
    slabs: &Slabs<L>,
    (lo, hi): (Vec3<L>, Vec3<L>),
    hit: L::Mask,
    t: L,
    limit: L,
) -> (L::Mask, L) {
    let (near, far) = slabs.pass(lo, hi);
    let t = t.min(far).max(near);
    (hit & near.le(far) & L::zero().lt(t) & t.lt(limit), t)
}
