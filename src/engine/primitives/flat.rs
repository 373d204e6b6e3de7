//! Flat lights: triangles, parallelograms of two triangles, and pieces of textured triangles, sampled
//! uniformly in solid angle.

use super::light::{ChosenLight, LightKind, LightRow, LightSample, bounded_importance, valid_pdf};
use super::triangle::TriangleRow;
use crate::buffers::block_means::{BlockMeans, GRID};
use crate::lane::{Lane, Mask, functions};
use crate::math::Vec3;
use crate::scene::Triangle;
use glam::{DVec2, DVec3, Vec2};
use std::f32::consts::PI;

/// A flat light before it becomes a row of the table.
#[derive(Clone, Copy)]
pub(crate) struct Flat {
    /// The first vertex, and the edges from there to the second and third.
    pub a: DVec3,
    pub ab: DVec3,
    pub ac: DVec3,
    /// Whether the light is the parallelogram that continues the triangle.
    pub is_quad: bool,
}

impl Flat {
    /// Returns a triangle as a light, or the parallelogram of which it is a half: `vertex` is then the one
    /// opposite the other half.
    pub fn new(triangle: &Triangle, vertex: Option<usize>) -> Self {
        let at = |index: usize| triangle.vertices[(vertex.unwrap_or(0) + index) % 3].as_dvec3();
        Self { a: at(0), ab: at(1) - at(0), ac: at(2) - at(0), is_quad: vertex.is_some() }
    }

    /// Returns the rows of a light with this power.
    pub fn light(&self, power: f64) -> (LightRow, [f32; 8]) {
        let Self { a, ab, ac, is_quad } = *self;
        let kind = if is_quad { LightKind::Parallelogram } else { LightKind::Triangle };
        let edges = [ab, ac].map(|edge| edge.as_vec3());
        let row = LightRow { kind, at: a.as_vec3(), edges, ..LightRow::default() };
        let (b, c) = (a + ab, a + ac);
        let center = if is_quad { 0.5 * (b + c) } else { (a + b + c) / 3.0 };
        let radius = [a, b, c].map(|vertex| (vertex - center).length()).into_iter().fold(0.0, f64::max);
        let (n, power) = (ab.cross(ac).normalize().as_vec3(), 0.5 * (power / f64::from(PI)));
        (row, bounded_importance(center.as_vec3(), radius as f32, Some(n), power))
    }
}

/// Returns the power that a triangle emits, on both sides, at a radiance of 1.
pub(crate) fn unit_power(triangle: &Triangle) -> f64 {
    let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
    f64::from(PI) * (b - a).cross(c - a).length()
}

/// Returns the sum of a texture's texels over a triangle with these texture coordinates, and their number.
pub(crate) fn sum_of_texels(texture: &BlockMeans, uvs: &[Vec2; 3]) -> (DVec3, f64) {
    let (level, points) = texture.points(sides(uvs), GRID);
    points
        .map(inside)
        .fold((DVec3::ZERO, 0.0), |(sum, count), at| (sum + texture.mean(level, blend(uvs, at)), count + 1.0))
}

/// Returns a point of the unit square, moved into its lower triangle.
pub(crate) fn inside(at: DVec2) -> DVec2 {
    if at.x + at.y > 1.0 { DVec2::ONE - at } else { at }
}

/// Returns the texture coordinates of a triangle at barycentrics.
pub(crate) fn blend(uvs: &[Vec2; 3], at: DVec2) -> DVec2 {
    let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
    a + (b - a) * at.x + (c - a) * at.y
}

/// Returns the differences of texture coordinates along two sides of a triangle.
pub(crate) fn sides([a, b, c]: &[Vec2; 3]) -> [DVec2; 2] {
    [*b - *a, *c - *a].map(|side| side.as_dvec2())
}

