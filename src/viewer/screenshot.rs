//! Saves screenshots: the film as PNG and EXR, and a view file that renders it again with the same bits.

use super::painter::FrameInput;
use octray_formats::output::{self, OutputError};
use octray_formats::scene::{Rendering, View};
use std::path::{Path, PathBuf};

/// Most screenshots of a scene in a folder.
const MOST: u32 = 9_999;

/// Saves a screenshot under the first free name in a folder. Returns its path without an extension. The film
/// must have the same number of samples in every pixel.
pub fn save(folder: &Path, input: &FrameInput) -> Result<PathBuf, OutputError> {
    let place = free_path(folder, &input.scene.name);
    let (picture, tone) = (input.accumulation.film.picture(), &input.controls.tone);
    output::save(&place.with_extension("png"), &picture, tone)?;
    output::save(&place.with_extension("exr"), &picture, tone)?;
    output::save_text(&place.with_extension("json"), &view(folder, input).text())?;
    Ok(place)
}

/// Returns the view that `octray render` makes the same picture of.
fn view(folder: &Path, input: &FrameInput) -> View {
    let FrameInput { scene, renderer, accumulation, controls } = input;
    let (settings, tone) = (renderer.settings(), &controls.tone);
    let methods = &settings.methods;
    View {
        camera: Some(accumulation.pose.camera),
        resolution: Some(settings.resolution),
        max_bounces: Some(settings.max_bounces),
        render: Rendering {
            samples: Some(accumulation.film.samples()),
            seed: Some(settings.seed),
            exposure: Some(tone.exposure),
            tone: Some(tone.operator),
            clamp: Some(settings.clamp).filter(|clamp| clamp.is_finite()),
            sphere: Some(methods.sphere),
            triangle: Some(methods.triangle),
            traversal: Some(methods.traversal),
            lights: Some(methods.lights),
            sampler: Some(methods.sampler),
            pipeline: Some(settings.pipeline),
        },
        ..View::from_scene(scene, scene.view.as_ref(), folder)
    }
}

/// Returns the path `octray-NAME-0001`, or that of the first number without a file.
fn free_path(folder: &Path, scene: &str) -> PathBuf {
    let stem = Path::new(scene).file_stem().unwrap_or_default().to_string_lossy();
    let plain = |letter: char| if letter.is_alphanumeric() || letter == '-' { letter } else { '-' };
    let stem: String = stem.chars().map(plain).collect();
    let stem = stem.strip_prefix("builtin-").unwrap_or(&stem);
    let name = |number: u32| folder.join(format!("octray-{stem}-{number:04}"));
    let taken = |place: &PathBuf| ["png", "exr", "json"].iter().any(|end| place.with_extension(end).exists());
    (1..MOST).map(name).find(|place| !taken(place)).unwrap_or_else(|| name(MOST))
}
