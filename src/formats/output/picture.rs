//! Encodes a picture as PNG, JPEG, EXR or HDR, and saves it.

use super::error::OutputError;
use super::file::{CancellableWriter, Existing, InsertingWriter, write_atomically};
use crate::openexr;
use image::codecs::{hdr::HdrEncoder, jpeg::JpegEncoder, png::PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError};
use octray_engine::film::Picture;
use octray_engine::render::aovs::ChannelValues;
use octray_engine::tone::Tone;
use std::io::{self, Seek, Write};
use std::path::Path;

/// Quality of JPEG files, of 100. From here on, artefacts are hard to see in rendered noise.
const JPEG_QUALITY: u8 = 95;

/// A picture file's format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Eight bits a channel, sRGB, lossless.
    Png,
    /// Eight bits a channel, sRGB, lossy.
    Jpeg,
    /// OpenEXR: linear f32, lossless, every bit of the film's average.
    Exr,
    /// Radiance RGBE: linear, eight bits of mantissa under an exponent that the three channels share.
    Hdr,
}

impl Format {
    /// Returns the format of a file name's extension, which may be in upper or lower case.
    pub fn from_path(path: &Path) -> Result<Self, OutputError> {
        let extension =
            path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("jpg" | "jpeg") => Ok(Self::Jpeg),
            Some("exr") => Ok(Self::Exr),
            Some("hdr") => Ok(Self::Hdr),
            _ => Err(OutputError::UnknownFormat { path: path.to_owned() }),
        }
    }

    /// Tests whether the format holds linear radiance, on which exposure and tone mapping have no effect.
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Exr | Self::Hdr)
    }
}

/// Encodes a picture. A `comment` in ASCII, unless it is empty, becomes part of the file's metadata.
///
/// # Panics
/// If the number of pixels is not `width · height`.
pub fn encode(
    out: impl Write + Seek,
    picture: &Picture,
    (format, comment): (Format, &str),
    tone: &Tone,
) -> Result<(), io::Error> {
    let mut out = InsertingWriter::new(out, comment_bytes(format, comment));
    let Picture { width, height, ref pixels } = *picture;
    assert_eq!(pixels.len(), width as usize * height as usize, "a picture has width · height pixels");
    let (eight, float) = (ExtendedColorType::Rgb8, ExtendedColorType::Rgb32F);
    let done = match format {
        Format::Png => PngEncoder::new(&mut out).write_image(&tone.bytes(picture), width, height, eight),
        Format::Jpeg => {
            let encoder = JpegEncoder::new_with_quality(&mut out, JPEG_QUALITY);
            encoder.write_image(&tone.bytes(picture), width, height, eight)
        }
        Format::Exr => openexr::write(&mut out, picture, comment).map_err(ImageError::IoError),
        Format::Hdr => {
            let rounded: Vec<[f32; 3]> = pixels.iter().copied().map(round_to_rgbe).collect();
            HdrEncoder::new(&mut out).write_image(bytemuck::cast_slice(&rounded), width, height, float)
        }
    };
    done.map_err(|error| match error {
        ImageError::IoError(error) => error,
        other => io::Error::other(other),
    })?;
    out.flush()
}

/// Saves a picture in the format of the file name's extension. `tone` applies to PNG and JPEG only, because
/// EXR and HDR hold linear radiance. Afterwards the file is complete, or as it was before.
pub fn save(path: &Path, picture: &Picture, tone: &Tone) -> Result<(), OutputError> {
    save_unless(path, picture, (tone, ""), &|| false)
}

/// Saves a picture as [`save`] does, with a comment in its metadata, but fails and keeps any earlier file
/// once `cancelled` returns true.
pub fn save_unless(
    path: &Path,
    picture: &Picture,
    (tone, comment): (&Tone, &str),
    cancelled: &dyn Fn() -> bool,
) -> Result<(), OutputError> {
    let format = Format::from_path(path)?;
    write_atomically(path, Existing::Replace, |inner| {
        encode(CancellableWriter { inner, cancelled }, picture, (format, comment), tone)
    })
}

