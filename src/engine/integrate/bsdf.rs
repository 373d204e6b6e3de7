//! The BSDF of a surface, over all lobes that the pipeline has.

use super::context::{has, is_general};
use super::material::{FacingNormals, MaterialSample};
use super::queue::Path;
use crate::buffers::{Features, MaterialCode};
use crate::kernel::bsdf::layered::Layered;
use crate::kernel::bsdf::plastic::PlasticView;
use crate::kernel::bsdf::{self, BsdfSample, LobeNormals};
use crate::lane::{Lane, Mask};
use crate::math::{Ray, Vec3};
use crate::primitives::Surface;
use crate::sampling::{PacketValues, dimension};

/// An operation on each lobe; `mask` holds the lanes that have it. Delta lobes may be left out.
pub(super) trait LobeVisitor<L: Lane> {
    fn diffuse(&mut self, mask: L::Mask);
    #[inline(always)]
    fn mirror(&mut self, _mask: L::Mask) {}
    fn ggx(&mut self, mask: L::Mask);
    #[inline(always)]
    fn glass(&mut self, _mask: L::Mask) {}
    fn fuzzy_mirror(&mut self, mask: L::Mask);
    fn plastic(&mut self, mask: L::Mask);
    fn metal_rough(&mut self, mask: L::Mask);
    fn rough_glass(&mut self, mask: L::Mask);
}

/// Visits every lobe that the pipeline has and that some lane of `mask` has.
#[inline(always)]
pub(super) fn visit_lobes<L: Lane, const N: u64>(
    material: &MaterialSample<L>,
    mask: L::Mask,
    visitor: &mut impl LobeVisitor<L>,
) {
    macro_rules! visit {
        ($($lobe:ident => $visit:ident),*) => {$(
            if has(N, Features::$lobe) {
                let mask = material.has_lobe(MaterialCode::$lobe, mask);
                if mask.any() {
                    visitor.$visit(mask);
                }
            }
        )*};
    }
    visit!(
        DIFFUSE => diffuse,
        MIRROR => mirror,
        GGX => ggx,
        GLASS => glass,
        FUZZY_MIRROR => fuzzy_mirror,
        PLASTIC => plastic,
        METAL_ROUGH => metal_rough,
        ROUGH_GLASS => rough_glass
    );
}

/// The next segments of paths.
pub struct ScatteredPath<L: Lane> {
    /// The paths as they leave the surface.
    pub path: Path<L>,
    /// The paths that continue.
    pub alive: L::Mask,
    /// The paths that a delta lobe scattered.
    pub is_delta: L::Mask,
    /// The origins of rays to lights; for lobes other than mirrors and glass, they are the paths' origins.
    pub offset_origin: Vec3<L>,
    /// The view of plastic, for [`evaluation`](super::evaluation).
    pub plastic: PlasticView<L>,
}

/// Samples the BSDF; returns the next segment of each path in `found`.
#[inline(always)]
pub fn scatter<L: Lane, const N: u64>(
    path: &Path<L>,
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    numbers: &PacketValues<L>,
    found: L::Mask,
) -> ScatteredPath<L> {
    if is_general(N) {
        scatter_called(path, surface, material, numbers, found)
    } else {
        scatter_inlined::<L, N>(path, surface, material, numbers, found)
    }
}

#[inline(never)]
fn scatter_called<L: Lane>(
    path: &Path<L>,
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    numbers: &PacketValues<L>,
    found: L::Mask,
) -> ScatteredPath<L> {
    scatter_inlined::<L, { Features::ALL.0 }>(path, surface, material, numbers, found)
}

#[inline(always)]
fn scatter_inlined<L: Lane, const N: u64>(
    path: &Path<L>,
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    numbers: &PacketValues<L>,
    found: L::Mask,
) -> ScatteredPath<L> {
    let d = path.ray.direction;
    let normals = FacingNormals::new::<N>(d, surface, material);
    let nothing = L::Mask::splat(false);
    let offset_origin = normals.ng.mul_add(surface.offset, leaving_point::<L, N>(surface, material, nothing));
    let wi = normals.lobes.specular;
    let mut sampling = Sampling {
        d,
        numbers,
        normals: &normals,
        material,
        sample: BsdfSample { wi, weight: L::one(), pdf: L::zero(), alive: nothing },
        color: material.color,
        plastic: PlasticView::none(),
    };
    visit_lobes::<L, N>(material, found, &mut sampling);
    let Sampling { sample, color, plastic, .. } = sampling;
    let is_delta = !sample.pdf.lt(L::splat(f32::INFINITY));

    let throughput = path.throughput * (color * sample.weight);
    // A path with throughput 0 ends here. NaN goes on, to be counted at the film.
    let dark = (throughput.x + throughput.y + throughput.z).eq(L::zero());
    let ray = leave::<L, N>(surface, material, normals.ng, sample.wi, (found, is_delta));
    let inv_pdf =
        if has(N, Features::LIGHTS) { L::one() / sample.pdf.max(L::splat(1e-30)) } else { L::zero() };
    let path = Path { ray, throughput, inv_pdf, ..*path };
    ScatteredPath { path, alive: sample.alive & !dark, is_delta, offset_origin, plastic }
}

