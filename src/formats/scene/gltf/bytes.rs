//! The bytes of a glTF file: its JSON and binary parts, its buffers, data URIs.
//!
//! For: [`split`], [`buffers`], [`Document`], [`from_uri`], and the error [`broken`].

use super::super::error::SceneError;
use super::super::files::{Files, has_extension};
use super::super::json::{JsonPath, Source};
use gltf_json::Root;
use gltf_json::buffer::View;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::rc::Rc;

const EXPORT_AGAIN: &str = "export the model again";

/// An error about a value that no person writes.
pub fn broken(place: &JsonPath, what: impl Into<String>) -> SceneError {
    place.error(what, EXPORT_AGAIN)
}

/// The JSON text, and the binary part of a .glb file, of which all lengths are checked.
pub fn split<'a>(content: &'a [u8], path: &Path) -> Result<(&'a str, Option<&'a [u8]>), SceneError> {
    let fault = |what: String| SceneError::new(what).in_file(path).mend(EXPORT_AGAIN);
    let text = |bytes: &'a [u8], what: &str| {
        let text = std::str::from_utf8(bytes).map_err(|_| fault(what.into()))?;
        Ok(text.trim_start_matches('\u{feff}'))
    };
    if !content.starts_with(b"glTF") {
        let neither =
            |nor: &str| format!("this is not glTF: neither binary, which begins with `glTF`, nor {nor}");
        let text = text(content, &neither("text in UTF-8"))?;
        if has_extension(path, "glb") && !text.trim_start().starts_with('{') {
            return Err(fault(neither("JSON")));
        }
        return Ok((text, None));
    }
    let word = |at: usize| {
        let bytes = content.get(at..at + 4)?;
        Some(u32::from_le_bytes(bytes.try_into().expect("four bytes")))
    };
    if word(4) != Some(2) {
        return Err(fault("this is not binary glTF of version 2".into()));
    }
    let (mut json, mut binary, mut at) = (None, None, 12);
    while let (Some(length), Some(kind)) = (word(at), word(at + 4)) {
        let chunk = content.get(at + 8..).and_then(|rest| rest.get(..length as usize)).ok_or_else(|| {
            let rest = content.len() - at - 8;
            fault(format!("a chunk at byte {at} says it has {length} bytes, and the file has {rest} more"))
        })?;
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(text(chunk, "the JSON is not UTF-8")?),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            // Others are to be skipped.
            _ => {}
        }
        at += 8 + chunk.len();
    }
    Ok((json.ok_or_else(|| fault("the file has no JSON chunk".into()))?, binary))
}

/// The content of a buffer. Buffers of the same file share it.
pub struct Buffer {
    content: Rc<[u8]>,
    length: usize,
}

impl Deref for Buffer {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.content[..self.length]
    }
}

/// The bytes of all buffers, each file counted once.
pub fn total(buffers: &[Buffer]) -> usize {
    let mut seen = HashSet::new();
    let first = buffers.iter().filter(|buffer| seen.insert(Rc::as_ptr(&buffer.content)));
    first.map(|buffer| buffer.content.len()).sum()
}

/// The content of every buffer.
pub fn buffers(
    source: &Source,
    root: &Root,
    binary: Option<&[u8]>,
    files: &Files,
) -> Result<Vec<Buffer>, SceneError> {
    let list = source.root();
    let list = list.key("buffers");
    let mut buffers = Vec::new();
    let mut read: HashMap<&str, Rc<[u8]>> = HashMap::new();
    for (index, buffer) in root.buffers.iter().enumerate() {
        let place = list.item(index);
        let content = match (buffer.uri.as_deref(), binary) {
            (Some(uri), _) if read.contains_key(uri) => Rc::clone(&read[uri]),
            (Some(uri), _) => {
                let content = from_uri(uri, source.file, files).map_err(|reason| {
                    let mend = "put the file beside the model, or export the model as .glb";
                    place.key("uri").error(format!("cannot read a buffer: {reason}"), mend)
                })?;
                Rc::clone(read.entry(uri).or_insert(content.into_owned().into()))
            }
            (None, Some(binary)) if index == 0 => binary.into(),
            (None, _) => return Err(broken(&place, "a buffer without `uri` and without a binary part")),
        };
        let length = buffer.byte_length.0;
        if (content.len() as u64) < length {
            let what = format!("the buffer has {} bytes, not {length}", content.len());
            return Err(broken(&place.key("byteLength"), what));
        }
        buffers.push(Buffer { content, length: length as usize });
    }
    Ok(buffers)
}

