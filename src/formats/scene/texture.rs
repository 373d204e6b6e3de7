//! Decodes PNG, JPEG, WebP, BMP, TGA, HDR and EXR files to textures.

use super::alpha::alpha_texels;
use super::colorimetry::{self, linear, to_rec709};
use super::files::Files;
use super::radiance::Radiance;
use crate::openexr;
use crate::wording::counted;
use glam::DMat3;
use image::metadata::Orientation;
use image::{DynamicImage, GenericImageView, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use moxcms::ColorProfile;
use octray_engine::film::Picture;
use octray_engine::scene::{Filter, TexelKind, Texels, Texture, Wrap, srgb_to_linear};
use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Most texels in a row and in a column of an image file.
pub const MAX_IMAGE_SIDE: u32 = u16::MAX as u32;
/// Most bytes that an image file may be decoded to.
pub const MAX_IMAGE_BYTES: u64 = 2 << 30;
/// Most pixels for each byte of a file: those of a PNG of one bit a pixel, which Deflate shrinks to 1 in
/// 1,032. Only a BMP that leaves out nearly all of its pixels has more.
const MAX_PIXELS_OF_BYTE: u64 = 8 * 1_032;
/// Most bytes of the textures of a scene, levels of detail included: four for a texel with 8 bits a channel,
/// sixteen for others.
const MAX_BYTES: usize = 4 << 30;
/// Number of pixels up to which a WebP file may have any size: one of a single colour has 40 bytes.
const FEW_PIXELS: u64 = 1 << 24;
/// Least number of bytes that a texture counts for its name and its places in tables.
const LEAST_BYTES: usize = 1 << 10;

/// The clause about an alpha channel that a colour texture does not use.
const TRANSPARENCY: &str =
    "its transparency is left out: an `opacity_map` (MTL: `map_d`) of the same picture shows it";

/// Width, height and texels of an image.
pub type Decoded = (u32, u32, Texels);

/// The way in which a texture is read.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Lookup {
    pub filter: Filter,
    pub wrap: [Wrap; 2],
    pub kind: TexelKind,
}

impl Lookup {
    /// Returns the lookup of textures that repeat.
    pub fn repeating(filter: Filter, kind: TexelKind) -> Self {
        Self { filter, wrap: [Wrap::Repeat; 2], kind }
    }
}

/// Makes the texels that are kept of an image.
pub type Change<'a> = dyn FnMut(&mut Textures, Decoded) -> Decoded + 'a;

/// The textures of one scene. Each file is loaded once for each lookup.
#[derive(Default)]
pub struct Textures {
    /// The files that they come from.
    pub files: Files,
    pub list: Vec<Texture>,
    /// Whether all display values are read as sRGB, even if a file has another profile.
    pub ignores_profiles: bool,
    /// A sentence about everything of image files that is left out.
    pub left_out: Vec<String>,
    bytes: usize,
    known: HashMap<(PathBuf, Lookup), u32>,
}

