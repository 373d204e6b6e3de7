//! Frusta around many rays, to cull boxes that none of the rays can meet.
//!
//! Rays from one origin that all run along one axis lie between a least and a greatest slope along each of
//! the other two: four planes. A box is culled if it lies wholly beyond one of them. Only the innermost
//! corner of the box is tested, and each plane contains the direction of one axis, so a plane takes one FMA.
//!
//! The culling is conservative. A ray that passes a padded box ([`crate::kernel::ray_box::BoxRay`]) meets it
//! within (|o| + room) 2⁻²⁰, where |o| is the largest component and room is [`Padding::room`]; the frustum
//! adds twice that along both axes of a side.
//!
//! Source: Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005.

use crate::bvh::WIDE;
use crate::columns::Rays;
use crate::kernel::ray_box::Padding;
use crate::lane::{F32x8, Lane, Mask, Mask8, Native, NativeMask};
use crate::math::{Ray, Vec3};

/// Boxes, one per lane: their lower and upper planes along an axis.
type Planes = [Native; 2];

/// The common origin of a tile's rays, and the axis along which they run: all frusta of the tile share it.
#[derive(Clone, Copy)]
pub struct FrustumAxis {
    /// The indices of the axis along which all rays run and of the other two.
    axes: [usize; 3],
    /// The sign of the rays' direction along the axis: 1 or −1.
    forward: f32,
    origin: [f32; 3],
    /// The padding of boxes on every side, in scene units.
    padding: f32,
}

/// The slopes of the packets of a tile along the two other axes, per unit along the first.
pub type Slopes<const PACKETS: usize> = [[F32x8; PACKETS]; 2];

impl FrustumAxis {
    /// Takes origin and axis from one of the rays; `None` if the rounding error has no finite bound.
    pub fn of(ray: &Ray<f32>, padding: Padding) -> Option<Self> {
        let components = |v: Vec3<f32>| [v.x, v.y, v.z];
        let (direction, origin) = (components(ray.direction), components(ray.origin));
        let size = direction.map(f32::abs);
        let main = if size[0] >= size[1] && size[0] >= size[2] {
            0
        } else if size[1] >= size[2] {
            1
        } else {
            2
        };
        let far = origin.into_iter().fold(0.0, |far: f32, o| far.max(o.abs()));
        let padding = (padding.room(ray.origin) + far) * f32::powi(0.5, 19);
        let forward = 1f32.copysign(direction[main]);
        let axes = [main, (main + 1) % 3, (main + 2) % 3];
        padding.is_finite().then_some(Self { axes, forward, origin, padding })
    }

    /// Computes the slopes of all rays; returns the least and the greatest along each axis, or `None` if a
    /// ray has another origin or does not run along the axis. Domain: whole packets, at most `N`.
    #[inline(always)]
    pub fn slopes<const N: usize>(&self, rays: &Rays, slopes: &mut Slopes<N>) -> Option<[[F32x8; 2]; 2]> {
        let mut fits = Mask8::splat(true);
        let mut span = [[F32x8::splat(f32::INFINITY), F32x8::splat(f32::NEG_INFINITY)]; 2];
        if !rays.begin_at(self.origin) {
            return None;
        }
        let [main, a, b] = self.axes.map(|axis| rays.direction[axis].as_chunks::<8>().0);
        let directions = main.iter().zip(a).zip(b);
        let [to_a, to_b] = slopes;
        for (((main, a), b), (to_a, to_b)) in directions.zip(to_a.iter_mut().zip(to_b)) {
            let main = F32x8::load(main) * F32x8::splat(self.forward);
            let inverse = F32x8::one() / main;
            for (i, (others, to)) in [(a, to_a), (b, to_b)].into_iter().enumerate() {
                let slope = F32x8::load(others) * inverse;
                // A frustum with greater slopes would cull nothing; a NaN fails the comparison.
                fits = fits & slope.abs().le(F32x8::splat(f32::powi(2.0, 20)));
                span[i] = [span[i][0].min(slope), span[i][1].max(slope)];
                *to = slope;
            }
            fits = fits & F32x8::zero().lt(main);
        }
        fits.all()
            .then(|| span.map(|[low, high]| [F32x8::splat(-greatest(-low)), F32x8::splat(greatest(high))]))
    }

