//! Converts glTF materials: metallic-roughness, emission, transmission.
//!
//! | glTF | octray |
//! |---|---|
//! | metallic-roughness, `KHR_materials_ior` | metal-rough |
//! | `KHR_materials_transmission` of 1, of no metal, without textures that vary it | thin glass, smooth or rough, of that index and the base colour |
//! | also a thickness in `KHR_materials_volume` | glass; its colour is √ base colour, as light enters and leaves |
//! | other `KHR_materials_transmission` | metal-rough that is partly such glass |
//! | attenuation in `KHR_materials_volume` | attenuation |
//! | `KHR_materials_specular`, `KHR_materials_clearcoat` | those of metal-rough |
//! | emissive factor, texture, `KHR_materials_emissive_strength` | emission and its map |
//! | `KHR_materials_unlit` | an emitter of the base colour |
//! | `alphaMode` `BLEND`, `MASK` | opacity: base colour factor and texture; a cutoff |
//!
//! A vertex has one pair of texture coordinates, so all textures of a material use the set and the transform
//! of its first texture. Textures with others are left out with a warning.

use super::super::builder::SceneBuilder;
use super::super::error::SceneError;
use super::super::json::JsonPath;
use super::super::notes::Notes;
use super::bytes::Document;
use super::ranges::within_ranges;
use super::schema::{Material as MaterialFile, Primitive, Root, TextureInfo, TextureTransform};
use super::texture::{self, Range};
use glam::Vec3;
use octray_engine::scene::{Attenuation, Material, MaterialExtras, MaterialKind, TexelKind};
use std::collections::HashMap;

/// Returns the textures of a material: those of colour, of roughness and metallic, of normals, of emission.
fn textures(file: &MaterialFile) -> [Option<&TextureInfo>; 4] {
    let pbr = &file.pbr_metallic_roughness;
    let [color, rough] = [&pbr.base_color_texture, &pbr.metallic_roughness_texture];
    [color, rough, &file.normal_texture, &file.emissive_texture].map(Option::as_ref)
}

/// Returns the set of texture coordinates that a primitive's material uses, if it has textures.
pub fn uv_set(primitive: &Primitive, root: &Root) -> Option<usize> {
    let file = root.materials.get(primitive.material?.0)?;
    textures(file).into_iter().flatten().next().map(|first| first.mapping().0)
}

/// A file's materials, each added to the builder once.
pub struct Materials<'a> {
    document: &'a Document<'a>,
    /// The added materials by their indices in the file; `None` is the default material.
    added: HashMap<Option<usize>, Added>,
    /// The ranges of images that determine the kind of a whole material, by their indices.
    ranges: HashMap<Option<usize>, Option<[Range; 3]>>,
}

/// A material in the builder.
#[derive(Clone, Copy)]
pub struct Added {
    pub number: u32,
    /// The transform of texture coordinates on its triangles.
    pub uv_map: TextureTransform,
}

/// The transmission of a whole surface.
#[derive(Default)]
struct Transmission {
    /// The mean share of light below a surface of no metal that is transmitted and not scattered.
    share: f64,
    /// The part of `share` that metal leaves.
    clear: f64,
    /// Whether its texture varies the share.
    varies: bool,
    /// Whether all of the surface is glass of one roughness.
    is_glass: bool,
    /// Whether it is thick anywhere.
    is_volume: bool,
}

