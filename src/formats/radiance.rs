//! Radiance pictures (.hdr, .pic): what their header says.
//!
//! For: [`Radiance`]. The `image` crate decodes the pixels, but knows one orientation and refuses XYZE.
//!
//! Source: G. Ward, "Radiance File Formats", 2024, section 4.

use crate::colorimetry::{to_rec709, xyz_to_rec709};
use glam::DMat3;
use image::DynamicImage;

/// A file of scan lines from the top, each from the left, and what its own header says of them.
pub struct Radiance {
    /// The file with another header.
    pub file: Vec<u8>,
    /// To linear Rec. 709.
    pub matrix: DMat3,
    /// What is left out, as clauses.
    pub left_out: Vec<String>,
    /// Do scan lines run along y?
    is_turned: bool,
    /// Do they go against x, from the right, and against y, from the bottom?
    is_flipped: [bool; 2],
}

impl Radiance {
    /// Reads the header of a file that begins with `#?`: the first line may name any program.
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
                    left_out.push(format!("its `{line}` is not undone: divide by it for radiance"));
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
        let (is_turned, x, y) = match (slow, fast) {
            ("+Y" | "-Y", "+X" | "-X") => (false, fast, slow),
            ("+X" | "-X", "+Y" | "-Y") => (true, slow, fast),
            _ => return Err(unknown()),
        };
        if is_xyz {
            matrix = xyz_to_rec709();
        }
        let header = format!("#?RADIANCE\n\n-Y {count} +X {length}\n");
        let file = [header.as_bytes(), rest].concat();
        Ok(Self { file, matrix, left_out, is_turned, is_flipped: [x == "-X", y == "+Y"] })
    }

    /// The decoded picture as it is seen.
    pub fn turn(&self, picture: DynamicImage) -> DynamicImage {
        let picture = if self.is_turned { picture.rotate90().fliph() } else { picture };
        let [from_right, from_bottom] = self.is_flipped;
        let picture = if from_right { picture.fliph() } else { picture };
        if from_bottom { picture.flipv() } else { picture }
    }
}
