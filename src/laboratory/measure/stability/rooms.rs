//! Leaks: rays that leave a wall next to a corner of a closed room, and start outside.

use super::methods::Method;
use super::rays::towards;
use super::rng::Rng;
use super::spawn::{SpawnMethod, WAECHTER};
use super::test_case::{FailureCounts, TestCase, trials};
use super::triangles::{self, mean};
use crate::kernel::surface::{inset, triangle_normal, triangle_offset};
use crate::math;
use crate::methods::Woop;
use glam::{DMat3, DVec3, Vec3};

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![TestCase {
        name: "spawn-corners",
        title: "Leaving the walls of closed rooms of size 2 next to their corners",
        axis: "distance of the room from the origin",
        places: &[0.0, 1.0, 10.0, 100.0, 1e3, 1e4, 2e4],
        methods: trials(
            leave_walls,
            &[
                Method::default("inset point in sight", Leaving::InsetInSight),
                Method::other("inset point", Leaving::Inset),
                Method::other("point", Leaving::Point),
            ],
        ),
        failure: "the ray starts outside the room",
        source: WAECHTER,
        ..TestCase::COMMON
    }]
}

/// Where a ray leaves from: the hit point, moved away from the triangle's edges, and only if it is in sight
/// from where the ray began. A ray aimed at an edge that juts into the room may hit the wall behind it, from
/// behind, as their distances differ by less than rounding; octray takes what is before the point instead.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Leaving {
    Point,
    Inset,
    InsetInSight,
}

/// The floor plan of a room in the shape of an L, as a fan around its first corner.
const PLAN: [[f64; 2]; 6] = [[0.0, 0.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 0.0]];

/// Returns a closed room in the shape of an L, 2 units large and turned at random: its triangles, and a point
/// in each of its arms.
pub fn room(rng: &mut Rng, distance: f64) -> (Vec<[Vec3; 3]>, [Vec3; 2]) {
    let turn = DMat3::from_axis_angle(rng.direction(), 6.0 * rng.unit());
    let center = rng.direction() * distance;
    let place = |[x, z]: [f64; 2], y: f64| (center + turn * DVec3::new(x, y, z)).as_vec3();
    let corner = |number: usize, y: f64| place(PLAN[number % 6], y);
    let floor = |y| (1..5).map(move |at| [corner(0, y), corner(at, y), corner(at + 1, y)]);
    let wall = |at| {
        let [a, b, c, d] =
            [(at, -1.0), (at + 1, -1.0), (at + 1, 1.0), (at, 1.0)].map(|(at, y)| corner(at, y));
        [[a, b, c], [a, c, d]]
    };
    let ground = floor(-1.0).map(|[a, b, c]| [a, c, b]);
    let triangles = ground.chain(floor(1.0)).chain((0..6).flat_map(wall)).collect();
    (triangles, [place([-0.5, 0.6], 0.1), place([0.6, -0.5], -0.2)])
}

/// Tests whether a closed mesh surrounds a point: the solid angles of its triangles, 0 in sum outside, ±4π
/// inside.
///
/// Source: Van Oosterom, Strackee, "The Solid Angle of a Plane Triangle", IEEE Transactions on Biomedical
/// Engineering 30(2), 1983.
fn surrounds(mesh: &[[Vec3; 3]], point: Vec3) -> bool {
    let half_angle = |triangle: &[Vec3; 3]| {
        let [a, b, c] = triangle.map(|corner| corner.as_dvec3() - point.as_dvec3());
        let (x, y, z) = (a.length(), b.length(), c.length());
        a.dot(b.cross(c)).atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    mesh.iter().map(half_angle).sum::<f64>().abs() > std::f64::consts::PI
}

fn leave_walls(rng: &mut Rng, distance: f64, counts: &mut FailureCounts, leaving: Leaving) {
    let (room, eyes) = room(rng, distance);
    let eye = eyes[rng.index(2)];
    for vertices in room.iter().copied() {
        let [a, b, c] = vertices.map(math::Vec3::<f32>::splat);
        let near = rng.scale(1e-8, 1e-1);
        let along = rng.scale(1e-8, 1.0) * (1.0 - near);
        let mut weights = [near, along, 1.0 - near - along];
        weights.rotate_left(rng.index(3));
        let arriving = towards(eye, mean(vertices.map(|corner| corner.as_dvec3()), weights));
        let hit = |triangle: [Vec3; 3]| triangles::intersect::<Woop>(triangle, &arriving, f32::INFINITY);
        let Some([t, mut u, mut v]) = hit(vertices) else { continue };
        if room.iter().any(|&other| other != vertices && hit(other).is_some_and(|[nearer, ..]| nearer <= t)) {
            continue;
        }
        let offset = triangle_offset(vertices);
        if leaving != Leaving::Point {
            (u, v) = inset((u, v), [b - a, c - a], offset);
        }
        let point = (b - a).mul_add(u, (c - a).mul_add(v, a)).get(0);
        let n = triangle_normal(vertices);
        let n = if n.dot(arriving.direction.get(0)) < 0.0 { n } else { -n };
        let start = SpawnMethod::share(1.0).start(point, point, n, offset);
        let (way, length) = (towards(eye, start.into()), start.distance(eye));
        let hides = |wall: &[Vec3; 3]| triangles::intersect::<Woop>(*wall, &way, length).is_some();
        let is_left = leaving != Leaving::InsetInSight || !room.iter().any(hides);
        counts.record(is_left && !surrounds(&room, start));
    }
}
