//! Evaluates materials: parameters, textures, shading normals, and the width at which paths leave them.

use super::context::TraceContext;
use super::context::{abilities, has, is_general, reads_texels_first};
use super::queue::Path;
use crate::buffers::{Features, MaterialCode};
use crate::kernel::bsdf::layered::Layers;
use crate::kernel::bsdf::metal_rough::MetalRough;
use crate::kernel::bsdf::plastic::Plastic;
use crate::kernel::bsdf::rough_glass::RoughGlass;
use crate::kernel::bsdf::{Horizon, LobeNormals, ggx};
use crate::kernel::normals;
use crate::kernel::ray_cone::Cone;
use crate::kernel::texture::{TexturePoint, srgb_to_linear};
use crate::lane::{Bits, Lane, Mask};
use crate::math::Vec3;
use crate::primitives::Surface;
use crate::sampling::{PacketValues, dimension};
use crate::scene::TexelKind;

/// The materials of a packet of surfaces, with textures applied.
pub struct MaterialSample<L: Lane> {
    /// One of [`MaterialCode`]'s kinds.
    pub kind: L::Bits,
    pub color: Vec3<L>,
    /// The alpha of rough metal, plastic, metal-rough and rough glass, the roughness of fuzzy mirrors, or the
    /// refractive index of glass (negated: thin glass).
    pub roughness_or_ior: L,
    pub emission: Vec3<L>,
    /// Plastic's index of refraction, and the share of light that its coat transmits. For metal-rough, the
    /// dielectric's reflectance at normal incidence, and the metallic share. For rough glass, its index of
    /// refraction (negated: thin glass), and the factor of [`super::glass::resolve`].
    pub ior: L,
    pub transmitted: L,
    /// The unit shading normal on the side of the geometric one; the geometric normal itself unless
    /// `has_shading_normal`.
    pub ns: Vec3<L>,
    /// The lanes whose shading normal is interpolated or mapped.
    pub has_shading_normal: L::Mask,
    /// The interpolated normal, without the normal map; the geometric one if vertices have no normals.
    pub interpolated: Vec3<L>,
    /// The reflectances and the clear coat of metal-rough, if some material has others than metal-rough
    /// alone.
    pub layers: Option<Layers<L>>,
    /// What is left of the number that chose between the parts of a mixture; `None` if there is no mixture.
    pub choice: Option<L>,
    /// The vector from the hit to the smooth surface, if normals are interpolated: see [`normals::bulge`].
    pub bulge: Vec3<L>,
}

impl<L: Lane> MaterialSample<L> {
    /// Evaluates the materials of the lanes in `found`; the others are unspecified. With
    /// [`reads_texels_first`], colours lack their texels: [`MaterialSample::multiply_texels`].
    #[inline(always)]
    pub fn of<const N: u64>(context: &TraceContext, surface: &Surface<L>, found: L::Mask) -> Self {
        if is_general(N) {
            Self::called(context, surface, found)
        } else {
            Self::inlined::<N>(context, surface, found)
        }
    }

    #[inline(never)]
    fn called(context: &TraceContext, surface: &Surface<L>, found: L::Mask) -> Self {
        if context.buffers.needs.meets(Features::LONG_LOOKUPS) {
            Self::inlined::<{ Features::ALL.0 }>(context, surface, found)
        } else {
            Self::inlined::<{ WITHOUT_LONG_LOOKUPS.0 }>(context, surface, found)
        }
    }

