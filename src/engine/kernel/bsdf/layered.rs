//! Metal-rough with another reflectance of its dielectric, and under a clear coat.
//!
//! The dielectric reflects F₀ of three channels at normal incidence and F₉₀ at grazing angles. A coat of the
//! share c, of α of its own and of the index 1.5, lies over all:
//!
//! ```text
//! F(F₀) = (F₀ + (F₉₀ − F₀) (1 − h · o)⁵) / (1 − F₀ (1 − E))
//! f = c F(0.04) D G₂ / (4 cos i cos o) + (1 − c A) f of the surface below
//! ```
//!
//! A is the total that the coat reflects, seen from o ([`super::albedo`]). The base below the dielectric gets
//! what the brightest channel of F leaves. So no light is added, and a white coated surface returns all of
//! it; the coat takes light once, where it enters, as in the standard.
//!
//! Source: Khronos, KHR_materials_specular, KHR_materials_clearcoat; the rest: [`super::metal_rough`].

use super::albedo::{Albedo, schlick};
use super::lobe_normals::LobeNormals;
use super::metal_rough::{MetalRough, View};
use super::{BsdfEval, BsdfSample, LobeEval, ggx};
use crate::lane::Lane;
use crate::math::Vec3;

/// The reflectance of the coat at normal incidence: that of the index 1.5.
const COAT: f32 = 0.04;

/// The parameters beside those of metal-rough.
#[derive(Clone, Copy, Debug)]
pub struct Layers<L: Lane> {
    /// F₀ of each channel.
    pub f0: Vec3<L>,
    /// F₉₀.
    pub f90: L,
    /// The share c of the coat.
    pub coat: L,
    /// The roughness α of the coat; below [`ggx::NARROW`] it is a delta lobe.
    pub coat_alpha: L,
}

/// Metal-rough with these parameters; its own F₀ is not used.
#[derive(Clone, Copy, Debug)]
pub struct Layered<L: Lane> {
    /// The surface below the coat.
    pub base: MetalRough<L>,
    /// Its reflectance, and the coat.
    pub layers: Layers<L>,
}

/// The values of the coat that depend on the direction of view.
#[derive(Clone, Copy)]
struct Coat<L: Lane> {
    /// c F(0.04) for h = o, and for h · o = 0.
    normal: L,
    grazing: L,
    /// 1 − c A.
    passed: L,
    /// The probability of sampling the coat.
    probability: L,
}

#[inline(always)]
fn brightest<L: Lane>(v: Vec3<L>) -> L {
    v.x.max(v.y).max(v.z)
}

impl<L: Lane> Layered<L> {
    #[inline(always)]
    fn view(&self, d: Vec3<L>, n: Vec3<L>) -> (View<L>, Coat<L>) {
        let (MetalRough { color, alpha, metallic, .. }, one) = (self.base, L::one());
        let Layers { f0, f90, coat, coat_alpha } = self.layers;
        let cos = ggx::cos_o(d, n);
        let albedo = Albedo::of(cos, alpha);
        let (dielectric, grazing) = (one - metallic, albedo.grazing());
        let total = |f0: L, f90: L| f0.mul_add(albedo.white - grazing, f90 * grazing) * albedo.series(f0);
        let reflected = total(brightest(f0), f90);
        let uncompensated = color.mul_add(metallic, f0 * dielectric);
        let specular = total(brightest(uncompensated), dielectric.mul_add(f90, metallic));
        let base = dielectric * (one - reflected).max(L::zero());
        let diffuse = base * brightest(color);
        let all = (specular + diffuse).max(L::splat(f32::MIN_POSITIVE));
        let of_dielectric = albedo.compensation(f0) * dielectric;
        let of_metal = albedo.compensation(color) * metallic;
        let normal = of_dielectric * f0 + of_metal * color;
        let grazing = of_dielectric * f90 + of_metal;
        let view = View { normal, grazing, base, specular_probability: specular / all };

        let (f0, smooth) = (L::splat(COAT), ggx::is_narrow(coat_alpha));
        let albedo = Albedo::of(cos, coat_alpha);
        let white = L::select(smooth, one, albedo.white);
        let grazing = L::select(smooth, schlick(cos), albedo.grazing());
        let series = L::select(smooth, one, albedo.series(f0));
        let reflected = coat * f0.mul_add(white - grazing, grazing) * series;
        let passed = one - reflected;
        let probability = reflected / passed.mul_add(all, reflected).max(L::splat(f32::MIN_POSITIVE));
        (view, Coat { normal: coat * series * f0, grazing: coat * series, passed, probability })
    }

