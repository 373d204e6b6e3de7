//! The law of every traversal: the same hit, bit for bit, as testing every primitive in order: spheres first,
//! then triangles, the nearest t winning, the lower index on a tie; at every width and by every choice of
//! equations.
//!
//! The oracle is a loop of its own that calls the kernels at width 1. Seeds are fixed.

use crate::common::rays::{Set, list_of};
use crate::common::*;
use octray::methods::{MollerTrumbore, Naive, Robust, Woop};
use octray::rays::{Hits, Rays, Structure, Tracer};
use octray::scene::Coordinates;

/// A hit's bits: t, primitive, u, v.
type Answer = [u32; 4];

const NOTHING: Answer = [f32::INFINITY.to_bits(), MISS, 0, 0];

/// Every primitive, one by one.
fn oracle<S: SphereMethod, T: TriangleMethod>(scene: &Scene, ray: &Ray<f32>) -> Answer {
    let (mut answer, mut nearest) = (NOTHING, f32::INFINITY);
    let sphere_ray = S::precalculate(ray);
    for (index, sphere) in scene.spheres.iter().enumerate() {
        let center = math::Vec3::splat(sphere.center);
        let (hit, t) = S::test(&sphere_ray, center, sphere.radius * sphere.radius, f32::INFINITY);
        if hit && t < nearest {
            nearest = t;
            answer = [t.to_bits(), index as u32, 0, 0];
        }
    }
    let triangle_ray = T::precalculate(ray);
    for (index, triangle) in scene.triangles.iter().enumerate() {
        let hit = T::test(&triangle_ray, &T::store(triangle.vertices), f32::INFINITY);
        if hit.mask && hit.t < nearest {
            nearest = hit.t;
            let primitive = (scene.spheres.len() + index) as u32;
            answer = [hit.t.to_bits(), primitive, hit.u.to_bits(), hit.v.to_bits()];
        }
    }
    answer
}

/// Asserts the law for one choice of equations; returns the answers.
fn assert_law<S: SphereMethod, T: TriangleMethod>(
    scene: &Scene,
    methods: Methods,
    rays: &[Ray<f32>],
) -> Vec<Answer> {
    let expected: Vec<Answer> = rays.iter().map(|ray| oracle::<S, T>(scene, ray)).collect();
    for width in [1, 8, 16] {
        let answers = Set::of(rays).nearest_in(&list_of(scene, methods, width));
        assert_eq!(answers.len(), expected.len());
        for ((answer, expected), ray) in answers.iter().zip(&expected).zip(rays) {
            assert_eq!(answer, expected, "{methods:?}, width {width}, {ray:?}");
        }
    }
    expected
}

/// Asserts the law for every choice of equations; returns the answers of each.
fn assert_law_of_all(scene: &Scene, rays: &[Ray<f32>]) -> Vec<Vec<Answer>> {
    fn of_sphere<S: SphereMethod>(
        scene: &Scene,
        sphere: SphereChoice,
        rays: &[Ray<f32>],
    ) -> Vec<Vec<Answer>> {
        use TriangleChoice as Choice;
        let methods =
            |triangle| Methods { sphere, triangle, traversal: TraversalChoice::Linear, ..Methods::default() };
        vec![
            assert_law::<S, Woop>(scene, methods(Choice::Woop), rays),
            assert_law::<S, MollerTrumbore>(scene, methods(Choice::MollerTrumbore), rays),
        ]
    }
    [
        of_sphere::<Robust>(scene, SphereChoice::Robust, rays),
        of_sphere::<Naive>(scene, SphereChoice::Naive, rays),
    ]
    .concat()
}

/// Spheres and triangles in a cube of edge 4.
fn mixed(rng: &mut Rng, spheres: usize, triangles: usize) -> Scene {
    let balls = (0..spheres).map(|_| sphere((rng.in_cube() * 2.0).as_vec3(), rng.scale(0.05, 0.8) as f32, 0));
    let spheres = balls.collect();
    let corners = (0..triangles).map(|_| {
        let center = rng.in_cube() * 2.0;
        triangle([(); 3].map(|()| (center + rng.in_cube()).as_vec3()), 0)
    });
    let triangles = corners.collect();
    Scene { spheres, triangles, ..diffuse() }
}

