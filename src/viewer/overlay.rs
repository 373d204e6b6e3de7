//! The text over a frame: figures and messages.
//!
//! For: [`Overlay`].

use super::controls::Controls;
use super::frame::Frame;
use super::painter::FrameInput;
use super::state::State;
use super::timing::{RateMeter, Rates};
use octray_engine::buffers::LightChoice;
use octray_formats::wording::{counted, grouped};
use std::fmt::Write;
use std::time::{Duration, Instant};

/// Interval between updates of the figures, so that they can be read.
const UPDATE_INTERVAL: Duration = Duration::from_millis(250);

/// The text over a frame.
#[derive(Default)]
pub struct Overlay {
    figures: String,
    /// The controls that `figures` describe, and when they were written.
    written: Option<(Controls, Instant)>,
    message: String,
}

impl Overlay {
    pub fn set_message(&mut self, text: &str) {
        self.message.clear();
        self.message.push_str(text);
    }

    /// Writes the frame's figures, message and title.
    pub fn write(
        &mut self,
        input: &FrameInput,
        state: &State,
        rates: &RateMeter,
        busy: bool,
        frame: &mut Frame,
    ) {
        let now = Instant::now();
        let fresh =
            |&(controls, at): &(Controls, Instant)| controls == state.controls && now - at < UPDATE_INTERVAL;
        if !self.written.as_ref().is_some_and(fresh) {
            self.written = Some((state.controls, now));
            self.figures.clear();
            // The help is long and replaces the figures.
            if state.controls.overlay && !state.controls.help {
                write(&mut self.figures, input, state, &rates.rates(), busy);
            }
        }
        frame.figures.clone_from(&self.figures);
        frame.message.clone_from(&self.message);
        if frame.title != input.scene.name {
            frame.title.clone_from(&input.scene.name);
        }
    }
}

/// Appends the figures, line by line. Writing to a `String` cannot fail.
fn write(text: &mut String, input: &FrameInput, state: &State, figures: &Rates, busy: bool) {
    let _ = lines(text, input, state, figures, busy);
}

fn lines(
    text: &mut String,
    input: &FrameInput,
    state: &State,
    figures: &Rates,
    busy: bool,
) -> std::fmt::Result {
    let FrameInput { renderer, scene, film, .. } = *input;
    let State { controls, playlist, .. } = state;
    let settings = renderer.settings();
    let [scenes, place] = playlist.place();
    let [width, height] = settings.resolution;
    write!(text, "{}", scene.name)?;
    if scenes > 1 && input.is_current {
        write!(text, " ({place} of {scenes})")?;
    }
    if !scene.warnings.is_empty() {
        let warnings = counted(scene.warnings.len(), "warning", "warnings");
        write!(text, ", {warnings} (R reloads)")?;
    }
    writeln!(text, "{}", if busy { ", another is being prepared" } else { "" })?;
    let Rates { fps, low, samples: [simd, scalar], mrays } = *figures;
    let now = if settings.lanes == 1 { scalar } else { simd };
    match fps > 0.0 {
        true => write!(text, "screen {} fps, 1 % low {}", rate_of(fps), rate_of(low))?,
        false => write!(text, "no frame rate yet")?,
    }
    if let Some(rate) = now {
        write!(text, " · renderer {} samples/s, {mrays:.1} Mray/s", rate_of(rate))?;
    }
    match settings.lanes {
        1 => write!(text, "\nscalar")?,
        lanes => write!(text, "\n{lanes} lanes")?,
    }
    write!(text, ", {}", counted(settings.threads, "thread", "threads"))?;
    match (simd, scalar) {
        (Some(simd), Some(scalar)) => {
            let factor = simd / scalar;
            write!(text, " · SIMD {}, scalar {} samples/s, {factor:.1}×", rate_of(simd), rate_of(scalar))?;
        }
        (Some(_), None) => write!(text, " · L measures scalar beside it")?,
        (None, Some(_)) => write!(text, " · L measures SIMD beside it")?,
        (None, None) => {}
    }
    let samples = counted(film.samples(), "sample", "samples");
    let bounces = counted(settings.max_bounces, "bounce", "bounces");
    write!(text, "\n{width}×{height} · {samples} · {bounces}")?;
    if let Some(target) = controls.target {
        write!(text, " · holds {target} fps")?;
    }
    let methods = &settings.methods;
    let (sphere, triangle) = (methods.sphere.name(), methods.triangle.name());
    let traversal =
        methods.traversal_of(scene, settings.lanes).map_or("linear", |traversal| traversal.name());
    write!(text, "\nspheres {sphere}, triangles {triangle}, {traversal}")?;
    if controls.preset != super::controls::MethodPreset::CommandLine {
        write!(text, " ({})", controls.preset.name())?;
    }
    if methods.lights == LightChoice::Off {
        write!(text, ", no light sampling")?;
    }
    writeln!(text)?;
    shown(text, controls)
}

/// How the film is displayed.
fn shown(text: &mut String, controls: &Controls) -> std::fmt::Result {
    let Controls { mode, reprojection, filter, denoiser, tone, .. } = controls;
    if *mode != super::display_mode::DisplayMode::Picture {
        return write!(text, "{}: {}", mode.name(), mode.legend());
    }
    let temporal = if *reprojection { "temporal" } else { "not temporal" };
    let denoised = if *denoiser { ", denoised" } else { "" };
    let operator = tone.operator.name();
    write!(
        text,
        "{temporal}, {}{denoised} · exposure {:+.1}, {operator} · H for help",
        filter.name(),
        tone.exposure
    )
}

/// No decimals for large rates, one or two for small ones.
fn rate_of(rate: f64) -> String {
    let decimals = if rate < 1.0 { 2 } else { usize::from(rate < 10.0) };
    grouped(format!("{rate:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::playlist::Playlist;
    use octray_engine::render::{LaneChoice, Renderer, Settings};
    use octray_formats::scene::load;
    use std::time::Instant;

    #[test]
    fn figures_stand_at_their_names() {
        let mut scene = load("builtin:three").unwrap();
        scene.warnings.push("It is odd.".into());
        let names = ["builtin:thesis".to_string(), "builtin:three".to_string()];
        let mut playlist = Playlist::new(&names).unwrap();
        playlist.next();
        let controls =
            Controls { target: Some(30), ..Controls::new(4, 2, LaneChoice::Eight, Default::default()) };
        let state = State::new(playlist, &scene, controls, None, Instant::now());
        let settings = Settings { threads: 2, lanes: 8, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 1);
        let input = FrameInput {
            renderer: &renderer,
            scene: &scene,
            camera: &scene.camera,
            film: &film,
            controls: &controls,
            pose_shown: true,
            progressive: true,
            is_current: true,
        };
        let figures = Rates { fps: 60.0, low: 0.25, samples: [Some(4_000.0), Some(8.0)], mrays: 7.5 };
        let mut text = String::new();
        write(&mut text, &input, &state, &figures, true);
        for words in [
            "builtin:three (2 of 2), 1 warning (R reloads), another is being prepared\n",
            "screen 60 fps, 1 % low 0.25 · renderer 4,000 samples/s, 7.5 Mray/s\n",
            "8 lanes, 2 threads · SIMD 4,000, scalar 8.0 samples/s, 500.0×\n",
            " · 1 sample · 4 bounces · holds 30 fps\n",
        ] {
            assert!(text.contains(words), "{words:?} in {text}");
        }
        text.clear();
        write(&mut text, &input, &state, &Rates::default(), false);
        assert!(
            text.contains(
                "R reloads)
no frame rate yet\n8 lanes"
            ),
            "{text}"
        );
    }
}
