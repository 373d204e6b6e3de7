//! Cameras: fields of view near 0° and 180°, and cameras inside objects.

use super::rays::ray;
use super::rng::Rng;
use super::scenes::{empty, put_box, seen, sphere};
use super::spheres::{self, Ball};
use super::test_case::{Bound, EPSILON, FAILED, FailureCounts, TestCase, compare};
use super::triangles;
use crate::camera::PreparedCamera;
use crate::math::{MISS, Ray, Vec3};
use crate::methods::{Robust, Woop};
use crate::reference::{Reference, Verdict};
use crate::render::{Methods, PrimaryHit};
use crate::scene::{Camera, Lens, Projection, Scene};

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![
        TestCase {
            name: "cameras-fov",
            title: "Fields of view from 0° to 180°, 240×135 pixels",
            axis: "vertical field of view in degrees",
            places: &[
                1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 40.0, 90.0, 150.0, 170.0, 179.0, 179.9, 179.99,
                179.999,
            ],
            failure: "direction is NaN, not of unit length within 4 ε, or off by half a pixel or more where single precision resolves \
                      pixels",
            error: Some("pixels off"),
            source: "Shirley, Ray Tracing in One Weekend §12; half the picture's height is tan(fov / 2), a pixel's 1 / 135 of twice that",
            inputs: 50_000,
            methods: compare(
                views,
                &[("corner-in-the-world", in_the_world), ("f32", in_single), ("corner-in-f64", pinhole)],
            ),
            bound: |degrees| Bound::error(8.0 * EPSILON * pixels_per_unit(degrees)),
        },
        TestCase {
            name: "cameras-focus",
            title: "Lenses focused from a hundredth of their aperture away to infinity",
            axis: "distance of the focal plane / radius of the aperture",
            places: &[1e-2, 0.1, 1.0, 1e2, 1e4, 1e6, 1e9, 1e15, 1e18, 1e20, 1e30, 1e36],
            failure: "direction is NaN, or not of unit length within 4 ε",
            error: Some("angle to the point where the pixel's rays meet, in radians"),
            source: "Potmesil, Chakravarty, SIGGRAPH 1981: all rays of a pixel's point meet on the focal plane",
            inputs: 50_000,
            methods: compare(focused, &[("to-the-point", to_the_point), ("by-the-inverse", by_the_inverse)]),
            // The direction, and the origin, whose coordinates are up to 2 radii.
            bound: |distance| Bound::error(EPSILON * (8.0 + 4.0 / distance)),
        },
        TestCase {
            name: "cameras-inside",
            title: "Cameras inside balls and boxes of all sizes",
            axis: "distance from the wall / size",
            places: &[1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0],
            failure: "a camera ray hits nothing, or a hit that the f64 reference rejects",
            source: "from inside a closed object, every ray hits it",
            inputs: 20_000,
            methods: compare(
                inside,
                &[("least-t-1e-4", beyond_least_t), ("renderer", |scene| seen(scene, Methods::default(), 8))],
            ),
            ..TestCase::COMMON
        },
    ]
}

const SIZE: [u32; 2] = [240, 135];

/// Returns the pixels per unit of the direction near the picture's corners, where rounding matters most.
fn pixels_per_unit(degrees: f64) -> f64 {
    let half_height = (degrees.to_radians() / 2.0).tan();
    let half_width = half_height * f64::from(SIZE[0]) / f64::from(SIZE[1]);
    (1.0 + half_height * half_height + half_width * half_width) * f64::from(SIZE[1]) / (2.0 * half_height)
}

/// The direction through a point of the picture, in pixels.
type View = fn(&Camera, f32, f32) -> glam::Vec3;

fn pinhole(camera: &Camera, x: f32, y: f32) -> glam::Vec3 {
    PreparedCamera::new(camera, SIZE).rays(x, y).direction.get(0)
}

