//! Ray cones: the width of a path's view of a surface, for the level of detail of its textures.
//!
//! A pixel's cone starts at the camera with no width; its width grows by the angle times the distance. A hit
//! keeps the width, and scattering adds to the angle. The curvature of interpolated and mapped normals and
//! the effect of refraction are ignored.
//!
//! Two choices differ from the source, because a pixel has many samples here. A cone is half as wide as its
//! pixel: samples are spread over the pixel already, and a bilinear lookup is two texels wide. A footprint
//! counts as the square of its own area, while the source uses the square of its longer side, which is 1 /
//! cosine of the other. Measured at 240×135 in the scenes thesis and chess, relative to the source's choices:
//! 0.3 to 0.4 of the blur that is left after many samples, 0.75 to 1 after four samples, 1.0 to 1.1 after
//! one.
//!
//! Source: T. Akenine-Möller, C. Crassin, J. Boksansky, L. Belcour, A. Panteleev, O. Wright, "Improved Shader
//! and Texture Level of Detail Using Ray Cones", JCGT 10(1), 2021; T. Akenine-Möller et al., "Texture Level
//! of Detail Strategies for Real-Time Ray Tracing", Ray Tracing Gems, 2019, ch. 20.

use crate::lane::Lane;
use crate::lane::functions::ln;
use crate::math::Vec3;
use std::f32::consts::{LOG2_E, PI};

/// The cones of a packet of path segments.
#[derive(Clone, Copy, Debug)]
pub struct Cone<L: Lane> {
    /// The width at the start of the segment, in scene units; negative behind the focus of a concave mirror.
    pub width: L,
    /// The growth of the width per unit of distance: the tangent of the cone's angle, which counts as the
    /// angle.
    pub angle: L,
}

/// The least cosine at which a cone meets a surface, so that a footprint stays finite.
const MIN_COSINE: f32 = 1e-3;
/// The largest angle, about a radian, to either side.
const MAX_ANGLE: f32 = 1.0;
/// The angle that a lobe of full width adds, in radians. A diffuse lobe is about five times as wide, so a
/// path averages a texture behind it over a thirtieth of the area that all paths of the pixel see.
const LOBE_ANGLE: f32 = 0.375;

impl<L: Lane> Cone<L> {
    /// Returns a cone without width and angle.
    #[inline(always)]
    pub fn none() -> Self {
        Self { width: L::zero(), angle: L::zero() }
    }
    /// Returns the width at a distance.
    #[inline(always)]
    pub fn width_at(&self, t: L) -> L {
        self.angle.mul_add(t, self.width)
    }

    /// Returns the cone that leaves a surface where this one has this width. `curvature` is one over a
    /// sphere's radius, negative on its inner side; the normals in the footprint differ by it, and reflected
    /// directions by twice that. `lobe` is the width of the lobe, from 0 (delta) to 1 (diffuse).
    #[inline(always)]
    pub fn scattered(&self, width: L, cosine: L, curvature: L, lobe: L) -> Self {
        let most = L::splat(MAX_ANGLE);
        let bent = width * (curvature + curvature) / least_cosine(cosine);
        let angle = lobe.mul_add(L::splat(LOBE_ANGLE), self.angle + bent);
        Self { width, angle: angle.max(-most).min(most) }
    }
}

#[inline(always)]
fn least_cosine<L: Lane>(cosine: L) -> L {
    cosine.abs().max(L::splat(MIN_COSINE))
}

/// Returns the area of a cone on a surface in texture coordinates, where 1 is the whole texture. `density` is
/// the area in texture coordinates per unit of area.
#[inline(always)]
pub fn footprint<L: Lane>(width: L, cosine: L, density: L) -> L {
    width * width / least_cosine(cosine) * density
}

/// Returns the density of latitude/longitude textures on a sphere at the unit normal `n`, in 1 / (scene
/// units)²: a whole turn has the length 2π r sin θ, half a turn from pole to pole π r. It is infinite at the
/// poles. `curvature` is 1 / r.
#[inline(always)]
pub fn sphere_density<L: Lane>(n: Vec3<L>, curvature: L) -> L {
    let sine = n.x.mul_add(n.x, n.z * n.z).sqrt();
    curvature * curvature / (sine * L::splat(2.0 * PI * PI))
}

/// Returns the level of detail at which a texel is as large as a footprint: 0 if the texture's own texels are
/// larger, else half the binary logarithm of the number of texels in it, at most `last`.
///
/// Domain: any; 0 for NaN.
/// Error: ≤ 1e-6 (measured, `tests/laws/kernel_ray_cone.rs`).
#[inline(always)]
pub fn level_of_detail<L: Lane>(footprint: L, texels: L, last: L) -> L {
    let level = ln(footprint * texels) * L::splat(0.5 * LOG2_E);
    level.max(L::zero()).min(last)
}
