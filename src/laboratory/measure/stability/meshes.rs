//! Closed meshes: rays from inside, aimed at edges, at vertices and anywhere. A leak is a ray that hits
//! nothing. Several triangles may hit a ray at a vertex, so hits are not counted.
//!
//! Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.

use super::methods::triangle_methods;
use super::rays::{packet, towards};
use super::recipe::{Bound, FailureCounts, Recipe};
use super::rng::Rng;
use super::triangles::{WOOP, mean};
use crate::kernel::ray_triangle::TriangleMethod;
use crate::lane::{F32x8, Lane, Mask};
use crate::math::Ray;
use glam::{DVec3, Vec3};

const LEAK: &str = "a ray inside a closed mesh hits nothing";
/// Sizes of meshes, in scene units. The watertight test multiplies three lengths, which f32 represents from
/// 1e-12 to 1e12.
const SIZES: [f64; 9] = [1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12];

pub(super) const RECIPES: &[Recipe] = &[
    Recipe {
        name: "mesh-edges",
        title: "Rays at the edges of a closed mesh",
        axis: "size of the mesh",
        places: &SIZES,
        failure: LEAK,
        error: None,
        source: WOOP,
        cases: 40_000,
        methods: &triangle_methods!(at_edges),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "mesh-vertices",
        title: "Rays at the vertices of a closed mesh",
        axis: "size of the mesh",
        places: &SIZES,
        failure: LEAK,
        error: None,
        source: WOOP,
        cases: 40_000,
        methods: &triangle_methods!(at_vertices),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "mesh-random",
        title: "Rays anywhere at a closed mesh: failures are rarer than at edges",
        axis: "size of the mesh",
        places: &SIZES,
        failure: LEAK,
        error: None,
        source: WOOP,
        cases: 40_000,
        methods: &triangle_methods!(anywhere),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "mesh-offset",
        title: "Rays at the edges of a closed mesh away from the origin of coordinates",
        axis: "distance of the mesh from the origin / its size",
        places: &[0.0, 1.0, 10.0, 100.0, 1e3, 1e4],
        failure: LEAK,
        error: None,
        source: WOOP,
        cases: 40_000,
        methods: &triangle_methods!(away),
        bound: |_| Bound::NO_FAILURE,
    },
];

/// A closed bumpy ball around the origin, star-shaped, of radius about 1: `4 · rows · rows` triangles or so,
/// all vertices shared.
pub fn bumpy_ball(rows: usize) -> Vec<[Vec3; 3]> {
    let columns = 2 * rows;
    let vertex = |row: usize, column: usize| {
        let theta = std::f64::consts::PI * row as f64 / rows as f64;
        let phi = std::f64::consts::TAU * (column % columns) as f64 / columns as f64;
        // The poles are one vertex each.
        let phi = if row == 0 || row == rows { 0.0 } else { phi };
        let unit = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
        let bump = (7.0 * unit.x + 1.0).sin() * (9.0 * unit.y).sin() * (8.0 * unit.z + 2.0).sin();
        (unit * (1.0 + 0.2 * bump)).as_vec3()
    };
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [vertex(row, column), vertex(row, column + 1)];
            let [c, d] = [vertex(row + 1, column), vertex(row + 1, column + 1)];
            if row > 0 {
                triangles.push([a, b, c]);
            }
            if row + 1 < rows {
                triangles.push([b, d, c]);
            }
        }
    }
    triangles
}

/// The target of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Target {
    Edges,
    Vertices,
    Anywhere,
}

/// A ray from inside a mesh that holds the ball of radius 0.3 `size` around `center`, aimed at this triangle
/// of it.
fn from_within(rng: &mut Rng, triangle: [Vec3; 3], center: DVec3, size: f64, aimed_at: Target) -> Ray<f32> {
    let origin = (center + rng.in_cube() * (0.15 * size)).as_vec3();
    let triangle = triangle.map(|vertex| vertex.as_dvec3());
    let corner = rng.index(3);
    let target = match aimed_at {
        Target::Edges => triangle[corner].lerp(triangle[(corner + 1) % 3], rng.unit()),
        Target::Vertices => triangle[corner],
        Target::Anywhere => mean(triangle, rng.barycentrics()),
    };
    towards(origin, target)
}

