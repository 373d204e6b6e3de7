//! Reads and writes views: files that name another scene and have a camera and render options of their own.

use super::camera::camera;
use super::camera_path::{CameraPath, Keyframe};
use super::check::warn_of_size;
use super::embedded::PREFIX;
use super::error::SceneError;
use super::json::{JsonPath, Source};
use super::native::{CameraFile, KeyframeFile, VIEW_FORMAT};
use super::write;
use octray_engine::lights::LightChoice;
use octray_engine::render::{PipelineChoice, SphereChoice, TraversalChoice, TriangleChoice};
use octray_engine::sampling::Sampler;
use octray_engine::scene::{Camera, Coordinates, Projection, Scene};
use octray_engine::tone::Operator;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::fs;
use std::ops::Deref;
use std::path::Path;
use std::time::SystemTime;

/// The content of a file of the format `octray-view-1`. A view that is written and read again has the same
/// bits.
///
/// Domain of the writer: finite numbers within a scene's bounds.
///
/// ```
/// use octray_engine::tone::Operator;
/// use octray_formats::scene::{Rendering, View, load, load_with_view};
///
/// let folder = tempfile::tempdir()?;
/// let mut view = View::from_scene(&load("builtin:three")?, None, folder.path());
/// view.render = Rendering { samples: Some(37), tone: Some(Operator::Aces), ..Rendering::default() };
/// let file = folder.path().join("shot.json");
/// octray_formats::output::save_text(&file, &view.text())?;
/// assert_eq!(load_with_view(file.to_str().unwrap())?.view, Some(view));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The scene's path relative to the view's folder, or `builtin:NAME`. Never a view.
    pub scene: String,
    /// The coordinates of the scene and of the cameras here.
    pub coordinates: Coordinates,
    /// The scene's own if `None`.
    pub camera: Option<Camera>,
    /// The scene's own if `None`.
    pub resolution: Option<[u32; 2]>,
    /// The scene's own if `None`.
    pub max_bounces: Option<u32>,
    /// The render options.
    pub render: Rendering,
    /// The cameras of `octray render --frames`; empty without keyframes.
    pub path: CameraPath,
}

/// Options of `octray render` under their names on the command line. `None` is not written. The command line
/// checks the ranges of the numbers and reports a fault with [`view_fault`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object of options of `octray render`")]
pub struct Rendering {
    /// Samples per pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<u32>,
    /// Seed of the random numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u32>,
    /// Exposure in stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f32>,
    /// The tone curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tone: Option<Operator>,
    /// Largest radiance of a sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clamp: Option<f32>,
    /// How rays meet spheres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sphere: Option<SphereChoice>,
    /// How rays meet triangles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangle: Option<TriangleChoice>,
    /// How rays find primitives.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub traversal: Option<TraversalChoice>,
    /// Which lights are sampled.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lights: Option<LightChoice>,
    /// Where sample values come from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampler: Option<Sampler>,
    /// What the pipeline is compiled for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pipeline: Option<PipelineChoice>,
}

/// A scene, and the view that it was loaded through, if the file was a view.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene, with the view's camera, resolution and bounces.
    pub scene: Scene,
    /// The view, if there is one.
    pub view: Option<View>,
    /// A time before the scene's files were read; `None` without files on disk.
    pub read: Option<SystemTime>,
}

impl Deref for Loaded {
    type Target = Scene;

    fn deref(&self) -> &Scene {
        &self.scene
    }
}

impl From<Scene> for Loaded {
    fn from(scene: Scene) -> Self {
        Self { scene, view: None, read: None }
    }
}

impl View {
    /// Makes a view of a scene with its present camera, for a file in `folder`. It names the viewed scene if
    /// the scene was loaded through a view. `render` and `path` are empty.
    pub fn from_scene(scene: &Scene, loaded_through: Option<&View>, folder: &Path) -> Self {
        Self {
            scene: name_of_viewed(scene, loaded_through, folder),
            coordinates: scene.coordinates,
            camera: Some(scene.camera),
            resolution: Some(scene.resolution),
            max_bounces: Some(scene.max_bounces),
            render: Rendering::default(),
            path: CameraPath::default(),
        }
    }

