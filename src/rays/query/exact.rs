//! Queries in [`super::Precision::Exact`]: a conservative descent in f32 finds few triangles and decides most
//! of them, and [`crate::exact`] decides the others.

use super::Error;
use super::answer::{AllHits, HitColumns, HitsMut, first_by_ray};
use super::input::{Rays, check_exact};
use super::order::TraceOrder;
use super::scene_rays::{SceneRays, Usual};
use super::surfaces::Surfaces;
use crate::columns;
use crate::exact::{Crossing, DOMAIN, ExactRay, Rule, WIDTH, solve};
use crate::kind::triangle::Candidate;
use crate::math::MISS;
use crate::traverse::Structure;
use crate::traverse::every::{self, Memory, RoundedRay, VisitCandidates, visit_candidates_of_batch};
use glam::DVec3;
use std::cmp::Ordering;
use std::mem::take;
use std::ops::Range;

/// The end of a ray that is done, in the structure.
const DONE: f32 = f32::NEG_INFINITY;

/// Triangles, the hierarchy over them, and rays.
#[derive(Clone, Copy)]
pub(super) struct Exact<'a> {
    pub surfaces: &'a Surfaces,
    pub structure: &'a Structure,
    pub rays: &'a Rays<'a>,
}

/// A hit, and bounds of its t in the structure.
#[derive(Clone, Copy)]
struct Found {
    lo: f32,
    hi: f32,
    number: u32,
}

/// Rays that are traced together.
#[derive(Default)]
pub(super) struct ExactBatch {
    rays: SceneRays,
    nearest: Vec<Found>,
    found: Vec<(u32, Found)>,
}