impl<'a> Materials<'a> {
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { document, added: HashMap::new(), ranges: HashMap::new() }
    }

    /// Returns the material of a primitive, after adding it at its first use.
    pub fn get(
        &mut self,
        primitive: &Primitive,
        place: &JsonPath,
        builder: &mut SceneBuilder,
    ) -> Result<Added, SceneError> {
        let index = primitive.material.map(|index| index.0);
        if let Some(&known) = self.added.get(&index) {
            return Ok(known);
        }
        let document = self.document;
        let added = match index {
            None => {
                let material = plain(&MaterialFile::default(), "default".into(), &Transmission::default());
                Added { number: builder.add_material(material, 1.0), uv_map: TextureTransform::default() }
            }
            Some(index) => {
                let list = &document.root.materials;
                let file = document.get(list, "materials", index, &place.key("material"))?;
                self.add(index, file, builder)
            }
        };
        self.added.insert(index, added);
        Ok(added)
    }

    /// Computes a material's transmission from its factors and textures.
    fn transmission(
        &mut self,
        file: &MaterialFile,
        place: &JsonPath,
        builder: &mut SceneBuilder,
    ) -> Transmission {
        let (pbr, extension) = (&file.pbr_metallic_roughness, &file.extensions.transmission);
        if extension.transmission_factor <= 0.0 {
            return Transmission::default();
        }
        let mut ranges = |info: &Option<TextureInfo>| {
            let texture = info.as_ref()?.index.0;
            let image = self.document.root.textures.get(texture).and_then(|file| file.image());
            let read = || texture::ranges(self.document, texture, place, builder);
            *self.ranges.entry(image).or_insert_with(read)
        };
        let [_, rough, metal] = ranges(&pbr.metallic_roughness_texture).unwrap_or([[1.0; 3]; 3]);
        let [clear, ..] = ranges(&extension.transmission_texture).unwrap_or([[1.0; 3]; 3]);
        let volume = &file.extensions.volume;
        let [_, thick, _] = ranges(&volume.thickness_texture).unwrap_or([[1.0; 3]; 3]);
        let metal = metal.map(|texel| texel * pbr.metallic_factor.unwrap_or(1.0));
        let is_volume = thick[2] * volume.thickness_factor > 0.0;
        let share = extension.transmission_factor * clear[1];
        // The colour of glass that fills its mesh is the root of the base colour, which no texture here can
        // be, and its roughness map has another channel.
        let varies_glass = (is_volume && pbr.base_color_texture.is_some())
            || (pbr.metallic_roughness_texture.is_some()
                && rough[2] * pbr.roughness_factor.unwrap_or(1.0) > 0.0);
        let clear_share = share * (1.0 - metal[1]);
        Transmission {
            share: if clear_share > 0.0 { share } else { 0.0 },
            clear: clear_share,
            varies: clear[0] < clear[2],
            is_glass: clear_share >= 1.0 && metal[2] <= 0.0 && !varies_glass,
            is_volume,
        }
    }

    fn add(&mut self, index: usize, file: &MaterialFile, builder: &mut SceneBuilder) -> Added {
        let list = self.document.source.root();
        let list = list.key("materials");
        let place = list.item(index);
        let file = &within_ranges(file, &place, &mut builder.notes);
        let name = file.name.0.clone().unwrap_or_else(|| format!("material {index}"));
        let transmission = self.transmission(file, &place, builder);
        let mut material = plain(file, name, &transmission);
        note_ignored(file, material.kind, &transmission, &place, &mut builder.notes);
        let textures = textures(file);
        let mapping = textures.into_iter().flatten().next().map(TextureInfo::mapping);
        let [color, rough, normal, emission] = textures;
        let mut load = |key: &'static str, info: Option<&TextureInfo>, kind, slopes| {
            let (info, place) = (info?, place.key(key));
            if Some(info.mapping()) != mapping {
                let what = "a texture is left out: its coordinates are not those of the material's first one";
                builder.notes.add(&place, what);
                return None;
            }
            texture::load(self.document, info.index.0, kind, slopes, &place, builder)
        };
        material.texture = load("pbrMetallicRoughness", color, TexelKind::Color, None);
        if material.kind.has_roughness() {
            material.roughness_map = load("pbrMetallicRoughness", rough, TexelKind::Data, None);
        }
        if material.kind != MaterialKind::Emitter {
            let scale = file.normal_texture.as_ref().and_then(|normal| normal.scale).unwrap_or(1.0);
            let slopes = Some(scale as f32).filter(|scale| *scale != 1.0 && scale.is_finite());
            material.normal_map = load("normalTexture", normal, TexelKind::Data, slopes);
            if material.emits() {
                material.emission_map = load("emissiveTexture", emission, TexelKind::Color, None);
            }
        }
        if file.has_alpha() {
            self.set_opacity(&mut material, file, &place, builder);
        }
        let uv_map = mapping.map(|(_, transform)| transform).unwrap_or_default();
        Added { number: builder.add_material(material, 1.0), uv_map }
    }

    /// Sets the opacity of a material that may be passed.
    fn set_opacity(
        &self,
        material: &mut Material,
        file: &MaterialFile,
        place: &JsonPath,
        builder: &mut SceneBuilder,
    ) {
        let (pbr, known) = (&file.pbr_metallic_roughness, builder.textures.list.len());
        let place = place.key("pbrMetallicRoughness");
        // Its coordinates are those of the material's first texture, which it is.
        let load = |info: &TextureInfo| {
            texture::load(self.document, info.index.0, TexelKind::Alpha, None, &place, builder)
        };
        let map = pbr.base_color_texture.as_ref().and_then(load);
        let (map, factor) = (builder.opacity_map(map, known), factor(pbr.base_color_factor.map(|c| c[3])));
        let cutoff =
            (file.alpha_mode.as_deref() == Some("MASK")).then(|| file.alpha_cutoff.unwrap_or(0.5) as f32);
        (material.opacity, material.opacity_map, material.alpha_cutoff) = match (map, cutoff) {
            // No product with a map is larger.
            (_, Some(cutoff)) if factor < cutoff => (0.0, None, None),
            (None, Some(_)) => (1.0, None, None),
            (Some(_), Some(cutoff)) if cutoff <= 0.0 => (1.0, None, None),
            (map, cutoff) => (factor, map, cutoff),
        };
    }
}

impl MaterialFile {
    /// Tests whether the alpha of the base colour counts.
    pub fn has_alpha(&self) -> bool {
        matches!(self.alpha_mode.as_deref(), Some("MASK" | "BLEND"))
    }
}

