//! Looks up surfaces at hits: point, geometric normal, texture coordinates. Each primitive kind has a file.

mod sphere;
mod triangle;

use super::context::{TraceContext, has};
use super::queue::Path;
use crate::buffers::Features;
use crate::kernel::ray_cone;
use crate::kernel::texture::TexturePoint;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Vec3};
use crate::rays::Kind;
use sphere::OnSphere;
use triangle::OnTriangle;

/// The lanes whose hit is on a primitive of each kind. If the pipeline has one kind, all lanes are of it.
#[derive(Clone, Copy)]
struct HitKinds<L: Lane> {
    sphere: L::Mask,
    triangle: L::Mask,
}

/// The surfaces at a packet's hits.
pub struct Surface<L: Lane> {
    /// The point on the surface, as exactly as floats allow.
    pub point: Vec3<L>,
    /// The unit geometric normal: outward on spheres, by the order of the vertices on triangles.
    pub ng: Vec3<L>,
    /// The distance from the surface at which spawned rays must start.
    pub offset: L,
    /// The index of the material.
    pub material: L::Bits,
    kinds: HitKinds<L>,
    sphere: OnSphere<L>,
    triangle: OnTriangle<L>,
    /// The cosine at which the ray arrives; negative from behind `ng`.
    pub facing: L,
    /// The width of the ray cone at the hit; 0 unless paths carry cones.
    pub cone_width: L,
    /// The pdf with which light sampling at the ray's origin samples the ray's direction, in 1/sr; 0 if it
    /// never does.
    pub light_pdf: L,
}

impl<L: Lane> Surface<L> {
    /// Looks up the surfaces of the lanes in `found`; the others are unspecified.
    #[inline(always)]
    pub fn of<const N: u32>(context: &TraceContext, path: &Path<L>, hit: &Hit<L>, found: L::Mask) -> Self {
        let (ranges, zero) = (context.buffers.ranges, L::Bits::splat(0));
        let sphere = match (has(N, Features::SPHERES), has(N, Features::TRIANGLES)) {
            (true, true) => ranges.are_of_kind(Kind::Sphere, hit.primitive),
            (sphere, _) => L::Mask::splat(sphere),
        };
        let kinds = HitKinds { sphere, triangle: !sphere };
        let index = ranges.index_in_kind(Kind::Triangle, hit.primitive);
        let index = L::Bits::select(found & kinds.triangle, index, zero);
        let mut surface = Self {
            point: Vec3::zero(),
            ng: Vec3::zero(),
            offset: L::zero(),
            material: zero,
            kinds,
            sphere: OnSphere::default(),
            triangle: OnTriangle::new(index, hit),
            facing: L::zero(),
            cone_width: L::zero(),
            light_pdf: L::zero(),
        };
        if has(N, Features::SPHERES) && (!has(N, Features::TRIANGLES) || (found & sphere).any()) {
            surface.set_sphere::<N>(context, path, hit, found & sphere);
        }
        if has(N, Features::TRIANGLES) && (!has(N, Features::SPHERES) || (found & !sphere).any()) {
            surface.set_triangle::<N>(context, path, hit);
        }
        surface.facing = -path.ray.direction.dot(surface.ng);
        if context.carries_cones::<N>() {
            surface.cone_width = path.cone.width_at(hit.t);
        }
        surface
    }

    /// Returns the object id: one for each sphere, and one for all triangles of a material.
    #[inline(always)]
    pub fn object(&self, context: &TraceContext, hit: &Hit<L>) -> L::Bits {
        let of_material = self.material.wrapping_add(L::Bits::splat(context.buffers.spheres));
        L::Bits::select(self.kinds.sphere, hit.primitive, of_material)
    }

    /// Returns the tangent along growing u in the lanes of `mapped`, and the frame's handedness: +1 if v
    /// grows along normal × tangent, −1 if against it.
    #[inline(always)]
    pub fn tangent<const N: u32>(&self, context: &TraceContext, mapped: L::Mask) -> (Vec3<L>, L) {
        let mut frame = (Vec3::zero(), L::zero());
        let HitKinds { sphere, triangle } = self.kinds;
        if has(N, Features::SPHERES) && (mapped & sphere).any() {
            frame = self.sphere_tangent();
        }
        let on_triangle = mapped & triangle;
        if has(N, Features::TRIANGLES) && on_triangle.any() {
            frame = self.triangle_tangent::<N>(context, on_triangle, frame);
        }
        frame
    }

    /// Returns the points at which textures are read in the lanes of `textured`.
    #[inline(always)]
    pub fn texture_point<const N: u32>(&self, context: &TraceContext, textured: L::Mask) -> TexturePoint<L> {
        let mut found = ((L::zero(), L::zero()), L::zero());
        let HitKinds { sphere, triangle } = self.kinds;
        if has(N, Features::SPHERES) && (textured & sphere).any() {
            found = self.sphere_coordinates::<N>(context);
        }
        let on_triangle = textured & triangle;
        if has(N, Features::TRIANGLES) && on_triangle.any() && context.buffers.has_uvs {
            found = self.triangle_coordinates::<N>(context, found);
        }
        let ((u, v), density) = found;
        let mut footprint = L::zero();
        if context.carries_cones::<N>() {
            footprint = ray_cone::footprint(self.cone_width, self.facing, density);
        }
        TexturePoint { u, v, clamp_v: sphere, footprint }
    }
}
