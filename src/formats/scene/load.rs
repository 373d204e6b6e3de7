//! From a name on the command line to a [`Scene`].
//!
//! For: [`load`], [`load_with_view`], [`load_from`], and [`may_be_scene`].

use super::embedded::PREFIX;
use super::error::SceneError;
use super::files::{FILES, Files, has_extension};
use super::json::{JsonPath, Source, read};
use super::native::{FORMAT, VIEW_FORMAT};
use super::view::Loaded;
use super::{builtin, model, procedural, thesis, validate, view};
use octray_engine::scene::Scene;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use std::io;
use std::path::Path;
use std::rc::Rc;
use std::time::SystemTime;

/// Loads a scene as [`load_with_view`] does, without its view.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    load_with_view(spec).map(|loaded| loaded.scene)
}

/// Loads a scene: `builtin:NAME`, a generated mesh (`builtin:knot:N`), the path of a model (.obj, .gltf, .glb
/// or .ply; framed automatically under a plain sky), or the path of a .json file in the native format or the
/// thesis's, or of a view of any of these.
pub fn load_with_view(spec: &str) -> Result<Loaded, SceneError> {
    if let Some(name) = spec.strip_prefix(PREFIX) {
        return built_in(spec, name);
    }
    let path = Path::new(spec);
    if !may_be_scene(path) {
        let mend = match builtin::guess(spec) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("give {FILES}"),
        };
        let what = match path.extension() {
            _ if path.is_dir() => "this is a folder, not a scene".into(),
            Some(extension) if path.is_file() => {
                format!("files of the kind `.{}` are not read", extension.to_string_lossy())
            }
            _ => "this is not the name of a scene".to_string(),
        };
        return Err(SceneError::new(what).in_file(path).mend(mend));
    }
    let start = SystemTime::now();
    from_named(path, Files::beside(path)).map(|loaded| Loaded { read: Some(start), ..loaded })
}

/// Loads a scene as [`load_with_view`] does, from files that are not on disk: `read` has the content of the
/// file at `path`, and of those that it names, beside it.
///
/// ```
/// use octray_formats::scene::load_from;
/// use std::io::ErrorKind;
/// use std::path::Path;
///
/// let model = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
/// let files = |path: &Path| match path.to_str() {
///     Some("archive/model.obj") => Ok(model.to_vec()),
///     _ => Err(ErrorKind::NotFound.into()),
/// };
/// assert_eq!(load_from(Path::new("archive/model.obj"), files)?.triangles.len(), 1);
/// # Ok::<(), octray_formats::scene::SceneError>(())
/// ```
pub fn load_from(
    path: &Path,
    read: impl Fn(&Path) -> io::Result<Vec<u8>> + 'static,
) -> Result<Loaded, SceneError> {
    from_named(path, Files::given(path, Rc::new(read)))
}

/// The scene in a file that the user named.
fn from_named(path: &Path, files: Files) -> Result<Loaded, SceneError> {
    match files.read_named(path) {
        Ok(bytes) => from_bytes(path, &bytes, files, &from_view),
        Err(error) => Err(error.after(files.into_requested())),
    }
}

fn built_in(spec: &str, name: &str) -> Result<Loaded, SceneError> {
    if let Some(shape) = procedural::read(name)? {
        return shape.scene(spec).map(Loaded::from);
    }
    let source = Source { file: Path::new(spec), text: builtin::text(name)? };
    json_scene(&source, &Files::embedded(), spec.to_string(), &from_view)
}

/// Whether a file's extension is that of a scene, a view or a model.
pub fn may_be_scene(path: &Path) -> bool {
    has_extension(path, "json") || model::is_model(path)
}

/// Called for a file that is a view.
type OnView<'a> = &'a dyn Fn(&Source, &Files, String) -> Result<Loaded, SceneError>;

