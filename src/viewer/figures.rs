//! What the overlay says.
//!
//! For: [`write()`]. May import: `state`, `rates`, `painter`'s subject. Must never know: fonts, windows.

use super::controls::Controls;
use super::painter::Subject;
use super::rates::Figures;
use super::state::State;
use crate::buffers::LightChoice;
use crate::wording::{counted, grouped};
use std::fmt::Write;

/// Appends the figures, line by line. Writing to a text cannot fail.
pub fn write(text: &mut String, subject: &Subject, state: &State, figures: &Figures, busy: bool) {
    let _ = lines(text, subject, state, figures, busy);
}

fn lines(
    text: &mut String,
    subject: &Subject,
    state: &State,
    figures: &Figures,
    busy: bool,
) -> std::fmt::Result {
    let Subject { renderer, scene, film, .. } = *subject;
    let State { controls, playlist, .. } = state;
    let settings = renderer.settings();
    let [scenes, place] = playlist.place();
    let [width, height] = settings.resolution;
    write!(text, "{}", scene.name)?;
    if scenes > 1 && subject.listed {
        write!(text, " ({place} of {scenes})")?;
    }
    if !scene.warnings.is_empty() {
        let warnings = counted(scene.warnings.len(), "warning", "warnings");
        write!(text, ", {warnings} (R reads and says again)")?;
    }
    writeln!(text, "{}", if busy { ", another is being made ready" } else { "" })?;
    let Figures { fps, low, samples: [simd, scalar], mrays } = *figures;
    let now = if settings.lanes == 1 { scalar } else { simd };
    match fps > 0.0 {
        true => write!(text, "{} fps, 1 % low {}", rate_of(fps), rate_of(low))?,
        false => write!(text, "no frame rate yet")?,
    }
    if let Some(rate) = now {
        write!(text, " · {} samples/s · {mrays:.1} Mray/s", rate_of(rate))?;
    }
    let how = if settings.lanes == 1 { "scalar" } else { "SIMD" };
    write!(text, "\n{how}, {}", counted(settings.threads, "thread", "threads"))?;
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
    let traversal = methods.traversal_of(scene, settings.lanes).map_or("linear", |way| way.name());
    write!(text, "\nspheres {sphere}, triangles {triangle}, {traversal}")?;
    if controls.equations != super::controls::Equations::Asked {
        write!(text, " ({})", controls.equations.name())?;
    }
    if methods.lights == LightChoice::Off {
        write!(text, ", lights by chance")?;
    }
    writeln!(text)?;
    shown(text, controls)
}

/// What is made of the film.
fn shown(text: &mut String, controls: &Controls) -> std::fmt::Result {
    let Controls { view, reprojection, filter, denoiser, tone, .. } = controls;
    if *view != super::views::View::Picture {
        return write!(text, "{}: {}", view.name(), view.legend());
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

/// Of large rates no decimals, of small ones two digits.
fn rate_of(rate: f64) -> String {
    let decimals = if rate < 1.0 { 2 } else { usize::from(rate < 10.0) };
    grouped(format!("{rate:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Renderer, Settings};
    use crate::scene::load;
    use crate::viewer::playlist::Playlist;
    use std::time::Instant;

    #[test]
    fn figures_stand_at_their_names() {
        let mut scene = load("builtin:three").unwrap();
        scene.warnings.push("It is odd.".into());
        let names = ["builtin:thesis".to_string(), "builtin:three".to_string()];
        let mut playlist = Playlist::new(&names).unwrap();
        playlist.next();
        let controls = Controls { target: Some(30), ..Controls::new(4, 2, 8, Default::default()) };
        let state = State::new(playlist, &scene, controls, None, Instant::now());
        let settings = Settings { threads: 2, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 1);
        let subject = Subject {
            renderer: &renderer,
            scene: &scene,
            camera: &scene.camera,
            film: &film,
            controls: &controls,
            known: true,
            standing: true,
            listed: true,
        };
        let figures = Figures { fps: 60.0, low: 0.25, samples: [Some(4_000.0), Some(8.0)], mrays: 7.5 };
        let mut text = String::new();
        write(&mut text, &subject, &state, &figures, true);
        for words in [
            "builtin:three (2 of 2), 1 warning (R reads and says again), another is being made ready\n",
            "60 fps, 1 % low 0.25 · 4,000 samples/s · 7.5 Mray/s\n",
            "SIMD, 2 threads · SIMD 4,000, scalar 8.0 samples/s, 500.0×\n",
            " · 1 sample · 4 bounces · holds 30 fps\n",
        ] {
            assert!(text.contains(words), "{words:?} in {text}");
        }
        text.clear();
        write(&mut text, &subject, &state, &Figures::default(), false);
        assert!(text.contains("again)\nno frame rate yet\nSIMD"), "{text}");
    }
}
