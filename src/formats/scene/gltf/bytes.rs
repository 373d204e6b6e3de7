//! Reads the bytes of a glTF file: its JSON and binary parts, its buffers, data URIs.

use super::super::error::SceneError;
use super::super::faults::fault;
use super::super::files::{Files, has_extension};
use super::super::json::{JsonPath, Source};
use super::schema::{List, Root, View};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;
use serde::de::DeserializeOwned;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::rc::Rc;

const EXPORT_AGAIN: &str = "export the model again";

/// Makes an error about a value that no person writes.
pub fn broken(place: &JsonPath, what: impl Into<String>) -> SceneError {
    place.error(what, EXPORT_AGAIN)
}

/// Splits a file into its JSON text and, of a .glb file, its binary part. All lengths are checked.
pub fn split<'a>(content: &'a [u8], path: &Path) -> Result<(&'a str, Option<&'a [u8]>), SceneError> {
    let refused = |what: String| SceneError::new(what).in_file(path).mend(EXPORT_AGAIN);
    let text = |bytes: &'a [u8], what: &str| {
        let text = std::str::from_utf8(bytes).map_err(|_| refused(what.into()))?;
        // Some programs fill the chunk with zeros.
        Ok(text.trim_start_matches('\u{feff}').trim_end_matches('\0'))
    };
    if !content.starts_with(b"glTF") {
        let neither =
            |nor: &str| format!("this is not glTF: neither binary, which begins with `glTF`, nor {nor}");
        let text = text(content, &neither("text in UTF-8"))?;
        if has_extension(path, "glb") && !text.trim_start().starts_with('{') {
            return Err(refused(neither("JSON")));
        }
        return Ok((text, None));
    }
    let word = |at: usize| {
        let bytes = content.get(at..at + 4)?;
        Some(u32::from_le_bytes(bytes.try_into().expect("four bytes")))
    };
    if word(4) != Some(2) {
        return Err(refused("this is not binary glTF of version 2".into()));
    }
    let length = word(8).unwrap_or(u32::MAX) as usize;
    if length > content.len() {
        let what = format!("the file is cut off: it should have {length} bytes, and has {}", content.len());
        return Err(refused(what));
    }
    let (mut json, mut binary, mut at) = (None, None, 12);
    while let (Some(length), Some(kind)) = (word(at).filter(|_| at < length), word(at + 4)) {
        let chunk = content.get(at + 8..).and_then(|rest| rest.get(..length as usize)).ok_or_else(|| {
            let rest = content.len() - at - 8;
            refused(format!("a chunk at byte {at} says it has {length} bytes, and the file has {rest} more"))
        })?;
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(text(chunk, "the JSON is not UTF-8")?),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            // The standard demands that other chunks are skipped.
            _ => {}
        }
        at += 8 + chunk.len();
    }
    Ok((json.ok_or_else(|| refused("the file has no JSON chunk".into()))?, binary))
}

/// The content of a buffer. Buffers of the same file share it.
pub type Content = Rc<[u8]>;

/// Returns the number of bytes of all buffers, with each file counted once.
pub fn total(buffers: &[Result<Content, String>]) -> usize {
    let mut seen = HashSet::new();
    let contents = buffers.iter().flatten();
    contents.filter(|content| seen.insert(Rc::as_ptr(content))).map(|content| content.len()).sum()
}

/// Reads the content of every buffer, or the reason why there is none.
pub fn buffers(
    root: &Root,
    binary: Option<&[u8]>,
    model: &Path,
    files: &Files,
) -> Vec<Result<Content, String>> {
    let mut known = HashMap::new();
    let mut contents = vec![Err(String::new()); root.buffers.len()];
    for (index, buffer) in root.buffers.iter() {
        contents[index] = match (buffer.uri.as_deref(), binary) {
            (Some(uri), _) => {
                known.entry(uri).or_insert_with(|| from_uri(uri, model, files).map(Content::from)).clone()
            }
            (None, Some(binary)) if index == 0 => Ok(binary.into()),
            (None, _) => Err("it is missing, and the file has no binary part".to_string()),
        };
    }
    contents
}

/// A file's JSON and its buffers.
pub struct Document<'a> {
    pub source: Source<'a>,
    pub root: &'a Root,
    pub buffers: &'a [Result<Content, String>],
}

impl Document<'_> {
    /// Returns an entry of the list at the key `name`, which the value at `user` names by its index.
    pub fn get<'l, T: DeserializeOwned>(
        &self,
        list: &'l List<T>,
        name: &str,
        index: usize,
        user: &JsonPath,
    ) -> Result<&'l T, SceneError> {
        list.get(index).ok_or_else(|| {
            let missing = || broken(user, format!("there is no `{name}[{index}]`"));
            fault::<T>(&self.source.root().key(name).item(index)).unwrap_or_else(missing)
        })
    }
    /// Returns a buffer view and its bytes, or its fault.
    pub fn view(&self, index: usize) -> Result<(&View, &[u8]), String> {
        let broken = |what: &str| format!("`{what}` is missing, or does not follow the standard");
        let view =
            self.root.buffer_views.get(index).ok_or_else(|| broken(&format!("bufferViews[{index}]")))?;
        let name = format!("buffers[{}]", view.buffer.0);
        let buffer = self.root.buffers.get(view.buffer.0).ok_or_else(|| broken(&name))?;
        let content = self.buffers[view.buffer.0].as_ref().map_err(|why| format!("`{name}.uri`: {why}"))?;
        if content.len() < buffer.byte_length.0 {
            return Err(format!("`{name}` has {} bytes, not {}", content.len(), buffer.byte_length.0));
        }
        let bytes = content.get(view.byte_offset.0..).and_then(|rest| rest.get(..view.byte_length.0));
        Ok((view, bytes.ok_or_else(|| format!("`bufferViews[{index}]` reaches beyond its buffer"))?))
    }
}

/// Reads the content of a URI: a data URI, or a file beside the model.
pub fn from_uri(uri: &str, model: &Path, files: &Files) -> Result<Vec<u8>, String> {
    match data(uri) {
        Some(data) => decoded_data(data),
        None => {
            let name = decoded(uri);
            files.find(&name, [model; 2], |path| files.read(path)).map_err(|why| format!("{name}: {why}"))
        }
    }
}

/// Returns what follows the scheme of a data URI.
pub fn data(uri: &str) -> Option<&str> {
    let (scheme, data) = uri.split_once(':')?;
    scheme.eq_ignore_ascii_case("data").then_some(data)
}

/// Decodes a data URI (RFC 2397): percent-encoded, and base64 beneath that where it says so.
fn decoded_data(data: &str) -> Result<Vec<u8>, String> {
    let (header, data) = data.split_once(',').ok_or("a data URI has no comma before its data")?;
    let bytes = Cow::from(percent_decode_str(data));
    if header.rsplit(';').next().is_none_or(|last| !last.trim().eq_ignore_ascii_case("base64")) {
        return Ok(bytes.into_owned());
    }
    // Some programs break lines.
    let in_one_line = || bytes.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect::<Vec<_>>();
    let content = BASE64.decode(&bytes).or_else(|_| BASE64.decode(in_one_line()));
    content.map_err(|_| "a data URI is not base64".to_string())
}

/// Decodes percent-encoded bytes.
pub fn decoded(uri: &str) -> String {
    percent_decode_str(uri).decode_utf8().map_or(uri.to_string(), Cow::into_owned)
}

/// Base64, whose padding may be missing.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);
