//! Pictures for surfaces and skies: from PNG, JPEG, BMP, TGA, HDR and EXR files to linear texels.
//!
//! For: [`Textures`], [`srgb_to_linear`]. May import: `files`. Must never know: what a texture lies on.

use super::files::Files;
use super::{Filter, Texels, Texture};
use image::{DynamicImage, ImageFormat, ImageReader};
use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The textures of one scene; each file is loaded once for each filter and meaning.
#[derive(Default)]
pub struct Textures {
    pub list: Vec<Texture>,
    known: HashMap<(PathBuf, Filter, Meaning), u32>,
}

/// What the numbers in a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Meaning {
    /// Colours: files of display values are decoded.
    Light,
    /// Directions or roughness: read as they stand.
    Data,
}

impl Textures {
    /// The number of the texture at a resolved path, or the reason why there is none. `name` is for people.
    pub fn load(
        &mut self,
        files: &Files,
        path: &Path,
        name: &str,
        filter: Filter,
        meaning: Meaning,
    ) -> Result<u32, String> {
        let key = (path.to_path_buf(), filter, meaning);
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let (width, height, texels) = decode(&files.read(path)?, path, meaning)?;
        let number = self.list.len() as u32;
        self.list.push(Texture { name: name.to_string(), width, height, filter, texels });
        self.known.insert(key, number);
        Ok(number)
    }
}

/// The linear intensity of a display value: IEC 61966-2-1. Both are 1 at 1; values above 1 follow the same curve.
pub fn srgb_to_linear(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

fn decode(bytes: &[u8], path: &Path, meaning: Meaning) -> Result<(u32, u32, Texels), String> {
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string())?;
    // TGA has no magic number: its name must tell.
    if reader.format().is_none()
        && let Ok(format) = ImageFormat::from_path(path)
    {
        reader.set_format(format);
    }
    let format = reader.format().ok_or("it is not a PNG, JPEG, BMP, TGA, HDR or EXR picture")?;
    let picture = reader.decode().map_err(|error| format!("the picture is broken: {error}"))?;
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err("the picture has no pixels".to_string());
    }
    let texels = match format {
        ImageFormat::Hdr | ImageFormat::OpenExr => linear_texels(picture)?,
        _ => display_texels(picture, meaning),
    };
    Ok((width, height, texels))
}

/// HDR and EXR hold linear light already.
fn linear_texels(picture: DynamicImage) -> Result<Texels, String> {
    let picture = picture.into_rgb32f();
    for (x, y, pixel) in picture.enumerate_pixels() {
        if let Some(bad) = pixel.0.iter().find(|channel| !(channel.is_finite() && **channel >= 0.0)) {
            return Err(format!("the pixel in column {x}, row {y} holds {bad}, which is no amount of light"));
        }
    }
    Ok(Texels::Linear(picture.pixels().map(|pixel| [pixel[0], pixel[1], pixel[2], 0.0]).collect()))
}

/// The other formats hold display values (sRGB), or data, of 8 or 16 bits.
fn display_texels(picture: DynamicImage, meaning: Meaning) -> Texels {
    use DynamicImage::{ImageLuma16, ImageLumaA16, ImageRgb16, ImageRgba16};
    match picture {
        ImageLuma16(_) | ImageLumaA16(_) | ImageRgb16(_) | ImageRgba16(_) => {
            // More than a byte holds: kept as linear numbers.
            let linear = |channel: u16| {
                let x = f64::from(channel) / 65_535.0;
                (if meaning == Meaning::Light { srgb_to_linear(x) } else { x }) as f32
            };
            let texel = |p: &image::Rgb<u16>| [linear(p[0]), linear(p[1]), linear(p[2]), 0.0];
            Texels::Linear(picture.into_rgb16().pixels().map(texel).collect())
        }
        _ => {
            let texels = picture.into_rgb8().pixels().map(|p| [p[0], p[1], p[2], 0]).collect();
            if meaning == Meaning::Light { Texels::Display(texels) } else { Texels::Data(texels) }
        }
    }
}