/// A file's JSON and its buffers.
pub struct Document<'a> {
    pub source: Source<'a>,
    pub root: &'a Root,
    pub buffers: &'a [Buffer],
}

impl Document<'_> {
    /// A buffer view and its bytes; `None` where it reaches beyond its buffer, or where there is none.
    pub fn view(&self, index: usize) -> Option<(&View, &[u8])> {
        let view = self.root.buffer_views.get(index)?;
        let buffer = self.buffers.get(view.buffer.value())?;
        let start = usize::try_from(view.byte_offset.unwrap_or_default().0).ok()?;
        let length = usize::try_from(view.byte_length.0).ok()?;
        Some((view, buffer.get(start..)?.get(..length)?))
    }
}

/// The content that a URI names: a data URI, or a file beside the model.
pub fn from_uri(uri: &str, model: &Path, files: &Files) -> Result<Cow<'static, [u8]>, String> {
    if is_data(uri) {
        let data = uri.split_once(";base64,").and_then(|(_, data)| base64(data.as_bytes()));
        return data.map(Cow::Owned).ok_or_else(|| "a data URI is not base64".to_string());
    }
    let path = path(uri, model);
    files.read(&path).map_err(|reason| format!("{}: {reason}", path.display()))
}

/// The file that a URI names.
pub fn path(uri: &str, model: &Path) -> PathBuf {
    model.with_file_name(decoded(uri))
}

/// Whether a URI is content and not a name.
pub fn is_data(uri: &str) -> bool {
    uri.starts_with("data:") && uri.contains(',')
}

/// Percent-encoded bytes decoded.
pub fn decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let (mut plain, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let escaped = (bytes[at] == b'%')
            .then(|| uri.get(at + 1..at + 3).and_then(|hex| u8::from_str_radix(hex, 16).ok()))
            .flatten();
        plain.push(escaped.unwrap_or(bytes[at]));
        at += if escaped.is_some() { 3 } else { 1 };
    }
    String::from_utf8(plain).unwrap_or_else(|_| uri.to_string())
}

/// Base64 (RFC 4648 §4); padding may be missing.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text.strip_suffix(b"==").or(text.strip_suffix(b"=")).unwrap_or(text);
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    for group in text.chunks(4) {
        let mut bits = 0_u32;
        for &letter in group {
            let value = match letter {
                b'A'..=b'Z' => letter - b'A',
                b'a'..=b'z' => letter - b'a' + 26,
                b'0'..=b'9' => letter - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            bits = bits << 6 | u32::from(value);
        }
        bits <<= 6 * (4 - group.len());
        let whole = match group.len() {
            1 => return None,
            length => length - 1,
        };
        bytes.extend_from_slice(&bits.to_be_bytes()[1..1 + whole]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_decodes_every_length_and_refuses_what_is_none() {
        // RFC 4648 §10.
        let cases =
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmFy", "foobar"), ("Zm8", "fo")];
        for (text, plain) in cases {
            assert_eq!(base64(text.as_bytes()).as_deref(), Some(plain.as_bytes()), "{text}");
        }
        for text in ["Z", "Zg=a", "Z\n9v", "Zm9vY"] {
            assert_eq!(base64(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn names_are_decoded() {
        assert_eq!(decoded("a%20b%2Fc%zz%e2%82%ac%"), "a b/c%zz€%");
    }
}
