//! Writes the figures over a frame.

use super::controls::{Controls, PRESETS};
use super::display_mode::DisplayMode;
use super::painter::FrameInput;
use super::state::State;
use octray_engine::lights::LightChoice;
use octray_engine::scene::Projection;
use octray_formats::wording::{counted, grouped};
use std::fmt::Write;
use std::time::{Duration, Instant};

/// Interval between updates of the figures, so that they can be read.
const UPDATE_INTERVAL: Duration = Duration::from_millis(250);

/// The figures over a frame.
#[derive(Default)]
pub struct Overlay {
    text: String,
    /// The controls that `text` describes, and when it was written.
    written: Option<(Controls, Instant)>,
}

impl Overlay {
    /// Writes a frame's figures.
    pub fn write(&mut self, input: &FrameInput, state: &State, busy: bool, figures: &mut String) {
        let now = Instant::now();
        let stale =
            |(controls, at): (Controls, Instant)| controls != state.controls || now - at >= UPDATE_INTERVAL;
        if self.written.is_none_or(stale) {
            self.written = Some((state.controls, now));
            self.text.clear();
            // The help is long, so it replaces the figures.
            if state.controls.overlay && !state.controls.help {
                // Writing to a `String` cannot fail.
                let _ = write(&mut self.text, input, state, busy);
            }
        }
        figures.clone_from(&self.text);
    }
}

/// Appends the figures, line by line.
fn write(text: &mut String, input: &FrameInput, state: &State, busy: bool) -> std::fmt::Result {
    let FrameInput { renderer, scene, controls, accumulation } = *input;
    let (settings, rates) = (renderer.settings(), &accumulation.rates);
    let [scenes, place] = state.playlist.count_and_number();
    let [width, height] = settings.resolution;
    write!(text, "{}", scene.name)?;
    if scenes > 1 && state.shows_current() {
        write!(text, " ({place} of {scenes})")?;
    }
    if !scene.warnings.is_empty() {
        let warnings = counted(scene.warnings.len(), "warning", "warnings");
        write!(text, ", {warnings} (R reloads)")?;
    }
    writeln!(text, "{}", if busy { ", another is being prepared" } else { "" })?;
    let ([fps, low], [simd, scalar], mrays) = (rates.fps(), rates.passes, rates.mrays);
    let now = if settings.lanes == 1 { scalar } else { simd };
    match fps > 0.0 {
        true => write!(text, "screen {} fps, 1 % low {}", rate_of(fps), rate_of(low))?,
        false => write!(text, "no frame rate yet")?,
    }
    if let Some(rate) = now {
        write!(text, " · renderer {} passes/s, {mrays:.1} Mray/s", rate_of(rate))?;
    }
    match settings.lanes {
        1 => write!(text, "\nscalar")?,
        lanes => write!(text, "\n{lanes} lanes")?,
    }
    write!(text, ", {}", counted(settings.threads, "thread", "threads"))?;
    match (simd, scalar) {
        (Some(simd), Some(scalar)) => {
            let factor = simd / scalar;
            write!(text, " · SIMD {}, scalar {} passes/s, {factor:.1}×", rate_of(simd), rate_of(scalar))?;
        }
        (Some(_), None) => write!(text, " · L measures scalar beside it")?,
        (None, Some(_)) => write!(text, " · L measures SIMD beside it")?,
        (None, None) => {}
    }
    let samples = counted(accumulation.film.samples(), "sample", "samples");
    let bounces = counted(settings.max_bounces, "bounce", "bounces");
    write!(text, "\n{width}×{height} · {samples} · {bounces}")?;
    let camera = &accumulation.pose.camera;
    match camera.projection {
        Projection::Orthographic { .. } => write!(text, " · orthographic")?,
        Projection::Perspective(lens) if lens.radius > 0.0 => {
            let unit = scene.coordinates.unit;
            let f_number = camera.f_number_or_radius(f64::from(lens.radius) * unit);
            write!(text, " · f/{f_number:.3}, focus {:.3}", camera.focus() * unit)?;
        }
        Projection::Perspective(_) => {}
    }
    if let Some(target) = controls.target {
        write!(text, " · holds {target} fps")?;
    }
    let methods = &settings.methods;
    let (sphere, triangle) = (methods.sphere.name(), methods.triangle.name());
    let traversal = methods.traversal_name(scene, settings.lanes);
    write!(text, "\nspheres {sphere}, triangles {triangle}, {traversal}")?;
    if let Some(preset) = controls.preset {
        write!(text, " ({})", PRESETS[preset].0)?;
    }
    if methods.lights == LightChoice::Off {
        write!(text, ", no light sampling")?;
    }
    if controls.mode != DisplayMode::Picture {
        let (mode, legend) = controls.mode.name_and_legend();
        return write!(text, "\n{mode}: {legend}");
    }
    let temporal = if controls.reprojection { "temporal" } else { "not temporal" };
    let denoised = if controls.denoiser { ", denoised" } else { "" };
    let (filter, exposure) = (controls.filter.name(), controls.tone.exposure);
    let operator = controls.tone.operator.name();
    write!(text, "\n{temporal}, {filter}{denoised} · exposure {exposure:+.1}, {operator} · H for help")
}

/// Formats a rate: without decimals from 10 on, with one from 1 on, with two below.
fn rate_of(rate: f64) -> String {
    let decimals = if rate < 1.0 { 2 } else { usize::from(rate < 10.0) };
    grouped(format!("{rate:.decimals$}"))
}