impl Exact<'_> {
    #[inline(always)]
    fn corners(&self, number: u32) -> [DVec3; 3] {
        self.surfaces.corners(number as usize)
    }

    /// Returns a ray that can hit something.
    #[inline(always)]
    fn ray(&self, at: usize) -> ExactRay {
        self.rays.get(at).expect("rays that hit nothing are left out")
    }

    /// Compares two hits of a ray by t, then number.
    fn compare(&self, at: usize, a: &Found, b: &Found) -> Ordering {
        match () {
            () if a.hi < b.lo => Ordering::Less,
            () if b.hi < a.lo => Ordering::Greater,
            () => self.compare_exactly(&self.ray(at), a.number, b.number),
        }
    }

    #[cold]
    #[inline(never)]
    fn compare_exactly(&self, ray: &ExactRay, a: u32, b: u32) -> Ordering {
        let triangles = [self.corners(a), self.corners(b)];
        let [of_a, of_b] = triangles.each_ref().map(|triangle| ray.crossing(triangle));
        of_a.compare(&of_b, ray, || triangles).then(a.cmp(&b))
    }

    /// Calls `visit` with rays, by their index in the range, and all triangles that they hit by the `rule`
    /// before the ends that `visit` returns. Rays that hit nothing are not visited. With `ANY`, the order of
    /// triangles is arbitrary.
    fn trace<const ANY: bool>(
        &self,
        scene_rays: &mut SceneRays,
        (range, rule): (Range<usize>, Rule),
        memory: &mut Memory,
        mut visit: impl FnMut(usize, Found) -> Option<f32>,
    ) -> Result<(), Error> {
        let usual = Usual { numbers: DOMAIN, extent: every::extent(self.structure) };
        let order = TraceOrder::as_given(range.clone());
        scene_rays.fill::<true>(&self.structure.coordinates(), self.rays, &order, &usual);
        let mut ends = take(&mut scene_rays.ends);
        let SceneRays { columns: [x, y, z, dx, dy, dz], greatest, .. } = &*scene_rays;
        for &at in &scene_rays.unusual {
            let Some(ray) = self.rays.get(range.start + at) else { continue };
            check_exact(&ray, range.start + at)?;
            self.trace_one(&ray, rule, memory, |found| visit(at, found));
        }
        let rays = columns::Rays::new([x, y, z], [dx, dy, dz]);
        let first = range.start;
        let visitor = Visitor { exact: *self, scene_rays, first, rule, visit, uncertain: Vec::new() };
        visit_candidates_of_batch::<ANY>(self.structure, *greatest, memory, &rays, &mut ends, visitor);
        scene_rays.ends = ends;
        Ok(())
    }

    /// Runs [`Exact::trace`] for one ray of any kind. The bounds of its hits order them as their t does.
    fn trace_one(
        &self,
        ray: &ExactRay,
        rule: Rule,
        memory: &mut Memory,
        mut visit: impl FnMut(Found) -> Option<f32>,
    ) {
        let Some(rounded) = RoundedRay::new(self.structure, ray.origin, ray.direction) else { return };
        let mut hits: Vec<(Crossing, u32)> = Vec::new();
        rounded.visit_candidates(self.structure, memory, rounded.end(ray.t_max), |number| {
            hits.push((ray.hit(&self.corners(number), rule)?, number));
            None
        });
        hits.sort_unstable_by(|&(a, of_a), &(b, of_b)| {
            a.compare(&b, ray, || [self.corners(of_a), self.corners(of_b)]).then(of_a.cmp(&of_b))
        });
        for (place, (_, number)) in hits.into_iter().enumerate() {
            let place = place as f32;
            visit(Found { lo: place, hi: place, number });
        }
    }

    /// Finds the first hit of each ray; with `ANY`, any hit.
    fn nearest<const ANY: bool>(
        &self,
        batch: &mut ExactBatch,
        range: Range<usize>,
        memory: &mut Memory,
    ) -> Result<(), Error> {
        let ExactBatch { rays, nearest, .. } = batch;
        nearest.clear();
        nearest.resize(range.len(), Found { lo: f32::INFINITY, hi: f32::INFINITY, number: MISS });
        let first = range.start;
        self.trace::<ANY>(rays, (range, Rule::Closed), memory, |at, found| {
            let nearest = &mut nearest[at];
            let is_nearer = nearest.number == MISS || self.compare(first + at, &found, nearest).is_lt();
            if is_nearer {
                *nearest = found;
            }
            is_nearer.then_some(if ANY { DONE } else { found.hi })
        })
    }

    /// Finds the first hits of rays.
    pub fn closest(
        &self,
        batch: &mut ExactBatch,
        range: Range<usize>,
        memory: &mut Memory,
        mut hits: HitsMut,
    ) -> Result<(), Error> {
        self.nearest::<false>(batch, range.clone(), memory)?;
        let numbers: Vec<u32> = batch.nearest.iter().map(|found| found.number).collect();
        if hits.have_numbers() {
            hits.fill_misses();
            let of_hits = numbers.iter().enumerate().filter(|(_, number)| **number != MISS);
            let of_hits: Vec<_> = of_hits.map(|(at, &number)| (at, range.start + at, number)).collect();
            self.solve(&of_hits, |at, numbers| hits.set_numbers(at, numbers));
        }
        hits.set_primitives(self.surfaces, 0, &numbers);
        Ok(())
    }

    /// Tests which rays hit anything.
    pub fn occluded(
        &self,
        batch: &mut ExactBatch,
        range: Range<usize>,
        memory: &mut Memory,
    ) -> Result<Vec<bool>, Error> {
        self.nearest::<true>(batch, range, memory)?;
        Ok(batch.nearest.iter().map(|found| found.number != MISS).collect())
    }

    /// Returns how many triangles each ray crosses, edges and vertices once.
    pub fn count(
        &self,
        batch: &mut ExactBatch,
        range: Range<usize>,
        memory: &mut Memory,
    ) -> Result<Vec<u32>, Error> {
        let mut counts = vec![0; range.len()];
        self.trace::<true>(&mut batch.rays, (range, Rule::Once), memory, |at, _| {
            counts[at] += 1;
            None
        })?;
        Ok(counts)
    }

    /// Returns the first hits of rays, at most so many.
    pub fn first_hits(
        &self,
        batch: &mut ExactBatch,
        (range, most): (Range<usize>, usize),
        memory: &mut Memory,
    ) -> Result<AllHits, Error> {
        let ExactBatch { rays, found, .. } = batch;
        found.clear();
        self.trace::<true>(rays, (range.clone(), Rule::Closed), memory, |at, hit| {
            found.push((at as u32, hit));
            None
        })?;
        let first = range.start;
        let compare = |at: usize, a: &Found, b: &Found| self.compare(first + at, a, b);
        let (offsets, found) = first_by_ray(found, [range.len(), most], compare);
        let of_rays = offsets
            .windows(2)
            .zip(range)
            .flat_map(|(of_ray, at)| (of_ray[0]..of_ray[1]).map(move |place| (place, at)));
        let of_hits: Vec<_> = of_rays.map(|(place, at)| (place, at, found[place].number)).collect();
        let mut hits = HitColumns::with_len(found.len());
        self.solve(&of_hits, |place, numbers| hits.as_mut().set_numbers(place, numbers));
        for of_ray in offsets.windows(2) {
            // Two hits less than a rounding apart stay in order.
            (of_ray[0] + 1..of_ray[1]).for_each(|at| hits.t[at] = hits.t[at].max(hits.t[at - 1]));
        }
        let numbers: Vec<u32> = found.iter().map(|hit| hit.number).collect();
        hits.as_mut().set_primitives(self.surfaces, 0, &numbers);
        Ok(AllHits { offsets, hits })
    }

    /// Calls `set` with t and the weights of hits, given as their places, rays and triangles.
    fn solve(&self, hits: &[(usize, usize, u32)], mut set: impl FnMut(usize, [f64; 3])) {
        for first in (0..hits.len()).step_by(WIDTH) {
            let ahead = |by: usize| hits[hits.len().min(first + by)..].iter().take(WIDTH);
            ahead(2 * WIDTH).for_each(|&(.., number)| self.surfaces.prefetch_face(number));
            ahead(WIDTH).for_each(|&(.., number)| self.surfaces.prefetch_vertices(number));
            let of_lane = |lane: usize| hits[(first + lane).min(hits.len() - 1)];
            let rays = std::array::from_fn(|lane| self.ray(of_lane(lane).1));
            let triangles = std::array::from_fn(|lane| self.corners(of_lane(lane).2));
            let numbers = solve(&rays, &triangles);
            hits[first..].iter().zip(numbers).for_each(|(&(place, ..), numbers)| set(place, numbers));
        }
    }
}