/// Returns, in f32: width and height in pixels; forward, right and up; half of the picture's width and height
/// at the distance 1.
fn frame(camera: &Camera) -> ([f32; 2], [glam::Vec3; 3], [f32; 2]) {
    let [width, height] = SIZE.map(|side| side as f32);
    let forward = (camera.look_at - camera.position).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let half_height = (camera.vertical_fov.to_radians() / 2.0).tan();
    ([width, height], [forward, right, up], [half_height * width / height, half_height])
}

/// Computes the direction as Ray Tracing in One Weekend does: corner and point are world positions.
fn in_the_world(camera: &Camera, x: f32, y: f32) -> glam::Vec3 {
    let ([width, height], [forward, right, up], [half_width, half_height]) = frame(camera);
    let corner = camera.position + forward - right * half_width + up * half_height;
    let point = corner + right * (x * 2.0 * half_width / width) - up * (y * 2.0 * half_height / height);
    (point - camera.position).normalize()
}

/// Computes the point of the picture at the distance 1, relative to the camera's position.
fn on_plane(camera: &Camera, x: f32, y: f32) -> glam::Vec3 {
    let ([width, height], [forward, right, up], [half_width, half_height]) = frame(camera);
    let (across, upwards) = (2.0 * x / width - 1.0, 1.0 - 2.0 * y / height);
    forward + right * (across * half_width) + up * (upwards * half_height)
}

/// Computes the direction relative to the camera's position, every step in f32.
fn in_single(camera: &Camera, x: f32, y: f32) -> glam::Vec3 {
    on_plane(camera, x, y).normalize()
}

fn views(rng: &mut Rng, degrees: f64, counts: &mut FailureCounts, view: View) {
    let position = rng.in_cube().as_vec3() * 1000.0;
    let camera = Camera::pinhole(
        position,
        position + rng.direction().as_vec3() * rng.scale(0.1, 100.0) as f32,
        rng.direction().as_vec3(),
        degrees as f32,
    );
    let [width, height] = SIZE.map(f64::from);
    let (x, y) = ((width * rng.unit()) as f32, (height * rng.unit()) as f32);
    // Basis and picture in f64.
    let forward = (camera.look_at.as_dvec3() - camera.position.as_dvec3()).normalize();
    let right = forward.cross(camera.up.as_dvec3()).normalize();
    let up = right.cross(forward);
    let half_height = (f64::from(camera.vertical_fov).to_radians() / 2.0).tan();
    if forward.cross(camera.up.as_dvec3()).length() < 0.1 {
        return;
    }
    let d = view(&camera, x, y).as_dvec3();
    // The point where the direction hits the picture plane, in pixels.
    let scale = height / (2.0 * half_height * d.dot(forward));
    let point = [width / 2.0 + d.dot(right) * scale, height / 2.0 - d.dot(up) * scale];
    let off = (point[0] - f64::from(x)).hypot(point[1] - f64::from(y));
    let unit = (d.length() - 1.0).abs() <= 4.0 * EPSILON && d.dot(forward) > 0.0;
    let resolved = EPSILON * pixels_per_unit(degrees) < 0.05;
    counts.record_error(if unit && (off < 0.5 || !resolved) { off } else { FAILED });
}

/// The ray of a camera with a lens through a point of the picture and, by two numbers, a point of the lens.
type FromLens = fn(&Camera, [f32; 4]) -> Ray<f32>;

/// Returns the renderer's method: it subtracts the point of the lens over the focal distance.
fn by_the_inverse(camera: &Camera, [x, y, u, v]: [f32; 4]) -> Ray<f32> {
    PreparedCamera::new(camera, SIZE).sample_rays(x, y, u, v)
}

/// Aims at the point where rays meet, as Ray Tracing in One Weekend does.
fn to_the_point(camera: &Camera, [x, y, u, v]: [f32; 4]) -> Ray<f32> {
    let origin = by_the_inverse(camera, [x, y, u, v]).origin;
    let point = camera.position + on_plane(camera, x, y) * camera.focus() as f32;
    Ray { origin, direction: Vec3::splat((point - origin.get(0)).normalize()) }
}

