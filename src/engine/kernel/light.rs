//! Sampling directions towards lights, and their pdfs.
//!
//! Shapes: `WIDTH` lit points with a light each; vectors are relative to the lit point.
//! Units: pdfs per solid angle, in 1/sr; 0 where the light cannot be sampled. Then only scattered rays find
//! it.
//! Domain: u and v are uniform in [0, 1).

use crate::lane::{Lane, Mask, functions};
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::TAU;

/// A sampled point of a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<L: Lane> {
    /// Unit vector towards the point.
    pub wi: Vec3<L>,
    /// Distance to the point, in scene units.
    pub t: L,
    /// The light's unit normal there, on the lit side.
    pub n: Vec3<L>,
    /// The pdf of `wi`.
    pub pdf: L,
}

impl<L: Lane> LightSample<L> {
    /// Lane by lane, one of two samples.
    #[inline(always)]
    pub fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self {
            wi: Vec3::select(mask, if_true.wi, if_false.wi),
            t: L::select(mask, if_true.t, if_false.t),
            n: Vec3::select(mask, if_true.n, if_false.n),
            pdf: L::select(mask, if_true.pdf, if_false.pdf),
        }
    }
}

/// The cone that a sphere subtends.
struct Cone<L: Lane> {
    /// The squared distance of the centre, and one over the distance.
    distance2: L,
    per_distance: L,
    /// 1 − cos θ of its half angle; NaN from inside the sphere.
    one_minus_cos: L,
}

impl<L: Lane> Cone<L> {
    #[inline(always)]
    fn new(center: Vec3<L>, radius: L) -> Self {
        let distance2 = center.dot(center);
        let per_distance = L::one() / distance2.sqrt();
        let sine = radius * per_distance;
        let sin2 = sine * sine;
        // 1 − cos θ = sin² θ / (1 + cos θ), which does not cancel at any distance.
        let one_minus_cos = sin2 / (L::one() + (L::one() - sin2).sqrt());
        Self { distance2, per_distance, one_minus_cos }
    }
    /// One over the solid angle; 0 from inside the sphere and on it.
    #[inline(always)]
    fn pdf(&self) -> L {
        valid_pdf(L::splat(1.0 / TAU) / self.one_minus_cos)
    }
}

/// The pdf of directions towards a sphere: one over its solid angle; 0 from inside it and on it.
///
/// Domain: a radius of at least 1e-15 distances.
#[inline(always)]
pub fn sphere_pdf<L: Lane>(center: Vec3<L>, radius: L) -> L {
    Cone::new(center, radius).pdf()
}

/// A direction uniform in the cone that a sphere subtends, and the first point of the sphere there. The
/// normal has unit length within 4 ε times the distance over the radius; of spheres more than 2²⁰ radii away
/// it is shorter, at most about 1.
#[inline(always)]
pub fn sample_sphere<L: Lane>(center: Vec3<L>, radius: L, u: L, v: L) -> LightSample<L> {
    let cone = Cone::new(center, radius);
    let Cone { distance2, per_distance, one_minus_cos } = cone;
    let (wi, cos, sin2) = warp::sample_uniform_cone(center * per_distance, one_minus_cos, u, v);
    // The smaller root of t² − 2 t d cos θ + d² − r², from the product of the roots: the difference would
    // cancel.
    let radius2 = radius * radius;
    let half_chord = (sin2.neg_mul_add(distance2, radius2)).max(L::zero()).sqrt();
    let distance = distance2 * per_distance;
    let t = (distance2 - radius2) / distance.mul_add(cos, half_chord);
    // Farther away, the difference is rounding error, longer than the radius.
    let length = radius.max(distance * L::splat(f32::powi(0.5, 20)));
    let n = (wi * t - center) * (L::one() / length);
    LightSample { wi, t, n, pdf: cone.pdf() }
}

/// A flat light relative to the lit point: the triangle a, a + ab, a + ac, or the parallelogram that
/// continues it to a + ab + ac.
#[derive(Clone, Copy)]
pub struct FlatLight<L: Lane> {
    /// The first vertex.
    pub a: Vec3<L>,
    /// The edge to the second vertex.
    pub ab: Vec3<L>,
    /// The edge to the third vertex.
    pub ac: Vec3<L>,
    /// The lanes of parallelograms.
    pub is_quad: L::Mask,
}

