//! Slices of numbers, points and rays, in single or double precision.

use super::order::TraceOrder;
use super::{Error, outside};
use crate::exact::{DOMAIN, ExactRay, LEAST_DIRECTION};
use crate::lane::prefetch;
use bytemuck::Zeroable;
use glam::DVec3;
use std::ops::Range;

/// A t_min below 0 and above all other hits before 0: with it, a hit at t = 0 counts.
const BEFORE_0: f64 = -f64::from_bits((1023 - 500) << 52);

/// The number of rays that are loaded together.
pub(super) const BLOCK: usize = 64;

/// Numbers, one for each ray or sphere.
#[derive(Clone, Copy, Debug)]
pub enum Numbers<'a> {
    /// In single precision.
    F32(&'a [f32]),
    /// In double precision.
    F64(&'a [f64]),
    /// One number, the same for all.
    Same(f64),
}

/// Points or vectors, as slices of triples or as columns of x, y and z.
#[derive(Clone, Copy, Debug)]
pub enum Points<'a> {
    /// Triples in single precision.
    F32(&'a [[f32; 3]]),
    /// Triples in double precision.
    F64(&'a [[f64; 3]]),
    /// Columns.
    Columns([Numbers<'a>; 3]),
}

macro_rules! from_slices {
    ($($to:ident::$variant:ident: $([$($n:ident)?] $slice:ty),*;)*) => {$($(
        impl<'a, $(const $n: usize)?> From<&'a $slice> for $to<'a> {
            fn from(items: &'a $slice) -> Self {
                Self::$variant(items)
            }
        }
    )*)*};
}
from_slices! {
    Numbers::F32: [] [f32], [] Vec<f32>, [N] [f32; N];
    Numbers::F64: [] [f64], [] Vec<f64>, [N] [f64; N];
    Points::F32: [] [[f32; 3]], [] Vec<[f32; 3]>, [N] [[f32; 3]; N];
    Points::F64: [] [[f64; 3]], [] Vec<[f64; 3]>, [N] [[f64; 3]; N];
}

impl From<f64> for Numbers<'_> {
    fn from(number: f64) -> Self {
        Self::Same(number)
    }
}

/// Columns of x, y and z.
impl<'a, T: Into<Numbers<'a>>> From<[T; 3]> for Points<'a> {
    fn from(columns: [T; 3]) -> Self {
        Self::Columns(columns.map(Into::into))
    }
}

impl Numbers<'_> {
    /// Returns how many there are, or `None` for one number for all.
    fn len(&self) -> Option<usize> {
        match self {
            Self::F32(numbers) => Some(numbers.len()),
            Self::F64(numbers) => Some(numbers.len()),
            Self::Same(_) => None,
        }
    }
    fn range(self, range: Range<usize>) -> Self {
        match self {
            Self::F32(numbers) => Self::F32(&numbers[range]),
            Self::F64(numbers) => Self::F64(&numbers[range]),
            Self::Same(_) => self,
        }
    }
    #[inline(always)]
    pub(super) fn get(&self, at: usize) -> f64 {
        match self {
            Self::F32(numbers) => numbers[at].into(),
            Self::F64(numbers) => numbers[at],
            Self::Same(number) => *number,
        }
    }
    /// Copies the numbers from `first` on.
    #[inline(always)]
    fn load(&self, first: usize, to: &mut [f64]) {
        match self {
            Self::F32(numbers) => to.iter_mut().zip(&numbers[first..]).for_each(|(to, &x)| *to = x.into()),
            Self::F64(numbers) => to.copy_from_slice(&numbers[first..first + to.len()]),
            Self::Same(number) => to.fill(*number),
        }
    }
    /// Tests whether there are as many as expected.
    pub(super) fn check(&self, of: &'static str, expected: usize) -> Result<(), Error> {
        check(of, self.len().unwrap_or(expected), expected)
    }
}

