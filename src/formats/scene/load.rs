//! Loads the [`Scene`] of a name on the command line, and detects its format.

use super::embedded::{self, PREFIX};
use super::error::SceneError;
use super::faults::read_all;
use super::files::{FILES, Files, has_extension};
use super::json::{JsonPath, Source, read};
use super::native::{FORMAT, VIEW_FORMAT};
use super::spelling::nearest;
use super::view::{self, Loaded, ViewFile};
use super::{model, procedural, thesis, validate};
use octray_engine::scene::Scene;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use std::ffi::OsStr;
use std::io;
use std::path::Path;
use std::rc::Rc;
use std::time::SystemTime;

/// Loads a scene as [`load_with_view`] does, without its view.
pub fn load(spec: &(impl AsRef<OsStr> + ?Sized)) -> Result<Scene, SceneError> {
    load_with_view(spec).map(|loaded| loaded.scene)
}

/// Loads a scene: `builtin:NAME`, a generated mesh (`builtin:knot:N`), the path of a model (.obj, .gltf, .glb
/// or .ply; framed automatically under a plain sky), or the path of a .json file in the native format or the
/// thesis's, or of a view of any of these.
pub fn load_with_view(spec: &(impl AsRef<OsStr> + ?Sized)) -> Result<Loaded, SceneError> {
    load_as(spec.as_ref(), false)
}