impl Textures {
    /// Loads the texture at a resolved path, and returns its index, or the reason why it cannot be loaded.
    /// `name` is for messages.
    pub fn load(&mut self, path: &Path, name: &str, lookup: Lookup) -> Result<u32, String> {
        self.add((path.to_path_buf(), lookup), name, |textures| textures.read(path, lookup.kind))
    }
    /// Loads the texture that a model names in a file, `beside`: see [`Files::find`].
    pub fn find(&mut self, name: &str, beside: [&Path; 2], lookup: Lookup) -> Result<u32, String> {
        self.find_changed(name, beside, lookup, "", &mut |_, image| image)
    }
    /// Loads the texture that a model names in a file, `beside`, and changes it. `what` names the change.
    pub fn find_changed(
        &mut self,
        name: &str,
        beside @ [_, model]: [&Path; 2],
        lookup: Lookup,
        what: &str,
        change: &mut Change,
    ) -> Result<u32, String> {
        let folder = model.parent().unwrap_or(Path::new(""));
        self.files.clone().find(name, beside, |path| {
            let shown = path.strip_prefix(folder).unwrap_or(path).to_string_lossy();
            let mut key = path.as_os_str().to_owned();
            key.push(what);
            self.add((key.into(), lookup), &format!("{shown}{what}"), |textures| {
                let image = textures.read(path, lookup.kind)?;
                Ok(change(textures, image))
            })
        })
    }
    /// Decodes the image that a model names in a file, `beside`. The scene does not keep it.
    pub fn find_image(
        &mut self,
        name: &str,
        beside: [&Path; 2],
        texel_kind: TexelKind,
    ) -> Result<Decoded, String> {
        self.files.clone().find(name, beside, |path| self.read(path, texel_kind))
    }
    fn read(&mut self, path: &Path, texel_kind: TexelKind) -> Result<Decoded, String> {
        self.decode(&self.files.clone().read(path)?, path, texel_kind)
    }
    /// Loads a texture from the content of an image file. `change` makes the texels that are kept; `path`
    /// names the image and the change.
    pub fn load_from(
        &mut self,
        content: impl FnOnce() -> Result<Vec<u8>, String>,
        change: impl FnOnce(Texels) -> Texels,
        path: &Path,
        lookup: Lookup,
    ) -> Result<u32, String> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.add((path.to_path_buf(), lookup), &name, |textures| {
            let (width, height, texels) = textures.decode(&content()?, path, lookup.kind)?;
            Ok((width, height, change(texels)))
        })
    }
    /// Keeps the first textures. The others still count as loaded.
    pub fn truncate(&mut self, count: usize) {
        self.list.truncate(count);
        self.known.retain(|_, number| (*number as usize) < count);
    }
    /// Takes the sentences about what is left out. The transparency of a picture that is an opacity map, too,
    /// is not.
    pub fn take_left_out(&mut self) -> Vec<String> {
        let is_alpha = |kind: TexelKind| matches!(kind, TexelKind::Alpha | TexelKind::AlphaOrGrey);
        let maps = self.known.keys().filter(|(_, lookup)| is_alpha(lookup.kind));
        let shown: Vec<String> =
            maps.map(|(path, ..)| format!("{}: {TRANSPARENCY}.", path.display())).collect();
        self.left_out.retain(|sentence| !shown.contains(sentence));
        std::mem::take(&mut self.left_out)
    }
    fn decode(&mut self, bytes: &[u8], path: &Path, texel_kind: TexelKind) -> Result<Decoded, String> {
        let mut left_out = Vec::new();
        let decoded = decode(bytes, path, texel_kind, self.ignores_profiles, &mut left_out)?;
        self.left_out.extend(left_out.into_iter().map(|what| format!("{}: {what}.", path.display())));
        Ok(decoded)
    }
    /// Adds a texture, unless it is known, and returns its index.
    fn add(
        &mut self,
        key: (PathBuf, Lookup),
        name: &str,
        decode: impl FnOnce(&mut Self) -> Result<Decoded, String>,
    ) -> Result<u32, String> {
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let (width, height, texels) = decode(self)?;
        let Lookup { filter, wrap, .. } = key.1;
        let texture = Texture { name: name.to_string(), width, height, filter, wrap, texels };
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

/// Decodes an image file, and adds a clause to `left_out` for everything that is left out of it.
fn decode(
    bytes: &[u8],
    path: &Path,
    texel_kind: TexelKind,
    ignores_profiles: bool,
    left_out: &mut Vec<String>,
) -> Result<Decoded, String> {
    let radiance = bytes.starts_with(b"#?").then(|| Radiance::new(bytes)).transpose()?;
    let bytes = radiance.as_ref().map_or(bytes, |radiance| radiance.file.as_slice());
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string())?;
    // TGA has no magic number, and is known by its extension.
    if let (None, Ok(format)) = (reader.format(), ImageFormat::from_path(path)) {
        reader.set_format(format);
    }
    if reader.format() == Some(ImageFormat::OpenExr) {
        let (Picture { width, height, pixels }, file, others) = openexr::read(bytes, MAX_IMAGE_BYTES / 12)?;
        left_out.extend(others);
        if width.max(height) > MAX_IMAGE_SIDE {
            return Err(too_large());
        }
        let matrix = file.map_or(Some(DMat3::IDENTITY), to_rec709);
        if matrix.is_none() {
            left_out.push("its chromaticities span no colours: it is read as Rec. 709".to_string());
        }
        return Ok((width, height, linear_texels(pixels, matrix.unwrap_or_default(), texel_kind, left_out)));
    }
    let mut limits = Limits::no_limits();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_IMAGE_SIDE), Some(MAX_IMAGE_SIDE));
    limits.max_alloc = Some(MAX_IMAGE_BYTES);
    reader.limits(limits);
    let format = reader.format().ok_or("it is not a PNG, JPEG, WebP, BMP, TGA, HDR or EXR image")?;
    let refused = |error| match error {
        ImageError::Limits(_) => too_large(),
        error => format!("the image is broken: {error}"),
    };
    let mut decoder = reader.into_decoder().map_err(refused)?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err("the image has no pixels".to_string());
    }
    if decoder.total_bytes() > MAX_IMAGE_BYTES {
        return Err(too_large());
    }
    // A decoder allocates memory for the whole picture before it finds the end of the file.
    let free = if format == ImageFormat::WebP { FEW_PIXELS } else { 0 };
    if u64::from(width) * u64::from(height) > free.max(bytes.len() as u64 * MAX_PIXELS_OF_BYTE) {
        return Err(format!("its {} bytes are too few for {width}x{height} pixels", bytes.len()));
    }
    if let Some(radiance) = &radiance {
        let picture = radiance.turn(DynamicImage::from_decoder(decoder).map_err(refused)?).into_rgb32f();
        left_out.extend(radiance.left_out.iter().cloned());
        let pixels = picture.pixels().map(|pixel| pixel.0).collect();
        let texels = linear_texels(pixels, radiance.matrix, texel_kind, left_out);
        return Ok((picture.width(), picture.height(), texels));
    }
    let is_color = texel_kind == TexelKind::Color;
    let profile = is_color.then(|| profile(bytes, &mut decoder, left_out));
    let picture = DynamicImage::from_decoder(decoder).map_err(refused)?;
    if is_color && picture.color().has_alpha() && picture.pixels().any(|(_, _, pixel)| pixel[3] < u8::MAX) {
        left_out.push(TRANSPARENCY.to_string());
    }
    if format == ImageFormat::Jpeg && !has_end(bytes) {
        left_out.push("its end is missing: the last rows may be wrong".to_string());
    }
    if matches!(texel_kind, TexelKind::Alpha | TexelKind::AlphaOrGrey) {
        return Ok(alpha_texels(picture, texel_kind));
    }
    let texels = match profile.map(|profile| linear(&profile?, &picture)) {
        Some(Some(Some(converted))) if !ignores_profiles => converted,
        converted => {
            if let Some(None | Some(Some(_))) = converted {
                left_out.push("its colour profile is left out: it is read as sRGB".to_string());
            }
            display_texels(picture, texel_kind)
        }
    };
    Ok((width, height, texels))
}

