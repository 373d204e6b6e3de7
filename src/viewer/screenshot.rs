//! Saves screenshots: what is shown as PNG, the film as EXR, and a view file that renders the film again with
//! the same bits.

use super::controls::{Controls, Filter};
use super::display_mode::DisplayMode;
use super::frame::Frame;
use super::painter::{FrameInput, Painter};
use octray_formats::output::{self, OutputError};
use octray_formats::scene::{Rendering, View};
use octray_formats::wording::counted;
use std::path::{Path, PathBuf};

/// Most screenshots of a scene in a folder.
const MOST: u32 = 9_999;

/// Saves a screenshot under the first free name in a folder: what is shown of the film alone, without what
/// the history of a moving camera adds. Returns what was saved. The film must have the same number of samples
/// in every pixel.
pub fn save(folder: &Path, input: &FrameInput) -> Result<String, OutputError> {
    let place = free_path(folder, &input.scene.name);
    let (film, tone) = (&input.accumulation.film, &input.controls.tone);
    let picture = film.picture();
    let treatment = treatment(input.controls);
    let samples = counted(film.samples(), "sample", "samples");
    let file = place.with_extension("png");
    match &treatment {
        Some(treatment) => {
            let controls = Controls { minimap: false, reprojection: false, ..*input.controls };
            let mut shown = Frame::default();
            Painter::default().paint(&FrameInput { controls: &controls, ..*input }, &mut shown);
            let comment = format!("octray: {}, {samples}", treatment.replace('×', "x"));
            output::save_shown(&file, [shown.width, shown.height], &shown.pixels, &comment)?;
        }
        None => output::save(&file, &picture, tone)?,
    }
    output::save(&place.with_extension("exr"), &picture, tone)?;
    output::save_text(&place.with_extension("json"), &view(folder, input).text())?;
    let place = place.display();
    Ok(match treatment {
        Some(treatment) => format!("saved {place}.png ({treatment}, {samples}), .exr (raw) and .json"),
        None => format!("saved {place}.png (raw, {samples}), .exr and .json"),
    })
}

/// Returns what a frame shows other than the raw film; `None` if it shows the film.
fn treatment(controls: &Controls) -> Option<String> {
    if controls.mode != DisplayMode::Picture {
        return Some(controls.mode.name_and_legend().0.to_string());
    }
    let denoised = controls.denoiser.then_some("denoised");
    let filter = (controls.filter != Filter::None).then(|| controls.filter.name());
    let all: Vec<&str> = denoised.into_iter().chain(filter).collect();
    (!all.is_empty()).then(|| all.join(", "))
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
