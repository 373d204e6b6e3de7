//! Reads the headers of Radiance pictures (.hdr, .pic).
//!
//! The `image` crate decodes the pixels, but knows only one orientation and refuses XYZE.
//!
//! Source: G. Ward, "Radiance File Formats", 2024, section 4.

use super::colorimetry::{to_rec709, xyz_to_rec709};
use glam::DMat3;
use image::DynamicImage;

/// A picture whose header is replaced by one of scan lines from the top and from the left.
pub struct Radiance {
    /// The file with the replaced header.
    pub file: Vec<u8>,
    /// The matrix to linear Rec. 709.
    pub matrix: DMat3,
    /// One clause for everything that is left out.
    pub left_out: Vec<String>,
    /// The direction from scan line to scan line, and that from pixel to pixel, as in `-Y +X`.
    axes: String,
}

impl Radiance {
    /// Reads the header of a file that begins with `#?`. The first line may name any program.
    pub fn new(bytes: &[u8]) -> Result<Self, String> {
        let (mut rest, mut is_xyz, mut matrix, mut left_out) = (bytes, false, DMat3::IDENTITY, Vec::new());
        let mut line = || -> Result<String, String> {
            let end = rest.iter().position(|&byte| byte == b'\n');
            let end = end.ok_or("the image is broken: its header ends early")?;
            let line = String::from_utf8_lossy(&rest[..end]).trim().to_string();
            rest = &rest[end + 1..];
            Ok(line)
        };
        loop {
            let line = line()?;
            let Some((key, value)) = line.split_once('=') else {
                if line.is_empty() { break } else { continue }
            };
            let numbers: Vec<f32> = value.split_whitespace().map_while(|word| word.parse().ok()).collect();
            match key.trim() {
                "FORMAT" => match value.trim() {
                    "32-bit_rle_rgbe" => {}
                    "32-bit_rle_xyze" => is_xyz = true,
                    other => {
                        return Err(format!("its FORMAT `{other}` is neither 32-bit_rle_rgbe nor _xyze"));
                    }
                },
                "EXPOSURE" | "COLORCORR" if numbers.iter().any(|&factor| factor != 1.0) => {
                    left_out.push(format!("its `{line}` is ignored: divide by it for radiance"));
                }
                "PRIMARIES" => match numbers.as_chunks().0.try_into().ok().and_then(to_rec709) {
                    Some(found) => matrix = found,
                    None => left_out.push(format!("its `{line}` is left out: it is read as Rec. 709")),
                },
                _ => {}
            }
        }
        let resolution = line()?;
        let words: Vec<&str> = resolution.split_whitespace().collect();
        let unknown =
            || format!("the image is broken: `{resolution}` is no resolution, such as -Y 512 +X 1024");
        let [slow, count, fast, length] = words[..] else { return Err(unknown()) };
        let axes = format!("{slow} {fast}");
        if !matches!((slow, fast), ("+Y" | "-Y", "+X" | "-X") | ("+X" | "-X", "+Y" | "-Y")) {
            return Err(unknown());
        }
        let header = format!("#?RADIANCE\n\n-Y {count} +X {length}\n");
        let matrix = if is_xyz { xyz_to_rec709() } else { matrix };
        Ok(Self { file: [header.as_bytes(), rest].concat(), matrix, left_out, axes })
    }

    /// Turns the decoded picture upright.
    pub fn turn(&self, picture: DynamicImage) -> DynamicImage {
        let picture = if self.axes.ends_with('Y') { picture.rotate90().fliph() } else { picture };
        let picture = if self.axes.contains("-X") { picture.fliph() } else { picture };
        if self.axes.contains("+Y") { picture.flipv() } else { picture }
    }
}
