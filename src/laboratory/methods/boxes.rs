//! Rays against axis-aligned boxes: the engine's test, and those of other renderers. The shares of false
//! misses are those of `boxes-corners` and `boxes-faces` of `octray stability`.
//!
//! A zero component of the direction divides to infinity, and a plane through the origin then gives 0 · ∞ =
//! NaN. Where planes are picked by the direction's sign, [`Lane::max`] and [`Lane::min`] leave NaN out of the
//! interval, because they return their second argument where the first is NaN: the ray counts as between
//! these planes, on either side of the face.

use crate::kernel::ray_box::{BoxRay, Padding, in_order};
use crate::lane::Lane;
use crate::math::{Ray, Vec3};

/// A method of intersecting rays with axis-aligned boxes. A ray passes a box if it enters it no later than it
/// leaves it, and does not leave it before its own origin.
///
/// Shapes: `WIDTH` rays against `WIDTH` boxes, lane by lane.
/// Units: t in multiples of the direction's length.
/// Domain: any direction; the method says what becomes of those along an axis. Boxes whose lower corner is
/// not above the upper one.
pub trait BoxMethod: Send + Sync + 'static {
    /// The values that are computed once per ray.
    type Precalculated<L: Lane>: Copy;

    /// Methods without padding ignore `padding`.
    fn precalculate<L: Lane>(ray: &Ray<L>, padding: Padding) -> Self::Precalculated<L>;

    /// The t at which each ray enters and leaves its box, given by its lower and upper corner.
    fn pass<L: Lane>(ray: &Self::Precalculated<L>, lo: Vec3<L>, hi: Vec3<L>) -> (L, L);
}

/// [`BoxRay`] as a [`BoxMethod`].
///
/// Error: no false miss; a ray that misses a box by less than two paddings may pass it
/// (`tests/laws/kernel_box.rs`).
/// Source: see [`crate::kernel::ray_box`].
pub struct Padded;

impl BoxMethod for Padded {
    type Precalculated<L: Lane> = BoxRay<L>;

    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>, padding: Padding) -> BoxRay<L> {
        BoxRay::new(ray, padding)
    }
    #[inline(always)]
    fn pass<L: Lane>(box_ray: &BoxRay<L>, lo: Vec3<L>, hi: Vec3<L>) -> (L, L) {
        box_ray.pass(lo, hi)
    }
}

/// Origin and 1 / direction.
#[derive(Clone, Copy, Debug)]
pub struct Inverse<L> {
    origin: Vec3<L>,
    inverse: Vec3<L>,
}

impl<L: Lane> Inverse<L> {
    #[inline(always)]
    fn new(ray: &Ray<L>) -> Self {
        let d = ray.direction;
        Self { origin: ray.origin, inverse: Vec3::new(L::one() / d.x, L::one() / d.y, L::one() / d.z) }
    }
    /// The t of one plane per axis.
    #[inline(always)]
    fn planes(&self, planes: Vec3<L>) -> Vec3<L> {
        (planes - self.origin) * self.inverse
    }
}

/// The intersection of the three intervals; NaN bounds nothing.
#[inline(always)]
fn intersect<L: Lane>(near: Vec3<L>, far: Vec3<L>) -> (L, L) {
    let infinity = L::splat(f32::INFINITY);
    (near.x.max(near.y.max(near.z.max(-infinity))), far.x.min(far.y.min(far.z.min(infinity))))
}

/// (p − o) · (1 / d), the nearer plane picked by the direction's sign.
///
/// Error: a false miss for 9 % of rays, where two planes meet and their t round to the wrong order.
/// Source: Williams, Barrus, Morley, Shirley, "An Efficient and Robust Ray-Box Intersection Algorithm", JGT
/// 10(1), 2005.
pub type BySign = PickedBySign<false>;

/// [`BySign`] with the far distance times 1 + 2 ulp.
///
/// Error: no false miss. Each of the two distances has three roundings; 1 ulp would not cover them.
/// Source: Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013, §3.
pub type BySignWidened = PickedBySign<true>;

