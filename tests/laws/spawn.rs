//! The law of spawned rays: a ray spawned on a surface, by the offset of `kernel::surface`, never hits it
//! again, and loses nothing that is clearly farther away than that offset.
//!
//! The rays are those of `octray stability`, here from near and far at once. Seeds are fixed; re-hits must be
//! 0.

use crate::common::*;
use octray::kernel::surface::{sphere_offset, sphere_surface, triangle_normal, triangle_offset};
use octray::measure::stability::shells::{Side, leave_shell, leave_sphere};
use octray::measure::stability::spawn::{self, SpawnMethod, leave_triangle};
use octray::measure::stability::spheres::Ball;
use octray::measure::stability::{FailureCounts, rooms};
use octray::primitives::{PrimitiveTables, SampledAs, SphereRow, TriangleRow};

/// How far rays travel before they leave, in sizes of what they leave.
const TRAVELLED: [f64; 2] = [1e-2, 1e3];

/// The test cases leave by the numbers that pictures are made with.
#[test]
fn tables_hold_the_offsets_and_normals_that_are_tested_here() {
    let mut rng = Rng(20);
    for _ in 0..100 {
        let ball = sphere(rng.in_cube().as_vec3(), rng.scale(1e-3, 1e3) as f32, 0);
        let vertices = [(); 3].map(|()| rng.in_cube().as_vec3());
        let scene = Scene { spheres: vec![ball], triangles: vec![triangle(vertices, 0)], ..diffuse() };
        let tables = PrimitiveTables::new(&scene, |_| SampledAs::Nothing);
        let row = SphereRow::<f32>::fetch(&tables.spheres, 0, true);
        assert_eq!((row.center.get(0), row.inverse_radius), (ball.center, 1.0 / ball.radius));
        assert_eq!(row.offset, sphere_offset(ball.center, ball.radius));
        let row = TriangleRow::<f32>::fetch(&tables.triangles.rows, 0, true);
        let [a, b, c] = vertices;
        let vectors = [row.a, row.edges[0], row.edges[1], row.ng].map(|vector| vector.get(0));
        assert_eq!(vectors, [a, b - a, c - a, triangle_normal(vertices)]);
        assert_eq!(row.offset, triangle_offset(vertices));
    }
}

/// The renderer's own way to spawn rays.
const OWN: SpawnMethod = SpawnMethod::share(1.0);

/// Edges of triangles, and their distances from the origin.
const TRIANGLES: [(f64, f64); 9] = [
    (1.0, 0.0),
    (1.0, 1.0),
    (1.0, 1e5),
    (1e3, 1.0),
    (1e-3, 1e-3),
    (1e-3, 1.0),
    (1e5, 1e5),
    (1e-6, 1e-6),
    (1e-2, 30.0),
];

#[test]
fn triangles_are_left_without_hitting_them_again() {
    for (size, place) in TRIANGLES {
        let (mut rng, mut counts) = (Rng(21), FailureCounts::default());
        while counts.tested < 40_000 {
            // Every other triangle is a sliver.
            let flat = [1.0, rng.scale(10.0, 1e4)][rng.index(2)];
            if let Some(vertices) = spawn::triangle(&mut rng, size, place, flat) {
                let travelled = TRAVELLED.map(|travelled| travelled * size);
                leave_triangle(&mut counts, &mut rng, vertices, travelled, OWN);
            }
        }
        assert_eq!(counts.failures, 0, "edge {size}, {place} from the origin");
    }
}

/// Radii, and distances of the centre from the origin; both sides can be left while the distance is below
/// some 10⁴ radii.
const SPHERES: [(f64, [f64; 3]); 5] = [
    (1.0, [0.0, 1.0, 100.0]),
    (1e-3, [0.0, 1e-3, 1.0]),
    (1e3, [1.0, 1e3, 1e5]),
    (1e6, [1.0, 1e6, 1e8]),
    (0.1, [50.0, 200.0, 500.0]),
];

const SIDES: [Side; 2] = [Side::Outside, Side::Inside];

#[test]
fn spheres_are_left_on_both_sides_without_hitting_them_again() {
    for (radius, places) in SPHERES {
        for (place, side) in places.into_iter().flat_map(|place| SIDES.map(|side| (place, side))) {
            let (mut rng, mut counts) = (Rng(22), FailureCounts::default());
            while counts.tested < 20_000 {
                let ball = Ball { center: (rng.direction() * place).as_vec3(), radius: radius as f32 };
                leave_sphere(&mut counts, &mut rng, ball, TRAVELLED, side, OWN);
            }
            assert_eq!(counts.failures, 0, "radius {radius}, {place} from the origin, {side:?}");
        }
    }
}

/// Of two shells around one centre, the outer one of radius 1: how many of 5000 rays that leave one towards
/// the other do not hit it next.
fn lost_between_shells(center: Vec3, gap: f64) -> [usize; 2] {
    let mut rng = Rng(23);
    SIDES.map(|side| {
        let mut counts = FailureCounts::default();
        while counts.tested < 5000 {
            leave_shell(&mut counts, &mut rng, center, gap, side, OWN);
        }
        counts.failures
    })
}

/// The opposite fault: an offset that is too large would start beyond the other shell.
#[test]
fn close_shells_are_not_lost_while_the_gap_is_twice_the_offset() {
    for center in [Vec3::ZERO, vec3(1.0, -2.0, 3.0), vec3(40.0, 0.0, 9.0)] {
        let offset = f64::from(sphere_offset(center, 1.0));
        for gap in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
            let lost = lost_between_shells(center, gap);
            if gap > 2.0 * offset {
                assert_eq!(lost, [0, 0], "centre {center}, gap {gap:e}, offset {offset:e}");
            }
        }
        // And below one offset they are: the test can see the fault.
        assert!(lost_between_shells(center, 0.5 * offset).iter().sum::<usize>() > 1000);
    }
}

