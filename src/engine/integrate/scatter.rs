//! Scattering events: where paths go on, and how much light a surface passes on into a given direction.

use super::queue::Path;
use super::surface::{MaterialSample, Surface, has};
use crate::buffers::{Features, MaterialCode};
use crate::kernel::bsdf::plastic::Plastic;
use crate::kernel::bsdf::{self, BsdfSample, LobeEval};
use crate::kernel::normals;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Ray, Vec3};
use crate::sampling::{Numbers, random};

pub use crate::kernel::bsdf::BsdfEval;

/// The next segments of paths.
pub struct ScatteredPath<L: Lane> {
    /// The paths as they leave the surface.
    pub path: Path<L>,
    /// Those that go on.
    pub alive: L::Mask,
}

/// Draws the next segment of each path in `found`.
#[inline(always)]
pub fn scatter<L: Lane, const N: u32>(
    path: &Path<L>,
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    numbers: &Numbers,
    found: L::Mask,
) -> ScatteredPath<L> {
    let d = path.ray.direction;
    let facing = Facing::of::<N>(d, surface, material);
    let Facing { own, n, matt, outside } = facing;
    let lobe_number = || numbers.one::<L>(path.key, random::LOBE);

    let nothing = L::Mask::splat(false);
    let mut drawn = BsdfSample::<L> { direction: n, weight: L::one(), pdf: L::zero(), alive: nothing };
    let mut color = material.color;
    let mut take = |mask: L::Mask, lobe: BsdfSample<L>| {
        drawn.direction = Vec3::select(mask, lobe.direction, drawn.direction);
        drawn.weight = L::select(mask, lobe.weight, drawn.weight);
        drawn.pdf = L::select(mask, lobe.pdf, drawn.pdf);
        drawn.alive = drawn.alive | (mask & lobe.alive);
    };
    let two_numbers = || numbers.pair::<L>(path.key, random::DIRECTION);
    if has(N, Features::DIFFUSE) {
        let mask = material.has_lobe(MaterialCode::DIFFUSE, found);
        if mask.any() {
            let (u, v) = two_numbers();
            take(mask, bsdf::diffuse::sample(matt, u, v));
        }
    }
    if has(N, Features::MIRROR) {
        let mask = material.has_lobe(MaterialCode::MIRROR, found);
        if mask.any() {
            take(mask, bsdf::mirror::sample(d, n));
        }
    }
    if has(N, Features::GGX) {
        let mask = material.has_lobe(MaterialCode::GGX, found);
        if mask.any() {
            let (u, v) = two_numbers();
            take(mask, bsdf::ggx::sample(d, n, material.parameter, u, v));
        }
    }
    if has(N, Features::GLASS) {
        let mask = material.has_lobe(MaterialCode::GLASS, found);
        if mask.any() {
            take(mask, bsdf::glass::sample(d, n, outside, material.parameter, lobe_number()));
        }
    }
    if has(N, Features::SCATTER) {
        let mask = material.has_lobe(MaterialCode::SCATTER, found);
        if mask.any() {
            let (u, v) = two_numbers();
            take(mask, bsdf::scatter::sample(d, n, material.parameter, u, v));
        }
    }
    if has(N, Features::PLASTIC) {
        let mask = material.has_lobe(MaterialCode::PLASTIC, found);
        if mask.any() {
            let (lobe, weight) = material.plastic().sample(d, n, lobe_number(), two_numbers());
            take(mask, lobe);
            color = Vec3::select(mask, weight, color);
        }
    }

    if Features(N).meets(Features::SHADING_NORMALS) && material.bent.any() {
        let passes = through_glass::<L, N>(d, &facing, material, &mut drawn);
        // On the reflecting side nothing goes on below the surface.
        drawn.alive = drawn.alive & (!material.bent | passes | L::zero().lt(drawn.direction.dot(own)));
        let shadowed = material.bent & drawn.pdf.lt(L::splat(f32::INFINITY));
        let factor = facing.terminator::<N>(material, drawn.direction);
        drawn.weight = L::select(shadowed, drawn.weight * factor, drawn.weight);
    }

    let throughput = path.throughput * (color * drawn.weight);
    // A path that can carry no more light ends here. NaN goes on, to be counted at the film.
    let dark = (throughput.x + throughput.y + throughput.z).eq(L::zero());
    // Only glass is left on the far side: a reflection that rounding points a little below its surface is not, in any pipeline.
    let side = if has(N, Features::GLASS) {
        let through = surface.offset.copysign(drawn.direction.dot(own));
        L::select(material.has_lobe(MaterialCode::GLASS, found), through, surface.offset)
    } else {
        surface.offset
    };
    let ray = Ray { origin: own.mul_add(side, surface.point), direction: drawn.direction };
    let inv_pdf =
        if has(N, Features::LIGHTS) { L::one() / drawn.pdf.max(L::splat(1e-30)) } else { L::zero() };
    let path = Path { ray, throughput, inv_pdf, key: path.key, slot: path.slot };
    ScatteredPath { path, alive: drawn.alive & !dark }
}