    /// Returns the text of the view's file.
    pub fn text(&self) -> String {
        let mut entries =
            vec![("format", json!(VIEW_FORMAT).to_string()), ("scene", json!(self.scene).to_string())];
        entries.extend(self.camera.map(|camera| ("camera", write::camera(&camera, &self.coordinates))));
        entries.extend(self.resolution.map(|resolution| ("resolution", json!(resolution).to_string())));
        entries.extend(self.max_bounces.map(|bounces| ("max_bounces", bounces.to_string())));
        if self.render != Rendering::default() {
            // Indents the nested object. JSON strings contain no line breaks.
            let render = serde_json::to_string_pretty(&self.render).expect("options are JSON");
            entries.push(("render", render.replace('\n', "\n  ")));
        }
        if !self.path.keyframes().is_empty() {
            entries.push(("keyframes", write::keyframes(self.path.keyframes(), &self.coordinates)));
        }
        let lines: Vec<String> = entries.iter().map(|(key, value)| format!("  \"{key}\": {value}")).collect();
        format!("{{\n{}\n}}\n", lines.join(",\n"))
    }
}

/// Returns the name, for a view in `folder`, of this scene or of the scene that it is a view of.
fn name_of_viewed(scene: &Scene, loaded_through: Option<&View>, folder: &Path) -> String {
    let file = match loaded_through {
        Some(view) if view.scene.starts_with(PREFIX) => return view.scene.clone(),
        Some(_) => scene.files.get(1),
        None => scene.files.first(),
    };
    match file.and_then(|path| Some((path.parent()?, path.file_name()?))) {
        Some((beside, name)) => write::relative(beside, &name.to_string_lossy(), folder),
        None => scene.name.clone(),
    }
}

/// The view file as the user wrote it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewFile {
    #[serde(rename = "format")]
    _format: String,
    pub scene: String,
    camera: Option<CameraFile>,
    resolution: Option<[u32; 2]>,
    max_bounces: Option<u32>,
    render: Option<Rendering>,
    #[serde(default)]
    keyframes: Vec<KeyframeFile>,
}

/// Applies a view to the scene that it names. Camera keys that are missing in the view keep the scene's
/// values.
pub fn apply(source: &Source, file: ViewFile, mut scene: Scene, name: String) -> Result<Loaded, SceneError> {
    let root = source.root();
    if let Some(resolution) = file.resolution {
        scene.resolution = root.key("resolution").resolution(resolution)?;
    }
    if let Some(bounces) = file.max_bounces {
        scene.max_bounces = root.key("max_bounces").bounces(bounces)?;
    }
    if let Some(camera) = &file.camera {
        scene.camera = self::camera(&root.key("camera"), camera, &scene, Some(scene.camera))?;
    }
    let view = View {
        scene: file.scene,
        coordinates: scene.coordinates,
        camera: file.camera.map(|_| scene.camera),
        resolution: file.resolution,
        max_bounces: file.max_bounces,
        render: file.render.unwrap_or_default(),
        path: path(&root.key("keyframes"), &file.keyframes, &scene)?,
    };
    let keyframes = view.path.keyframes().iter().map(|keyframe| keyframe.camera);
    let cameras: Vec<Camera> = view.camera.into_iter().chain(keyframes).collect();
    scene.warnings.extend(warn_of_size(&scene, &cameras));
    scene.name = name;
    Ok(Loaded { scene, view: Some(view), read: None })
}

/// Converts keyframes. Missing keys of their cameras are those of the scene's camera.
fn path(place: &JsonPath, files: &[KeyframeFile], scene: &Scene) -> Result<CameraPath, SceneError> {
    let mut keyframes: Vec<Keyframe> = Vec::with_capacity(files.len());
    for (index, file) in files.iter().enumerate() {
        let place = place.item(index);
        if let Some(before) = keyframes.last().filter(|before| before.frame >= file.frame) {
            let what = format!("frame {} comes after frame {}", file.frame, before.frame);
            return Err(place.key("frame").error(what, "write the keyframes in ascending order"));
        }
        let camera = camera(&place.key("camera"), &file.camera, scene, Some(scene.camera))?;
        let is_orthographic = |camera: &Camera| matches!(camera.projection, Projection::Orthographic { .. });
        if keyframes.first().is_some_and(|key| is_orthographic(&key.camera) != is_orthographic(&camera)) {
            let what = "there is no way from a perspective to an orthographic camera";
            let mend = "give all keyframes `orthographic_height`, or none";
            return Err(place.key("camera").error(what, mend));
        }
        keyframes.push(Keyframe { frame: file.frame, camera });
    }
    Ok(CameraPath::new(keyframes))
}

/// Makes an error about the value of `key` in the `render` object of the view that the scene was loaded
/// through. Reads the file again to find the line.
pub fn view_fault(scene: &Scene, key: &str, what: impl Into<String>, mend: impl Into<String>) -> SceneError {
    let file = scene.files.first().map_or(Path::new(""), |file| file);
    let text = fs::read_to_string(file).unwrap_or_default();
    let source = Source { file, text: text.trim_start_matches('\u{feff}') };
    source.root().key("render").key(key).error(what, mend)
}
