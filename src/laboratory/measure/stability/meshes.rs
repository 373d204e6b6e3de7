//! Closed meshes: rays from inside, aimed at edges, at vertices and anywhere. A leak is a ray that hits nothing; several triangles may
//! claim a ray at a vertex, so hits are not counted.
//!
//! Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.

use super::aim::{packet, towards};
use super::methods::triangle_methods;
use super::triangles::{WOOP, mean};
use super::{Bound, Dice, Recipe, Tally};
use crate::kernel::ray_triangle::TriangleMethod;
use crate::lane::{F32x8, Lane, Mask};
use crate::math::Ray;
use glam::{DVec3, Vec3};

const LEAK: &str = "a ray inside a closed mesh hits nothing";
/// Sizes of meshes, in scene units: the watertight test multiplies three lengths, which have room from 1e-12 to 1e12.
const SIZES: [f64; 9] = [1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12];

pub const RECIPES: &[Recipe] = &[
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
        title: "Rays anywhere at a closed mesh, which hide what aimed ones show",
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

/// A closed bumpy ball around the origin, star-shaped, of radius about 1: `4 · rows · rows` triangles or so, all vertices shared.
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

/// What rays aim at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSample {
    Edges,
    Vertices,
    Anywhere,
}

/// A ray from inside a mesh that holds the ball of radius 0.3 `size` around `center`, aimed at this triangle of it.
fn from_within(dice: &mut Dice, triangle: [Vec3; 3], center: DVec3, size: f64, aim: LightSample) -> Ray<f32> {
    let origin = (center + dice.in_cube() * (0.15 * size)).as_vec3();
    let triangle = triangle.map(|vertex| vertex.as_dvec3());
    let corner = dice.index(3);
    let target = match aim {
        LightSample::Edges => triangle[corner].lerp(triangle[(corner + 1) % 3], dice.unit()),
        LightSample::Vertices => triangle[corner],
        LightSample::Anywhere => mean(triangle, dice.barycentrics()),
    };
    towards(origin, target)
}

/// Leaks of a closed mesh of 2208 triangles, of this size and place: rays from within that hit nothing.
fn leaks<T: TriangleMethod>(
    dice: &mut Dice,
    size: f64,
    offset: f64,
    aim: LightSample,
    cases: usize,
) -> Tally {
    const ROWS: usize = 24;
    let center = dice.direction() * (offset * size);
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
    // Most rays hit what they are aimed at or its neighbours, which are a row of triangles away at most; the others are tried on all.
    let near = 4 * ROWS + 4;
    let (mut thrown, mut left) = (0, Vec::new());
    while thrown < cases {
        let first = dice.index(mesh.len());
        let rays: [Ray<f32>; 8] = std::array::from_fn(|_| from_within(dice, mesh[first], center, size, aim));
        let around = (0..near).flat_map(|step| [first + step, first + mesh.len() - step - 1]);
        let hit = hits(&rays, &mut around.map(|number| number % mesh.len()));
        let count = (cases - thrown).min(8);
        left.extend((0..count).filter(|lane| hit >> lane & 1 == 0).map(|lane| rays[lane]));
        thrown += count;
    }
    let mut failures = 0;
    for rays in left.chunks(8) {
        let eight = std::array::from_fn(|lane| rays[lane % rays.len()]);
        let hit = hits(&eight, &mut (0..mesh.len()));
        failures += (0..rays.len()).filter(|lane| hit >> lane & 1 == 0).count();
    }
    Tally { tested: cases, failures, errors: Vec::new() }
}

fn at_edges<T: TriangleMethod>(dice: &mut Dice, size: f64, cases: usize) -> Tally {
    leaks::<T>(dice, size, 0.0, LightSample::Edges, cases)
}

fn at_vertices<T: TriangleMethod>(dice: &mut Dice, size: f64, cases: usize) -> Tally {
    leaks::<T>(dice, size, 0.0, LightSample::Vertices, cases)
}

fn anywhere<T: TriangleMethod>(dice: &mut Dice, size: f64, cases: usize) -> Tally {
    leaks::<T>(dice, size, 0.0, LightSample::Anywhere, cases)
}

fn away<T: TriangleMethod>(dice: &mut Dice, offset: f64, cases: usize) -> Tally {
    leaks::<T>(dice, 1.0, offset, LightSample::Edges, cases)
}
