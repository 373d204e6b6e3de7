//! Looks up surfaces of spheres.

use super::Surface;
use crate::buffers::{Features, SphereRow};
use crate::integrate::context::{TraceContext, has};
use crate::integrate::queue::Path;
use crate::kernel::surface::{latitude_longitude, sphere_surface};
use crate::kernel::{normals, ray_cone};
use crate::lane::{Bits, Lane, Mask};
use crate::lights;
use crate::math::{Hit, Vec3};
use crate::rays::Kind;

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
    pub(super) fn set_sphere<const N: u32>(
        &mut self,
        context: &TraceContext,
        path: &Path<L>,
        hit: &Hit<L>,
        used: L::Mask,
    ) {
        let index = context.buffers.ranges.index_in_kind(Kind::Sphere, hit.primitive);
        let index = L::Bits::select(used, index, L::Bits::splat(0));
        let fits_registers = !has(N, Features::MANY_SPHERES);
        let sphere = SphereRow::fetch(&context.buffers.sphere_rows, index, fits_registers);
        let SphereRow { center, inverse_radius, .. } = sphere;
        (self.point, self.ng) = sphere_surface(path.ray.at(hit.t), center, inverse_radius, used);
        self.sphere.turn = sphere.turn;
        self.offset = sphere.offset;
        self.material = sphere.material;
        if context.carries_cones::<N>() {
            self.sphere.curvature = inverse_radius.only(self.kinds.sphere);
        }
        if has(N, Features::LIGHTS) && sphere.light.are_sampled().any() {
            let pdf = lights::sphere::pdf(center - path.ray.origin, L::one() / inverse_radius);
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
    pub(super) fn sphere_coordinates<const N: u32>(&self, context: &TraceContext) -> ((L, L), L) {
        let (u, v) = latitude_longitude(self.ng);
        let mut density = L::zero();
        if context.carries_cones::<N>() {
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
