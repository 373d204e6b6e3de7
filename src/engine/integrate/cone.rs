//! Ray cones behind surfaces.
//!
//! For: [`scattered_cone`].

use super::material::MaterialSample;
use super::queue::Path;
use super::surface::Surface;
use crate::buffers::MaterialCode;
use crate::kernel::bsdf::ggx;
use crate::kernel::ray_cone::Cone;
use crate::lane::{Bits, Lane};

/// The cones of paths as they leave a surface; those of `is_delta` have a delta lobe. Of a coated or
/// metallic-roughness surface both lobes count as the narrower one, the specular lobe.
#[inline(always)]
pub fn scattered_cone<L: Lane>(
    path: &Path<L>,
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    is_delta: L::Mask,
) -> Cone<L> {
    let is = |kind: u32| material.kind.equals(L::Bits::splat(kind));
    let (zero, one) = (L::zero(), L::one());
    // Where the specular lobe is a delta lobe, what is none comes from the diffuse base.
    let is_base =
        is(MaterialCode::DIFFUSE) | (!is(MaterialCode::SCATTER) & ggx::is_narrow(material.roughness_or_ior));
    let lobe = L::select(is_base, one, material.roughness_or_ior.min(one));
    let lobe = L::select(is_delta, zero, lobe);
    // Refraction at a sphere bends otherwise.
    let curvature = L::select(is(MaterialCode::GLASS), zero, surface.curvature.flip_sign(surface.facing));
    path.cone.scattered(surface.cone_width, surface.facing, curvature, lobe)
}
