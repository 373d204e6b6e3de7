//! Plastic: a dielectric coat, smooth or rough, over a diffuse base.
//!
//! The coat reflects F at its facets ([`super::ggx`]; smooth at alpha 0). The rest, T(i), reaches the base,
//! which scatters it (Lambert, reflectance a). The share T(o) of that leaves through the coat; F′ is
//! reflected back onto the base, and so on. The series sums to
//!
//! ```text
//! f = F D G₂ / (4 cos i cos o) + a T(i) T(o) / (π η² (1 − a F′)),    1 − F′ = T̄ / η²,   T̄ = 2 ∫ T(c) c dc
//!   = F D G₂ / (4 cos i cos o) + T(i) T(o) / π · a / (η² (1 − a) + a T̄)
//! ```
//!
//! A smooth coat has T(c) = 1 − F(c) and a reciprocal f: with a = 1 it returns all light. A rough coat loses
//! light between its facets, which goes into the base: in this case T(o) = 1 − E(o) F(h) with the directional
//! albedo E and the facets' mean cosine h of [`super::albedo`], so that a = 1 returns all light, but f is not
//! reciprocal. `tests/laws/lobes.rs` measures how much.
//!
//! Source: Wolff, Nayar, Oren, "Improved Diffuse Reflection Models for Computer Vision", IJCV 1998; Jakob,
//! Mitsuba, `plastic`; 1 − F′ = T̄ / η²: Egan, Hilgeman, Optical Properties of Inhomogeneous Materials, 1979.
//! The light that a rough coat gives to its base: Kulla, Conty, "Revisiting Physically Based Shading at
//! Imageworks", SIGGRAPH 2017.

use super::albedo::Albedo;
use super::lobe_normals::LobeNormals;
use super::{BsdfEval, BsdfSample, LobeEval};
use super::{diffuse, fresnel, ggx};
use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// The parameters of plastic.
#[derive(Clone, Copy, Debug)]
pub struct Plastic<L: Lane> {
    /// The base's reflectance a.
    pub color: Vec3<L>,
    /// The roughness of the coat, in [0, 1].
    pub alpha: L,
    /// The index of refraction η, at least 1.
    pub ior: L,
    /// The T̄ of [`mean_transmittance`].
    pub transmitted: L,
}

/// Returns T̄, the coat's transmittance of uniform incident radiance.
///
/// Domain: `ior` ≥ 1.
/// Error: less than 1e-6; in f64 by the midpoint rule over c².
pub fn mean_transmittance(ior: f32) -> f32 {
    const STEPS: u32 = 4096;
    let eta = 1.0 / f64::from(ior);
    let transmittance =
        |step: u32| 1.0 - fresnel::reflectance_f64(eta, ((f64::from(step) + 0.5) / f64::from(STEPS)).sqrt());
    ((0..STEPS).map(transmittance).sum::<f64>() / f64::from(STEPS)) as f32
}

/// The values that depend on the direction of view and not on that of the light.
#[derive(Clone, Copy, Debug)]
pub struct PlasticView<L: Lane> {
    /// T(o).
    into_base: L,
    /// a / (η² (1 − a) + a T̄) of each channel.
    base: Vec3<L>,
    /// The probability of sampling the coat.
    coat_probability: L,
    /// 1 / η.
    inverse_ior: L,
}

impl<L: Lane> PlasticView<L> {
    /// Returns zeros, for packets without plastic.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = L::zero();
        Self { into_base: zero, base: Vec3::zero(), coat_probability: zero, inverse_ior: zero }
    }
    #[inline(always)]
    fn fresnel(&self, cos: L) -> L {
        // Kept above 0: at a cosine of 0 an index of 1 gives 0/0.
        fresnel::dielectric(self.inverse_ior, cos.min(L::one()).max(L::splat(1e-6))).reflectance
    }
    /// Returns T of the direction of the light, from its cosine.
    #[inline(always)]
    fn transmittance(&self, cos: L) -> L {
        L::one() - self.fresnel(cos)
    }
    /// Returns F at the facet that reflects d into `wi`: h · o = |h| / 2.
    #[inline(always)]
    fn facet_fresnel(&self, d: Vec3<L>, wi: Vec3<L>) -> L {
        let half = wi - d;
        self.fresnel(L::splat(0.5) * half.dot(half).sqrt())
    }
}

