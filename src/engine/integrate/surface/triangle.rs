//! Looks up surfaces of triangles.

use super::Surface;
use crate::buffers::{Features, TriangleRow};
use crate::integrate::context::{TraceContext, has};
use crate::integrate::queue::Path;
use crate::kernel::normals;
use crate::kernel::surface::inset;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Vec3};

/// The data of lanes on triangles that shading keeps.
pub struct OnTriangle<L: Lane> {
    /// The index among the triangles; 0 in other lanes.
    index: L::Bits,
    barycentric: (L, L),
    /// The edges from the first vertex to the second, and to the third.
    edges: [Vec3<L>; 2],
}

impl<L: Lane> OnTriangle<L> {
    /// Stores the index and the weights of hits.
    #[inline(always)]
    pub(super) fn new(index: L::Bits, hit: &Hit<L>) -> Self {
        Self { index, barycentric: (hit.u, hit.v), edges: [Vec3::zero(); 2] }
    }
}

impl<L: Lane> Surface<L> {
    /// Overwrites the lanes on triangles.
    #[inline(always)]
    pub(super) fn set_triangle<const N: u32>(
        &mut self,
        context: &TraceContext,
        path: &Path<L>,
        hit: &Hit<L>,
    ) {
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let triangle =
            TriangleRow::fetch(&context.buffers.triangle_rows, self.triangle.index, fits_registers);
        let (mut u, mut v) = self.triangle.barycentric;
        let at_edge = hit.least_weight().lt(triangle.near_edge);
        if at_edge.any() {
            let moved = inset((u, v), triangle.edges, triangle.offset);
            (u, v) = (L::select(at_edge, moved.0, u), L::select(at_edge, moved.1, v));
        }
        let [ab, ac] = triangle.edges;
        let point = ab.mul_add(u, ac.mul_add(v, triangle.a));
        self.triangle.edges = triangle.edges;
        let keep = !self.kinds.triangle;
        self.point = Vec3::select(keep, self.point, point);
        self.ng = Vec3::select(keep, self.ng, triangle.ng);
        self.offset = L::select(keep, self.offset, triangle.offset);
        self.material = L::Bits::select(keep, self.material, triangle.material);
        if has(N, Features::LIGHTS) {
            let mut pdf = L::zero();
            if (!keep & triangle.light.are_sampled()).any() {
                pdf = context.lights.triangle_pdf::<L, N>(&triangle, &path.ray, hit, !keep);
            }
            // Lanes on triangles that are no lights hold the pdf of some sphere and are overwritten, too.
            self.light_pdf = L::select(keep, self.light_pdf, pdf);
        }
    }

    /// Returns interpolated vertex normals, and the lanes of `found` that have them; geometric normals
    /// elsewhere. The third result is the vector to the smooth surface, on the side from which the ray
    /// arrives: see [`normals::bulge`].
    #[inline(always)]
    pub fn interpolated_normal<const N: u32>(
        &self,
        context: &TraceContext,
        found: L::Mask,
    ) -> (Vec3<L>, L::Mask, Vec3<L>) {
        let on_triangle = found & self.kinds.triangle;
        if !on_triangle.any() {
            return (self.ng, L::Mask::splat(false), Vec3::zero());
        }
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let first = self.triangle.index.shl(1);
        let second = first | L::Bits::splat(1);
        let [ax, ay, az, bx, by, bz, ..] = context.buffers.normal_rows.fetch::<L>(first, fits_registers);
        let [cx, cy, cz, ..] = context.buffers.normal_rows.fetch::<L>(second, fits_registers);
        let corners = [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz)];
        let blended = normals::blend(corners, self.triangle.barycentric);
        let (normal, exists) = normals::interpolated(blended, self.ng);
        let interpolated = on_triangle & exists;
        let ng = self.ng.flip_sign(self.facing);
        let bulge =
            normals::bulge(corners, self.triangle.edges, self.triangle.barycentric, ng, blended.dot(ng));
        let bulge = Vec3::select(interpolated, bulge, Vec3::zero());
        (Vec3::select(interpolated, normal, self.ng), interpolated, bulge)
    }

    /// Overwrites the tangents of the lanes in `on_triangle`.
    #[inline(always)]
    pub(super) fn triangle_tangent<const N: u32>(
        &self,
        context: &TraceContext,
        on_triangle: L::Mask,
        (tangent, hand): (Vec3<L>, L),
    ) -> (Vec3<L>, L) {
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let index = L::Bits::select(on_triangle, self.triangle.index, L::Bits::splat(0));
        let [x, y, z, w, ..] = context.buffers.tangent_rows.fetch::<L>(index, fits_registers);
        let keep = !self.kinds.triangle;
        (Vec3::select(keep, tangent, Vec3::new(x, y, z)), L::select(keep, hand, w))
    }

    /// Overwrites texture coordinates and the density of the texture in the lanes on triangles.
    #[inline(always)]
    pub(super) fn triangle_coordinates<const N: u32>(
        &self,
        context: &TraceContext,
        ((u, v), density): ((L, L), L),
    ) -> ((L, L), L) {
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let [au, av, bu, bv, cu, cv, of_triangle, _] =
            context.buffers.uv_rows.fetch::<L>(self.triangle.index, fits_registers);
        let (s, t) = self.triangle.barycentric;
        let blend = |a: L, b: L, c: L| (b - a).mul_add(s, (c - a).mul_add(t, a));
        let keep = !self.kinds.triangle;
        let u = L::select(keep, u, blend(au, bu, cu));
        let v = L::select(keep, v, blend(av, bv, cv));
        ((u, v), L::select(keep, density, of_triangle))
    }
}
