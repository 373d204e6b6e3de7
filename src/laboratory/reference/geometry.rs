//! The scene in double precision: where a ray hits spheres and triangles, the surface at that point, and how
//! accurate single precision is there.

use super::texture;
use crate::scene::{Camera, LightShape, Material, Scene, Side, Sky};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Roundings that both kernels stay within; see the sums above.
const BOUND: f64 = 40.0 / 16_777_216.0;

/// A scene in double precision.
pub struct Reference {
    pub(super) camera: Camera,
    pub(super) sky: Sky,
    pub(super) lights: Vec<LightShape>,
    pub(super) materials: Vec<Material>,
    textures: Vec<texture::Levels>,
    spheres: Vec<Sphere>,
    triangles: Vec<Triangle>,
}

impl Reference {
    /// Copies the scene. Points are those of its file if it was loaded so ([`Scene::unrounded`]).
    pub fn new(scene: &Scene) -> Self {
        let (spheres, triangles) = primitives(scene);
        Self {
            camera: scene.camera,
            sky: scene.sky,
            lights: scene.lights.iter().map(|light| light.shape).collect(),
            materials: scene.materials.clone(),
            textures: scene.textures.iter().map(texture::Levels::new).collect(),
            spheres,
            triangles,
        }
    }

    /// The nearest hit with t > 0 of the ray from `origin` along `direction`, which need not have unit
    /// length. Of equal t, the lower index. Surfaces are hit from both sides.
    pub fn closest(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let spheres = self.spheres.iter().map(|sphere| sphere.hit(origin, direction));
        let triangles = self.triangles.iter().map(|triangle| triangle.hit(origin, direction));
        let hits = spheres.chain(triangles).zip(0..).filter_map(|(hit, primitive)| {
            let (t, u, v) = hit?;
            Some(Hit { primitive, t, u, v })
        });
        hits.min_by(|a, b| a.t.total_cmp(&b.t))
    }

    /// All crossings of a ray, by the numbers of the primitives.
    pub(super) fn crossings(&self, origin: DVec3, unit: DVec3) -> impl Iterator<Item = (u32, Crossing)> {
        let spheres = self.spheres.iter().map(move |sphere| sphere.crossings(origin, unit));
        let triangles = self.triangles.iter().map(move |triangle| triangle.crossings(origin, unit));
        let all = spheres.chain(triangles).zip(0..);
        all.flat_map(|(crossings, number)| crossings.into_iter().map(move |crossing| (number, crossing)))
    }

    /// The primitive of this number: spheres first, in the scene's order, then triangles.
    pub(super) fn primitive(&self, number: u32) -> Option<&dyn Primitive> {
        let number = number as usize;
        match self.spheres.get(number) {
            Some(sphere) => Some(sphere),
            None => Some(self.triangles.get(number - self.spheres.len())?),
        }
    }

    /// The colour of texture `texture` at `uv` where a path sees `area` of it, white if there is none; see
    /// [`texture::Levels::lookup`].
    pub(super) fn lookup(&self, texture: Option<u32>, uv: DVec2, wraps: bool, area: f64) -> DVec3 {
        texture.map_or(DVec3::ONE, |index| self.textures[index as usize].lookup(uv, wraps, area))
    }
}

/// A primitive in double precision.
pub(super) trait Primitive {
    /// The smallest t > 0 at which a ray hits it, and barycentric weights: see [`Hit`].
    fn hit(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64, f64)>;
    /// All hits with t > 0.
    fn hits(&self, origin: DVec3, direction: DVec3) -> Vec<(f64, f64, f64)> {
        self.hit(origin, direction).into_iter().collect()
    }
    /// The surface at a hit at `point`.
    fn surface(&self, point: DVec3, u: f64, v: f64) -> Surface;
    /// How far a right hit may lie from it: see [`super::verdict`].
    fn bound(&self, origin: DVec3, unit: DVec3) -> f64;
    /// Of a point from it.
    fn distance(&self, point: DVec3) -> f64;
    /// Where a ray passes through it by more than the bound.
    fn crossings(&self, origin: DVec3, unit: DVec3) -> Vec<Crossing>;
    /// How far the point of the weights `u` and `v` lies off a ray; `None` on what has no weights.
    fn off_ray(&self, _origin: DVec3, _unit: DVec3, _u: f64, _v: f64) -> Option<f64> {
        None
    }
}

