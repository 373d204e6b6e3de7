//! Rays of a batch, converted to the coordinates of a structure, many at a time.

use super::input::{BLOCK, Block, Rays};
use super::order::TraceOrder;
use crate::coordinates::Coordinates;
use crate::lane::F64x8;
use crate::traverse::every::{BEFORE, EXTRA, FAR};
use bytemuck::Zeroable;

/// Rays in the coordinates of a structure, with directions of unit length. Origins far away are moved along
/// them, as by [`RoundedRay`](crate::traverse::every::RoundedRay).
#[derive(Default)]
pub(super) struct SceneRays {
    /// The x, y and z of the origins and of the directions.
    pub columns: [Vec<f32>; 6],
    /// Numbers that are not above t_min, not below it, not above t_max and not below it, in the structure. A
    /// ray that hits nothing ends at −∞.
    pub starts: Vec<f32>,
    sure_starts: Vec<f32>,
    sure_ends: Vec<f32>,
    pub ends: Vec<f32>,
    /// Whether all rays, in the structure too, are from 0 to ∞.
    are_endless: bool,
    /// The length of each direction, and how far its origin was moved, in units of the structure.
    pub scale: Vec<f64>,
    moved: Vec<f64>,
    /// The places, in order, of rays that are not [`Usual`]: with bounds, their ends are −∞.
    pub unusual: Vec<usize>,
    /// The greatest extent to add, and the largest coordinate of the origins.
    pub greatest: [f64; 2],
}

/// The rays that need no special care: the absolute values of their numbers, except 0, are in a range, and
/// origins beyond the structure's `extent` are near enough to be moved.
pub(super) struct Usual {
    pub numbers: [f64; 2],
    pub extent: f64,
}

/// The directions whose squared length is between these numbers are usual.
const SQUARED: [f64; 2] = [1e-200, 1e200];
/// Directions whose squared length differs less from 1 count as unit vectors, as in
/// [`crate::Tracer::closest`].
const NEAR_1: f64 = 2e-6;
/// The largest extent to add of usual rays, in extents of the structure.
const NEAR: f64 = 1.0 / 16.0;

/// More than the t_min of endless rays, however it is rounded.
const TINY: f32 = 2.0 * f32::MIN_POSITIVE;

/// A number for each ray of a block.
type Column<T> = [T; BLOCK];

