//! Queries in [`super::Precision::Single`]: [`Tracer`] answers for a batch of rays at once, or every hit is
//! visited.

use super::answer::{AllHits, HitColumns, HitsMut, first_by_ray, part};
use super::input::Rays;
use super::order::TraceOrder;
use super::scene_rays::{SceneRays, Usual};
use super::surfaces::Surfaces;
use crate::columns::{self, Hits};
use crate::exact::ExactRay;
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::traverse::every::{Memory, visit_every_hit, visit_every_hit_of_batch};
use crate::traverse::{Structure, Tracer};
use std::ops::Range;

/// Rays that are traced together, and their hits.
#[derive(Default)]
pub(super) struct Batch {
    tracer: Tracer,
    rays: SceneRays,
    primitive: Vec<u32>,
    weights: [Vec<f32>; 2],
    /// Every hit, by ray.
    found: Vec<(u32, Hit<f32>)>,
}

/// All rays with finite numbers are usual, wherever they begin.
const USUAL: Usual = Usual { numbers: [0.0, f64::MAX], extent: f64::INFINITY };

/// Returns the rays of columns.
fn columns([x, y, z, dx, dy, dz]: &[Vec<f32>; 6]) -> columns::Rays<'_> {
    columns::Rays::new([x, y, z], [dx, dy, dz])
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

/// Returns the greatest start for which t > start is t / scale > t_min, as both are rounded.
fn start(t_min: f64, scale: f64) -> f32 {
    if t_min > 0.0 { end(t_min.next_up(), scale).next_down() } else { 0.0 }
}

impl Batch {
    /// Converts rays to the coordinates of a structure. Those that hit nothing end at NaN.
    fn fill(&mut self, structure: &Structure, rays: &Rays, order: &TraceOrder) {
        let coordinates = structure.coordinates();
        self.rays.fill::<false>(&coordinates, rays, order, &USUAL);
        let SceneRays { columns, starts, ends, scale, unusual, .. } = &mut self.rays;
        let exact_end = |t_max: f64, scale: f64| match t_max {
            f64::INFINITY => f32::INFINITY,
            t_max => end(t_max, scale),
        };
        if !rays.have_no_ends() {
            for (at, &scale) in scale.iter().enumerate() {
                let [t_min, t_max] = rays.ends(order.ray(at));
                (starts[at], ends[at]) = (start(t_min, scale), exact_end(t_max, scale));
            }
        } else {
            starts.fill(0.0);
        }
        for &at in &*unusual {
            ends[at] = f32::NAN;
            let Some(ExactRay { origin, direction, t_min, t_max }) = rays.get(order.ray(at)) else {
                continue;
            };
            // Divided by the largest component, so that no square overflows or underflows.
            let largest = direction.abs().max_element();
            let length = largest * (direction / largest).length();
            let of_ray = length / coordinates.unit;
            if of_ray.is_normal() {
                let direction = (direction / largest).normalize().as_vec3().to_array();
                let from = coordinates.to_scene(origin).as_vec3().to_array();
                columns.iter_mut().zip(from.into_iter().chain(direction)).for_each(|(to, x)| to[at] = x);
                // A t that overflows is no hit.
                (starts[at], ends[at]) = (start(t_min, of_ray), end(t_max.min(f64::MAX), of_ray));
                scale[at] = of_ray;
            }
        }
    }

    /// Traces rays to their first hits; with `ANY`, only whether there is one is defined.
    fn trace<const ANY: bool>(&mut self, structure: &Structure, rays: &Rays, order: &TraceOrder) {
        let count = order.len();
        self.fill(structure, rays, order);
        let Self { tracer, rays: SceneRays { columns, starts, ends, .. }, primitive, weights, .. } = self;
        primitive.clear();
        primitive.resize(count, MISS);
        weights.iter_mut().for_each(|column| column.resize(count, 0.0));
        let mut of_batch = self::columns(columns);
        // The bound is a hit of the last primitive, so that no hit at its t follows it.
        let has_starts = !rays.have_no_ends() && starts.iter().any(|&start| start > 0.0);
        let bound = vec![MISS; if has_starts { count } else { 0 }];
        if has_starts {
            of_batch = of_batch.beyond(starts, &bound);
        }
        let [u, v] = weights;
        tracer.improve::<ANY>(structure, &of_batch, &mut Hits { t: ends, primitive, u, v });
    }

    /// Finds the first hits of rays.
    pub fn closest(
        &mut self,
        (surfaces, structure): (&Surfaces, &Structure),
        rays: &Rays,
        range: Range<usize>,
        mut hits: HitsMut,
    ) {
        let order = TraceOrder::by_blocks(rays, range);
        self.trace::<false>(structure, rays, &order);
        order.for_runs(|places, first| self.write(surfaces, places, first, &mut hits));
    }