/// Loads a scene as [`load_with_view`] does; if `unrounded`, also with its points before they are rounded to
/// single precision, for the reference.
pub fn load_as(spec: &OsStr, unrounded: bool) -> Result<Loaded, SceneError> {
    let path = Path::new(spec);
    let name = path.to_string_lossy();
    if let Some(name) = name.strip_prefix(PREFIX) {
        return built_in(name, unrounded).map(Loaded::from);
    }
    if !may_be_scene(path) {
        let mend = match builtin_like(&name) {
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
    from_named(path, Files::beside(path).with_unrounded(unrounded))
        .map(|loaded| Loaded { read: Some(start), ..loaded })
}

/// Loads a scene as [`load_with_view`] does, from files that are not on disk: `read` returns the content of
/// the file at `path`, and of the files beside it that it names.
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

/// Loads the scene in a file that the user named.
fn from_named(path: &Path, files: Files) -> Result<Loaded, SceneError> {
    let found = files.read_named(path).and_then(|bytes| match content(path, &bytes, &files)? {
        Content::Scene(scene) => Ok(Loaded::from(scene)),
        Content::View(source, file) => {
            let scene = viewed(&source.root().key("scene"), &files, &file.scene)?;
            view::apply(&source, file, scene, file_name(path))
        }
    });
    match found {
        Ok(mut loaded) => {
            loaded.scene.files = files.into_requested();
            Ok(loaded)
        }
        Err(error) => Err(error.after(files.into_requested())),
    }
}

/// Tests whether a file's extension is that of a scene, a view or a model.
pub fn may_be_scene(path: &Path) -> bool {
    has_extension(path, "json") || model::is_model(path)
}

/// The content of a file.
enum Content<'a> {
    Scene(Scene),
    View(Source<'a>, ViewFile),
}

/// Parses the content of a file, whose bytes were read through `files`.
fn content<'a>(path: &'a Path, bytes: &'a [u8], files: &Files) -> Result<Content<'a>, SceneError> {
    if model::is_model(path) {
        return model::scene(bytes, path, files, file_name(path)).map(Content::Scene);
    }
    from_json(Source { file: path, text: utf8(path, bytes)? }, files, file_name(path))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn utf8<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str, SceneError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count() + 1;
        SceneError::new("the text is not UTF-8")
            .in_file(path)
            .at_place(format!("line {line}"))
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

fn from_json<'a>(source: Source<'a>, files: &Files, name: String) -> Result<Content<'a>, SceneError> {
    // Serde would read the entries of an array as the keys in their order of declaration.
    if source.text.trim_start().starts_with('[') {
        return Err(not_a_scene(&source));
    }
    let keys: Keys = serde_json::from_str(source.text).or_else(|_| {
        // `Keys` skips the values; a full read finds the JSON path of a fault inside them.
        read::<Value>(&source)?;
        read(&source)
    })?;
    match keys.format {
        Some(format) if format == VIEW_FORMAT => {
            let (file, faults) = read_all(&source)?;
            SceneError::join(faults).map_or(Ok(()), Err)?;
            Ok(Content::View(source, file))
        }
        Some(_) => validate::scene(&source, files, name).map(Content::Scene),
        None if keys.sphere.is_some() || keys.triangle.is_some() || keys.res.is_some() => {
            thesis::scene(&source, files, name).map(Content::Scene)
        }
        None => Err(not_a_scene(&source)),
    }
}

fn not_a_scene(source: &Source) -> SceneError {
    SceneError::new("this JSON is not a scene").in_file(source.file).mend(format!(
        "a scene has \"format\": \"{FORMAT}\", a view \"{VIEW_FORMAT}\"; a scene of the thesis has the keys `sphere`, \
         `triangle` or `res`"
    ))
}

/// Loads the scene that a view names at `place`.
fn viewed(place: &JsonPath, files: &Files, spec: &str) -> Result<Scene, SceneError> {
    const MEND: &str = "give the path of a scene (.json) or a model (.obj, .gltf, .glb, .ply) relative to the \
                        view, or `builtin:NAME`";
    if let Some(name) = spec.strip_prefix(PREFIX) {
        return built_in(name, files.unrounded)
            .map_err(|error| place.error(error.what, error.mend.unwrap_or_else(|| MEND.into())));
    }
    let path = files.resolve(spec);
    if !may_be_scene(&path) {
        return Err(place.error(format!("`{spec}` is not the name of a scene"), MEND));
    }
    // The files of the scene are beside the scene and not beside the view.
    let files = files.beside_other(&path);
    let bytes = files.read(&path).map_err(|reason| {
        let mend = format!("the file searched for is {}: {MEND}", path.display());
        place.error(format!("cannot read the scene `{spec}`: {reason}"), mend)
    })?;
    match content(&path, &bytes, &files)? {
        Content::Scene(scene) => Ok(scene),
        Content::View(..) => {
            let mend = "name the scene that it is a view of";
            Err(place.error(format!("`{spec}` is a view itself"), mend))
        }
    }
}

/// Loads the built-in or generated scene of a name without its prefix.
fn built_in(name: &str, unrounded: bool) -> Result<Scene, SceneError> {
    if let Some(scene) = procedural::scene(name)? {
        return Ok(scene);
    }
    let spec = format!("{PREFIX}{name}");
    let files = Files::default().with_unrounded(unrounded);
    let text = embedded::scene(name).ok_or_else(|| {
        let guess = builtin_like(name).map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
        let made = procedural::words().map(|word| format!("{word}:N"));
        let names: Vec<String> = embedded::names().map(String::from).chain(made).collect();
        let mend = format!("{guess}the names are {}", names.join(", "));
        SceneError::new(format!("there is no scene `{spec}`")).mend(mend)
    })?;
    match from_json(Source { file: Path::new(&spec), text }, &files, spec.clone())? {
        Content::Scene(scene) => Ok(scene),
        Content::View(..) => unreachable!("no built-in scene is a view"),
    }
}

/// Returns the argument for the built-in or generated scene of the nearest name; `None` if none is near.
fn builtin_like(name: &str) -> Option<String> {
    let (word, count) = name.split_once(':').unwrap_or((name, ""));
    if let Some(word) = nearest(word, procedural::words()) {
        return Some(format!("{PREFIX}{word}:{}", if count.is_empty() { "N" } else { count }));
    }
    nearest(name, embedded::names()).map(|near| format!("{PREFIX}{near}"))
}
