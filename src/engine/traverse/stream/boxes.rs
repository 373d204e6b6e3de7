//! The rays of a list against the boxes of a node.

use super::listed::BATCH;
use super::listed::ListedRay;
use super::record::Record;
use crate::lane::{Bits, Lane, Mask, Native, NativeBits};
use crate::math::Vec3;
use crate::traverse::frustum::Boxes;

/// Whether the two planes of an axis are ordered by their t, or by the ray's octant. AMD's processors, which
/// alone have SSE4a, do the first in few cycles, as integers, and load fewer vectors a cycle: there the
/// planes stay in registers for all rays of a list. Intel's load those that the ray meets first and second.
const ORDERS_BY_T: bool = cfg!(target_feature = "sse4a");

/// The rows of a node's planes in the order in which rays of an octant meet them.
#[derive(Clone, Copy)]
struct Order {
    first: [usize; 3],
    second: [usize; 3],
}

impl Order {
    #[inline(always)]
    fn of(record: &Record) -> Self {
        let backwards = |axis: usize| 3 * usize::from(record.is_backwards(axis));
        let [x, y, z] = [backwards(0), backwards(1), backwards(2)];
        Self { first: [x, 1 + y, 2 + z], second: [3 - x, 4 - y, 5 - z] }
    }
}

/// These rows of a node, of which `& 7` keeps the index inside.
#[inline(always)]
fn rows(boxes: &Boxes, rows: [usize; 3]) -> Vec3<Native> {
    let row = |row: usize| Native::load(&boxes[row & 7]);
    Vec3::new(row(rows[0]), row(rows[1]), row(rows[2]))
}

/// The t at which a ray meets three planes, given with their rows. `all` brings a number of the ray into all
/// lanes.
#[inline(always)]
fn meets(
    record: &Record,
    inverse: Vec3<Native>,
    (planes, rows): (Vec3<Native>, [usize; 3]),
    all: impl Fn(&f32) -> Native,
) -> [NativeBits; 3] {
    // `rest` lies behind the three numbers of `inverse`; `& 15` drops the bounds check.
    let numbers: &[f32; 16] = bytemuck::cast_ref(record);
    let t = |plane: Native, inverse: Native, row: usize| {
        plane.mul_add(inverse, all(&numbers[(3 + row) & 15])).to_bits()
    };
    [t(planes.x, inverse.x, rows[0]), t(planes.y, inverse.y, rows[1]), t(planes.z, inverse.z, rows[2])]
}

/// Tests the rays of a list against the boxes of a node: one bit a box in `masks`, in the order of the list.
/// Returns the boxes that any of them passes. Adds the entry distances to `distances`, box by box, unless any
/// hit will do. With `ONE` all rays run into one octant.
///
/// A t is compared as an integer: bits of non-negative floats have the order of the floats. Negative ones are
/// below all those, in reverse order among themselves, which changes nothing: intervals start at 0 or later,
/// and end before that or not. A NaN is above or below all numbers by its sign. In both bounds alike, as rays
/// that have one have it, it passes no box.
#[inline(always)]
pub fn pass_boxes<const ANY: bool, const ONE: bool>(
    boxes: &Boxes,
    list: &[u16],
    records: &[Record; BATCH],
    masks: &mut [u16],
    distances: &mut Native,
) -> u32 {
    let Order { first, second } = Order::of(ListedRay::new(list[0], records).record);
    // Loaded once: the compiler cannot know that masks do not lie where boxes do.
    let planes = |of: [usize; 3]| (rows(boxes, of), of);
    let (low, high, first, second) = (planes([0, 1, 2]), planes([3, 4, 5]), planes(first), planes(second));
    let occupied = low.0.x.le(high.0.x).bitmask();
    let (mut all, mut sum) = (0, *distances);
    for (mask, &entry) in masks.iter_mut().zip(list) {
        let record = ListedRay::new(entry, records).record;
        let [x, y, z] = &record.inverse;
        let inverse = Vec3 { x, y, z }.broadcast();
        // The operand of an FMA that it need not keep is read from memory by the FMA itself; the sum of the
        // first goes where the addend was, as the factor is needed once more.
        let both = |first: (Vec3<Native>, [usize; 3]), second: (Vec3<Native>, [usize; 3])| {
            let first = meets(record, inverse, first, Native::broadcast);
            (first, meets(record, inverse, second, |&number| Native::splat(number)))
        };
        let (near, far) = if ONE {
            both(first, second)
        } else if ORDERS_BY_T {
            let (a, b) = both(low, high);
            (
                [a[0].min_signed(b[0]), a[1].min_signed(b[1]), a[2].min_signed(b[2])],
                [a[0].max_signed(b[0]), a[1].max_signed(b[1]), a[2].max_signed(b[2])],
            )
        } else {
            let Order { first, second } = Order::of(record);
            both(planes(first), planes(second))
        };
        let near = near[0].max_signed(near[1]).max_signed(near[2].max_signed(NativeBits::splat(0)));
        let t = NativeBits::splat(record.t.to_bits());
        let far = far[0].min_signed(far[1]).min_signed(far[2].min_signed(t));
        let passes = near.le_signed(far);
        if !ANY {
            sum = sum + Native::from_bits(near).only(passes);
        }
        *mask = passes.bitmask() as u16;
        all |= u32::from(*mask);
    }
    *distances = sum;
    all & occupied
}