impl Points<'_> {
    /// Returns the same point for all.
    pub fn same(point: [f64; 3]) -> Self {
        Self::Columns(point.map(Numbers::Same))
    }
    /// Returns how many there are; 0 if the same is for all.
    pub fn len(&self) -> usize {
        self.count().unwrap_or(0)
    }
    fn count(&self) -> Option<usize> {
        match self {
            Self::F32(points) => Some(points.len()),
            Self::F64(points) => Some(points.len()),
            Self::Columns(columns) => columns.iter().find_map(Numbers::len),
        }
    }
    /// Tests whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Returns the points with these indices.
    pub fn range(self, range: Range<usize>) -> Self {
        match self {
            Self::F32(points) => Self::F32(&points[range]),
            Self::F64(points) => Self::F64(&points[range]),
            Self::Columns(columns) => Self::Columns(columns.map(|column| column.range(range.clone()))),
        }
    }
    /// Returns one point.
    #[inline(always)]
    pub fn get(&self, at: usize) -> [f64; 3] {
        match self {
            Self::F32(points) => points[at].map(f64::from),
            Self::F64(points) => points[at],
            Self::Columns(columns) => columns.map(|column| column.get(at)),
        }
    }
    /// Fetches one point into the cache, unless it is in columns.
    #[inline(always)]
    fn prefetch(&self, at: usize) {
        match self {
            Self::F32(points) => prefetch(&points[at]),
            Self::F64(points) => prefetch(&points[at]),
            Self::Columns(_) => {}
        }
    }
    /// Copies points from `first` on as columns.
    #[inline(always)]
    fn load(&self, first: usize, to: [&mut [f64]; 3]) {
        let end = first + to[0].len();
        match self {
            Self::F32(points) => load(&points[first..end], to),
            Self::F64(points) => load(&points[first..end], to),
            Self::Columns(columns) => {
                columns.iter().zip(to).for_each(|(column, to)| column.load(first, to));
            }
        }
    }
    /// Tests whether there are as many as expected.
    pub(super) fn check(&self, of: &'static str, expected: usize) -> Result<(), Error> {
        match self {
            Self::Columns(columns) => columns.iter().try_for_each(|column| column.check(of, expected)),
            Self::F32(_) | Self::F64(_) => check(of, self.len(), expected),
        }
    }
}

#[inline(always)]
fn load<T: Copy + Into<f64>>(points: &[[T; 3]], [x, y, z]: [&mut [f64]; 3]) {
    for (point, ((x, y), z)) in points.iter().zip(x.iter_mut().zip(y).zip(z)) {
        (*x, *y, *z) = (point[0].into(), point[1].into(), point[2].into());
    }
}

pub(super) fn check(of: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Length { of, found, expected }) }
}

/// Rays: points `origin + t · direction` with t_min < t < t_max. Directions have any length.
#[derive(Clone, Copy, Debug)]
pub struct Rays<'a> {
    pub(super) origins: Points<'a>,
    pub(super) directions: Points<'a>,
    t_min: Numbers<'a>,
    t_max: Numbers<'a>,
}

/// Rays as columns. Lanes beyond the last ray hold zeros or earlier rays.
#[derive(Zeroable)]
pub(super) struct Block {
    pub origin: [[f64; BLOCK]; 3],
    pub direction: [[f64; BLOCK]; 3],
    pub t_min: [f64; BLOCK],
    pub t_max: [f64; BLOCK],
}

impl<'a> Rays<'a> {
    /// Creates rays from slices of triples, as `&[[f32; 3]]` or `&[[f64; 3]]`, or from columns, as `[&[f32];
    /// 3]` or `[&[f64]; 3]`.
    pub fn new(origins: impl Into<Points<'a>>, directions: impl Into<Points<'a>>) -> Self {
        let [t_min, t_max] = [0.0, f64::INFINITY].map(Numbers::Same);
        Self { origins: origins.into(), directions: directions.into(), t_min, t_max }
    }
    /// Sets the t_min of each ray, or of all, in lengths of the direction: hits count behind it.
    pub fn after(self, t_min: impl Into<Numbers<'a>>) -> Self {
        Self { t_min: t_min.into(), ..self }
    }
    /// Sets the t_max of each ray, or of all, in lengths of the direction: hits count before it.
    pub fn until(self, t_max: impl Into<Numbers<'a>>) -> Self {
        Self { t_max: t_max.into(), ..self }
    }
    /// Returns the number of rays.
    pub fn len(&self) -> usize {
        self.origins.count().or(self.directions.count()).unwrap_or(0)
    }
    /// Tests whether there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Returns the rays with these indices.
    pub fn range(self, range: Range<usize>) -> Self {
        Self {
            origins: self.origins.range(range.clone()),
            directions: self.directions.range(range.clone()),
            t_min: self.t_min.range(range.clone()),
            t_max: self.t_max.range(range),
        }
    }

