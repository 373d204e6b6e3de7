//! Plastic: a clear coat, smooth or rough, over a matt base.
//!
//! The coat reflects F at its facets ([`super::ggx`]; smooth at alpha 0). What it lets in, T(i), is scattered by the base
//! (Lambert, reflectance a) and leaves through the coat, T(o), or is reflected back from within, F′ of it, onto the base again, and so on.
//! The series sums to
//!
//! ```text
//! f = F D G₂ / (4 cos i cos o) + a T(i) T(o) / (π η² (1 − a F′)),      1 − F′ = T̄ / η²,   T̄ = 2 ∫ T(c) c dc
//!   = F D G₂ / (4 cos i cos o) + T(i) T(o) / π · a / (η² (1 − a) + a T̄)
//! ```
//!
//! Reciprocal. With a smooth coat and a = 1 it returns all light, F(o) + T(o) = 1. A rough coat's facets show themselves more steeply
//! to a grazing ray than its plane does, so T is that of the cosine c + (1 − c) κ α^1.5 with κ = `STEEPER`: the largest that creates no light,
//! by quadrature (0.07 % at most, for indices from 1 to 3). What a rough coat loses is stated where it is measured, `tests/lobes.rs`.
//!
//! Source: Wolff, Nayar, Oren, "Improved Diffuse Reflection Models for Computer Vision", IJCV 1998; Jakob, Mitsuba, `plastic`;
//! 1 − F′ = T̄ / η²: Egan, Hilgeman, Optical Properties of Inhomogeneous Materials, 1979. The steeper cosine is our own fit.

use super::glass::boundary;
use super::{BsdfEval, BsdfSample, LobeEval, diffuse, ggx};
use crate::lane::Lane;
use crate::math::Vec3;

/// See the head of this file.
const STEEPER: f32 = 0.43;

/// What plastic is made of.
#[derive(Clone, Copy, Debug)]
pub struct Plastic<L: Lane> {
    /// The base's reflectance a.
    pub color: Vec3<L>,
    /// Of the coat, in [0, 1].
    pub alpha: L,
    /// η, at least 1.
    pub ior: L,
    /// T̄ of [`mean_transmittance`].
    pub transmitted: L,
}

/// T̄: what the coat lets in of light that comes evenly from everywhere. Domain: `ior` ≥ 1, `alpha` in [0, 1].
///
/// In f64, by the midpoint rule over c², off by less than 1e-6.
pub fn mean_transmittance(ior: f32, alpha: f32) -> f32 {
    const STEPS: u32 = 4096;
    let (eta, alpha) = (1.0 / f64::from(ior), f64::from(alpha));
    let steeper = f64::from(STEEPER) * alpha * alpha.sqrt();
    let transmitted = |step: u32| {
        let c = ((f64::from(step) + 0.5) / f64::from(STEPS)).sqrt();
        let c = c + (1.0 - c) * steeper;
        let cos_t = (1.0 - eta * eta * (1.0 - c * c)).sqrt();
        let (parallel, perpendicular) =
            ((c - eta * cos_t) / (c + eta * cos_t), (eta * c - cos_t) / (eta * c + cos_t));
        1.0 - 0.5 * (parallel * parallel + perpendicular * perpendicular)
    };
    ((0..STEPS).map(transmitted).sum::<f64>() / f64::from(STEPS)) as f32
}

impl<L: Lane> Plastic<L> {
    #[inline(always)]
    fn fresnel(&self, cos: L) -> L {
        // Not 0, where an index of 1 knows no answer.
        boundary(L::one() / self.ior, cos.min(L::one()).max(L::splat(1e-6))).fresnel
    }
    /// T of a direction by its cosine.
    #[inline(always)]
    fn let_in(&self, cos: L) -> L {
        let steeper = L::splat(STEEPER) * self.alpha * self.alpha.sqrt();
        let cos = cos.max(L::zero());
        L::one() - self.fresnel((L::one() - cos).mul_add(steeper, cos))
    }
    /// a / (η² (1 − a) + a T̄) of each channel.
    #[inline(always)]
    fn base(&self) -> Vec3<L> {
        let eta2 = self.ior * self.ior;
        let of =
            |a: L| a / a.mul_add(self.transmitted, eta2 * (L::one() - a)).max(L::splat(f32::MIN_POSITIVE));
        Vec3::new(of(self.color.x), of(self.color.y), of(self.color.z))
    }
    /// F at the facet that reflects d into `towards`: h · o = |h| / 2.
    #[inline(always)]
    fn facet_fresnel(&self, d: Vec3<L>, towards: Vec3<L>) -> L {
        let half = towards - d;
        self.fresnel(L::splat(0.5) * half.dot(half).sqrt())
    }
    /// How probably the coat is drawn: its share of the light if it were smooth, of the channel with the brightest base.
    #[inline(always)]
    fn coat_probability(&self, let_in: L, base: Vec3<L>) -> L {
        let fresnel = L::one() - let_in;
        let base = base.x.max(base.y).max(base.z) * self.transmitted;
        // With neither, black anyway.
        fresnel / base.mul_add(let_in, fresnel).max(L::splat(f32::MIN_POSITIVE))
    }

    /// Draws the coat or the base by `choose`, uniform in [0, 1). The weight of the lanes holds all colour.
    #[inline(always)]
    pub fn sample(&self, d: Vec3<L>, n: Vec3<L>, choose: L, (u, v): (L, L)) -> (BsdfSample<L>, Vec3<L>) {
        let (let_in, base) = (self.let_in(ggx::cos_out(d, n)), self.base());
        let probability = self.coat_probability(let_in, base);
        let (on_coat, on_base) = (ggx::sample(d, n, self.alpha, u, v), diffuse::sample(n, u, v));
        let coat = choose.lt(probability);
        let delta = coat & ggx::is_narrow(self.alpha);
        let direction = Vec3::select(coat, on_coat.direction, on_base.direction);
        let BsdfEval { value, pdf } = self.evaluate(d, n, direction);
        let weight = value * (L::one() / pdf);
        let mirrored = on_coat.weight * self.facet_fresnel(d, on_coat.direction) / probability;
        let weight = Vec3::select(delta, Vec3::repeat(mirrored), weight);
        let pdf = L::select(delta, L::splat(f32::INFINITY), pdf);
        // Of a direction without density rounding drew what the lobe has not.
        let alive = (!coat | on_coat.alive) & L::zero().lt(pdf);
        (BsdfSample { direction, weight: L::one(), pdf, alive }, weight)
    }

    /// Coat and base together; the base alone where the coat is narrow. Zero below the surface.
    #[inline(always)]
    pub fn evaluate(&self, d: Vec3<L>, n: Vec3<L>, towards: Vec3<L>) -> BsdfEval<L> {
        let (let_in, base) = (self.let_in(ggx::cos_out(d, n)), self.base());
        let probability = self.coat_probability(let_in, base);
        let on_coat: LobeEval<L> = ggx::evaluate(d, n, self.alpha, towards);
        let on_base = diffuse::evaluate(n, towards);
        let through = let_in * self.let_in(towards.dot(n)) * on_base.value;
        let shine = self.facet_fresnel(d, towards) * on_coat.value;
        let pdf = probability.mul_add(on_coat.pdf, (L::one() - probability) * on_base.pdf);
        BsdfEval { value: base.mul_add(through, Vec3::repeat(shine)), pdf }
    }
}
