//! `octray rays`: what its report holds, and the files it writes for other programs.

use crate::desk::{Desk, assert_fits};
use octray::lane::NATIVE_WIDTH;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};
use std::fs;

/// A sphere that hides part of a triangle.
const MIXED: &str = r#"{
  "format": "octray-1",
  "spheres": [ { "center": [0, 0, 0], "radius": 1 } ],
  "triangles": [ { "vertices": [[-9, -1, -9], [-9, -1, 9], [9, -1, 0]] } ]
}"#;

fn results(report: &Value) -> &Vec<Value> {
    report["results"].as_array().unwrap()
}

fn whole(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value} is not a whole number"))
}

/// A file of columns, read as its documentation says.
struct Columns {
    bytes: Vec<u8>,
    count: usize,
}

impl Columns {
    fn read(desk: &Desk, name: &str, magic: &[u8; 8], columns: usize) -> Self {
        let bytes = fs::read(desk.path(name)).unwrap();
        assert_eq!(&bytes[..8], magic, "{name}");
        let count = u64::from_le_bytes(bytes[8..16].try_into().unwrap()) as usize;
        assert_eq!(bytes.len(), 16 + 4 * columns * count, "{name}");
        Self { bytes, count }
    }
    fn words(&self, column: usize) -> Vec<[u8; 4]> {
        let start = 16 + 4 * column * self.count;
        self.bytes[start..start + 4 * self.count].chunks(4).map(|word| word.try_into().unwrap()).collect()
    }
    fn floats(&self, column: usize) -> Vec<f32> {
        self.words(column).into_iter().map(f32::from_le_bytes).collect()
    }
    fn numbers(&self, column: usize) -> Vec<u32> {
        self.words(column).into_iter().map(u32::from_le_bytes).collect()
    }
}

#[test]
fn rays_reports_every_kind_and_way_in_json() {
    let desk = Desk::new();
    let arguments = "rays builtin:knot:2000 --size 64x48 --threads 1 --passes 2 --json";
    let report = desk.json(&arguments.split(' ').collect::<Vec<_>>());
    assert_eq!(report["schema"], "octray-rays-1");
    assert_eq!(report["scene"], "builtin:knot:2000");
    assert_eq!(report["spheres"], 0);
    assert!(whole(&report["triangles"]).abs_diff(2_000) < 40, "{report}");
    assert!(report["build_ms"].as_f64().unwrap() > 0.0 && whole(&report["bvh_bytes"]) > 2_000, "{report}");
    assert!(
        report["settings"]["machine"]["cpu"].is_string() && report["tree"]["wide_nodes"].is_u64(),
        "{report}"
    );
    assert_eq!(json!([report["fault"], report["left_out"]]), json!([null, []]));

    let names: Vec<Value> = results(&report)
        .iter()
        .map(|result| json!([result["kind"], result["traversal"], result["lanes"]]))
        .collect();
    let mut expected = Vec::new();
    for kind in ["primary", "shadow", "diffuse"] {
        let native = NATIVE_WIDTH;
        for (way, lanes) in [
            ("scalar", 1),
            ("single", native),
            ("packet", native),
            ("stream", native),
            ("hybrid", native),
            ("linear", native),
        ] {
            if way != "packet" || kind == "primary" {
                expected.push(json!([kind, way, lanes]));
            }
        }
    }
    assert_eq!(names, expected);
    let hits = |kind: &str| {
        let hits: Vec<&Value> = results(&report)
            .iter()
            .filter(|result| result["kind"] == kind)
            .map(|result| &result["hits"])
            .collect();
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
        assert_eq!(json!([result["threads"], result["rays"]]), json!([1, rays]), "{result}");
        assert_eq!(json!([result["passes"], result["disagreements"]]), json!([2, 0]), "{result}");
        let [rate, low, high] =
            [&result["mrays_per_s"], &result["mrays_per_s_spread"][0], &result["mrays_per_s_spread"][1]]
                .map(|rate| rate.as_f64().unwrap());
        assert!(0.0 < low && low <= rate && rate <= high, "{result}");
        match result["traversal"] == "scalar" {
            true => assert!(result["over_scalar"].is_null(), "{result}"),
            false => assert_eq!(result["over_scalar"]["rounds"], 2, "{result}"),
        }
    }
}

