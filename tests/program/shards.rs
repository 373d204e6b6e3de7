//! `octray render --shard` and `octray merge`: parts that join into the bits of one run.

use crate::desk::Desk;
use octray::lane::WIDTHS;
use std::fs;

const PICTURE: &str = "render builtin:spheres --size 100x60 --samples 3";
const TONE: &str = "--exposure 0.5 --tone aces";

#[test]
fn eight_shards_join_into_the_bits_of_one_run() {
    let desk = Desk::new();
    let run = |line: &str| desk.run(line);
    for number in 1..=8 {
        // Widths and threads of their own, as on different machines.
        let own = format!("--lanes {} --threads {}", WIDTHS[number % WIDTHS.len()], 1 + number % 2);
        let checkpoint = if number == 5 { " --checkpoint 5.part" } else { "" };
        run(&format!("{PICTURE} {TONE} --shard {number}/8 -o {number}.part {own}{checkpoint}"));
    }
    let parts = "6.part 2.part 1.part 8.part 3.part 4.part 7.part 5.part";
    for name in ["a.exr", "a.png", "a.jpg", "a.hdr"] {
        run(&format!("{PICTURE} {TONE} -o {name}"));
        run(&format!("merge {parts} -o merged-{name}"));
        assert!(desk.bytes(name) == desk.bytes(&format!("merged-{name}")), "{name}");
    }
    run(&format!("merge {parts} -o dark.png --exposure -3 --tone clamp"));
    run(&format!("{PICTURE} -o b.png --exposure -3 --tone clamp"));
    assert!(desk.bytes("dark.png") == desk.bytes("b.png"));
    let report = desk.json(&format!("merge {parts} -o a.exr"));
    let whole = desk.json(&format!("{PICTURE} -o a.exr"));
    assert_eq!(report["schema"], "octray-merge-1");
    assert_eq!([&report["parts"], &report["samples"]], [8, 3]);
    assert_eq!(report["rays"], whole["rays"]);
}

#[test]
fn merge_names_what_is_missing_doubled_mixed_or_incomplete() {
    let desk = Desk::new();
    let run = |line: &str| desk.run(line);
    let picture = "render scene.json --size 60x40 --samples 2";
    for number in 1..=4 {
        run(&format!("{picture} --shard {number}/4 -o {number}.part"));
    }
    fs::copy(desk.path("2.part"), desk.path("copy.part")).unwrap();
    run(&format!("{picture} --shard 3/4 -o seed.part --seed 9"));
    run(&format!("{picture} --shard 3/5 -o five.part"));
    run("render scene.json --size 60x40 --samples 5 --shard 3/4 -o more.part");
    run("render scene.json --size 60x40 --samples 1000000 --shard 3/4 -o half.part --time-limit 0.01");
    run(&format!("{picture} --shard 3/4 -o light.part --exposure 1"));
    run(&format!("{picture} --shard 1/12 -o twelfth.part"));
    for (parts, words) in [
        ("1.part 2.part 3.part", &["shard 4 of 4 is missing"][..]),
        ("1.part", &["shards 2, 3, 4 of 4 are missing"]),
        (
            "1.part 2.part copy.part 4.part",
            &["shard 2 is there twice: `2.part` and `copy.part`", "shard 3 of 4"],
        ),
        (
            "1.part 2.part seed.part 4.part",
            &["`seed.part` is not of the picture of `1.part`: seed: 9, and here 0"],
        ),
        ("1.part 2.part five.part 4.part", &["`five.part`", "5 shards, and here 4"]),
        ("1.part 2.part more.part 4.part", &["`more.part`", "samples: 5, and here 2"]),
        ("1.part 2.part half.part 4.part", &["`half.part` is not complete"]),
        ("1.part 2.part none.part 4.part", &["there is no part `none.part`", "--shard"]),
        ("1.part scene.json", &["scene.json", "not a checkpoint"]),
        ("1.part 2.part light.part 4.part", &["`light.part`", "exposure or tone: not the same"]),
        ("twelfth.part", &["shards 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, … of 12 are missing"]),
    ] {
        desk.refuses(&format!("merge {parts} -o a.exr"), words);
    }
    desk.refuses("merge 1.part 2.part 3.part 4.part -o a.gif", &["a.gif", ".png"]);
    run("merge 1.part 2.part 3.part 4.part -o a.exr");
    // A checkpoint of a whole picture is its only part.
    run(&format!("{picture} -o b.exr --checkpoint whole"));
    run("merge whole -o c.exr");
    let [a, b, c] = ["a.exr", "b.exr", "c.exr"].map(|name| desk.bytes(name));
    assert!(a == b && b == c);
    run("render scene.json --size 60x40 --target-error 0.2 -o d.exr --checkpoint noisy");
    run("merge noisy -o e.exr");
    assert!(desk.bytes("d.exr") == desk.bytes("e.exr"));
}

#[test]
fn unfinished_part_goes_on_in_its_place() {
    let desk = Desk::new();
    let picture = "builtin:cornell --size 48x32 --samples 40 --threads 1";
    let part = format!("render {picture} --shard 1/1 -o 1.part --checkpoint 1.part");
    desk.run(&format!("{part} --time-limit 0.001"));
    desk.refuses("merge 1.part -o a.exr", &["not complete"]);
    desk.run(&part);
    desk.run("merge 1.part -o a.exr");
    assert!(desk.bytes("a.exr") == desk.rendered(picture, "b.exr"));
}
