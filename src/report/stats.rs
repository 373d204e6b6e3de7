//! The tables of `--stats`.

use super::numbers::figure;
use super::text::{paragraph, row};
use crate::measure::stats::{BounceStats, FrameStats, PerRay, RayStats, TestStats};
use crate::wording::{counted, grouped};

/// Most bounces that a table shows; the JSON report has all.
const MOST_BOUNCES: usize = 12;

const TESTS: &str = "\
A test is one ray, or one frustum around many rays, against one box or primitive; in brackets the number of \
steps, each of up to one test a lane at once. Traversals of a hierarchy have the machine's lanes, whatever \
--lanes says. Primitives that no ray of a tile can meet, or that can occlude no light, are not tested.";
const STAGES: &str = "\
Stages: nanoseconds per ray of any kind, summed over threads, including the cost of counting; share of all \
stages. Generate makes the camera's rays; trace finds the hits of these and of all later segments; shade adds \
emitted light, samples materials and lights; finish adds what the last segments of paths end at.";
const SIMD_UTILISATION: &str = "\
SIMD utilisation: rays over the lanes of the packets that hold them, and the share of rays after this number of \
bounces in all rays. From two bounces on, tiles share packets: more of them with fewer threads.";

/// Returns a table with one column for each of `columns`, below `heading`.
pub fn frames(heading: &str, columns: &[&FrameStats]) -> String {
    let widths = [&[-28][..], &vec![22; columns.len()]].concat();
    let mut text = String::from("\n");
    let mut add = |name: &str, cell: &dyn Fn(&FrameStats) -> String| {
        let cells = columns.iter().map(|column| cell(column));
        text += &row(&widths, std::iter::once(name.to_owned()).chain(cells));
    };
    add(heading, &|column| engine_name(column.lanes, column.threads));
    for (at, stage) in columns[0].stages.iter().enumerate() {
        let of = |column: &FrameStats| {
            let stage = &column.stages[at];
            let time = format!("{} ns", figure(stage.ns_per_ray, 1));
            format!("{time} {:>5.1} %", 100.0 * stage.share)
        };
        if columns.iter().any(|column| column.stages[at].seconds > 0.0) {
            add(stage.stage, &of);
        }
    }
    for (at, kind) in columns[0].kinds.iter().enumerate() {
        let share = |column: &FrameStats| {
            let rays = column.kinds[at].rays as f64;
            let frames = f64::from(column.frames.max(1));
            let share = 100.0 * rays / (column.rays as f64).max(1.0);
            format!("{} {share:>5.1} %", grouped(format!("{:.0}", rays / frames)))
        };
        add(&format!("{} rays a pass", kind.kind), &share);
        for (what, of) in KINDS {
            let counted = |column: &FrameStats| of(&column.kinds[at].tests).tests > 0;
            if columns.iter().any(|column| counted(column)) {
                let cell = |column: &FrameStats| cell(of(&column.kinds[at].tests));
                add(&format!("  {what} tests a ray"), &cell);
            }
        }
    }
    let bounces = columns.iter().map(|column| column.bounces.len()).max().unwrap_or(0);
    for bounce in 0..bounces.min(MOST_BOUNCES) {
        let of = |column: &FrameStats| {
            let lanes = |bounce: &BounceStats| {
                let share = 100.0 * bounce.rays as f64 / column.rays as f64;
                format!("{:.1} % {share:>5.1} %", 100.0 * bounce.simd_utilisation)
            };
            column.bounces.get(bounce).map_or(String::new(), lanes)
        };
        add(&format!("SIMD utilisation, bounce {bounce}"), &of);
    }
    if bounces > MOST_BOUNCES {
        let more = counted(bounces - MOST_BOUNCES, "bounce", "bounces");
        text += &format!("  (and {more} more: --json has them)\n");
    }
    text
}

/// Explains the tables of [`frames`].
pub fn meaning_of_frames() -> String {
    "\n".to_owned() + &[STAGES, SIMD_UTILISATION, TESTS].map(paragraph).concat()
}

/// Returns a row for each kind of rays and traversal.
pub fn rays(rows: &[RayStats]) -> String {
    const WIDTHS: [isize; 5] = [-9, -10, 24, 24, 24];
    let names = KINDS.map(|(what, _)| format!("{what} tests a ray"));
    let mut text =
        "\n".to_owned() + &row(&WIDTHS, ["kind".into(), "traversal".into()].into_iter().chain(names));
    for of_kind in rows {
        let cells = KINDS.map(|(_, of)| cell(of(&of_kind.tests)));
        let names = [of_kind.kind.name().to_owned(), of_kind.traversal.to_string()];
        text += &row(&WIDTHS, names.into_iter().chain(cells));
    }
    text + &paragraph(TESTS)
}

type Of = fn(&TestStats) -> PerRay;
const KINDS: [(&str, Of); 3] =
    [("box", |tests| tests.boxes), ("triangle", |tests| tests.triangles), ("sphere", |tests| tests.spheres)];

fn cell(tests: PerRay) -> String {
    match tests.tests {
        0 => "-".into(),
        _ => format!("{} ({})", hundredths(tests.tests_per_ray), hundredths(tests.steps_per_ray)),
    }
}

fn hundredths(x: f64) -> String {
    grouped(format!("{x:.2}"))
}

/// Returns a width and a number of threads in words.
pub fn engine_name(lanes: usize, threads: usize) -> String {
    format!("{}, {}", engine(lanes), counted(threads, "thread", "threads"))
}

/// Returns a width in words.
pub fn engine(lanes: usize) -> String {
    if lanes == 1 { "scalar".into() } else { format!("{lanes} lanes") }
}