    #[inline(always)]
    fn inlined<const N: u64>(context: &TraceContext, surface: &Surface<L>, found: L::Mask) -> Self {
        let fits_registers = !has(N, Features::MANY_MATERIALS);
        let index = L::Bits::select(found, surface.material, L::Bits::splat(0));
        let [r, g, b, roughness_or_ior, er, eg, eb, code] =
            context.buffers.material_rows.fetch::<L>(index, fits_registers);
        let code = code.to_bits();
        let mut material = Self {
            kind: code & L::Bits::splat(MaterialCode::KIND),
            color: Vec3::new(r, g, b),
            roughness_or_ior,
            emission: Vec3::new(er, eg, eb),
            ior: L::one(),
            transmitted: L::one(),
            ns: surface.ng,
            has_shading_normal: L::Mask::splat(false),
            interpolated: surface.ng,
            layers: None,
            choice: None,
            bulge: Vec3::zero(),
        };
        if has(N, Features::SMOOTH_NORMALS) && context.buffers.needs.contains(Features::SMOOTH_NORMALS) {
            (material.ns, material.has_shading_normal, material.bulge) =
                surface.interpolated_normal::<N>(&context.primitives, found);
            material.interpolated = material.ns;
        }
        let none = L::Bits::splat(0);
        let (mut roughness_map, mut normal_map, mut emission_map) = (none, none, none);
        if Features(N).meets(Features::DETAILS) && context.buffers.needs.meets(Features::DETAILS) {
            let [ior, transmitted, roughness, normal, emission, ..] =
                context.buffers.material_extra.fetch::<L>(index, fits_registers);
            (material.ior, material.transmitted) = (ior, transmitted);
            (roughness_map, normal_map) = (roughness.to_bits(), normal.to_bits());
            if has(N, Features::EMISSION_MAPS) {
                emission_map = emission.to_bits();
            }
        }
        if has(N, Features::LAYERS) && context.buffers.needs.contains(Features::LAYERS) {
            let second = index.shl(1) | L::Bits::splat(1);
            let [r, g, b, f90, coat, coat_alpha, ..] =
                context.buffers.material_extensions.fetch::<L>(second, false);
            material.layers = Some(Layers { f0: Vec3::new(r, g, b), f90, coat, coat_alpha });
        }
        if Features(N).meets(TEXTURED) && !reads_texels_first(N) {
            let texture = code.shr(MaterialCode::TEXTURE_SHIFT);
            let textured = found & !(texture | roughness_map | normal_map | emission_map).equals(none);
            if textured.any() {
                let at = surface.texture_point::<N>(&context.surfaces::<N>(), textured);
                material.apply_color_texture::<N>(context, at, found, texture);
                material.apply_roughness_map::<N>(context, at, found, roughness_map);
                material.apply_normal_map::<N>(context, surface, at, found, normal_map);
                material.apply_emission_map::<N>(context, at, found, emission_map);
            }
        }
        material
    }

    /// Returns the lanes of `mask` that have a lobe of this kind.
    #[inline(always)]
    pub fn has_lobe(&self, kind: u32, mask: L::Mask) -> L::Mask {
        mask & self.kind.equals(L::Bits::splat(kind))
    }
    #[inline(always)]
    pub fn plastic(&self) -> Plastic<L> {
        let Self { color, roughness_or_ior: alpha, ior, transmitted, .. } = *self;
        Plastic { color, alpha, ior, transmitted }
    }
    #[inline(always)]
    pub fn metal_rough(&self) -> MetalRough<L> {
        let Self { color, roughness_or_ior: alpha, ior: f0, transmitted: metallic, .. } = *self;
        MetalRough { color, alpha, f0, metallic }
    }

    /// Returns a random number that chooses between the lobes of the material.
    #[inline(always)]
    pub fn lobe_number(&self, numbers: &PacketValues<L>) -> L {
        self.choice.unwrap_or_else(|| numbers.get_1d(dimension::LOBE))
    }
    /// Returns rough glass seen from the side of `normals`.
    #[inline(always)]
    pub fn rough_glass(&self, normals: &FacingNormals<L>) -> RoughGlass<L> {
        let Self { roughness_or_ior: alpha, ior, transmitted: compensation, .. } = *self;
        RoughGlass { alpha, ior, compensation, outside: normals.outside, ng: normals.ng }
    }

    /// Multiplies colours by textures; `code` is index + 1, 0 for none.
    #[inline(always)]
    fn apply_color_texture<const N: u64>(
        &mut self,
        context: &TraceContext,
        at: TexturePoint<L>,
        found: L::Mask,
        code: L::Bits,
    ) {
        if !has(N, Features::TEXTURES) {
            return;
        }
        let textured = found & !code.equals(L::Bits::splat(0));
        if textured.any() {
            let texel = texel::<L, N>(context, at, textured, code, TexelKind::Color);
            self.multiply_color(texel, textured);
        }
    }

    /// Multiplies colours by texels that were already read, at the indices of [`texel_indices`].
    #[inline(always)]
    pub fn multiply_texels<const N: u64>(
        &mut self,
        context: &TraceContext,
        surface: &Surface<L>,
        found: L::Mask,
        texels: L::Bits,
    ) {
        let (_, textured) = color_textures::<L, N>(context, surface, found);
        self.multiply_color(srgb_to_linear(texels), textured);
    }

