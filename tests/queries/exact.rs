//! Exact answers are those of integers of any size.

use crate::cases::{Mesh, Rng};
use crate::rational::{Hit, Point, Ray, judge};
use octray_rays::query::{AllHits, HitColumns, Intersector, MISS, Precision, Rays, Surfaces};
use rayon::prelude::*;

const PER_MESH: usize = 200;

fn build(mesh: &Mesh) -> Intersector {
    let mut surfaces = Surfaces::new();
    surfaces.add_mesh(&mesh.vertices, &mesh.faces).unwrap();
    surfaces.build(Precision::Exact).unwrap()
}

/// What integers say: the hits of closed triangles in order, and the number of triangles crossed.
fn expected(mesh: &Mesh, ray: &Ray) -> (Vec<(u32, Hit)>, u32) {
    let (mut hits, mut count) = (Vec::new(), 0);
    for face in 0..mesh.faces.len() {
        let (hit, crosses) = judge(ray, &mesh.triangle(face));
        hits.extend(hit.map(|hit| (face as u32, hit)));
        count += u32::from(crosses);
    }
    hits.sort_by(|(a, of_a), (b, of_b)| of_a.t.compare(&of_b.t).then(a.cmp(b)));
    (hits, count)
}

fn is_hit_at(hit: &Hit, hits: &HitColumns, at: usize) -> bool {
    let near = |weight: &crate::rational::Ratio, x: f64| {
        weight.compare_double(x - f64::EPSILON).is_ge() && weight.compare_double(x + f64::EPSILON).is_le()
    };
    let [u, v] = &hit.weights;
    hit.t.is_near(hits.t[at], 2.0) && near(u, hits.u[at]) && near(v, hits.v[at])
}

/// Whether a coordinate is closer to 0 than those that exact queries take.
fn is_refused(ray: &Ray) -> bool {
    let any = |point: &Point, least: f64| point.iter().any(|x| *x != 0.0 && x.abs() < least);
    any(&ray.origin, 2.0_f64.powi(-120)) || any(&ray.direction, 2.0_f64.powi(-162))
}

/// Compares the answers for some rays and one mesh; returns the numbers of hits, and of rays at which a
/// closed and an open triangle differ.
fn compare(seed: u64) -> [usize; 2] {
    let mut rng = Rng(seed);
    let mesh = Mesh::new(&mut rng);
    let intersector = build(&mesh);
    let list: Vec<Ray> = (0..PER_MESH)
        .map(|_| mesh.ray(&mut rng))
        .filter(|ray| ray.direction != [0.0; 3] && ray.range[0] < ray.range[1] && !is_refused(ray))
        .collect();
    let column = |of: fn(&Ray) -> Point| list.iter().map(of).collect::<Vec<_>>();
    let (origins, directions) = (column(|ray| ray.origin), column(|ray| ray.direction));
    let [t_min, t_max] = [0, 1].map(|end| list.iter().map(|ray| ray.range[end]).collect::<Vec<_>>());
    let rays = Rays::new(&origins, &directions).after(&t_min).until(&t_max);
    let closest = intersector.closest(&rays).unwrap();
    let occluded = intersector.occluded(&rays).unwrap();
    let AllHits { offsets, hits } = intersector.all_hits(&rays).unwrap();
    let counts = intersector.count(&rays).unwrap();
    let inside = intersector.contains(&origins).unwrap();
    let mut seen = [0; 2];
    for (at, ray) in list.iter().enumerate() {
        let what = || format!("seed {seed}, ray {at}: {ray:?}");
        let (all, count) = expected(&mesh, ray);
        let range = offsets[at]..offsets[at + 1];
        let numbers: Vec<u32> = all.iter().map(|(number, _)| *number).collect();
        assert_eq!(hits.primitive[range.clone()], numbers, "{}", what());
        assert!(hits.t[range.clone()].is_sorted(), "{}", what());
        for ((_, hit), place) in all.iter().zip(range) {
            assert!(is_hit_at(hit, &hits, place), "{}: {hit:?}, {}", what(), hits.t[place]);
        }
        assert_eq!(occluded[at], !all.is_empty(), "{}", what());
        assert_eq!(closest.primitive[at], numbers.first().copied().unwrap_or(MISS), "{}", what());
        assert!(all.is_empty() || is_hit_at(&all[0].1, &closest, at), "{}", what());
        assert_eq!(counts[at], count, "{}", what());
        if mesh.is_closed && at % 8 == 0 {
            let ray = Ray { direction: [-0.25, 1.0, 0.125], range: [0.0, f64::INFINITY], ..*ray };
            assert_eq!(inside[at], expected(&mesh, &ray).1 % 2 == 1, "contains, {}", what());
        }
        seen = [seen[0] + all.len(), seen[1] + usize::from(count as usize != all.len())];
    }
    seen
}

/// One hundred thousand rays, or as many as `OCTRAY_EXACT_RAYS` says.
#[test]
fn exact_answers_are_those_of_rational_arithmetic() {
    let rays = std::env::var("OCTRAY_EXACT_RAYS").ok().map_or(100_000, |rays| rays.parse().unwrap());
    let meshes = rays / PER_MESH as u64;
    let sum = |[a, b]: [usize; 2], [c, d]: [usize; 2]| [a + c, b + d];
    let seen = (0..meshes).into_par_iter().map(compare).reduce(|| [0; 2], sum);
    assert!(seen[0] as u64 > rays / 2 && seen[1] as u64 > rays / 10, "too few hits: {seen:?}");
}