    /// Estimates the shares of the two sides of a tile that boxes cover, seen from the origin: 0 for boxes
    /// beside the tile. `span` is the result of [`FrustumAxis::slopes`].
    #[inline(always)]
    pub fn covered(&self, span: &[[F32x8; 2]; 2], boxes: &Boxes) -> [Native; 2] {
        let [main, others @ ..] = self.axes;
        let from_origin = |planes: Planes, axis: usize| planes.map(|p| p - Native::splat(self.origin[axis]));
        let [lo, hi] = from_origin(planes(boxes, main), main);
        let (near, far) = if self.forward > 0.0 { (lo, hi) } else { (-hi, -lo) };
        let inverse = |depth: Native| Native::one() / depth.max(Native::splat(f32::MIN_POSITIVE));
        let (near, far) = (inverse(near), inverse(far));
        [0, 1].map(|i| {
            let [lo, hi] = from_origin(planes(boxes, others[i]), others[i]);
            let lo = lo * Native::select(lo.lt(Native::zero()), near, far);
            let hi = hi * Native::select(hi.lt(Native::zero()), far, near);
            let [least, most] = span[i].map(|slopes| slopes.get(0));
            let share = hi.min(Native::splat(most)) - lo.max(Native::splat(least));
            share.max(Native::zero()) * Native::splat(1.0 / (most - least).max(f32::MIN_POSITIVE))
        })
    }

    /// Returns the distances along the axis at t = 1 of the rays of the packet that starts at `at`.
    #[inline(always)]
    pub fn depths<L: Lane>(&self, rays: &Rays, at: usize) -> L {
        L::load(&rays.direction[self.axes[0]][at..]).abs()
    }

    /// Returns eight frusta, one per lane, around all rays between these slopes: for each of the other axes
    /// the least and the greatest.
    #[inline(always)]
    pub fn frusta(&self, spans: [[F32x8; 2]; 2]) -> Frusta {
        let Self { axes: [main, others @ ..], forward, origin, padding } = *self;
        let side = |i: usize, slope: F32x8, steepest: F32x8, outwards: f32| {
            let outwards = F32x8::splat(outwards);
            // The margin is 8 ε of the steeper slope for the rounding of slopes (the padding alone would do),
            // then the box's padding along both axes.
            let slope = (outwards * steepest).mul_add(F32x8::splat(f32::powi(0.5, 21)), slope);
            let tilt = slope * F32x8::splat(-forward);
            let bound = tilt.mul_add(F32x8::splat(origin[main]), F32x8::splat(origin[others[i]]));
            let room = F32x8::splat(padding) * (F32x8::one() + slope.abs());
            [bytemuck::cast(tilt), bytemuck::cast(room.mul_add(outwards, bound))]
        };
        let sides = [0, 1].map(|i| {
            let [low, high] = spans[i];
            let steepest = low.abs().max(high.abs());
            [side(i, low, steepest, -1.0), side(i, high, steepest, 1.0)]
        });
        Frusta { sides }
    }

    /// Returns one of eight frusta.
    #[inline(always)]
    pub fn frustum(&self, frusta: &Frusta, lane: usize) -> Frustum {
        let start = self.forward * self.origin[self.axes[0]];
        let side = |[tilt, bound]: &[[f32; 8]; 2], outwards: f32| {
            let (tilt, bound) = (tilt[lane & 7], bound[lane & 7]);
            // The innermost corner of the box.
            let corner = usize::from(tilt * outwards <= 0.0);
            Side { tilt: Native::splat(tilt), bound: Native::splat(bound), corner }
        };
        Frustum {
            axes: self.axes,
            backwards: usize::from(self.forward < 0.0),
            forward: Native::splat(self.forward),
            near: Native::splat(-start - self.padding),
            far: Native::splat(-start + self.padding),
            sides: frusta.sides.each_ref().map(|[lower, upper]| [side(lower, -1.0), side(upper, 1.0)]),
        }
    }
}

/// Eight frusta on one axis.
pub struct Frusta {
    /// For each of the two other axes the lower and the upper side: see [`Side`].
    sides: [[[[f32; 8]; 2]; 2]; 2],
}