/// Tests whether a JPEG file has the marker that ends its first picture, which others may follow. The decoder
/// fills in missing rows without an error.
fn has_end(jpeg: &[u8]) -> bool {
    const START: u8 = 0xd8;
    const END: u8 = 0xd9;
    let mut rest = jpeg;
    while let Some(at) = rest.windows(2).position(|at| at[0] == 0xff && !matches!(at[1], 0 | 0xff)) {
        let segment = &rest[at + 2..];
        rest = match rest[at + 1] {
            END => return true,
            START | 0xd0..=0xd7 => segment,
            _ => {
                let length = segment.first_chunk().map_or(2, |&length| u16::from_be_bytes(length));
                segment.get(usize::from(length)..).unwrap_or_default()
            }
        };
    }
    false
}

/// Returns the profile of a picture's values; `None` if it cannot be used.
fn profile(
    bytes: &[u8],
    decoder: &mut impl ImageDecoder,
    left_out: &mut Vec<String>,
) -> Option<ColorProfile> {
    if decoder.orientation().is_ok_and(|turn| turn != Orientation::NoTransforms) {
        left_out.push("its EXIF orientation is left out: turn the picture itself".to_string());
    }
    // Files of other formats have none.
    let info = png::Decoder::new(Cursor::new(bytes)).read_info().ok();
    let png = info.as_ref().map(png::Reader::info);
    if let Some(codes) = png.and_then(|png| png.coding_independent_code_points) {
        return colorimetry::cicp(codes);
    }
    if let Some(profile) = decoder.icc_profile().ok().flatten() {
        return ColorProfile::new_from_slice(&profile).ok();
    }
    let png = png.filter(|png| png.srgb.is_none());
    let primaries = png.and_then(|png| png.chrm_chunk).map(|file| {
        [file.red, file.green, file.blue, file.white].map(|(x, y)| [x.into_value(), y.into_value()])
    });
    // An exponent of 2.2 stands for the curve of sRGB.
    let gamma = png.and_then(|png| png.gama_chunk).map(|gamma| 1.0 / gamma.into_value());
    let gamma = gamma.filter(|gamma| (gamma - 2.2).abs() > 0.05);
    Some(colorimetry::chromatic(gamma, primaries))
}

