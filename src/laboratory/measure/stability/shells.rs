//! Leaving spheres, on both sides; and the opposite fault: of two shells close together, a ray that leaves one loses the other, if it
//! starts too far off.
//!
//! Source: Wächter, Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems ch. 6, 2019.

use super::aim::{exactly, ray, towards};
use super::leaving::{AGAIN, TRAVELLED, WAECHTER, Way, leaving, ways};
use super::spheres::{Ball, answer};
use super::{Bound, Dice, Recipe, Tally};
use crate::kernel::ray_sphere::Robust;
use crate::kernel::surface::{sphere_normal, sphere_offset};
use crate::math::{self, Ray};
use glam::Vec3;

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "leaving-spheres",
        title: "Leaving spheres of radius 1 outwards",
        axis: "distance of the centre from the origin",
        places: &[0.0, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4],
        failure: AGAIN,
        error: None,
        source: WAECHTER,
        cases: 100_000,
        methods: &ways!(outwards),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "leaving-inwards",
        title: "Leaving spheres of radius 1 inwards",
        axis: "distance of the centre from the origin",
        places: &[0.0, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4],
        failure: "the far side is missed, or the near one hit again",
        error: None,
        source: WAECHTER,
        cases: 100_000,
        methods: &ways!(inwards),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "leaving-shells",
        title: "Leaving one of two concentric shells of radius 1, some distance from the origin, towards the other",
        axis: "gap between the shells",
        places: &[1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2],
        failure: "the other shell is lost, or the own one hit again",
        error: None,
        source: WAECHTER,
        cases: 50_000,
        methods: &ways!(between_shells),
        // Two offsets of shells in these places.
        bound: |gap| if gap > 1e-5 { Bound::NO_FAILURE } else { Bound::NONE },
    },
];

/// Which side of a sphere rays leave to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    Outside,
    Inside,
}

/// Counts rays that leave a sphere and hit it again, or, inwards, miss the far side of it. They arrive from so near to so far, in radii above
/// the surface, and one in three from inside.
pub fn leave_sphere(
    tally: &mut Tally,
    dice: &mut Dice,
    ball: Ball,
    [near, far]: [f64; 2],
    side: Side,
    way: Way,
) {
    let center = math::Vec3::<f32>::splat(ball.center);
    let radius = f64::from(ball.radius);
    let distance = radius * dice.scale(near, far);
    let away = if dice.index(3) == 0 { radius * 0.9 * dice.unit() } else { radius + distance };
    let from = (ball.center.as_dvec3() + dice.direction() * away).as_vec3();
    let arriving = towards(from, ball.center.as_dvec3() + dice.in_cube() * radius);
    let Some(t) = answer::<Robust>(ball, &arriving, f32::INFINITY) else { return };
    let normal = sphere_normal(arriving.at(t), center);
    let exact = normal.mul_add(ball.radius, center).get(0);
    let n = if side == Side::Outside { normal } else { -normal }.get(0);
    let bound = sphere_offset(ball.center, ball.radius);
    let next = ray(way.start(exact, arriving.at(t).get(0), n, bound), leaving(dice, n));
    let again = answer::<Robust>(ball, &next, f32::INFINITY).filter(|&t| t > way.least);
    tally.count(match side {
        Side::Outside => again.is_some(),
        Side::Inside => !far_side(ball, &next, again),
    });
}

/// Is what the ray hits beyond the middle of its chord, from where it really starts?
fn far_side(ball: Ball, ray: &Ray<f32>, found: Option<f32>) -> bool {
    let (origin, d) = exactly(ray);
    let f = origin - ball.center.as_dvec3();
    let (b, c) = (-f.dot(d), f.length_squared() - f64::from(ball.radius).powi(2));
    let chord = b + (b * b - d.length_squared() * c).sqrt();
    found.is_some_and(|t| f64::from(t) > 0.5 * chord)
}

fn leave_spheres(dice: &mut Dice, place: f64, cases: usize, side: Side, way: Way) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let ball = Ball { center: (dice.direction() * place).as_vec3(), radius: 1.0 };
        leave_sphere(&mut tally, dice, ball, TRAVELLED, side, way);
    }
    tally
}

fn outwards<const WAY: usize>(dice: &mut Dice, place: f64, cases: usize) -> Tally {
    leave_spheres(dice, place, cases, Side::Outside, Way::ALL[WAY])
}

fn inwards<const WAY: usize>(dice: &mut Dice, place: f64, cases: usize) -> Tally {
    leave_spheres(dice, place, cases, Side::Inside, Way::ALL[WAY])
}

/// Counts rays that leave one of two shells around one centre towards the other, with a cosine of 0.2 at least, and do not hit it next. The
/// outer one has the radius 1; rays leave points of it outwards to inwards by turns.
pub fn leave_shell(tally: &mut Tally, dice: &mut Dice, center: Vec3, gap: f64, side: Side, way: Way) {
    let outer = Ball { center, radius: 1.0 };
    let inner = Ball { center, radius: (1.0 - gap) as f32 };
    let (own, other) = if side == Side::Inside { (outer, inner) } else { (inner, outer) };
    // A ray from within the shell that is left, or from without, finds the point; its own rounding belongs to the way.
    let normal = dice.direction();
    let reach = if side == Side::Inside { 0.3 } else { 3.0 };
    let arriving = towards(
        (center.as_dvec3() + normal * reach).as_vec3(),
        center.as_dvec3() + normal * f64::from(own.radius),
    );
    let Some(t) = answer::<Robust>(own, &arriving, f32::INFINITY) else { return tally.count(true) };
    let splat = math::Vec3::<f32>::splat(center);
    let normal = sphere_normal(arriving.at(t), splat);
    let exact = normal.mul_add(own.radius, splat).get(0);
    let n = if side == Side::Outside { normal } else { -normal }.get(0);
    let direction = loop {
        let direction = dice.direction().as_vec3();
        // Inwards, a ray with this cosine meets the inner shell while the gap is small.
        if direction.dot(n) > 0.2 {
            break direction;
        }
    };
    let start = way.start(exact, arriving.at(t).get(0), n, sphere_offset(center, own.radius));
    let next = ray(start, direction);
    let hit = |ball| {
        let t = answer::<Robust>(ball, &next, f32::INFINITY).filter(|&t| t > way.least);
        t.unwrap_or(f32::INFINITY)
    };
    let (own, other) = (hit(own), hit(other));
    tally.count(!(other < own && f64::from(other) < 6.0 * gap));
}

fn between_shells<const WAY: usize>(dice: &mut Dice, gap: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    for case in 0..cases {
        let center = dice.direction().as_vec3() * 3.0;
        let side = [Side::Inside, Side::Outside][case % 2];
        leave_shell(&mut tally, dice, center, gap, side, Way::ALL[WAY]);
    }
    tally
}
