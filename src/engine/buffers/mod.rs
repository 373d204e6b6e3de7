//! Materials, textures and sky flattened into aligned structure-of-arrays buffers, and the features that a
//! scene needs.
//!
//! Shading reads *row tables* ([`rows::Rows`]) of eight floats per row, each lane at its own index: rows are
//! fetched and transposed into packets in registers. [`crate::primitives`] has those of primitives.

pub(crate) mod block_means;
pub mod features;
mod mip_chain;
mod opacity;
pub mod rows;
mod texels;

pub use features::{Features, has};
pub use opacity::Opacities;
pub use texels::{Abilities, Textures};

use crate::kernel::bsdf::{glass_albedo, metal_rough, plastic};
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
    /// index + 1, 0 for none), 0, first row in `glass_albedo` (bits), index of refraction of glass (negated:
    /// thin glass). For metal-rough the first two are the dielectric's reflectance at normal incidence and
    /// the metallic share; for rough glass the first is the last, and the second 1.
    pub material_extra: Rows,
    /// Two rows of eight per material, if the scene needs some of [`Features::EXTENSIONS`]. The first one:
    /// transmission, absorption coefficients, 0; the second one: the dielectric's reflectance at normal
    /// incidence and at grazing angles, the share of the clear coat and its alpha, 0.
    pub material_extensions: Rows,
    /// The tables of [`glass_albedo`], one for each index of refraction.
    pub glass_albedo: Rows,
    /// The opacities of materials, if [`Features::OPACITY`] holds.
    pub opacities: Opacities,
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
    /// A rough dielectric.
    pub const ROUGH_GLASS: u32 = 8;
    /// The position of the texture index, in bits.
    pub const TEXTURE_SHIFT: u32 = 8;
    /// The mask of the kind.
    pub const KIND: u32 = 0xff;

    /// Returns the code of a material, and its parameter: alpha of GGX, plastic's coat, metal-rough and rough
    /// glass, index of refraction of glass (negated: thin glass), roughness of the fuzzy mirror.
    fn of(material: &scene::Material) -> (Self, f32) {
        let (kind, parameter) = match material.kind {
            MaterialKind::Emitter => (Self::EMITTER, 0.0),
            MaterialKind::Diffuse => (Self::DIFFUSE, 0.0),
            MaterialKind::Metal { roughness: 0.0 } => (Self::MIRROR, 0.0),
            MaterialKind::Metal { roughness } => (Self::GGX, roughness * roughness),
            MaterialKind::Glass { ior } => (Self::GLASS, ior),
            MaterialKind::ThinGlass { ior } => (Self::GLASS, -ior),
            MaterialKind::RoughGlass { roughness, .. } => (Self::ROUGH_GLASS, roughness * roughness),
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
        let glass = GlassTables::of(scene);
        let detail_row = |material: &scene::Material| detail_row(material, &glass);
        let needs = Features::of(scene);
        let extended = scene.materials.iter().filter(|_| needs.meets(Features::EXTENSIONS));
        Self {
            needs,
            material_extensions: Rows::new(extended.flat_map(extension_rows)),
            material_rows: Rows::new(scene.materials.iter().map(material_row)),
            material_extra: Rows::new(scene.materials.iter().map(detail_row)),
            glass_albedo: glass.rows(),
            opacities: Opacities::new(scene),
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
fn detail_row(material: &scene::Material, glass: &GlassTables) -> [f32; 8] {
    let (first_row, glass_ior) = glass.entry(material);
    let (ior, transmitted) = match material.kind {
        MaterialKind::RoughGlass { .. } => (glass_ior, 1.0),
        MaterialKind::Plastic { ior, .. } => (ior, plastic::mean_transmittance(ior)),
        MaterialKind::MetalRough { metallic, ior, .. } => (metal_rough::normal_reflectance(ior), metallic),
        _ => (1.0, 1.0),
    };
    let code = |map: Option<u32>| f32::from_bits(map.map_or(0, |index| index + 1));
    let roughness_map = material.roughness_map.filter(|_| material.kind.has_roughness());
    let (normal_map, emission_map) = (code(material.normal_map), code(material.emission_map));
    [
        ior,
        transmitted,
        code(roughness_map),
        normal_map,
        emission_map,
        0.0,
        f32::from_bits(first_row),
        glass_ior,
    ]
}

/// Returns the two rows of [`Buffers::material_extensions`].
fn extension_rows(material: &scene::Material) -> [[f32; 8]; 2] {
    let extras = &material.extras;
    let f0 = match material.kind {
        MaterialKind::MetalRough { ior, .. } => metal_rough::normal_reflectance(ior),
        _ => 0.0,
    };
    let [r, g, b] = (extras.specular_color * f0).min(Vec3::ONE).to_array().map(|x| x * extras.specular);
    let [red, green, blue] = extras.attenuation.map_or(Vec3::ZERO, |it| it.coefficient()).to_array();
    let coat_alpha = extras.clearcoat_roughness * extras.clearcoat_roughness;
    [
        [extras.transmission, red, green, blue, 0.0, 0.0, 0.0, 0.0],
        [r, g, b, extras.specular, extras.clearcoat, coat_alpha, 0.0, 0.0],
    ]
}

/// The tables of the albedo of the rough glass in a scene, by index of refraction, roughness, and whether a
/// map multiplies it.
struct GlassTables(Vec<(f32, f32, bool)>);

impl GlassTables {
    /// Finds the tables of all rough glass that fills its shape.
    fn of(scene: &Scene) -> Self {
        let mut tables = Vec::new();
        for table in scene.materials.iter().filter_map(Self::key) {
            if table.0 > 0.0 && !tables.contains(&table) {
                tables.push(table);
            }
        }
        Self(tables)
    }
    fn key(material: &scene::Material) -> Option<(f32, f32, bool)> {
        let (ior, roughness) = rough_glass(material)?;
        Some((ior, roughness, material.roughness_map.is_some()))
    }
    /// Returns the index of the first row of the material's table, or 0, and its index of refraction, negated
    /// for thin glass, or 1.
    fn entry(&self, material: &scene::Material) -> (u32, f32) {
        let key = Self::key(material);
        let table = self.0.iter().position(|known| Some(*known) == key).unwrap_or(0);
        ((table * glass_albedo::ROWS) as u32, key.map_or(1.0, |(ior, ..)| ior))
    }
    /// Returns the tables, one after the other.
    fn rows(&self) -> Rows {
        let table = |&(ior, roughness, is_mapped)| glass_albedo::table(ior, roughness, is_mapped);
        Rows::new(self.0.iter().map(table).flat_map(|table| table.to_vec()))
    }
}

/// Returns the index of refraction of rough glass, or of the glass in metal-rough, negated for thin glass,
/// and its roughness.
fn rough_glass(material: &scene::Material) -> Option<(f32, f32)> {
    match material.kind {
        MaterialKind::RoughGlass { roughness, ior, thin } => Some((if thin { -ior } else { ior }, roughness)),
        MaterialKind::MetalRough { roughness, ior, .. } if material.extras.transmission > 0.0 => {
            Some((if material.extras.thin { -ior } else { ior }, roughness))
        }
        _ => None,
    }
}
