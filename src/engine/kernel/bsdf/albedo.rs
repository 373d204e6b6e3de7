//! Computes the directional albedo of GGX with single scattering, the share of light that it reflects, and
//! the factor that compensates for the loss between facets.
//!
//! With μ = cos o, F₀ the reflectance at normal incidence and F = F₀ + (1 − F₀) (1 − h · o)⁵ of Schlick:
//!
//! ```text
//! E(μ, α)  = ∫ D G₂ / (4 cos i cos o) cos i di
//! E₅(μ, α) = ∫ (1 − h · o)⁵ D G₂ / (4 cos i cos o) cos i di
//! f = F D G₂ / (4 cos i cos o) / (1 − F₀ (1 − E))
//! ∫ f cos i di = (F₀ E + (1 − F₀) E₅) / (1 − F₀ (1 − E))
//! ```
//!
//! the sum of the light that leaves after one bounce, two, three and so on, so that white metal returns all
//! light, and a coloured one gets its colour once for each bounce. The factor depends only on o: the lobe
//! keeps its shape, and the sampled directions their pdfs, but f is no longer reciprocal. A reciprocal lobe
//! that compensates for the loss (Kulla, Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH
//! 2017) has tails that sampling visible normals does not reach: it would be a third lobe to sample.
//!
//! E and E₅ = E (1 − h)⁵ are rational functions, fitted to their integrals. E is 1 at grazing incidence and
//! on a mirror; for small α it depends only on c = μ / s and σ² = 1 − c², with s² = μ² + α² (1 − μ²).
//!
//! Source: Turquin, "Practical multiple scattering compensation for microfacet models", 2019, with the whole
//! series where he has its first two terms, 1 + F₀ (1 − E) / E. The fits are our own.

use super::ggx;
use crate::lane::Lane;
use crate::math::Vec3;

/// The albedo of GGX seen from a direction.
#[derive(Clone, Copy, Debug)]
pub struct Albedo<L: Lane> {
    /// E, the albedo of white GGX.
    pub white: L,
    /// The cosine h · o of a facet at which (1 − h · o)⁵ equals its mean: E₅ = E (1 − h)⁵.
    pub facet_cosine: L,
}

impl<L: Lane> Albedo<L> {
    /// Computes the albedo from the cosine of the direction.
    ///
    /// Domain: both in [0, 1], the cosine above 0.
    /// Error: 0.5 % of E, 0.008 in E₅.
    #[inline(always)]
    pub fn of(cos: L, alpha: L) -> Self {
        let n = L::splat;
        let (mu, a, one) = (cos.min(L::one()), alpha, L::one());
        let s = ggx::stretched_cosine(a, mu);
        let c = (mu / s).min(one);
        let sigma = c.neg_mul_add(c, one).max(L::zero()).sqrt();
        let a2 = a * a;
        let narrow = a2.mul_add(n(0.6057), c * n(-0.1997)).mul_add(sigma, c * n(0.2543) - a2 * n(0.7164));
        let loss = c * (one - c).mul_add(narrow, a2 * n(0.2037));
        let at_c = a.mul_add(n(1.7093), n(-0.8341));
        let at_sigma = a.mul_add(n(-0.2676), n(1.8491)).mul_add(a, n(-0.9814));
        let at_both = a.mul_add(n(0.1059), n(-1.5914)).mul_add(a, n(0.8844));
        let rest = a.mul_add(n(0.2614), n(-1.8421)).mul_add(a, one);
        let divisor = sigma.mul_add(c.mul_add(at_both, at_sigma), c.mul_add(at_c, rest));
        let white = one - loss / divisor;

        let above = mu.mul_add(s.mul_add(n(-114.20), n(-3.019)), s * s.mul_add(n(149.98), n(3.910)));
        let below = mu.mul_add(n(141.07), s.mul_add(n(-386.2), a.mul_add(n(16.95), n(-50.08))));
        let below = mu.mul_add(below, s.mul_add(s.mul_add(n(248.7), n(84.49)), one));
        Self { white, facet_cosine: a.mul_add(n(1.198), above) / below }
    }
    /// Returns E₅.
    #[inline(always)]
    pub fn grazing(&self) -> L {
        self.white * schlick(self.facet_cosine)
    }
    /// Returns 1 / (1 − F₀ (1 − E)).
    #[inline(always)]
    pub(super) fn series(&self, f0: L) -> L {
        L::one() / f0.neg_mul_add(L::one() - self.white, L::one())
    }
    /// Returns 1 / (1 − F₀ (1 − E)) of each channel.
    #[inline(always)]
    pub fn compensation(&self, f0: Vec3<L>) -> Vec3<L> {
        Vec3::new(self.series(f0.x), self.series(f0.y), self.series(f0.z))
    }
    /// Returns the total reflected share with Schlick's F.
    #[inline(always)]
    pub fn reflected(&self, f0: L) -> L {
        let grazing = self.grazing();
        f0.mul_add(self.white - grazing, grazing) * self.series(f0)
    }
}

/// Returns rough metal's reflectance, equal at all angles, with compensation for single scattering.
#[inline(always)]
pub fn compensated<L: Lane>(reflectance: Vec3<L>, d: Vec3<L>, n: Vec3<L>, alpha: L) -> Vec3<L> {
    reflectance * Albedo::of(ggx::cos_o(d, n), alpha).compensation(reflectance)
}

/// Returns (1 − cos)⁵.
#[inline(always)]
pub(super) fn schlick<L: Lane>(cos: L) -> L {
    let x = (L::one() - cos).max(L::zero());
    let x2 = x * x;
    x2 * x2 * x
}
