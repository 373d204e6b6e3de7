//! Rays and meshes in double precision, aimed at vertices, edges and faces. Coordinates are integers, so that
//! integers decide.

use super::rng::Rng;
use super::test_case::{Bound, FailureCounts, TestCase, compare};
use super::triangles::intersect;
use crate::math::{Ray, Vec3};
use crate::methods::Woop;
use glam::DVec3;
use octray_rays::query::{MISS, Precision, Rays, Surfaces};

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![TestCase {
        name: "meshes-doubles",
        title: "Rays in double precision at vertices, edges and faces of a terrain far from 0",
        axis: "distance from 0 / size of the terrain",
        places: &[0.0, 1.0, 10.0, 100.0, 1e3, 1e4],
        failure: "the hit is missed, or another face is named",
        error: None,
        source: "J. Shewchuk, Adaptive Precision Floating-Point Arithmetic, 1997",
        inputs: 1_000,
        methods: compare(
            first_hits,
            &[
                ("woop-f32", woop),
                ("moller-trumbore-f64", moller_trumbore),
                ("query-single", |terrain, rays| query(terrain, rays, Precision::Single)),
                ("query-exact", |terrain, rays| query(terrain, rays, Precision::Exact)),
            ],
        ),
        bound: |_| Bound::NO_FAILURE,
    }]
}

/// Vertices and faces.
type Terrain = (Vec<DVec3>, Vec<[u32; 3]>);
/// The face that each ray hits first, given origins and directions.
type FirstHits = fn(&Terrain, &[[DVec3; 2]]) -> Vec<Option<u32>>;

/// A vector of integers.
type Whole = [i128; 3];

/// The vertices along a side, and half the size. Products of three sizes and some more fit into an integer,
/// and all coordinates into doubles.
const SIDE: i128 = 5;
const SIZE: i128 = 1 << 36;
/// The rays at a terrain.
const RAYS: usize = 32;

fn add(p: Whole, q: Whole) -> Whole {
    [p[0] + q[0], p[1] + q[1], p[2] + q[2]]
}

fn sub(p: Whole, q: Whole) -> Whole {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

fn doubles(v: Whole) -> DVec3 {
    DVec3::from(v.map(|x| x as f64))
}

/// Returns a random vector with components up to `size`.
fn whole(rng: &mut Rng, size: i128) -> Whole {
    rng.in_cube().to_array().map(|x| (x * size as f64) as i128)
}

/// Returns a terrain around 0. Coordinates are multiples of 4.
fn terrain(rng: &mut Rng) -> (Vec<Whole>, Vec<[u32; 3]>) {
    let place = |i: i128| (2 * i - SIDE + 1) * SIZE / SIDE / 4 * 4;
    let mut moved = || whole(rng, SIZE / SIDE / 8).map(|x| 4 * x);
    let vertex = |i: i128| add([place(i % SIDE), 0, place(i / SIDE)], moved());
    let vertices = (0..SIDE * SIDE).map(vertex).collect();
    let side = SIDE as u32;
    let cells = (0..(side - 1) * (side - 1)).map(|i| i % (side - 1) + i / (side - 1) * side);
    (vertices, cells.flat_map(|i| [[i, i + 1, i + side + 1], [i, i + side + 1, i + side]]).collect())
}

/// Returns origin and direction of a ray that is aimed at a vertex, an edge or a face, or beside a vertex.
fn aimed(rng: &mut Rng, [a, b, c]: [Whole; 3]) -> [Whole; 2] {
    let target = match rng.index(4) {
        0 => a,
        1 => add(a, b).map(|x| x / 2),
        2 => add(add(a, a), add(b, c)).map(|x| x / 4),
        _ => add(a, [0, 1, 0]),
    };
    let origin = add(whole(rng, SIZE), [0, 4 * SIZE, 0]);
    [origin, sub(target, origin)]
}

fn first_hits(rng: &mut Rng, distance: f64, counts: &mut FailureCounts, method: FirstHits) {
    let (vertices, faces) = terrain(rng);
    let corners = |face: usize| faces[face].map(|vertex| vertices[vertex as usize]);
    let rays: Vec<_> = (0..RAYS)
        .map(|_| {
            let face = rng.index(faces.len());
            aimed(rng, corners(face))
        })
        .collect();
    let offset = DVec3::splat((distance * SIZE as f64).round());
    let moved = vertices.iter().map(|&vertex| doubles(vertex) + offset).collect();
    let in_doubles: Vec<_> = rays.iter().map(|&[from, to]| [doubles(from) + offset, doubles(to)]).collect();
    let found = method(&(moved, faces.clone()), &in_doubles);
    for (ray, face) in rays.iter().zip(found) {
        // From so far above, a ray crosses the terrain once.
        let has_hit = || (0..faces.len()).any(|face| is_hit(ray, corners(face)));
        counts.record(!face.map_or_else(|| !has_hit(), |face| is_hit(ray, corners(face as usize))));
    }
}

/// Tests whether a ray hits a closed triangle, which is not behind it.
fn is_hit(&[origin, d]: &[Whole; 2], corners: [Whole; 3]) -> bool {
    let side = |p: Whole, q: Whole| {
        d[0] * (p[1] * q[2] - p[2] * q[1])
            + d[1] * (p[2] * q[0] - p[0] * q[2])
            + d[2] * (p[0] * q[1] - p[1] * q[0])
    };
    let [a, b, c] = corners.map(|corner| sub(corner, origin));
    let signs = [side(b, c), side(c, a), side(a, b)].map(i128::signum);
    signs != [0; 3] && !(signs.contains(&1) && signs.contains(&-1))
}

/// Returns the nearest of hits.
fn nearest(hits: impl Iterator<Item = (u32, f64)>) -> Option<u32> {
    hits.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(face, _)| face)
}

