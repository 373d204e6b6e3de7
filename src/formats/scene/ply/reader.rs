//! Reads the header and the numbers of a PLY file.

use super::super::error::SceneError;
use super::super::notes::Notes;
use super::super::scalar::{Kind, Scalar};
use std::path::Path;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

fn scalar(name: &str) -> Option<Scalar> {
    let (kind, bytes) = match name {
        "char" | "int8" => (Kind::Signed, 1),
        "uchar" | "uint8" => (Kind::Unsigned, 1),
        "short" | "int16" => (Kind::Signed, 2),
        "ushort" | "uint16" => (Kind::Unsigned, 2),
        "int" | "int32" => (Kind::Signed, 4),
        "uint" | "uint32" => (Kind::Unsigned, 4),
        "float" | "float32" => (Kind::Real, 4),
        "double" | "float64" => (Kind::Real, 8),
        _ => return None,
    };
    Some(Scalar { kind, bytes })
}

pub struct Property {
    pub name: String,
    pub line: usize,
    pub scalar: Scalar,
    /// The type of a list's length.
    pub list: Option<Scalar>,
}

impl Property {
    /// Tests whether it lists the vertices of a face.
    pub fn is_corners(&self) -> bool {
        self.list.is_some() && ["vertex_indices", "vertex_index"].contains(&self.name.as_str())
    }
    /// Tests whether it lists the texture coordinates of a face's corners.
    pub fn is_uvs(&self) -> bool {
        self.list.is_some() && self.name == "texcoord"
    }
}

pub struct Element {
    pub name: String,
    pub line: usize,
    pub count: usize,
    pub properties: Vec<Property>,
}

/// A reader of a file's bytes.
pub struct Reader<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    encoding: Encoding,
    /// Number of bytes read.
    at: usize,
    /// Number of lines read.
    line: usize,
    /// The image files that the header names, with their lines.
    pub images: Vec<(String, usize)>,
    /// Notes about the file.
    pub notes: Notes,
}

