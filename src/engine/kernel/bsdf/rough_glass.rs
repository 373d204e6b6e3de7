//! Rough glass: a dielectric interface of GGX facets, each of which reflects or refracts.
//!
//! With η the index on the side of o over that on the other side, m the normal of the facet, h = η d − i
//! (turned to the side of n) for light that is refracted, D, Λ and s of [`super::ggx`], and F of the facet:
//!
//! ```text
//! reflected:   pdf = F D / (2 (cos o + s(o)))
//! refracted:   pdf = (1 − F) 2 (o · h) (−i · h) (α / (h⊥² + α² h∥²))² / (π (cos o + s(o)))
//! f cos θ / pdf = G₂ / G₁ / E, times η² if refracted
//! ```
//!
//! h has the length |cos t − η cos i| of the facet's angles, which is the square root of the Jacobian's
//! divisor, so that the second pdf needs no division by it. Refracted radiance scales with the square of the
//! index, as in [`super::glass`].
//!
//! E, the share of light that single scattering keeps, is in [`super::glass_albedo`]: the factor 1 / E
//! returns the light that is lost between facets. It depends only on o, so that sampled directions keep their
//! pdfs, and the lobe is not reciprocal.
//!
//! Thin glass reflects F′ of [`super::glass`] at each facet; the rest is transmitted, its direction mirrored
//! in the pane. Its E is that of white metal.
//!
//! Units, domain: see [`super`]. With α |ior − 1| below [`ggx::NARROW`] refraction is too narrow to evaluate,
//! and the whole lobe counts as a delta lobe.
//! Source: Walter, Marschner, Li, Torrance, "Microfacet Models for Refraction through Rough Surfaces", EGSR
//! 2007; visible normals: see [`super::ggx`]; the factor: Turquin, "Practical multiple scattering
//! compensation for microfacet models", 2019.

use super::fresnel::{self, Fresnel};
use super::glass::is_thin;
use super::lobe_normals::{Horizon, LobeNormals};
use super::{BsdfSample, LobeEval, ggx};
use crate::lane::Lane;
use crate::math::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Rough glass, seen from one side.
#[derive(Clone, Copy, Debug)]
pub struct RoughGlass<L: Lane> {
    /// The roughness α, in [0, 1].
    pub alpha: L,
    /// The index of refraction inside, above 0; negated for thin glass.
    pub ior: L,
    /// 1 / E.
    pub compensation: L,
    /// The lanes whose ray arrives from the vacuum side.
    pub outside: L::Mask,
    /// The geometric normal on the side of the ray, which decides sides.
    pub ng: Vec3<L>,
}

impl<L: Lane> RoughGlass<L> {
    /// Returns the lanes whose lobe is too narrow to evaluate.
    #[inline(always)]
    pub fn is_narrow(alpha: L, ior: L) -> L::Mask {
        let bend = L::select(is_thin(ior), L::one(), (ior - L::one()).abs().min(L::one()));
        ggx::is_narrow(alpha * bend)
    }
    /// Returns η.
    #[inline(always)]
    fn eta(&self) -> L {
        let ior = self.ior.abs();
        L::select(self.outside | is_thin(self.ior), L::one() / ior, ior)
    }
    /// Returns the reflected share at a facet, and the cosine of the refracted direction.
    #[inline(always)]
    fn reflectance(&self, eta: L, cos: L) -> (L, L) {
        // Kept above 0: at a cosine of 0 an index of 1 gives 0/0.
        let cos = cos.min(L::one()).max(L::splat(1e-6));
        let Fresnel { reflectance, total, cos_t } = fresnel::dielectric(eta, cos);
        let once = L::select(total, L::one(), reflectance);
        (L::select(is_thin(self.ior), (once + once) / (L::one() + once), once), cos_t)
    }