    /// Samples the coat or the surface below it, by `uc`. The second result is the weight with colour.
    #[inline(never)]
    pub fn sample(
        &self,
        d: Vec3<L>,
        normals: &LobeNormals<L>,
        uc: L,
        (u, v): (L, L),
    ) -> (BsdfSample<L>, Vec3<L>) {
        let (n, alpha) = (normals.specular, self.layers.coat_alpha);
        let (view, coat) = self.view(d, n);
        let (probability, smooth) = (coat.probability, ggx::is_narrow(alpha));
        let on_coat = uc.lt(probability);
        let below = L::one() - probability;
        let uc = ((uc - probability) / below.max(L::splat(f32::MIN_POSITIVE))).min(L::one());
        let (base, base_weight) = self.base.sample_view(&view, d, normals, [uc, u, v]);
        let (reflected, cos) = ggx::sample_direction(d, n, alpha, u, v);
        let wi = Vec3::select(on_coat, normals.raise(reflected, smooth), base.wi);
        let base_is_delta = !base.pdf.lt(L::splat(f32::INFINITY));
        let is_delta = (on_coat & smooth) | (!on_coat & base_is_delta);
        let BsdfEval { value, pdf } = self.evaluate_view((&view, &coat), d, normals, wi);
        let shadowing = ggx::shadowing(alpha, ggx::cos_o(d, n), cos);
        let mirrored = coat.specular(d, reflected) * shadowing / probability;
        let delta = Vec3::select(on_coat, Vec3::repeat(mirrored), base_weight * (coat.passed / below));
        let weight = Vec3::select(is_delta, delta, value * (L::one() / pdf));
        let pdf = L::select(is_delta, L::splat(f32::INFINITY), pdf);
        let alive = (on_coat & L::zero().lt(cos)) | (!on_coat & base.alive);
        (BsdfSample { wi, weight: L::one(), pdf, alive: alive & L::zero().lt(pdf) }, weight)
    }

    /// Evaluates all parts that are not delta lobes. Zero below the surface.
    #[inline(never)]
    pub fn evaluate(&self, d: Vec3<L>, normals: &LobeNormals<L>, wi: Vec3<L>) -> BsdfEval<L> {
        let (view, coat) = self.view(d, normals.specular);
        self.evaluate_view((&view, &coat), d, normals, wi)
    }
    #[inline(always)]
    fn evaluate_view(
        &self,
        (view, coat): (&View<L>, &Coat<L>),
        d: Vec3<L>,
        normals: &LobeNormals<L>,
        wi: Vec3<L>,
    ) -> BsdfEval<L> {
        let base = self.base.evaluate_view(view, d, normals, wi);
        let on_coat = normals.fold(wi, Vec3::zero(), |wi, _| {
            let LobeEval { value, pdf } = ggx::evaluate(d, normals.specular, self.layers.coat_alpha, wi);
            BsdfEval { value: Vec3::repeat(coat.specular(d, wi) * value), pdf }
        });
        let pdf = coat.probability.mul_add(on_coat.pdf, (L::one() - coat.probability) * base.pdf);
        BsdfEval { value: base.value.mul_add(coat.passed, on_coat.value), pdf }
    }
}

impl<L: Lane> Coat<L> {
    /// Returns c F(0.04) of the facet that reflects d into `wi`: h · o = |h| / 2.
    #[inline(always)]
    fn specular(&self, d: Vec3<L>, wi: Vec3<L>) -> L {
        let half = wi - d;
        let s = schlick(L::splat(0.5) * half.dot(half).sqrt());
        (self.grazing - self.normal).mul_add(s, self.normal)
    }
}