/// Decides which triangles rays hit.
struct Visitor<'a, V> {
    exact: Exact<'a>,
    scene_rays: &'a SceneRays,
    /// The first ray.
    first: usize,
    rule: Rule,
    visit: V,
    /// The rays and triangles of a node that single precision did not decide.
    uncertain: Vec<(usize, u32)>,
}

/// The number of tests between the prefetch of vertices and their use.
const AHEAD: usize = 6;

impl<V: FnMut(usize, Found) -> Option<f32>> VisitCandidates for Visitor<'_, V> {
    #[inline(always)]
    fn visit(&mut self, ray: usize, Candidate { primitive: number, t }: Candidate) -> Option<f32> {
        match t {
            Some([_, hi]) if hi < self.scene_rays.start(ray)[0] => None,
            Some([lo, hi]) if self.scene_rays.start(ray)[1] < lo && hi < self.scene_rays.sure_end(ray) => {
                (self.visit)(ray, Found { lo, hi, number })
            }
            _ => {
                self.exact.surfaces.prefetch_face(number);
                self.exact.rays.prefetch(self.first + ray);
                self.uncertain.push((ray, number));
                None
            }
        }
    }

    #[inline(always)]
    fn finish(&mut self, mut set_end: impl FnMut(usize, f32)) {
        let (surfaces, uncertain) = (self.exact.surfaces, &self.uncertain);
        uncertain.iter().take(AHEAD).for_each(|&(_, number)| surfaces.prefetch_vertices(number));
        for (at, &(ray, number)) in uncertain.iter().enumerate() {
            if let Some(&(_, next)) = uncertain.get(at + AHEAD) {
                surfaces.prefetch_vertices(next);
            }
            let hit = self.exact.ray(self.first + ray).hit(&self.exact.corners(number), self.rule);
            let Some(crossing) = hit else { continue };
            let [lo, hi] = self.scene_rays.bounds(ray, crossing.bounds());
            if let Some(end) = (self.visit)(ray, Found { lo, hi, number }) {
                set_end(ray, end);
            }
        }
        self.uncertain.clear();
    }
}
