//! The answers of queries, as columns.

use super::Error;
use super::input::check;
use super::surfaces::Surfaces;
use crate::math::MISS;
use std::cmp::Ordering;
use std::mem::take;

/// Hits as columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HitColumns {
    /// The distances in lengths of the directions; ∞ for a miss.
    pub t: Vec<f64>,
    /// The surfaces, in the order of adding from 0; [`MISS`] for a miss.
    pub surface: Vec<u32>,
    /// The faces of the mesh, or the spheres, from 0; [`MISS`] for a miss.
    pub primitive: Vec<u32>,
    /// The barycentric weights of the second vertex; 0 on spheres.
    pub u: Vec<f64>,
    /// The barycentric weights of the third vertex; 0 on spheres.
    pub v: Vec<f64>,
}

/// Columns to write hits into, as in [`HitColumns`]. Empty columns are left out.
#[derive(Debug, Default)]
pub struct HitsMut<'a> {
    /// See [`HitColumns::t`].
    pub t: &'a mut [f64],
    /// See [`HitColumns::surface`].
    pub surface: &'a mut [u32],
    /// See [`HitColumns::primitive`].
    pub primitive: &'a mut [u32],
    /// See [`HitColumns::u`].
    pub u: &'a mut [f64],
    /// See [`HitColumns::v`].
    pub v: &'a mut [f64],
}

impl HitColumns {
    pub(super) fn with_len(count: usize) -> Self {
        let (numbers, weights) = (vec![MISS; count], vec![0.0; count]);
        let t = vec![f64::INFINITY; count];
        Self { t, surface: numbers.clone(), primitive: numbers, u: weights.clone(), v: weights }
    }
    /// Returns the number of hits, misses included.
    pub fn len(&self) -> usize {
        self.t.len()
    }
    /// Tests whether there are neither hits nor misses.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Returns all columns to write into.
    pub fn as_mut(&mut self) -> HitsMut<'_> {
        let Self { t, surface, primitive, u, v } = self;
        HitsMut { t, surface, primitive, u, v }
    }
    pub(super) fn append(&mut self, mut other: Self) {
        self.t.append(&mut other.t);
        self.surface.append(&mut other.surface);
        self.primitive.append(&mut other.primitive);
        self.u.append(&mut other.u);
        self.v.append(&mut other.v);
    }
}

impl HitsMut<'_> {
    pub(super) fn check(&self, count: usize) -> Result<(), Error> {
        let Self { t, surface, primitive, u, v } = self;
        let lengths = [t.len(), surface.len(), primitive.len(), u.len(), v.len()];
        lengths.into_iter().filter(|&length| length > 0).try_for_each(|found| check("hits", found, count))
    }

    /// Splits columns after `count` hits. Columns that are left out stay empty.
    pub fn split(self, count: usize) -> (Self, Self) {
        fn at<T>(column: &mut [T], count: usize) -> (&mut [T], &mut [T]) {
            column.split_at_mut(count.min(column.len()))
        }
        let (t, t_rest) = at(self.t, count);
        let (surface, surface_rest) = at(self.surface, count);
        let (primitive, primitive_rest) = at(self.primitive, count);
        let ((u, u_rest), (v, v_rest)) = (at(self.u, count), at(self.v, count));
        let rest = Self { t: t_rest, surface: surface_rest, primitive: primitive_rest, u: u_rest, v: v_rest };
        (Self { t, surface, primitive, u, v }, rest)
    }

    /// Splits columns of `count` hits into parts of `size`.
    pub(super) fn parts(mut self, count: usize, size: usize) -> Vec<Self> {
        let part = |_| {
            let (part, rest) = take(&mut self).split(size);
            self = rest;
            part
        };
        (0..count.div_ceil(size)).map(part).collect()
    }

    /// Tests whether distances or weights are wanted.
    pub(super) fn have_numbers(&self) -> bool {
        !(self.t.is_empty() && self.u.is_empty() && self.v.is_empty())
    }

    /// Writes t and the weights of misses.
    pub(super) fn fill_misses(&mut self) {
        self.t.fill(f64::INFINITY);
        self.u.fill(0.0);
        self.v.fill(0.0);
    }

    /// Writes t and the weights of a hit.
    #[inline(always)]
    pub(super) fn set_numbers(&mut self, at: usize, [t, u, v]: [f64; 3]) {
        set(self.t, at, t);
        set(self.u, at, u);
        set(self.v, at, v);
    }

    /// Writes surfaces and primitives from a place on, given the numbers of the primitives among all.
    pub(super) fn set_primitives(&mut self, surfaces: &Surfaces, first: usize, numbers: &[u32]) {
        let primitive = part(self.primitive, first, numbers.len());
        let surface = part(self.surface, first, numbers.len());
        if surfaces.is_one_mesh() {
            if !primitive.is_empty() {
                primitive.copy_from_slice(numbers);
            }
            for (surface, &number) in surface.iter_mut().zip(numbers) {
                *surface = if number == MISS { MISS } else { 0 };
            }
            return;
        }
        for (at, &number) in numbers.iter().enumerate() {
            let place = if number == MISS { (MISS, MISS) } else { surfaces.place(number) };
            set(surface, at, place.0);
            set(primitive, at, place.1);
        }
    }
}

