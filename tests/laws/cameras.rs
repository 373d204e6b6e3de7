//! Cameras with a lens, and orthographic ones: rays, bits, and the sizes of what they show in closed form.

use crate::common::*;
use octray::camera::PreparedCamera;
use octray::scene::{Lens, Projection};
use std::f64::consts::{PI, TAU};

fn lens(radius: f32, focus: f32, blades: u32) -> Projection {
    Projection::Perspective(Lens { radius, focus: Some(focus), blades })
}

/// Balls and triangles, some of them emitters, seen by this camera.
fn scene(projection: Projection) -> Scene {
    let mut rng = Rng(65);
    let materials = vec![material(Diffuse), material(Glass { ior: 1.5 }), lamp(3.0)];
    let camera = Camera { projection, ..camera(vec3(0.4, 1.0, 6.0), Vec3::ZERO, 45.0) };
    let mut scene = Scene { camera, materials, ..empty() };
    for number in 0..14 {
        let (center, one) = ((rng.in_cube() * 2.0).as_vec3(), number % 3);
        scene.spheres.push(sphere(center, rng.scale(0.2, 0.7) as f32, one));
        let corner = |rng: &mut Rng| center + rng.in_cube().as_vec3();
        scene.triangles.push(triangle([corner(&mut rng), corner(&mut rng), corner(&mut rng)], one));
    }
    Scene { sky: Sky::Gradient { bottom: Vec3::ONE, top: vec3(0.5, 0.7, 1.0) }, ..scene }
}

fn bits(scene: &Scene, change: impl Fn(&mut Settings)) -> u64 {
    let mut settings = Settings { resolution: [45, 34], ..Settings::of(scene) };
    change(&mut settings);
    film(scene, settings, 3).picture().hash()
}

#[test]
fn pictures_of_lenses_and_orthographic_cameras_have_the_same_bits_however_they_are_traced() {
    for projection in [lens(0.3, 5.0, 0), lens(0.3, 5.0, 5), Projection::Orthographic { height: 4.0 }] {
        let scene = scene(projection);
        let one = bits(&scene, |settings| settings.lanes = 1);
        let through = Traversal::ALL.map(TraversalChoice::Through);
        for traversal in [TraversalChoice::Linear].into_iter().chain(through) {
            for lanes in WIDTHS {
                let found = bits(&scene, |set| (set.lanes, set.methods.traversal) = (lanes, traversal));
                assert_eq!(found, one, "{projection:?}, {lanes} lanes, {traversal:?}");
            }
        }
        assert_eq!(bits(&scene, |settings| settings.tile_size = [7, 5]), one, "{projection:?}");
    }
}

#[test]
fn closed_aperture_is_a_pinhole_bit_by_bit_and_a_far_focal_plane_shows_its_directions() {
    let pinhole = bits(&scene(Projection::default()), |_| {});
    assert_eq!(bits(&scene(lens(0.0, 3.0, 7)), |_| {}), pinhole);
    assert_ne!(bits(&scene(lens(0.1, 3.0, 0)), |_| {}), pinhole);
    let [far, pinhole] = [lens(0.3, 1e18, 0), Projection::default()]
        .map(|projection| PreparedCamera::new(&scene(projection).camera, [90, 60]));
    let mut rng = Rng(3);
    for _ in 0..1_000 {
        let [x, y, u, v] = [90.0, 60.0, 1.0, 1.0].map(|size| (rng.unit() * size) as f32);
        let [found, expected] = [far.sample_rays(x, y, u, v), pinhole.rays(x, y)].map(|ray| ray.direction);
        assert_eq!(found.get(0), expected.get(0));
    }
}

/// Of every kind, at any place and of any size, against the reference.
#[test]
fn rays_are_the_references_within_rounding() {
    const EPSILON: f64 = 1.0 / 16_777_216.0;
    let mut rng = Rng(7);
    let (mut of_origins, mut of_directions) = (0.0_f64, 0.0_f64);
    for turn in 0..20_000 {
        let size = rng.scale(1e-3, 1e3);
        let position = (rng.in_cube() * size).as_vec3();
        let look_at = position + (rng.direction() * size).as_vec3();
        let [radius, focus] = [rng.scale(1e-3, 0.3), rng.scale(0.2, 1e6)].map(|x| (x * size) as f32);
        let projection = match turn % 4 {
            0 => Projection::Orthographic { height: focus },
            1 => lens(radius, focus, 0),
            _ => lens(radius, focus, 3 + rng.index(14) as u32),
        };
        let up = rng.direction().as_vec3();
        if (look_at - position).normalize().cross(up).length() < 0.1 {
            continue;
        }
        let scene =
            Scene { camera: Camera { position, look_at, up, vertical_fov: 50.0, projection }, ..diffuse() };
        let [x, y, u, v] = [90.0, 60.0, 1.0, 1.0].map(|size| (rng.unit() * size) as f32);
        let ray = PreparedCamera::new(&scene.camera, [90, 60]).sample_rays(x, y, u, v);
        let (origin, direction) =
            Reference::new(&scene).camera_ray([90, 60], [x, y].map(f64::from), [u, v].map(f64::from));
        // The lens is as large as its radius, the picture as its diagonal.
        let across = if turn % 4 == 0 { f64::from(focus) } else { f64::from(radius) };
        let off = ray.origin.get(0).as_dvec3().distance(origin);
        of_origins = of_origins.max(off / EPSILON / (position.as_dvec3().length() + across));
        let off = ray.direction.get(0).as_dvec3().distance(direction);
        // A point of the lens counts in the direction as much as the angle that it is seen at.
        let angle = if turn % 4 == 0 { 0.0 } else { f64::from(radius / focus) };
        of_directions = of_directions.max(off / EPSILON / (4.0 + 40.0 * angle));
    }
    assert!(of_origins < 20.0 && of_directions < 1.0, "{of_origins} {of_directions}");
}

