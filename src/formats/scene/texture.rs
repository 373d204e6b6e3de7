//! Textures: PNG, JPEG, BMP, TGA, HDR and EXR files decoded to texels.
//!
//! For: [`Textures`].

use super::files::Files;
use crate::openexr;
use image::{DynamicImage, ImageError, ImageFormat, ImageReader, Limits};
use octray_engine::film::Picture;
use octray_engine::scene::{Filter, TexelKind, Texels, Texture, srgb_to_linear};
use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt::Display;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Most texels in a row and in a column of an image file.
pub const MAX_IMAGE_SIDE: u32 = u16::MAX as u32;
/// Most bytes that an image file may be decoded to.
pub const MAX_IMAGE_BYTES: u64 = 2 << 30;
/// Most bytes that the textures of a scene may take, levels of detail included: four of a texel with 8 bits a
/// channel, sixteen of others.
const MAX_BYTES: usize = 4 << 30;
/// What a texture counts at the least: it also has a name and a place in tables.
const LEAST_BYTES: usize = 1 << 10;

/// The textures of one scene; each file is loaded once for each filter and kind of texels.
#[derive(Default)]
pub struct Textures {
    /// Where they come from.
    pub files: Files,
    pub list: Vec<Texture>,
    bytes: usize,
    known: HashMap<(PathBuf, Filter, TexelKind), u32>,
}

impl Textures {
    /// The index of the texture at a resolved path, or the reason why it cannot be loaded. `name` is shown to
    /// the user.
    pub fn load(
        &mut self,
        path: &Path,
        name: &str,
        filter: Filter,
        texel_kind: TexelKind,
    ) -> Result<u32, String> {
        let files = self.files.clone();
        self.load_from(|| files.read(path), |texels| texels, path, name, filter, texel_kind)
    }
    /// The same from an image file's content, of which `change` makes the texels that are kept. `path` names
    /// the image and the change.
    pub fn load_from(
        &mut self,
        content: impl FnOnce() -> Result<Cow<'static, [u8]>, String>,
        change: impl FnOnce(Texels) -> Texels,
        path: &Path,
        name: &str,
        filter: Filter,
        texel_kind: TexelKind,
    ) -> Result<u32, String> {
        let key = (path.to_path_buf(), filter, texel_kind);
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let (width, height, texels) = decode(&content()?, path, texel_kind)?;
        self.add(key, Texture { name: name.to_string(), width, height, filter, texels: change(texels) })
    }
    fn add(&mut self, key: (PathBuf, Filter, TexelKind), texture: Texture) -> Result<u32, String> {
        self.bytes += texture.bytes().max(LEAST_BYTES);
        if self.bytes > MAX_BYTES {
            return Err(format!("the scene's textures take more than {MAX_BYTES} bytes"));
        }
        let number = self.list.len() as u32;
        self.list.push(texture);
        self.known.insert(key, number);
        Ok(number)
    }
}

fn decode(bytes: &[u8], path: &Path, texel_kind: TexelKind) -> Result<(u32, u32, Texels), String> {
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string())?;
    // TGA has no magic number: its extension decides.
    if reader.format().is_none()
        && let Ok(format) = ImageFormat::from_path(path)
    {
        reader.set_format(format);
    }
    if reader.format() == Some(ImageFormat::OpenExr) {
        let Picture { width, height, pixels } = openexr::read(bytes, MAX_IMAGE_BYTES / 12).map_err(broken)?;
        if width.max(height) > MAX_IMAGE_SIDE {
            return Err(too_large());
        }
        return Ok((width, height, linear_texels(width, pixels)?));
    }
    let mut limits = Limits::no_limits();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_IMAGE_SIDE), Some(MAX_IMAGE_SIDE));
    limits.max_alloc = Some(MAX_IMAGE_BYTES);
    reader.limits(limits);
    let format = reader.format().ok_or("it is not a PNG, JPEG, BMP, TGA, HDR or EXR image")?;
    let picture = reader.decode().map_err(|error| match error {
        ImageError::Limits(_) => too_large(),
        error => broken(error),
    })?;
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err("the image has no pixels".to_string());
    }
    let texels = match format {
        ImageFormat::Hdr => {
            let picture = picture.into_rgb32f();
            linear_texels(width, picture.pixels().map(|pixel| pixel.0).collect())?
        }
        _ => display_texels(picture, texel_kind),
    };
    Ok((width, height, texels))
}

/// HDR and EXR already hold linear values.
fn linear_texels(width: u32, pixels: Vec<[f32; 3]>) -> Result<Texels, String> {
    for (index, pixel) in pixels.iter().enumerate() {
        if let Some(bad) = pixel.iter().find(|channel| !(channel.is_finite() && **channel >= 0.0)) {
            let (x, y) = (index % width as usize, index / width as usize);
            return Err(format!("the pixel in column {x}, row {y} holds {bad}, which is not a radiance"));
        }
    }
    Ok(Texels::Float32(pixels.into_iter().map(|[r, g, b]| [r, g, b, 0.0]).collect()))
}

fn too_large() -> String {
    format!(
        "the image is larger than {MAX_IMAGE_SIDE} texels in width or height, or decodes to more than \
         {MAX_IMAGE_BYTES} bytes"
    )
}

fn broken(error: impl Display) -> String {
    format!("the image is broken: {error}")
}

/// The other formats hold display values (sRGB), or data, of 8 or 16 bits.
fn display_texels(picture: DynamicImage, texel_kind: TexelKind) -> Texels {
    use DynamicImage::{ImageLuma16, ImageLumaA16, ImageRgb16, ImageRgba16};
    match picture {
        ImageLuma16(_) | ImageLumaA16(_) | ImageRgb16(_) | ImageRgba16(_) => {
            // 16 bits do not fit a byte: stored as linear f32.
            let linear = |channel: u16| {
                let x = f64::from(channel) / 65_535.0;
                (if texel_kind == TexelKind::Color { srgb_to_linear(x) } else { x }) as f32
            };
            let texel = |p: &image::Rgb<u16>| [linear(p[0]), linear(p[1]), linear(p[2]), 0.0];
            Texels::Float32(picture.into_rgb16().pixels().map(texel).collect())
        }
        _ => {
            let texels = picture.into_rgb8().pixels().map(|p| [p[0], p[1], p[2], 0]).collect();
            if texel_kind == TexelKind::Color { Texels::Srgb8(texels) } else { Texels::Unorm8(texels) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_are_counted_and_end_at_the_limit() {
        let texture = |texels| Texture {
            name: String::new(),
            width: 1,
            height: texels,
            filter: Filter::Nearest,
            texels: Texels::Float32(vec![[0.0; 4]; texels as usize]),
        };
        let key = |name: &str| (PathBuf::from(name), Filter::Nearest, TexelKind::Color);
        let mut textures = Textures { bytes: MAX_BYTES - 17_024, ..Textures::default() };
        // 16 bytes each texel, and not less than a kilobyte.
        assert_eq!(textures.add(key("a"), texture(1_000)), Ok(0));
        assert_eq!(textures.add(key("b"), texture(1)), Ok(1));
        let refused = textures.add(key("c"), texture(1));
        assert_eq!(refused, Err("the scene's textures take more than 4294967296 bytes".to_string()));
        assert_eq!(textures.list.len(), 2);
        // Levels of detail count: 1,000 texels in a row have 994 more.
        let mut textures = Textures { bytes: MAX_BYTES - 17_024, ..Textures::default() };
        let levels = Texture { filter: Filter::Trilinear, ..texture(1_000) };
        assert!(textures.add(key("d"), levels).is_err());
    }
}
