//! glTF materials: metallic-roughness, emission, transmission.
//!
//! For: [`Materials`], [`uv_set`].
//!
//! | glTF | octray |
//! |---|---|
//! | metallic-roughness, `KHR_materials_ior` | metal-rough |
//! | `KHR_materials_transmission` above a half | glass of that index; its colour is √ base colour, as light enters and leaves |
//! | emissive factor, texture, `KHR_materials_emissive_strength` | emission and its map |
//! | `KHR_materials_unlit` | an emitter of the base colour |
//!
//! A triangle has one pair of texture coordinates, so all textures of a material use the set and the
//! transform of its first texture; others are left out with a warning, unless they have the same.

use super::super::builder::SceneBuilder;
use super::super::error::SceneError;
use super::super::files::Files;
use super::super::json::{JsonPath, Source};
use super::super::notes::Notes;
use super::bytes::Buffer;
use super::texture::{self, Images, Reference, UvMap};
use glam::Vec3;
use gltf_json::Root;
use gltf_json::material::{AlphaMode, Material as MaterialFile};
use gltf_json::mesh::Primitive;
use gltf_json::validation::Checked;
use octray_engine::scene::{Material, MaterialKind, TexelKind};
use serde_json::{Map, Value};
use std::collections::HashMap;

/// Extensions that are read.
const KNOWN: [&str; 5] = [
    "KHR_materials_ior",
    "KHR_materials_emissive_strength",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    // Glass fills its mesh.
    "KHR_materials_volume",
];

/// A material that transmits more than this is glass.
const CLEAR: f64 = 0.5;

/// The textures of a material.
struct References {
    color: Option<Reference>,
    rough: Option<Reference>,
    normal: Option<Reference>,
    emission: Option<Reference>,
}

impl References {
    fn of(file: &MaterialFile) -> Self {
        let pbr = &file.pbr_metallic_roughness;
        Self {
            color: pbr.base_color_texture.as_ref().map(Reference::of),
            rough: pbr.metallic_roughness_texture.as_ref().map(Reference::of),
            normal: file.normal_texture.as_ref().map(|normal| {
                let extensions = normal.extensions.as_ref().map(|extensions| &extensions.others);
                Reference::new(normal.index.value(), normal.tex_coord, extensions)
            }),
            emission: file.emissive_texture.as_ref().map(Reference::of),
        }
    }
    /// The one whose texture coordinates all use.
    fn first(&self) -> Option<Reference> {
        self.color.or(self.rough).or(self.normal).or(self.emission)
    }
}

/// The set of texture coordinates that a primitive's material uses.
pub fn uv_set(primitive: &Primitive, root: &Root) -> u32 {
    let material = primitive.material.and_then(|index| root.materials.get(index.value()));
    material.and_then(|file| References::of(file).first()).map_or(0, |reference| reference.set)
}

/// What the vertices of a primitive have.
#[derive(Clone, Copy)]
pub struct Has {
    /// Texture coordinates of the set of [`uv_set`].
    pub uvs: bool,
    pub colors: bool,
}

/// A file's materials, each added to the builder once.
pub struct Materials<'a> {
    images: Images<'a>,
    added: HashMap<usize, u32>,
    default: Option<u32>,
    uv_maps: HashMap<u32, UvMap>,
}

impl<'a> Materials<'a> {
    pub fn new(source: &'a Source<'a>, root: &'a Root, buffers: &'a [Buffer], files: &'a Files) -> Self {
        let images = Images { source, root, buffers, files };
        Self { images, added: HashMap::new(), default: None, uv_maps: HashMap::new() }
    }
    /// The transform of the texture coordinates of a material in the builder.
    pub fn uv_map(&self, material: u32) -> Option<UvMap> {
        self.uv_maps.get(&material).copied()
    }

    /// The material of a primitive.
    pub fn of(
        &mut self,
        primitive: &Primitive,
        has: Has,
        place: &JsonPath,
        builder: &mut SceneBuilder,
        notes: &mut Notes,
    ) -> Result<u32, SceneError> {
        let number = match primitive.material.map(|index| index.value()) {
            None => *self.default.get_or_insert_with(|| {
                builder.add_material(plain(&MaterialFile::default(), "default".into()), 1.0)
            }),
            Some(index) => match (self.added.get(&index), self.images.root.materials.get(index)) {
                (Some(&known), _) => known,
                (None, Some(file)) => {
                    let number = self.add(index, file, builder, notes);
                    self.added.insert(index, number);
                    number
                }
                (None, None) => {
                    let what = format!("there is no material {index}");
                    let mend = "export the model again";
                    return Err(self.images.source.error(&place.key("material"), what, mend));
                }
            },
        };
        let is_textured = builder.materials[number as usize].textures().next().is_some();
        if is_textured && !has.uvs {
            notes.add(place, "a textured mesh without its texture coordinates has one texel's colour".into());
        }
        if has.colors && builder.colored(number).is_none() {
            notes.add(place, "vertex colours are left out, as the material has textures".into());
        }
        Ok(number)
    }