impl<L: Lane> ChosenLight<L> {
    /// Returns the light as seen from `origin`, in the lanes of flat lights.
    #[inline(always)]
    pub fn flat(&self, origin: Vec3<L>) -> FlatLight<L> {
        let [ab, ac] = self.edges;
        FlatLight { a: self.at - origin, ab, ac, is_quad: self.is_quad }
    }
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
    /// Returns the light that a hit triangle is, or is half of, as seen from `origin`.
    #[inline(always)]
    pub fn from_triangle(triangle: &TriangleRow<L>, origin: Vec3<L>) -> Self {
        let (a, [ab, ac]) = (triangle.a - origin, triangle.edges);
        let [first, second, third] = triangle.light.opposite_vertex();
        let turned = |from_b: Vec3<L>, from_c: Vec3<L>, from_a: Vec3<L>| {
            Vec3::select(third, from_c, Vec3::select(second, from_b, from_a))
        };
        Self {
            a: turned(a + ab, a + ac, a),
            ab: turned(ac - ab, ac * -L::one(), ab),
            ac: turned(ab * -L::one(), ab - ac, ac),
            is_quad: first | second | third,
        }
    }
    /// Selects one of two lights in each lane.
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
    /// The solid angle in sr, at most 2π.
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
    /// Samples a direction of the triangle: the part `part` of its solid angle lies towards the arc from b to
    /// a, and v runs from b to the arc from a to c.
    #[inline(always)]
    fn sample(&self, part: L, v: L) -> Vec3<L> {
        let [a, b, c] = self.corners;
        let [ab, rest] = self.sums;
        // c' is on the arc from a to c, so that the triangle a, b, c' has the solid angle `part`. With h
        // halfway between a and c': tan(part / 2) = det(a, b, h) / (a·h + b·h), solved for h = α a + γ c.
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

/// A flat light projected onto the unit sphere around the lit point: the triangle a, b, c, and for a
/// parallelogram also the triangle c, b, d behind its side from b to c.
///
/// Both triangles turn about b, so one number that runs through the first and then through the second
/// maps the unit square continuously onto a parallelogram.
struct SphericalLight<L: Lane> {
    /// ab × ac; its length is the area of a parallelogram, twice that of a triangle.
    normal: Vec3<L>,
    /// The plane's distance times the length of `normal`.
    height: L,
    first: SphericalTriangle<L>,
    /// The second triangle, with a solid angle of 0 in lanes with triangles.
    second: Option<SphericalTriangle<L>>,
    solid_angle: L,
}

/// Lights with a smaller solid angle are sampled by area: it has too few correct digits.
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
    /// Returns the pdf of the direction that meets the plane at `t`.
    #[inline(always)]
    fn pdf(&self, light: &FlatLight<L>, wi: Vec3<L>, t: L) -> L {
        // t² / (area · cos θ).
        let areas = L::select(light.is_quad, L::one(), L::splat(2.0));
        let by_area = areas * t * t / self.normal.dot(wi).abs();
        valid_pdf(L::select(self.sampled_by_area(), by_area, L::one() / self.solid_angle))
    }
    /// Samples a direction uniform in the solid angle.
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

/// Returns the pdf of the unit direction `wi` that meets the light at `t`.
#[inline(always)]
pub fn pdf<L: Lane>(light: &FlatLight<L>, wi: Vec3<L>, t: L) -> L {
    SphericalLight::new(light).pdf(light, wi, t)
}

/// Samples a direction towards a flat light: uniform in solid angle, or by area below `MIN_SOLID_ANGLE`.
///
/// Domain: edges of at least 1e-10 scene units; below, the square of the area underflows, and `n` is not a
/// unit vector.
/// Source: Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995; in the form of Peters without
/// angles, and fans of triangles, "BRDF Importance Sampling for Polygonal Lights", ACM TOG 40(4), 2021, §4.
#[inline(always)]
pub fn sample<L: Lane>(light: &FlatLight<L>, u: L, v: L) -> LightSample<L> {
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