/// Returns the rays that leave a surface in the lanes of `found`; those of `is_delta` have a delta lobe.
#[inline(always)]
fn leave<L: Lane, const N: u64>(
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    ng: Vec3<L>,
    wi: Vec3<L>,
    (found, is_delta): (L::Mask, L::Mask),
) -> Ray<L> {
    // Only glass transmits to the far side. A reflection that rounding puts slightly below its surface starts
    // on the near side, in every pipeline.
    let side = if has(N, Features::GLASS) {
        let through = surface.offset.copysign(wi.dot(ng));
        let mut glass = material.has_lobe(MaterialCode::GLASS, found);
        if has(N, Features::ROUGH_GLASS) {
            glass = glass | material.has_lobe(MaterialCode::ROUGH_GLASS, found);
        }
        L::select(glass, through, surface.offset)
    } else {
        surface.offset
    };
    Ray { origin: ng.mul_add(side, leaving_point::<L, N>(surface, material, is_delta)), direction: wi }
}

/// Returns the points where rays start: the hit, or the point of the smooth surface above it, except at
/// mirrors and glass, whose images would shift.
#[inline(always)]
fn leaving_point<L: Lane, const N: u64>(
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    is_delta: L::Mask,
) -> Vec3<L> {
    if !has(N, Features::SMOOTH_NORMALS) || !material.has_shading_normal.any() {
        return surface.point;
    }
    let mut is_delta = is_delta;
    if has(N, Features::ROUGH_GLASS) {
        is_delta = material.has_lobe(MaterialCode::ROUGH_GLASS, L::Mask::splat(true)) | is_delta;
    }
    Vec3::select(is_delta, surface.point, surface.point + material.bulge)
}

/// Returns the rays that continue paths at mirrors and glass (the lanes of `found`; others are unspecified),
/// and the factors of their throughput: along the reflection, or at glass along the likelier one of
/// reflection and refraction. The mask holds refractions.
#[inline(always)]
pub fn follow_delta<L: Lane, const N: u64>(
    d: Vec3<L>,
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    found: L::Mask,
) -> (Ray<L>, Vec3<L>, L::Mask) {
    let FacingNormals { ng, lobes, outside } = FacingNormals::new::<N>(d, surface, material);
    let (mut sample, mut color) = (sample_mirror(d, &lobes), material.color);
    let glass = material.has_lobe(MaterialCode::GLASS, found);
    if glass.any() {
        let either = bsdf::glass::sample(d, &lobes, outside, material.roughness_or_ior, L::splat(0.5));
        sample.wi = Vec3::select(glass, either.wi, sample.wi);
        sample.weight = L::select(glass, either.weight, sample.weight);
        color = glass_color(material, (material.roughness_or_ior, glass), ng, sample.wi);
    }
    let refracts = glass & sample.wi.dot(ng).lt(L::zero());
    let ray = leave::<L, N>(surface, material, ng, sample.wi, (found, L::Mask::splat(true)));
    (ray, color * sample.weight, refracts)
}

#[inline(always)]
fn sample_mirror<L: Lane>(d: Vec3<L>, lobes: &LobeNormals<L>) -> BsdfSample<L> {
    lobes.raise_sample(bsdf::mirror::sample(d, lobes.specular), |_| L::zero())
}

/// Returns the colour of glass of the index `ior` (the lanes of `mask`) along `wi`: thin glass reflects
/// white.
#[inline(always)]
pub(super) fn glass_color<L: Lane>(
    material: &MaterialSample<L>,
    (ior, mask): (L, L::Mask),
    ng: Vec3<L>,
    wi: Vec3<L>,
) -> Vec3<L> {
    let white = mask & bsdf::glass::is_thin(ior) & L::zero().lt(wi.dot(ng));
    Vec3::select(white, Vec3::repeat(L::one()), material.color)
}

/// Samples each lobe in its lanes.
struct Sampling<'a, L: Lane> {
    d: Vec3<L>,
    numbers: &'a PacketValues<'a, L>,
    normals: &'a FacingNormals<L>,
    material: &'a MaterialSample<L>,
    sample: BsdfSample<L>,
    color: Vec3<L>,
    plastic: PlasticView<L>,
}

