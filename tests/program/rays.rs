//! `octray rays`: its report, and the files it writes for other programs.

use crate::desk::{Desk, assert_fits, assert_has, list, number};
use octray::lane::NATIVE_WIDTH;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// A sphere that hides part of a triangle.
const MIXED: &str = r#"{
  "format": "octray-1",
  "spheres": [ { "center": [0, 0, 0], "radius": 1 } ],
  "triangles": [ { "vertices": [[-9, -1, -9], [-9, -1, 9], [9, -1, 0]] } ]
}"#;

fn results(report: &Value) -> &[Value] {
    list(&report["results"])
}

fn whole(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value} is not a whole number"))
}

/// The columns of a file, read as its documentation says: of floats, or of whole numbers by their bits.
fn columns<const N: usize>(desk: &Desk, name: &str, magic: &[u8; 8]) -> [Vec<f32>; N] {
    let bytes = desk.bytes(name);
    assert_eq!(&bytes[..8], magic, "{name}");
    let count = u64::from_le_bytes(bytes[8..16].try_into().unwrap()) as usize;
    assert_eq!(bytes.len(), 16 + 4 * N * count, "{name}");
    let words: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes[16..]);
    std::array::from_fn(|column| words[column * count..][..count].to_vec())
}

#[test]
fn rays_reports_every_kind_and_way_in_json() {
    let desk = Desk::new();
    let report = desk.json("rays builtin:knot:2000 --size 64x48 --threads 1 --passes 2");
    let expected = json!({
        "schema": "octray-rays-1", "scene": "builtin:knot:2000", "spheres": 0, "fault": null, "left_out": []
    });
    assert_has(&report, &expected);
    assert!(whole(&report["triangles"]).abs_diff(2_000) < 40, "{report}");
    assert!(number(&report["build_ms"]) > 0.0 && whole(&report["bvh_bytes"]) > 2_000, "{report}");
    assert!(
        report["settings"]["machine"]["cpu"].is_string() && report["tree"]["wide_nodes"].is_u64(),
        "{report}"
    );

    let name = |result: &Value| json!([result["kind"], result["traversal"], result["lanes"]]);
    let mut expected = Vec::new();
    for kind in ["primary", "shadow", "diffuse"] {
        expected.push(json!([kind, "scalar", 1]));
        let ways = ["single", "packet", "stream", "hybrid", "linear"].into_iter();
        let ways = ways.filter(|&way| way != "packet" || kind == "primary");
        expected.extend(ways.map(|way| json!([kind, way, NATIVE_WIDTH])));
    }
    assert_eq!(results(&report).iter().map(name).collect::<Vec<_>>(), expected);
    let hits = |kind: &str| {
        let of_kind = results(&report).iter().filter(|result| result["kind"] == kind);
        let hits: Vec<&Value> = of_kind.map(|result| &result["hits"]).collect();
        assert!(hits.iter().all(|&count| count == hits[0]), "{kind}: {hits:?}");
        whole(hits[0])
    };
    // The camera sees all of the knot and it fills some of the picture; it shades part of itself.
    let (primary, shadow, diffuse) = (hits("primary"), hits("shadow"), hits("diffuse"));
    assert!((300..1_500).contains(&primary), "{primary}");
    let some = primary / 20..primary / 2;
    assert!(some.contains(&shadow) && some.contains(&diffuse), "{shadow} and {diffuse} of {primary}");
    for result in results(&report) {
        let rays = if result["kind"] == "primary" { 64 * 48 } else { primary };
        let known = json!({ "threads": 1, "rays": rays, "passes": 2, "disagreements": 0 });
        assert_has(result, &known);
        let spread = &result["mrays_per_s_spread"];
        let [rate, low, high] = [&result["mrays_per_s"], &spread[0], &spread[1]].map(number);
        assert!(0.0 < low && low <= rate && rate <= high, "{result}");
        match result["traversal"] == "scalar" {
            true => assert!(result["over_scalar"].is_null(), "{result}"),
            false => assert_eq!(result["over_scalar"]["rounds"], 2, "{result}"),
        }
    }
}

