//! Whole scenes: very different sizes in one scene, and coplanar surfaces.

use super::rays::ray;
use super::rng::Rng;
use super::spheres::{Ball, reference_t};
use super::test_case::{Bound, FailureCounts, TestCase, compare};
use super::triangles;
use crate::lane::WIDTHS;
use crate::math::MISS;
use crate::methods::{self, Woop};
use crate::rays::Traversal;
use crate::render::{Methods, PrimaryHit, Settings, SphereChoice, TraversalChoice};
use crate::scene::{Camera, Material, MaterialKind, Scene, Side, Sky, Sphere, Triangle};
use glam::{DQuat, DVec3, Vec3};
use std::f64::consts::TAU;

pub(super) fn test_cases() -> Vec<TestCase> {
    let naive =
        Methods { sphere: SphereChoice::Naive, traversal: TraversalChoice::Linear, ..Methods::default() };
    vec![
        TestCase {
            name: "scenes-mixed",
            title: "A small ball on a huge one, seen from a thousand times its size away",
            axis: "radius of the huge ball / radius of the small one",
            places: &[1.0, 1e2, 1e3, 1e4, 1e5, 1e6, 3e6, 1e7, 3e7, 1e8],
            failure: "the small ball is not hit where it is in front by a tenth of its radius",
            source: "errors grow with the largest object and hide the smallest",
            inputs: 50_000,
            methods: compare(mixed, &[("naive", naive), ("robust", Methods::default())]),
            // The huge ball's surface is off along the ray by some ε of its radius: no promise above 1e5.
            bound: |ratio| if ratio <= 1e5 { Bound::NO_FAILURE } else { Bound::NONE },
            ..TestCase::COMMON
        },
        TestCase {
            name: "scenes-coplanar",
            title: "Coincident triangles, in any order, at both widths and with every traversal",
            axis: "triangles in one place",
            places: &[2.0, 4.0, 16.0, 64.0],
            failure: "the hit is not the one of lowest index among coincident triangles",
            source: "for equal t, the first or the last triangle tested wins, unless a rule decides",
            inputs: 20_000,
            methods: compare(coplanar, &[("first-met", first_tested), ("lower-index", renderer)]),
            ..TestCase::COMMON
        },
    ]
}

/// Returns a scene without primitives, with one diffuse material.
pub fn empty() -> Scene {
    let diffuse = Material::new("diffuse", MaterialKind::Diffuse, Vec3::ONE);
    Scene {
        name: "test case".into(),
        camera: Camera::pinhole(Vec3::ZERO, Vec3::Z, Vec3::Y, 90.0),
        resolution: [16, 16],
        max_bounces: 1,
        sky: Sky::Color(Vec3::ONE),
        materials: vec![diffuse],
        ..Scene::default()
    }
}

pub fn triangle(vertices: [Vec3; 3]) -> Triangle {
    Triangle { vertices, material: 0 }
}

/// Returns the scene's camera rays and their hits.
pub fn seen(scene: &Scene, methods: Methods, lanes: usize) -> Vec<PrimaryHit> {
    methods::renderer(scene, Settings { methods, lanes, ..Settings::of(scene) }).primary_hits(0)
}

/// Share of a ball's radius within which rays may pass its silhouette on either side: a few ε of the 1,000
/// radii to the eye are the error of the distance at which a ray passes the centre.
const SILHOUETTE: f32 = 1e-3;

/// Tries a view in which the small ball fills the picture's height, down to its contact with the huge one.
fn mixed(rng: &mut Rng, ratio: f64, counts: &mut FailureCounts, methods: Methods) {
    let small = rng.scale(1e-3, 1.0);
    let (up, contact) = (rng.direction(), rng.in_cube() * small);
    let ball =
        |height: f64, radius: f64| Ball { center: (contact + up * height).as_vec3(), radius: radius as f32 };
    let balls = [ball(-ratio * small, ratio * small), ball(small, small)];
    let along = up.cross(rng.direction()).normalize();
    let eye = contact + (up * rng.scale(0.5, 5.0) + along).normalize() * (1000.0 * small);
    let mut scene = empty();
    scene.spheres = balls.map(|Ball { center, radius }| sphere(center, radius)).into();
    let (position, look_at) = (eye.as_vec3(), balls[1].center);
    scene.camera = Camera::pinhole(position, look_at, along.cross(up).as_vec3(), 0.12);
    let inner = Ball { radius: balls[1].radius * (1.0 - SILHOUETTE), ..balls[1] };
    for hit in seen(&scene, methods, 8) {
        let ray = ray(hit.origin.into(), hit.direction.into());
        let [ground, nearest] = balls.map(|ball| reference_t(ball, &ray).unwrap_or(f64::INFINITY));
        if reference_t(inner, &ray).is_some() && nearest + 0.1 * small < ground {
            counts.record(hit.primitive != 1);
        }
    }
}

