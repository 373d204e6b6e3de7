//! `--denoise` and `--aovs`: clean pictures, the raw films beside them, and what pixels show.

use crate::desk::Desk;
use exr::prelude::*;
use std::collections::HashMap;

/// The mean squared error relative to the squared brightness.
fn error(pixels: &[[f32; 3]], truth: &[[f32; 3]]) -> f64 {
    let square = |a: [f32; 3]| a.iter().map(|x| f64::from(x * x)).sum::<f64>();
    let of_pixel =
        |(a, b): (&[f32; 3], &[f32; 3])| square([0, 1, 2].map(|c| a[c] - b[c])) / (square(*b) + 0.01);
    pixels.iter().zip(truth).map(of_pixel).sum::<f64>() / truth.len() as f64
}

#[test]
fn denoised_pictures_are_cleaner_and_the_raw_film_is_kept() {
    let desk = Desk::new();
    for (scene, samples, gain) in [("cornell", 4, 6.0), ("thesis", 4, 4.0), ("three", 16, 1.3)] {
        let picture = format!("builtin:{scene} --size 96x54 --samples");
        let truth = format!("{picture} 512 --seed 7");
        desk.rendered(&truth, "truth.exr");
        let raw = desk.rendered(&format!("{picture} {samples}"), "raw.exr");
        let report = desk.json(&format!("render {picture} {samples} -o clean.exr --denoise"));
        assert_eq!(report["raw"], "clean.raw.exr");
        assert!(desk.bytes("clean.raw.exr") == raw, "{scene}: the raw film is not that of a raw picture");
        let errors =
            ["raw.exr", "clean.exr"].map(|file| error(&desk.pixels(file), &desk.pixels("truth.exr")));
        assert!(errors[1] * gain < errors[0], "{scene}: {errors:?}");
    }
}

#[test]
fn files_say_that_they_are_denoised_and_are_still_read() {
    let desk = Desk::new();
    for file in ["a.png", "a.jpg", "a.hdr", "a.exr"] {
        let (raw, clean) = (format!("raw-{file}"), format!("clean-{file}"));
        desk.rendered("scene.json --samples 5", &raw);
        let said = desk.run(&format!("render scene.json --samples 5 --denoise -o {clean}"));
        assert!(said.contains("denoised; the raw film is clean-a.raw.exr"), "{said}");
        let says = |file: &str| {
            let comment = b"denoised by octray; mean samples of a pixel: 5";
            desk.bytes(file).windows(comment.len()).any(|window| window == comment)
        };
        assert!(says(&clean) && !says(&raw), "{file}");
        assert_eq!(desk.pixels(&clean).len(), desk.pixels(&raw).len(), "{file}");
    }
}

#[test]
fn shards_are_denoised_when_they_are_merged_and_frames_each() {
    let desk = Desk::new();
    let picture = "render builtin:thesis --size 50x33 --samples 3";
    desk.run(&format!("{picture} --denoise -o whole.png"));
    for number in 1..=3 {
        let checkpoint = if number == 2 { " --checkpoint 2.part" } else { "" };
        desk.run(&format!("{picture} --denoise --shard {number}/3 -o {number}.part{checkpoint}"));
    }
    desk.run("merge 3.part 1.part 2.part -o merged.png --denoise");
    for file in ["png", "raw.exr"] {
        let [whole, merged] = ["whole", "merged"].map(|name| desk.bytes(&format!("{name}.{file}")));
        assert!(whole == merged, "{file}");
    }
    desk.run("merge 3.part 1.part 2.part -o raw.exr");
    assert!(desk.bytes("raw.exr") == desk.bytes("whole.raw.exr"), "rows of AOVs change no film");
    desk.run(&format!("{picture} --shard 1/3 -o raw-1.part"));
    desk.refuses("merge raw-1.part 2.part 3.part -o a.png --denoise", &["`raw-1.part`", "--denoise"]);
    // More parts than rows.
    let picture = "render builtin:three --size 100x3 --samples 2 --denoise";
    (1..=5).for_each(|part| drop(desk.run(&format!("{picture} --shard {part}/5 -o wide-{part}.part"))));
    desk.run("merge wide-1.part wide-2.part wide-3.part wide-4.part wide-5.part -o wide.png --denoise");
    desk.run(&format!("{picture} -o a.png"));
    assert!(desk.bytes("a.png") == desk.bytes("wide.png"));
    desk.write(
        "view.json",
        r#"{ "format": "octray-view-1", "scene": "builtin:three", "keyframes": [
        { "frame": 1, "camera": { "position": [0, 1, 6], "look_at": [0, 1, 0] } },
        { "frame": 2, "camera": { "position": [1, 1, 6], "look_at": [0, 1, 0] } } ] }"#,
    );
    desk.run("render view.json --size 16x9 --samples 2 --frames 1..2 --denoise --aovs f#.aovs.exr -o f#.png");
    for file in ["f1.png", "f1.raw.exr", "f1.aovs.exr", "f2.png", "f2.raw.exr", "f2.aovs.exr"] {
        assert!(desk.path(file).exists(), "{file}");
    }
}

