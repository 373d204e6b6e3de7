//! Cameras: fields of view near 0° and 180°, and cameras inside of things.

use super::aim::ray;
use super::scenes::{self, Way, empty, put_box, sphere};
use super::{Bound, Dice, EPSILON, Method, Recipe, Tally};
use crate::buffers::store_triangles;
use crate::camera::Pinhole;
use crate::kernel::ray_sphere::{Robust, SphereMethod};
use crate::kernel::ray_triangle::{TriangleMethod, Woop};
use crate::math::{MISS, Vec3};
use crate::reference::{Reference, Verdict};
use crate::render::PrimaryHit;
use crate::scene::{Camera, Scene};

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "cameras-fov",
        title: "Fields of view from 0° to 180°, 240×135 pixels",
        axis: "vertical field of view in degrees",
        places: &[
            1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 40.0, 90.0, 150.0, 170.0, 179.0, 179.9, 179.99, 179.999,
        ],
        failure: "direction is no number, not of unit length within 4 ε, or half a pixel and more off where single precision can tell \
                  pixels apart",
        error: Some("pixels off"),
        source: "Shirley, Ray Tracing in One Weekend §12; half the picture's height is tan(fov / 2), a pixel's 1 / 135 of twice that",
        cases: 50_000,
        methods: &[
            Method::other("corner-in-the-world", |dice, x, cases| views(dice, x, cases, in_the_world)),
            Method::other("f32", |dice, x, cases| views(dice, x, cases, in_single)),
            Method::default("corner-in-f64", |dice, x, cases| views(dice, x, cases, pinhole)),
        ],
        bound: |degrees| Bound::error(8.0 * EPSILON * coarseness(degrees)),
    },
    Recipe {
        name: "cameras-inside",
        title: "Cameras inside balls and boxes of all sizes",
        axis: "distance from the wall / size",
        places: &[1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0],
        failure: "the camera sees nothing, or what the judge does not find there",
        error: None,
        source: "a closed thing is seen in every direction from inside",
        cases: 20_000,
        methods: &[
            Method::other("least-t-1e-4", |dice, x, cases| inside(dice, x, cases, beyond_least_t)),
            Method::default("renderer", |dice, x, cases| {
                inside(dice, x, cases, |scene| scenes::seen(scene, Way::NEEDED))
            }),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
];

const SIZE: [u32; 2] = [240, 135];

/// How many pixels the direction's length spans near the picture's corners, where a rounding counts most.
fn coarseness(degrees: f64) -> f64 {
    let half_height = (degrees.to_radians() / 2.0).tan();
    let half_width = half_height * f64::from(SIZE[0]) / f64::from(SIZE[1]);
    (1.0 + half_height * half_height + half_width * half_width) * f64::from(SIZE[1]) / (2.0 * half_height)
}

/// The directions through points of the picture, in pixels.
type View = fn(&Camera, f32, f32) -> glam::Vec3;

fn pinhole(camera: &Camera, x: f32, y: f32) -> glam::Vec3 {
    Pinhole::new(camera, SIZE).rays(x, y).direction.get(0)
}

/// In f32: the picture's pixels; forward, right and up; half of the width and height of the picture at the distance 1.
fn frame(camera: &Camera) -> ([f32; 2], [glam::Vec3; 3], [f32; 2]) {
    let [width, height] = SIZE.map(|side| side as f32);
    let forward = (camera.look_at - camera.position).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let half_height = (camera.vertical_fov.to_radians() / 2.0).tan();
    ([width, height], [forward, right, up], [half_height * width / height, half_height])
}

/// As the book has it that many begin with: the picture's corner and the point in the picture are places in the world.
fn in_the_world(camera: &Camera, x: f32, y: f32) -> glam::Vec3 {
    let ([width, height], [forward, right, up], [half_width, half_height]) = frame(camera);
    let corner = camera.position + forward - right * half_width + up * half_height;
    let point = corner + right * (x * 2.0 * half_width / width) - up * (y * 2.0 * half_height / height);
    (point - camera.position).normalize()
}

/// The same without the camera's place, and still every step in f32.
fn in_single(camera: &Camera, x: f32, y: f32) -> glam::Vec3 {
    let ([width, height], [forward, right, up], [half_width, half_height]) = frame(camera);
    let (across, upwards) = (2.0 * x / width - 1.0, 1.0 - 2.0 * y / height);
    (forward + right * (across * half_width) + up * (upwards * half_height)).normalize()
}

fn views(dice: &mut Dice, degrees: f64, cases: usize, view: View) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let position = dice.in_cube().as_vec3() * 1000.0;
        let camera = Camera {
            position,
            look_at: position + dice.direction().as_vec3() * dice.scale(0.1, 100.0) as f32,
            up: dice.direction().as_vec3(),
            vertical_fov: degrees as f32,
        };
        let [width, height] = SIZE.map(f64::from);
        let (x, y) = ((width * dice.unit()) as f32, (height * dice.unit()) as f32);
        // Basis and picture in f64.
        let forward = (camera.look_at.as_dvec3() - camera.position.as_dvec3()).normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let up = right.cross(forward);
        let half_height = (f64::from(camera.vertical_fov).to_radians() / 2.0).tan();
        if forward.cross(camera.up.as_dvec3()).length() < 0.1 {
            continue;
        }
        let d = view(&camera, x, y).as_dvec3();
        // Where the direction meets the picture, in pixels.
        let scale = height / (2.0 * half_height * d.dot(forward));
        let met = [width / 2.0 + d.dot(right) * scale, height / 2.0 - d.dot(up) * scale];
        let off = (met[0] - f64::from(x)).hypot(met[1] - f64::from(y));
        let unit = (d.length() - 1.0).abs() <= 4.0 * EPSILON && d.dot(forward) > 0.0;
        let told_apart = EPSILON * coarseness(degrees) < 0.05;
        if unit && off.is_finite() && (off < 0.5 || !told_apart) {
            tally.off_by(off);
        } else {
            tally.count(true);
        }
    }
    tally
}

