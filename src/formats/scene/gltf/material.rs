//! glTF materials: metallic-roughness, emission, transmission.
//!
//! For: [`Materials`], [`uv_set`].
//!
//! | glTF | octray |
//! |---|---|
//! | metallic-roughness, `KHR_materials_ior` | metal-rough |
//! | `KHR_materials_transmission` above a half | thin glass of that index and the base colour |
//! | the same with a thickness in `KHR_materials_volume` | glass; its colour is √ base colour, as light enters and leaves |
//! | emissive factor, texture, `KHR_materials_emissive_strength` | emission and its map |
//! | `KHR_materials_unlit` | an emitter of the base colour |
//!
//! A triangle has one pair of texture coordinates, so all textures of a material use the set and the
//! transform of its first texture; others are left out with a warning, unless they have the same.

use super::super::builder::SceneBuilder;
use super::super::error::SceneError;
use super::super::json::JsonPath;
use super::super::notes::Notes;
use super::bytes::{Document, broken};
use super::texture::{self, Reference, UvMap};
use glam::Vec3;
use gltf_json::Root;
use gltf_json::material::{AlphaMode, Material as MaterialFile};
use gltf_json::mesh::Primitive;
use gltf_json::validation::Checked;
use octray_engine::scene::{Material, MaterialKind, TexelKind};
use serde_json::{Map, Value};
use std::collections::HashMap;

/// A material that transmits more than this is glass.
const CLEAR: f64 = 0.5;

const TRANSMISSION: &str = "KHR_materials_transmission";
const VOLUME: &str = "KHR_materials_volume";

/// The textures of a material: of colour, of roughness and metallic, of normals, of emission.
fn references(file: &MaterialFile) -> [Option<Reference>; 4] {
    let pbr = &file.pbr_metallic_roughness;
    [
        pbr.base_color_texture.as_ref().map(Reference::of),
        pbr.metallic_roughness_texture.as_ref().map(Reference::of),
        file.normal_texture.as_ref().map(|normal| {
            let extensions = normal.extensions.as_ref().map(|extensions| &extensions.others);
            Reference::new(normal.index.value(), normal.tex_coord, extensions)
        }),
        file.emissive_texture.as_ref().map(Reference::of),
    ]
}

/// The set of texture coordinates that a primitive's material uses.
pub fn uv_set(primitive: &Primitive, root: &Root) -> u32 {
    let material = primitive.material.and_then(|index| root.materials.get(index.value()));
    let first = material.and_then(|file| references(file).into_iter().flatten().next());
    first.map_or(0, |first| first.set)
}

/// A file's materials, each added to the builder once.
pub struct Materials<'a> {
    document: &'a Document<'a>,
    /// By the index in the file; `None` is the default material.
    added: HashMap<Option<usize>, Added>,
}

/// A material in the builder.
#[derive(Clone, Copy)]
pub struct Added {
    pub number: u32,
    /// The transform of texture coordinates on its triangles.
    pub uv_map: UvMap,
}

