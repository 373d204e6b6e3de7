//! The bytes of a glTF file: its JSON and binary parts, its buffers, data URIs.
//!
//! For: [`split`], [`buffers`], [`Document`], [`from_uri`], and the error [`broken`].

use super::super::error::SceneError;
use super::super::files::{Files, has_extension};
use super::super::json::{JsonPath, Source};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf_json::Root;
use gltf_json::buffer::View;
use percent_encoding::percent_decode_str;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
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

/// The content of a buffer, at least as long as the buffer. Buffers of the same file share it.
pub type Buffer = Rc<[u8]>;

/// The bytes of all buffers, each file counted once.
pub fn total(buffers: &[Buffer]) -> usize {
    let mut seen = HashSet::new();
    buffers.iter().filter(|buffer| seen.insert(Rc::as_ptr(buffer))).map(|buffer| buffer.len()).sum()
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
    let mut read: HashMap<&str, Buffer> = HashMap::new();
    for (index, buffer) in root.buffers.iter().enumerate() {
        let place = list.item(index);
        let content = match (buffer.uri.as_deref(), binary) {
            (Some(uri), _) if read.contains_key(uri) => Rc::clone(&read[uri]),
            (Some(uri), _) => {
                let content = from_uri(uri, source.file, files).map_err(|reason| {
                    let mend = "put the file beside the model, or export the model as .glb";
                    place.key("uri").error(format!("cannot read a buffer: {reason}"), mend)
                })?;
                Rc::clone(read.entry(uri).or_insert(content.into()))
            }
            (None, Some(binary)) if index == 0 => binary.into(),
            (None, _) => return Err(broken(&place, "a buffer without `uri` and without a binary part")),
        };
        let length = buffer.byte_length.0;
        if (content.len() as u64) < length {
            let what = format!("the buffer has {} bytes, not {length}", content.len());
            return Err(broken(&place.key("byteLength"), what));
        }
        buffers.push(content);
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
pub fn from_uri(uri: &str, model: &Path, files: &Files) -> Result<Vec<u8>, String> {
    if is_data(uri) {
        let data = uri.split_once(";base64,").and_then(|(_, data)| BASE64.decode(data).ok());
        return data.ok_or_else(|| "a data URI is not base64".to_string());
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
    percent_decode_str(uri).decode_utf8().map_or(uri.to_string(), Cow::into_owned)
}

/// Base64; padding may be missing.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);