#[test]
fn rays_measures_the_ways_threads_and_widths_asked_for() {
    let desk = Desk::new();
    for (way, threads, kinds) in [("stream", 2, 3), ("packet", 1, 1), ("linear", 3, 3)] {
        let own = format!("--traversal {way} --threads {threads}");
        let report = desk.json(&format!("rays model.obj --size 17x9 --passes 1 {own}"));
        assert_eq!(results(&report).len(), kinds, "{report}");
        for result in results(&report) {
            assert!(result["traversal"] == way && result["threads"] == threads, "{result}");
        }
    }
    let line = |list: &str| format!("rays model.obj --size 17x9 --passes 1 --threads 1 --lanes {list}");
    let widths = |list: &str| -> BTreeSet<u64> {
        results(&desk.json(&line(list))).iter().map(|result| whole(&result["lanes"])).collect()
    };
    let native = NATIVE_WIDTH as u64;
    assert_eq!([widths("1"), widths("auto,1")], [BTreeSet::from([1]), BTreeSet::from([1, native])]);
    desk.refuses(&line(if native == 8 { "16" } else { "8" }), &["--lanes", "give auto"]);
    desk.refuses(&line("1 --traversal packet"), &["--lanes", "no such width"]);
}

#[test]
fn rays_has_ratios_to_an_earlier_report_and_names_what_differs() {
    let desk = Desk::new();
    let line = "rays model.obj --size 17x9 --passes 2 --threads 1";
    let mut old = desk.json(&format!("{line} --seed 3"));
    for result in old["results"].as_array_mut().unwrap() {
        result["mrays_per_s"] = json!(0.5);
        result["mrays_per_s_spread"] = json!([0.25, 1.0]);
    }
    old["results"].as_array_mut().unwrap().pop();
    desk.write("old.json", old.to_string());
    let new = desk.json(&format!("{line} --baseline old.json"));
    for (at, result) in results(&new).iter().enumerate() {
        let Some(over) = result.get("over_baseline") else { continue };
        let [rate, slow] = [&result["mrays_per_s"], &result["mrays_per_s_spread"][0]].map(number);
        assert_eq!([number(&over["median"]), number(&over["spread"][0])], [rate / 0.5, slow / 1.0], "{at}");
    }
    let count = results(&new).iter().filter(|result| result.get("over_baseline").is_some()).count();
    assert_eq!(count + 1, results(&new).len(), "all but the last");
    assert_eq!(new["baseline_differences"], json!({ "seed": [0, 3] }));
    assert!(desk.run(&format!("{line} --baseline old.json")).contains("Differences: seed 0, there 3."));
    desk.refuses(&format!("{line} --baseline model.obj"), &["--baseline", "no report of rays"]);
}

#[test]
fn rays_start_at_the_scenes_camera_on_request() {
    let desk = Desk::new();
    let hits = |more: &str| {
        let report = desk.json(&format!("rays scene.json --size 32x32 --passes 1 --threads 1{more}"));
        (report["settings"]["camera"].clone(), whole(&results(&report)[0]["hits"]))
    };
    // From 5 away, a ball of radius 1 has a circle of radius 1/√24 in a square of half side tan 20°.
    let (camera, seen) = hits(" --camera scene");
    let share = std::f64::consts::PI / 24.0 / (2.0 * 20f64.to_radians().tan()).powi(2);
    assert!((seen as f64 / 1024.0 - share).abs() < 0.02, "{seen} hits, {share} of the pixels");
    let (default, overview) = hits("");
    assert_eq!((camera, default), (json!("scene"), json!("overview")));
    assert!(overview > seen + 50, "{overview} hits");
}

#[test]
fn rays_of_odd_sizes_and_scenes_with_spheres_agree_in_every_way() {
    let desk = Desk::new();
    desk.write("mixed.json", MIXED);
    for scene in ["scene.json", "mixed.json", "builtin:cornell-spheres"] {
        for size in ["1x1", "7x3", "33x17", "250x5"] {
            let report = desk.json(&format!("rays {scene} --size {size} --passes 1 --threads 2"));
            let (width, height) = size.split_once('x').unwrap();
            let pixels: u64 = width.parse::<u64>().unwrap() * height.parse::<u64>().unwrap();
            assert_eq!(results(&report)[0]["rays"], pixels, "{scene} {size}");
            assert!(results(&report).iter().all(|result| result["disagreements"] == 0), "{scene} {size}");
        }
    }
}

