//! `--stats`: tables for people, figures in JSON, and nothing of either without it.

use crate::desk::{Desk, assert_fits, list, number};
use octray::lane::NATIVE_WIDTH;
use serde_json::{Value, json};

/// Asserts what holds of all figures about frames; `rays` is their expected number.
fn check_frames(stats: &Value, rays: f64) {
    assert_eq!(number(&stats["rays"]), rays, "{stats}");
    let sum = |of: &str, key: &str| -> f64 { list(&stats[of]).iter().map(|entry| number(&entry[key])).sum() };
    assert_eq!([sum("kinds", "rays"), sum("bounces", "rays")], [rays, rays], "{stats}");
    assert!((sum("stages", "share") - 1.0).abs() < 1e-9, "{stats}");
    assert!((sum("stages", "seconds") / number(&stats["seconds"]) - 1.0).abs() < 1e-9, "{stats}");
    for bounce in list(&stats["bounces"]) {
        let used = number(&bounce["simd_utilisation"]);
        assert!(0.0 < used && used <= 1.0, "{stats}");
    }
    assert_eq!(stats["bounces"][0]["rays"], stats["kinds"][0]["rays"]);
    for kind in list(&stats["kinds"]) {
        for what in ["boxes", "triangles", "spheres"] {
            let tests = number(&kind[what]["tests_per_ray"]) * number(&kind["rays"]);
            assert!((tests - number(&kind[what]["tests"])).abs() < 1e-6 * (1.0 + tests), "{kind}");
            assert!(number(&kind[what]["steps"]) <= number(&kind[what]["tests"]), "{kind}");
        }
    }
}

#[test]
fn render_counts_its_own_rays_and_writes_the_same_file() {
    let desk = Desk::new();
    for scene in ["scene.json", "builtin:knot:2000"] {
        let line = format!("render {scene} --samples 3 --size 40x24 --lanes 8 -o");
        let plain = desk.json(&format!("{line} plain.exr"));
        assert_eq!(plain.get("stats"), None);
        let counted = desk.json(&format!("{line} counted.exr --stats"));
        assert!(desk.bytes("plain.exr") == desk.bytes("counted.exr"));
        let stats = &counted["stats"];
        assert_eq!(stats["frames"], 3);
        assert_eq!(plain["rays"], counted["rays"]);
        check_frames(stats, number(&plain["rays"]));
        let first = json!({ "bounce": 0, "rays": 2880, "packets": 360, "simd_utilisation": 1.0 });
        assert_eq!(stats["bounces"][0], first);
        let boxes = number(&stats["kinds"][1]["boxes"]["tests"]);
        assert_eq!(boxes > 0.0, scene.contains("knot"), "boxes are tested where there is a hierarchy");
        let each = &stats["kinds"][1]["spheres"]["tests_per_ray"];
        assert_eq!(number(each), if scene.contains("knot") { 0.0 } else { 1.0 });
    }
}

#[test]
fn render_and_bench_print_tables_and_what_they_mean() {
    let desk = Desk::new();
    for line in [
        "render builtin:knot:2000 -o a.png --samples 1 --size 32x32 --bounces 20 --threads 1",
        "bench builtin:knot:2000 --frames 1 --size 32x32 --bounces 20 --threads 1",
    ] {
        let said = desk.run(&format!("{line} --stats"));
        let words = ["generate ", "box tests a ray", "SIMD utilisation, bounce 0", "A test is one ray"];
        assert!(words.iter().all(|words| said.contains(words)), "{said}");
        // The first line of `bench` names the machine, the last one is a summary.
        let of_bench = said.trim_end().rsplit_once('\n').filter(|_| line.starts_with("bench"));
        assert_fits(of_bench.map_or(&said[..], |(tables, _)| tables).split_once('\n').unwrap().1);
        assert!(!desk.run(line).contains("SIMD utilisation"));
    }
}

#[test]
fn bench_counts_frames_that_it_does_not_time() {
    let desk = Desk::new();
    let line = "bench scene.json builtin:three --frames 2 --size 16x16 --threads 1";
    let (plain, counted) = (desk.json(line), desk.json(&format!("{line} --stats")));
    let [plain, counted] = [&plain, &counted].map(|report| list(&report["results"]));
    assert!(plain.iter().all(|result| result.get("stats").is_none()));
    for (result, plain) in counted.iter().zip(plain) {
        assert_eq!(json!([result["frames"], result["rays_per_frame"]]), json!([2, plain["rays_per_frame"]]));
        let stats = &result["stats"];
        assert_eq!(json!([stats["lanes"], stats["threads"]]), json!([result["lanes"], 1]));
        check_frames(stats, number(&stats["rays"]));
        assert_eq!(number(&stats["kinds"][0]["rays"]), 256.0 * number(&stats["frames"]));
        let each = number(&stats["rays"]) / number(&stats["frames"]);
        assert!((number(&result["rays_per_frame"]) / each - 1.0).abs() < 0.2, "{result}");
    }
    let same_scene = |a: &Value, b: &Value| a["scene"] == b["scene"];
    for engines in counted.chunk_by(same_scene) {
        let rays = |result: &Value| json!([result["stats"]["frames"], result["stats"]["rays"]]);
        assert!(engines.len() > 1);
        assert!(engines.iter().all(|engine| rays(engine) == rays(&engines[0])), "all trace the same paths");
    }
}

#[test]
fn rays_counts_the_tests_of_every_kind_and_way_once() {
    let desk = Desk::new();
    let line = "rays builtin:knot:2000 --size 64x48 --passes 1";
    let plain = desk.json(line);
    assert_eq!(plain.get("stats"), None);
    let of = |threads: u32| desk.json(&format!("{line} --stats --threads {threads}"))["stats"].clone();
    let stats = of(1);
    assert_eq!(stats, of(3), "threads do not change what is tested");
    let stats = list(&stats);
    assert_eq!(stats.len(), 16, "six ways for primary rays, five for the others");
    let find = |kind: &str, way: &str| {
        stats.iter().find(|entry| entry["kind"] == kind && entry["traversal"] == way).unwrap()
    };
    for kind in ["primary", "shadow", "diffuse"] {
        let boxes = |way| number(&find(kind, way)["boxes"]["tests_per_ray"]);
        assert!(boxes("scalar") > 1.0 && boxes("single") > boxes("scalar"), "{kind}");
        let all = &find(kind, "linear")["triangles"]["tests_per_ray"];
        assert_eq!(number(all), number(&plain["triangles"]), "{kind}");
        assert_eq!(find(kind, "linear")["boxes"]["tests"], 0);
        let of_kind = list(&plain["results"]).iter().find(|result| result["kind"] == kind);
        let rays = of_kind.unwrap()["rays"].as_u64().unwrap() as usize;
        let packets = rays / NATIVE_WIDTH + rays % NATIVE_WIDTH;
        assert!(kind == "primary" || !rays.is_multiple_of(NATIVE_WIDTH), "some are traced one by one");
        let steps = packets as f64 * number(&plain["triangles"]);
        assert_eq!(number(&find(kind, "linear")["triangles"]["steps"]), steps, "whole packets, and the rest");
        let [tests, steps] = ["tests", "steps"].map(|key| &find(kind, "scalar")["boxes"][key]);
        assert_eq!(tests, steps, "one test a step");
    }
    let boxes = |way| number(&find("primary", way)["boxes"]["tests_per_ray"]);
    assert!(boxes("packet") < boxes("scalar"), "a frustum's tests are shared by the rays in it");
    let printed = desk.run("rays scene.json --size 16x16 --passes 1 --stats");
    assert!(printed.contains("sphere tests a ray"), "{printed}");
}
