//! The bytes of a PLY file: header and numbers.
//!
//! For: [`Reader`], [`Element`].

use super::super::error::SceneError;
use std::path::Path;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }
    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
    /// The number that means the colour 1.
    pub fn white(self) -> f64 {
        match self {
            Self::I8 | Self::U8 => 255.0,
            Self::I16 | Self::U16 => 65_535.0,
            Self::I32 | Self::U32 => 4_294_967_295.0,
            Self::F32 | Self::F64 => 1.0,
        }
    }
}

pub struct Property {
    pub name: String,
    pub scalar: Scalar,
    /// The type of a list's length.
    pub list: Option<Scalar>,
}

pub struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

/// A file's bytes, and how far they are read.
pub struct Reader<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    encoding: Encoding,
    at: usize,
    line: usize,
}

impl<'a> Reader<'a> {
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self { path, bytes, encoding: Encoding::Ascii, at: 0, line: 0 }
    }
    pub fn fault(&self, what: impl Into<String>, mend: impl Into<String>) -> SceneError {
        SceneError::new(what)
            .in_file(self.path)
            .at(format!("line {}, byte {}", self.line, self.at))
            .mend(mend)
    }
    fn ends_early(&self) -> SceneError {
        self.fault("the file ends too early", "export the model again")
    }
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }
    /// The next line, without its end; `None` at the end of the file.
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
    /// How many numbers come next of a property.
    pub fn count(&mut self, property: &Property) -> Result<u64, SceneError> {
        property.list.map_or(Ok(1), |length| Ok(self.number(length)? as u64))
    }
    /// The next number.
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
            return number.ok_or_else(|| {
                let word = String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
                self.fault(format!("`{word}` is not a number"), "write a number")
            });
        }
        let mut raw = [0; 8];
        let size = scalar.bytes();
        raw[..size].copy_from_slice(self.rest().get(..size).ok_or_else(|| self.ends_early())?);
        if self.encoding == Encoding::Big {
            raw[..size].reverse();
        }
        self.at += size;
        let [a, b, c, d, ..] = raw;
        Ok(match scalar {
            Scalar::I8 => f64::from(a as i8),
            Scalar::U8 => f64::from(a),
            Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
            Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
            Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Scalar::F64 => f64::from_le_bytes(raw),
        })
    }

    /// Everything up to `end_header`.
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
                    elements.push(Element { name: name.to_string(), count, properties: Vec::new() });
                }
                ["property", ref property @ ..] => {
                    let (scalar, list, name) = match *property {
                        ["list", length, scalar, name] => (scalar, Some(length), name),
                        [scalar, name] => (scalar, None, name),
                        _ => return Err(self.fault("this is not a property", MEND)),
                    };
                    let [scalar, length] = [Some(scalar), list].map(|name| name.map(Scalar::of));
                    let (Some(Some(scalar)), None | Some(Some(_))) = (scalar, length) else {
                        return Err(self.fault("the type of the property is unknown", MEND));
                    };
                    let element =
                        elements.last_mut().ok_or_else(|| self.fault("a property of no element", MEND))?;
                    element.properties.push(Property {
                        name: name.to_string(),
                        scalar,
                        list: length.flatten(),
                    });
                }
                ["end_header"] => break,
                ["comment" | "obj_info", ..] | [] => {}
                _ => return Err(self.fault(format!("`{line}` does not belong into a header"), MEND)),
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
            Encoding::Little | Encoding::Big => property.list.unwrap_or(property.scalar).bytes(),
        });
        let least: usize = least.sum();
        let needed = least.checked_mul(element.count);
        // The last number of a file has no space behind it.
        if needed.is_none_or(|needed| needed > self.rest().len() + 1) {
            let what = format!("{} elements `{}` are more than the file holds", element.count, element.name);
            return Err(self.fault(what, "export the model again"));
        }
        Ok(())
    }
}
