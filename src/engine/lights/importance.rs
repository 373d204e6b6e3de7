//! What lights are weighed by at a point: an estimate of the irradiance that each brings there.

use crate::buffers::rows::Rows;
use crate::lane::{Lane, functions};
use crate::math::Vec3;

/// What a light is weighed by.
pub(super) enum Importance {
    /// A light within a sphere.
    Bounded {
        center: glam::Vec3,
        radius: f32,
        /// The unit normal of a flat light.
        normal: Option<glam::Vec3>,
        /// Its power over 4π, or over 2π of a flat light.
        power: f32,
    },
    /// A light that brings the same irradiance everywhere.
    Everywhere { irradiance: f32 },
}

/// In the place of a radius: marks [`Importance::Everywhere`].
const EVERYWHERE: f32 = -1.0;

impl Importance {
    /// Returns a row: centre, radius, normal or zero, power; or zero, [`EVERYWHERE`], zero, irradiance.
    pub(super) fn pack(self) -> [f32; 8] {
        match self {
            Self::Bounded { center, radius, normal, power } => {
                let n = normal.unwrap_or_default();
                [center.x, center.y, center.z, radius, n.x, n.y, n.z, power]
            }
            Self::Everywhere { irradiance } => [0.0, 0.0, 0.0, EVERYWHERE, 0.0, 0.0, 0.0, irradiance],
        }
    }
}

/// Returns, from the rows of [`Importance::pack`], an estimate of the irradiance of a light at `point` on a
/// surface with the normal `n`, nothing between them; above 0 where some of it is above the horizon.
///
/// Source of the bounds of cosines: A. Conty Estevez, C. Kulla, "Importance Sampling of Many Lights with
/// Adaptive Tree Splitting", HPG 2018, §4.
#[inline(always)]
pub(super) fn irradiance<L: Lane>(
    rows: &Rows,
    light: L::Bits,
    (point, n): (Vec3<L>, Vec3<L>),
    fits_registers: bool,
) -> L {
    let [x, y, z, radius, nx, ny, nz, power] = rows.fetch::<L>(light, fits_registers);
    let (to, normal) = (Vec3::new(x, y, z) - point, Vec3::new(nx, ny, nz));
    let distance2 = to.dot(to).max(radius * radius).max(L::splat(f32::MIN_POSITIVE));
    let per_distance = functions::approximate_rsqrt(distance2);
    // The cosine of an angle that is smaller by that of the bounding sphere is at most greater by its
    // sine.
    let sine = radius * per_distance;
    let cosine = to.dot(n).mul_add(per_distance, sine).max(L::zero()).min(L::one());
    let facing = (to.dot(normal).abs()).mul_add(per_distance, sine).min(L::one());
    let is_flat = L::zero().lt(normal.dot(normal));
    let bound = power * cosine * L::select(is_flat, facing, L::one()) * (per_distance * per_distance);
    let is_everywhere = radius.lt(L::zero());
    L::select(is_everywhere, power, bound)
}