#[test]
fn rays_measures_the_way_and_threads_asked_for() {
    let desk = Desk::new();
    let arguments = ["rays", "model.obj", "--size", "17x9", "--passes", "1", "--json"];
    for (way, threads, kinds) in [("stream", "2", 3), ("packet", "1", 1), ("linear", "3", 3)] {
        let report = desk.json(&[&arguments[..], &["--traversal", way, "--threads", threads]].concat());
        assert_eq!(results(&report).len(), kinds, "{report}");
        assert!(results(&report).iter().all(|result| result["traversal"] == way), "{report}");
        assert!(
            results(&report).iter().all(|result| result["threads"] == threads.parse::<u64>().unwrap()),
            "{report}"
        );
    }
}

#[test]
fn rays_of_odd_sizes_and_scenes_with_spheres_agree_in_every_way() {
    let desk = Desk::new();
    desk.write("mixed.json", MIXED);
    for scene in ["scene.json", "mixed.json", "builtin:cornell-spheres"] {
        for size in ["1x1", "7x3", "33x17", "250x5"] {
            let report =
                desk.json(&["rays", scene, "--size", size, "--passes", "1", "--threads", "2", "--json"]);
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
    let arguments = "rays builtin:terrain:20000 --size 200x200 --passes 1 --threads 1 --traversal linear";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    desk.octray(&arguments).assert().success().stdout(contains("primary rays would take too long"));
}

#[test]
fn rays_prints_a_row_a_way_and_what_it_means() {
    let desk = Desk::new();
    let arguments = ["rays", "builtin:knot:2000", "--size", "16x16", "--passes", "1"];
    let told = |more: &[&str]| {
        let shown = desk.octray(&[&arguments[..], more].concat()).assert().success();
        let shown = shown.stdout(contains("Mray/s").and(contains("bit by bit")));
        String::from_utf8_lossy(&shown.get_output().stdout).into_owned()
    };
    // The first line names the machine.
    assert_fits(told(&["--stats"]).split_once('\n').unwrap().1);
    let rows = |said: &str, start: &str| said.lines().filter(|line| line.starts_with(start)).count();
    let all = told(&[]);
    for words in ["\nprimary: 256 rays, ", "; scalar ", "× scalar"] {
        assert!(all.contains(words), "{words} is not in {all}");
    }
    assert_eq!(rows(&all, "  "), 5 + 4 + 4, "scalar rays stand in the line of their kind: {all}");
    let one = told(&["--traversal", "hybrid", "--threads", "1"]);
    assert!(one.contains(" – ") && !one.contains("; scalar "), "{one}");
    assert_eq!(rows(&one, "  hybrid"), 3, "{one}");
    assert_eq!(rows(&told(&["--traversal", "scalar"]), "  scalar"), 3);
}

#[test]
fn dump_holds_the_rays_and_hits_that_the_report_counts() {
    let desk = Desk::new();
    desk.write("mixed.json", MIXED);
    let arguments = [
        "rays",
        "mixed.json",
        "--size",
        "50x30",
        "--passes",
        "1",
        "--threads",
        "1",
        "--json",
        "--dump",
        "a/b",
    ];
    let report = desk.json(&arguments);
    let mut names: Vec<_> =
        fs::read_dir(desk.path("a/b")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["diffuse.rays", "primary.rays", "shadow.rays", "triangles.bin"]);

    let triangles = Columns::read(&desk, "a/b/triangles.bin", b"OCTRITR1", 9);
    assert_eq!(triangles.count, 1);
    let vertices: Vec<f32> = (0..9).flat_map(|word| triangles.floats(word)).collect();
    assert_eq!(vertices, [-9.0, -1.0, -9.0, -9.0, -1.0, 9.0, 9.0, -1.0, 0.0]);

    for kind in ["primary", "shadow", "diffuse"] {
        let rays = Columns::read(&desk, &format!("a/b/{kind}.rays"), b"OCTRAYS1", 11);
        let result = results(&report).iter().find(|result| result["kind"] == kind).unwrap();
        let column = |number: usize| rays.floats(number);
        let [origin_y, direction_y] = [column(1), column(4)];
        let direction = [column(3), column(4), column(5)];
        let (reach, t, primitive, u, v) = (column(6), column(7), rays.numbers(8), column(9), column(10));
        assert_eq!(rays.count as u64, whole(&result["rays"]), "{kind}");
        let hits = primitive.iter().filter(|&&primitive| primitive != u32::MAX).count();
        assert_eq!(hits as u64, whole(&result["hits"]), "{kind}");
        for at in 0..rays.count {
            let length: f32 = direction.iter().map(|column| column[at] * column[at]).sum();
            assert!((length - 1.0).abs() < 1e-6, "{kind} {at}");
            assert_eq!(reach[at].is_finite(), kind == "shadow", "{kind} {at}");
            if primitive[at] == u32::MAX {
                assert_eq!([t[at], u[at], v[at]], [f32::INFINITY, 0.0, 0.0], "{kind} {at}");
                continue;
            }
            assert!(t[at] > 0.0 && t[at] <= reach[at] && primitive[at] < 2, "{kind} {at}");
            if primitive[at] == 1 {
                let height = origin_y[at] + t[at] * direction_y[at];
                assert!((height + 1.0).abs() < 1e-4, "{kind} {at}: {height}");
                assert!(u[at] >= 0.0 && v[at] >= 0.0 && u[at] + v[at] <= 1.0 + 1e-6, "{kind} {at}");
            }
        }
    }
    // The same again, in place of the files that are there.
    let before = fs::read(desk.path("a/b/shadow.rays")).unwrap();
    desk.json(&arguments);
    assert_eq!(fs::read(desk.path("a/b/shadow.rays")).unwrap(), before);
    desk.json(&[&arguments[..], &["--seed", "1"]].concat());
    assert_ne!(fs::read(desk.path("a/b/shadow.rays")).unwrap(), before);
}

#[test]
fn what_rays_cannot_use_is_refused() {
    let desk = Desk::new();
    fs::write(desk.path("file"), "").unwrap();
    for (arguments, words) in [
        (&["scene.json", "--traversal", "zigzag"][..], &["zigzag", "hybrid"][..]),
        (&["scene.json", "--dump", "file"], &["cannot make the folder `file`", "because: "]),
        (&["scene.json", "--dump", "file/folder"], &["cannot make the folder `file/folder`", "because: "]),
        (&["nowhere.json", "--dump", "folder"], &["nowhere.json"]),
        (&["scene.json", "--size", "0x5"], &["--size", "from 1 to 16,384"]),
        (&["scene.json", "--size", "4096x4096"], &["'4096x4096' for '--size", "at most 8,388,608 pixels"]),
        (&["scene.json", "--passes", "0"], &["--passes", "from 1 to"]),
        (&["scene.json", "--threads", "0"], &["--threads", "from 1 to 1,024"]),
        (&["scene.json", "--seed", "-1"], &["--seed", "from 0 to"]),
        (&["builtin:knot:1"], &["`builtin:knot:1`: 1 is out of range", "from 2 to 4,000,000"]),
        (&["builtin:terrain:99999999999"], &["99999999999 is out of range", "from 2 to 4,000,000"]),
        (&["builtin:knott:5"], &["did you mean `builtin:knot:5`?"]),
        (&["knot:100"], &["did you mean `builtin:knot:100`?"]),
        (&["builtin:terrain"], &["builtin:terrain:N"]),
        (&[], &["SCENE"]),
    ] {
        desk.refuses(&[&["rays"], arguments].concat(), words);
    }
    // Too small for where it stands: every camera's position is rounded to what it looks at.
    desk.write("speck.json", &crate::desk::SCENE.replace("\"center\": [0, 0, 0], \"radius\": 1", SPECK));
    desk.refuses(&["rays", "speck.json"], &["no camera can stand beside it"]);
}

const SPECK: &str = "\"center\": [1000000, 0, 1000000], \"radius\": 0.001";

#[test]
fn meshes_made_by_rule_are_scenes() {
    let desk = Desk::new();
    for name in ["builtin:terrain:300", "builtin:knot:300"] {
        desk.render_small(name);
    }
    desk.refuses(&["inspect", "builtin:knob:300"], &["terrain:N", "knot:N"]);
}
