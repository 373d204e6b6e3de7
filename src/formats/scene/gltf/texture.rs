//! Textures of glTF materials: images, filters, and the transform of texture coordinates.
//!
//! For: [`Reference`], [`UvMap`], [`load`].

use super::super::builder::SceneBuilder;
use super::super::files::Files;
use super::super::json::{JsonPath, Source};
use super::super::notes::Notes;
use super::bytes;
use glam::{DVec2, Vec2};
use gltf_json::Root;
use gltf_json::texture::{Info, MagFilter, WrappingMode};
use gltf_json::validation::Checked;
use octray_engine::math::portable;
use octray_engine::scene::{Filter, TexelKind, Texels};
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

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
        let uv = DVec2::new(cos * u + sin * v + self.offset[0], cos * v - sin * u + self.offset[1]);
        Vec2::new(uv.x as f32, (1.0 - uv.y) as f32)
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

/// Where textures come from.
pub struct Images<'a> {
    pub source: &'a Source<'a>,
    pub root: &'a Root,
    pub buffers: &'a [bytes::Buffer],
    pub files: &'a Files,
}

/// What is made of a texture's texels before they are kept: `None`, nothing; else the factor of a normal
/// map's slopes.
pub type Slopes = Option<f32>;

/// Loads a texture; `None`, with a note, where it cannot be used. A model's shape is visible without it.
pub fn load(
    images: &Images,
    texture: usize,
    (kind, slopes): (TexelKind, Slopes),
    place: &JsonPath,
    builder: &mut SceneBuilder,
    notes: &mut Notes,
) -> Option<u32> {
    let Some(file) = images.root.textures.get(texture) else {
        notes.add(place, format!("there is no texture {texture}"));
        return None;
    };
    let root = JsonPath::Root;
    let samplers = root.key("samplers");
    let sampler =
        file.sampler.and_then(|index| Some((index.value(), images.root.samplers.get(index.value())?)));
    let mut filter = Filter::Bilinear;
    if let Some((index, sampler)) = sampler {
        if matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest))) {
            filter = Filter::Nearest;
        }
        let repeats = Checked::Valid(WrappingMode::Repeat);
        if sampler.wrap_s != repeats || sampler.wrap_t != repeats {
            notes.add(
                &samplers.item(index),
                "textures repeat here: clamping and mirroring are not read".into(),
            );
        }
    }
    let index = file.source.value();
    let Some(image) = images.root.images.get(index) else {
        let list = root.key("textures");
        notes.add(&list.item(texture), "a texture without a PNG or JPEG image is left out".into());
        return None;
    };
    let model = images.source.file;
    let name = model.file_name().unwrap_or_default().to_string_lossy();
    let loaded = match &image.uri {
        Some(uri) if slopes.is_none() && bytes::data(uri).is_none() => {
            let path = bytes::path(uri, model);
            builder.textures.load(images.files, &path, &bytes::decoded(uri), filter, kind)
        }
        uri => {
            let content = || match (uri, image.buffer_view) {
                (Some(uri), _) => bytes::from_uri(uri, model, images.files),
                (None, Some(view)) => {
                    let view = images.root.buffer_views.get(view.value());
                    let bytes = view.and_then(|view| bytes::view(view, images.buffers));
                    bytes.map(<[u8]>::to_vec).ok_or_else(|| "it reaches beyond its buffer".to_string())
                }
                (None, None) => Err("it has no data".to_string()),
            };
            let scaled = slopes.map_or(String::new(), |scale| format!(", slopes times {scale}"));
            let path: PathBuf = model.with_file_name(format!("{name} image {index}{scaled}"));
            builder.textures.load_embedded(content, Path::new(&path), filter, kind, |texels| match slopes {
                Some(scale) => scale_slopes(&texels, scale),
                None => texels,
            })
        }
    };
    loaded
        .map_err(|reason| {
            let list = root.key("images");
            notes.add(&list.item(index), format!("the image is left out: {reason}"));
        })
        .ok()
}

/// A normal map with the slopes of its normals multiplied.
fn scale_slopes(texels: &Texels, scale: f32) -> Texels {
    let scaled = (0..texels.len()).map(|index| {
        let [x, y, z] = texels.linear(index).map(|channel| 2.0 * channel - 1.0);
        let scale = f64::from(scale);
        let normal = glam::DVec3::new(x * scale, y * scale, z);
        let [x, y, z] =
            normal.try_normalize().unwrap_or(glam::DVec3::Z).to_array().map(|c| (0.5 * c + 0.5) as f32);
        [x, y, z, 0.0]
    });
    Texels::Float32(scaled.collect())
}