impl<L: Lane> FlatLight<L> {
    /// Lane by lane, one of two lights.
    #[inline(always)]
    pub fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self {
            a: Vec3::select(mask, if_true.a, if_false.a),
            ab: Vec3::select(mask, if_true.ab, if_false.ab),
            ac: Vec3::select(mask, if_true.ac, if_false.ac),
            is_quad: (mask & if_true.is_quad) | (!mask & if_false.is_quad),
        }
    }
}

/// A triangle projected onto the unit sphere around the lit point.
#[derive(Clone, Copy)]
struct SphericalTriangle<L: Lane> {
    /// Unit vectors to the corners.
    corners: [Vec3<L>; 3],
    /// The absolute determinant of `corners`.
    volume: L,
    /// 1 + a·b, and a·c + b·c, of the `corners` a, b, c.
    sums: [L; 2],
    /// In sr, at most 2π.
    solid_angle: L,
}

impl<L: Lane> SphericalTriangle<L> {
    /// Source: Van Oosterom, Strackee, "The Solid Angle of a Plane Triangle", IEEE TBME 30(2), 1983.
    #[inline(always)]
    fn new(corners: [Vec3<L>; 3], volume: L) -> Self {
        let [a, b, c] = corners;
        let sums = [L::one() + a.dot(b), a.dot(c) + b.dot(c)];
        let half = functions::atan2(volume, sums[0] + sums[1]);
        Self { corners, volume, sums, solid_angle: half + half }
    }
    #[inline(always)]
    fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        let number = |a, b| L::select(mask, a, b);
        let vector = |corner: usize| Vec3::select(mask, if_true.corners[corner], if_false.corners[corner]);
        Self {
            corners: [vector(0), vector(1), vector(2)],
            volume: number(if_true.volume, if_false.volume),
            sums: [number(if_true.sums[0], if_false.sums[0]), number(if_true.sums[1], if_false.sums[1])],
            solid_angle: number(if_true.solid_angle, if_false.solid_angle),
        }
    }
    /// A direction of the triangle: `part`, of its solid angle, lies towards the arc from b to a, and v runs
    /// from b to the arc from a to c.
    #[inline(always)]
    fn sample(&self, part: L, v: L) -> Vec3<L> {
        let [a, b, c] = self.corners;
        let [ab, rest] = self.sums;
        // c' on the arc from a to c, so that the triangle a, b, c' has the solid angle `part`. With h halfway
        // between a and c': tan(part / 2) = det(a, b, h) / (a·h + b·h), solved for h = α a + γ c.
        let (sin, cos) = functions::sin_cos(L::splat(0.5) * part);
        let h = a * (rest.neg_mul_add(sin, self.volume * cos)) + c * (ab * sin);
        let corner = h * (L::splat(2.0) * a.dot(h) / h.dot(h)) - a;
        // The cosine is uniform on the arc from b to c'; 1 − cos comes from the chord, which does not cancel.
        let chord = corner - b;
        let full = (L::splat(0.5) * chord.dot(chord)).max(L::splat(f32::MIN_POSITIVE));
        let part = v * full;
        let two = L::splat(2.0);
        let along = (part * (two - part) / (full * (two - full))).sqrt();
        let at_b = along.neg_mul_add(L::one() - full, L::one() - part);
        (b * at_b + corner * along).normalize()
    }
}

/// A flat light projected onto the unit sphere around the lit point: the triangle a, b, c, and behind its
/// side from b to c that of a parallelogram, c, b, d.
///
/// Both triangles turn about b, so one number that runs through the first and then through the second
/// maps the unit square continuously onto a parallelogram.
struct SphericalLight<L: Lane> {
    /// ab × ac; its length is the area of a parallelogram, twice that of a triangle.
    normal: Vec3<L>,
    /// The plane's distance times the length of `normal`.
    height: L,
    first: SphericalTriangle<L>,
    /// Of a solid angle of 0 in lanes with triangles.
    second: Option<SphericalTriangle<L>>,
    solid_angle: L,
}

/// Smaller lights are sampled by area: their solid angle has too few correct digits.
const MIN_SOLID_ANGLE: f32 = 1e-3;