/// The scene in a file whose content, `bytes`, was read through `files`.
fn from_bytes(path: &Path, bytes: &[u8], files: Files, on_view: OnView) -> Result<Loaded, SceneError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let loaded = if model::is_model(path) {
        model::scene(bytes, path, &files, name).map(Loaded::from)
    } else {
        utf8(path, bytes).and_then(|text| json_scene(&Source { file: path, text }, &files, name, on_view))
    };
    match loaded {
        Ok(mut loaded) => {
            let of_viewed = std::mem::replace(&mut loaded.scene.files, files.into_requested());
            loaded.scene.files.extend(of_viewed);
            Ok(loaded)
        }
        Err(error) => Err(error.after(files.into_requested())),
    }
}

fn utf8<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str, SceneError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count() + 1;
        SceneError::new("the text is not UTF-8")
            .in_file(path)
            .at(format!("line {line}"))
            .mend("save the file as UTF-8")
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// The keys that distinguish the formats.
#[derive(Deserialize)]
#[serde(expecting = "an object")]
struct Keys {
    format: Option<Value>,
    sphere: Option<IgnoredAny>,
    triangle: Option<IgnoredAny>,
    res: Option<IgnoredAny>,
}

fn json_scene(source: &Source, files: &Files, name: String, on_view: OnView) -> Result<Loaded, SceneError> {
    // Serde would read an array's entries as the keys in order of declaration.
    if source.text.trim_start().starts_with('[') {
        return Err(not_a_scene(source));
    }
    let keys: Keys = serde_json::from_str(source.text).or_else(|_| {
        // `Keys` skips the values; a full read finds the JSON path of a fault inside them.
        read::<Value>(source)?;
        read(source)
    })?;
    match keys.format {
        Some(format) if format == VIEW_FORMAT => on_view(source, files, name),
        Some(_) => validate::scene(source, files, name).map(Loaded::from),
        None if keys.sphere.is_some() || keys.triangle.is_some() || keys.res.is_some() => {
            thesis::scene(source, files, name).map(Loaded::from)
        }
        None => Err(not_a_scene(source)),
    }
}

fn not_a_scene(source: &Source) -> SceneError {
    SceneError::new("this JSON is not a scene").in_file(source.file).mend(format!(
        "a scene has \"format\": \"{FORMAT}\", a view \"{VIEW_FORMAT}\"; a scene of the thesis has the keys `sphere`, \
         `triangle` or `res`"
    ))
}

/// The scene that a view names, as the view shows it.
fn from_view(source: &Source, files: &Files, name: String) -> Result<Loaded, SceneError> {
    let file = view::read(source)?;
    let scene = named_in_view(source, files, &file.scene)?.scene;
    view::apply(source, file, scene, name)
}

/// The scene that a view names.
fn named_in_view(source: &Source, files: &Files, spec: &str) -> Result<Loaded, SceneError> {
    const MEND: &str = "give the path of a scene (.json) or a model (.obj, .gltf, .glb, .ply) relative to the \
                        view, or `builtin:NAME`";
    let root = JsonPath::Root;
    let fault = |what: String, mend: &str| source.error(&root.key("scene"), what, mend);
    if let Some(name) = spec.strip_prefix(PREFIX) {
        return built_in(spec, name)
            .map_err(|error| fault(error.what, error.mend.as_deref().unwrap_or(MEND)));
    }
    let path = files.resolve(spec);
    if !may_be_scene(&path) {
        return Err(fault(format!("`{spec}` is not the name of a scene"), MEND));
    }
    // The scene's files lie beside the scene, not beside the view. `from_bytes` appends their paths to the
    // view's.
    let files = files.beside_other(&path);
    let bytes = match files.read(&path) {
        Ok(bytes) => bytes,
        Err(reason) => {
            let mend = format!("the file searched for is {}: {MEND}", path.display());
            let error = fault(format!("cannot read the scene `{spec}`: {reason}"), &mend);
            return Err(error.after(files.into_requested()));
        }
    };
    from_bytes(&path, &bytes, files, &|_, _, _| {
        Err(fault(format!("`{spec}` is a view itself"), "name the scene that it is a view of"))
    })
}
