//! Evaluates the BSDF of a surface for directions that next event estimation samples.

use super::bsdf::{LobeVisitor, glass_color, visit_lobes};
use super::context::has;
use super::material::{FacingNormals, MaterialSample};
use crate::buffers::{Features, MaterialCode};
use crate::kernel::bsdf::layered::Layered;
use crate::kernel::bsdf::plastic::PlasticView;
use crate::kernel::bsdf::rough_glass::RoughGlass;
use crate::kernel::bsdf::{self, BsdfEval, LobeEval, LobeNormals};
use crate::lane::{Bits, Lane};
use crate::math::Vec3;
use crate::primitives::Surface;

/// Returns the value of the BSDF, cosine included, for light that arrives from `towards` and leaves against
/// `d`, and the pdf with which [`super::bsdf::scatter`] samples `towards`. Both are zero outside `mask`,
/// below the surface, and for delta lobes. `plastic` is that of [`super::bsdf::ScatteredPath`] at this
/// surface.
#[inline(always)]
pub fn evaluate<L: Lane, const N: u64>(
    d: Vec3<L>,
    surface: &Surface<L>,
    (material, plastic): (&MaterialSample<L>, &PlasticView<L>),
    towards: Vec3<L>,
    mask: L::Mask,
) -> BsdfEval<L> {
    let normals = FacingNormals::new::<N>(d, surface, material);
    let eval = BsdfEval { value: Vec3::zero(), pdf: L::zero() };
    let (lobes, normals) = (&normals.lobes, &normals);
    let mut evaluation = Evaluation { d, towards, lobes, normals, material, plastic, eval };
    visit_lobes::<L, N>(material, mask, &mut evaluation);
    evaluation.eval
}

/// Evaluates each lobe in its lanes.
struct Evaluation<'a, L: Lane> {
    d: Vec3<L>,
    towards: Vec3<L>,
    lobes: &'a LobeNormals<L>,
    normals: &'a FacingNormals<L>,
    material: &'a MaterialSample<L>,
    plastic: &'a PlasticView<L>,
    eval: BsdfEval<L>,
}

impl<L: Lane> Evaluation<'_, L> {
    #[inline(always)]
    fn take(&mut self, mask: L::Mask, lobe: BsdfEval<L>) {
        self.eval.value = Vec3::select(mask, lobe.value, self.eval.value);
        self.eval.pdf = L::select(mask, lobe.pdf, self.eval.pdf);
    }
    /// Evaluates a lobe by [`LobeNormals::fold`].
    #[inline(always)]
    fn take_folded(&mut self, mask: L::Mask, color: Vec3<L>, lobe: impl Fn(Vec3<L>) -> LobeEval<L>) {
        let colored = |wi, _| {
            let LobeEval { value, pdf } = lobe(wi);
            BsdfEval { value: color * value, pdf }
        };
        self.take(mask, self.lobes.fold(self.towards, Vec3::zero(), colored));
    }
}

impl<L: Lane> LobeVisitor<L> for Evaluation<'_, L> {
    #[inline(always)]
    fn diffuse(&mut self, mask: L::Mask) {
        let LobeEval { value, pdf } = bsdf::diffuse::evaluate(self.lobes, self.towards);
        self.take(mask, BsdfEval { value: self.material.color * value, pdf });
    }
    #[inline(always)]
    fn ggx(&mut self, mask: L::Mask) {
        let (d, n, alpha) = (self.d, self.lobes.specular, self.material.roughness_or_ior);
        let color = bsdf::albedo::compensated(self.material.color, d, n, alpha);
        self.take_folded(mask, color, |wi| bsdf::ggx::evaluate(d, n, alpha, wi));
    }
    #[inline(always)]
    fn fuzzy_mirror(&mut self, mask: L::Mask) {
        let (d, n, roughness) = (self.d, self.lobes.specular, self.material.roughness_or_ior);
        let lobe = |wi| bsdf::fuzzy_mirror::evaluate(d, n, roughness, wi);
        self.take_folded(mask, self.material.color, lobe);
    }
    #[inline(always)]
    fn plastic(&mut self, mask: L::Mask) {
        let plastic = self.material.plastic();
        self.take(mask, plastic.evaluate(self.plastic, self.d, self.lobes, self.towards));
    }
    #[inline(always)]
    fn metal_rough(&mut self, mask: L::Mask) {
        let base = self.material.metal_rough();
        let eval = match self.material.layers {
            Some(layers) => Layered { base, layers }.evaluate(self.d, self.lobes, self.towards),
            None => base.evaluate(self.d, self.lobes, self.towards),
        };
        self.take(mask, eval);
    }
    #[inline(always)]
    fn rough_glass(&mut self, mask: L::Mask) {
        let glass = self.material.rough_glass(self.normals);
        let LobeEval { value, pdf } = glass.evaluate(self.d, self.lobes, self.towards);
        let color = glass_color(self.material, (glass.ior, mask), self.normals.ng, self.towards);
        self.take(mask, BsdfEval { value: color * value, pdf });
    }
}

/// Returns the lanes with a lobe that is worth light sampling, which is neither a delta lobe nor too narrow;
/// unspecified in lanes that hit nothing.
#[inline(always)]
pub fn has_sampled_lobe<L: Lane, const N: u64>(material: &MaterialSample<L>) -> L::Mask {
    let has_lobe = |kind: u32| material.kind.equals(L::Bits::splat(kind));
    let wide = |least: f32| L::splat(least).le(material.roughness_or_ior);
    let mut sampled = has_lobe(MaterialCode::DIFFUSE)
        | has_lobe(MaterialCode::PLASTIC)
        | (has_lobe(MaterialCode::GGX) & !bsdf::ggx::is_narrow(material.roughness_or_ior))
        | (has_lobe(MaterialCode::FUZZY_MIRROR) & wide(bsdf::fuzzy_mirror::NARROW));
    if has(N, Features::METAL_ROUGH) {
        sampled = sampled | has_lobe(MaterialCode::METAL_ROUGH);
    }
    if has(N, Features::ROUGH_GLASS) {
        let narrow = RoughGlass::is_narrow(material.roughness_or_ior, material.ior);
        sampled = sampled | (has_lobe(MaterialCode::ROUGH_GLASS) & !narrow);
    }
    sampled
}