impl<L: Lane> SphericalLight<L> {
    #[inline(always)]
    fn new(&FlatLight { a, ab, ac, is_quad }: &FlatLight<L>) -> Self {
        let normal = ab.cross(ac);
        let height = a.dot(normal);
        let (b, c) = (a + ab, a + ac);
        let inverse_length = |v: Vec3<L>| L::one() / v.dot(v).sqrt();
        let (ia, ib, ic) = (inverse_length(a), inverse_length(b), inverse_length(c));
        let (pa, pb, pc) = (a * ia, b * ib, c * ic);
        let first = SphericalTriangle::new([pa, pb, pc], height.abs() * ia * ib * ic);
        let (mut second, mut solid_angle) = (None, first.solid_angle);
        if is_quad.any() {
            let d = b + ac;
            let id = inverse_length(d);
            let mut triangle = SphericalTriangle::new([pc, pb, d * id], height.abs() * ic * ib * id);
            triangle.solid_angle = triangle.solid_angle.only(is_quad);
            solid_angle = solid_angle + triangle.solid_angle;
            second = Some(triangle);
        }
        Self { normal, height, first, second, solid_angle }
    }
    #[inline(always)]
    fn sampled_by_area(&self) -> L::Mask {
        self.solid_angle.lt(L::splat(MIN_SOLID_ANGLE))
    }
    /// The pdf of the direction that meets the plane at `t`.
    #[inline(always)]
    fn pdf(&self, light: &FlatLight<L>, wi: Vec3<L>, t: L) -> L {
        // t² / (area · cos θ).
        let areas = L::select(light.is_quad, L::one(), L::splat(2.0));
        let by_area = areas * t * t / self.normal.dot(wi).abs();
        valid_pdf(L::select(self.sampled_by_area(), by_area, L::one() / self.solid_angle))
    }
    /// A direction uniform in the solid angle.
    #[inline(always)]
    fn sample_solid_angle(&self, u: L, v: L) -> Vec3<L> {
        let part = u * self.solid_angle;
        let Some(second) = self.second else { return self.first.sample(part, v) };
        let rest = part - self.first.solid_angle;
        let in_second = L::zero().lt(rest);
        let triangle = SphericalTriangle::select(in_second, second, self.first);
        triangle.sample(L::select(in_second, rest, part), v)
    }
}

/// The pdf of the unit direction `wi` that meets the light at `t`.
#[inline(always)]
pub fn flat_pdf<L: Lane>(light: &FlatLight<L>, wi: Vec3<L>, t: L) -> L {
    SphericalLight::new(light).pdf(light, wi, t)
}

/// A direction towards a flat light: uniform in solid angle, or by area below `MIN_SOLID_ANGLE`.
///
/// Domain: edges of at least 1e-10 scene units; below, the square of the area underflows, and `n` is not a
/// unit vector.
/// Source: Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995; in the form of Peters without
/// angles, and fans of triangles, "BRDF Importance Sampling for Polygonal Lights", ACM TOG 40(4), 2021, §4.
#[inline(always)]
pub fn sample_flat<L: Lane>(light: &FlatLight<L>, u: L, v: L) -> LightSample<L> {
    let spherical = SphericalLight::new(light);
    let by_area = {
        // Uniform barycentrics: Osada et al., "Shape Distributions", ACM TOG 21(4), 2002.
        let root = u.sqrt();
        let along_ab = L::select(light.is_quad, u, root * (L::one() - v));
        let along_ac = L::select(light.is_quad, v, root * v);
        light.ab.mul_add(along_ab, light.ac.mul_add(along_ac, light.a)).normalize()
    };
    let wi = Vec3::select(spherical.sampled_by_area(), by_area, spherical.sample_solid_angle(u, v));
    let t = spherical.height / spherical.normal.dot(wi);
    let n = spherical.normal.normalize().flip_sign(spherical.height) * -L::one();
    let pdf = spherical.pdf(light, wi, t).only(L::zero().lt(t));
    LightSample { wi, t, n, pdf }
}

/// The pdf where it is finite and above 0; else 0.
#[inline(always)]
fn valid_pdf<L: Lane>(pdf: L) -> L {
    pdf.only(L::zero().lt(pdf) & pdf.is_finite())
}
