//! Textures of glTF materials: images, filters, and the transform of texture coordinates.
//!
//! For: [`Reference`], [`UvMap`], [`load`].

use super::super::builder::SceneBuilder;
use super::super::files::Files;
use super::super::json::JsonPath;
use super::super::notes::Notes;
use super::bytes::{self, Document};
use glam::{DVec3, Vec2};
use gltf_json::image::Image;
use gltf_json::texture::{Info, MagFilter, Texture, WrappingMode};
use gltf_json::validation::Checked;
use octray_engine::math::portable;
use octray_engine::scene::{Filter, TexelKind, Texels};
use serde_json::{Map, Value};

/// The transform of texture coordinates (`KHR_texture_transform`): scaled, rotated, offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvMap {
    offset: [f64; 2],
    /// Radians.
    rotation: f64,
    scale: [f64; 2],
}

impl Default for UvMap {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2] }
    }
}

impl UvMap {
    /// From glTF's texture coordinates, v downwards, to a scene's, v upwards.
    pub fn apply(&self, [u, v]: [f64; 2]) -> Vec2 {
        let (sin, cos) = portable::sin_cos(self.rotation);
        let (u, v) = (u * self.scale[0], v * self.scale[1]);
        let (u, v) = (cos * u + sin * v + self.offset[0], cos * v - sin * u + self.offset[1]);
        Vec2::new(u as f32, (1.0 - v) as f32)
    }
    fn of(value: &Value) -> Self {
        let two = |key: &str, default: f64| {
            let at = |index: usize| value[key][index].as_f64().unwrap_or(default);
            [at(0), at(1)]
        };
        Self {
            offset: two("offset", 0.0),
            rotation: value["rotation"].as_f64().unwrap_or(0.0),
            scale: two("scale", 1.0),
        }
    }
}

/// A material's use of a texture.
#[derive(Clone, Copy)]
pub struct Reference {
    pub texture: usize,
    /// The number of the set of texture coordinates.
    pub set: u32,
    pub map: UvMap,
}

impl Reference {
    pub fn of(info: &Info) -> Self {
        let extensions = info.extensions.as_ref().map(|extensions| &extensions.others);
        Self::new(info.index.value(), info.tex_coord, extensions)
    }
    pub fn new(texture: usize, set: u32, extensions: Option<&Map<String, Value>>) -> Self {
        let transform = extensions.and_then(|others| others.get("KHR_texture_transform"));
        let own = transform.and_then(|transform| transform["texCoord"].as_u64());
        Self {
            texture,
            set: own.and_then(|set| u32::try_from(set).ok()).unwrap_or(set),
            map: transform.map(UvMap::of).unwrap_or_default(),
        }
    }
}

/// Loads a texture; `None`, with a note, where it cannot be used. A model's shape is visible without it. The
/// slopes of a normal map are multiplied by `slopes`.
pub fn load(
    document: &Document,
    texture: usize,
    kind: TexelKind,
    slopes: Option<f32>,
    place: &JsonPath,
    builder: &mut SceneBuilder,
) -> Option<u32> {
    let Some(file) = document.root.textures.get(texture) else {
        builder.notes.add(place, format!("there is no texture {texture}"));
        return None;
    };
    let root = document.source.root();
    let filter = filter(document, file, &mut builder.notes);
    let index = file.source.value();
    let Some(image) = document.root.images.get(index) else {
        let what = "a texture without a PNG or JPEG image is left out";
        builder.notes.add(&root.key("textures").item(texture), what);
        return None;
    };
    let model = document.source.file;
    let textures = &mut builder.textures;
    let known = textures.left_out.len();
    let files = textures.files.clone();
    let loaded = match &image.uri {
        Some(uri) if slopes.is_none() && !bytes::is_data(uri) => {
            textures.load(&bytes::path(uri, model), &bytes::decoded(uri), filter, kind)
        }
        _ => {
            let name = model.file_name().unwrap_or_default().to_string_lossy();
            let scaled = slopes.map_or(String::new(), |scale| format!(", slopes times {scale}"));
            let name = format!("{name} image {index}{scaled}");
            let change = |texels| match slopes {
                Some(scale) => scale_slopes(&texels, scale),
                None => texels,
            };
            let path = model.with_file_name(&name);
            textures.load_from(|| content(document, image, &files), change, &path, &name, filter, kind)
        }
    };
    // Colour spaces that images state, and alpha where a material is opaque, are to be ignored.
    textures.left_out.truncate(known);
    if let Err(reason) = &loaded {
        builder.notes.add(&root.key("images").item(index), format!("the image is left out: {reason}"));
    }
    loaded.ok()
}

/// Notes what of the texture's sampler is left out.
fn filter(document: &Document, texture: &Texture, notes: &mut Notes) -> Filter {
    let index = texture.sampler.map(|index| index.value());
    let sampler = index.and_then(|index| Some((index, document.root.samplers.get(index)?)));
    let Some((index, sampler)) = sampler else { return Filter::Bilinear };
    let repeats = Checked::Valid(WrappingMode::Repeat);
    if sampler.wrap_s != repeats || sampler.wrap_t != repeats {
        let what = "textures repeat here: clamping and mirroring are not read";
        notes.add(&document.source.root().key("samplers").item(index), what);
    }
    match sampler.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
        _ => Filter::Bilinear,
    }
}

fn content(document: &Document, image: &Image, files: &Files) -> Result<Vec<u8>, String> {
    match (&image.uri, image.buffer_view) {
        (Some(uri), _) => bytes::from_uri(uri, document.source.file, files),
        (None, Some(view)) => {
            let view = document.view(view.value()).map(|(_, bytes)| bytes.to_vec());
            view.ok_or_else(|| "it reaches beyond its buffer".to_string())
        }
        (None, None) => Err("it has no data".to_string()),
    }
}

/// A normal map with the slopes of its normals multiplied.
fn scale_slopes(texels: &Texels, scale: f32) -> Texels {
    let scaled = (0..texels.len()).map(|index| {
        let [x, y, z] = texels.linear(index).map(|channel| 2.0 * channel - 1.0);
        let scale = f64::from(scale);
        let normal = DVec3::new(x * scale, y * scale, z).try_normalize().unwrap_or(DVec3::Z);
        let [x, y, z] = normal.to_array().map(|c| (0.5 * c + 0.5) as f32);
        [x, y, z, 0.0]
    });
    Texels::Float32(scaled.collect())
}