/// The lanes of eight rays that hit one of these triangles of a mesh, as bits.
type HitLanes<'a> = &'a dyn Fn(&[Ray<f32>; 8], &mut dyn Iterator<Item = usize>) -> u32;

/// Rows of triangles of the mesh.
const ROWS: usize = 24;

/// Leaks of a closed mesh of 2208 triangles of this size and place: rays from inside that hit nothing.
fn leaks<T: TriangleMethod>(
    rng: &mut Rng,
    size: f64,
    offset: f64,
    aimed_at: Target,
    cases: usize,
) -> FailureCounts {
    let center = rng.direction() * (offset * size);
    let place = |vertex: Vec3| (vertex.as_dvec3() * size + center).as_vec3();
    let mesh: Vec<_> = bumpy_ball(ROWS).into_iter().map(|corners| corners.map(place)).collect();
    let stored: Vec<T::Stored> = mesh.iter().map(|&vertices| T::store(vertices)).collect();
    let hits = |rays: &[Ray<f32>; 8], triangles: &mut dyn Iterator<Item = usize>| {
        let prepared = T::prepare(&packet::<F32x8>(rays));
        let mut hit = <F32x8 as Lane>::Mask::splat(false);
        for number in triangles {
            hit = hit | T::test(&prepared, &stored[number], F32x8::splat(f32::INFINITY)).mask;
            if hit.all() {
                break;
            }
        }
        hit.bitmask()
    };
    let ray = |rng: &mut Rng, triangle| from_within(rng, mesh[triangle], center, size, aimed_at);
    count_leaks(rng, mesh.len(), cases, &ray, &hits)
}

/// Aims packets of rays with `ray` at random triangles, and counts those without a hit.
fn count_leaks(
    rng: &mut Rng,
    triangles: usize,
    cases: usize,
    ray: &dyn Fn(&mut Rng, usize) -> Ray<f32>,
    hits: HitLanes,
) -> FailureCounts {
    // Most rays hit the triangle at which they aim or a neighbour, at most a row of triangles away. Only the
    // others are tested against the whole mesh.
    let near = 4 * ROWS + 4;
    let (mut tested, mut left) = (0, Vec::new());
    while tested < cases {
        let first = rng.index(triangles);
        let rays: [Ray<f32>; 8] = std::array::from_fn(|_| ray(rng, first));
        let around = (0..near).flat_map(|step| [first + step, first + triangles - step - 1]);
        let hit = hits(&rays, &mut around.map(|number| number % triangles));
        let count = (cases - tested).min(8);
        left.extend((0..count).filter(|lane| hit >> lane & 1 == 0).map(|lane| rays[lane]));
        tested += count;
    }
    let mut failures = 0;
    for rays in left.chunks(8) {
        let eight = std::array::from_fn(|lane| rays[lane % rays.len()]);
        let hit = hits(&eight, &mut (0..triangles));
        failures += (0..rays.len()).filter(|lane| hit >> lane & 1 == 0).count();
    }
    FailureCounts { tested: cases, failures, errors: Vec::new() }
}

fn at_edges<T: TriangleMethod>(rng: &mut Rng, size: f64, cases: usize) -> FailureCounts {
    leaks::<T>(rng, size, 0.0, Target::Edges, cases)
}

fn at_vertices<T: TriangleMethod>(rng: &mut Rng, size: f64, cases: usize) -> FailureCounts {
    leaks::<T>(rng, size, 0.0, Target::Vertices, cases)
}

fn anywhere<T: TriangleMethod>(rng: &mut Rng, size: f64, cases: usize) -> FailureCounts {
    leaks::<T>(rng, size, 0.0, Target::Anywhere, cases)
}

fn away<T: TriangleMethod>(rng: &mut Rng, offset: f64, cases: usize) -> FailureCounts {
    leaks::<T>(rng, 1.0, offset, Target::Edges, cases)
}