/// The points and normals of spheres around and far from the origin, from points so close to them that the
/// root is left out, from others, and from the centre itself.
#[test]
fn points_are_on_their_spheres_and_normals_have_unit_length() {
    let mut rng = Rng(22);
    let [mut roots, mut others] = [0, 0];
    for case in 0..200_000 {
        let (place, radius) = (rng.scale(1e-3, 1e6), rng.scale(1e-6, 1e3));
        let (center, radius) = ((rng.direction() * place).as_vec3(), radius as f32);
        // Off the surface as a hit that comes from far away is.
        let off = 1.0 + rng.scale(1e-9, 0.5) * if case % 2 == 0 { 1.0 } else { -1.0 };
        let near = (center.as_dvec3() + rng.direction() * (f64::from(radius) * off)).as_vec3();
        let (near, splat) = (math::Vec3::<f32>::splat(near), math::Vec3::splat(center));
        let (point, normal) = sphere_surface(near, splat, 1.0 / radius, true);
        let (point, normal) = (point.get(0), normal.get(0));
        let epsilon = f64::from(octray::math::EPSILON);
        let length = normal.as_dvec3().length();
        assert!((length - 1.0).abs() <= 3.0 * epsilon, "|n| = {length}, r = {radius}, c = {center}");
        let exact = center.as_dvec3() + normal.as_dvec3() / length * f64::from(radius);
        let bound = 4.5 * epsilon * f64::from(center.abs().max_element() + radius);
        let error = (point.as_dvec3() - exact).length();
        assert!(error <= bound, "off by {error}, bound {bound}, r = {radius}, c = {center}");
        // The direction is that of the point given.
        let from_center = near.get(0) - center;
        if from_center != Vec3::ZERO {
            let cross = from_center.as_dvec3().normalize().cross(normal.as_dvec3()).length();
            assert!(cross <= 4.0 * epsilon, "the normal turns by {cross}");
        }
        // The root is left out up to 2⁻¹³ of the radius.
        *if (off - 1.0).abs() > 2e-4 { &mut roots } else { &mut others } += 1;
    }
    assert!(roots > 10_000 && others > 10_000);
    let (point, normal) = sphere_surface(math::Vec3::<f32>::zero(), math::Vec3::zero(), 0.5, true);
    assert_eq!((point.get(0), normal.get(0)), (vec3(0.0, 2.0, 0.0), Vec3::Y));
}

/// Closed rooms are black under a bright sky: no path of up to 100 bounces on white walls finds a way out, at
/// any distance from the origin, also with something else there.
#[test]
fn no_light_leaks_into_closed_rooms() {
    let mut rng = Rng(24);
    for distance in [0.0, 100.0, 1000.0, 10_000.0] {
        let (room, [position, look_at]) = rooms::room(&mut rng, distance);
        let scene = Scene {
            spheres: vec![sphere(vec3(0.0, 0.0, 3.0), 0.5, 0)],
            triangles: room.into_iter().map(|vertices| triangle(vertices, 0)).collect(),
            camera: camera(position, look_at, 90.0),
            max_bounces: 100,
            ..diffuse()
        };
        let film = film(&scene, Settings { resolution: [64, 64], ..Settings::of(&scene) }, 8);
        assert_eq!(mean(&film.picture()), 0.0, "{distance} from the origin");
        assert_eq!(film.rays(), 64 * 64 * 8 * 101, "{distance} from the origin: paths ended");
    }
}

/// Rays that pass the edge that juts into a room within rounding meet both of its walls at one distance: the
/// far one, from behind, must not let them out. Uncorrected, two rooms in three lose up to a hundredth.
#[test]
fn no_light_leaks_past_edges_that_jut_in() {
    let mut rng = Rng(25);
    let black = Material { color: Vec3::ZERO, ..diffuse().materials[0].clone() };
    for round in 0..24 {
        let distance = [0.0, 1.0, 100.0, 10_000.0][round % 4];
        let (room, [position, _]) = rooms::room(&mut rng, distance);
        let [edge, ..] = room[0];
        let scene = Scene {
            triangles: room.iter().map(|&vertices| triangle(vertices, 0)).collect(),
            camera: camera(position, edge + (room[4][0] - edge) * rng.unit() as f32, 1e-4),
            max_bounces: 20,
            ..diffuse()
        };
        let film = |scene: &Scene| film(scene, Settings { resolution: [64, 64], ..Settings::of(scene) }, 8);
        let bright = film(&scene);
        assert_eq!(mean(&bright.picture()), 0.0, "{distance} from the origin");
        assert_eq!(bright.rays(), 64 * 64 * 8 * 21, "{distance} from the origin: paths ended");
        // What is hit does not depend on whether the path may go on.
        let wall = |number| Material { emission: Vec3::splat(number as f32), ..black.clone() };
        let triangles = (0..room.len()).map(|wall| triangle(room[wall], wall as u32)).collect();
        let shining = Scene { materials: (0..room.len()).map(wall).collect(), triangles, ..scene };
        let picture = |max_bounces| film(&Scene { max_bounces, ..shining.clone() }).picture();
        assert!(picture(0).pixels == picture(1).pixels, "{distance} from the origin: other walls");
    }
}
