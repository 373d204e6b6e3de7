//! Spheres in shading: their rows, the surfaces at hits, and spheres as lights, sampled uniformly in the cone
//! that they subtend.

use super::light::{
    LightKind, LightRow, LightSample, SampledAs, SampledPrimitives, bounded_importance, valid_pdf,
};
use super::{Surface, SurfaceTables};
use crate::buffers::block_means::{BlockMeans, GRID};
use crate::buffers::rows::Rows;
use crate::buffers::{Features, has};
use crate::kernel::surface::{latitude_longitude, sphere_surface};
use crate::kernel::{normals, ray_cone};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3, portable};
use crate::rays::Kind;
use crate::sampling::warp;
use crate::scene::{Primitive, Scene, Side, Sphere};
use glam::{DVec2, DVec3};
use std::f32::consts::{PI, TAU};

/// A sphere in each lane.
pub struct SphereRow<L: Lane> {
    /// The centre.
    pub center: Vec3<L>,
    /// One over the radius.
    pub inverse_radius: L,
    /// The distance from the surface at which spawned rays start.
    pub offset: L,
    /// The index of the material.
    pub material: L::Bits,
    /// The rotation of the texture, in turns. Its sign bit is set if the texture is oriented to be seen from
    /// outside: with the angle's sign flipped by it, the angle plus this number is u on both sides.
    pub turn: L,
    /// The way in which the sphere is sampled as a light.
    pub light: SampledPrimitives<L>,
}

/// Returns the row of a sphere: centre, one over the radius, offset, material (bits), texture turn,
/// probability of being chosen as a light.
fn row(sphere: &Sphere, offset: f32, light: SampledAs) -> [f32; 8] {
    let [x, y, z] = sphere.center.to_array();
    let is_inside = sphere.texture_side == Side::Inside;
    // A turn of 0 has a sign too.
    let turn = sphere.texture_turn.abs().copysign(if is_inside { 1.0 } else { -1.0 });
    [x, y, z, 1.0 / sphere.radius, offset, f32::from_bits(sphere.material), turn, light.pack().0]
}

impl<L: Lane> SphereRow<L> {
    /// Fetches spheres by their index: see [`Rows::fetch`].
    #[inline(always)]
    pub fn fetch(rows: &Rows, index: L::Bits, fits_registers: bool) -> Self {
        let [x, y, z, inverse_radius, offset, material, turn, column] =
            rows.fetch::<L>(index, fits_registers);
        Self {
            center: Vec3::new(x, y, z),
            inverse_radius,
            offset,
            material: material.to_bits(),
            turn,
            light: SampledPrimitives { column, material: L::Bits::splat(0) },
        }
    }
}

/// Returns the rows of a scene's spheres: see [`SphereRow`]. `light` returns how a sphere is sampled.
pub(super) fn rows(scene: &Scene, light: impl Fn(usize) -> SampledAs) -> Rows {
    let offset = |sphere: &Sphere| Primitive::Sphere(sphere).shape().offset();
    let spheres = scene.spheres.iter().enumerate();
    Rows::new(spheres.map(|(number, sphere)| row(sphere, offset(sphere), light(number))))
}

/// The data of lanes on spheres that shading keeps.
pub struct OnSphere<L: Lane> {
    /// See [`SphereRow::turn`].
    turn: L,
    /// One over the radius; unset unless paths carry cones.
    curvature: L,
}

impl<L: Lane> Default for OnSphere<L> {
    fn default() -> Self {
        Self { turn: L::zero(), curvature: L::zero() }
    }
}

