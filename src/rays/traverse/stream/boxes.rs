//! Tests the rays of a list against the boxes of a node.

use super::listed::{BATCH, ListedRay};
use super::stream_ray::{ORDERS_BY_T, StreamRay};
use crate::bvh::WIDE;
use crate::lane::{Bits, Lane, Mask, Native};
use crate::math::Vec3;
use crate::traverse::frustum::Boxes;

/// Returns the planes that rays of an octant meet first along each axis, and those that they meet second.
#[inline(always)]
fn in_order<L: Lane>(boxes: &Boxes, octant: u8) -> (Vec3<L>, Vec3<L>) {
    // `& 7` keeps the index inside.
    let row = |row: usize| L::load(&boxes[row & 7]);
    let upper = |axis: u32| 3 * usize::from(octant >> axis & 1);
    let (x, y, z) = (upper(0), upper(1), upper(2));
    (Vec3::new(row(x), row(1 + y), row(2 + z)), Vec3::new(row(3 - x), row(4 - y), row(5 - z)))
}

/// Returns the t at which a ray meets planes. `all` broadcasts a number of the ray to all lanes.
#[inline(always)]
fn meets<L: Lane>(planes: Vec3<L>, inverse: Vec3<L>, rest: Vec3<&f32>, all: impl Fn(&f32) -> L) -> Vec3<L> {
    Vec3::new(
        planes.x.mul_add(inverse.x, all(rest.x)),
        planes.y.mul_add(inverse.y, all(rest.y)),
        planes.z.mul_add(inverse.z, all(rest.z)),
    )
}

/// Returns the smaller t: the second operand if one is NaN; with [`ORDERS_BY_T`] by signed bits.
#[inline(always)]
fn min<L: Lane>(a: L, b: L) -> L {
    if ORDERS_BY_T { L::from_bits(a.to_bits().min_signed(b.to_bits())) } else { a.min(b) }
}

/// Returns the larger t: the second operand if one is NaN; with [`ORDERS_BY_T`] by signed bits.
#[inline(always)]
fn max<L: Lane>(a: L, b: L) -> L {
    if ORDERS_BY_T { L::from_bits(a.to_bits().max_signed(b.to_bits())) } else { a.max(b) }
}

/// Tests the rays of a list against the boxes of a node, one box per lane. Writes one bit per box to `masks`,
/// in the order of the list, and returns the boxes that any ray passes. For closest hits, stores the sums of
/// the entry distances of each box in `distances`. With `ONE` all rays run into one octant.
///
/// With [`ORDERS_BY_T`] a t is compared as an integer: bits of non-negative floats have the order of the
/// floats. Negative floats compare below all those, in reverse order among themselves; this changes nothing,
/// because intervals start at 0 or later and end before that or not. A NaN compares by its sign: its ray may
/// pass no box, or more than it meets, and triangle tests keep no hit of it.
#[inline(always)]
pub fn pass_boxes<const ANY: bool, const ONE: bool>(
    boxes: &Boxes,
    list: &[u16],
    (stream_rays, octants): (&[StreamRay; BATCH], &[u8; BATCH]),
    masks: &mut [u16],
    distances: &mut [f32; WIDE],
) -> u32 {
    type L = Native;
    // Loaded once: the compiler cannot know that masks and boxes do not overlap.
    let octant = octants[ListedRay::new(list[0], stream_rays).ray()];
    let (of_octant_0, of_first_ray) = (in_order::<L>(boxes, 0), in_order::<L>(boxes, octant));
    let occupied = of_octant_0.0.x.le(of_octant_0.1.x).bitmask();
    // The indices in `rest`, along each axis, of the numbers of the first plane and of the second.
    let backwards = |axis: usize| if ONE && ORDERS_BY_T { 3 * usize::from(octant >> axis & 1) } else { 0 };
    let of_first = [backwards(0), 1 + backwards(1), 2 + backwards(2)];
    let of_second = [3 - of_first[0], 5 - of_first[1], 7 - of_first[2]];
    let (mut all, mut sum) = (0, L::zero());
    for (mask, &entry) in masks.iter_mut().zip(list) {
        let listed = ListedRay::new(entry, stream_rays);
        let ray = listed.stream_ray;
        let [x, y, z] = &ray.inverse;
        let inverse = Vec3 { x, y, z }.broadcast();
        let rest = |places: [usize; 3]| {
            let of = |axis: usize| ray.rest(places[axis]);
            Vec3 { x: of(0), y: of(1), z: of(2) }
        };
        // An addend is read from memory by the FMA that may overwrite its factor; the other FMA of an axis
        // overwrites its addend.
        let both = |(first, second): (Vec3<L>, Vec3<L>)| {
            let first = meets(first, inverse, rest(of_first), L::broadcast);
            (first, meets(second, inverse, rest(of_second), |&number| L::splat(number)))
        };
        let (near, far) = if ONE {
            both(of_first_ray)
        } else if ORDERS_BY_T {
            let (a, b) = both(of_octant_0);
            let near = Vec3::new(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z));
            (near, Vec3::new(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)))
        } else {
            both(in_order::<L>(boxes, octants[listed.ray()]))
        };
        // Floats are compared: in this order a NaN in both is kept, and passes no box.
        let near = max(L::zero(), max(max(near.x, near.y), near.z));
        let far = min(L::splat(ray.t), min(min(far.x, far.y), far.z));
        let passes = if ORDERS_BY_T { near.to_bits().le_signed(far.to_bits()) } else { near.le(far) };
        if !ANY {
            sum = sum + near.only(passes);
        }
        *mask = passes.bitmask() as u16;
        all |= u32::from(*mask);
    }
    if !ANY {
        sum.store(&mut distances[..]);
    }
    all & occupied
}
