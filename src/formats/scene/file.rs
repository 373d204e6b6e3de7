//! The native scene file as the user wrote it: its keys and their JSON types, nothing about their meaning.
//!
//! For: [`SceneFile`], [`read`]. May import: `place`, `check` (for suggestions). Must never know: what a valid scene is.

use super::SceneError;
use super::check::nearest;
use super::place::Source;
use serde::de::{DeserializeOwned, Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::marker::PhantomData;

/// The value of `format` that this program reads.
pub const FORMAT: &str = "octray-1";

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `format`")]
pub struct SceneFile {
    pub format: String,
    /// Missing: frames the whole scene.
    pub camera: Option<CameraFile>,
    pub resolution: Option<[u32; 2]>,
    pub max_bounces: Option<u32>,
    /// Missing: black where something in the scene shines, plain white where nothing does.
    pub sky: Option<SkyFile>,
    #[serde(default)]
    pub materials: Named<MaterialFile>,
    #[serde(default)]
    pub spheres: Vec<SphereFile>,
    #[serde(default)]
    pub triangles: Vec<TriangleFile>,
    #[serde(default)]
    pub meshes: Vec<MeshFile>,
}

#[derive(Deserialize, Default)]
#[serde(
    deny_unknown_fields,
    expecting = "an object such as { \"position\": [0, 1, 5], \"look_at\": [0, 1, 0] }"
)]
pub struct CameraFile {
    /// Missing: far enough from `look_at` to see the whole scene.
    pub position: Option<[f64; 3]>,
    /// Missing: the middle of the scene.
    pub look_at: Option<[f64; 3]>,
    pub up: Option<[f64; 3]>,
    pub vertical_fov: Option<f64>,
}

/// `color`, or `gradient`, or `texture` (which `color` then multiplies).
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `color`, `gradient` or `texture`")]
pub struct SkyFile {
    pub color: Option<[f64; 3]>,
    pub gradient: Option<GradientFile>,
    pub texture: Option<String>,
    pub filter: Option<FilterFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `bottom` and `top`")]
pub struct GradientFile {
    pub bottom: [f64; 3],
    pub top: [f64; 3],
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "lowercase")]
pub enum FilterFile {
    Nearest,
    Bilinear,
}

/// The keys of all types together; which belong to `type` is for `material` to say.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with a `type`")]
pub struct MaterialFile {
    pub r#type: String,
    pub color: Option<[f64; 3]>,
    pub emission: Option<[f64; 3]>,
    pub roughness: Option<f64>,
    pub ior: Option<f64>,
    pub texture: Option<String>,
    pub roughness_map: Option<String>,
    pub normal_map: Option<String>,
    /// Scene units that one repeat of the texture covers on triangles without `uvs`.
    pub texture_size: Option<f64>,
    pub filter: Option<FilterFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `center` and `radius`")]
pub struct SphereFile {
    pub center: [f64; 3],
    pub radius: f64,
    pub material: Option<String>,
    pub turn_degrees: Option<f64>,
    /// Missing: outside.
    pub picture_from: Option<SideFile>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "lowercase")]