impl<L: Lane> Surface<L> {
    /// Sets all lanes to the surfaces of spheres, in the lanes of `used`.
    #[inline(always)]
    pub(super) fn set_sphere<const N: u64>(
        &mut self,
        tables: &SurfaceTables,
        ray: &Ray<L>,
        hit: &Hit<L>,
        used: L::Mask,
    ) {
        let index = tables.primitives.ranges.index_in_kind(Kind::Sphere, hit.primitive);
        let index = L::Bits::select(used, index, L::Bits::splat(0));
        let fits_registers = !has(N, Features::MANY_SPHERES);
        let sphere = SphereRow::fetch(&tables.primitives.spheres, index, fits_registers);
        let SphereRow { center, inverse_radius, .. } = sphere;
        (self.point, self.ng) = sphere_surface(ray.at(hit.t), center, inverse_radius, used);
        self.sphere.turn = sphere.turn;
        self.offset = sphere.offset;
        self.material = sphere.material;
        if tables.cones {
            self.sphere.curvature = inverse_radius.only(self.kinds.0[Kind::Sphere as usize]);
        }
        if has(N, Features::LIGHTS) && sphere.light.are_sampled().any() {
            let pdf = pdf(center - ray.origin, L::one() / inverse_radius);
            self.light_pdf = sphere.light.probability() * pdf;
        }
    }

    /// Returns the tangents of spheres along growing u, and the frames' handedness.
    #[inline(always)]
    pub(super) fn sphere_tangent(&self) -> (Vec3<L>, L) {
        let inside = self.sphere.turn.to_bits().shr(31).equals(L::Bits::splat(0));
        normals::sphere_tangent(self.ng, inside)
    }

    /// Returns the texture coordinates of spheres, and the texture's density if paths carry cones.
    #[inline(always)]
    pub(super) fn sphere_coordinates(&self, tables: &SurfaceTables) -> ((L, L), L) {
        let (u, v) = latitude_longitude(self.ng);
        let mut density = L::zero();
        if tables.cones {
            density = ray_cone::sphere_density(self.ng, self.sphere.curvature);
        }
        ((u.flip_sign(self.sphere.turn) + self.sphere.turn, v), density)
    }

    /// Returns one over the radius of spheres, 0 elsewhere; unset unless paths carry cones.
    #[inline(always)]
    pub fn curvature(&self) -> L {
        self.sphere.curvature
    }
}

/// Returns the power that a sphere emits, on all sides, at a radiance of 1.
pub(super) fn unit_power(sphere: &Sphere) -> f64 {
    let radius = f64::from(sphere.radius);
    4.0 * f64::from(PI) * f64::from(PI) * radius * radius
}

/// Returns the weighted sum of a texture's texels over a sphere, and the sum of the weights: the
/// circumferences of its circles of latitude.
pub(super) fn sum_of_texels(texture: &BlockMeans) -> (DVec3, f64) {
    let (level, points) = texture.points([DVec2::X, DVec2::Y], GRID);
    points.fold((DVec3::ZERO, 0.0), |(sum, weights), at| {
        let circle = portable::sin_cos(f64::from(PI) * at.y).0;
        (sum + circle * texture.mean(level, at), weights + circle)
    })
}

/// Returns the rows of a sphere with this power.
pub(super) fn light(sphere: &Sphere, power: f64) -> (LightRow, [f32; 8]) {
    let &Sphere { center, radius, .. } = sphere;
    let row = LightRow { kind: LightKind::Sphere, at: center, radius, ..LightRow::default() };
    (row, bounded_importance(center, radius, None, 0.25 * (power / f64::from(PI))))
}

/// The cone that a sphere subtends.
struct Cone<L: Lane> {
    /// The squared distance of the centre, and one over the distance.
    distance2: L,
    per_distance: L,
    /// 1 − cos θ of the cone's half angle; NaN from inside the sphere.
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
    /// Returns one over the solid angle; 0 from inside the sphere and on it.
    #[inline(always)]
    fn pdf(&self) -> L {
        valid_pdf(L::splat(1.0 / TAU) / self.one_minus_cos)
    }
}

/// Returns the pdf of directions towards a sphere: one over its solid angle; 0 inside it and on it.
///
/// Domain: a radius of at least 1e-15 distances.
#[inline(always)]
pub fn pdf<L: Lane>(center: Vec3<L>, radius: L) -> L {
    Cone::new(center, radius).pdf()
}

/// Samples a direction uniform in the cone that a sphere subtends, and the first point of the sphere there.
/// The normal has unit length within 4 ε times the distance over the radius; for spheres more than 2²⁰ radii
/// away it is shorter, at most about 1.
#[inline(always)]
pub fn sample<L: Lane>(center: Vec3<L>, radius: L, u: L, v: L) -> LightSample<L> {
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