/// The mean square of the distance from the middle, in pixels, of the light in a picture.
fn spread(scene: &Scene, samples: u32) -> f64 {
    let film = film(scene, Settings { max_bounces: 0, ..Settings::of(scene) }, samples);
    let picture = film.picture();
    let [mut sum, mut square] = [0.0, 0.0];
    for (at, pixel) in picture.pixels.iter().enumerate() {
        let [x, y] = [at as u32 % picture.width, at as u32 / picture.width].map(|x| f64::from(x) + 0.5);
        let [x, y] = [x - f64::from(picture.width) / 2.0, y - f64::from(picture.height) / 2.0];
        (sum, square) = (sum + f64::from(pixel[0]), square + f64::from(pixel[0]) * (x * x + y * y));
    }
    square / sum
}

#[test]
fn blur_of_a_point_has_the_diameter_of_the_circle_of_confusion() {
    let (distance, focal_height) = (5.0_f64, 2.0 * 20_f64.to_radians().tan());
    for (focus, blades) in [(3.0_f64, 0), (9.0, 0), (1e6, 0), (3.0, 4), (9.0, 3)] {
        let (radius, size, ball) = (0.8_f64, 64.0, 0.08_f64);
        let scene = Scene {
            camera: Camera { projection: lens(radius as f32, focus as f32, blades), ..empty().camera },
            resolution: [64, 64],
            sky: Sky::Color(Vec3::ZERO),
            materials: vec![lamp(1.0)],
            spheres: vec![sphere(Vec3::Z * (5.0 - distance) as f32, ball as f32, 0)],
            ..empty()
        };
        let pixels = |at_distance_1: f64| at_distance_1 * size / focal_height;
        let circle = pixels(radius * (1.0 / distance - 1.0 / focus).abs());
        // A disc has half its radius squared; a polygon a sixth of that times 2 + cos of the angle of a side.
        let corners = f64::from(blades);
        let polygon = if blades == 0 { 0.5 } else { (2.0 + (TAU / corners).cos()) / 6.0 };
        // The ball and the pixel widen it.
        let own = pixels(ball / distance).powi(2) / 2.0 + 1.0 / 6.0;
        let found = ((spread(&scene, 2_048) - own) / polygon).sqrt();
        assert!((found / circle - 1.0).abs() < 0.015, "{focus} {blades}: {found} instead of {circle}");
    }
}

#[test]
fn orthographic_sizes_are_exact_and_do_not_depend_on_the_distance() {
    let corners = [vec3(-1.0, -0.5, 0.0), vec3(1.0, -0.5, 0.0), vec3(1.0, 0.5, 0.0), vec3(-1.0, 0.5, 0.0)];
    let at = |z: f32| {
        let corner = |number: usize| corners[number] + Vec3::Z * z;
        let triangles = [[0, 1, 2], [0, 2, 3]].map(|numbers| triangle(numbers.map(corner), 0)).to_vec();
        let scene = Scene {
            camera: Camera { projection: Projection::Orthographic { height: 4.0 }, ..empty().camera },
            sky: Sky::Color(Vec3::ZERO),
            materials: vec![lamp(1.0)],
            resolution: [96, 64],
            triangles,
            ..empty()
        };
        film(&scene, Settings { max_bounces: 0, ..Settings::of(&scene) }, 16).picture()
    };
    for z in [4.0, 0.0, -30.0, -4_000.0] {
        for (pixel, number) in at(z).pixels.iter().zip(0..) {
            let (x, y) = (number % 96, number / 96);
            let inside = (32..64).contains(&x) && (24..40).contains(&y);
            assert_eq!(pixel[0], f32::from(u8::from(inside)), "{x}, {y} at {z}");
        }
    }
    assert!(at(6.0).pixels.iter().all(|pixel| pixel[0] == 0.0), "nothing behind the camera is seen");
}

#[test]
fn f_numbers_are_those_of_35_mm_film() {
    // At a field of view of 24 mm over 50 mm, f/2.5 is a radius of 10 mm.
    let fov = 2.0 * (12.0_f64 / 50.0).atan() * 180.0 / PI;
    let camera = Camera { vertical_fov: fov as f32, ..empty().camera };
    assert!((camera.f_number_or_radius(2.5) - 0.01).abs() < 1e-7);
    assert!((camera.f_number_or_radius(0.01) - 2.5).abs() < 1e-5);
}
