//! The normals about which lobes scatter, and the rule for light that shading normals send below the surface.

use super::{BsdfEval, BsdfSample};
use crate::kernel::normals::{facing, shadow_terminator};
use crate::lane::Lane;
use crate::math::Vec3;

/// The normals of a surface for its lobes, all on the side from which the ray arrives.
#[derive(Clone, Copy, Debug)]
pub struct LobeNormals<L: Lane> {
    /// The normal about which diffuse lobes scatter.
    pub diffuse: Vec3<L>,
    /// The normal about which all other lobes scatter; it faces the ray.
    pub specular: Vec3<L>,
    /// The horizon; `None` if no lane has a shading normal.
    pub horizon: Option<Horizon<L>>,
}

/// The planes above which surfaces with shading normals reflect.
#[derive(Clone, Copy, Debug)]
pub struct Horizon<L: Lane> {
    /// The lanes with a shading normal.
    pub bent: L::Mask,
    /// The normal of the plane: the interpolated normal or the geometric one.
    pub normal: Vec3<L>,
    /// The geometric normal, which replaces it for delta lobes.
    pub ng: Vec3<L>,
}

impl<L: Lane> Horizon<L> {
    /// Returns the factor of diffuse light along `wi`: [`shadow_terminator`] in lanes with a shading normal.
    #[inline(always)]
    pub(super) fn fade(&self, wi: Vec3<L>, ns: Vec3<L>) -> L {
        L::select(self.bent, shadow_terminator(wi, ns, self.normal), L::one())
    }
}

impl<L: Lane> LobeNormals<L> {
    /// Returns one normal for all lobes.
    #[inline(always)]
    pub fn flat(n: Vec3<L>) -> Self {
        Self { diffuse: n, specular: n, horizon: None }
    }
    /// Returns the normals for rays along `d` at a surface with the shading normal `ns`.
    #[inline(always)]
    pub fn bent(d: Vec3<L>, ns: Vec3<L>, horizon: Horizon<L>) -> Self {
        let ns = Vec3::select(horizon.bent, ns, horizon.ng);
        Self { diffuse: ns, specular: facing(d, ns, horizon.ng), horizon: Some(horizon) }
    }

    /// Returns the direction of light that a specular lobe reflects along `wi`: mirrored in the horizon if it
    /// would go below.
    #[inline(always)]
    pub fn raise(&self, wi: Vec3<L>, is_delta: L::Mask) -> Vec3<L> {
        let Some(horizon) = &self.horizon else { return wi };
        let n = Vec3::select(is_delta, horizon.ng, horizon.normal);
        Vec3::select(horizon.bent & wi.dot(n).lt(L::zero()), wi.reflect(n), wi)
    }

    /// Raises the sample of a specular lobe. `pdf` returns the lobe's pdf of a direction: two directions are
    /// raised to the same one.
    #[inline(always)]
    pub fn raise_sample(&self, sample: BsdfSample<L>, pdf: impl Fn(Vec3<L>) -> L) -> BsdfSample<L> {
        let Some(horizon) = &self.horizon else { return sample };
        let wi = self.raise(sample.wi, !sample.pdf.lt(L::splat(f32::INFINITY)));
        let other = pdf(sample.wi.reflect(horizon.normal)).only(horizon.bent);
        BsdfSample { wi, pdf: sample.pdf + other, ..sample }
    }

    /// Returns the value and pdf of the specular `lobe` for light along `wi`: the sum over the directions
    /// that are raised to it, zero below the horizon. The lobe gets a direction and a term to add to its
    /// value: `base`, once.
    #[inline(always)]
    pub fn fold(
        &self,
        wi: Vec3<L>,
        base: Vec3<L>,
        lobe: impl Fn(Vec3<L>, Vec3<L>) -> BsdfEval<L>,
    ) -> BsdfEval<L> {
        let direct = lobe(wi, base);
        let Some(horizon) = &self.horizon else { return direct };
        let other = lobe(wi.reflect(horizon.normal), Vec3::zero());
        let above = !horizon.bent | L::zero().lt(wi.dot(horizon.normal));
        let sum = |a: L, b: L| (a + b.only(horizon.bent)).only(above);
        let (a, b) = (direct.value, other.value);
        BsdfEval {
            value: Vec3::new(sum(a.x, b.x), sum(a.y, b.y), sum(a.z, b.z)),
            pdf: sum(direct.pdf, other.pdf),
        }
    }
}
