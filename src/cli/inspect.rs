//! `octray inspect`: what a scene contains, and which methods and traversal it gets; or one path of a pixel.

use super::error::{CliError, refuse};
use super::numbers::{MAX_SAMPLES, whole};
use super::options::{FrameOptions, SCENE};
use super::scenes;
use super::terminal::{self, Printer};
use crate::diagnosis;
use crate::methods;
use crate::reference::{PathSettings, Reference};
use crate::render::{Renderer, Settings};
use crate::report::inspection::Inspection;
use crate::report::path;
use crate::report::settings::{self, RunSettings};
use crate::scene::{Loaded, point_in_file};
use serde_json::json;
use std::ffi::OsString;
use std::process::ExitCode;

/// Show what a scene contains, or one path of a pixel.
///
/// Prints the numbers of objects, materials and textures, their memory, the camera, and warnings about the
/// file; the features that the scene needs; and the traversal, either testing every primitive or a hierarchy
/// of boxes, which is built, timed and checked. Exits with 1 if the hierarchy is invalid.
///
/// With --pixel, prints the path of one sample of a frame of `octray compare`, in double precision (the
/// reference) beside single precision (the engine): at each vertex the hit, the lobe that scatters, the
/// throughput on arrival, what emission and next event estimation (0: occluded) add to the pixel, and the
/// radiance so far. The reference has no next event estimation: with --lights off both columns compute the
/// same.
#[derive(Debug, clap::Parser)]
#[command(mut_args(of_pixel))]
#[command(after_help = "Examples:\n  octray inspect builtin:three --json\n  \
                        octray inspect builtin:three --pixel 120,90 --size 240x135")]
pub struct Options {
    #[arg(value_name = "SCENE", help = SCENE)]
    scene: OsString,
    /// Also print the reasons for traversal and methods.
    #[arg(long, conflicts_with = "pixel")]
    why: bool,
    /// Print JSON (schemas octray-inspect-1, octray-path-1).
    #[arg(long)]
    json: bool,
    /// Print a path of this pixel (0,0: upper left).
    #[arg(long, value_name = "X,Y", value_parser = pixel, allow_hyphen_values = true)]
    pixel: Option<[u32; 2]>,
    /// The number of the sample.
    #[arg(long, value_name = "N", default_value = "0", value_parser = whole::<0, { MAX_SAMPLES - 1 }>, allow_hyphen_values = true)]
    sample: u32,
    #[command(flatten)]
    frame: FrameOptions,
}

/// Makes every option except these four require `--pixel`.
fn of_pixel(arg: clap::Arg) -> clap::Arg {
    let is_any = ["scene", "why", "json", "pixel"].contains(&arg.get_id().as_str());
    if is_any { arg } else { arg.requires("pixel") }
}

/// Parses a column and a row.
fn pixel(text: &str) -> Result<[u32; 2], String> {
    let pair = text.split_once(',').and_then(|(x, y)| Some([x.parse().ok()?, y.parse().ok()?]));
    pair.ok_or("give column and row as X,Y, such as 120,67".into())
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    let out = Printer { json: options.json };
    if let Some(pixel) = options.pixel {
        return print_path(&options, pixel, out);
    }
    let scene = scenes::load(&options.scene, false)?;
    let inspection = Inspection::of(options.scene.to_string_lossy().into_owned(), &scene);
    out.text(&inspection.text(options.why))?;
    out.end(&inspection, !inspection.is_valid())
}

fn print_path(options: &Options, [x, y]: [u32; 2], out: Printer) -> Result<ExitCode, CliError> {
    let (sample, (scene, settings)) = (options.sample, options.frame.load(&options.scene, 0)?);
    let Settings { resolution, max_bounces, seed, methods, .. } = settings;
    let [right, bottom] = resolution.map(|side| side - 1);
    if x > right || y > bottom {
        let own = if options.frame.as_scene { "" } else { "; --as-scene takes the scene's own size" };
        let instead = format!("the pixels of this size go from 0,0 to {right},{bottom}{own}");
        return Err(refuse("--pixel", format!("{x},{y}"), instead));
    }
    let of_reference = PathSettings { resolution, max_bounces, seed, sampler: methods.sampler };
    let mut f64 = Reference::new(&scene).vertices(of_reference, x, y, sample);
    let mut renderer = methods::renderer(&scene, settings);
    let f32 = renderer.path([x, y], sample);
    if f32.last().is_some_and(|end| end.radiance == [0.0; 3]) {
        warn_of_black(&mut renderer, &scene, &settings, f32.len());
    }
    let mut of_engine = settings::json(&f32);
    let coordinates = scene.coordinates;
    for vertex in f64.iter_mut().filter(|vertex| vertex.primitive.is_some()) {
        vertex.point = coordinates.to_file(vertex.point.into()).into();
        vertex.distance *= coordinates.unit;
    }
    for (at, vertex) in f32.iter().enumerate().filter(|(_, vertex)| vertex.primitive.is_some()) {
        of_engine[at]["point"] = json!(point_in_file(vertex.point.into(), &coordinates).to_array());
        of_engine[at]["distance"] = settings::json(&(vertex.distance * coordinates.unit as f32));
    }
    let report = json!({
        "schema": "octray-path-1",
        "scene": options.scene.to_string_lossy(),
        "pixel": [x, y],
        "sample": sample,
        // The first vertex with another primitive or lobe.
        "part_at": f64.iter().zip(&f32).position(|(a, b)| (a.primitive, a.lobe) != (b.primitive, b.lobe)),
        "f64": f64,
        "f32": of_engine,
        "settings": settings::json(&RunSettings::of_picture(&settings)),
    });
    let own = settings::own_size(&scene, &settings);
    out.text(&(path::text(&report, &scene, &settings) + &settings::own_sizes(own.as_slice())))?;
    out.end(&report, false)
}

/// Warns as `octray render` does, if it would of a picture in which this path of so many vertices is black.
fn warn_of_black(renderer: &mut Renderer, scene: &Loaded, settings: &Settings, vertices: usize) {
    // A small picture of the same view is as black as a large one.
    let &Settings { resolution: [width, height], max_bounces, .. } = settings;
    let shrink = ((width - 1).max(height - 1) / 240).max(1);
    let small = [width, height].map(|side| side.div_ceil(shrink));
    renderer.set_view(&scene.camera, small, max_bounces);
    let mut film = renderer.film();
    renderer.add_samples(&mut film, 1);
    let is_black = film.picture().pixels.iter().all(|pixel| *pixel == [0.0; 3]);
    if is_black || vertices > max_bounces as usize {
        let odd = diagnosis::warnings(renderer, scene, &film, None);
        odd.iter().for_each(|odd| terminal::warn(&format!("{odd}.")));
    }
}
