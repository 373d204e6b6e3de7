//! Scattered directions towards the brightest light's border and its images in mirror spheres.
//!
//! Surfaces next to a light, and mirrors that show it, reflect nearly as much radiance as the light emits.
//! Light sampling does not find these paths, and few directions sampled by the cosine do: most of the noise
//! of indirect light comes from them. So a share of the directions that leave a diffuse surface goes there;
//! the others are sampled by the cosine. A direction's weight is its cosine over the pdf of all together,
//! which is at most 1 / (1 − the shares): a defensive mixture (T. Hesterberg, "Weighted Average Importance
//! Sampling and Defensive Mixture Distributions", Technometrics 37(2), 1995).

use super::border::Strip;
use super::bsdf::{BsdfSample, diffuse};
use super::mirror_image::{Cone, MirrorImage};
use crate::lane::{Lane, Mask};
use crate::math::{BELOW_ONE, Vec3};

/// The share of directions that go to the strip, and of those to all mirror images together: powers of two,
/// so that they are cells of Sobol points.
///
/// Strip: in the Cornell box the variance of a sample is 0.65 times as large as without; with 1/20 and 1/10
/// the same within noise, with 1/5 0.72 times. Image, in the box with spheres: 0.36 times; with 1/32 0.44,
/// with 1/8 0.36 times.
pub const SHARE: f32 = 1.0 / 16.0;

/// Where directions are guided to.
#[derive(Clone, Debug, PartialEq)]
pub struct Guiding {
    strip: Option<Strip>,
    images: Vec<MirrorImage>,
    /// The share of directions that go to each image.
    image_share: f32,
}

impl Guiding {
    /// Most images: each costs 3 % of a frame or more.
    pub const MAX_IMAGES: usize = 2;

    /// Towards these; `None` if there are none.
    ///
    /// # Panics
    /// If there are more than [`Guiding::MAX_IMAGES`] images.
    pub fn new(strip: Option<Strip>, images: Vec<MirrorImage>) -> Option<Self> {
        assert!(images.len() <= Self::MAX_IMAGES);
        let image_share = SHARE / images.len().next_power_of_two() as f32;
        (strip.is_some() || !images.is_empty()).then_some(Self { strip, images, image_share })
    }
    /// The strip around the light.
    pub fn strip(&self) -> Option<&Strip> {
        self.strip.as_ref()
    }
    /// The images of the light.
    pub fn images(&self) -> &[MirrorImage] {
        &self.images
    }

    /// A direction from `origin`, on a diffuse surface with the normal `n`, and its weight. The pdf is that
    /// of the cosine alone: the one that weights of light sampling compare with.
    ///
    /// Domain: u and v in [0, 1).
    #[inline(always)]
    pub fn sample_diffuse<L: Lane>(&self, origin: Vec3<L>, n: Vec3<L>, u: L, v: L) -> BsdfSample<L> {
        match (self.images.first_chunk::<2>(), self.images.first_chunk::<1>()) {
            (Some(images), _) => self.sample_with_two(images, origin, n, (u, v)),
            (None, Some(image)) => self.sample_with(image, origin, n, (u, v)),
            (None, None) => self.sample_with(&[], origin, n, (u, v)),
        }
    }

    /// Called, not inlined: 0.93 of the speed, and less to compile. The others are inlined.
    #[inline(never)]
    fn sample_with_two<L: Lane>(
        &self,
        images: &[MirrorImage; 2],
        origin: Vec3<L>,
        n: Vec3<L>,
        numbers: (L, L),
    ) -> BsdfSample<L> {
        self.sample_with(images, origin, n, numbers)
    }

    #[inline(always)]
    fn sample_with<L: Lane, const K: usize>(
        &self,
        images: &[MirrorImage; K],
        origin: Vec3<L>,
        n: Vec3<L>,
        (u, v): (L, L),
    ) -> BsdfSample<L> {
        let below_one = L::splat(BELOW_ONE);
        let strip_share = if self.strip.is_some() { SHARE } else { 0.0 };
        // Each target has an interval of u, the strip the first; those of images that are not seen are empty.
        // Loops: `map` of an array may not be inlined.
        let mut cones = [Cone::<L>::none(); K];
        let mut shares = [L::zero(); K];
        let mut start = L::splat(strip_share);
        for (image, (cone, share)) in images.iter().zip(cones.iter_mut().zip(&mut shares)) {
            *cone = image.cone(origin);
            *share = L::splat(self.image_share).only(cone.is_seen());
            start = start + *share;
        }
        let rest = L::one() - start;
        let scale = if K == 0 { L::splat(1.0 / (1.0 - strip_share)) } else { L::one() / rest };
        let mut wi = diffuse::sample(n, ((u - start) * scale).max(L::zero()).min(below_one), v).wi;
        if let Some(strip) = &self.strip {
            let to_strip = u.lt(L::splat(SHARE));
            if to_strip.any() {
                let towards = (strip.point(u * L::splat(1.0 / SHARE), v) - origin).normalize();
                wi = Vec3::select(to_strip, towards, wi);
            }
        }
        let mut pdf = L::zero();
        let mut end = L::splat(strip_share);
        let mut to_images = [L::Mask::splat(false); K];
        for (to_image, (cone, share)) in to_images.iter_mut().zip(cones.iter().zip(shares)) {
            let from = end;
            end = from + share;
            *to_image = from.le(u) & u.lt(end);
            if to_image.any() {
                let part = ((u - from) * L::splat(1.0 / self.image_share)).max(L::zero()).min(below_one);
                wi = Vec3::select(*to_image, cone.sample(part, v), wi);
            }
        }
        for (to_image, (cone, share)) in to_images.iter().zip(cones.iter().zip(shares)) {
            pdf = share.mul_add(cone.pdf(wi, *to_image), pdf);
        }
        let cosine = diffuse::evaluate(n, wi).pdf;
        pdf = rest.mul_add(cosine, pdf);
        if let Some(strip) = &self.strip {
            pdf = L::splat(SHARE).mul_add(strip.pdf(origin, wi), pdf);
        }
        BsdfSample { wi, weight: cosine / pdf, pdf: cosine, alive: L::zero().lt(cosine) }
    }
}