/// Unit directions from in and around the cube, towards it.
fn rays(rng: &mut Rng, count: usize) -> Vec<Ray<f32>> {
    let one = |_| {
        let origin = rng.in_cube() * [1.0, 6.0][rng.index(2)];
        ray(origin.as_vec3(), (rng.in_cube() * 2.0 - origin).normalize().as_vec3())
    };
    (0..count).map(one).collect()
}

fn hits(answers: &[Answer]) -> usize {
    answers.iter().filter(|answer| answer[1] != MISS).count()
}

#[test]
fn traversal_equals_every_primitive_one_by_one_on_random_scenes() {
    let mut rng = Rng(31);
    for (spheres, triangles) in
        [(0, 0), (1, 0), (0, 1), (7, 0), (8, 0), (9, 0), (17, 3), (3, 40), (40, 60), (0, 33)]
    {
        let scene = mixed(&mut rng, spheres, triangles);
        let rays = rays(&mut rng, 800);
        for answers in assert_law_of_all(&scene, &rays) {
            assert!(spheres + triangles < 30 || (200..800).contains(&hits(&answers)), "{}", hits(&answers));
            assert!(spheres + triangles > 0 || hits(&answers) == 0);
        }
    }
}

#[test]
fn ties_go_to_the_lower_index() {
    let mut rng = Rng(32);
    let single = mixed(&mut rng, 11, 13);
    // Every primitive three times: whichever is hit, its first copy must be named.
    let mut scene = single.clone();
    for _ in 0..2 {
        scene.spheres.extend_from_slice(&single.spheres);
        scene.triangles.extend_from_slice(&single.triangles);
    }
    let rays = rays(&mut rng, 1600);
    for answers in assert_law_of_all(&scene, &rays) {
        assert!(hits(&answers) > 200);
        for [_, primitive, ..] in answers {
            let first = primitive < 11 || (33..33 + 13).contains(&primitive) || primitive == MISS;
            assert!(first, "primitive {primitive} is a copy");
        }
    }
}

#[test]
fn traversal_equals_every_primitive_one_by_one_along_axes_and_with_zeros_of_both_signs() {
    let mut rng = Rng(33);
    let mut scene = mixed(&mut rng, 20, 20);
    // Primitives that such rays graze and meet exactly: on integers, in coordinate planes.
    for at in [Vec3::ZERO, Vec3::X, -Vec3::Y, Vec3::Z] {
        scene.spheres.push(sphere(at, 1.0, 0));
        scene.triangles.push(triangle([at, at + Vec3::X, at + Vec3::Y], 0));
        scene.triangles.push(triangle([at, at + Vec3::Z, at - Vec3::Y], 0));
    }
    let special = [0.0, -0.0, 1.0, -1.0, 1e-20, -1e-20, 1e-40, -1e-40];
    let mut rays = Vec::new();
    while rays.len() < 2000 {
        let direction = Vec3::from_array(std::array::from_fn(|_| special[rng.index(special.len())]));
        let length = direction.as_dvec3().length();
        let origin = match rng.index(3) {
            0 => (rng.in_cube() * 3.0).as_vec3(),
            1 => (rng.in_cube() * 3.0).round().as_vec3(),
            _ => (rng.in_cube() * 6.0).round().as_vec3() * 0.5,
        };
        if length > 0.5 {
            rays.push(ray(origin, (direction.as_dvec3() / length).as_vec3()));
        }
    }
    for answers in assert_law_of_all(&scene, &rays) {
        assert!(hits(&answers) > 400);
    }
}

#[test]
fn traversal_equals_every_primitive_one_by_one_for_directions_of_no_length() {
    let mut rng = Rng(34);
    let scene = mixed(&mut rng, 10, 10);
    let directions = [Vec3::NAN, Vec3::ZERO, Vec3::INFINITY, vec3(0.0, f32::NAN, 1.0), Vec3::X];
    let rays: Vec<_> = (0..400).map(|i| ray((rng.in_cube() * 4.0).as_vec3(), directions[i % 5])).collect();
    assert_law_of_all(&scene, &rays);
}