/// Saves pixels of display values, 0x00RRGGBB, as PNG, with a comment in its metadata.
pub fn save_shown(path: &Path, size: [u32; 2], pixels: &[u32], comment: &str) -> Result<(), OutputError> {
    let bytes: Vec<u8> = pixels.iter().flat_map(|pixel| pixel.to_be_bytes().into_iter().skip(1)).collect();
    write_atomically(path, Existing::Replace, |out| {
        let mut out = InsertingWriter::new(out, comment_bytes(Format::Png, comment));
        let written =
            PngEncoder::new(&mut out).write_image(&bytes, size[0], size[1], ExtendedColorType::Rgb8);
        written.map_err(io::Error::other)
    })
}

/// Saves named channels of a picture's size as layers of an EXR file: see [`openexr::write_channels`].
pub fn save_channels(
    path: &Path,
    size: [u32; 2],
    channels: Vec<(String, ChannelValues)>,
) -> Result<(), OutputError> {
    let samples = |values| match values {
        ChannelValues::Numbers(numbers) => openexr::FlatSamples::F32(numbers),
        ChannelValues::Indices(indices) => openexr::FlatSamples::U32(indices),
    };
    let channels = channels.into_iter().map(|(name, values)| (name, samples(values))).collect();
    write_atomically(path, Existing::Replace, |out| openexr::write_channels(out, size, channels))
}

/// Returns where a comment belongs in a file of this format, and the bytes that hold it there.
fn comment_bytes(format: Format, comment: &str) -> (usize, Vec<u8>) {
    let length = comment.len();
    match format {
        _ if comment.is_empty() => (0, Vec::new()),
        // Behind the signature and the first chunk: a chunk of text, with its length and checksum.
        Format::Png => {
            let chunk = [b"tEXtComment\0", comment.as_bytes()].concat();
            let (length, sum) = (chunk.len() as u32 - 4, crc32fast::hash(&chunk));
            (33, [&length.to_be_bytes()[..], &chunk, &sum.to_be_bytes()].concat())
        }
        // Behind the first two segments, start and JFIF: a segment of comment, whose length counts itself.
        Format::Jpeg => {
            (20, [&[0xff, 0xfe], &(length as u16 + 2).to_be_bytes()[..], comment.as_bytes()].concat())
        }
        // Behind the line `#?RADIANCE`.
        Format::Hdr => (11, format!("# {comment}\n").into_bytes()),
        // An attribute, which `openexr::write` adds.
        Format::Exr => (0, Vec::new()),
    }
}

/// Rounds to the nearest colour that a Radiance file can hold: each channel is a whole number of 256ths of
/// the power of two above the largest channel.
///
/// The encoder of the `image` crate truncates mantissas, which darkens a picture by half a step on average,
/// and its exponents wrap around at both ends of f32's range. It encodes the colours returned here without
/// change.
///
/// Domain: all of f32. NaN, negative values and values below 2⁻¹²⁰ become 0; the maximum is 255 · 2¹¹⁹.
/// Error: at most 2⁻⁸ of the largest channel.
fn round_to_rgbe(pixel: [f32; 3]) -> [f32; 3] {
    const LEAST: f32 = 7.523_164e-37; // 2⁻¹²⁰
    const MOST: f32 = 1.694_847_4e38; // 255 · 2¹¹⁹
    let pixel = pixel.map(|channel| if channel > 0.0 { channel.min(MOST) } else { 0.0 });
    let largest = pixel[0].max(pixel[1]).max(pixel[2]);
    if largest < LEAST {
        return [0.0; 3];
    }
    let exponent_of = |x: f32| (x.to_bits() >> 23) as i32 - 127;
    // A 256th of the power of two above `x`. `powi` of two is exact in this range.
    let step_of = |x: f32| 2.0_f32.powi(exponent_of(x) - 7);
    let round = |step: f32| pixel.map(|channel| (channel / step).round() * step);
    let step = step_of(largest);
    // If the largest channel rounds up to the next power of two, the step doubles: 256 steps become 128.
    if (largest / step).round() >= 256.0 { round(step * 2.0) } else { round(step) }
}