/// The same rays, with the constant that keeps rays from hitting where they start in many programs.
fn beyond_least_t(scene: &Scene) -> Vec<PrimaryHit> {
    let stored = store_triangles::<Woop>(scene);
    let nearest = |hit: PrimaryHit| {
        let ray = ray(hit.origin.into(), hit.direction.into());
        let (on_sphere, on_triangle) = (Robust::prepare::<f32>(&ray), Woop::prepare::<f32>(&ray));
        let spheres = scene.spheres.iter().map(|sphere| {
            let radius2 = sphere.radius * sphere.radius;
            Robust::test(&on_sphere, Vec3::splat(sphere.center), radius2, f32::INFINITY)
        });
        let triangles = stored.iter().map(|triangle| {
            let found = Woop::test(&on_triangle, triangle, f32::INFINITY);
            (found.mask, found.t)
        });
        let found = spheres.chain(triangles).zip(0..).filter(|((hit, t), _)| *hit && *t > 1e-4);
        let nearest = found.min_by(|((_, a), _), ((_, b), _)| a.total_cmp(b));
        let ((_, t), primitive) = nearest.unwrap_or(((false, f32::INFINITY), MISS));
        PrimaryHit { t, primitive, ..hit }
    };
    scenes::seen(scene, Way::NEEDED).into_iter().map(nearest).collect()
}

/// By turns in a ball and in a tilted box, away from the origin.
fn inside(dice: &mut Dice, from_wall: f64, cases: usize, look: fn(&Scene) -> Vec<PrimaryHit>) -> Tally {
    let mut tally = Tally::default();
    let mut number = 0;
    while tally.tested < cases {
        number += 1;
        let size = dice.scale(1e-3, 1e3);
        let center = dice.in_cube() * size;
        let mut scene = empty();
        let towards = if number % 2 == 0 {
            let (center, radius) = (center.as_vec3(), size as f32);
            scene.spheres.push(sphere(center, radius));
            dice.direction()
        } else {
            put_box(&mut scene, dice, center, size)[dice.index(3)]
        };
        let position = (center + towards * (size * (1.0 - from_wall))).as_vec3();
        scene.camera = Camera {
            position,
            look_at: position + (dice.direction() * size).as_vec3(),
            up: dice.direction().as_vec3(),
            vertical_fov: 100.0,
        };
        let judge = Reference::new(&scene);
        for hit in look(&scene).into_iter().take(cases - tally.tested) {
            let verdict = judge.check_primary(hit.origin, hit.direction, hit.t, hit.primitive);
            tally.count(hit.primitive == MISS || verdict != Verdict::Right);
        }
    }
    tally
}