/// A hit at t_max or behind it is none, and what lies behind a hit never takes its place.
#[test]
fn hits_count_before_the_end_of_a_ray() {
    fn check(scene: &Scene, set: &Set, triangle: TriangleChoice, lanes: usize) -> usize {
        let list = list_of(scene, Methods { triangle, ..Methods::default() }, lanes);
        let endless = set.nearest_in(&list);
        let mut ended = 0;
        let below = [0.0, -1.0, f32::NAN, 0.5, 1.0 - f32::EPSILON, 1.0].map(|end| (end, false));
        for (end, counts) in below.into_iter().chain([(1.0 + f32::EPSILON, true), (2.0, true)]) {
            let t_max = endless.iter().map(|answer| match answer[1] {
                MISS => 1.0,
                _ => f32::from_bits(answer[0]) * end,
            });
            let set = Set { t_max: t_max.collect(), ..set.clone() };
            let answers = set.nearest_in(&list);
            for ((answer, endless), t_max) in answers.iter().zip(&endless).zip(&set.t_max) {
                if endless[1] != MISS && counts {
                    assert_eq!(answer, endless);
                } else {
                    assert_eq!(*answer, [t_max.to_bits(), MISS, 0, 0], "t_max {t_max}, {endless:?}");
                    ended += usize::from(endless[1] != MISS);
                }
            }
        }
        ended
    }
    let mut rng = Rng(35);
    for (spheres, triangles) in [(20, 20), (5, 0), (0, 20)] {
        let scene = mixed(&mut rng, spheres, triangles);
        let set = Set::of(&rays(&mut rng, 400));
        for triangle in [TriangleChoice::Woop, TriangleChoice::MollerTrumbore] {
            let ended = [1, 8, 16].map(|lanes| check(&scene, &set, triangle, lanes));
            assert!(ended[0] > 200 && ended == [ended[0]; 3], "{ended:?}");
        }
    }
}

#[test]
fn rays_of_ones_own_are_in_the_files_coordinates_and_end_where_they_say() {
    let coordinates = Coordinates { origin: DVec3::new(0.5, 1.5, 6.25), unit: 4.0 };
    let place = |x: f64, y: f64, z: f64| coordinates.to_scene(DVec3::new(x, y, z)).as_vec3();
    let floor = triangle([place(-90.0, 0.0, 90.0), place(90.0, 0.0, 90.0), place(0.0, 0.0, -90.0)], 0);
    let ball = sphere(place(3.0, 1.0, 0.0), 0.25, 0);
    let scene = Scene { coordinates, spheres: vec![ball], triangles: vec![floor], ..diffuse() };
    let (geometry, endless) = (scene.geometry(), f32::INFINITY);
    for (traversal, length) in Traversal::ALL.into_iter().flat_map(|one| [1.0, 0.01, 40.0].map(|l| (one, l)))
    {
        let structure = Structure::tree(&geometry, traversal);
        // Down from y = 5: to the floor, to the ball, not so far as either, no further, and nowhere.
        let x = [0.0, 3.0, 0.0, 3.0, 0.0, 0.0];
        let (y, zeros, down) = ([5.0; 6], [0.0; 6], [-length, -length, -length, -length, -length, 0.0]);
        let (t_max, before) = (
            [endless, 3.1, 4.9, endless, endless, 9.0].map(|t| t / length),
            [endless, 9.0, 9.0, 2.9, 5.1, 9.0].map(|t| t / length),
        );
        let expected = [(5.0, 1), (3.0, 0), (4.9, MISS), (2.9, MISS), (5.0, 1), (9.0, MISS)];
        for any in [false, true] {
            let (mut t, mut primitive, [mut u, mut v]) = (before, [MISS; 6], [[0.0; 6]; 2]);
            let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
            let rays = Rays::new([&x, &y, &zeros], [&zeros, &down, &zeros]).until(&t_max);
            match any {
                true => Tracer::new().occluded(&structure, &rays, &mut hits),
                false => Tracer::new().closest(&structure, &rays, &mut hits),
            }
            for (at, (expected, number)) in expected.into_iter().enumerate() {
                let what = format!(
                    "{traversal:?}, length {length}, {any}: ray {at} at {} {}",
                    t[at] * length,
                    primitive[at]
                );
                assert_eq!(primitive[at] == MISS, number == MISS, "{what}");
                assert!(
                    any || (primitive[at] == number && (t[at] * length - expected).abs() < 1e-5),
                    "{what}"
                );
            }
        }
    }
}
