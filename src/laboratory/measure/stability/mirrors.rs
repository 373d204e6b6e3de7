//! Thousands of reflections: directions that grow, paths that drift, rays that leave a closed room.

use super::aim::{exactly, ray};
use super::scenes::{empty, put_box};
use super::{Bound, Dice, EPSILON, Method, Recipe, Tally};
use crate::integrate::RENORMALIZATION_INTERVAL;
use crate::kernel::ray_triangle::{TriangleHit, TriangleMethod, Woop, WoopTriangle};
use crate::kernel::surface::{triangle_normal, triangle_offset};
use crate::math::{Ray, Vec3};
use glam::DVec3;

pub const RECIPES: &[Recipe] = &[Recipe {
    name: "mirrors-room",
    title: "Paths between the mirrors of a closed room",
    axis: "reflections",
    places: &[1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 1e4, 1e5],
    failure: "the ray leaves the room, or its direction is longer or shorter than 1 by more than 1e-5",
    error: Some("|Δ direction| in radians, but for the sides that the room has mirrored"),
    source: "kernel::ray_sphere, which asks for unit length within 1e-5",
    cases: 48,
    methods: &[
        Method::other("point-along-ray", |dice, x, cases| room(dice, x, cases, along_ray, 1)),
        Method::other("never-mended", |dice, x, cases| room(dice, x, cases, off_surface, u32::MAX)),
        Method::other("mended-each-time", |dice, x, cases| room(dice, x, cases, off_surface, 1)),
        Method::default("mended-each-eighth", |dice, x, cases| {
            room(dice, x, cases, off_surface, RENORMALIZATION_INTERVAL)
        }),
    ],
    // What one reflection rounds, always to the same side.
    bound: |reflections| Bound::error(10.0 * EPSILON * (1.0 + reflections)),
}];

/// What a ray needs to know of a wall.
struct Wall {
    stored: WoopTriangle,
    vertices: [Vec3<f32>; 3],
    normal: Vec3<f32>,
    offset: f32,
}

/// Where the next ray starts: from the last ray, what it hit, and the normal on its side.
type Start = fn(&Ray<f32>, &TriangleHit<f32>, &Wall, Vec3<f32>) -> Vec3<f32>;

/// The school's, which needs a least t.
fn along_ray(ray: &Ray<f32>, hit: &TriangleHit<f32>, _: &Wall, _: Vec3<f32>) -> Vec3<f32> {
    ray.at(hit.t)
}

/// The renderer's: on the surface by its weights, and off it by what those are off.
fn off_surface(_: &Ray<f32>, hit: &TriangleHit<f32>, wall: &Wall, normal: Vec3<f32>) -> Vec3<f32> {
    let [a, b, c] = wall.vertices;
    normal.mul_add(wall.offset, (b - a).mul_add(hit.u, (c - a).mul_add(hit.v, a)))
}

/// A room far from the origin by some of its sizes.
fn room(dice: &mut Dice, reflections: f64, cases: usize, start: Start, mend: u32) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let size = dice.scale(0.1, 10.0);
        let center = dice.in_cube() * (3.0 * size);
        let mut scene = empty();
        let axes = put_box(&mut scene, dice, center, size);
        let walls = scene.triangles.iter().map(|triangle| Wall {
            stored: Woop::store(triangle.vertices),
            vertices: triangle.vertices.map(Vec3::splat),
            normal: Vec3::splat(triangle_normal(triangle.vertices)),
            offset: triangle_offset(triangle.vertices),
        });
        let walls: Vec<Wall> = walls.collect();
        let first = ray(center.as_vec3(), dice.direction().as_vec3());
        let last = follow(first, &walls, reflections as u32, start, mend);
        // In a box, reflections change signs along its axes and nothing else.
        let along = |ray: &Ray<f32>| DVec3::from(axes.map(|axis| axis.dot(exactly(ray).1).abs()));
        match last {
            Some(last) if (exactly(&last).1.length() - 1.0).abs() <= 1e-5 => {
                tally.off_by(along(&first).angle_between(along(&last)));
            }
            _ => tally.count(true),
        }
    }
    tally
}

/// The ray after so many reflections; `None` if it leaves the room.
fn follow(mut ray: Ray<f32>, walls: &[Wall], reflections: u32, start: Start, mend: u32) -> Option<Ray<f32>> {
    for number in 1..=reflections {
        let prepared = Woop::prepare(&ray);
        let mut nearest: Option<(TriangleHit<f32>, &Wall)> = None;
        for wall in walls {
            let limit = nearest.as_ref().map_or(f32::INFINITY, |(hit, _)| hit.t);
            let hit = Woop::test(&prepared, &wall.stored, limit);
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
