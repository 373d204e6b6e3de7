//! Guiding of diffuse rays: to the border of a lamp near a ceiling and to images of lights in mirror spheres.

use super::{double, square};
use crate::common::Rng;
use glam::{DVec3, Vec3};
use octray::buffers::{LightChoice, Lights};
use octray::kernel::border::Strip;
use octray::kernel::guiding::Guiding;
use octray::kernel::mirror_image::MirrorImage;
use octray::math;
use octray::sampling::warp;
use octray::scene::{MaterialKind, Scene, Sphere, load};

/// A strip around a parallelogram, and a point with a normal that sees some of it.
fn strip(rng: &mut Rng) -> (Strip, Vec3, Vec3) {
    let [ab, ac] = [(); 2].map(|()| rng.direction() * rng.scale(0.1, 2.0));
    let margins = [(); 2].map(|()| rng.scale(0.02, 0.5));
    let a = rng.direction() * rng.scale(0.1, 3.0);
    (Strip::new(a.as_vec3(), ab.as_vec3(), ac.as_vec3(), margins), Vec3::ZERO, rng.direction().as_vec3())
}

/// A mirror sphere and a light, both apart from the origin and from each other.
fn image(rng: &mut Rng) -> MirrorImage {
    loop {
        let [mirror, light] = [(); 2].map(|()| rng.direction() * rng.scale(0.5, 3.0));
        let [radius, light_radius] = [(); 2].map(|()| rng.scale(0.05, 1.0));
        if radius < mirror.length() && radius < (light - mirror).length() {
            let [mirror, light] = [mirror, light].map(|at| at.as_vec3());
            return MirrorImage::new((mirror, radius as f32), (light, light_radius as f32));
        }
    }
}

/// By area, in double precision: the pdf of directions to a point is the same all over the strip and zero
/// beside it, and points are as many in each corner and along each side as its area asks for.
#[test]
fn points_of_a_strip_are_uniform_by_area_and_so_is_the_pdf() {
    let mut rng = Rng(17);
    let mut checked = 0;
    for round in 0..24 {
        let [ab, ac] = [(); 2].map(|()| rng.direction() * rng.scale(0.5, 2.0));
        let cross = ab.cross(ac);
        // Neither edge on nor too near: there single precision is not enough to compare.
        let a = rng.direction() * 3.0;
        if cross.length() < 0.3 || cross.normalize().dot(a).abs() < 0.5 {
            continue;
        }
        checked += 1;
        let margins @ [mx, my] = [(); 2].map(|()| rng.scale(0.05, 0.5));
        let strip = Strip::new(a.as_vec3(), ab.as_vec3(), ac.as_vec3(), margins);
        let outer = (1.0 + 2.0 * mx) * (1.0 + 2.0 * my);
        let density = 1.0 / ((outer - 1.0) * cross.length());
        let zero = math::Vec3::splat(Vec3::ZERO);
        for (u, v) in square(64) {
            // A little beyond the outer parallelogram, too.
            let [x, y] = [(u, mx), (v, my)].map(|(u, m)| f64::from(u).mul_add(1.2 + 2.4 * m, -0.1 - 1.2 * m));
            let beyond = (-x).max(x - 1.0) / mx;
            let beyond = beyond.max((-y).max(y - 1.0) / my);
            let point = a + ab * x + ac * y;
            let wi = point.normalize();
            let pdf = f64::from(strip.pdf::<f32>(zero, math::Vec3::splat(wi.as_vec3())));
            let by_area = pdf * wi.dot(cross.normalize()).abs() / point.length_squared();
            let expected = if (0.0..1.0).contains(&beyond) { density } else { 0.0 };
            let at_an_edge = beyond.abs() < 1e-3 || (beyond - 1.0).abs() < 1e-3;
            let off = (by_area - expected).abs() / density;
            assert!(at_an_edge || off < 1e-3, "round {round}, ({x}, {y}): {by_area} for {expected}");
        }
        // Columns and rows: before the inner parallelogram, beside it, behind it.
        let mut shares = [[0.0; 3]; 3];
        let side = 256;
        for (u, v) in square(side) {
            let from = double(strip.point::<f32>(u, v)) - a;
            let x = ac.cross(cross).dot(from) / ac.cross(cross).dot(ab);
            let y = ab.cross(cross).dot(from) / ab.cross(cross).dot(ac);
            let part = |x: f64| if x < 0.0 { 0 } else { 1 + usize::from(x > 1.0) };
            shares[part(y)][part(x)] += 1.0 / f64::from(side * side);
        }
        for (row, height) in [my, 1.0, my].into_iter().enumerate() {
            for (column, width) in [mx, 1.0, mx].into_iter().enumerate() {
                let inner = row == 1 && column == 1;
                let share = if inner { 0.0 } else { width * height / (outer - 1.0) };
                let found = shares[row][column];
                // The inner edges may be a rounding error inside.
                assert!((found - share).abs() < 5e-3, "round {round}: {found} for {share}");
            }
        }
    }
    assert!(checked >= 6, "only {checked} strips");
}

