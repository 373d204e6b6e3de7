//! Slices of numbers, points and rays, in single or double precision.

use super::{Error, outside};
use std::ops::Range;

/// A t_min below 0 and above all other hits before 0: with it, a hit at t = 0 counts.
const BEFORE_0: f64 = -f64::from_bits((1023 - 500) << 52);

/// Numbers, one for each ray or sphere.
#[derive(Clone, Copy, Debug)]
pub enum Numbers<'a> {
    /// In single precision.
    F32(&'a [f32]),
    /// In double precision.
    F64(&'a [f64]),
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
    ($($variant:ident($number:ty)),*) => {$(
        impl<'a> From<&'a [$number]> for Numbers<'a> {
            fn from(numbers: &'a [$number]) -> Self {
                Self::$variant(numbers)
            }
        }
        impl<'a> From<&'a Vec<$number>> for Numbers<'a> {
            fn from(numbers: &'a Vec<$number>) -> Self {
                Self::$variant(numbers)
            }
        }
        impl<'a, const N: usize> From<&'a [$number; N]> for Numbers<'a> {
            fn from(numbers: &'a [$number; N]) -> Self {
                Self::$variant(numbers)
            }
        }
        impl<'a> From<&'a [[$number; 3]]> for Points<'a> {
            fn from(points: &'a [[$number; 3]]) -> Self {
                Self::$variant(points)
            }
        }
        impl<'a> From<&'a Vec<[$number; 3]>> for Points<'a> {
            fn from(points: &'a Vec<[$number; 3]>) -> Self {
                Self::$variant(points)
            }
        }
        impl<'a, const N: usize> From<&'a [[$number; 3]; N]> for Points<'a> {
            fn from(points: &'a [[$number; 3]; N]) -> Self {
                Self::$variant(points)
            }
        }
    )*};
}
from_slices!(F32(f32), F64(f64));

/// Columns of x, y and z.
impl<'a, T: Into<Numbers<'a>>> From<[T; 3]> for Points<'a> {
    fn from(columns: [T; 3]) -> Self {
        Self::Columns(columns.map(Into::into))
    }
}

impl Numbers<'_> {
    /// Returns how many there are.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::F32(numbers) => numbers.len(),
            Self::F64(numbers) => numbers.len(),
        }
    }
    fn range(self, range: Range<usize>) -> Self {
        match self {
            Self::F32(numbers) => Self::F32(&numbers[range]),
            Self::F64(numbers) => Self::F64(&numbers[range]),
        }
    }
    #[inline(always)]
    pub(super) fn get(&self, at: usize) -> f64 {
        match self {
            Self::F32(numbers) => numbers[at].into(),
            Self::F64(numbers) => numbers[at],
        }
    }
}

impl Points<'_> {
    /// Returns how many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(points) => points.len(),
            Self::F64(points) => points.len(),
            Self::Columns([x, ..]) => x.len(),
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
    /// Tests whether there are as many as expected.
    pub(super) fn check(&self, of: &'static str, expected: usize) -> Result<(), Error> {
        let columns = match self {
            Self::Columns(columns) => columns.map(|column| column.len()),
            _ => [self.len(); 3],
        };
        columns.into_iter().try_for_each(|found| check(of, found, expected))
    }
}

pub(super) fn check(of: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Length { of, found, expected }) }
}

/// Rays: points `origin + t · direction` with t_min < t < t_max. Directions have any length.
#[derive(Clone, Copy, Debug)]
pub struct Rays<'a> {
    origins: Points<'a>,
    directions: Points<'a>,
    t_min: Option<Numbers<'a>>,
    t_max: Option<Numbers<'a>>,
}

/// One ray that can hit something.
#[derive(Clone, Copy, Debug)]
pub(super) struct OneRay {
    pub origin: [f64; 3],
    pub direction: [f64; 3],
    pub t_min: f64,
    pub t_max: f64,
}

impl<'a> Rays<'a> {
    /// Creates rays from slices of triples, as `&[[f32; 3]]` or `&[[f64; 3]]`, or from columns, as `[&[f32];
    /// 3]` or `[&[f64]; 3]`.
    pub fn new(origins: impl Into<Points<'a>>, directions: impl Into<Points<'a>>) -> Self {
        Self { origins: origins.into(), directions: directions.into(), t_min: None, t_max: None }
    }
    /// Sets the t_min of each ray, in lengths of its direction: hits count behind it.
    pub fn after(self, t_min: impl Into<Numbers<'a>>) -> Self {
        Self { t_min: Some(t_min.into()), ..self }
    }
    /// Sets the t_max of each ray, in lengths of its direction: hits count before it.
    pub fn until(self, t_max: impl Into<Numbers<'a>>) -> Self {
        Self { t_max: Some(t_max.into()), ..self }
    }
    /// Returns the number of rays.
    pub fn len(&self) -> usize {
        self.origins.len()
    }
    /// Tests whether there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Returns the rays with these indices.
    pub fn range(self, range: Range<usize>) -> Self {
        let ends = |ends: Option<Numbers<'a>>| ends.map(|ends| ends.range(range.clone()));
        Self {
            origins: self.origins.range(range.clone()),
            directions: self.directions.range(range.clone()),
            t_min: ends(self.t_min),
            t_max: ends(self.t_max),
        }
    }

    /// Tests whether all columns have the same length.
    pub(super) fn check(&self) -> Result<(), Error> {
        let count = self.len();
        self.origins.check("origins", count)?;
        self.directions.check("directions", count)?;
        self.t_min.map_or(Ok(()), |t_min| check("t_min", t_min.len(), count))?;
        self.t_max.map_or(Ok(()), |t_max| check("t_max", t_max.len(), count))
    }

    /// Returns a ray; `None` if it hits nothing.
    #[inline(always)]
    pub(super) fn get(&self, at: usize) -> Option<OneRay> {
        let (origin, direction) = (self.origins.get(at), self.directions.get(at));
        let t_min = self.t_min.map_or(0.0, |t_min| t_min.get(at));
        let t_max = self.t_max.map_or(f64::INFINITY, |t_max| t_max.get(at));
        let t_min = if t_min < 0.0 { BEFORE_0 } else { t_min };
        let is_finite = origin.iter().chain(&direction).all(|component| component.is_finite());
        (is_finite && direction != [0.0; 3] && t_min < t_max).then_some(OneRay {
            origin,
            direction,
            t_min,
            t_max,
        })
    }
}

impl OneRay {
    /// Tests whether the ray is in the range of numbers of exact answers.
    pub fn check(&self, index: usize) -> Result<(), Error> {
        let numbers = self.origin.into_iter().chain(self.direction);
        outside(numbers).map_or(Ok(()), |number| Err(Error::Ray { index, number }))
    }
}
