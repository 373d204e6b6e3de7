//! Prepares glass for scattering: absorption along the segment inside, the choice between the parts of a
//! surface that is partly glass, and the light that is lost between the facets of rough glass.

use super::context::TraceContext;
use super::material::{FacingNormals, MaterialSample};
use super::queue::Path;
use crate::buffers::{Features, MaterialCode};
use crate::kernel::bsdf::albedo::Albedo;
use crate::kernel::bsdf::{ggx, glass, glass_albedo};
use crate::lane::{Bits, Lane, Mask, functions};
use crate::math::{BELOW_ONE, Vec3};
use crate::primitives::Surface;
use crate::sampling::{PacketValues, dimension};

const ALL: u64 = Features::ALL.0;

/// Multiplies the throughput of paths that hit absorbing surfaces from inside, at the distance `t`, by what
/// the segment leaves: exp(−σ t). Whether a segment is inside is known at its end, by the side that it hits;
/// objects inside the glass end segments that are not absorbed.
#[inline(never)]
pub fn attenuate<L: Lane>(
    context: &TraceContext,
    path: &mut Path<L>,
    t: L,
    surface: &Surface<L>,
    found: L::Mask,
) {
    let inside = found & L::zero().lt(path.ray.direction.dot(surface.ng));
    if !inside.any() {
        return;
    }
    let index = L::Bits::select(inside, surface.material, L::Bits::splat(0));
    let [_, red, green, blue, ..] = context.buffers.material_extensions.fetch::<L>(index.shl(1), false);
    let t = t.only(inside);
    let [red, green, blue] = [red, green, blue].map(|coefficient| functions::exp(-(coefficient * t)));
    let left = Vec3::new(red, green, blue);
    path.throughput = Vec3::select(inside, path.throughput * left, path.throughput);
}

/// Chooses between the parts of partly transmitting surfaces, and sets the factor 1 / E of
/// [`crate::kernel::bsdf::rough_glass`], in the lanes of `found`.
#[inline(never)]
pub fn resolve<L: Lane>(
    context: &TraceContext,
    (path, numbers): (&Path<L>, &PacketValues<L>),
    surface: &Surface<L>,
    material: &mut MaterialSample<L>,
    found: L::Mask,
) {
    let buffers = &context.buffers;
    let index = L::Bits::select(found, surface.material, L::Bits::splat(0));
    let metal_rough = material.has_lobe(MaterialCode::METAL_ROUGH, found);
    let [.., first_row, ior] = buffers.material_extra.fetch::<L>(index, false);
    if buffers.needs.contains(Features::TRANSMISSION) && metal_rough.any() {
        let [transmission, ..] = buffers.material_extensions.fetch::<L>(index.shl(1), false);
        let number = numbers.get_1d(dimension::LOBE);
        choose_part(material, (transmission, ior), number, metal_rough);
    }
    let rough = material.has_lobe(MaterialCode::ROUGH_GLASS, found);
    if !rough.any() {
        return;
    }
    let (d, alpha) = (path.ray.direction, material.roughness_or_ior);
    let normals = FacingNormals::new::<ALL>(d, surface, material);
    let cos = ggx::cos_o(d, normals.lobes.specular);
    let mut albedo = Albedo::of(cos, alpha).white;
    let solid = rough & !glass::is_thin(material.ior);
    if solid.any() {
        let [_, _, _, stated, ..] = buffers.material_rows.fetch::<L>(index, false);
        let cell = glass_albedo::Cell::of(cos, alpha, stated);
        let row = first_row.to_bits().wrapping_add(cell.row);
        let row = buffers.glass_albedo.fetch::<L>(L::Bits::select(solid, row, L::Bits::splat(0)), false);
        albedo = L::select(solid, cell.interpolate(row, normals.outside), albedo);
    }
    material.transmitted = L::select(rough, L::one() / albedo, material.transmitted);
}

/// Chooses between metal-rough and its glass (the lanes of `mask`), in proportion to their shares: glass has
/// the share t (1 − metallic). The rest of `number` is kept for the lobes.
#[inline(always)]
fn choose_part<L: Lane>(
    material: &mut MaterialSample<L>,
    (transmission, ior): (L, L),
    number: L,
    mask: L::Mask,
) {
    let metallic = material.transmitted;
    let share = transmission * (L::one() - metallic);
    let mixed = mask & L::zero().lt(share);
    let glass = mixed & number.lt(share);
    let least = L::splat(f32::MIN_POSITIVE);
    let rest = (L::one() - share).max(least);
    let left = L::select(glass, number / share.max(least), (number - share) / rest);
    material.choice = Some(L::select(mixed, left.max(L::zero()).min(L::splat(BELOW_ONE)), number));
    let metallic = L::select(mixed, (metallic / rest).min(L::one()), metallic);
    let code = L::Bits::splat(MaterialCode::ROUGH_GLASS);
    material.kind = L::Bits::select(glass, code, material.kind);
    material.transmitted = L::select(glass, L::one(), metallic);
    material.ior = L::select(glass, ior, material.ior);
    // Light enters and leaves glass that is not thin.
    let color = material.color;
    let root = Vec3::new(color.x.sqrt(), color.y.sqrt(), color.z.sqrt());
    material.color = Vec3::select(glass & !glass::is_thin(ior), root, color);
}