impl<'a> Reader<'a> {
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        let (images, notes) = (Vec::new(), Notes::default());
        Self { path, bytes, encoding: Encoding::Ascii, at: 0, line: 0, images, notes }
    }
    pub fn fault(&self, what: impl Into<String>, mend: impl Into<String>) -> SceneError {
        SceneError::new(what)
            .in_file(self.path)
            .at_place(format!("line {}, byte {}", self.line, self.at))
            .mend(mend)
    }
    fn ends_early(&self) -> SceneError {
        self.fault("the file ends too early", "export the model again")
    }
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }
    /// Reads the next line, without its end; `None` at the end of the file.
    fn next_line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        self.line += 1;
        Some(rest[..end].trim_ascii())
    }
    /// Reads how many numbers of a property follow.
    pub fn count(&mut self, property: &Property) -> Result<u64, SceneError> {
        let Some(length) = property.list else { return Ok(1) };
        let count = self.number(length)?;
        if count >= 0.0 && count.fract() == 0.0 {
            return Ok(count as u64);
        }
        Err(self.fault(format!("{count} is not the length of a list"), "export the model again"))
    }
    /// Reads the next number. A word that is no number becomes NaN, with a note unless it stands for NaN or
    /// infinity.
    #[inline]
    pub fn number(&mut self, scalar: Scalar) -> Result<f64, SceneError> {
        if self.encoding == Encoding::Ascii {
            let space = self.rest().iter().position(|byte| !byte.is_ascii_whitespace());
            let skipped = &self.rest()[..space.ok_or_else(|| self.ends_early())?];
            self.line += skipped.iter().filter(|&&byte| byte == b'\n').count();
            self.at += skipped.len();
            let rest = self.rest();
            let word = &rest[..rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len())];
            let number = std::str::from_utf8(word).ok().and_then(|word| word.parse::<f64>().ok());
            self.at += word.len();
            // Words such as `-nan(ind)` and `1.#QNAN` stand for NaN.
            if number.is_none() && !word.iter().any(|byte| b"(#".contains(byte)) {
                let word = String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
                let fault = self.fault(format!("`{word}` is not a number"), "write a number");
                self.notes.add_fault("a number", fault);
            }
            return Ok(number.unwrap_or(f64::NAN));
        }
        let bytes = self.rest().get(..scalar.bytes).ok_or_else(|| self.ends_early())?;
        self.at += bytes.len();
        if self.encoding == Encoding::Little {
            return Ok(scalar.read(bytes));
        }
        let mut turned = [0; 8];
        turned[..bytes.len()].copy_from_slice(bytes);
        turned[..bytes.len()].reverse();
        Ok(scalar.read(&turned[..bytes.len()]))
    }

    /// Reads everything up to `end_header`.
    pub fn header(&mut self) -> Result<Vec<Element>, SceneError> {
        const MEND: &str = "export the model again as PLY 1.0";
        if self.next_line() != Some(b"ply") {
            let what = "this is not a PLY file: its first line is not `ply`";
            return Err(SceneError::new(what).in_file(self.path).mend(MEND));
        }
        let (mut encoding, mut elements) = (None, Vec::<Element>::new());
        loop {
            let line = self.next_line().ok_or_else(|| self.ends_early())?;
            let line = String::from_utf8_lossy(line);
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                ["format", "ascii", _] => encoding = Some(Encoding::Ascii),
                ["format", "binary_little_endian", _] => encoding = Some(Encoding::Little),
                ["format", "binary_big_endian", _] => encoding = Some(Encoding::Big),
                ["element", name, count] => {
                    let count =
                        count.parse().map_err(|_| self.fault(format!("`{count}` is not a count"), MEND))?;
                    let (name, line) = (name.to_string(), self.line);
                    elements.push(Element { name, line, count, properties: Vec::new() });
                }
                ["property", ref property @ ..] => {
                    let (scalar_type, list, name) = match *property {
                        ["list", length, scalar_type, name] => (scalar_type, Some(length), name),
                        [scalar_type, name] => (scalar_type, None, name),
                        _ => return Err(self.fault("this is not a property", MEND)),
                    };
                    let unknown = || self.fault("the type of the property is unknown", MEND);
                    let known = |name: &str| scalar(name).ok_or_else(unknown);
                    let element =
                        elements.last_mut().ok_or_else(|| self.fault("a property of no element", MEND))?;
                    element.properties.push(Property {
                        name: name.to_string(),
                        line: self.line,
                        scalar: known(scalar_type)?,
                        list: list.map(known).transpose()?,
                    });
                }
                ["end_header"] => break,
                ["comment", "TextureFile", _, ..] => {
                    let name = line.split_once("TextureFile").map_or("", |(_, name)| name.trim());
                    self.images.push((name.to_string(), self.line));
                }
                ["comment" | "obj_info", ..] | [] => {}
                _ => return Err(self.fault(format!("`{line}` is no line of a header"), MEND)),
            }
        }
        self.encoding = encoding.ok_or_else(|| self.fault("the header has no `format`", MEND))?;
        // Numbers begin on the next line.
        self.line += 1;
        Ok(elements)
    }

    /// Refuses more elements than the rest of the file can hold.
    pub fn check_count(&self, element: &Element) -> Result<(), SceneError> {
        let least = element.properties.iter().map(|property| match self.encoding {
            // A digit and a space.
            Encoding::Ascii => 2,
            Encoding::Little | Encoding::Big => property.list.unwrap_or(property.scalar).bytes,
        });
        let least: usize = least.sum();
        let needed = least.checked_mul(element.count);
        // The last number of a file may have no space after it.
        if needed.is_none_or(|needed| needed > self.rest().len() + 1) {
            let what = format!("{} elements `{}` are more than the file holds", element.count, element.name);
            return Err(self.fault(what, "export the model again"));
        }
        Ok(())
    }
}