pub enum SideFile {
    Outside,
    Inside,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `vertices`")]
pub struct TriangleFile {
    pub vertices: [[f64; 3]; 3],
    pub uvs: Option<[[f64; 2]; 3]>,
    /// Missing: flat.
    pub normals: Option<[[f64; 3]; 3]>,
    pub material: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `obj`")]
pub struct MeshFile {
    pub obj: String,
    /// Missing: the materials of the model's own MTL file.
    pub material: Option<String>,
    pub translate: Option<[f64; 3]>,
    /// About the x axis, then the y axis, then the z axis.
    pub rotate_degrees: Option<[f64; 3]>,
    pub scale: Option<f64>,
}

/// An object whose keys are names: kept in the order of the file, no name twice.
pub struct Named<T>(pub Vec<(String, T)>);

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = Named<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of names")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries: Vec<(String, T)> = Vec::new();
                while let Some((name, value)) = map.next_entry::<String, T>()? {
                    if entries.iter().any(|(known, _)| *known == name) {
                        return Err(A::Error::custom(format!("the name `{name}` stands twice")));
                    }
                    entries.push((name, value));
                }
                Ok(Named(entries))
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

/// Reads a JSON text as `T`. Only a text that is refused is read a second time, to learn the path of the fault.
pub fn read<T: DeserializeOwned>(source: &Source) -> Result<T, SceneError> {
    serde_json::from_str(source.text).or_else(|_| {
        let mut deserializer = serde_json::Deserializer::from_str(source.text);
        let value: T = serde_path_to_error::deserialize(&mut deserializer)
            .map_err(|error| refusal(source, &error.path().to_string(), error.inner()))?;
        deserializer.end().map_err(|error| refusal(source, ".", &error))?;
        Ok(value)
    })
}

fn refusal(source: &Source, path: &str, error: &serde_json::Error) -> SceneError {
    let (line, column) = (error.line(), error.column());
    let message = error.to_string();
    let message = message.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&message);
    let (what, mend) = if error.is_data() {
        data_fault(path, message)
    } else if message == "trailing characters" && path != "." {
        ("there are too many entries in this list".to_string(), "remove those from here on".to_string())
    } else {
        syntax_fault(message, source.text.lines().nth(line.saturating_sub(1)).unwrap_or_default(), column)
    };
    // A question mark stands for a key that could not be read.
    let path = path.trim_end_matches('?').trim_end_matches('.');
    let place = match path {
        "" => format!("line {line}, column {column}"),
        path => format!("{path}, line {line}, column {column}"),
    };
    SceneError::new(what).in_file(source.file).at(place).mend(mend)
}

fn syntax_fault(message: &str, line: &str, column: usize) -> (String, String) {
    let rest = line.get(column.saturating_sub(1)..).unwrap_or_default();
    let word = rest.trim_start_matches('-');
    if ["NaN", "nan", "Inf", "inf"].iter().any(|start| word.starts_with(start))
        || message.contains("number out of range")
    {
        let what = "this is not a finite number".to_string();
        return (what, "write a number from -1e18 to 1e18; JSON knows no NaN and no infinity".to_string());
    }
    let mend = match message {
        "EOF while parsing a value" => "the file is empty or ends too early: write a JSON object",
        "trailing comma" => "remove the comma before the closing bracket",
        "trailing characters" => "remove what follows the end of the JSON object",
        m if m.starts_with("EOF") => "the file ends too early: close the brackets and quotes that are open",
        m if m.starts_with("expected `,`") => "put a comma between two entries",
        "key must be a string" => "put the key in double quotes; comments are not allowed",
        _ => "mend the JSON here: keys and texts in double quotes, commas between entries, no comments",
    };
    (format!("broken JSON: {message}"), mend.to_string())
}

fn data_fault(path: &str, message: &str) -> (String, String) {
    let quoted = || message.split('`').skip(1).step_by(2);
    if message.starts_with("unknown variant") {
        let (key, word) = (path.rsplit('.').next().unwrap_or(path), quoted().next().unwrap_or_default());
        let known: Vec<&str> = quoted().skip(1).collect();
        return (format!("`{key}` cannot be `{word}`"), format!("write one of {}", known.join(", ")));
    }
    if message.starts_with("unknown field") {
        let unknown = quoted().next().unwrap_or_default();
        let known: Vec<&str> = quoted().skip(1).collect();
        let guess = nearest(unknown, known.iter().copied());
        let guess = guess.map(|known| format!("did you mean `{known}`? ")).unwrap_or_default();
        let mend = format!("{guess}the keys known here are {}", known.join(", "));
        return (format!("unknown key `{unknown}`"), mend);
    }
    if message.starts_with("missing field") {
        let missing = quoted().next().unwrap_or_default();
        return (format!("the key `{missing}` is missing"), format!("add `{missing}` to this object"));
    }
    if message.starts_with("duplicate field") || message.contains("stands twice") {
        return (
            message.replace("duplicate field", "a second"),
            "remove or rename one of the two".to_string(),
        );
    }
    let message = message
        .replace("expected f64", "expected a number")
        .replace("expected u32", "expected a whole number of 0 or more")
        .replace("expected a sequence", "expected an array");
    let expected = message.rsplit_once("expected ").map(|(_, expected)| expected.to_string());
    let mend =
        expected.map_or("see the scene format".to_string(), |expected| format!("write {expected} here"));
    (message, mend)
}