#[test]
fn guided_rays_change_no_expectation() {
    let mut rng = Rng(14);
    for round in 0..48 {
        let (strip, origin, n) = strip(&mut rng);
        let images: Vec<MirrorImage> = (0..round % 3).map(|_| image(&mut rng)).collect();
        let strip = (images.is_empty() || rng.unit() < 0.5).then_some(strip);
        let guiding = Guiding::new(strip, images).unwrap();
        let (origin, n) = (math::Vec3::splat(origin), math::Vec3::splat(n));
        let axis = rng.direction();
        // The cosine-weighted means of 1 and of two functions of the direction, with and without guiding.
        let functions = |wi: DVec3| [1.0, wi.dot(axis), (3.0 * wi.dot(axis)).sin()];
        let (mut with, mut without) = ([0.0; 3], [0.0; 3]);
        let side = 256;
        for (u, v) in square(side) {
            let sample = guiding.sample_diffuse::<f32>(origin, n, u, v);
            let plain = warp::sample_cosine_hemisphere::<f32>(n, u, v);
            assert!((double(sample.wi).length() - 1.0).abs() < 1e-6, "{:?}", sample.wi);
            assert!(!sample.alive || sample.weight <= 16.0 / 14.0 + 1e-5, "{}", sample.weight);
            for (i, value) in functions(double(sample.wi)).into_iter().enumerate() {
                with[i] += if sample.alive { f64::from(sample.weight) * value } else { 0.0 };
                without[i] += functions(double(plain))[i];
            }
        }
        for i in 0..3 {
            let off = (with[i] - without[i]) / f64::from(side * side);
            assert!(off.abs() < 4e-3, "round {round}, function {i}: {off}");
        }
    }
}

#[test]
fn cones_of_images_lie_around_the_light_that_mirrors_show() {
    let mut rng = Rng(16);
    let (mut met, mut seen, mut centered) = (0, 0, 0);
    for _ in 0..64 {
        // From the origin; the light is a sphere of a tenth of its distance from the mirror.
        let radius = rng.scale(0.2, 0.8);
        let mirror = rng.direction() * (radius + rng.scale(0.2, 3.0));
        let light = mirror + rng.direction() * (radius + rng.scale(1.0, 3.0));
        let light_radius = 0.1 * (light - mirror).length();
        let sphere = (mirror.as_vec3(), radius as f32);
        let image = MirrorImage::new(sphere, (light.as_vec3(), light_radius as f32));
        let cone = image.cone::<f32>(math::Vec3::zero());
        // Whether the reflection of a direction meets the light.
        let meets = |d: DVec3| {
            let half = mirror.dot(d);
            let square = half * half - mirror.length_squared() + radius * radius;
            if square < 0.0 {
                return false;
            }
            let at = d * (half - square.sqrt());
            let n = (at - mirror) / radius;
            let reflected = d - n * (2.0 * n.dot(d));
            let along = reflected.dot(light - at);
            along > 0.0 && (light - at - reflected * along).length() < light_radius
        };
        if cone.is_seen() {
            seen += 1;
            centered += usize::from(meets(double(cone.sample(0.0, 0.0))));
            met += square(16).filter(|&(u, v)| meets(double(cone.sample(u, v)))).count();
        }
    }
    // At grazing angles the image is narrower than the cone in one direction, and farther from its axis.
    let share = met as f64 / (256 * seen) as f64;
    println!("{centered} of {seen} axes and {share:.3} of the directions meet the light");
    assert!(seen > 40 && centered * 10 > seen * 8 && share > 0.2);
}

/// An image pays where it lights much of what is diffuse: in a room, not on a ground without end.
#[test]
fn rays_are_guided_to_images_of_the_brightest_light_where_they_pay() {
    let images = |scene: &Scene, choice| {
        Lights::new(scene, choice).guiding.map_or(0, |guiding| guiding.images().len())
    };
    let room = load("builtin:cornell-spheres").unwrap();
    assert_eq!(images(&room, LightChoice::Auto), 1);
    assert_eq!(images(&room, LightChoice::Power), 0);
    let with_mirror = |change: &dyn Fn(&mut Scene)| {
        let mut scene = room.clone();
        change(&mut scene);
        images(&scene, LightChoice::Auto)
    };
    assert_eq!(with_mirror(&|scene| scene.spheres[0].radius = 0.2), 1);
    assert_eq!(with_mirror(&|scene| scene.spheres[0].radius = 0.1), 0, "too small");
    assert_eq!(
        with_mirror(&|scene| scene.spheres[0].center = Vec3::new(0.0, 1.99, 0.0)),
        0,
        "around the lamp"
    );
    assert_eq!(with_mirror(&|scene| scene.materials[4].kind = MaterialKind::Metal { roughness: 0.1 }), 0);
    let three = |scene: &mut Scene| {
        let more = [0.0, 0.2].map(|x| Sphere { center: Vec3::new(x, 0.4, 0.5), ..scene.spheres[0] });
        scene.spheres.extend(more);
    };
    assert_eq!(with_mirror(&three), 2, "at most two");
    for scene in ["builtin:spheres", "builtin:materials"] {
        assert_eq!(images(&load(scene).unwrap(), LightChoice::Auto), 0, "{scene}");
    }
}