#[test]
fn rays_leaves_out_what_would_take_too_long_and_says_so() {
    let desk = Desk::new();
    let line = "rays builtin:terrain:20000 --size 200x200 --passes 1 --threads 1 --traversal linear";
    let printed = desk.run(line);
    assert!(printed.contains("primary rays would take too long"), "{printed}");
}

#[test]
fn rays_prints_a_row_a_way_and_what_it_means() {
    let desk = Desk::new();
    let told = |more: &str| desk.run(&format!("rays builtin:knot:2000 --size 16x16 --passes 1{more}"));
    // The first line names the machine.
    assert_fits(told(" --stats").split_once('\n').unwrap().1);
    let all = told("");
    let rows = all.lines().filter(|line| line.starts_with("  ")).count();
    assert_eq!(rows, 5 + 4 + 4, "scalar rays stand in the line of their kind: {all}");
    assert!(all.contains("; scalar ") && all.contains("bit by bit"), "{all}");
}

#[test]
fn dump_holds_the_rays_and_hits_that_the_report_counts() {
    let desk = Desk::new();
    desk.write("mixed.json", MIXED);
    let line = "rays mixed.json --size 50x30 --passes 1 --threads 1 --dump a/b";
    let report = desk.json(line);
    assert_eq!(desk.names_in("a/b"), ["diffuse.rays", "primary.rays", "shadow.rays", "triangles.bin"]);

    let vertices = columns::<9>(&desk, "a/b/triangles.bin", b"OCTRITR1").concat();
    assert_eq!(vertices, [0.0, 0.0, 0.0, 0.0, 0.0, 18.0, 18.0, 0.0, 9.0], "from the scene's origin");

    for kind in ["primary", "shadow", "diffuse"] {
        let [x, y, z, dx, dy, dz, reach, t, primitive, u, v] =
            columns(&desk, &format!("a/b/{kind}.rays"), b"OCTRAYS1");
        let (origin, direction) = ([x, y, z], [dx, dy, dz]);
        let primitive: Vec<u32> = primitive.into_iter().map(f32::to_bits).collect();
        let result = results(&report).iter().find(|result| result["kind"] == kind).unwrap();
        assert_eq!(t.len() as u64, whole(&result["rays"]), "{kind}");
        let hits = primitive.iter().filter(|&&primitive| primitive != u32::MAX).count();
        assert_eq!(hits as u64, whole(&result["hits"]), "{kind}");
        for at in 0..t.len() {
            let length: f32 = direction.iter().map(|column| column[at] * column[at]).sum();
            assert!((length - 1.0).abs() < 1e-6, "{kind} {at}");
            assert_eq!(reach[at].is_finite(), kind == "shadow", "{kind} {at}");
            if primitive[at] == u32::MAX {
                assert_eq!([t[at], u[at], v[at]], [f32::INFINITY, 0.0, 0.0], "{kind} {at}");
                continue;
            }
            assert!(t[at] > 0.0 && t[at] <= reach[at] && primitive[at] < 2, "{kind} {at}");
            if primitive[at] == 1 {
                let height = origin[1][at] + t[at] * direction[1][at];
                assert!(height.abs() < 1e-4, "{kind} {at}: {height} from the origin at a vertex");
                assert!(u[at] >= 0.0 && v[at] >= 0.0 && u[at] + v[at] <= 1.0 + 1e-6, "{kind} {at}");
                for axis in [0, 2] {
                    let [a, b, c] = [0, 3, 6].map(|vertex| vertices[vertex + axis]);
                    let along = origin[axis][at] + t[at] * direction[axis][at];
                    let across = a + u[at] * (b - a) + v[at] * (c - a);
                    assert!((along - across).abs() < 1e-3, "{kind} {at}: {along}, {across}");
                }
            }
        }
    }
    // A second run replaces the files by the same ones.
    let before = desk.bytes("a/b/shadow.rays");
    desk.run(line);
    assert_eq!(desk.bytes("a/b/shadow.rays"), before);
    desk.run(&format!("{line} --seed 1"));
    assert_ne!(desk.bytes("a/b/shadow.rays"), before);
}
