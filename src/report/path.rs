//! The report of `octray inspect --pixel`: one path in f64 and f32 beside each other.

use super::inspection::type_of;
use super::text::row;
use crate::render::Settings;
use crate::scene::Scene;
use crate::wording::counted;
use serde_json::Value;

/// The name of a row, then f64's and f32's three numbers.
const WIDTHS: [isize; 7] = [-16, 16, 16, 16, 19, 16, 16];
const ROWS: [&str; 8] =
    ["distance", "point", "normal", "throughput", "+ emitted", "light direction", "+ light", "= radiance"];

/// Formats the JSON report as text for people. Rows that say nothing are left out.
pub fn text(report: &Value, scene: &Scene, settings: &Settings) -> String {
    let Settings { resolution: [width, height], max_bounces, seed, .. } = settings;
    let [x, y] = [0, 1].map(|at| &report["pixel"][at]);
    let mut text = format!(
        "pixel {x},{y} of {width}×{height}, sample {}, up to {}, seed {seed}\n\
         + is what the path adds to the pixel, times the throughput; = is their sum so far\n\n",
        report["sample"],
        counted(max_bounces, "bounce", "bounces"),
    );
    text += &row(&WIDTHS, ["", "f64: reference", "", "", "f32: engine"]);
    let count = ["f64", "f32"].map(|key| report[key].as_array().map_or(0, Vec::len));
    for at in 0..count[0].max(count[1]) {
        let vertices = ["f64", "f32"].map(|key| &report[key][at]);
        let [a, b] = vertices.map(|vertex| place(vertex, scene));
        let parts = if report["part_at"] == at { "\nThe two paths part here.\n" } else { "" };
        let place = if a == b { a } else { format!("f64 {a}; f32 {b}") };
        text += &format!("{parts}\nvertex {at}: {place}\n");
        for label in ROWS {
            let key = label.trim_start_matches(['+', '=', ' ']).replace(' ', "_");
            let [a, b] = vertices.map(|vertex| numbers(&vertex[&key]));
            let is_sum = !b.is_empty() && ["+ light", "= radiance"].contains(&label);
            if is_sum || a.iter().chain(&b).any(|&number| number != 0.0) {
                let cells = [&[label.into()], &cells(&a)[..], &cells(&b)[..]].concat();
                text += &format!("{}\n", row(&WIDTHS, cells).trim_end());
            }
        }
    }
    let mut engine = report["f32"].as_array().into_iter().flatten();
    let samples_lights = engine.any(|vertex| !vertex["light"].is_null());
    let note =
        "\nThe engine samples lights, the reference does not: --lights off makes both compute the same.\n";
    text + if samples_lights { note } else { "\n" }
}

/// Names the primitive, the material and the lobe of a vertex.
fn place(vertex: &Value, scene: &Scene) -> String {
    let Some(primitive) = vertex["primitive"].as_u64().map(|index| index as usize) else {
        return (if vertex.is_null() { "no vertex" } else { "the environment" }).into();
    };
    let (list, index) = scene.place(primitive);
    let material = &scene.materials[scene.primitive(primitive).material() as usize];
    let lobe = vertex["lobe"].as_str().unwrap_or("the path ends");
    format!("{list}[{index}], `{}` ({}), {lobe}", material.name, type_of(material.kind))
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().map_or(std::slice::from_ref(value), Vec::as_slice);
    list.iter().filter_map(Value::as_f64).collect()
}

/// Formats three numbers with up to nine significant digits, which is all that f32 has.
fn cells(numbers: &[f64]) -> [String; 3] {
    let text = |&x: &f64| {
        if x != 0.0 && !(1e-4..1e10).contains(&x.abs()) {
            return format!("{x:.8e}");
        }
        let digits = (8.0 - x.abs().log10().floor()).clamp(1.0, 12.0) as usize;
        format!("{x:.digits$}").trim_end_matches('0').trim_end_matches('.').into()
    };
    let absent = if numbers.is_empty() { "–" } else { "" };
    std::array::from_fn(|at| numbers.get(at).map_or(absent.into(), text))
}