fn focused(rng: &mut Rng, distance: f64, counts: &mut FailureCounts, rays: FromLens) {
    let position = rng.in_cube().as_vec3();
    let lens = Lens { radius: 1.0, focus: Some(distance as f32), blades: 0 };
    let look_at = position + rng.direction().as_vec3();
    let aimed = Camera::pinhole(position, look_at, rng.direction().as_vec3(), 50.0);
    let camera = Camera { projection: Projection::Perspective(lens), ..aimed };
    let [x, y] = SIZE.map(|side| (rng.unit() * f64::from(side)) as f32);
    let Ray { origin, direction } = rays(&camera, [x, y, rng.unit() as f32, rng.unit() as f32]);
    let forward = (look_at.as_dvec3() - position.as_dvec3()).normalize();
    if forward.cross(aimed.up.as_dvec3()).length() < 0.1 {
        return;
    }
    // From the camera and from the ray's origin to the common point, over the distance of the focal plane.
    let pinhole = Reference::new(&Scene { camera: aimed, ..empty() });
    let (_, towards) = pinhole.camera_ray(SIZE, [x, y].map(f64::from), [0.0; 2]);
    let point = towards / towards.dot(forward);
    let beside = (origin.get(0).as_dvec3() - position.as_dvec3()) / f64::from(distance as f32);
    let d = direction.get(0).as_dvec3();
    let off = (point - beside).normalize().cross(d).length();
    counts.record_error(if (d.length() - 1.0).abs() <= 4.0 * EPSILON { off } else { FAILED });
}

/// Traces the scene's camera rays with a constant least t of 1e-4, a common way to avoid self-intersection.
fn beyond_least_t(scene: &Scene) -> Vec<PrimaryHit> {
    let nearest = |hit: PrimaryHit| {
        let ray = ray(hit.origin.into(), hit.direction.into());
        let spheres = scene.spheres.iter().map(|sphere| {
            let ball = Ball { center: sphere.center, radius: sphere.radius };
            spheres::intersect::<Robust>(ball, &ray, f32::INFINITY)
        });
        let triangles = scene.triangles.iter().map(|triangle| {
            triangles::intersect::<Woop>(triangle.vertices, &ray, f32::INFINITY).map(|[t, ..]| t)
        });
        let hits = spheres.chain(triangles).zip(0..).filter_map(|(t, primitive)| Some((t?, primitive)));
        let nearest = hits.filter(|(t, _)| *t > 1e-4).min_by(|(a, _), (b, _)| a.total_cmp(b));
        let (t, primitive) = nearest.unwrap_or((f32::INFINITY, MISS));
        PrimaryHit { t, primitive, ..hit }
    };
    seen(scene, Methods::default(), 8).into_iter().map(nearest).collect()
}

/// Tries cameras in a ball or in a tilted box, away from the origin.
fn inside(rng: &mut Rng, from_wall: f64, counts: &mut FailureCounts, find: fn(&Scene) -> Vec<PrimaryHit>) {
    let size = rng.scale(1e-3, 1e3);
    let center = rng.in_cube() * size;
    let mut scene = empty();
    let towards = if rng.index(2) == 0 {
        scene.spheres.push(sphere(center.as_vec3(), size as f32));
        rng.direction()
    } else {
        put_box(&mut scene, rng, center, size)[rng.index(3)]
    };
    let position = (center + towards * (size * (1.0 - from_wall))).as_vec3();
    scene.camera = Camera::pinhole(
        position,
        position + (rng.direction() * size).as_vec3(),
        rng.direction().as_vec3(),
        100.0,
    );
    let reference = Reference::new(&scene);
    for hit in find(&scene) {
        let verdict = reference.check_primary(hit.origin, hit.direction, hit.t, hit.primitive);
        counts.record(hit.primitive == MISS || verdict != Verdict::Right);
    }
}