/// The spheres and triangles of a scene, as its file has them, or else as the scene does: every
/// single-precision number converts exactly.
pub(super) fn primitives(scene: &Scene) -> (Vec<Sphere>, Vec<Triangle>) {
    let exact = scene.unrounded.as_ref();
    let spheres = scene.spheres.iter().enumerate().map(|(index, sphere)| {
        let rounded = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        let (center, radius) = exact.map_or(rounded, |exact| exact.spheres[index]);
        Sphere {
            center,
            radius,
            turn: f64::from(sphere.texture_turn),
            picture_from: sphere.texture_side,
            material: sphere.material as usize,
        }
    });
    let triangles = scene.triangles.iter().enumerate().map(|(index, triangle)| {
        let (uvs, normals) = (scene.uvs.get(index), scene.normals.get(index));
        let rounded = triangle.vertices.map(|vertex| vertex.as_dvec3());
        Triangle {
            vertices: exact.map_or(rounded, |exact| exact.triangles[index]),
            uvs: uvs.map_or([DVec2::ZERO; 3], |uvs| uvs.map(|uv| uv.as_dvec2())),
            normals: normals.map_or([DVec3::ZERO; 3], |normals| normals.map(|n| n.as_dvec3())),
            material: triangle.material as usize,
        }
    });
    (spheres.collect(), triangles.collect())
}

pub(super) struct Sphere {
    center: DVec3,
    radius: f64,
    turn: f64,
    picture_from: Side,
    material: usize,
}

pub(super) struct Triangle {
    vertices: [DVec3; 3],
    uvs: [DVec2; 3],
    /// Unit vertex normals, or zeros.
    normals: [DVec3; 3],
    material: usize,
}

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Spheres first, in the scene's order, then triangles.
    pub primitive: u32,
    /// In units of the direction's length; above 0.
    pub t: f64,
    /// Barycentric weight of a triangle's second vertex; 0 on spheres.
    pub u: f64,
    /// Barycentric weight of a triangle's third vertex; 0 on spheres.
    pub v: f64,
}

/// A place where a ray passes through a primitive by more than the error bound.
pub(super) struct Crossing {
    /// From the origin.
    pub distance: f64,
    /// Its error bound along the ray.
    pub slack: f64,
}

/// The surface at a hit point.
pub(super) struct Surface {
    pub point: DVec3,
    /// Geometric normal, unit length. A sphere's points outwards, a triangle's to the side from which its
    /// vertices turn anticlockwise.
    pub ng: DVec3,
    /// Shading normal, unit length, where it is not `ng`; in the hemisphere of `ng`.
    pub ns: Option<DVec3>,
    /// What leads from `point` to the smooth surface, on the side of `ng` and on the other one: see
    /// [`crate::kernel::normals::bulge`].
    pub bulge: [DVec3; 2],
    /// Unit vector along growing u, zero where u is constant; v grows on the side of `hand` · ng × right.
    pub right: DVec3,
    pub hand: f64,
    pub material: usize,
    /// Texture coordinates: u, and v from the top.
    pub uv: DVec2,
    /// Whether texture rows repeat.
    pub wraps: bool,
    /// Area in texture coordinates over area in space.
    pub density: f64,
    /// One over the radius, 0 on triangles.
    pub curvature: f64,
    /// The largest length in the computation of `point`, whose error is a few 2⁻⁵³ of it.
    pub scale: f64,
}

