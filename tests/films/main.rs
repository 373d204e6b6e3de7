//! Films have the same bits on every machine: of each scene, at the usual settings of `octray compare`, the
//! hash that `hashes.txt` names.
//!
//! A line of that file is a film: a scene as in `octray compare --hash`, below this folder or built in; the
//! hash from builds with fused multiply-add; the hash from those without. This test checks the column of its
//! own build, whatever the processor, the level of optimisation or the compiler; `.ci/run` builds it for
//! several. A hash that changes is a picture that changes, and the changelog says so; the failing test prints
//! the new column. `+` after a scene names methods other than the default.

use octray_engine::lane::{FUSED, WIDTHS};
use octray_engine::lights::LightChoice;
use octray_engine::render::{Methods, Renderer, Settings};
use octray_engine::sampling::Sampler;
use octray_engine::scene::Scene;
use octray_formats::scene::load;
use std::path::Path;
use std::thread;

/// The films of the table: name, hash with FMA, hash without.
fn table() -> impl Iterator<Item = [&'static str; 3]> {
    let lines = include_str!("hashes.txt").lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| line.split_whitespace().collect::<Vec<_>>().try_into().expect("three columns"))
}

fn scene(spec: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(spec);
    load(if spec.starts_with("builtin:") { spec } else { path.to_str().unwrap() }).unwrap()
}

fn hash(film: &str, lanes: usize) -> String {
    let (spec, variant) = film.split_once('+').unwrap_or((film, "default"));
    let scene = scene(spec);
    let methods = match variant {
        "default" => Methods::default(),
        "random" => Methods { sampler: Sampler::Random, lights: LightChoice::Off, ..Methods::default() },
        unknown => panic!("{unknown} names no methods"),
    };
    let settings =
        Settings { resolution: [240, 135], max_bounces: 4, methods, lanes, ..Settings::of(&scene) };
    let renderer = Renderer::new(&scene, settings);
    let mut film = renderer.film();
    renderer.add_samples(&mut film, 16);
    format!("{:016x}", film.picture().hash())
}

#[test]
fn films_have_the_bits_of_every_other_machine() {
    let column = if FUSED { 1 } else { 2 };
    let rendered: Vec<(&str, &str, String)> = thread::scope(|scope| {
        let films: Vec<_> = table().map(|row| (row, scope.spawn(move || hash(row[0], WIDTHS[1])))).collect();
        films.into_iter().map(|(row, hash)| (row[0], row[column], hash.join().unwrap())).collect()
    });
    assert!(rendered.len() > 10, "the table is found");
    let differ = rendered.iter().filter(|(_, expected, hash)| hash != expected).count();
    let now: Vec<String> = rendered.iter().map(|(film, _, hash)| format!("{film:<28} {hash}")).collect();
    let build = if FUSED { "fused" } else { "plain" };
    assert_eq!(differ, 0, "films that differ; the column {build} is now\n{}\n", now.join("\n"));
}
