//! The parts that all drawings share: colours for light and dark pages, marks, title and notes.

use maud::{Markup, PreEscaped, html};
use textwrap::wrap;

/// A drawing as the text of an SVG file.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// File name, without folder and extension.
    pub name: String,
    /// SVG text, without a fixed size on the page.
    pub svg: String,
}

/// Returns a scene's name as part of a file name: letters and digits, and hyphens for all else.
pub fn file_name(scene: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let name: String = scene.strip_prefix("builtin:").unwrap_or(scene).chars().map(plain).collect();
    let words: Vec<&str> = name.split('-').filter(|word| !word.is_empty()).collect();
    words.join("-")
}

/// Width of every drawing in its units. It is shown at about half of it.
pub(super) const WIDTH: i32 = 1_600;
pub(super) const MARGIN: i32 = 24;
/// Height of a line of text.
pub(super) const LINE: i32 = 34;
/// Sizes of letters.
const TITLE: i32 = 34;
const TEXT: i32 = 25;
/// The width of a bold letter of the wider common fonts: the viewer of a drawing has the font.
pub(super) const LETTER: i32 = 17;
/// Most letters of a line of the title and of notes, likewise.
const TITLE_LETTERS: usize = 66;
const NOTE_LETTERS: usize = 100;

/// Classes, and their colours on light and on dark paper.
const INKS: [(&str, [u32; 2]); 6] = [
    ("paper", [0xff_ff_ff, 0x0d_11_17]),
    ("grid", [0xe4_e7_eb, 0x2b_31_3a]),
    ("words", [0x1f_23_28, 0xe6_ed_f3]),
    ("remark", [0x59_63_6e, 0x9a_a4_ae]),
    ("front", [0xcb_d5_df, 0x45_50_5c]),
    ("main", [0x00_72_b2, 0x4f_b0_ec]),
];

/// The colours of lines: those of Okabe and Ito, which any kind of colour vision distinguishes, darker where
/// they are too pale on white, and others between them.
const LINES: [[u32; 2]; 10] = [
    [0x00_8f_68, 0x12_b8_88],
    [0xd5_5e_00, 0xf0_7c_22],
    [0xb0_4a_86, 0xe0_8f_be],
    [0x8f_65_00, 0xe6_9f_00],
    [0x6b_4f_c8, 0xa7_93_f0],
    [0x5e_7a_12, 0xa3_c2_3f],
    [0xb8_2e_2e, 0xf0_76_76],
    [0x3b_40_48, 0xc9_d1_d9],
    [0x0e_7f_8c, 0x45_c4_d0],
    [0x8a_5a_3c, 0xc9_98_78],
];

/// The marks of points, as paths around them.
const MARKS: [&str; 4] = [
    "m-8 0a8 8 0 1 0 16 0a8 8 0 1 0 -16 0z",
    "m-9 7h18l-9 -16z",
    "m-7 -7h14v14h-14z",
    "m0 -10l10 10l-10 10l-10 -10z",
];

/// Returns the class of a numbered line's colour. Twenty differ by it or by their marks.
pub(super) fn line_class(number: usize) -> String {
    format!("line-{}", number % LINES.len())
}

/// Returns the mark of a number around each of these points.
pub(super) fn marks(class: &str, number: usize, points: &[[i32; 2]]) -> Markup {
    let shape = MARKS[number % MARKS.len()];
    let path: String = points.iter().map(|[x, y]| format!("M{x} {y}{shape}")).collect();
    html! { path class={ (class) " mark" } d=(path) {} }
}

/// Formats points as an SVG attribute.
pub(super) fn path(points: &[[i32; 2]]) -> String {
    points.iter().map(|[x, y]| format!("{x},{y} ")).collect()
}

/// Returns a line of a grid or an axis.
pub(super) fn stroke(class: &str, width: i32, points: &[[i32; 2]]) -> Markup {
    html! { polyline class={ (class) " stroke" } stroke-width=(width) points=(path(points)) {} }
}

/// Draws one line of text; `y` is the middle of its height, `anchor` the part of it at `x`.
pub(super) fn text([x, y]: [i32; 2], anchor: &str, class: &str, words: &str) -> Markup {
    let size = if class.starts_with("title") { TITLE } else { TEXT };
    html! { text x=(x) y=(y) dy="0.35em" text-anchor=(anchor) font-size=(size) class=(class) { (words) } }
}

/// Returns the text of an SVG file with title and notes, a paragraph each. `draw` adds what stands below a
/// height, and gives the height at which that ends.
pub(super) fn svg(title: &str, notes: &[String], draw: impl FnOnce(i32, &mut Vec<Markup>) -> i32) -> String {
    let mut y = MARGIN + TITLE / 2;
    let mut parts = Vec::new();
    for words in wrap(title, TITLE_LETTERS) {
        parts.push(text([MARGIN, y], "start", "title words", &words));
        y += TITLE * 5 / 4;
    }
    for words in notes.iter().flat_map(|note| wrap(note, NOTE_LETTERS)) {
        parts.push(text([MARGIN, y], "start", "remark", &words));
        y += LINE;
    }
    let height = draw(y, &mut parts) + MARGIN;
    let drawing = html! {
        svg role="img" viewBox={ "0 0 " (WIDTH) " " (height) } xmlns="http://www.w3.org/2000/svg" font-family="sans-serif" {
            title { (title) }
            style { (PreEscaped(style())) }
            rect class="paper mark" width=(WIDTH) height=(height) {}
            @for part in &parts { (part) }
        }
    };
    drawing.into_string() + "\n"
}

/// Classes of shapes and colours. The paper too changes on screens set to dark, so a drawing can be read on
/// any page, whatever that page does.
fn style() -> String {
    let lines = LINES.iter().enumerate().map(|(number, colors)| (line_class(number), *colors));
    let inks: Vec<_> =
        INKS.map(|(class, colors)| (class.to_owned(), colors)).into_iter().chain(lines).collect();
    let colors = |dark: usize| -> String {
        inks.iter()
            .map(|(class, colors)| format!("svg .{class} {{ color: #{:06x} }}\n", colors[dark]))
            .collect()
    };
    format!(
        "svg text, svg .mark {{ fill: currentColor }}\n\
         svg .stroke {{ fill: none; stroke: currentColor }}\n\
         svg .title, svg .strong {{ font-weight: bold }}\n\
         {}@media screen and (prefers-color-scheme: dark) {{\n{}}}\n",
        colors(0),
        colors(1)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::srgb_to_linear;

    /// Relative luminance and contrast as WCAG 2 defines them.
    #[test]
    fn text_and_lines_stand_out_on_light_and_on_dark_paper() {
        let luminance = |color: u32| {
            let channel = |shift: u32| srgb_to_linear(f64::from(color >> shift & 255) / 255.0);
            0.2126 * channel(16) + 0.7152 * channel(8) + 0.0722 * channel(0)
        };
        let papers = INKS[0].1;
        for (class, colors) in INKS.into_iter().chain(LINES.map(|colors| ("line", colors))) {
            let least = match class {
                "paper" | "grid" | "front" => 1.0,
                "words" | "remark" => 4.5,
                _ => 3.0,
            };
            for (paper, color) in papers.into_iter().zip(colors) {
                let [a, b] = [paper, color].map(|color| luminance(color) + 0.05);
                assert!(a.max(b) / a.min(b) >= least, "{class} {color:06x}: {}", a.max(b) / a.min(b));
            }
        }
    }
}
