//! The surface at a hit: point, geometric normal, texture coordinates.

use super::context::TraceContext;
use super::context::has;
use super::queue::Path;
use crate::buffers::{Features, SphereRow, TriangleRow};
use crate::kernel::normals;
use crate::kernel::ray_cone;
use crate::kernel::surface::{inset, latitude_longitude, sphere_surface};
use crate::kernel::texture::TexturePoint;
use crate::lane::{Bits, Lane, Mask};
use crate::lights;
use crate::math::{Hit, Vec3};

/// The surfaces at a packet's hits.
pub struct Surface<L: Lane> {
    /// On the surface as exactly as floats allow.
    pub point: Vec3<L>,
    /// Unit geometric normal: outward on spheres, by the order of the vertices on triangles.
    pub ng: Vec3<L>,
    /// Distance from the surface at which spawned rays must start.
    pub offset: L,
    /// Index of the material.
    pub material: L::Bits,
    is_sphere: L::Mask,
    /// Index of the triangle, where it is one.
    triangle: L::Bits,
    /// Texture offset of spheres in u. Its sign bit is set where u runs the other way: see
    /// [`SphereRow::turn`].
    turn: L,
    barycentric: (L, L),
    /// Of the triangle: first to second vertex, first to third.
    edges: [Vec3<L>; 2],
    /// The cosine at which the ray arrives; below 0 from behind `ng`.
    pub facing: L,
    /// Width of the ray cone at the hit; 0 unless paths carry cones.
    pub cone_width: L,
    /// One over the radius of spheres, 0 on triangles; unset unless paths carry cones.
    pub curvature: L,
    /// The pdf with which light sampling at the ray's origin samples the ray's direction, in 1/sr; 0 where it
    /// never does.
    pub light_pdf: L,
}

impl<L: Lane> Surface<L> {
    /// Looks up the surfaces of the lanes in `found`; the others are unspecified.
    #[inline(always)]
    pub fn of<const N: u32>(context: &TraceContext, path: &Path<L>, hit: &Hit<L>, found: L::Mask) -> Self {
        let first_triangle = L::Bits::splat(context.buffers.first_triangle);
        let zero = L::Bits::splat(0);
        let is_sphere = match (has(N, Features::SPHERES), has(N, Features::TRIANGLES)) {
            (true, true) => hit.primitive.less(first_triangle),
            (sphere, _) => L::Mask::splat(sphere),
        };
        let triangle =
            L::Bits::select(found & !is_sphere, hit.primitive.wrapping_add(negative(first_triangle)), zero);
        let mut surface = Self {
            point: Vec3::zero(),
            ng: Vec3::zero(),
            offset: L::zero(),
            material: zero,
            is_sphere,
            triangle,
            turn: L::zero(),
            barycentric: (hit.u, hit.v),
            edges: [Vec3::zero(); 2],
            facing: L::zero(),
            cone_width: L::zero(),
            curvature: L::zero(),
            light_pdf: L::zero(),
        };
        if has(N, Features::SPHERES) && (!has(N, Features::TRIANGLES) || (found & is_sphere).any()) {
            surface.set_sphere::<N>(context, path, hit, found & is_sphere);
        }
        if has(N, Features::TRIANGLES) && (!has(N, Features::SPHERES) || (found & !is_sphere).any()) {
            surface.set_triangle::<N>(context, path, hit);
        }
        surface.facing = -path.ray.direction.dot(surface.ng);
        if context.carries_cones::<N>() {
            surface.cone_width = path.cone.width_at(hit.t);
        }
        surface
    }

    /// The object id: one for each sphere, and one for all triangles of a material.
    #[inline(always)]
    pub fn object(&self, context: &TraceContext, hit: &Hit<L>) -> L::Bits {
        let of_material = self.material.wrapping_add(L::Bits::splat(context.buffers.first_triangle));
        L::Bits::select(self.is_sphere, hit.primitive, of_material)
    }

    #[inline(always)]
    fn set_sphere<const N: u32>(
        &mut self,
        context: &TraceContext,
        path: &Path<L>,
        hit: &Hit<L>,
        used: L::Mask,
    ) {
        let index = L::Bits::select(used, hit.primitive, L::Bits::splat(0));
        let fits_registers = !has(N, Features::MANY_SPHERES);
        let sphere = SphereRow::fetch(&context.buffers.sphere_rows, index, fits_registers);
        let SphereRow { center, inverse_radius, .. } = sphere;
        (self.point, self.ng) = sphere_surface(path.ray.at(hit.t), center, inverse_radius, used);
        self.turn = sphere.turn;
        self.offset = sphere.offset;
        self.material = sphere.material;
        if context.carries_cones::<N>() {
            self.curvature = inverse_radius.only(self.is_sphere);
        }
        if has(N, Features::LIGHTS) && sphere.light.are_sampled().any() {
            let pdf = lights::sphere::pdf(center - path.ray.origin, L::one() / inverse_radius);
            self.light_pdf = sphere.light.probability() * pdf;
        }
    }