    fn add(
        &mut self,
        index: usize,
        file: &MaterialFile,
        builder: &mut SceneBuilder,
        notes: &mut Notes,
    ) -> u32 {
        let root = JsonPath::Root;
        let list = root.key("materials");
        let place = list.item(index);
        note_ignored(file, &place, notes);
        let name = file.name.clone().unwrap_or_else(|| format!("material {index}"));
        let mut material = plain(file, name);
        let references = References::of(file);
        let first = references.first();
        let mut load = |key: &'static str, reference: Option<Reference>, kind, slopes| {
            let (reference, first) = (reference?, first?);
            let place = place.key(key);
            if (reference.set, reference.map) != (first.set, first.map) {
                let what = "a texture is left out: its coordinates are not those of the material's first one";
                notes.add(&place, what.into());
                return None;
            }
            texture::load(&self.images, reference.texture, (kind, slopes), &place, builder, notes)
        };
        // Glass is shown without its texture.
        let is_glass = matches!(material.kind, MaterialKind::Glass { .. });
        material.texture =
            load("pbrMetallicRoughness", references.color.filter(|_| !is_glass), TexelKind::Color, None);
        if material.kind.has_roughness() {
            let rough = references.rough;
            material.roughness_map = load("pbrMetallicRoughness", rough, TexelKind::Data, None);
        }
        if material.kind != MaterialKind::Emitter {
            let scale = file.normal_texture.as_ref().map_or(1.0, |normal| normal.scale);
            let slopes = Some(scale).filter(|scale| *scale != 1.0 && scale.is_finite());
            material.normal_map = load("normalTexture", references.normal, TexelKind::Data, slopes);
            if material.emission != Vec3::ZERO {
                let emission = references.emission;
                material.emission_map = load("emissiveTexture", emission, TexelKind::Color, None);
            }
        }
        let number = builder.add_material(material, 1.0);
        self.uv_maps.insert(number, first.map(|first| first.map).unwrap_or_default());
        number
    }
}

/// A material's extension, if it has it.
fn extension<'a>(file: &'a MaterialFile, name: &str) -> Option<&'a Map<String, Value>> {
    file.extensions.as_ref()?.others.get(name)?.as_object()
}

/// A number of a material's extension; the default where either is missing.
fn number(file: &MaterialFile, name: &str, key: &str, default: f64) -> f64 {
    extension(file, name).and_then(|extension| extension.get(key)?.as_f64()).unwrap_or(default)
}

/// The material without its textures.
fn plain(file: &MaterialFile, name: String) -> Material {
    let pbr = &file.pbr_metallic_roughness;
    let fraction = |x: f32| if x.is_finite() { x.clamp(0.0, 1.0) } else { 1.0 };
    let [r, g, b, _] = pbr.base_color_factor.0.map(fraction);
    let color = Vec3::new(r, g, b);
    let strength = number(file, "KHR_materials_emissive_strength", "emissiveStrength", 1.0).clamp(0.0, 1e9);
    let emission =
        Vec3::from_array(file.emissive_factor.0.map(|x| if x.is_finite() { x.clamp(0.0, 1e9) } else { 0.0 }));
    // 0 stands for a dielectric that reflects everything.
    let ior = match number(file, "KHR_materials_ior", "ior", 1.5) {
        0.0 => 1e6,
        ior => ior.clamp(1.0, 1e6),
    } as f32;
    let transmission = number(file, "KHR_materials_transmission", "transmissionFactor", 0.0);
    let (kind, color, emission) = if extension(file, "KHR_materials_unlit").is_some() {
        (MaterialKind::Emitter, Vec3::ONE, color)
    } else if transmission > CLEAR && pbr.metallic_factor.0 < 0.5 {
        (MaterialKind::Glass { ior }, color.map(f32::sqrt), emission * strength as f32)
    } else {
        let (roughness, metallic) = (fraction(pbr.roughness_factor.0), fraction(pbr.metallic_factor.0));
        (MaterialKind::MetalRough { roughness, metallic, ior }, color, emission * strength as f32)
    };
    Material { emission, ..Material::new(name, kind, color) }
}

/// Notes what of a material is left out.
fn note_ignored(file: &MaterialFile, place: &JsonPath, notes: &mut Notes) {
    for name in file.extensions.iter().flat_map(|extensions| extensions.others.keys()) {
        if !KNOWN.contains(&name.as_str()) {
            notes.add(&place.key("extensions"), format!("`{name}` is not read"));
        }
    }
    match file.alpha_mode {
        Checked::Valid(AlphaMode::Mask) => {
            notes.add(&place.key("alphaMode"), "cut-out parts (`MASK`) are shown opaque".into());
        }
        Checked::Valid(AlphaMode::Blend) => {
            notes.add(&place.key("alphaMode"), "partly transparent parts (`BLEND`) are shown opaque".into());
        }
        Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => {}
    }
    let transmission = number(file, "KHR_materials_transmission", "transmissionFactor", 0.0);
    let extensions = place.key("extensions");
    if transmission > CLEAR {
        if file.pbr_metallic_roughness.roughness_factor.0 > 0.1 {
            notes.add(&extensions, "rough glass is shown smooth".into());
        }
        if file.pbr_metallic_roughness.base_color_texture.is_some() {
            notes.add(&extensions, "glass is shown without its texture".into());
        }
        if transmission < 1.0 {
            notes.add(&extensions, "a partly transmitting surface is shown as clear glass".into());
        }
        let has =
            |key| extension(file, "KHR_materials_volume").is_some_and(|volume| volume.contains_key(key));
        if has("attenuationDistance") {
            notes.add(&extensions, "the absorption of volumes is not read".into());
        }
    } else if transmission > 0.0 {
        notes.add(&extensions, "a partly transmitting surface is shown opaque".into());
    }
    if extension(file, "KHR_materials_transmission").is_some_and(|it| it.contains_key("transmissionTexture"))
    {
        notes.add(&extensions, "the texture of transmission is not read".into());
    }
}