/// Two million paths take longer than a millisecond on every machine.
#[test]
fn pictures_with_pixels_without_samples_are_not_denoised() {
    let desk = Desk::new();
    let said = desk.warnings("render builtin:cornell --size 1600x1200 --time-limit 0.001 --denoise -o a.exr");
    assert!(said.contains("not denoised"), "{said}");
    assert!(desk.bytes("a.raw.exr") == desk.bytes("a.exr"));
}

/// What glows and scatters has an emission that no guide tells from noise.
#[test]
fn surfaces_that_scatter_and_emit_are_left_as_they_are() {
    let desk = Desk::new();
    let glows = crate::desk::SCENE
        .replace(r#""type": "diffuse","#, r#""type": "diffuse", "emission": [0.5, 0.1, 0],"#);
    desk.write("glows.json", glows);
    for (scene, is_left) in [("glows", true), ("scene", false)] {
        desk.run(&format!("render {scene}.json --size 33x33 --samples 2 --denoise -o a.exr"));
        let [clean, raw] = ["a.exr", "a.raw.exr"].map(|file| desk.pixels(file)[16 * 33 + 16]);
        assert_eq!(clean == raw, is_left, "{scene}: {clean:?} {raw:?}");
    }
}

#[test]
fn outputs_of_the_denoiser_replace_nothing_that_is_read_or_written() {
    let desk = Desk::new();
    desk.refuses("render scene.json --denoise -o a.png --samples-map a.raw.exr", &["--denoise", "a.raw.exr"]);
    desk.refuses("render scene.json --aovs a.png -o b.png", &["--aovs", ".exr"]);
    desk.refuses("render scene.json --aovs b.exr -o b.exr", &["--aovs", "another output"]);
    desk.refuses("render scene.json --aovs b.exr --shard 1/1 -o b.part", &["--samples 1"]);
}

/// The channels of a file by their names.
fn channels(desk: &Desk, file: &str) -> HashMap<String, Vec<f32>> {
    let image = read_first_flat_layer_from_file(desk.path(file)).unwrap();
    let values = |channel: &AnyChannel<FlatSamples>| channel.sample_data.values_as_f32().collect();
    image.layer_data.channel_data.list.iter().map(|one| (one.name.to_string(), values(one))).collect()
}

/// Of `three`, whose balls stand on a ball of the size of a floor.
#[test]
fn aovs_are_layers_that_agree_with_the_scene() {
    let desk = Desk::new();
    let film = desk.rendered("builtin:three --size 64x36 --samples 3 --aovs a.exr", "film.exr");
    assert!(!film.is_empty());
    let layers = channels(&desk, "a.exr");
    let (size, camera) = (64 * 36, [0.6, 1.7, 6.2_f64]);
    assert!(layers.values().all(|channel| channel.len() == size), "{:?}", layers.keys());
    let at = |name: &str, pixel: usize| f64::from(layers[name][pixel]);
    let vector =
        |layer: &str, pixel: usize| ["X", "Y", "Z"].map(|axis| at(&format!("{layer}.{axis}"), pixel));
    let balls = [([0.0, -1000.0, 0.0], 1000.0), ([-1.1, 1.0, 0.0], 1.0), ([1.1, 1.0, 0.3], 1.0)];
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let minus = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|axis| a[axis] - b[axis]);
    let mut seen = [0; 4];
    for (pixel, &object) in layers["object.ID"].iter().enumerate() {
        assert_eq!(at("samples.N", pixel), 3.0);
        let Some(&(center, radius)) = balls.get(object as usize) else {
            assert_eq!([at("material.ID", pixel), f64::from(object)], [f64::from(u32::MAX as f32); 2]);
            assert!(at("depth.Z", pixel).is_infinite() && at("position.X", pixel).is_nan());
            seen[3] += 1;
            continue;
        };
        seen[object as usize] += 1;
        assert_eq!(at("material.ID", pixel), f64::from(object), "each ball has a material of its own");
        let point = vector("position", pixel);
        assert!((length(minus(point, center)) - radius).abs() < 1e-3, "{point:?} is on no ball");
        assert!((length(minus(point, camera)) - at("depth.Z", pixel)).abs() < 1e-3, "{point:?}");
        if object == 2.0 {
            let (normal, out) = (vector("normal", pixel), minus(point, center).map(|x| x / radius));
            // Edge pixels have the mean of several points.
            assert!(length(minus(normal, out)) < 0.7 || length(normal) < 0.9, "{normal:?}, {out:?}");
            assert!(at("albedo.R", pixel) > at("albedo.B", pixel), "clay");
        }
    }
    assert!(seen.iter().all(|&count| count > 50), "{seen:?}");
    let film = desk.pixels("film.exr");
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        assert!(film.iter().zip(&layers[name]).all(|(pixel, value)| pixel[channel] == *value), "{name}");
    }
}
