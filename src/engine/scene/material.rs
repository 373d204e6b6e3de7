//! Materials.

use super::texture::{Texture, Wrap};
use crate::math::portable;
use glam::Vec3;

/// The way in which a surface scatters and emits light.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name given by the user.
    pub name: String,
    /// The BSDF and its parameters.
    pub kind: MaterialKind,
    /// The reflectance, each channel in [0, 1]; the transmittance of glass.
    pub color: Vec3,
    /// The texture that multiplies `color` or, for an [`MaterialKind::Emitter`], `emission`.
    pub texture: Option<u32>,
    /// The map whose red channel, linear and at most 1, multiplies the roughness of kinds that have one. For
    /// [`MaterialKind::MetalRough`] its green channel multiplies the roughness and its blue one the metallic
    /// share, as glTF packs them.
    pub roughness_map: Option<u32>,
    /// The map of normals in tangent space, in OpenGL's convention: x = 2 red − 1 along growing u, y = 2
    /// green − 1 along growing v (up), z = 2 blue − 1 along the outward normal. From behind, the surface
    /// shows the back of the same relief.
    pub normal_map: Option<u32>,
    /// The emitted radiance, equal in every direction and on both sides; each channel ≥ 0.
    pub emission: Vec3,
    /// The map that multiplies `emission`; none for an [`MaterialKind::Emitter`], whose `texture` does.
    pub emission_map: Option<u32>,
    /// Parameters that few materials have.
    pub extras: MaterialExtras,
    /// The share of rays that the surface stops, in [0, 1]; the others go straight through and do not see it.
    /// It applies to every kind, and to emission.
    pub opacity: f32,
    /// The map whose red channel, linear and at most 1, multiplies `opacity`.
    pub opacity_map: Option<u32>,
    /// The least product of `opacity` and `opacity_map` that is opaque; below it, nothing is there. `None`
    /// blends. Without a map it is not read.
    pub alpha_cutoff: Option<f32>,
}

/// The parameters of glTF's extensions of materials. All but `attenuation` are of
/// [`MaterialKind::MetalRough`].
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialExtras {
    /// The share, in [0, 1], of the dielectric that is glass of the same roughness and index, instead of its
    /// diffuse base: thin glass of `color`, or else glass that tints light by the root of `color` where it
    /// enters and where it leaves.
    pub transmission: f32,
    /// Whether that glass is thin.
    pub thin: bool,
    /// The absorption of the glass that the surface encloses; none if it is thin or emits.
    pub attenuation: Option<Attenuation>,
    /// The factor of the dielectric's reflectance, in [0, 1].
    pub specular: f32,
    /// The tint of the dielectric's reflectance at normal incidence, which stays at most 1; each channel ≥ 0.
    pub specular_color: Vec3,
    /// The share of the surface under a clear coat of the index 1.5, in [0, 1].
    pub clearcoat: f32,
    /// The roughness of the clear coat, in [0, 1].
    pub clearcoat_roughness: f32,
}

impl Default for MaterialExtras {
    fn default() -> Self {
        let (specular, specular_color) = (1.0, Vec3::ONE);
        let (clearcoat, clearcoat_roughness) = (0.0, 0.0);
        let (transmission, thin, attenuation) = (0.0, false, None);
        Self { transmission, thin, attenuation, specular, specular_color, clearcoat, clearcoat_roughness }
    }
}

impl MaterialExtras {
    /// Tests whether the reflection differs from that of metal-rough alone.
    pub fn reflects_otherwise(&self) -> bool {
        self.specular != 1.0 || self.specular_color != Vec3::ONE || self.clearcoat > 0.0
    }
}

/// The absorption of a volume (Beer and Lambert): `color`, each channel in [0, 1], is what is left of white
/// light after `distance` > 0 in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // The text above explains both.
pub struct Attenuation {
    pub color: Vec3,
    pub distance: f32,
}

impl Attenuation {
    /// Returns the absorption coefficient σ of each channel: exp(−σ t) is left after the distance t. A
    /// channel of 0 counts as 10⁻⁶.
    pub fn coefficient(&self) -> Vec3 {
        self.color.map(|x| (-portable::log(f64::from(x).max(1e-6)) / f64::from(self.distance)) as f32)
    }
}

