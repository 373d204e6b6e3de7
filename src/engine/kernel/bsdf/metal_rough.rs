//! Metal-rough: the metallic-roughness model of glTF 2.0, between a metal and a dielectric.
//!
//! With F₀ the dielectric's reflectance at normal incidence, m the metallic share and a the colour:
//!
//! ```text
//! f = ((1 − m) F(F₀) + m F(a)) D G₂ / (4 cos i cos o) + (1 − m) a (1 − A) / π
//! F(x) = (x + (1 − x) (1 − h · o)⁵) / (1 − x (1 − E))
//! ```
//!
//! E is the albedo of white GGX, and A the total that a dielectric's specular part reflects, both seen from
//! o: [`super::albedo`]. White metal and white dielectrics return all light, within the fits' errors.
//!
//! The specular part is the standard's, without its loss. The standard's base, a (1 − F(h · o)) / π, returns
//! with a smooth coat up to 1.6 times the light that arrives at a grazing angle; the base used here has only
//! the light that the specular part leaves.
//!
//! Source: glTF 2.0 specification, appendix B; Schlick, "An Inexpensive BRDF Model for Physically-based
//! Rendering", Computer Graphics Forum 13(3), 1994; the base, as in Cycles: Kulla, Conty, "Revisiting
//! Physically Based Shading at Imageworks", SIGGRAPH 2017.

use super::albedo::{Albedo, schlick};
use super::lobe_normals::LobeNormals;
use super::{BsdfEval, BsdfSample, LobeEval};
use super::{diffuse, ggx};
use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// The parameters of metal-rough.
#[derive(Clone, Copy, Debug)]
pub struct MetalRough<L: Lane> {
    /// The colour a: the metal's reflectance at normal incidence, the dielectric's diffuse reflectance.
    pub color: Vec3<L>,
    /// The roughness α, in [0, 1]; below [`ggx::NARROW`] the specular part is a delta lobe.
    pub alpha: L,
    /// The reflectance F₀.
    pub f0: L,
    /// The metallic share m, in [0, 1].
    pub metallic: L,
}

/// Returns the reflectance of a dielectric of this index at normal incidence.
pub fn normal_reflectance(ior: f32) -> f32 {
    let ior = f64::from(ior);
    (((ior - 1.0) / (ior + 1.0)).powi(2)) as f32
}

/// The values that depend on the direction of view and not on that of the light.
#[derive(Clone, Copy)]
pub(super) struct View<L: Lane> {
    /// (1 − m) F(F₀) + m F(a) for h = o, and for h · o = 0.
    pub normal: Vec3<L>,
    pub grazing: Vec3<L>,
    /// (1 − m) (1 − A).
    pub base: L,
    /// The probability of sampling the specular part: its share of the reflected light, by the brightest
    /// channels.
    pub specular_probability: L,
}

impl<L: Lane> View<L> {
    /// Returns (1 − m) F(F₀) + m F(a) of the facet that reflects d into `wi`: h · o = |h| / 2.
    #[inline(always)]
    fn specular(&self, d: Vec3<L>, wi: Vec3<L>) -> Vec3<L> {
        let half = wi - d;
        let s = schlick(L::splat(0.5) * half.dot(half).sqrt());
        self.normal * (L::one() - s) + self.grazing * s
    }
}

impl<L: Lane> MetalRough<L> {
    #[inline(always)]
    fn view(&self, d: Vec3<L>, n: Vec3<L>) -> View<L> {
        let albedo = Albedo::of(ggx::cos_o(d, n), self.alpha);
        let dielectric = L::one() - self.metallic;
        let uncompensated = self.color.mul_add(self.metallic, Vec3::repeat(dielectric * self.f0));
        let base = dielectric * (L::one() - albedo.reflected(self.f0)).max(L::zero());
        let brightest = |v: Vec3<L>| v.x.max(v.y).max(v.z);
        let (specular, diffuse) = (albedo.reflected(brightest(uncompensated)), base * brightest(self.color));
        // If both are zero, the result is black.
        let specular_probability = specular / (specular + diffuse).max(L::splat(f32::MIN_POSITIVE));
        let of_dielectric = Vec3::repeat(albedo.series(self.f0) * dielectric);
        let of_metal = albedo.compensation(self.color) * self.metallic;
        let normal = of_dielectric * self.f0 + of_metal * self.color;
        View { normal, grazing: of_dielectric + of_metal, base, specular_probability }
    }

    /// Samples the specular part or the base, by `uc`. The second result is the weight with colour.
    #[inline(always)]
    pub fn sample(
        &self,
        d: Vec3<L>,
        normals: &LobeNormals<L>,
        uc: L,
        (u, v): (L, L),
    ) -> (BsdfSample<L>, Vec3<L>) {
        self.sample_view(&self.view(d, normals.specular), d, normals, [uc, u, v])
    }
    #[inline(always)]
    pub(super) fn sample_view(
        &self,
        view: &View<L>,
        d: Vec3<L>,
        normals: &LobeNormals<L>,
        [uc, u, v]: [L; 3],
    ) -> (BsdfSample<L>, Vec3<L>) {
        let (n, probability) = (normals.specular, view.specular_probability);
        let (specular, cos) = ggx::sample_direction(d, n, self.alpha, u, v);
        let (reflects, smooth) = (uc.lt(probability), ggx::is_narrow(self.alpha));
        let on_base = diffuse::sample(normals, u, v).wi;
        let wi = Vec3::select(reflects, normals.raise(specular, smooth), on_base);
        let BsdfEval { value, mut pdf } = self.evaluate_view(view, d, normals, wi);
        let mut weight = value * (L::one() / pdf);
        let delta = reflects & smooth;
        if delta.any() {
            let shadowing = ggx::shadowing(self.alpha, ggx::cos_o(d, n), cos);
            let reflected = view.specular(d, specular) * (shadowing / probability);
            weight = Vec3::select(delta, reflected, weight);
            pdf = L::select(delta, L::splat(f32::INFINITY), pdf);
        }
        // If the pdf is zero, rounding moved the sample out of the lobe, or the base absorbs it.
        let alive = (!reflects | L::zero().lt(cos)) & L::zero().lt(pdf);
        (BsdfSample { wi, weight: L::one(), pdf, alive }, weight)
    }

    /// Evaluates both parts; only the base if the specular part is a delta lobe. Zero below the surface.
    #[inline(always)]
    pub fn evaluate(&self, d: Vec3<L>, normals: &LobeNormals<L>, wi: Vec3<L>) -> BsdfEval<L> {
        self.evaluate_view(&self.view(d, normals.specular), d, normals, wi)
    }
    #[inline(always)]
    pub(super) fn evaluate_view(
        &self,
        view: &View<L>,
        d: Vec3<L>,
        normals: &LobeNormals<L>,
        wi: Vec3<L>,
    ) -> BsdfEval<L> {
        let probability = view.specular_probability;
        let on_base = diffuse::evaluate(normals, wi);
        let diffuse = self.color * (view.base * on_base.value);
        let BsdfEval { value, pdf } = normals.fold(wi, diffuse, |wi, base| {
            let LobeEval { value, pdf } = ggx::evaluate(d, normals.specular, self.alpha, wi);
            BsdfEval { value: view.specular(d, wi).mul_add(value, base), pdf }
        });
        BsdfEval { value, pdf: probability.mul_add(pdf, (L::one() - probability) * on_base.pdf) }
    }
}