/// Returns a factor; 1 where it is missing.
fn factor(factor: Option<f64>) -> f32 {
    factor.unwrap_or(1.0) as f32
}

/// Returns the material, whose numbers are within their ranges, without its textures.
fn plain(file: &MaterialFile, name: String, transmission: &Transmission) -> Material {
    let (pbr, extensions) = (&file.pbr_metallic_roughness, &file.extensions);
    let [r, g, b, _] = pbr.base_color_factor.unwrap_or([1.0; 4]).map(|x| x as f32);
    let color = Vec3::new(r, g, b);
    let strength = factor(extensions.emissive_strength.emissive_strength);
    let emitted = Vec3::from_array(file.emissive_factor.unwrap_or_default().map(|x| x as f32)) * strength;
    let ior = extensions.ior.ior.unwrap_or(1.5) as f32;
    let [roughness, metallic] = [pbr.roughness_factor, pbr.metallic_factor].map(factor);
    let thin = !transmission.is_volume;
    let glass_color = if thin { color } else { color.map(f32::sqrt) };
    let mut extras = MaterialExtras::default();
    let (kind, color, emission) = if extensions.unlit.is_some() {
        (MaterialKind::Emitter, Vec3::ONE, color)
    } else if transmission.is_glass {
        let kind = match (roughness > 0.0, thin) {
            (true, _) => MaterialKind::RoughGlass { roughness, ior, thin },
            (false, true) => MaterialKind::ThinGlass { ior },
            (false, false) => MaterialKind::Glass { ior },
        };
        (kind, glass_color, emitted)
    } else {
        extras = layers(file);
        extras.transmission = transmission.share as f32;
        extras.thin = thin && transmission.share > 0.0;
        (MaterialKind::MetalRough { roughness, metallic, ior }, color, emitted)
    };
    if transmission.clear > 0.0 && transmission.is_volume && emission == Vec3::ZERO {
        extras.attenuation = attenuation(file);
    }
    Material { emission, extras, ..Material::new(name, kind, color) }
}

/// Returns the reflectance and the clear coat.
fn layers(file: &MaterialFile) -> MaterialExtras {
    let (specular, coat) = (&file.extensions.specular, &file.extensions.clearcoat);
    let color = specular.specular_color_factor.unwrap_or([1.0; 3]).map(|x| x as f32);
    MaterialExtras {
        specular: factor(specular.specular_factor),
        specular_color: Vec3::from_array(color),
        clearcoat: coat.clearcoat_factor as f32,
        clearcoat_roughness: coat.clearcoat_roughness_factor as f32,
        ..MaterialExtras::default()
    }
}

/// Returns the absorption of the volume, in units of the file.
fn attenuation(file: &MaterialFile) -> Option<Attenuation> {
    let volume = &file.extensions.volume;
    let distance = volume.attenuation_distance.filter(|&x| (1e-18..=1e18).contains(&x))? as f32;
    let color = volume.attenuation_color.unwrap_or([1.0; 3]).map(|x| x as f32);
    (color != [1.0; 3]).then_some(Attenuation { color: Vec3::from_array(color), distance })
}

/// Notes the parts of a material that are left out.
fn note_ignored(
    file: &MaterialFile,
    kind: MaterialKind,
    transmission: &Transmission,
    place: &JsonPath,
    notes: &mut Notes,
) {
    // The standard ignores the rest of an unlit material too.
    if kind == MaterialKind::Emitter {
        return;
    }
    if file.occlusion_texture.is_some() {
        notes.add(&place.key("occlusionTexture"), "occlusion is left out: path tracing computes it");
    }
    let (at, extensions, &Transmission { clear, varies, is_volume, .. }) =
        (place.key("extensions"), &file.extensions, transmission);
    let (specular, coat) = (&extensions.specular, &extensions.clearcoat);
    let is_pure = !matches!(kind, MaterialKind::MetalRough { .. });
    let absorbs = clear > 0.0 && is_volume && attenuation(file).is_some();
    let emits = file.emissive_factor.is_some_and(|factor| factor != [0.0; 3]);
    let textures = [&specular.specular_texture, &specular.specular_color_texture, &coat.clearcoat_texture];
    let coat_textures = [&coat.clearcoat_roughness_texture, &coat.clearcoat_normal_texture];
    for (is_ignored, what) in [
        (clear > 0.0 && varies, "transmission varies over its texture: its mean is shown"),
        (absorbs && emits, "glass that emits is shown without its absorption"),
        (clear > 0.0 && coat.clearcoat_factor > 0.0, "what light passes is shown without its clear coat"),
        (is_pure && layers(file).specular != 1.0, "glass is shown with the reflectance of its index"),
        (
            textures.into_iter().chain(coat_textures).any(|texture| texture.is_some()),
            "textures of `KHR_materials_specular` and `KHR_materials_clearcoat` are left out",
        ),
    ] {
        if is_ignored {
            notes.add(&at, what);
        }
    }
}
