//! Screenshots: the film as PNG and EXR, and a view file that renders it again with the same bits.

use super::painter::FrameInput;
use octray_formats::output::{self, OutputError};
use octray_formats::scene::{Rendering, View};
use std::path::{Path, PathBuf};

/// Largest number of screenshots of a scene in a folder.
const MOST: u32 = 9_999;

/// Saves a screenshot under the first free name in a folder; returns the path without an extension. The film
/// has the same number of samples in every pixel.
pub fn take(folder: &Path, input: &FrameInput) -> Result<PathBuf, OutputError> {
    let place = free_path(folder, &input.scene.name);
    let (picture, tone) = (input.accumulation.film.picture(), &input.controls.tone);
    output::save(&place.with_extension("png"), &picture, tone)?;
    output::save(&place.with_extension("exr"), &picture, tone)?;
    output::save_text(&place.with_extension("json"), &view(folder, input).text())?;
    Ok(place)
}

/// The view that `octray render` makes the same picture of.
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
        ..View::of(scene, scene.view.as_ref(), folder)
    }
}

/// `octray-NAME-0001`, or the next number without a file.
fn free_path(folder: &Path, scene: &str) -> PathBuf {
    let stem = Path::new(scene).file_stem().unwrap_or_default().to_string_lossy();
    let plain = |letter: char| if letter.is_alphanumeric() || letter == '-' { letter } else { '-' };
    let stem: String = stem.chars().map(plain).collect();
    let stem = stem.strip_prefix("builtin-").unwrap_or(&stem);
    let name = |number: u32| folder.join(format!("octray-{stem}-{number:04}"));
    let taken = |place: &PathBuf| ["png", "exr", "json"].iter().any(|end| place.with_extension(end).exists());
    (1..MOST).map(name).find(|place| !taken(place)).unwrap_or_else(|| name(MOST))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_never_used_twice() {
        let folder = tempfile::tempdir().unwrap();
        let name =
            |scene| free_path(folder.path(), scene).file_name().unwrap().to_string_lossy().into_owned();
        assert_eq!(name("builtin:thesis"), "octray-thesis-0001");
        assert_eq!(name("my scene.json"), "octray-my-scene-0001");
        std::fs::write(folder.path().join("octray-thesis-0001.exr"), "").unwrap();
        assert_eq!(name("builtin:thesis"), "octray-thesis-0002");
        assert_eq!(name("builtin:knot:2000"), "octray-knot-2000-0001");
    }
}