impl Material {
    /// Creates a material that has no textures and emits nothing.
    pub fn new(name: impl Into<String>, kind: MaterialKind, color: Vec3) -> Self {
        Self {
            name: name.into(),
            kind,
            color,
            texture: None,
            roughness_map: None,
            normal_map: None,
            emission: Vec3::ZERO,
            emission_map: None,
            extras: MaterialExtras::default(),
            opacity: 1.0,
            opacity_map: None,
            alpha_cutoff: None,
        }
    }
    /// Tests whether the material emits light.
    pub fn emits(&self) -> bool {
        self.emission != Vec3::ZERO
    }
    /// Tests whether all textures of the material, which are in this list, repeat in both directions.
    pub fn repeats(&self, textures: &[Texture]) -> bool {
        self.textures().all(|index| textures[index as usize].wrap == [Wrap::Repeat; 2])
    }
    /// Tests whether light goes through the surface.
    pub fn is_clear(&self) -> bool {
        use MaterialKind::{Glass, RoughGlass, ThinGlass};
        matches!(self.kind, Glass { .. } | ThinGlass { .. } | RoughGlass { .. })
            || self.extras.transmission > 0.0
    }
    /// Tests whether every ray that hits the surface is stopped.
    pub fn is_opaque(&self) -> bool {
        match (self.opacity_map, self.alpha_cutoff) {
            (None, _) => self.opacity >= 1.0,
            (Some(_), cutoff) => cutoff.is_some_and(|cutoff| cutoff <= 0.0),
        }
    }
    /// Iterates over all textures of the material.
    pub fn textures(&self) -> impl Iterator<Item = u32> {
        let Self { texture, roughness_map, normal_map, emission_map, opacity_map, .. } = *self;
        [texture, roughness_map, normal_map, emission_map, opacity_map].into_iter().flatten()
    }
}

impl MaterialKind {
    /// Tests whether a roughness map changes this kind.
    pub fn has_roughness(self) -> bool {
        match self {
            Self::Metal { roughness } | Self::Plastic { roughness, .. } | Self::FuzzyMirror { roughness } => {
                roughness > 0.0
            }
            Self::RoughGlass { roughness, .. } => roughness > 0.0,
            // The map holds the metallic share too.
            Self::MetalRough { .. } => true,
            Self::Diffuse | Self::Glass { .. } | Self::ThinGlass { .. } | Self::Emitter => false,
        }
    }
}

/// The BSDF of a material and its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // The variants' text explains their fields.
pub enum MaterialKind {
    /// A diffuse (Lambertian) surface.
    Diffuse,
    /// GGX with alpha = roughness², reflectance `color` at every angle; a mirror at roughness 0. Roughness in
    /// [0, 1].
    Metal { roughness: f32 },
    /// Smooth dielectric with the index of refraction `ior` > 0 inside and vacuum outside; `color` scales
    /// transmission and reflection.
    Glass { ior: f32 },
    /// A pane of glass without thickness, which reflects as both its surfaces together, and transmits the
    /// rest, times `color`, straight on. `ior` > 0.
    ThinGlass { ior: f32 },
    /// Glass of GGX facets with alpha = roughness². Each facet of a `thin` pane reflects as thin glass, and
    /// its transmitted light is scattered as much as the reflected one. Roughness in (0, 1], `ior` > 0.
    RoughGlass { roughness: f32, ior: f32, thin: bool },
    /// The fuzzy mirror, the lobe of the thesis: direction = normalize(reflected + roughness · u), u uniform
    /// on the unit sphere; absorbed if it points below the surface. Roughness ≥ 0.
    FuzzyMirror { roughness: f32 },
    /// A dielectric coat of index `ior` over a diffuse base of reflectance `color`: GGX with alpha =
    /// roughness², smooth at roughness 0. Roughness in [0, 1], `ior` in [1, 3].
    Plastic { roughness: f32, ior: f32 },
    /// The metallic-roughness model of glTF 2.0: between a metal (`metallic` 1) whose reflectance at normal
    /// incidence is `color`, and a dielectric (0) of index `ior` with a diffuse base of `color`; GGX with
    /// alpha = roughness², reflectance by Schlick. Roughness and `metallic` in [0, 1], `ior` ≥ 1.
    MetalRough { roughness: f32, metallic: f32, ior: f32 },
    /// A surface that emits light and scatters none.
    Emitter,
}