    /// Samples a facet, and by `uc` whether it reflects.
    #[inline(never)]
    pub fn sample(&self, d: Vec3<L>, normals: &LobeNormals<L>, [uc, u, v]: [L; 3]) -> BsdfSample<L> {
        let (n, eta, thin) = (normals.specular, self.eta(), is_thin(self.ior));
        let facet = ggx::sample_normal(d, n, self.alpha, u, v);
        let cos_facet = (-d.dot(facet)).max(L::zero());
        let (reflectance, cos_t) = self.reflectance(eta, cos_facet);
        let reflects = uc.lt(reflectance);
        let reflected = d.reflect(facet);
        let refracted = d * eta + facet * eta.mul_add(cos_facet, -cos_t);
        let transmitted = Vec3::select(thin, reflected.reflect(n), refracted.normalize());
        let wi = Vec3::select(reflects, reflected, transmitted);
        let height = wi.dot(n);
        let cos = L::select(reflects, height, -height);
        let alive = L::zero().lt(cos);
        let scale = L::select(reflects | thin, L::one(), eta * eta);
        let weight = ggx::shadowing(self.alpha, ggx::cos_o(d, n), cos) * self.compensation * scale;
        let wi = self.mirror_to_side(normals, wi, reflects);
        // A sample has a positive pdf, even if rounding makes it zero.
        let pdf = self.evaluate(d, normals, wi).pdf.max(L::splat(f32::MIN_POSITIVE));
        let pdf = L::select(Self::is_narrow(self.alpha, self.ior), L::splat(f32::INFINITY), pdf);
        BsdfSample { wi, weight: weight.only(alive), pdf, alive }
    }
    /// Returns directions on the right side of the geometric normal: mirrored in its plane if shading normals
    /// put them on the wrong one.
    #[inline(always)]
    fn mirror_to_side(&self, normals: &LobeNormals<L>, wi: Vec3<L>, reflects: L::Mask) -> Vec3<L> {
        let Some(Horizon { bent, .. }) = normals.horizon else { return wi };
        let wrong = reflects ^ L::zero().lt(wi.dot(self.ng));
        Vec3::select(bent & wrong, wi.reflect(self.ng), wi)
    }

    /// Evaluates the lobe on both sides; zero if it is narrow.
    #[inline(never)]
    pub fn evaluate(&self, d: Vec3<L>, normals: &LobeNormals<L>, wi: Vec3<L>) -> LobeEval<L> {
        let near = L::zero().lt(wi.dot(self.ng));
        let direct = self.evaluate_about(d, normals.specular, wi, near);
        let Some(Horizon { bent, .. }) = normals.horizon else { return direct };
        let other = self.evaluate_about(d, normals.specular, wi.reflect(self.ng), near);
        LobeEval { value: direct.value + other.value.only(bent), pdf: direct.pdf + other.pdf.only(bent) }
    }
    /// Evaluates the lobe about `n` for light that leaves to the side of the ray in the lanes of `near`, or
    /// to the other side.
    #[inline(always)]
    fn evaluate_about(&self, d: Vec3<L>, n: Vec3<L>, wi: Vec3<L>, near: L::Mask) -> LobeEval<L> {
        let (eta, thin, cos) = (self.eta(), is_thin(self.ior), wi.dot(n));
        let above = Vec3::select(near, wi, wi.reflect(n));
        let half = above - d;
        let (reflectance, _) = self.reflectance(eta, L::splat(0.5) * half.dot(half).sqrt());
        let mirrored =
            ggx::pdf(d, n, self.alpha, above) * L::select(near, reflectance, L::one() - reflectance);
        let (refracted, is_refracted) = self.refracted_pdf(d, n, eta, wi);
        let is_mirrored = L::zero().lt(cos) & near | (cos.lt(L::zero()) & !near & thin);
        let is_refracted = is_refracted & !near & !thin & cos.lt(L::zero());
        let pdf = L::select(is_refracted, refracted, mirrored);
        let scale = L::select(is_refracted, eta * eta, L::one()) * self.compensation;
        let value = pdf * ggx::shadowing(self.alpha, ggx::cos_o(d, n), cos.abs()) * scale;
        let valid = (is_mirrored | is_refracted) & !Self::is_narrow(self.alpha, self.ior);
        LobeEval::within(valid, value, pdf)
    }
    /// Returns the pdf of a refracted direction below `n`, and the lanes in which some facet refracts to it.
    #[inline(always)]
    fn refracted_pdf(&self, d: Vec3<L>, n: Vec3<L>, eta: L, wi: Vec3<L>) -> (L, L::Mask) {
        let half = (d * eta - wi).flip_sign(L::one() - eta);
        let (towards, away) = (-d.dot(half), -wi.dot(half));
        let (along, across) = (half.dot(n), half.cross(n));
        let exists = L::zero().lt(towards) & L::zero().lt(away) & L::zero().lt(along);
        // From both cosines: near total reflection the second one would cancel.
        let inverse = L::one() / half.dot(half).sqrt();
        let reflectance = fresnel::reflectance(eta, towards * inverse, away * inverse);
        let (cos, alpha2) = (ggx::cos_o(d, n), self.alpha * self.alpha);
        let ratio = self.alpha / alpha2.mul_add(along * along, across.dot(across));
        let density = L::splat(2.0 * FRAC_1_PI) * (towards * ratio) * (away * ratio);
        let visible = density / (cos + ggx::stretched_cosine(self.alpha, cos));
        ((L::one() - reflectance) * visible, exists)
    }
}
