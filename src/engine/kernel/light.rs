//! Points on emitters as seen from a point that they light, and how likely each is drawn.
//!
//! Shapes: `WIDTH` lit points with an emitter each; u and v are uniform in [0, 1). Vectors are relative to the lit point. Densities
//! are per solid angle, in 1/sr; 0 where the emitter cannot be drawn from: then only paths that happen to meet it find it.

use crate::lane::{Lane, functions};
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::TAU;

/// A point of an emitter.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<L: Lane> {
    /// Unit vector towards the point.
    pub direction: Vec3<L>,
    /// Distance to the point, in scene units.
    pub t: L,
    /// The emitter's unit normal there, on the lit side.
    pub normal: Vec3<L>,
    /// Of drawing this direction.
    pub density: L,
}

impl<L: Lane> LightSample<L> {
    /// The other one where `mask` holds.
    #[inline(always)]
    pub fn or(self, mask: L::Mask, other: Self) -> Self {
        Self {
            direction: Vec3::select(mask, other.direction, self.direction),
            t: L::select(mask, other.t, self.t),
            normal: Vec3::select(mask, other.normal, self.normal),
            density: L::select(mask, other.density, self.density),
        }
    }
}

/// A sphere's squared distance, and 1 − cos of half the angle of the cone that it fills; NaN from inside.
///
/// Without cancellation at any distance: 1 − cos θ = sin² θ / (1 + cos θ).
#[inline(always)]
fn cone<L: Lane>(center: Vec3<L>, radius: L) -> (L, L) {
    let distance2 = center.dot(center);
    let sin2 = radius * radius / distance2;
    (distance2, sin2 / (L::one() + (L::one() - sin2).sqrt()))
}

/// The density of each direction towards a sphere: one over its solid angle; 0 from inside it and on it.
///
/// Domain: a radius of at least 1e-15 distances.
#[inline(always)]
pub fn sphere_pdf<L: Lane>(center: Vec3<L>, radius: L) -> L {
    let (_, height) = cone(center, radius);
    some(L::splat(1.0 / TAU) / height)
}

/// A direction towards a sphere, all equally likely, and the first point there.
///
/// Source: Shirley, Wang, Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", ACM TOG 15(1), 1996.
#[inline(always)]
pub fn sample_sphere<L: Lane>(center: Vec3<L>, radius: L, u: L, v: L) -> LightSample<L> {
    let (distance2, height) = cone(center, radius);
    let distance = distance2.sqrt();
    let axis = center * (L::one() / distance);
    let (tangent, bitangent) = warp::orthonormal_basis(axis);
    let down = u * height;
    let cos = L::one() - down;
    let sin2 = down * (L::splat(2.0) - down);
    let sin = sin2.sqrt();
    let (sin_around, cos_around) = functions::sin_cos_turns(v);
    let direction = tangent.mul_add(sin * cos_around, bitangent.mul_add(sin * sin_around, axis * cos));
    // The smaller root of t² − 2 t d cos θ + d² − r², from the product of both: the difference would cancel.
    let radius2 = radius * radius;
    let half_chord = (sin2.neg_mul_add(distance2, radius2)).max(L::zero()).sqrt();
    let t = (distance2 - radius2) / distance.mul_add(cos, half_chord);
    let normal = (direction * t - center).normalize();
    LightSample { direction, t, normal, density: some(L::splat(1.0 / TAU) / height) }
}

/// A triangle as it is seen from the lit point.
struct Seen<L: Lane> {
    /// ab × ac: twice the area long.
    normal: Vec3<L>,
    /// The plane's distance times the length of `normal`.
    height: L,
    /// Unit vectors to the corners.
    corners: [Vec3<L>; 3],
    /// The determinant of `corners`, without sign.
    volume: L,
    /// 1 + a·b, and a·c + b·c, of `corners`.
    sums: [L; 2],
    /// In sr, at most 2π.
    solid_angle: L,
}

/// Triangles that fill less are drawn from by area: of their solid angle too few digits are left.
const LEAST_SOLID_ANGLE: f32 = 1e-3;

