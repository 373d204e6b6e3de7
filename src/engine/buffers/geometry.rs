//! The geometry of primitives by their kind: boxes, surface points, and the rows of quadrics.

use super::features::Features;
use crate::kernel::ray_box::sphere_bounds;
use crate::kernel::surface::{
    sphere_offset, sphere_surface, triangle_bounds, triangle_normal, triangle_offset,
};
use crate::lane::Lane;
use crate::math::Vec3;
use crate::scene::{Primitive, Side, Sphere, Triangle};

impl Primitive<'_> {
    /// The lower and upper corner of a box that holds it and all computed hit points: see [`sphere_bounds`]
    /// and [`triangle_bounds`].
    pub fn bounds(self) -> [glam::Vec3; 2] {
        match self {
            Self::Sphere(sphere) => sphere_bounds(sphere.center, sphere.radius),
            Self::Triangle(triangle) => triangle_bounds(triangle.vertices),
        }
    }
    /// How far off its surface rays start that leave it: see [`sphere_offset`] and [`triangle_offset`].
    pub fn offset(self) -> f32 {
        match self {
            Self::Sphere(sphere) => sphere_offset(sphere.center, sphere.radius),
            Self::Triangle(triangle) => triangle_offset(triangle.vertices),
        }
    }
    /// The point of its surface at a hit near `near` or, of a triangle, of the weights `u` and `v`; the
    /// geometric unit normal there, and the offset of rays that leave it.
    pub fn surface(self, near: Vec3<f32>, [u, v]: [f32; 2]) -> (Vec3<f32>, Vec3<f32>, f32) {
        let Self::Triangle(&Triangle { vertices, .. }) = self else {
            let row = self.quadric_row(0.0);
            let (point, ng, _) = quadric_surface::<f32, { Features::ALL.0 }>(row, near, true);
            return (point, ng, row[4]);
        };
        let [a, b, c] = vertices;
        let [a, ab, ac] = [a, b - a, c - a].map(Vec3::splat);
        (ab.mul_add(u, ac.mul_add(v, a)), Vec3::splat(triangle_normal(vertices)), self.offset())
    }
    /// See [`super::Buffers::quadric_rows`].
    pub(super) fn quadric_row(self, probability: f32) -> [f32; 8] {
        match self {
            Self::Sphere(&Sphere { center, radius, material, texture_turn, texture_side }) => {
                let [x, y, z] = center.to_array();
                let (offset, material) = (self.offset(), f32::from_bits(material));
                // A turn of 0 has a sign too.
                let turn = texture_turn.abs().copysign(if texture_side == Side::Inside { 1.0 } else { -1.0 });
                [x, y, z, 1.0 / radius, offset, material, turn, probability]
            }
            Self::Triangle(_) => unreachable!("triangles are no quadrics"),
        }
    }
}

/// From the rows of quadrics, their points next to `near`, the unit normals there and the texture turns, for
/// a pipeline of the features `N` and in the lanes of `used`.
#[inline(always)]
pub fn quadric_surface<L: Lane, const N: u32>(
    row: [L; 8],
    near: Vec3<L>,
    used: L::Mask,
) -> (Vec3<L>, Vec3<L>, L) {
    let [x, y, z, inverse_radius, _, _, turn, _] = row;
    let (point, ng) = sphere_surface(near, Vec3::new(x, y, z), inverse_radius, used);
    (point, ng, turn)
}