    /// Overwrites the lanes on triangles.
    #[inline(always)]
    fn set_triangle<const N: u32>(&mut self, context: &TraceContext, path: &Path<L>, hit: &Hit<L>) {
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let triangle = TriangleRow::fetch(&context.buffers.triangle_rows, self.triangle, fits_registers);
        let (mut u, mut v) = self.barycentric;
        let at_edge = hit.least_weight().lt(triangle.near_edge);
        if at_edge.any() {
            let moved = inset((u, v), triangle.edges, triangle.offset);
            (u, v) = (L::select(at_edge, moved.0, u), L::select(at_edge, moved.1, v));
        }
        let [ab, ac] = triangle.edges;
        let point = ab.mul_add(u, ac.mul_add(v, triangle.a));
        self.edges = triangle.edges;
        let keep = self.is_sphere;
        self.point = Vec3::select(keep, self.point, point);
        self.ng = Vec3::select(keep, self.ng, triangle.ng);
        self.offset = L::select(keep, self.offset, triangle.offset);
        self.material = L::Bits::select(keep, self.material, triangle.material);
        if has(N, Features::LIGHTS) {
            let mut pdf = L::zero();
            if (!keep & triangle.light.are_sampled()).any() {
                pdf = context.lights.triangle_pdf::<L, N>(&triangle, &path.ray, hit, !keep);
            }
            // Lanes on triangles that are no lights hold the pdf of some sphere: overwrite them too.
            self.light_pdf = L::select(keep, self.light_pdf, pdf);
        }
    }

    /// Interpolated vertex normals, and the lanes of `found` that have them; geometric normals elsewhere. And
    /// what leads from the point to the smooth surface, on the side from which the ray arrives: see
    /// [`normals::bulge`].
    #[inline(always)]
    pub fn interpolated_normal<const N: u32>(
        &self,
        context: &TraceContext,
        found: L::Mask,
    ) -> (Vec3<L>, L::Mask, Vec3<L>) {
        let on_triangle = found & !self.is_sphere;
        if !on_triangle.any() {
            return (self.ng, L::Mask::splat(false), Vec3::zero());
        }
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let first = self.triangle.shl(1);
        let second = first | L::Bits::splat(1);
        let [ax, ay, az, bx, by, bz, ..] = context.buffers.normal_rows.fetch::<L>(first, fits_registers);
        let [cx, cy, cz, ..] = context.buffers.normal_rows.fetch::<L>(second, fits_registers);
        let corners = [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz)];
        let blended = normals::blend(corners, self.barycentric);
        let (normal, exists) = normals::interpolated(blended, self.ng);
        let interpolated = on_triangle & exists;
        let ng = self.ng.flip_sign(self.facing);
        let bulge = normals::bulge(corners, self.edges, self.barycentric, ng, blended.dot(ng));
        let bulge = Vec3::select(interpolated, bulge, Vec3::zero());
        (Vec3::select(interpolated, normal, self.ng), interpolated, bulge)
    }

    /// The tangent along growing u in the lanes of `mapped`, and the frame's handedness (see
    /// [`normals::mapped`]).
    #[inline(always)]
    pub fn tangent<const N: u32>(&self, context: &TraceContext, mapped: L::Mask) -> (Vec3<L>, L) {
        let (mut tangent, mut hand) = (Vec3::zero(), L::zero());
        if has(N, Features::SPHERES) && (mapped & self.is_sphere).any() {
            let inside = self.turn.to_bits().shr(31).equals(L::Bits::splat(0));
            (tangent, hand) = normals::sphere_tangent(self.ng, inside);
        }
        let on_triangle = mapped & !self.is_sphere;
        if has(N, Features::TRIANGLES) && on_triangle.any() {
            let fits_registers = !has(N, Features::MANY_TRIANGLES);
            let index = L::Bits::select(on_triangle, self.triangle, L::Bits::splat(0));
            let [x, y, z, w, ..] = context.buffers.tangent_rows.fetch::<L>(index, fits_registers);
            tangent = Vec3::select(self.is_sphere, tangent, Vec3::new(x, y, z));
            hand = L::select(self.is_sphere, hand, w);
        }
        (tangent, hand)
    }

    /// Where textures are read in the lanes of `textured`.
    #[inline(always)]
    pub fn texture_point<const N: u32>(&self, context: &TraceContext, textured: L::Mask) -> TexturePoint<L> {
        let mut coordinates = (L::zero(), L::zero());
        let mut density = L::zero();
        if has(N, Features::SPHERES) && (textured & self.is_sphere).any() {
            let (u, v) = latitude_longitude(self.ng);
            coordinates = (u.flip_sign(self.turn) + self.turn, v);
            if context.carries_cones::<N>() {
                density = ray_cone::sphere_density(self.ng, self.curvature);
            }
        }
        if has(N, Features::TRIANGLES) && (textured & !self.is_sphere).any() && context.buffers.has_uvs {
            let fits_registers = !has(N, Features::MANY_TRIANGLES);
            let [au, av, bu, bv, cu, cv, of_triangle, _] =
                context.buffers.uv_rows.fetch::<L>(self.triangle, fits_registers);
            let (u, v) = self.barycentric;
            let blend = |a: L, b: L, c: L| (b - a).mul_add(u, (c - a).mul_add(v, a));
            let keep = self.is_sphere;
            coordinates.0 = L::select(keep, coordinates.0, blend(au, bu, cu));
            coordinates.1 = L::select(keep, coordinates.1, blend(av, bv, cv));
            density = L::select(keep, density, of_triangle);
        }
        let mut footprint = L::zero();
        if context.carries_cones::<N>() {
            footprint = ray_cone::footprint(self.cone_width, self.facing, density);
        }
        TexturePoint { u: coordinates.0, v: coordinates.1, clamp_v: self.is_sphere, footprint }
    }
}

#[inline(always)]
fn negative<B: Bits>(x: B) -> B {
    (!x).wrapping_add(B::splat(1))
}