impl<L: Lane> Sampling<'_, L> {
    #[inline(always)]
    fn take(&mut self, mask: L::Mask, lobe: BsdfSample<L>) {
        let sample = &mut self.sample;
        sample.wi = Vec3::select(mask, lobe.wi, sample.wi);
        sample.weight = L::select(mask, lobe.weight, sample.weight);
        sample.pdf = L::select(mask, lobe.pdf, sample.pdf);
        sample.alive = sample.alive | (mask & lobe.alive);
    }
    /// Returns two random numbers for the direction.
    #[inline(always)]
    fn two_numbers(&self) -> (L, L) {
        self.numbers.get_2d(dimension::DIRECTION)
    }
    /// Returns a random number that chooses between reflection and transmission.
    #[inline(always)]
    fn lobe_number(&self) -> L {
        self.material.lobe_number(self.numbers)
    }
}

impl<L: Lane> LobeVisitor<L> for Sampling<'_, L> {
    #[inline(always)]
    fn diffuse(&mut self, mask: L::Mask) {
        let (u, v) = self.two_numbers();
        self.take(mask, bsdf::diffuse::sample(&self.normals.lobes, u, v));
    }
    #[inline(always)]
    fn mirror(&mut self, mask: L::Mask) {
        self.take(mask, sample_mirror(self.d, &self.normals.lobes));
    }
    #[inline(always)]
    fn ggx(&mut self, mask: L::Mask) {
        let (u, v) = self.two_numbers();
        let (d, lobes, alpha) = (self.d, &self.normals.lobes, self.material.roughness_or_ior);
        let sample = bsdf::ggx::sample(d, lobes.specular, alpha, u, v);
        let pdf = |wi| bsdf::ggx::evaluate(d, lobes.specular, alpha, wi).pdf;
        self.take(mask, lobes.raise_sample(sample, pdf));
        let color = bsdf::albedo::compensated(self.material.color, d, lobes.specular, alpha);
        self.color = Vec3::select(mask, color, self.color);
    }
    #[inline(always)]
    fn glass(&mut self, mask: L::Mask) {
        let FacingNormals { ng, lobes, outside } = self.normals;
        let (ior, number) = (self.material.roughness_or_ior, self.lobe_number());
        let sample = bsdf::glass::sample(self.d, lobes, *outside, ior, number);
        let color = glass_color(self.material, (ior, mask), *ng, sample.wi);
        self.take(mask, sample);
        self.color = Vec3::select(mask, color, self.color);
    }
    #[inline(always)]
    fn fuzzy_mirror(&mut self, mask: L::Mask) {
        let (u, v) = self.two_numbers();
        let (d, lobes, roughness) = (self.d, &self.normals.lobes, self.material.roughness_or_ior);
        let sample = bsdf::fuzzy_mirror::sample(d, lobes.specular, roughness, u, v);
        let pdf = |wi| bsdf::fuzzy_mirror::evaluate(d, lobes.specular, roughness, wi).pdf;
        self.take(mask, lobes.raise_sample(sample, pdf));
    }
    #[inline(always)]
    fn plastic(&mut self, mask: L::Mask) {
        let lobes = &self.normals.lobes;
        let (number, pair) = (self.lobe_number(), self.two_numbers());
        let plastic = self.material.plastic();
        self.plastic = plastic.view(self.d, lobes.specular);
        let (lobe, weight) = plastic.sample(&self.plastic, self.d, lobes, [number, pair.0, pair.1]);
        self.take(mask, lobe);
        self.color = Vec3::select(mask, weight, self.color);
    }
    #[inline(always)]
    fn metal_rough(&mut self, mask: L::Mask) {
        let (number, pair) = (self.lobe_number(), self.two_numbers());
        let (base, lobes) = (self.material.metal_rough(), &self.normals.lobes);
        let (lobe, weight) = match self.material.layers {
            Some(layers) => Layered { base, layers }.sample(self.d, lobes, number, pair),
            None => base.sample(self.d, lobes, number, pair),
        };
        self.take(mask, lobe);
        self.color = Vec3::select(mask, weight, self.color);
    }
    #[inline(always)]
    fn rough_glass(&mut self, mask: L::Mask) {
        let FacingNormals { ng, lobes, .. } = self.normals;
        let (number, (u, v)) = (self.lobe_number(), self.two_numbers());
        let glass = self.material.rough_glass(self.normals);
        let sample = glass.sample(self.d, lobes, [number, u, v]);
        let color = glass_color(self.material, (glass.ior, mask), *ng, sample.wi);
        self.take(mask, sample);
        self.color = Vec3::select(mask, color, self.color);
    }
}