/// Returns a part of a column, which may be empty.
#[inline(always)]
pub(super) fn part<T>(column: &mut [T], first: usize, count: usize) -> &mut [T] {
    if column.is_empty() { &mut [] } else { &mut column[first..first + count] }
}

#[inline(always)]
fn set<T>(column: &mut [T], at: usize, value: T) {
    if let Some(place) = column.get_mut(at) {
        *place = value;
    }
}

/// Sorts values by ray, of which there are `count`, and the values of each ray by `compare`; keeps the first
/// `most` of each. Returns where the values of each ray begin, with the number of all at the end, and the
/// values.
pub(super) fn first_by_ray<T: Copy>(
    found: &[(u32, T)],
    [count, most]: [usize; 2],
    compare: impl Fn(usize, &T, &T) -> Ordering,
) -> (Vec<usize>, Vec<T>) {
    // The place of the next value of each ray. After the second loop it is the end of its values.
    let mut next = vec![0; count + 1];
    found.iter().for_each(|&(ray, _)| next[ray as usize + 1] += 1);
    (1..=count).for_each(|ray| next[ray] += next[ray - 1]);
    let mut values: Vec<T> = found.iter().map(|&(_, value)| value).collect();
    for &(ray, value) in found {
        values[next[ray as usize]] = value;
        next[ray as usize] += 1;
    }
    let (mut offsets, mut start) = (vec![0; count + 1], 0);
    for ray in 0..count {
        let of_ray = start..next[ray];
        values[of_ray.clone()].sort_unstable_by(|a, b| compare(ray, a, b));
        let (kept, to) = (of_ray.len().min(most), offsets[ray]);
        if to < start {
            values.copy_within(start..start + kept, to);
        }
        (offsets[ray + 1], start) = (to + kept, of_ray.end);
    }
    values.truncate(offsets[count]);
    (offsets, values)
}

/// Every hit of each ray. The hits of ray i are those from `offsets[i]` to `offsets[i + 1]`, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct AllHits {
    /// The first hit of each ray, and at the end the number of all hits.
    pub offsets: Vec<usize>,
    /// The hits.
    pub hits: HitColumns,
}

impl Default for AllHits {
    fn default() -> Self {
        Self { offsets: vec![0], hits: HitColumns::default() }
    }
}

impl AllHits {
    /// Leaves out the misses of first hits.
    pub(super) fn of_closest(mut hits: HitColumns) -> Self {
        fn keep<T: Copy>(column: &mut Vec<T>, are_hits: &[bool]) {
            let mut of_value = are_hits.iter();
            column.retain(|_| of_value.next().is_some_and(|is_hit| *is_hit));
        }
        let are_hits: Vec<bool> = hits.primitive.iter().map(|&number| number != MISS).collect();
        let mut offsets = vec![0; are_hits.len() + 1];
        (0..are_hits.len()).for_each(|ray| offsets[ray + 1] = offsets[ray] + usize::from(are_hits[ray]));
        let HitColumns { t, surface, primitive, u, v } = &mut hits;
        [t, u, v].into_iter().for_each(|column| keep(column, &are_hits));
        [surface, primitive].into_iter().for_each(|column| keep(column, &are_hits));
        Self { offsets, hits }
    }
    /// Appends the hits of more rays.
    pub fn append(&mut self, other: Self) {
        let before = self.hits.len();
        self.offsets.extend(other.offsets.into_iter().skip(1).map(|offset| before + offset));
        self.hits.append(other.hits);
    }
}