/// The columns of a block.
struct Columns<'a> {
    columns: [&'a mut Column<f32>; 6],
    ends: [&'a mut Column<f32>; 4],
    scale: &'a mut Column<f64>,
    moved: &'a mut Column<f64>,
}

impl SceneRays {
    /// Converts rays. Without `BOUNDS`, no origin is moved, all ends are ∞, and the other bounds of t
    /// are unspecified.
    pub fn fill<const BOUNDS: bool>(
        &mut self,
        coordinates: &Coordinates,
        rays: &Rays,
        order: &TraceOrder,
        usual: &Usual,
    ) {
        let Self { columns, starts, sure_starts, sure_ends, ends, scale, moved, unusual, .. } = self;
        let whole = order.len().next_multiple_of(BLOCK);
        let all_ends = [&mut *starts, &mut *sure_starts, &mut *sure_ends, &mut *ends];
        columns.iter_mut().chain(all_ends).for_each(|column| column.resize(whole, 0.0));
        scale.resize(whole, 0.0);
        moved.resize(whole, 0.0);
        unusual.clear();
        let (mut greatest, is_endless) = ([V::ZERO; 2], rays.have_no_ends());
        let mut block = Block::zeroed();
        for first in (0..order.len()).step_by(BLOCK) {
            rays.prefetch_block(order, first + BLOCK);
            rays.load(order, first, &mut block);
            let all_ends = [&mut *starts, &mut *sure_starts, &mut *sure_ends, &mut *ends];
            let to = Columns {
                columns: columns.each_mut().map(|column| chunk(column, first)),
                ends: all_ends.map(|column| chunk(column, first)),
                scale: chunk(scale, first),
                moved: chunk(moved, first),
            };
            let mut left = !convert::<BOUNDS>(&block, coordinates, usual, to, (&mut greatest, is_endless));
            left &= u64::MAX >> (BLOCK - BLOCK.min(order.len() - first));
            while left != 0 {
                unusual.push(first + left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
        let all_ends = [starts, sure_starts, sure_ends, ends];
        columns.iter_mut().chain(all_ends).for_each(|column| column.truncate(order.len()));
        scale.truncate(order.len());
        moved.truncate(order.len());
        self.greatest = greatest.map(|numbers| numbers.to_array().into_iter().fold(0.0, f64::max));
        self.are_endless = is_endless && self.greatest[0] == 0.0;
    }

    /// Returns a number that is not above t_min of a ray in the structure, and one that is not below it.
    #[inline(always)]
    pub fn start(&self, at: usize) -> [f32; 2] {
        if self.are_endless { [-TINY, TINY] } else { [self.starts[at], self.sure_starts[at]] }
    }

    /// Returns a number that is not above t_max of a ray in the structure.
    #[inline(always)]
    pub fn sure_end(&self, at: usize) -> f32 {
        if self.are_endless { f32::INFINITY } else { self.sure_ends[at] }
    }

    /// Returns bounds in the structure of t between two numbers.
    pub fn bounds(&self, at: usize, [lo, hi]: [f64; 2]) -> [f32; 2] {
        let of_t = (V::splat(self.scale[at]), V::splat(self.moved[at]));
        let [lows, highs] = bounds(V::from([lo, hi, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), of_t);
        [lows[0], highs[1]]
    }
}

#[inline(always)]
fn chunk<T>(column: &mut [T], first: usize) -> &mut Column<T> {
    column[first..].first_chunk_mut().expect("columns are whole blocks")
}

/// Numbers of eight rays.
type V = F64x8;

/// Returns numbers that are not above and not below t of rays, in the structure.
#[inline(always)]
fn bounds(t: V, (scale, moved): (V, V)) -> [[f32; 8]; 2] {
    const SLACK: f64 = 1.0 / (1_u64 << 48) as f64;
    // The difference of infinities would be NaN.
    let t = (t * scale).fast_max(V::splat(-1e300)).fast_min(V::splat(1e300));
    let (near, error) = (t - moved, (t.abs() + moved) * V::splat(SLACK));
    let lo = single(near - error).map(|lo| lo.min(f32::MAX));
    let hi = single(near + error);
    let away = |x: f32| x.abs() * f32::EPSILON + f32::MIN_POSITIVE;
    [lo.map(|lo| lo - away(lo)), hi.map(|hi| hi + away(hi))]
}

/// Returns numbers in single precision.
#[inline(always)]
fn single(numbers: V) -> [f32; 8] {
    numbers.to_array().map(|number| number as f32)
}

#[inline(always)]
fn largest([x, y, z]: [V; 3]) -> V {
    x.abs().fast_max(y.abs()).fast_max(z.abs())
}

/// Eight rays in the structure.
struct Converted {
    /// The x, y and z of the origins and of the directions.
    columns: [V; 6],
    scale: V,
    moved: V,
    /// The extent to add, and the largest coordinate of the origins.
    greatest: [V; 2],
    /// Masks of the rays that are usual, and of those among them that can hit something.
    is_usual: V,
    is_near: V,
}

impl Converted {
    #[inline(always)]
    fn new<const BOUNDS: bool>(
        (from, direction): ([V; 3], [V; 3]),
        ends: [V; 2],
        &Coordinates { origin, unit }: &Coordinates,
        &Usual { numbers: [least, most], extent }: &Usual,
    ) -> Self {
        let (zero, one, all) = (V::ZERO, V::ONE, V::splat);
        let fits = |number: &V| {
            let size = number.abs();
            number.simd_eq(zero) | (all(least).simd_le(size) & size.simd_le(all(most)))
        };
        let all_fit = |v: &[V; 3]| fits(&v[0]) & fits(&v[1]) & fits(&v[2]);
        let dot = |p: &[V; 3], q: &[V; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        let axes = [0, 1, 2];
        let squared = dot(&direction, &direction);
        let is_unit = (squared - one).abs().simd_le(all(NEAR_1));
        // Most rays come as unit vectors, and a root takes as long as all else here.
        let length = if is_unit.all() { one } else { is_unit.select(one, squared.sqrt()) };
        let inverse = if is_unit.all() { one } else { one / length };
        let unit_direction = direction.map(|component| component * inverse);
        let inverse_unit = all(1.0 / unit);
        let in_scene = axes.map(|axis| (from[axis] - all(origin[axis])) * inverse_unit);
        let mut is_usual = all_fit(&from)
            & all_fit(&direction)
            & all(SQUARED[0]).simd_le(squared)
            & squared.simd_le(all(SQUARED[1]))
            & ends[0].simd_lt(ends[1]);
        let (mut start, mut moved, mut greatest, mut is_near) = (in_scene, zero, [zero; 2], is_usual);
        if BOUNDS {
            let distance = largest(in_scene);
            let is_far = all(FAR * extent).simd_lt(distance);
            let extra = is_far & (distance * all(EXTRA));
            moved = -dot(&in_scene, &unit_direction) - all(BEFORE * extent);
            moved = is_far & moved.fast_max(zero);
            start = axes.map(|axis| in_scene[axis] + unit_direction[axis] * moved);
            let rest = largest(start);
            is_usual &= extra.simd_le(all(NEAR * extent));
            is_near = is_usual & rest.simd_le(all(8.0 * extent) + extra);
            (moved, greatest) = (is_near & moved, [is_near & extra, is_near & rest]);
        }
        let [x, y, z] = start;
        let [dx, dy, dz] = unit_direction;
        Self {
            columns: [x, y, z, dx, dy, dz].map(|column| is_near & column),
            scale: is_usual.select(length * inverse_unit, one),
            moved,
            greatest,
            is_usual,
            is_near,
        }
    }
}

/// Converts a block of rays; returns one bit for each that is usual. `greatest` holds the greatest extent to
/// add and the largest coordinate so far. `is_endless` says that all rays are from 0 to ∞.
#[inline(always)]
fn convert<const BOUNDS: bool>(
    block: &Block,
    coordinates: &Coordinates,
    usual: &Usual,
    to: Columns,
    (greatest, is_endless): (&mut [V; 2], bool),
) -> u64 {
    let Columns { columns, ends: [starts, sure_starts, sure_ends, ends], scale, moved } = to;
    let mut are_usual = 0;
    let mut doubles = [[0.0; BLOCK]; 6];
    for at in (0..BLOCK).step_by(8) {
        let eight = |column: &Column<f64>| V::from(*part(column, at));
        let of_rays = |[x, y, z]: &[Column<f64>; 3]| [eight(x), eight(y), eight(z)];
        let (t_min, t_max) = (eight(&block.t_min), eight(&block.t_max));
        let rays = (of_rays(&block.origin), of_rays(&block.direction));
        let rays = Converted::new::<BOUNDS>(rays, [t_min, t_max], coordinates, usual);
        for (column, numbers) in doubles.iter_mut().zip(rays.columns) {
            *part_mut(column, at) = numbers.to_array();
        }
        *part_mut(scale, at) = rays.scale.to_array();
        are_usual |= u64::from(rays.is_usual.to_bitmask()) << at;
        let is_near = rays.is_near.to_bitmask();
        if !BOUNDS {
            *part_mut(ends, at) = [f32::INFINITY; 8];
            continue;
        }
        *part_mut(moved, at) = rays.moved.to_array();
        let of_t = (rays.scale, rays.moved);
        if is_near == 0xff && is_endless && !rays.moved.to_array().iter().any(|&moved| moved > 0.0) {
            (*part_mut(starts, at), *part_mut(sure_starts, at)) = ([-TINY; 8], [TINY; 8]);
            (*part_mut(sure_ends, at), *part_mut(ends, at)) = ([f32::INFINITY; 8], [f32::INFINITY; 8]);
        } else {
            [*part_mut(starts, at), *part_mut(sure_starts, at)] = bounds(t_min, of_t);
            let [sure, end] = bounds(t_max, of_t);
            *part_mut(sure_ends, at) = sure;
            let or_nothing =
                |lane: usize| if is_near >> lane & 1 != 0 { end[lane] } else { f32::NEG_INFINITY };
            *part_mut(ends, at) = std::array::from_fn(or_nothing);
        }
        greatest.iter_mut().zip(rays.greatest).for_each(|(most, number)| *most = most.fast_max(number));
    }
    for (column, doubles) in columns.into_iter().zip(&doubles) {
        column.iter_mut().zip(doubles).for_each(|(to, &number)| *to = number as f32);
    }
    are_usual
}

#[inline(always)]
fn part<T>(column: &Column<T>, at: usize) -> &[T; 8] {
    column[at..].first_chunk().expect("blocks are whole parts")
}

#[inline(always)]
fn part_mut<T>(column: &mut Column<T>, at: usize) -> &mut [T; 8] {
    column[at..].first_chunk_mut().expect("blocks are whole parts")
}
