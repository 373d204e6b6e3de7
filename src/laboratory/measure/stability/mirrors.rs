//! Thousands of reflections: drift of length and direction, rays that leak out of a closed room.

use super::rays::{ray, to_f64};
use super::rng::Rng;
use super::scenes::{empty, put_box};
use super::test_case::{Bound, EPSILON, FailureCounts, TestCase, compare};
use crate::integrate::RENORMALIZATION_INTERVAL;
use crate::kernel::ray_triangle::{TriangleHit, WoopTriangle};
use crate::kernel::surface::{triangle_normal, triangle_offset};
use crate::math::{Ray, Vec3};
use crate::methods::{TriangleMethod, Woop};
use glam::DVec3;

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![TestCase {
        name: "mirrors-room",
        title: "Paths between the mirrors of a closed room",
        axis: "reflections",
        places: &[1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 1e4, 1e5],
        failure: "the ray leaks out of the room, or the length of its direction differs from 1 by more than 1e-5",
        error: Some("|Δ direction| in radians, up to signs along the room's axes"),
        source: "kernel::ray_sphere, which requires unit length within 1e-5",
        inputs: 48,
        methods: compare(
            room,
            &[
                ("point-along-ray", (along_ray, 1)),
                ("never-mended", (off_surface, u32::MAX)),
                ("mended-each-time", (off_surface, 1)),
                ("mended-each-eighth", (off_surface, RENORMALIZATION_INTERVAL)),
            ],
        ),
        // The rounding of a reflection, always with the same sign.
        bound: |reflections| Bound::error(10.0 * EPSILON * (1.0 + reflections)),
    }]
}

/// A wall, with its offset for spawned rays.
struct Wall {
    stored: WoopTriangle,
    vertices: [Vec3<f32>; 3],
    normal: Vec3<f32>,
    offset: f32,
}

/// The origin of the next ray from the last ray, its hit, and the normal on its side.
type Start = fn(&Ray<f32>, &TriangleHit<f32>, &Wall, Vec3<f32>) -> Vec3<f32>;

/// Returns o + t d, which needs a least t.
fn along_ray(ray: &Ray<f32>, hit: &TriangleHit<f32>, _: &Wall, _: Vec3<f32>) -> Vec3<f32> {
    ray.at(hit.t)
}

/// Returns the renderer's: the point of the barycentric weights, offset by its error bound.
fn off_surface(_: &Ray<f32>, hit: &TriangleHit<f32>, wall: &Wall, normal: Vec3<f32>) -> Vec3<f32> {
    let [a, b, c] = wall.vertices;
    normal.mul_add(wall.offset, (b - a).mul_add(hit.u, (c - a).mul_add(hit.v, a)))
}

/// Follows a ray in a room up to three of its sizes from the origin. `mend`: reflections until a direction is
/// normalised again.
fn room(rng: &mut Rng, reflections: f64, counts: &mut FailureCounts, (start, mend): (Start, u32)) {
    let size = rng.scale(0.1, 10.0);
    let center = rng.in_cube() * (3.0 * size);
    let mut scene = empty();
    let axes = put_box(&mut scene, rng, center, size);
    let walls = scene.triangles.iter().map(|triangle| Wall {
        stored: Woop::store(triangle.vertices),
        vertices: triangle.vertices.map(Vec3::splat),
        normal: Vec3::splat(triangle_normal(triangle.vertices)),
        offset: triangle_offset(triangle.vertices),
    });
    let walls: Vec<Wall> = walls.collect();
    let first = ray(center.as_vec3(), rng.direction().as_vec3());
    let last = follow(first, &walls, reflections as u32, start, mend);
    // Reflections in a box change only signs along its axes.
    let along = |ray: &Ray<f32>| DVec3::from(axes.map(|axis| axis.dot(to_f64(ray).1).abs()));
    match last {
        Some(last) if (to_f64(&last).1.length() - 1.0).abs() <= 1e-5 => {
            counts.record_error(along(&first).angle_between(along(&last)));
        }
        _ => counts.record(true),
    }
}

/// Returns the ray after these reflections; `None` if it leaks out of the room.
fn follow(mut ray: Ray<f32>, walls: &[Wall], reflections: u32, start: Start, mend: u32) -> Option<Ray<f32>> {
    for number in 1..=reflections {
        let precalculated = Woop::precalculate(&ray);
        let mut nearest: Option<(TriangleHit<f32>, &Wall)> = None;
        for wall in walls {
            let limit = nearest.as_ref().map_or(f32::INFINITY, |(hit, _)| hit.t);
            let hit = Woop::test(&precalculated, &wall.stored, limit);
            if hit.mask {
                nearest = Some((hit, wall));
            }
        }
        let (hit, wall) = nearest?;
        let normal = wall.normal.flip_sign(-ray.direction.dot(wall.normal));
        let direction = ray.direction.reflect(normal);
        let direction = if number.is_multiple_of(mend) { direction.normalize() } else { direction };
        ray = Ray { origin: start(&ray, &hit, wall, normal), direction };
    }
    Some(ray)
}
