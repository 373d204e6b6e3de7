//! Queries in [`super::Precision::Single`]: [`Tracer`] answers for a batch of rays at once, or every hit of a
//! ray is visited.

use super::input::OneRay;
use crate::columns::{Hits, Rays};
use crate::math::{MISS, Ray, Vec3};
use crate::traverse::stack::Stack;
use crate::traverse::{Structure, Tracer, visit_every_hit};
use glam::DVec3;

/// A batch of rays in the coordinates of a structure, with directions of unit length, and their hits.
#[derive(Default)]
pub(super) struct Batch {
    /// The x, y and z of the origins and of the directions.
    columns: [Vec<f32>; 6],
    t_min: Vec<f32>,
    t: Vec<f32>,
    primitive: Vec<u32>,
    weights: [Vec<f32>; 2],
    /// The length of each direction in units of the structure.
    scale: Vec<f64>,
}

/// A ray in f32. Hits are between the first and the second end.
struct SceneRay {
    ray: Ray<f32>,
    ends: [f32; 2],
    scale: f64,
}

impl SceneRay {
    #[inline(always)]
    fn new(structure: &Structure, ray: &OneRay) -> Option<Self> {
        let (coordinates, direction) = (structure.coordinates(), DVec3::from(ray.direction));
        let squared = direction.length_squared();
        let (length, direction) = match squared {
            // The tolerance is that of [`Tracer::closest`].
            squared if (squared - 1.0).abs() <= 2e-6 => (1.0, direction),
            1e-200..1e200 => (squared.sqrt(), direction / squared.sqrt()),
            _ => {
                // Divided by the largest component, so that no square overflows or underflows.
                let largest = direction.abs().max_element();
                let length = largest * (direction / largest).length();
                (length, direction / length)
            }
        };
        let scale = length / coordinates.unit;
        let end = if ray.t_max == f64::INFINITY { f32::INFINITY } else { end(ray.t_max, scale) };
        let ends = [(ray.t_min * scale) as f32, end];
        let ray = Ray {
            origin: Vec3::splat(coordinates.to_scene(ray.origin.into()).as_vec3()),
            direction: Vec3::splat(direction.as_vec3()),
        };
        (scale.is_normal()).then_some(Self { ray, ends, scale })
    }
}

/// Returns the least end for which t < end is t / scale < t_max, as both are rounded.
fn end(t_max: f64, scale: f64) -> f32 {
    let near = (t_max * scale) as f32;
    let is_behind = |end: f32| f64::from(end) / scale >= t_max;
    match is_behind(near) {
        true if is_behind(near.next_down()) => near.next_down(),
        true => near,
        false => near.next_up(),
    }
}

impl Batch {
    /// Fills the batch; `None` is a ray that hits nothing.
    fn fill(&mut self, structure: &Structure, rays: impl ExactSizeIterator<Item = Option<OneRay>>) {
        let Self { columns, t_min, t, primitive, weights, scale } = self;
        let count = rays.len();
        columns.iter_mut().chain([&mut *t_min, &mut *t]).for_each(|column| column.resize(count, 0.0));
        scale.resize(count, 0.0);
        let [x, y, z, dx, dy, dz] = columns.each_mut().map(|column| &mut column[..count]);
        let (t_min, t, scale) = (&mut t_min[..count], &mut t[..count], &mut scale[..count]);
        let nothing = SceneRay {
            ray: Ray { origin: Vec3::zero(), direction: Vec3::zero() },
            ends: [0.0, f32::NAN],
            scale: 1.0,
        };
        for (at, ray) in (0..count).zip(rays) {
            let ray = ray.and_then(|ray| SceneRay::new(structure, &ray));
            let SceneRay { ray: Ray { origin: o, direction: d }, ends, scale: of_ray } =
                ray.as_ref().unwrap_or(&nothing);
            (x[at], y[at], z[at], dx[at], dy[at], dz[at]) = (o.x, o.y, o.z, d.x, d.y, d.z);
            (t_min[at], t[at], scale[at]) = (ends[0], ends[1], *of_ray);
        }
        primitive.clear();
        primitive.resize(t.len(), MISS);
        weights.iter_mut().for_each(|column| column.resize(t.len(), 0.0));
    }

    /// Traces rays to their first hits; with `ANY`, only whether there is one is defined.
    pub fn trace<const ANY: bool>(
        &mut self,
        (structure, tracer): (&Structure, &mut Tracer),
        rays: impl ExactSizeIterator<Item = Option<OneRay>>,
    ) {
        self.fill(structure, rays);
        let [x, y, z, dx, dy, dz] = &self.columns;
        let mut rays = Rays::new([x, y, z], [dx, dy, dz]);
        // The bound is a hit of the last primitive, so that no hit at its t follows it.
        let bound = vec![MISS; if self.t_min.iter().any(|&t_min| t_min > 0.0) { rays.len() } else { 0 }];
        if !bound.is_empty() {
            rays = rays.beyond(&self.t_min, &bound);
        }
        let [u, v] = &mut self.weights;
        let mut hits = Hits { t: &mut self.t, primitive: &mut self.primitive, u, v };
        tracer.improve::<ANY>(structure, &rays, &mut hits);
    }

    /// Returns t, the weights and the primitive of a ray's hit.
    pub fn hit(&self, at: usize) -> Option<([f64; 3], u32)> {
        let [u, v] = self.weights.each_ref().map(|column| f64::from(column[at]));
        let t = f64::from(self.t[at]) / self.scale[at];
        (self.primitive[at] != MISS).then_some(([t, u, v], self.primitive[at]))
    }
}

/// Calls `push` with t, weights and primitive of each hit of a ray, in order.
pub(super) fn every_hit(
    structure: &Structure,
    ray: &OneRay,
    stack: &mut Stack,
    mut push: impl FnMut([f64; 3], u32),
) {
    let Some(SceneRay { ray, ends: [start, end], scale }) = SceneRay::new(structure, ray) else { return };
    let mut hits = Vec::new();
    visit_every_hit(structure, stack, ray, end, &mut |hit| {
        if hit.t > start {
            hits.push(hit);
        }
    });
    hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive)));
    // A ray that touches a sphere hits it once.
    hits.dedup_by_key(|hit| (hit.t, hit.primitive));
    hits.iter().for_each(|hit| push([f64::from(hit.t) / scale, hit.u.into(), hit.v.into()], hit.primitive));
}
