//! Law: glTF models look as they do in Cycles, which shares no code with octray: the means of blocks of the
//! picture are equal, channel by channel.
//!
//! `perf/peers/blender/compare --tables` wrote the models and Cycles' means; its README says where the two
//! materials differ. Limits are about 1½ times what differs. The noise of a block is at most 0.1 %, unless it
//! is said.

use crate::common::*;

const CYCLES: &str = include_str!("peers/cycles.txt");
/// Columns and rows of blocks, and the pixels of each.
const BLOCKS: [usize; 2] = [8, 3];
const PIXELS: [usize; 2] = [8, 12];

/// Cycles' means of the model's blocks: of each row of blocks red, then green, then blue.
fn expected(model: &str) -> Vec<f64> {
    let numbers = CYCLES.lines().skip_while(|line| *line != model).skip(1).take(3 * BLOCKS[1]);
    let numbers: Vec<_> = numbers.flat_map(str::split_whitespace).map(|x| x.parse().unwrap()).collect();
    assert_eq!(numbers.len(), 3 * BLOCKS[0] * BLOCKS[1], "{model}");
    numbers
}

/// octray's, in the same order.
fn rendered(model: &str) -> Vec<f64> {
    let scene = load(&format!("{}/pictures/peers/{model}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let resolution = [0, 1].map(|axis| (BLOCKS[axis] * PIXELS[axis]) as u32);
    let picture = render(&scene, Settings { resolution, max_bounces: 12, ..Settings::of(&scene) }, 1024);
    let mut means = vec![0.0; 3 * BLOCKS[0] * BLOCKS[1]];
    for (pixel, (x, y)) in picture.pixels.iter().zip(places(resolution)) {
        let (column, row) = (x as usize / PIXELS[0], y as usize / PIXELS[1]);
        for (channel, &value) in pixel.iter().enumerate() {
            let mean = &mut means[(3 * row + channel) * BLOCKS[0] + column];
            *mean += f64::from(value) / (PIXELS[0] * PIXELS[1]) as f64;
        }
    }
    means
}

/// Limits are in per cent: of each channel's mean, and of each block.
#[track_caller]
fn assert_equals_cycles(model: &str, of_mean: f64, of_block: f64) {
    let (theirs, ours) = (expected(model), rendered(model));
    let percent = |ours: f64, theirs: f64| 100.0 * (ours - theirs) / theirs;
    let blocks: Vec<f64> = ours.iter().zip(&theirs).map(|(&ours, &theirs)| percent(ours, theirs)).collect();
    let means = [0, 1, 2].map(|channel| {
        let rows = |all: &[f64]| -> f64 { all.chunks(BLOCKS[0]).skip(channel).step_by(3).flatten().sum() };
        percent(rows(&ours), rows(&theirs))
    });
    let shown = |values: &[f64]| values.iter().map(|x| format!("{x:+6.2}")).collect::<Vec<_>>().join(" ");
    let rows: Vec<_> = blocks.chunks(BLOCKS[0]).map(shown).collect();
    let text = format!("{model}: means off by {} %, blocks by\n{}", shown(&means), rows.join("\n"));
    println!("{text}");
    let within = |values: &[f64], limit: f64| values.iter().all(|value| value.abs() <= limit);
    assert!(within(&means, of_mean) && within(&blocks, of_block), "{text}");
}

// The multiply scattered light of coloured metals: a block of roughness 1 differs by 2 %.
#[test]
fn metallic_by_roughness_is_that_of_cycles() {
    assert_equals_cycles("grid.gltf", 1.0, 4.0);
}

// Light that arrives from below the surface is lost where a normal map tilts it: 4 %.
#[test]
fn textures_are_those_of_cycles() {
    assert_equals_cycles("textured.glb", 1.5, 6.0);
}

// The noise of a block is 0.3 % here.
#[test]
fn emissive_surfaces_are_those_of_cycles() {
    assert_equals_cycles("lamps.gltf", 1.5, 4.0);
}

// octray tints reflection too: 3 %.
#[test]
fn glass_is_that_of_cycles() {
    assert_equals_cycles("glass.glb", 1.2, 5.0);
}

// octray tints transmission as a whole, a sheet of two sides what bounces inside too: 2 %.
#[test]
fn thin_walls_and_unlit_surfaces_are_those_of_cycles() {
    assert_equals_cycles("thin.glb", 0.8, 4.0);
}

#[test]
fn instances_strips_and_vertex_colours_are_those_of_cycles() {
    assert_equals_cycles("tree.gltf", 0.8, 3.0);
}

// An orthographic camera; alpha in a texture and of a material.
#[test]
fn cut_outs_are_those_of_cycles() {
    assert_equals_cycles("leaves.glb", 0.6, 1.5);
}

#[test]
fn points_spots_and_directional_lights_are_those_of_cycles() {
    assert_equals_cycles("punctual.gltf", 0.4, 1.5);
}

// Roughness up to 0.3: from there on Cycles' rough glass gains light.
#[test]
fn frosted_glass_is_that_of_cycles() {
    assert_equals_cycles("frosted.glb", 0.6, 2.0);
}
