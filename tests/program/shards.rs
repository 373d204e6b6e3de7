//! `octray render --shard` and `octray merge`: parts that join into the bits of one run.

use crate::desk::Desk;
use octray::lane::WIDTHS;
use predicates::str::contains;
use std::fs;

const PICTURE: &str = "render builtin:spheres --size 100x60 --samples 3 --exposure 0.5 --tone aces";

fn run(desk: &Desk, arguments: &str) {
    desk.octray(&arguments.split(' ').collect::<Vec<_>>()).assert().success();
}

fn refuses(desk: &Desk, arguments: &str, words: &[&str]) {
    desk.refuses(&arguments.split(' ').collect::<Vec<_>>(), words);
}

#[test]
fn eight_shards_join_into_the_bits_of_one_run() {
    let desk = Desk::new();
    for number in 1..=8 {
        // Widths and threads of their own, as on different machines.
        let own = format!("--lanes {} --threads {}", WIDTHS[number % WIDTHS.len()], 1 + number % 2);
        let checkpoint = if number == 5 { " --checkpoint 5.part" } else { "" };
        run(&desk, &format!("{PICTURE} --shard {number}/8 -o {number}.part {own}{checkpoint}"));
    }
    let parts = "6.part 2.part 1.part 8.part 3.part 4.part 7.part 5.part";
    for name in ["a.exr", "a.png", "a.jpg", "a.hdr"] {
        run(&desk, &format!("{PICTURE} -o {name}"));
        run(&desk, &format!("merge {parts} -o merged-{name}"));
        let [whole, merged] =
            [name.into(), format!("merged-{name}")].map(|name| fs::read(desk.path(&name)).unwrap());
        assert!(whole == merged, "{name}");
    }
    run(&desk, &format!("merge {parts} -o dark.png --exposure -3 --tone clamp"));
    run(
        &desk,
        &format!("{PICTURE} -o b.png --exposure -3 --tone clamp").replace(" --exposure 0.5 --tone aces", ""),
    );
    assert!(fs::read(desk.path("dark.png")).unwrap() == fs::read(desk.path("b.png")).unwrap());
    let report = desk.json(&format!("merge {parts} -o a.exr --json").split(' ').collect::<Vec<_>>());
    let whole = desk.json(&format!("{PICTURE} -o a.exr --json").split(' ').collect::<Vec<_>>());
    assert_eq!(report["schema"], "octray-merge-1");
    assert_eq!(
        (&report["parts"], &report["samples"], &report["rays"]),
        (&8.into(), &3.into(), &whole["rays"])
    );
}

#[test]
fn merge_names_what_is_missing_doubled_mixed_or_incomplete() {
    let desk = Desk::new();
    let picture = "render scene.json --size 60x40 --samples 2";
    for number in 1..=4 {
        run(&desk, &format!("{picture} --shard {number}/4 -o {number}.part"));
    }
    fs::copy(desk.path("2.part"), desk.path("copy.part")).unwrap();
    run(&desk, &format!("{picture} --shard 3/4 -o seed.part --seed 9"));
    run(&desk, &format!("{picture} --shard 3/5 -o five.part"));
    run(&desk, &format!("{picture} --shard 3/4 -o more.part").replace("samples 2", "samples 5"));
    let unfinished =
        "render scene.json --size 60x40 --samples 1000000 --shard 3/4 -o half.part --time-limit 0.01";
    run(&desk, unfinished);
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
    ] {
        refuses(&desk, &format!("merge {parts} -o a.exr"), words);
    }
    run(&desk, &format!("{picture} --shard 3/4 -o light.part --exposure 1"));
    refuses(
        &desk,
        "merge 1.part 2.part light.part 4.part -o a.exr",
        &["`light.part`", "exposure or tone: not the same"],
    );
    run(&desk, &format!("{picture} --shard 1/12 -o twelfth.part"));
    refuses(
        &desk,
        "merge twelfth.part -o a.exr",
        &["shards 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, … of 12 are missing"],
    );
    refuses(&desk, "merge 1.part 2.part 3.part 4.part -o a.gif", &["a.gif", ".png"]);
    run(&desk, "merge 1.part 2.part 3.part 4.part -o a.exr");
    // A checkpoint of a whole picture is its only part.
    run(&desk, &format!("{picture} -o b.exr --checkpoint whole"));
    run(&desk, "merge whole -o c.exr");
    let [a, b, c] = ["a.exr", "b.exr", "c.exr"].map(|name| fs::read(desk.path(name)).unwrap());
    assert!(a == b && b == c);
    run(&desk, "render scene.json --size 60x40 --target-error 0.2 -o d.exr --checkpoint noisy");
    run(&desk, "merge noisy -o e.exr");
    assert!(fs::read(desk.path("d.exr")).unwrap() == fs::read(desk.path("e.exr")).unwrap());
}

#[test]
fn unfinished_part_goes_on_in_its_place() {
    let desk = Desk::new();
    let picture = "render builtin:cornell --size 48x32 --samples 40 --threads 1";
    let part = format!("{picture} --shard 1/1 -o 1.part --checkpoint 1.part");
    run(&desk, &format!("{part} --time-limit 0.001"));
    desk.octray(&["merge", "1.part", "-o", "a.exr"]).assert().code(2).stderr(contains("not complete"));
    run(&desk, &part);
    run(&desk, "merge 1.part -o a.exr");
    run(&desk, &format!("{picture} -o b.exr"));
    assert!(fs::read(desk.path("a.exr")).unwrap() == fs::read(desk.path("b.exr")).unwrap());
}

#[test]
fn shards_that_cannot_join_are_refused_before_they_are_rendered() {
    let desk = Desk::new();
    for (arguments, words) in [
        ("--shard 9/8 -o 1.part", &["'9/8' for '--shard", "3/8"][..]),
        ("--shard 1/2 -o a.png", &["--output a.png", "octray merge", ".part"]),
        ("--shard 1/2 -o scene.json", &["scene.json", "not a checkpoint"]),
        ("--shard 1/2 -o 1.part --target-error 0.1", &["--target-error", "--samples"]),
        ("--shard 1/2 -o 1.part --time-limit 9", &["--time-limit", "--samples"]),
        ("--shard 1/2 -o 1.part --samples-map m.png", &["--samples-map"]),
        ("--shard 1/2 -o 1.part --size 16x16", &["the picture has 1 tile"]),
    ] {
        refuses(&desk, &format!("render scene.json {arguments}"), words);
    }
}