/// The watertight test, on everything rounded to f32.
fn woop((vertices, faces): &Terrain, rays: &[[DVec3; 2]]) -> Vec<Option<u32>> {
    let corners = |face: &[u32; 3]| face.map(|vertex| vertices[vertex as usize].as_vec3());
    let first = |[origin, direction]: &[DVec3; 2]| {
        let ray = Ray {
            origin: Vec3::splat(origin.as_vec3()),
            direction: Vec3::splat(direction.normalize().as_vec3()),
        };
        let t = |face| intersect::<Woop>(corners(face), &ray, f32::INFINITY).map(|[t, ..]| f64::from(t));
        nearest((0..).zip(faces).filter_map(|(number, face)| Some((number, t(face)?))))
    };
    rays.iter().map(first).collect()
}

/// Möller and Trumbore's test in f64.
fn moller_trumbore((vertices, faces): &Terrain, rays: &[[DVec3; 2]]) -> Vec<Option<u32>> {
    let first = |&[origin, direction]: &[DVec3; 2]| {
        let t = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|vertex| vertices[vertex as usize]);
            let (p, s) = (direction.cross(c - a), origin - a);
            let inverse = 1.0 / (b - a).dot(p);
            let q = s.cross(b - a);
            let (u, v, t) = (s.dot(p) * inverse, direction.dot(q) * inverse, (c - a).dot(q) * inverse);
            (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
        };
        nearest((0..).zip(faces).filter_map(|(number, face)| Some((number, t(face)?))))
    };
    rays.iter().map(first).collect()
}

/// The queries of the rays' package.
fn query((vertices, faces): &Terrain, rays: &[[DVec3; 2]], precision: Precision) -> Vec<Option<u32>> {
    let column = |part: usize| rays.iter().map(|ray| ray[part].to_array()).collect::<Vec<_>>();
    let vertices: Vec<_> = vertices.iter().map(|vertex| vertex.to_array()).collect();
    let mut surfaces = Surfaces::new();
    let added = surfaces.add_mesh(&vertices, faces).and_then(|_| surfaces.build(precision));
    let (origins, directions) = (column(0), column(1));
    let hits = added.and_then(|intersector| intersector.closest(&Rays::new(&origins, &directions)));
    let primitive = hits.map(|hits| hits.primitive).expect("integers are in the range of numbers");
    primitive.into_iter().map(|face| (face != MISS).then_some(face)).collect()
}
