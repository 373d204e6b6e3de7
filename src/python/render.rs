//! Renders scenes.

use crate::pool::{PART, pool};
use bytemuck::{cast_slice, pod_collect_to_vec};
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray3};
use octray_display::{Denoiser, Samples};
use octray_engine::film::Picture;
use octray_engine::render::{RenderObserver, Renderer, Settings};
use octray_engine::tone::{Operator, Tone};
use octray_formats::output::{Format, encode};
use octray_formats::scene::{load_from, load_with_view};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::io::Cursor;
use std::path::PathBuf;
use std::time::Instant;

/// Cancels rendering at a time, after which it goes on.
struct Until(Instant);

impl RenderObserver for Until {
    fn is_cancelled(&self) -> bool {
        Instant::now() > self.0
    }
    fn sample_done(&self, _pixels: usize, _rays: u64) {}
}

/// Renders the scene at `path`, or with the JSON `text` as if it were there. Returns the picture and the
/// warnings.
#[pyfunction]
#[allow(clippy::type_complexity)]
pub fn render<'py>(
    py: Python<'py>,
    source: (PathBuf, Option<String>),
    picture: (Option<[u32; 2]>, u32, Option<u32>),
    method: (u32, usize, bool),
) -> PyResult<(Bound<'py, PyArray3<f32>>, Vec<String>)> {
    let ((path, text), (size, samples, bounces)) = (source, picture);
    let (seed, threads, denoise) = method;
    let pool = pool(py, threads);
    let load = || match text {
        Some(text) => {
            let of_text = path.clone();
            load_from(&path, move |file| match file == of_text {
                true => Ok(text.clone().into_bytes()),
                false => std::fs::read(file),
            })
        }
        None => load_with_view(&path),
    };
    let loaded = py.detach(|| pool.install(load));
    let scene = loaded.map_err(|error| PyValueError::new_err(error.to_string()))?.scene;
    let own = Settings::of(&scene);
    let resolution = size.unwrap_or(own.resolution);
    let max_bounces = bounces.unwrap_or(own.max_bounces);
    let settings = Settings { resolution, max_bounces, seed, threads, ..own };
    let renderer = py.detach(|| pool.install(|| Renderer::new(&scene, settings)));
    let mut film = renderer.film();
    while film.samples() < samples {
        let until = Until(Instant::now() + PART);
        py.detach(|| renderer.sample_tiles_to(&mut film, |_, _| samples, &until));
        py.check_signals()?;
    }
    let denoised = || {
        let (_, aovs) = renderer.aovs();
        Denoiser::default().filter(&film.picture(), Samples::Same(samples), &aovs).clone()
    };
    let picture = py.detach(|| if denoise { pool.install(denoised) } else { film.picture() });
    let [width, height] = resolution.map(|side| side as usize);
    let array = PyArray1::from_slice(py, cast_slice::<[f32; 3], f32>(&picture.pixels));
    Ok((array.reshape([height, width, 3])?, scene.warnings))
}

/// Returns a picture of linear radiance as a PNG file.
#[pyfunction]
pub fn encode_png<'py>(
    py: Python<'py>,
    pixels: PyReadonlyArray3<f32>,
    size: [u32; 2],
    exposure: f32,
) -> PyResult<Bound<'py, PyBytes>> {
    let picture = Picture { width: size[0], height: size[1], pixels: pod_collect_to_vec(pixels.as_slice()?) };
    let tone = Tone { exposure, operator: Operator::Clamp };
    let mut file = Cursor::new(Vec::new());
    py.detach(|| encode(&mut file, &picture, (Format::Png, ""), &tone))?;
    Ok(PyBytes::new(py, file.get_ref()))
}