impl<L: Lane> Seen<L> {
    /// Source of the solid angle: Van Oosterom, Strackee, "The Solid Angle of a Plane Triangle", IEEE TBME 30(2), 1983.
    #[inline(always)]
    fn new(a: Vec3<L>, ab: Vec3<L>, ac: Vec3<L>) -> Self {
        let normal = ab.cross(ac);
        let height = a.dot(normal);
        let (b, c) = (a + ab, a + ac);
        let inverse = |v: Vec3<L>| L::one() / v.dot(v).sqrt();
        let (ia, ib, ic) = (inverse(a), inverse(b), inverse(c));
        let (pa, pb, pc) = (a * ia, b * ib, c * ic);
        let volume = height.abs() * ia * ib * ic;
        let sums = [L::one() + pa.dot(pb), pa.dot(pc) + pb.dot(pc)];
        let half = functions::atan2(volume, sums[0] + sums[1]);
        Self { normal, height, corners: [pa, pb, pc], volume, sums, solid_angle: half + half }
    }
    #[inline(always)]
    fn by_area(&self) -> L::Mask {
        self.solid_angle.lt(L::splat(LEAST_SOLID_ANGLE))
    }
    /// Of the direction that meets the plane at `t`.
    #[inline(always)]
    fn density(&self, direction: Vec3<L>, t: L) -> L {
        // t² / (area · cos), and the normal is twice the area long.
        let by_area = L::splat(2.0) * t * t / self.normal.dot(direction).abs();
        some(L::select(self.by_area(), by_area, L::one() / self.solid_angle))
    }
}

/// The density of the unit direction that meets the triangle a, a + ab, a + ac at `t`.
#[inline(always)]
pub fn triangle_pdf<L: Lane>(a: Vec3<L>, ab: Vec3<L>, ac: Vec3<L>, direction: Vec3<L>, t: L) -> L {
    Seen::new(a, ab, ac).density(direction, t)
}

/// A direction towards a triangle: all equally likely, or all its points where it is seen small.
///
/// Domain: edges of at least 1e-10 scene units; below, the square of the area leaves single precision, and `normal` is none.
/// Source: Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995; in the form without angles of Peters, "BRDF Importance
/// Sampling for Polygonal Lights", ACM TOG 40(4), 2021, §4.
#[inline(always)]
pub fn sample_triangle<L: Lane>(a: Vec3<L>, ab: Vec3<L>, ac: Vec3<L>, u: L, v: L) -> LightSample<L> {
    let seen = Seen::new(a, ab, ac);
    let by_area = {
        // Uniform weights of the corners: Osada et al., "Shape Distributions", ACM TOG 21(4), 2002.
        let root = u.sqrt();
        ab.mul_add(root * (L::one() - v), ac.mul_add(root * v, a)).normalize()
    };
    let direction = Vec3::select(seen.by_area(), by_area, in_solid_angle(&seen, u, v));
    let t = seen.height / seen.normal.dot(direction);
    let normal = seen.normal.normalize().flip_sign(seen.height) * -L::one();
    let density = seen.density(direction, t).only(L::zero().lt(t));
    LightSample { direction, t, normal, density }
}

#[inline(always)]
fn in_solid_angle<L: Lane>(seen: &Seen<L>, u: L, v: L) -> Vec3<L> {
    let [a, b, c] = seen.corners;
    let [ab, rest] = seen.sums;
    // The triangle a, b, c' has the share u of the solid angle; c' on the arc from a to c. With h halfway between a and c':
    // tan of half the angle = det(a, b, h) / (a·h + b·h); solved for h = α a + γ c.
    let (sin, cos) = functions::sin_cos(L::splat(0.5) * seen.solid_angle * u);
    let h = a * (rest.neg_mul_add(sin, seen.volume * cos)) + c * (ab * sin);
    let corner = h * (L::splat(2.0) * a.dot(h) / h.dot(h)) - a;
    // On the arc from b to c' the cosine is uniform; 1 − cos from the chord, which does not cancel.
    let chord = corner - b;
    let full = (L::splat(0.5) * chord.dot(chord)).max(L::splat(f32::MIN_POSITIVE));
    let part = v * full;
    let two = L::splat(2.0);
    let along = (part * (two - part) / (full * (two - full))).sqrt();
    let at_b = along.neg_mul_add(L::one() - full, L::one() - part);
    (b * at_b + corner * along).normalize()
}

/// The density if it is one: finite and above 0; else 0.
#[inline(always)]
fn some<L: Lane>(density: L) -> L {
    density.only(L::zero().lt(density) & density.is_finite())
}