/// Makes texels of the linear values of HDR and EXR files. Values below 0, which filters leave, and NaN
/// become 0. Infinity, which stands for values beyond the range of a half, becomes the largest other number.
fn linear_texels(
    mut pixels: Vec<[f32; 3]>,
    to_rec709: DMat3,
    texel_kind: TexelKind,
    left_out: &mut Vec<String>,
) -> Texels {
    let is_nan = |channel: f32| channel.is_nan() || channel == f32::NEG_INFINITY;
    replace(&mut pixels, is_nan, 0.0, "NaN or negative infinity became 0", left_out);
    let finite = pixels.iter().flatten().copied().filter(|channel| channel.is_finite());
    let largest = Some(finite.fold(0.0, f32::max)).filter(|&largest| largest > 0.0).unwrap_or(1.0);
    let what = format!("infinity became {largest}, the largest other number,");
    replace(&mut pixels, f32::is_infinite, largest, &what, left_out);
    if texel_kind == TexelKind::Color {
        colorimetry::convert(&mut pixels, to_rec709);
    }
    let lowest = pixels.iter().flatten().fold(0.0, |lowest: f32, channel| lowest.min(*channel));
    let what = format!("values below 0, down to {lowest:e}, became 0");
    replace(&mut pixels, |channel| channel < 0.0, 0.0, &what, left_out);
    if texel_kind == TexelKind::AlphaOrGrey {
        // The luminance of Rec. 709; their alpha is not read.
        let grey = |[r, g, b]: [f32; 3]| [0.2126 * r + 0.7152 * g + 0.0722 * b; 3];
        pixels.iter_mut().for_each(|pixel| *pixel = grey(*pixel));
    }
    Texels::Float32(pixels.into_iter().map(|[r, g, b]| [r, g, b, 0.0]).collect())
}

/// Replaces channels, and adds a clause with the number of pixels.
fn replace(
    pixels: &mut [[f32; 3]],
    is_bad: fn(f32) -> bool,
    value: f32,
    what: &str,
    left_out: &mut Vec<String>,
) {
    let mut count = 0;
    for pixel in pixels.iter_mut().filter(|pixel| pixel.iter().any(|&channel| is_bad(channel))) {
        *pixel = pixel.map(|channel| if is_bad(channel) { value } else { channel });
        count += 1;
    }
    if count > 0 {
        left_out.push(format!("{what} in {}", counted(count, "pixel", "pixels")));
    }
}

fn too_large() -> String {
    format!(
        "the image is larger than {MAX_IMAGE_SIDE} texels in width or height, or decodes to more than \
         {MAX_IMAGE_BYTES} bytes"
    )
}

/// Makes texels of the other formats' display values (sRGB) or data, of 8 or 16 bits.
pub fn display_texels(picture: DynamicImage, texel_kind: TexelKind) -> Texels {
    use DynamicImage::{ImageLuma16, ImageLumaA16, ImageRgb16, ImageRgba16};
    match picture {
        ImageLuma16(_) | ImageLumaA16(_) | ImageRgb16(_) | ImageRgba16(_) => {
            // 16 bits do not fit a byte, so they are stored as linear f32.
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
        let add = |textures: &mut Textures, name: &str, filter, texels: u32| {
            let decoded = (1, texels, Texels::Float32(vec![[0.0; 4]; texels as usize]));
            let lookup = Lookup::repeating(filter, TexelKind::Color);
            textures.add((PathBuf::from(name), lookup), name, |_| Ok(decoded))
        };
        let mut textures = Textures { bytes: MAX_BYTES - 17_024, ..Textures::default() };
        // 16 bytes each texel, and not less than a kilobyte.
        assert_eq!(add(&mut textures, "a", Filter::Nearest, 1_000), Ok(0));
        assert_eq!(add(&mut textures, "b", Filter::Nearest, 1), Ok(1));
        assert!(add(&mut textures, "c", Filter::Nearest, 1).is_err());
        assert_eq!(textures.list.len(), 2);
        // Levels of detail count: 1,000 texels in a row have 994 more.
        let mut textures = Textures { bytes: MAX_BYTES - 17_024, ..Textures::default() };
        assert!(add(&mut textures, "d", Filter::Trilinear, 1_000).is_err());
    }
}