/// What the surfaces of the lanes in `mask` pass on of the light that comes from `towards`, into the direction from which `d`
/// arrived, and the density with which [`scatter`] draws `towards`. Zero in other lanes, below the surface, and of delta lobes.
#[inline(always)]
pub fn evaluate<L: Lane, const N: u32>(
    d: Vec3<L>,
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    towards: Vec3<L>,
    mask: L::Mask,
) -> BsdfEval<L> {
    let facing = Facing::of::<N>(d, surface, material);
    let Facing { own, n, matt, .. } = facing;
    let mut passed = BsdfEval { value: Vec3::zero(), pdf: L::zero() };
    let mut take = |mask: L::Mask, lobe: BsdfEval<L>| {
        passed.value = Vec3::select(mask, lobe.value, passed.value);
        passed.pdf = L::select(mask, lobe.pdf, passed.pdf);
    };
    let colored = |LobeEval { value, pdf }: LobeEval<L>| BsdfEval { value: material.color * value, pdf };
    if has(N, Features::DIFFUSE) {
        let mask = material.has_lobe(MaterialCode::DIFFUSE, mask);
        if mask.any() {
            take(mask, colored(bsdf::diffuse::evaluate(matt, towards)));
        }
    }
    if has(N, Features::GGX) {
        let mask = material.has_lobe(MaterialCode::GGX, mask);
        if mask.any() {
            take(mask, colored(bsdf::ggx::evaluate(d, n, material.parameter, towards)));
        }
    }
    if has(N, Features::SCATTER) {
        let mask = material.has_lobe(MaterialCode::SCATTER, mask);
        if mask.any() {
            take(mask, colored(bsdf::scatter::evaluate(d, n, material.parameter, towards)));
        }
    }
    if has(N, Features::PLASTIC) {
        let mask = material.has_lobe(MaterialCode::PLASTIC, mask);
        if mask.any() {
            take(mask, material.plastic().evaluate(d, n, towards));
        }
    }
    if Features(N).meets(Features::SHADING_NORMALS) && material.bent.any() {
        let factor = facing.terminator::<N>(material, towards);
        let below = material.bent & !L::zero().lt(towards.dot(own));
        passed.value = Vec3::select(material.bent, passed.value * factor, passed.value);
        passed.value = Vec3::select(below, Vec3::zero(), passed.value);
        passed.pdf = L::select(below, L::zero(), passed.pdf);
    }
    passed
}

/// The lanes that wear a lobe for which [`evaluate`] may be above zero. What they are in other lanes than those that hit
/// something is unspecified.
#[inline(always)]
pub fn samples_lights<L: Lane>(material: &MaterialSample<L>) -> L::Mask {
    let has_lobe = |kind: u32| material.kind.equals(L::Bits::splat(kind));
    let wide = |least: f32| L::splat(least).le(material.parameter);
    has_lobe(MaterialCode::DIFFUSE)
        | has_lobe(MaterialCode::PLASTIC)
        | (has_lobe(MaterialCode::GGX) & !bsdf::ggx::is_narrow(material.parameter))
        | (has_lobe(MaterialCode::SCATTER) & wide(bsdf::scatter::NARROW))
}

/// A surface as a ray sees it. All normals are on the side from which the ray arrives.
#[derive(Clone, Copy)]
struct Facing<L: Lane> {
    /// The surface's own: decides sides.
    own: Vec3<L>,
    /// For what reflects and refracts: n · d ≤ 0.
    n: Vec3<L>,
    /// For what is matt: smooth from one triangle to the next, however steeply it is seen.
    matt: Vec3<L>,
    /// The ray arrives at the outward side.
    outside: L::Mask,
}

impl<L: Lane> Facing<L> {
    #[inline(always)]
    fn of<const N: u32>(d: Vec3<L>, surface: &Surface<L>, material: &MaterialSample<L>) -> Self {
        let along = d.dot(surface.outward);
        let own = surface.outward.flip_sign(-along);
        let (mut n, mut matt) = (own, own);
        if Features(N).meets(Features::SHADING_NORMALS) && material.bent.any() {
            matt = Vec3::select(material.bent, material.normal.flip_sign(-along), own);
            n = Vec3::select(material.bent, normals::bend(d, matt, own), own);
        }
        Self { own, n, matt, outside: !L::zero().lt(along) }
    }

    /// How much light the lobes of bent normals let pass towards `w`.
    #[inline(always)]
    fn terminator<const N: u32>(&self, material: &MaterialSample<L>, w: Vec3<L>) -> L {
        let mut normal = self.n;
        if has(N, Features::DIFFUSE) {
            let is_matt = material.kind.equals(L::Bits::splat(MaterialCode::DIFFUSE));
            normal = Vec3::select(is_matt, self.matt, normal);
        }
        normals::terminator(w, normal, self.own)
    }
}

/// The lanes with bent normals that go through glass. What a bent normal would refract without leaving the side it came from is
/// reflected instead.
#[inline(always)]
fn through_glass<L: Lane, const N: u32>(
    d: Vec3<L>,
    facing: &Facing<L>,
    material: &MaterialSample<L>,
    drawn: &mut BsdfSample<L>,
) -> L::Mask {
    if !has(N, Features::GLASS) {
        return L::Mask::splat(false);
    }
    let refracts =
        material.has_lobe(MaterialCode::GLASS, material.bent) & drawn.direction.dot(facing.n).lt(L::zero());
    let through = drawn.direction.dot(facing.own).lt(L::zero());
    let stays = refracts & !through;
    drawn.direction = Vec3::select(stays, d.reflect(facing.n), drawn.direction);
    drawn.weight = L::select(stays, L::one(), drawn.weight);
    refracts & through
}

impl<L: Lane> MaterialSample<L> {
    /// The lanes of `among` that wear this kind of material.
    #[inline(always)]
    fn has_lobe(&self, kind: u32, among: L::Mask) -> L::Mask {
        among & self.kind.equals(L::Bits::splat(kind))
    }
    #[inline(always)]
    fn plastic(&self) -> Plastic<L> {
        let Self { color, parameter: alpha, ior, transmitted, .. } = *self;
        Plastic { color, alpha, ior, transmitted }
    }
}