    #[inline(always)]
    fn multiply_color(&mut self, texel: Vec3<L>, textured: L::Mask) {
        let texel = Vec3::select(textured, texel, Vec3::repeat(L::one()));
        let emits = self.kind.equals(L::Bits::splat(MaterialCode::EMITTER));
        self.emission = Vec3::select(emits, self.emission * texel, self.emission);
        self.color = self.color * texel;
    }

    /// Multiplies roughness by a map: the parameter of the fuzzy mirror, the square root of every other. For
    /// metal-rough the map multiplies the metallic share, too.
    #[inline(always)]
    fn apply_roughness_map<const N: u64>(
        &mut self,
        context: &TraceContext,
        at: TexturePoint<L>,
        found: L::Mask,
        code: L::Bits,
    ) {
        let mapped = found & !code.equals(L::Bits::splat(0));
        if has(N, Features::ROUGHNESS_MAPS) && mapped.any() {
            let texel = texel::<L, N>(context, at, mapped, code, TexelKind::Data);
            let mut factor = texel.x.min(L::one());
            if has(N, Features::METAL_ROUGH) {
                let packed = mapped & self.kind.equals(L::Bits::splat(MaterialCode::METAL_ROUGH));
                factor = L::select(packed, texel.y.min(L::one()), factor);
                let metallic = self.transmitted * texel.z.min(L::one());
                self.transmitted = L::select(packed, metallic, self.transmitted);
            }
            let is_fuzzy = self.kind.equals(L::Bits::splat(MaterialCode::FUZZY_MIRROR));
            let factor = L::select(is_fuzzy, factor, factor * factor);
            self.roughness_or_ior = L::select(mapped, self.roughness_or_ior * factor, self.roughness_or_ior);
        }
    }

    /// Multiplies emission by a map.
    #[inline(always)]
    fn apply_emission_map<const N: u64>(
        &mut self,
        context: &TraceContext,
        at: TexturePoint<L>,
        found: L::Mask,
        code: L::Bits,
    ) {
        let mapped = found & !code.equals(L::Bits::splat(0));
        if has(N, Features::EMISSION_MAPS) && mapped.any() {
            let texel = texel::<L, N>(context, at, mapped, code, TexelKind::Color);
            self.emission = Vec3::select(mapped, self.emission * texel, self.emission);
        }
    }

    #[inline(always)]
    fn apply_normal_map<const N: u64>(
        &mut self,
        context: &TraceContext,
        surface: &Surface<L>,
        at: TexturePoint<L>,
        found: L::Mask,
        code: L::Bits,
    ) {
        let mapped = found & !code.equals(L::Bits::splat(0));
        if has(N, Features::NORMAL_MAPS) && mapped.any() {
            let texel = texel::<L, N>(context, at, mapped, code, TexelKind::Data);
            let (tangent, hand) = surface.tangent::<N>(&context.primitives, mapped);
            let (normal, exists) = normals::apply_normal_map(texel, self.ns, tangent, hand);
            let mapped = mapped & exists;
            self.ns = Vec3::select(mapped, normal, self.ns);
            self.has_shading_normal = self.has_shading_normal | mapped;
        }
    }
}

/// Returns the indices of the texels by which [`MaterialSample::multiply_texels`] multiplies colours; 0 in
/// lanes without texels.
#[inline(always)]
pub fn texel_indices<L: Lane, const N: u64>(
    context: &TraceContext,
    surface: &Surface<L>,
    found: L::Mask,
) -> L::Bits {
    let (code, textured) = color_textures::<L, N>(context, surface, found);
    if !textured.any() {
        return L::Bits::splat(0);
    }
    let at = surface.texture_point::<N>(&context.surfaces::<N>(), textured);
    context.buffers.textures.nearest_texels(texture_index(code), at, textured)
}

/// Returns the codes of the textures of colours, and the lanes that have one.
#[inline(always)]
fn color_textures<L: Lane, const N: u64>(
    context: &TraceContext,
    surface: &Surface<L>,
    found: L::Mask,
) -> (L::Bits, L::Mask) {
    let (fits_registers, none) = (!has(N, Features::MANY_MATERIALS), L::Bits::splat(0));
    let index = L::Bits::select(found, surface.material, none);
    let [.., code] = context.buffers.material_rows.fetch::<L>(index, fits_registers);
    let code = code.to_bits().shr(MaterialCode::TEXTURE_SHIFT);
    (code, found & !code.equals(none))
}

