//! Metal-rough: the metallic-roughness model of glTF 2.0, between a metal and a dielectric.
//!
//! With F₀ the dielectric's reflectance at normal incidence, m the metallic share, a the colour and s(c) =
//! (1 − c)⁵ of Schlick:
//!
//! ```text
//! f = F D G₂ / (4 cos i cos o) + (1 − m) (1 − F₀) a T(i) T(o) / (π (1 − q / 21))
//! F = F₁ + (1 − F₁) s(h · o),   F₁ = (1 − m) F₀ + m a
//! T(c) = 1 − q s(c),   q = (1 − κ α^1.5)⁵,   2 ∫ T(c) c dc = 1 − q / 21
//! ```
//!
//! The specular part is the standard's. Its base, a (1 − F(h · o)) / π, returns with a smooth coat up to 1.6
//! times the light that arrives at a grazing angle; the one here has what the coat lets through on both ways,
//! as [`super::plastic`], whose κ it takes. It is reciprocal, and creates at most 0.3 % (by quadrature, F₀
//! from 0 to ½). Light that reflects between facets is lost, as in [`super::ggx`].
//!
//! Source: glTF 2.0 specification, appendix B; Schlick, "An Inexpensive BRDF Model for Physically-based
//! Rendering", Computer Graphics Forum 13(3), 1994; the base: Ashikhmin, Shirley, "An Anisotropic Phong BRDF
//! Model", Journal of Graphics Tools 5(2), 2000.

use super::plastic::GRAZING_FIT;
use super::sample::{BsdfEval, BsdfSample, LobeEval};
use super::{diffuse, ggx};
use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// The parameters of metal-rough.
#[derive(Clone, Copy, Debug)]
pub struct MetalRough<L: Lane> {
    /// a: the metal's reflectance at normal incidence, the dielectric's diffuse reflectance.
    pub color: Vec3<L>,
    /// In [0, 1]; below [`ggx::NARROW`] the specular part is a delta lobe.
    pub alpha: L,
    /// F₀.
    pub f0: L,
    /// m, in [0, 1].
    pub metallic: L,
}

/// The reflectance of a dielectric of this index at normal incidence.
pub fn normal_reflectance(ior: f32) -> f32 {
    let ior = f64::from(ior);
    (((ior - 1.0) / (ior + 1.0)).powi(2)) as f32
}

/// (1 − cos)⁵.
#[inline(always)]
fn schlick<L: Lane>(cos: L) -> L {
    let x = (L::one() - cos).max(L::zero());
    let x2 = x * x;
    x2 * x2 * x
}

impl<L: Lane> MetalRough<L> {
    /// F at a facet's cosine, coloured.
    #[inline(always)]
    fn fresnel(&self, cos: L) -> Vec3<L> {
        let s = schlick(cos);
        let dielectric = L::one() - self.metallic;
        let mix = |a: L| {
            let normal = dielectric.mul_add(self.f0, self.metallic * a);
            (L::one() - normal).mul_add(s, normal)
        };
        Vec3::new(mix(self.color.x), mix(self.color.y), mix(self.color.z))
    }
    /// q.
    #[inline(always)]
    fn grazing(&self) -> L {
        schlick(L::splat(GRAZING_FIT) * self.alpha * self.alpha.sqrt())
    }
    /// (1 − m) (1 − F₀) T(c): the base's share of light from a direction.
    #[inline(always)]
    fn entering(&self, cos: L) -> L {
        let transmitted = self.grazing().neg_mul_add(schlick(cos), L::one());
        (L::one() - self.metallic) * (L::one() - self.f0) * transmitted
    }
    /// T(c) / (1 − q / 21).
    #[inline(always)]
    fn leaving(&self, cos: L) -> L {
        let q = self.grazing();
        q.neg_mul_add(schlick(cos), L::one()) / q.neg_mul_add(L::splat(1.0 / 21.0), L::one())
    }
    /// h · o = |h| / 2 of the facet that reflects d into `wi`.
    #[inline(always)]
    fn facet_cosine(d: Vec3<L>, wi: Vec3<L>) -> L {
        let half = wi - d;
        L::splat(0.5) * half.dot(half).sqrt()
    }
    /// The probability of sampling the specular part: its share of the reflected light if it were smooth, by
    /// the brightest channels.
    #[inline(always)]
    fn specular_probability(&self, d: Vec3<L>, n: Vec3<L>) -> L {
        let cos = ggx::cos_o(d, n);
        let (fresnel, base) = (self.fresnel(cos), self.entering(cos));
        let brightest = |v: Vec3<L>| v.x.max(v.y).max(v.z);
        let (specular, base) = (brightest(fresnel), base * brightest(self.color));
        // Where both are zero, the result is black.
        specular / (specular + base).max(L::splat(f32::MIN_POSITIVE))
    }

    /// Samples the specular part or the base, as `uc` says. The second result is the weight with colour.
    #[inline(always)]
    pub fn sample(&self, d: Vec3<L>, n: Vec3<L>, uc: L, (u, v): (L, L)) -> (BsdfSample<L>, Vec3<L>) {
        let probability = self.specular_probability(d, n);
        let (specular, cos) = ggx::sample_direction(d, n, self.alpha, u, v);
        let reflects = uc.lt(probability);
        let wi = Vec3::select(reflects, specular, diffuse::sample(n, u, v).wi);
        let BsdfEval { value, mut pdf } = self.evaluate(d, n, wi);
        let mut weight = value * (L::one() / pdf);
        let delta = reflects & ggx::is_narrow(self.alpha);
        if delta.any() {
            let shadowing = ggx::shadowing(self.alpha, ggx::cos_o(d, n), cos);
            let fresnel = self.fresnel(Self::facet_cosine(d, specular));
            weight = Vec3::select(delta, fresnel * (shadowing / probability), weight);
            pdf = L::select(delta, L::splat(f32::INFINITY), pdf);
        }
        // Where the pdf is zero, rounding moved the sample out of the lobe.
        let alive = (!reflects | L::zero().lt(cos)) & L::zero().lt(pdf);
        (BsdfSample { wi, weight: L::one(), pdf, alive }, weight)
    }

    /// Both parts together; the base alone where the specular part is a delta lobe. Zero below the surface.
    #[inline(always)]
    pub fn evaluate(&self, d: Vec3<L>, n: Vec3<L>, wi: Vec3<L>) -> BsdfEval<L> {
        let probability = self.specular_probability(d, n);
        let specular: LobeEval<L> = ggx::evaluate(d, n, self.alpha, wi);
        let on_base = diffuse::evaluate(n, wi);
        let fresnel = self.fresnel(Self::facet_cosine(d, wi));
        let base = self.entering(ggx::cos_o(d, n)) * self.leaving(wi.dot(n));
        let diffuse = self.color * (base * on_base.value);
        let pdf = probability.mul_add(specular.pdf, (L::one() - probability) * on_base.pdf);
        BsdfEval { value: fresnel.mul_add(specular.value, diffuse), pdf }
    }
}