impl<'a> Materials<'a> {
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { document, added: HashMap::new() }
    }

    /// The material of a primitive.
    pub fn of(
        &mut self,
        primitive: &Primitive,
        place: &JsonPath,
        builder: &mut SceneBuilder,
    ) -> Result<Added, SceneError> {
        let index = primitive.material.map(|index| index.value());
        if let Some(&known) = self.added.get(&index) {
            return Ok(known);
        }
        let added = match index.map(|index| (index, self.document.root.materials.get(index))) {
            None => {
                let material = plain(&MaterialFile::default(), "default".into());
                Added { number: builder.add_material(material, 1.0), uv_map: UvMap::default() }
            }
            Some((index, Some(file))) => self.add(index, file, builder),
            Some((index, None)) => {
                return Err(broken(&place.key("material"), format!("there is no material {index}")));
            }
        };
        self.added.insert(index, added);
        Ok(added)
    }

    fn add(&self, index: usize, file: &MaterialFile, builder: &mut SceneBuilder) -> Added {
        let list = self.document.source.root();
        let list = list.key("materials");
        let place = list.item(index);
        let name = file.name.clone().unwrap_or_else(|| format!("material {index}"));
        let mut material = plain(file, name);
        note_ignored(file, material.kind, &place, &mut builder.notes);
        let references = references(file);
        let first = references.into_iter().flatten().next();
        let [color, rough, normal, emission] = references;
        let mut load = |key: &'static str, reference: Option<Reference>, kind, slopes| {
            let (reference, first) = (reference?, first?);
            let place = place.key(key);
            if (reference.set, reference.map) != (first.set, first.map) {
                let what = "a texture is left out: its coordinates are not those of the material's first one";
                builder.notes.add(&place, what);
                return None;
            }
            texture::load(self.document, reference.texture, kind, slopes, &place, builder)
        };
        // Its colour is not that of the texture, but the square root.
        let is_glass = matches!(material.kind, MaterialKind::Glass { .. });
        material.texture = load("pbrMetallicRoughness", color.filter(|_| !is_glass), TexelKind::Color, None);
        if material.kind.has_roughness() {
            material.roughness_map = load("pbrMetallicRoughness", rough, TexelKind::Data, None);
        }
        if material.kind != MaterialKind::Emitter {
            let scale = file.normal_texture.as_ref().map_or(1.0, |normal| normal.scale);
            let slopes = Some(scale).filter(|scale| *scale != 1.0 && scale.is_finite());
            material.normal_map = load("normalTexture", normal, TexelKind::Data, slopes);
            if material.emits() {
                material.emission_map = load("emissiveTexture", emission, TexelKind::Color, None);
            }
        }
        let uv_map = first.map(|first| first.map).unwrap_or_default();
        Added { number: builder.add_material(material, 1.0), uv_map }
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
    let is_solid = number(file, VOLUME, "thicknessFactor", 0.0) > 0.0;
    let emitted = emission * strength as f32;
    let (kind, color, emission) = if extension(file, "KHR_materials_unlit").is_some() {
        (MaterialKind::Emitter, Vec3::ONE, color)
    } else if transmission(file) > CLEAR {
        match is_solid {
            true => (MaterialKind::Glass { ior }, color.map(f32::sqrt), emitted),
            false => (MaterialKind::ThinGlass { ior }, color, emitted),
        }
    } else {
        let (roughness, metallic) = (fraction(pbr.roughness_factor.0), fraction(pbr.metallic_factor.0));
        (MaterialKind::MetalRough { roughness, metallic, ior }, color, emitted)
    };
    Material { emission, ..Material::new(name, kind, color) }
}

/// The share of light that the material transmits instead of scattering it below its surface.
fn transmission(file: &MaterialFile) -> f64 {
    let metallic = f64::from(file.pbr_metallic_roughness.metallic_factor.0);
    number(file, TRANSMISSION, "transmissionFactor", 0.0) * (1.0 - metallic)
}

/// Notes what of a material is left out.
fn note_ignored(file: &MaterialFile, kind: MaterialKind, place: &JsonPath, notes: &mut Notes) {
    match file.alpha_mode {
        Checked::Valid(AlphaMode::Mask) => {
            notes.add(&place.key("alphaMode"), "cut-out parts (`MASK`) are shown opaque");
        }
        Checked::Valid(AlphaMode::Blend) => {
            notes.add(&place.key("alphaMode"), "partly transparent parts (`BLEND`) are shown opaque");
        }
        Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => {}
    }
    // Of an unlit material the standard ignores the rest too.
    if kind == MaterialKind::Emitter {
        return;
    }
    if file.occlusion_texture.is_some() {
        notes.add(&place.key("occlusionTexture"), "occlusion is left out: paths find it themselves");
    }
    let (pbr, extensions) = (&file.pbr_metallic_roughness, place.key("extensions"));
    let transmission = transmission(file);
    let has = |name, key| extension(file, name).is_some_and(|extension| extension.contains_key(key));
    let is_thin = matches!(kind, MaterialKind::ThinGlass { .. });
    let is_glass = is_thin || matches!(kind, MaterialKind::Glass { .. });
    for (is_ignored, what) in [
        (is_glass && pbr.roughness_factor.0 > 0.0, "rough glass is shown smooth"),
        (
            is_glass && !is_thin && pbr.base_color_texture.is_some(),
            "glass that fills its mesh is shown without its texture",
        ),
        (is_glass && transmission < 1.0, "a partly transmitting surface is shown as clear glass"),
        (is_glass && !is_thin && has(VOLUME, "attenuationDistance"), "the absorption of volumes is not read"),
        (!is_glass && transmission > 0.0, "a partly transmitting surface is shown opaque"),
        (has(TRANSMISSION, "transmissionTexture"), "the texture of transmission is not read"),
    ] {
        if is_ignored {
            notes.add(&extensions, what);
        }
    }
}