/// The features of the general pipeline if no texture has [`Features::LONG_LOOKUPS`].
const WITHOUT_LONG_LOOKUPS: Features = Features::ALL.without(Features::LONG_LOOKUPS);

/// The features that look up textures on surfaces.
const TEXTURED: Features = Features::TEXTURES
    .with(Features::ROUGHNESS_MAPS)
    .with(Features::NORMAL_MAPS)
    .with(Features::EMISSION_MAPS);

/// Returns the texels of the lanes in `mask`; `code` is index + 1.
#[inline(always)]
fn texel<L: Lane, const N: u64>(
    context: &TraceContext,
    at: TexturePoint<L>,
    mask: L::Mask,
    code: L::Bits,
    texel_kind: TexelKind,
) -> Vec3<L> {
    context.buffers.textures.sample(texture_index(code), at, mask, abilities(N), texel_kind)
}

/// Returns the red channel of an opacity map at a point of a surface; `code` is the map's index + 1.
#[inline(never)]
pub(super) fn opacity_texel(context: &TraceContext, surface: &Surface<f32>, code: u32) -> f32 {
    const ALL: u64 = Features::ALL.0;
    let at = surface.texture_point::<ALL>(&context.surfaces::<ALL>(), true);
    let texel = match context.buffers.needs.meets(Features::LONG_LOOKUPS) {
        true => texel::<f32, ALL>(context, at, true, code, TexelKind::Data),
        false => texel::<f32, { WITHOUT_LONG_LOOKUPS.0 }>(context, at, true, code, TexelKind::Data),
    };
    texel.x
}

/// Returns the index of a texture from its code, which is one more.
#[inline(always)]
fn texture_index<B: Bits>(code: B) -> B {
    code.wrapping_add(B::splat(u32::MAX))
}

/// Returns the cones of paths as they leave a surface; those of `is_delta` have a delta lobe. On a coated or
/// metallic-roughness surface both lobes count as the narrower one, the specular lobe.
#[inline(always)]
pub fn scattered_cone<L: Lane>(
    path: &Path<L>,
    surface: &Surface<L>,
    material: &MaterialSample<L>,
    is_delta: L::Mask,
) -> Cone<L> {
    let is = |kind: u32| material.kind.equals(L::Bits::splat(kind));
    let (zero, one) = (L::zero(), L::one());
    // If the specular lobe is a delta lobe, all other samples come from the diffuse base.
    let is_base = is(MaterialCode::DIFFUSE)
        | (!is(MaterialCode::FUZZY_MIRROR) & ggx::is_narrow(material.roughness_or_ior));
    let lobe = L::select(is_base, one, material.roughness_or_ior.min(one));
    let lobe = L::select(is_delta, zero, lobe);
    // Refraction at a sphere bends otherwise.
    let glass = is(MaterialCode::GLASS) | is(MaterialCode::ROUGH_GLASS);
    let curvature = L::select(glass, zero, surface.curvature().flip_sign(surface.facing));
    path.cone.scattered(surface.cone_width, surface.facing, curvature, lobe)
}

/// The normals of a surface, flipped to the side from which the ray arrives.
#[derive(Clone, Copy)]
pub struct FacingNormals<L: Lane> {
    /// The geometric normal, which decides sides.
    pub ng: Vec3<L>,
    /// The normals of the lobes.
    pub lobes: LobeNormals<L>,
    /// The lanes whose ray arrives at the outward side.
    pub outside: L::Mask,
}

impl<L: Lane> FacingNormals<L> {
    /// Returns the normals for rays that arrive along `d`.
    #[inline(always)]
    pub fn new<const N: u64>(d: Vec3<L>, surface: &Surface<L>, material: &MaterialSample<L>) -> Self {
        let cosine = d.dot(surface.ng);
        let ng = surface.ng.flip_sign(-cosine);
        let mut lobes = LobeNormals::flat(ng);
        let bent = material.has_shading_normal;
        if Features(N).meets(Features::SHADING_NORMALS) && bent.any() {
            let mut normal = ng;
            if has(N, Features::SMOOTH_NORMALS) {
                normal = material.interpolated.flip_sign(-cosine);
            }
            lobes = LobeNormals::bent(d, material.ns.flip_sign(-cosine), Horizon { bent, normal, ng });
        }
        Self { ng, lobes, outside: !L::zero().lt(cosine) }
    }
}