impl<L: Lane> Plastic<L> {
    /// Prepares the lobe for rays that arrive along `d`.
    #[inline(always)]
    pub fn view(&self, d: Vec3<L>, n: Vec3<L>) -> PlasticView<L> {
        let mut view =
            PlasticView { base: self.base_factor(), inverse_ior: L::one() / self.ior, ..PlasticView::none() };
        let cos = ggx::cos_o(d, n);
        let Albedo { white, facet_cosine } = Albedo::of(cos, self.alpha);
        let smooth = ggx::is_narrow(self.alpha);
        let fresnel = view.fresnel(L::select(smooth, cos, facet_cosine));
        view.into_base = L::one() - L::select(smooth, fresnel, white * fresnel);
        view.coat_probability = self.coat_probability(view.into_base, view.base);
        view
    }
    /// Returns a / (η² (1 − a) + a T̄) of each channel, by one division.
    #[inline(always)]
    fn base_factor(&self) -> Vec3<L> {
        let Vec3 { x, y, z } = self.color;
        let eta2 = self.ior * self.ior;
        // Kept above 0; the product of three stays a normal number.
        let divisor = |a: L| a.mul_add(self.transmitted, eta2 * (L::one() - a)).max(L::splat(1e-12));
        let (dx, dy, dz) = (divisor(x), divisor(y), divisor(z));
        let inverse = L::one() / (dx * dy * dz);
        Vec3::new(x * (dy * dz * inverse), y * (dx * dz * inverse), z * (dx * dy * inverse))
    }
    /// Returns the probability of sampling the coat: its share of the reflected light if it were smooth, in
    /// the channel with the brightest base.
    #[inline(always)]
    fn coat_probability(&self, into_base: L, base: Vec3<L>) -> L {
        let fresnel = L::one() - into_base;
        let base = base.x.max(base.y).max(base.z) * self.transmitted;
        // If both are zero, the result is black.
        fresnel / base.mul_add(into_base, fresnel).max(L::splat(f32::MIN_POSITIVE))
    }

    /// Samples the coat or the base, by `uc`. The second result is the weight with colour.
    #[inline(always)]
    pub fn sample(
        &self,
        view: &PlasticView<L>,
        d: Vec3<L>,
        normals: &LobeNormals<L>,
        [uc, u, v]: [L; 3],
    ) -> (BsdfSample<L>, Vec3<L>) {
        let (n, probability) = (normals.specular, view.coat_probability);
        let (on_coat, cos) = ggx::sample_direction(d, n, self.alpha, u, v);
        let (coat, smooth) = (uc.lt(probability), ggx::is_narrow(self.alpha));
        let on_base = diffuse::sample(normals, u, v).wi;
        let wi = Vec3::select(coat, normals.raise(on_coat, smooth), on_base);
        let BsdfEval { value, mut pdf } = self.evaluate(view, d, normals, wi);
        let mut weight = value * (L::one() / pdf);
        let delta = coat & smooth;
        if delta.any() {
            let shadowing = ggx::shadowing(self.alpha, ggx::cos_o(d, n), cos);
            let mirror_weight = shadowing * view.facet_fresnel(d, on_coat) / probability;
            weight = Vec3::select(delta, Vec3::repeat(mirror_weight), weight);
            pdf = L::select(delta, L::splat(f32::INFINITY), pdf);
        }
        // If the pdf is zero, rounding moved the sample out of the lobe, or the base absorbs it.
        let alive = (!coat | L::zero().lt(cos)) & L::zero().lt(pdf);
        (BsdfSample { wi, weight: L::one(), pdf, alive }, weight)
    }

    /// Evaluates coat and base; only the base if the coat is a delta lobe. Zero below the surface.
    #[inline(always)]
    pub fn evaluate(
        &self,
        view: &PlasticView<L>,
        d: Vec3<L>,
        normals: &LobeNormals<L>,
        wi: Vec3<L>,
    ) -> BsdfEval<L> {
        let probability = view.coat_probability;
        let on_base = diffuse::evaluate(normals, wi);
        let diffuse = view.into_base * view.transmittance(wi.dot(normals.diffuse)) * on_base.value;
        let coat = normals.fold(wi, Vec3::zero(), |wi, _| {
            let LobeEval { value, pdf } = ggx::evaluate(d, normals.specular, self.alpha, wi);
            BsdfEval { value: Vec3::repeat(view.facet_fresnel(d, wi) * value), pdf }
        });
        let pdf = probability.mul_add(coat.pdf, (L::one() - probability) * on_base.pdf);
        BsdfEval { value: view.base.mul_add(diffuse, coat.value), pdf }
    }
}