    /// Writes the hits of consecutive rays, given their places and the first of the rays.
    #[inline(always)]
    fn write(&self, surfaces: &Surfaces, places: Range<usize>, first: usize, hits: &mut HitsMut) {
        let Self { rays: SceneRays { ends: t, scale, .. }, primitive, weights: [u, v], .. } = self;
        let (count, primitive) = (places.len(), &primitive[places.clone()]);
        let is_hit = |number: u32| number != MISS;
        let of_hits = t[places.clone()].iter().zip(&scale[places.clone()]).zip(primitive);
        for (to, ((t, scale), &number)) in part(hits.t, first, count).iter_mut().zip(of_hits) {
            *to = if is_hit(number) { f64::from(*t) / *scale } else { f64::INFINITY };
        }
        for (to, from) in [(&mut *hits.u, u), (&mut *hits.v, v)] {
            let of_hits = from[places.clone()].iter().zip(primitive);
            for (to, (from, &number)) in part(to, first, count).iter_mut().zip(of_hits) {
                let is_weighted = is_hit(number) & !surfaces.is_sphere(number);
                *to = if is_weighted { f64::from(*from) } else { 0.0 };
            }
        }
        hits.set_primitives(surfaces, first, primitive);
    }

    /// Tests which rays hit anything.
    pub fn occluded(&mut self, structure: &Structure, rays: &Rays, range: Range<usize>) -> Vec<bool> {
        let mut are_occluded = vec![false; range.len()];
        let order = TraceOrder::by_blocks(rays, range);
        if order.has_blocks() {
            // For packets of coherent rays, first hits take no longer than any hits.
            self.trace::<false>(structure, rays, &order);
        } else {
            self.trace::<true>(structure, rays, &order);
        }
        order.for_runs(|places, first| {
            let to = part(&mut are_occluded, first, places.len());
            to.iter_mut().zip(&self.primitive[places]).for_each(|(to, &number)| *to = number != MISS);
        });
        are_occluded
    }

    /// Finds every hit of rays, in any order.
    fn gather(&mut self, structure: &Structure, rays: &Rays, range: Range<usize>, memory: &mut Memory) {
        self.fill(structure, rays, &TraceOrder::as_given(range));
        let Self { rays: SceneRays { columns, starts, ends, .. }, found, .. } = self;
        found.clear();
        let of_batch = self::columns(columns);
        let are_found = visit_every_hit_of_batch(structure, memory, &of_batch, ends, |ray, hit| {
            if hit.t > starts[ray] {
                found.push((ray as u32, hit));
            }
        });
        if are_found {
            return;
        }
        for at in 0..ends.len() {
            let [x, y, z, dx, dy, dz] = columns.each_ref().map(|column| column[at]);
            let ray = Ray { origin: Vec3::new(x, y, z), direction: Vec3::new(dx, dy, dz) };
            let mut hits = Vec::new();
            visit_every_hit(structure, memory, ray, ends[at], &mut |hit| {
                if hit.t > starts[at] {
                    hits.push(hit);
                }
            });
            // A ray that touches a sphere hits it once.
            hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive)));
            hits.dedup_by_key(|hit| (hit.t, hit.primitive));
            found.extend(hits.into_iter().map(|hit| (at as u32, hit)));
        }
    }

    /// Returns the first hits of rays, at most so many.
    pub fn first_hits(
        &mut self,
        (surfaces, structure): (&Surfaces, &Structure),
        rays: &Rays,
        (range, most): (Range<usize>, usize),
        memory: &mut Memory,
    ) -> AllHits {
        let count = range.len();
        self.gather(structure, rays, range, memory);
        let key = |hit: &Hit<f32>| (hit.t.to_bits(), hit.primitive);
        let (offsets, found) = first_by_ray(&self.found, [count, most], |_, a, b| key(a).cmp(&key(b)));
        let mut hits = HitColumns::with_len(found.len());
        let places = offsets
            .windows(2)
            .zip(&self.rays.scale)
            .flat_map(|(ray, scale)| (ray[0]..ray[1]).map(move |at| (at, scale)));
        for (at, scale) in places {
            let Hit { t, primitive, u, v } = found[at];
            let [u, v] = if surfaces.is_sphere(primitive) { [0.0; 2] } else { [u.into(), v.into()] };
            hits.as_mut().set_numbers(at, [f64::from(t) / scale, u, v]);
        }
        let numbers: Vec<u32> = found.iter().map(|hit| hit.primitive).collect();
        hits.as_mut().set_primitives(surfaces, 0, &numbers);
        AllHits { offsets, hits }
    }

    /// Returns how many hits each ray has.
    pub fn count(
        &mut self,
        structure: &Structure,
        rays: &Rays,
        range: Range<usize>,
        memory: &mut Memory,
    ) -> Vec<u32> {
        let mut counts = vec![0; range.len()];
        self.gather(structure, rays, range, memory);
        self.found.iter().for_each(|&(ray, _)| counts[ray as usize] += 1);
        counts
    }
}