/// The smallest t > 0 at which a ray hits a sphere.
///
/// The discriminant comes from the distance between centre and line, and the root that would cancel from the
/// product of the roots: Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere
/// Intersection", Ray Tracing Gems, 2019, ch. 7.
pub fn hit_sphere(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Option<f64> {
    sphere_roots(center, radius, origin, direction)?.into_iter().find(|&t| t > 0.0)
}

/// Where a line passes through a sphere, in order.
fn sphere_roots(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let to_center = center - origin;
    let a = direction.length_squared();
    let b = to_center.dot(direction);
    let perpendicular = to_center - direction * (b / a);
    let discriminant = radius * radius - perpendicular.length_squared();
    // A direction of length zero makes a NaN, which is no hit.
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    let q = b + (a * discriminant).sqrt().copysign(b);
    let (t0, t1) = ((to_center.length_squared() - radius * radius) / q, q / a);
    Some([t0.min(t1), t0.max(t1)])
}

impl Primitive for Sphere {
    #[inline(always)]
    fn hit(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64, f64)> {
        hit_sphere(self.center, self.radius, origin, direction).map(|t| (t, 0.0, 0.0))
    }

    fn hits(&self, origin: DVec3, direction: DVec3) -> Vec<(f64, f64, f64)> {
        let roots = sphere_roots(self.center, self.radius, origin, direction).into_iter().flatten();
        roots.filter(|&t| t > 0.0).map(|t| (t, 0.0, 0.0)).collect()
    }

    fn surface(&self, point: DVec3, _u: f64, _v: f64) -> Surface {
        let normal = (point - self.center).normalize();
        let turned = DVec3::new(normal.z, 0.0, -normal.x);
        let east = if turned.length() < 1e-6 { DVec3::X } else { turned.normalize() };
        let hand = match self.picture_from {
            Side::Outside => 1.0,
            Side::Inside => -1.0,
        };
        Surface {
            ns: None,
            bulge: [DVec3::ZERO; 2],
            right: east * hand,
            hand,
            point: self.center + normal * self.radius,
            ng: normal,
            material: self.material,
            uv: texture::on_sphere(normal, self.turn, self.picture_from),
            wraps: false,
            // A turn is 2π r sin θ long, from pole to pole it is π r.
            density: 1.0 / (TAU * PI * self.radius.powi(2) * normal.x.hypot(normal.z)),
            curvature: 1.0 / self.radius,
            scale: self.center.abs().max_element() + self.radius,
        }
    }

    fn bound(&self, origin: DVec3, _unit: DVec3) -> f64 {
        BOUND * ((origin - self.center).length() + self.radius)
    }

    fn distance(&self, point: DVec3) -> f64 {
        ((point - self.center).length() - self.radius).abs()
    }

    /// None, or two: entry and exit.
    #[inline(always)]
    fn crossings(&self, origin: DVec3, unit: DVec3) -> Vec<Crossing> {
        let bound = self.bound(origin, unit);
        let to_center = self.center - origin;
        let middle = to_center.dot(unit);
        let perpendicular = (to_center - unit * middle).length();
        // A NaN, from a direction of length zero, is no crossing.
        if self.radius - perpendicular > bound {
            let half = (self.radius * self.radius - perpendicular * perpendicular).sqrt();
            let slack = 2.0 * bound / (half / self.radius);
            [middle - half, middle + half].map(|distance| Crossing { distance, slack }).into()
        } else {
            Vec::new()
        }
    }
}

impl Triangle {
    /// The bound on whether the ray passes an edge.
    fn outline_bound(&self, origin: DVec3) -> f64 {
        BOUND * self.vertices.map(|vertex| (vertex - origin).length()).into_iter().fold(0.0, f64::max)
    }

    /// The vertices projected along the ray, which is at the origin.
    fn across(&self, origin: DVec3, unit: DVec3) -> [DVec3; 3] {
        self.vertices.map(|vertex| (vertex - origin) - unit * (vertex - origin).dot(unit))
    }
}

impl Primitive for Triangle {
    /// t > 0 and the barycentric weights of the second and third vertex.
    ///
    /// A ray that hits passes all three edges on the same side: three volumes of one sign. Two triangles with
    /// a common edge compute the same volume for it, bit for bit, with opposite signs, so no ray passes
    /// between them. (Plücker coordinates; see Shoemake, "Plücker Coordinate Tutorial", Ray Tracing News
    /// 11(1), 1998.)
    #[inline(always)]
    fn hit(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64, f64)> {
        let [a, b, c] = self.vertices.map(|vertex| vertex - origin);
        let weights = [c.cross(b).dot(direction), a.cross(c).dot(direction), b.cross(a).dot(direction)];
        let sum: f64 = weights.iter().sum();
        let one_sign = weights.iter().all(|&w| w >= 0.0) || weights.iter().all(|&w| w <= 0.0);
        let normal = (b - a).cross(c - a);
        let t = normal.dot(a) / normal.dot(direction);
        (one_sign && sum != 0.0 && t > 0.0 && t.is_finite()).then(|| (t, weights[1] / sum, weights[2] / sum))
    }

    fn surface(&self, _point: DVec3, u: f64, v: f64) -> Surface {
        let [a, b, c] = self.vertices;
        let weights = [1.0 - u - v, u, v];
        let uv = self.uvs[0] * weights[0] + self.uvs[1] * weights[1] + self.uvs[2] * weights[2];
        let normal = (b - a).cross(c - a).normalize();
        let blend =
            self.normals[0] * weights[0] + self.normals[1] * weights[1] + self.normals[2] * weights[2];
        let ns = (blend.length() > 0.01).then(|| blend.normalize());
        let [p, q, r] = self.uvs;
        // Solves b − a = (q − p).x ∂P/∂u + (q − p).y ∂P/∂v, and the same for c, for ∂P/∂u.
        let determinant = (q - p).perp_dot(r - p);
        let right = ((b - a) * (r - p).y - (c - a) * (q - p).y) / determinant;
        let right = if determinant == 0.0 { DVec3::ZERO } else { right.normalize_or_zero() };
        let point = a * weights[0] + b * weights[1] + c * weights[2];
        let bulge = [1.0, -1.0].map(|side| {
            let outward = side * blend.dot(normal).signum();
            let lift = |corner: usize| {
                let n = self.normals[corner] * outward;
                n * weights[corner] * (self.vertices[corner] - point).dot(n).max(0.0)
            };
            let bulge = lift(0) + lift(1) + lift(2);
            if ns.is_none() || bulge.dot(normal) * side < 0.0 { DVec3::ZERO } else { bulge }
        });
        Surface {
            bulge,
            ns: ns.map(|ns| if ns.dot(normal) < 0.0 { -ns } else { ns }),
            right,
            hand: determinant.signum(),
            point,
            ng: normal,
            material: self.material,
            uv: DVec2::new(uv.x, 1.0 - uv.y),
            wraps: true,
            density: determinant.abs() / (b - a).cross(c - a).length(),
            curvature: 0.0,
            scale: a.abs().max(b.abs()).max(c.abs()).max_element(),
        }
    }

    fn bound(&self, origin: DVec3, unit: DVec3) -> f64 {
        let [a, b, c] = self.across(origin, unit);
        let det = (b - a).cross(c - a).length();
        let lengths = [a, b, c].map(|vertex| vertex.length());
        let shape = BOUND * lengths.iter().product::<f64>() / det;
        // For 0 / 0, `f64::min` returns the other operand.
        self.outline_bound(origin) + shape.min(3.0_f64.sqrt() * lengths.into_iter().fold(0.0, f64::max))
    }

    fn distance(&self, point: DVec3) -> f64 {
        let [a, b, c] = self.vertices.map(|vertex| vertex - point);
        let normal = (b - a).cross(c - a).normalize();
        let inside = |from: DVec3, to: DVec3| (to - from).cross(-from).dot(normal) >= 0.0;
        if inside(a, b) && inside(b, c) && inside(c, a) {
            return a.dot(normal).abs();
        }
        outline_distance([a, b, c])
    }

    /// None or one.
    #[inline(always)]
    fn crossings(&self, origin: DVec3, unit: DVec3) -> Vec<Crossing> {
        let [a, b, c] = self.across(origin, unit);
        let sides = [a.cross(b).dot(unit), b.cross(c).dot(unit), c.cross(a).dot(unit)];
        let inside = sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0);
        if !inside || outline_distance([a, b, c]) <= self.outline_bound(origin) {
            return Vec::new();
        }
        let normal =
            (self.vertices[1] - self.vertices[0]).cross(self.vertices[2] - self.vertices[0]).normalize();
        let distance = normal.dot(self.vertices[0] - origin) / normal.dot(unit);
        vec![Crossing { distance, slack: self.bound(origin, unit) / normal.dot(unit).abs() }]
    }

    fn off_ray(&self, origin: DVec3, unit: DVec3, u: f64, v: f64) -> Option<f64> {
        let [a, b, c] = self.across(origin, unit);
        Some((a + (b - a) * u + (c - a) * v).length())
    }
}

/// Distance of the origin from the nearest of three edges.
fn outline_distance([a, b, c]: [DVec3; 3]) -> f64 {
    let to_edge = |from: DVec3, to: DVec3| {
        let edge = to - from;
        let along = (-from.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        // Both vertices project to one point: the edge has no length.
        if along.is_nan() { from.length() } else { (from + edge * along).length() }
    };
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}
