//! Closed meshes: rays from inside, aimed at edges, at vertices and anywhere. A leak is a ray that hits
//! nothing. Several triangles may hit a ray at a vertex, so hits are not counted.
//!
//! Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.

use super::methods::all_methods;
use super::rays::towards;
use super::rng::Rng;
use super::test_case::{Case, FailureCounts, TestCase, trials};
use super::triangles::{WOOP, mean};
use crate::lane::{F32x8, Lane, Mask};
use crate::math::Ray;
use crate::methods::TriangleMethod;
use glam::{DVec3, Vec3};
use std::sync::LazyLock;

/// Sizes of meshes, in scene units. The watertight test multiplies three lengths, which f32 represents from
/// 1e-12 to 1e12.
const SIZES: [f64; 9] = [1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12];

pub(super) fn test_cases() -> Vec<TestCase> {
    let common = |case: Case<Leaks>| TestCase {
        axis: "size of the mesh",
        places: &SIZES,
        failure: "a ray inside a closed mesh hits nothing",
        source: WOOP,
        inputs: 40_000,
        methods: trials(case, &all_methods!(triangle, leaks)),
        ..TestCase::COMMON
    };
    vec![
        TestCase {
            name: "mesh-edges",
            title: "Rays at the edges of a closed mesh",
            ..common(|rng, x, counts, leaks| leaks(rng, counts, x, 0.0, Target::Edges))
        },
        TestCase {
            name: "mesh-vertices",
            title: "Rays at the vertices of a closed mesh",
            ..common(|rng, x, counts, leaks| leaks(rng, counts, x, 0.0, Target::Vertices))
        },
        TestCase {
            name: "mesh-random",
            title: "Rays anywhere at a closed mesh: failures are rarer than at edges",
            ..common(|rng, x, counts, leaks| leaks(rng, counts, x, 0.0, Target::Anywhere))
        },
        TestCase {
            name: "mesh-offset",
            title: "Rays at the edges of a closed mesh away from the origin of coordinates",
            axis: "distance of the mesh from the origin / its size",
            places: &[0.0, 1.0, 10.0, 100.0, 1e3, 1e4],
            ..common(|rng, x, counts, leaks| leaks(rng, counts, 1.0, x, Target::Edges))
        },
    ]
}

/// Returns a closed bumpy ball around the origin, star-shaped, of radius about 1: `4 · rows · rows` triangles
/// or so, all vertices shared.
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

/// Returns a ray from inside a mesh that holds the ball of radius 0.3 `size` around `center`, aimed at this
/// triangle of it.
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

/// The rows of a mesh of 2208 triangles.
const ROWS: usize = 24;
static MESH: LazyLock<Vec<[Vec3; 3]>> = LazyLock::new(|| bumpy_ball(ROWS));
/// Packets of eight rays for each place of the mesh.
const PACKETS: usize = 64;

/// [`leaks`] of one method.
type Leaks = fn(&mut Rng, &mut FailureCounts, f64, f64, Target);

/// Counts rays from inside a mesh of this size and place that hit nothing.
fn leaks<T: TriangleMethod>(
    rng: &mut Rng,
    counts: &mut FailureCounts,
    size: f64,
    offset: f64,
    aimed_at: Target,
) {
    let center = rng.direction() * (offset * size);
    let place = |vertex: Vec3| (vertex.as_dvec3() * size + center).as_vec3();
    let mesh: Vec<_> = MESH.iter().map(|corners| corners.map(place)).collect();
    let stored: Vec<T::Stored> = mesh.iter().map(|&vertices| T::store(vertices)).collect();
    // The rays, of up to eight, that hit none of these triangles.
    let missing = |rays: &[Ray<f32>], triangles: &mut dyn Iterator<Item = usize>| -> Vec<Ray<f32>> {
        let eight: [Ray<f32>; 8] = std::array::from_fn(|lane| rays[lane % rays.len()]);
        let precalculated = T::precalculate(&Ray::<F32x8>::from_lanes(&eight));
        let mut hit = <F32x8 as Lane>::Mask::splat(false);
        for number in triangles {
            hit = hit | T::test(&precalculated, &stored[number], F32x8::splat(f32::INFINITY)).mask;
            if hit.all() {
                break;
            }
        }
        (0..rays.len()).filter(|lane| hit.bitmask() >> lane & 1 == 0).map(|lane| rays[lane]).collect()
    };
    // Most rays hit the triangle at which they aim or a neighbour, at most a row of triangles away. Only the
    // others are tested against the whole mesh.
    let mut left = Vec::new();
    for _ in 0..PACKETS {
        let first = rng.index(mesh.len());
        let rays = [(); 8].map(|()| from_within(rng, mesh[first], center, size, aimed_at));
        let around = (0..4 * ROWS + 4).flat_map(|step| [first + step, first + mesh.len() - step - 1]);
        left.extend(missing(&rays, &mut around.map(|number| number % mesh.len())));
    }
    let leaks: usize = left.chunks(8).map(|rays| missing(rays, &mut (0..mesh.len())).len()).sum();
    (0..8 * PACKETS).for_each(|ray| counts.record(ray < leaks));
}
