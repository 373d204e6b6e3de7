//! Materials, textures and sky flattened into aligned structure-of-arrays buffers, and the features that a
//! scene needs.
//!
//! Shading reads *row tables* ([`rows::Rows`]) of eight floats per row, each lane at its own index: rows are
//! fetched and transposed into packets in registers. [`crate::primitives`] has those of primitives.

pub(crate) mod block_means;
pub mod features;
mod mip_chain;
pub mod rows;
mod texels;

pub use features::{Features, has};
pub use texels::{Abilities, Textures};

use crate::kernel::bsdf::{metal_rough, plastic};
use crate::scene::{self, MaterialKind, Scene};
use glam::Vec3;
use rows::Rows;

/// The data of a scene that shading reads.
pub struct Buffers {
    /// The features that the scene uses.
    pub needs: Features,
    /// One row of eight per material: colour, parameter, emission, kind and texture (bits; see
    /// [`MaterialCode`]).
    pub material_rows: Rows,
    /// One row of eight per material, read if the pipeline has some of [`Features::DETAILS`]: index of
    /// refraction, mean transmittance of plastic's coat, roughness map, normal map and emission map (bits:
    /// index + 1, 0 for none), 0. For metal-rough the first two are the dielectric's reflectance at normal
    /// incidence and the metallic share.
    pub material_extra: Rows,
    /// All textures, encoded for lookups.
    pub textures: Textures,
    /// The environment, seen by rays that hit nothing.
    pub sky: Sky,
}

/// The sky in the form that shading reads.
#[derive(Clone, Copy, Debug)]
pub struct Sky {
    /// The radiance straight down, the radiance of a uniform sky, or the factor of the texture.
    pub bottom: Vec3,
    /// The radiance straight up minus `bottom`; zero without a gradient.
    pub rise: Vec3,
    /// The index of the texture, if [`Features::SKY_TEXTURE`] holds.
    pub texture: u32,
    /// The rotation of the texture in turns, which is added to u.
    pub turn: f32,
}

/// The kind and the texture of a material in one number: the kind in the lowest byte, the texture's index + 1
/// above it, 0 for none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialCode(pub u32);

impl MaterialCode {
    /// An emitter, which scatters nothing.
    pub const EMITTER: u32 = 0;
    /// A diffuse (Lambertian) surface.
    pub const DIFFUSE: u32 = 1;
    /// A perfect mirror.
    pub const MIRROR: u32 = 2;
    /// A rough metal.
    pub const GGX: u32 = 3;
    /// A smooth dielectric.
    pub const GLASS: u32 = 4;
    /// The fuzzy mirror of the thesis.
    pub const FUZZY_MIRROR: u32 = 5;
    /// A coat over a diffuse base.
    pub const PLASTIC: u32 = 6;
    /// The metallic-roughness model of glTF.
    pub const METAL_ROUGH: u32 = 7;
    /// The position of the texture index, in bits.
    pub const TEXTURE_SHIFT: u32 = 8;
    /// The mask of the kind.
    pub const KIND: u32 = 0xff;

    /// Returns the code of a material, and its parameter: alpha of GGX, plastic's coat and metal-rough, index
    /// of refraction of glass (negated: thin glass), roughness of the fuzzy mirror.
    fn of(material: &scene::Material) -> (Self, f32) {
        let (kind, parameter) = match material.kind {
            MaterialKind::Emitter => (Self::EMITTER, 0.0),
            MaterialKind::Diffuse => (Self::DIFFUSE, 0.0),
            MaterialKind::Metal { roughness: 0.0 } => (Self::MIRROR, 0.0),
            MaterialKind::Metal { roughness } => (Self::GGX, roughness * roughness),
            MaterialKind::Glass { ior } => (Self::GLASS, ior),
            MaterialKind::ThinGlass { ior } => (Self::GLASS, -ior),
            MaterialKind::FuzzyMirror { roughness } => (Self::FUZZY_MIRROR, roughness),
            MaterialKind::Plastic { roughness, .. } => (Self::PLASTIC, roughness * roughness),
            MaterialKind::MetalRough { roughness, .. } => (Self::METAL_ROUGH, roughness * roughness),
        };
        let texture = material.texture.map_or(0, |texture| texture + 1);
        (Self(kind | texture << Self::TEXTURE_SHIFT), parameter)
    }
}

impl Buffers {
    /// Flattens a scene.
    pub fn new(scene: &Scene) -> Self {
        Self {
            needs: Features::of(scene),
            material_rows: Rows::new(scene.materials.iter().map(material_row)),
            material_extra: Rows::new(scene.materials.iter().map(detail_row)),
            textures: Textures::new(&scene.textures),
            sky: Sky::new(scene.sky),
        }
    }
}

impl Sky {
    fn new(sky: scene::Sky) -> Self {
        let (bottom, rise, texture, turn) = match sky {
            scene::Sky::Color(color) => (color, Vec3::ZERO, 0, 0.0),
            scene::Sky::Gradient { bottom, top } => (bottom, top - bottom, 0, 0.0),
            scene::Sky::Texture { texture, color, turn } => (color, Vec3::ZERO, texture, turn),
        };
        Self { bottom, rise, texture, turn }
    }
}

/// Returns a row of [`Buffers::material_rows`].
fn material_row(material: &scene::Material) -> [f32; 8] {
    let (code, parameter) = MaterialCode::of(material);
    let (color, emission) = (material.color, material.emission);
    [color.x, color.y, color.z, parameter, emission.x, emission.y, emission.z, f32::from_bits(code.0)]
}

/// Returns a row of [`Buffers::material_extra`].
fn detail_row(material: &scene::Material) -> [f32; 8] {
    let (ior, transmitted) = match material.kind {
        MaterialKind::Plastic { ior, .. } => (ior, plastic::mean_transmittance(ior)),
        MaterialKind::MetalRough { metallic, ior, .. } => (metal_rough::normal_reflectance(ior), metallic),
        _ => (1.0, 1.0),
    };
    let code = |map: Option<u32>| f32::from_bits(map.map_or(0, |index| index + 1));
    let roughness_map = material.roughness_map.filter(|_| material.kind.has_roughness());
    let (normal_map, emission_map) = (code(material.normal_map), code(material.emission_map));
    [ior, transmitted, code(roughness_map), normal_map, emission_map, 0.0, 0.0, 0.0]
}