    /// Tests whether all columns have the same length.
    pub(super) fn check(&self) -> Result<(), Error> {
        let count = self.len();
        self.origins.check("origins", count)?;
        self.directions.check("directions", count)?;
        self.t_min.check("t_min", count)?;
        self.t_max.check("t_max", count)
    }

    /// Tests whether every t_max is ∞, and no t_min is above 0.
    pub(super) fn have_no_ends(&self) -> bool {
        let are = |numbers: Numbers, matches: fn(f64) -> bool| match numbers {
            Numbers::Same(number) => matches(number),
            _ => false,
        };
        are(self.t_min, |t_min| t_min <= 0.0) && are(self.t_max, |t_max| t_max == f64::INFINITY)
    }

    /// Loads up to [`BLOCK`] rays at the places from `first` on.
    #[inline(always)]
    pub(super) fn load(&self, order: &TraceOrder, first: usize, block: &mut Block) {
        for places in order.runs(first..order.len().min(first + BLOCK)) {
            let (ray, to) = (order.ray(places.start), places.start - first..places.end - first);
            self.origins.load(ray, block.origin.each_mut().map(|column| &mut column[to.clone()]));
            self.directions.load(ray, block.direction.each_mut().map(|column| &mut column[to.clone()]));
            self.t_min.load(ray, &mut block.t_min[to.clone()]);
            self.t_max.load(ray, &mut block.t_max[to]);
        }
        block.t_min.iter_mut().for_each(|t_min| *t_min = after(*t_min));
    }

    /// Fetches the origins and directions of the rays that [`Rays::load`] would return.
    #[inline(always)]
    pub(super) fn prefetch_block(&self, order: &TraceOrder, first: usize) {
        // Two points take at most 48 bytes, so every second ray is fetched.
        for place in (0..BLOCK / 2).map(|pair| first + 2 * pair) {
            if place < order.len() {
                self.prefetch(order.ray(place));
            }
        }
    }

    /// Fetches origin and direction of a ray into the cache.
    #[inline(always)]
    pub(super) fn prefetch(&self, at: usize) {
        self.origins.prefetch(at);
        self.directions.prefetch(at);
    }

    /// Returns t_min and t_max of a ray.
    pub(super) fn ends(&self, at: usize) -> [f64; 2] {
        [after(self.t_min.get(at)), self.t_max.get(at)]
    }

    /// Returns a ray; `None` if it hits nothing.
    #[inline(always)]
    pub(super) fn get(&self, at: usize) -> Option<ExactRay> {
        let (origin, direction) = (DVec3::from(self.origins.get(at)), DVec3::from(self.directions.get(at)));
        let [t_min, t_max] = self.ends(at);
        let can_hit =
            origin.is_finite() && direction.is_finite() && direction != DVec3::ZERO && t_min < t_max;
        can_hit.then_some(ExactRay { origin, direction, t_min, t_max })
    }
}

/// Returns the t_min that the rule for negative ones gives.
#[inline(always)]
fn after(t_min: f64) -> f64 {
    if t_min < 0.0 { BEFORE_0 } else { t_min }
}

/// Tests whether a ray is in the range of numbers of exact answers.
pub(super) fn check_exact(ray: &ExactRay, index: usize) -> Result<(), Error> {
    let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
    let numbers = outside(origin, DOMAIN).or(outside(direction, [LEAST_DIRECTION, DOMAIN[1]]));
    numbers.map_or(Ok(()), |number| Err(Error::Ray { index, number }))
}