/// The planes around a packet or a tile of rays.
#[derive(Clone, Copy)]
pub struct Frustum {
    /// See [`FrustumAxis`].
    axes: [usize; 3],
    /// 1 if the rays run downwards along the axis, else 0.
    backwards: usize,
    forward: Native,
    /// Offsets from a coordinate along the axis to a lower and an upper bound of the distance along it.
    near: Native,
    far: Native,
    /// For each of the other axes, the lower and the upper side.
    sides: [[Side; 2]; 2],
}

/// A plane: the points whose coordinate across the axis plus `tilt` times that along it equals `bound`.
#[derive(Clone, Copy)]
struct Side {
    tilt: Native,
    bound: Native,
    /// The plane of a box along the axis that contains its innermost corner: 0 the lower one, 1 the upper
    /// one.
    corner: usize,
}

impl Frustum {
    /// Returns a lower bound of the distance along the axis at which each box begins, and the boxes that a
    /// ray may meet before `limit`; empty boxes and NaN are culled. `main` returns the boxes' lower planes
    /// along that axis for 0 and the upper ones for 1; `across` returns both along another axis.
    #[inline(always)]
    pub fn pass(
        &self,
        main: impl Fn(usize) -> Native,
        across: impl Fn(usize) -> Planes,
        limit: f32,
    ) -> (Native, NativeMask) {
        let near = main(self.backwards).mul_add(self.forward, self.near);
        let far = main(1 - self.backwards).mul_add(self.forward, self.far);
        let ahead = near.le(Native::splat(limit)) & Native::zero().le(far);
        (near, ahead & self.across(&main, across))
    }

    /// Returns the boxes that reach between the sides. NaN does not; an empty box does only if the rounding
    /// error has no finite bound.
    #[inline(always)]
    fn across(&self, main: impl Fn(usize) -> Native, across: impl Fn(usize) -> Planes) -> NativeMask {
        let between = |i: usize| {
            let [lower, upper] = &self.sides[i];
            let [lo, hi] = across(self.axes[1 + i]);
            let most = main(lower.corner).mul_add(lower.tilt, hi);
            let least = main(upper.corner).mul_add(upper.tilt, lo);
            lower.bound.le(most) & least.le(upper.bound)
        };
        between(0) & between(1)
    }

    /// Returns the axis along which the rays run.
    #[inline(always)]
    pub fn axis(&self) -> usize {
        self.axes[0]
    }

    /// Returns the boxes, in the layout of a node, that reach between the sides.
    #[inline(always)]
    pub fn across_boxes(&self, boxes: &Boxes) -> NativeMask {
        self.across(|upper| plane(boxes, self.axes[0] + 3 * upper), |axis| planes(boxes, axis))
    }

    /// Applies [`Frustum::pass`] to boxes in the layout of a node.
    #[inline(always)]
    pub fn pass_boxes(&self, boxes: &Boxes, limit: f32) -> (Native, NativeMask) {
        self.pass(|upper| plane(boxes, self.axes[0] + 3 * upper), |axis| planes(boxes, axis), limit)
    }
}

#[inline(always)]
fn plane(boxes: &Boxes, plane: usize) -> Native {
    Native::load(&boxes[plane & 7])
}

#[inline(always)]
fn planes(boxes: &Boxes, axis: usize) -> Planes {
    [plane(boxes, axis), plane(boxes, axis + 3)]
}

/// The boxes of a node: the lower planes along x, y, z, the upper ones, and two unused rows, so that `& 7`
/// keeps a row index inside.
pub type Boxes = [[f32; WIDE]; 8];

/// Returns the greatest lane. Domain: no lane is NaN.
#[inline(always)]
pub fn greatest<L: Lane>(x: L) -> f32 {
    let mut lanes = [f32::NEG_INFINITY; 16];
    x.store(&mut lanes);
    let [low, high] = [F32x8::load(&lanes), F32x8::load(&lanes[8..])];
    let mut lanes = [0.0; 8];
    low.max(high).store(&mut lanes);
    // Not f32::max, which takes three instructions because of NaN.
    for half in [4, 2, 1] {
        for lane in 0..half {
            lanes[lane] = Lane::max(lanes[lane], lanes[lane + half]);
        }
    }
    lanes[0]
}