/// Returns a sphere of the first material.
pub fn sphere(center: Vec3, radius: f32) -> Sphere {
    Sphere { center, radius, material: 0, texture_turn: 0.0, texture_side: Side::Outside }
}

/// Triangles in different places of a wall, several in each place, shuffled; and the place of each.
fn wall(rng: &mut Rng, copies: f64) -> (Scene, Vec<usize>) {
    const PLACES: usize = 12;
    let (depth, slope) = (rng.scale(1.0, 100.0), rng.direction());
    let corner = |rng: &mut Rng| {
        let (x, y) = (1.2 * depth * rng.signed(), 1.2 * depth * rng.signed());
        DVec3::new(x, y, depth + 0.3 * (slope.x * x + slope.y * y)).as_vec3()
    };
    let places: Vec<[Vec3; 3]> = (0..PLACES).map(|_| [(); 3].map(|()| corner(rng))).collect();
    let mut order: Vec<usize> = (0..PLACES * copies as usize).map(|number| number % PLACES).collect();
    shuffle(&mut order, rng);
    (Scene { triangles: order.iter().map(|&place| triangle(places[place])).collect(), ..empty() }, order)
}

/// Shuffles values. Source: Knuth, The Art of Computer Programming vol. 2, algorithm P.
fn shuffle<T>(values: &mut [T], rng: &mut Rng) {
    for last in (1..values.len()).rev() {
        values.swap(last, rng.index(last + 1));
    }
}

/// The triangles of a scene that the rays of these hits hit, by one method.
type Find = fn(&mut Rng, &Scene, &[PrimaryHit]) -> Vec<u32>;

fn coplanar(rng: &mut Rng, copies: f64, counts: &mut FailureCounts, find: Find) {
    let (scene, order) = wall(rng, copies);
    let linear = Methods { traversal: TraversalChoice::Linear, ..Methods::default() };
    let base = seen(&scene, linear, 1);
    let answers = find(rng, &scene, &base);
    for (hit, answer) in base.iter().zip(answers).filter(|(hit, _)| hit.primitive != MISS) {
        let place = order[hit.primitive as usize];
        let first = order.iter().position(|&other| other == place).map(|index| index as u32);
        counts.record(Some(answer) != first);
    }
}

/// Tests triangles in random order, as a hierarchy does; only a smaller t replaces a hit.
fn first_tested(rng: &mut Rng, scene: &Scene, rays: &[PrimaryHit]) -> Vec<u32> {
    let mut order: Vec<usize> = (0..scene.triangles.len()).collect();
    shuffle(&mut order, rng);
    let answer = |hit: &PrimaryHit| {
        let ray = ray(hit.origin.into(), hit.direction.into());
        let (mut nearest, mut primitive) = (f32::INFINITY, MISS);
        for &index in &order {
            let found = triangles::intersect::<Woop>(scene.triangles[index].vertices, &ray, f32::INFINITY);
            if let Some([t, ..]) = found.filter(|&[t, ..]| t < nearest) {
                (nearest, primitive) = (t, index as u32);
            }
        }
        primitive
    };
    rays.iter().map(answer).collect()
}

/// Returns the renderer at a random width, with a random traversal.
fn renderer(rng: &mut Rng, scene: &Scene, _: &[PrimaryHit]) -> Vec<u32> {
    let traversals = [Traversal::Single, Traversal::Packet, Traversal::Stream, Traversal::Hybrid];
    let choices = [TraversalChoice::Linear, TraversalChoice::Through(traversals[rng.index(4)])];
    let methods = Methods { traversal: choices[rng.index(2)], ..Methods::default() };
    let lanes = WIDTHS[rng.index(WIDTHS.len())];
    seen(scene, methods, lanes).iter().map(|hit| hit.primitive).collect()
}

/// Adds a tilted box of twelve triangles; returns the unit vectors towards three of its walls.
pub fn put_box(scene: &mut Scene, rng: &mut Rng, center: DVec3, size: f64) -> [DVec3; 3] {
    let axis = rng.direction();
    let tilt = DQuat::from_axis_angle(axis, TAU * rng.unit());
    let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
    let corner =
        |i: usize| (center + tilt * (DVec3::new(sign(i & 1), sign(i & 2), sign(i & 4)) * size)).as_vec3();
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]] {
        scene.triangles.extend([[a, b, c], [a, c, d]].map(|face| triangle(face.map(corner))));
    }
    DVec3::AXES.map(|axis| tilt * axis)
}
