//! The answers of queries, as columns.

use crate::math::MISS;

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

impl HitColumns {
    pub(super) fn with_capacity(count: usize) -> Self {
        let numbers = || Vec::with_capacity(count);
        let [surface, primitive] = [(); 2].map(|()| Vec::with_capacity(count));
        Self { t: numbers(), surface, primitive, u: numbers(), v: numbers() }
    }
    /// Returns the number of hits, misses included.
    pub fn len(&self) -> usize {
        self.t.len()
    }
    /// Tests whether there are neither hits nor misses.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    #[inline(always)]
    pub(super) fn push(&mut self, [t, u, v]: [f64; 3], (surface, primitive): (u32, u32)) {
        self.t.push(t);
        self.surface.push(surface);
        self.primitive.push(primitive);
        self.u.push(u);
        self.v.push(v);
    }
    pub(super) fn push_miss(&mut self) {
        self.push([f64::INFINITY, 0.0, 0.0], (MISS, MISS));
    }
    pub(super) fn append(&mut self, mut other: Self) {
        self.t.append(&mut other.t);
        self.surface.append(&mut other.surface);
        self.primitive.append(&mut other.primitive);
        self.u.append(&mut other.u);
        self.v.append(&mut other.v);
    }
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
    /// Ends the hits of a ray.
    pub(super) fn end_ray(&mut self) {
        self.offsets.push(self.hits.len());
    }
    /// Appends the hits of more rays.
    pub fn append(&mut self, other: Self) {
        let before = self.hits.len();
        self.offsets.extend(other.offsets.into_iter().skip(1).map(|offset| before + offset));
        self.hits.append(other.hits);
    }
}
