//! Loads the textures of glTF materials: images, filters, and the transform of texture coordinates.

use super::super::builder::SceneBuilder;
use super::super::files::Files;
use super::super::json::JsonPath;
use super::super::notes::Notes;
use super::super::relief;
use super::super::texture::Lookup;
use super::bytes::{self, Document};
use super::schema::{Image, Texture, TextureInfo, TextureTransform, Whole};
use glam::Vec2;
use octray_engine::math::portable;
use octray_engine::scene::{Filter, TexelKind, Wrap};

impl TextureTransform {
    /// Scales, rotates and offsets glTF's texture coordinates, with v downwards. Returns a scene's, with v
    /// upwards.
    pub fn apply(&self, [u, v]: [f64; 2]) -> Vec2 {
        let (sin, cos) = portable::sin_cos(self.rotation);
        let ([scale_u, scale_v], [u0, v0]) = (self.scale.unwrap_or([1.0; 2]), self.offset);
        let (u, v) = (u * scale_u, v * scale_v);
        let (u, v) = (cos * u + sin * v + u0, cos * v - sin * u + v0);
        Vec2::new(u as f32, (1.0 - v) as f32)
    }
}

impl TextureInfo {
    /// Returns the set of texture coordinates and their transform.
    pub fn mapping(&self) -> (usize, TextureTransform) {
        let transform = self.extensions.transform;
        let set = transform.tex_coord.unwrap_or(self.tex_coord).0;
        let scale = transform.scale.or(Some([1.0; 2]));
        (set, TextureTransform { tex_coord: None, scale, ..transform })
    }
}

/// The least, the mean and the largest value of a channel.
pub type Range = [f64; 3];

/// Returns the ranges of a texture's channels, read as data; `None`, with a note, if it cannot be used. The
/// scene does not keep the texture.
pub fn ranges(
    document: &Document,
    texture: usize,
    place: &JsonPath,
    builder: &mut SceneBuilder,
) -> Option<[Range; 3]> {
    let before = builder.textures.list.len();
    let number = load(document, texture, TexelKind::Data, None, place, builder)? as usize;
    let texels = &builder.textures.list[number].texels;
    let ranges = [0, 1, 2].map(|channel| {
        let values = (0..texels.len()).map(|index| texels.linear(index)[channel]);
        let mean = values.clone().sum::<f64>() / texels.len() as f64;
        [values.clone().fold(f64::INFINITY, f64::min), mean, values.fold(0.0, f64::max)]
    });
    builder.textures.truncate(before);
    Some(ranges)
}

/// Loads a texture; `None`, with a note, if it cannot be used, as a model's shape is visible without it. The
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
        builder.notes.add(place, format!("there is no `textures[{texture}]`"));
        return None;
    };
    let root = document.source.root();
    let image = file.image().and_then(|index| Some((index, document.root.images.get(index)?)));
    let Some((index, image)) = image else {
        let what = "a texture without a PNG, JPEG or WebP image is left out";
        builder.notes.add(&root.key("textures").item(texture), what);
        return None;
    };
    let lookup = lookup(document, file, kind, &mut builder.notes);
    let model = document.source.file;
    let textures = &mut builder.textures;
    let known = textures.left_out.len();
    let files = textures.files.clone();
    let loaded = match &image.uri {
        Some(uri) if slopes.is_none() && bytes::data(uri).is_none() => {
            textures.find(&bytes::decoded(uri), [model; 2], lookup)
        }
        _ => {
            let name = model.file_name().unwrap_or_default().to_string_lossy();
            let scaled = slopes.map_or(String::new(), |scale| format!(", slopes times {scale}"));
            let name = format!("{name} image {index}{scaled}");
            let change = |texels| match slopes {
                Some(scale) => relief::scale_slopes(&texels, scale.into()),
                None => texels,
            };
            let path = model.with_file_name(name);
            textures.load_from(|| content(document, image, &files), change, &path, lookup)
        }
    };
    // The standard demands that colour profiles, and the alpha of opaque materials, are ignored.
    textures.left_out.truncate(known);
    if let Err(reason) = &loaded {
        builder.notes.add(&root.key("images").item(index), format!("the image is left out: {reason}"));
    }
    loaded.ok()
}

/// Returns the lookup of a texture's sampler, and notes a wrap and a filter that do not exist.
fn lookup(document: &Document, texture: &Texture, kind: TexelKind, notes: &mut Notes) -> Lookup {
    let sampler = texture.sampler.and_then(|index| Some((index.0, document.root.samplers.get(index.0)?)));
    let Some((index, sampler)) = sampler else {
        return Lookup::repeating(Filter::Bilinear, kind);
    };
    let mut note = |what| notes.add(&document.source.root().key("samplers").item(index), what);
    let wrap = [sampler.wrap_s, sampler.wrap_t].map(|wrap| match wrap.map_or(10497, |Whole(code)| code) {
        10497 => Wrap::Repeat,
        33071 => Wrap::Clamp,
        33648 => Wrap::Mirror,
        code => {
            note(format!("there is no wrap {code}: textures repeat"));
            Wrap::Repeat
        }
    });
    let filter = match sampler.mag_filter.map_or(9729, |Whole(code)| code) {
        9728 => Filter::Nearest,
        9729 => Filter::Bilinear,
        code => {
            note(format!("there is no `magFilter` {code}: it is linear"));
            Filter::Bilinear
        }
    };
    Lookup { filter, wrap, kind }
}

fn content(document: &Document, image: &Image, files: &Files) -> Result<Vec<u8>, String> {
    match (&image.uri, image.buffer_view) {
        (Some(uri), _) => bytes::from_uri(uri, document.source.file, files),
        (None, Some(view)) => document.view(view.0).map(|(_, bytes)| bytes.to_vec()),
        (None, None) => Err("it has no data".to_string()),
    }
}