/// The planes picked by the direction's sign, with the far distance widened or not.
pub struct PickedBySign<const WIDENED: bool>;

impl<const WIDENED: bool> BoxMethod for PickedBySign<WIDENED> {
    type Precalculated<L: Lane> = Inverse<L>;

    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>, _: Padding) -> Inverse<L> {
        Inverse::new(ray)
    }
    #[inline(always)]
    fn pass<L: Lane>(ray: &Inverse<L>, lo: Vec3<L>, hi: Vec3<L>) -> (L, L) {
        let (first, second) = in_order(ray.inverse, lo, hi);
        let (near, far) = intersect(ray.planes(first), ray.planes(second));
        (near, if WIDENED { far * L::splat(1.0 + 2.0 * f32::EPSILON) } else { far })
    }
}

/// p · (1 / d) − o / d as one FMA per plane, without padding.
///
/// Error: a false miss for 10 % of rays, and for a third where the box is small and far from the origin of
/// the coordinates (without FMA a quarter): the difference p − o, which was nearly exact, is lost. With FMA,
/// for half of the rays that run nearly in the plane of a face: p / d − o / d cancels to the rounding of
/// o / d, which is large.
pub struct Contracted;

/// 1 / direction, and −origin / direction.
#[derive(Clone, Copy, Debug)]
pub struct Fused<L> {
    inverse: Vec3<L>,
    rest: Vec3<L>,
}

impl BoxMethod for Contracted {
    type Precalculated<L: Lane> = Fused<L>;

    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>, _: Padding) -> Fused<L> {
        let Inverse { origin, inverse } = Inverse::new(ray);
        Fused { inverse, rest: -(origin * inverse) }
    }
    #[inline(always)]
    fn pass<L: Lane>(ray: &Fused<L>, lo: Vec3<L>, hi: Vec3<L>) -> (L, L) {
        let Fused { inverse, rest } = *ray;
        let planes = |p: Vec3<L>| {
            Vec3::new(
                p.x.mul_add(inverse.x, rest.x),
                p.y.mul_add(inverse.y, rest.y),
                p.z.mul_add(inverse.z, rest.z),
            )
        };
        let (first, second) = in_order(inverse, lo, hi);
        intersect(planes(first), planes(second))
    }
}

/// (p − o) · (1 / d) of both planes, ordered by the minimum and maximum of x86, which return the second
/// operand where either is NaN.
///
/// Error: as [`BySign`] at corners; a false miss for half of the rays that run in the plane of a face, along
/// an axis.
/// Source: Kay, Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986, as compilers make it of `a < b ? a : b`.
pub type X86MinMax = MinMax<false>;

/// [`X86MinMax`] with the minimum and maximum of IEEE 754, which ignore NaN (`f32::min`, `fmin` in C).
///
/// Error: as [`BySign`] at corners; a false miss for all rays that run in the plane of a face, along an axis.
pub type IeeeMinMax = MinMax<true>;

/// Both planes of each axis, ordered by a minimum and a maximum.
pub struct MinMax<const IEEE: bool>;

impl<const IEEE: bool> BoxMethod for MinMax<IEEE> {
    type Precalculated<L: Lane> = Inverse<L>;

    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>, _: Padding) -> Inverse<L> {
        Inverse::new(ray)
    }
    #[inline(always)]
    fn pass<L: Lane>(ray: &Inverse<L>, lo: Vec3<L>, hi: Vec3<L>) -> (L, L) {
        // The rule of x86 gives b where a is NaN; that of IEEE 754 also a where b is NaN.
        let number = |b: L, chosen: L, a: L| if IEEE { L::select(b.eq(b), chosen, a) } else { chosen };
        let min = |a: L, b: L| number(b, a.min(b), a);
        let max = |a: L, b: L| number(b, a.max(b), a);
        let (a, b) = (ray.planes(lo), ray.planes(hi));
        let near = Vec3::new(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z));
        let far = Vec3::new(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z));
        intersect(near, far)
    }
}
