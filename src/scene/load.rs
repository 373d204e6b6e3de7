//! From a name on the command line to a [`Scene`].
//!
//! For: [`load`]. May import: scene's own files. Must never know: what a scene is used for.

use super::file::{FORMAT, read};
use super::files::{Files, read_named};
use super::place::Source;
use super::{Scene, SceneError, builtin, obj, procedural, thesis, validate};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use std::path::Path;

/// Loads a scene: `builtin:NAME`, a mesh made by rule (`builtin:knot:N`), the path of an .obj file (framed automatically under a plain sky), or the path of a
/// .json file in the native format or the thesis's own.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    if let Some(name) = spec.strip_prefix(builtin::PREFIX) {
        if let Some(shape) = procedural::read(name)? {
            return shape.scene(spec);
        }
        let source = Source { file: Path::new(spec), text: builtin::text(name)? };
        return json_scene(&source, &Files::Embedded, spec.to_string());
    }
    let path = Path::new(spec);
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if extension == "obj" {
        return obj::scene(&read_named(path)?, path, name);
    }
    if extension != "json" {
        let mend = match builtin::guess(spec) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "give a .json or .obj file, or `builtin:NAME`".to_string(),
        };
        return Err(SceneError::new("this is not the name of a scene").in_file(path).mend(mend));
    }
    let bytes = read_named(path)?;
    let text = std::str::from_utf8(&bytes).map_err(|error| {
        let line = bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count() + 1;
        SceneError::new("the text is not UTF-8")
            .in_file(path)
            .at(format!("line {line}"))
            .mend("save the file as UTF-8")
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    json_scene(&Source { file: path, text }, &Files::beside(path), name)
}

/// The keys that tell the formats apart.
#[derive(Deserialize)]
#[serde(expecting = "an object")]
struct Keys {
    format: Option<IgnoredAny>,
    sphere: Option<IgnoredAny>,
    triangle: Option<IgnoredAny>,
    res: Option<IgnoredAny>,
}

fn json_scene(source: &Source, files: &Files, name: String) -> Result<Scene, SceneError> {
    // Serde would take an array's entries for the keys in their order.
    if source.text.trim_start().starts_with('[') {
        return Err(not_a_scene(source));
    }
    let keys: Keys = serde_json::from_str(source.text).or_else(|_| {
        // Reading the keys skips what they hold; reading everything finds the path of a fault inside.
        read::<Value>(source)?;
        read(source)
    })?;
    if keys.format.is_some() {
        validate::scene(source, files, name)
    } else if keys.sphere.is_some() || keys.triangle.is_some() || keys.res.is_some() {
        thesis::scene(source, files, name)
    } else {
        Err(not_a_scene(source))
    }
}

fn not_a_scene(source: &Source) -> SceneError {
    SceneError::new("this JSON is not a scene").in_file(source.file).mend(format!(
        "a scene of this program is an object with \"format\": \"{FORMAT}\"; one of the thesis's has the keys \
         `sphere`, `triangle` or `res`"
    ))
}
