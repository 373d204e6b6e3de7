//! The rows of quadrics, and points on their surfaces.

use crate::kernel::surface::sphere_surface;
use crate::lane::Lane;
use crate::math::Vec3;
use crate::scene::{Primitive, Side, Sphere};

impl Primitive<'_> {
    /// See [`super::Buffers::quadric_rows`].
    pub(super) fn quadric_row(self, probability: f32) -> [f32; 8] {
        match self {
            Self::Sphere(&Sphere { center, radius, material, texture_turn, texture_side }) => {
                let [x, y, z] = center.to_array();
                let (offset, material) = (self.shape().offset(), f32::from_bits(material));
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
