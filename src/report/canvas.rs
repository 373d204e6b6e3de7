//! Shapes and text as SVG, in colours for light and dark pages.
//!
//! For: `svg`, `Canvas`, `Ink`, `Mark`, `Text`.
//!
//! Only the SVG backend of plotters is used, so no font library is needed: the viewer of the file has the
//! fonts. A unit is half a pixel where the drawing is 800 pixels wide, because plotters rounds to whole
//! units.

#[cfg(test)]
use super::labels::{bold_width, width};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A colour by its purpose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Ink {
    Paper,
    Grid,
    #[default]
    Text,
    Remark,
    /// The default.
    Default,
    /// Behind the front.
    Behind,
    Front,
    /// One of a few lines.
    Line(usize),
}

/// The colours on light paper and on dark. Lines have those of Okabe and Ito, which any kind of colour vision
/// distinguishes, darker where they are too pale on white; light greys tell what is behind.
const INKS: [(Ink, [u32; 2]); 12] = [
    (Ink::Paper, [0xff_ff_ff, 0x0d_11_17]),
    (Ink::Grid, [0xe4_e7_eb, 0x2b_31_3a]),
    (Ink::Text, [0x1f_23_28, 0xe6_ed_f3]),
    (Ink::Remark, [0x59_63_6e, 0x9a_a4_ae]),
    (Ink::Default, [0x00_72_b2, 0x4f_b0_ec]),
    (Ink::Behind, [0x8b_94_9e, 0x7d_85_90]),
    (Ink::Front, [0xcb_d5_df, 0x45_50_5c]),
    (Ink::Line(0), [0xd5_5e_00, 0xf0_7c_22]),
    (Ink::Line(1), [0x00_9e_73, 0x12_b8_88]),
    (Ink::Line(2), [0xcc_79_a7, 0xd9_8a_b6]),
    (Ink::Line(3), [0x3b_40_48, 0xc9_d1_d9]),
    (Ink::Line(4), [0xa8_76_00, 0xe6_9f_00]),
];

impl Ink {
    fn color(self) -> RGBColor {
        let lines = INKS.iter().filter(|(ink, _)| matches!(ink, Self::Line(_))).count();
        let same = |ink: &Ink| match (self, ink) {
            (Self::Line(ours), Self::Line(theirs)) => ours % lines == *theirs,
            (ours, theirs) => ours == *theirs,
        };
        let [_, r, g, b] =
            INKS.iter().find(|(ink, _)| same(ink)).map_or(0, |(_, [light, _])| *light).to_be_bytes();
        RGBColor(r, g, b)
    }
}

/// The mark of a point: lines of one colour differ in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mark {
    #[default]
    Dot,
    Triangle,
    Square,
    Cross,
    Ring,
}

impl Mark {
    pub const ALL: [Self; 5] = [Self::Dot, Self::Triangle, Self::Square, Self::Cross, Self::Ring];
}

/// Which part of a text stands at its place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Align {
    #[default]
    Left,
    Middle,
    Right,
}

/// One line of text; `at` is the middle of its height.
#[derive(Clone, Debug, Default)]
pub(super) struct Text {
    pub at: [i32; 2],
    pub words: String,
    pub size: i32,
    pub align: Align,
    pub ink: Ink,
    pub bold: bool,
}

impl Text {
    /// Left, top, right and bottom edge: tests let none cross another's.
    #[cfg(test)]
    pub fn edges(&self) -> [i32; 4] {
        let wide = if self.bold { bold_width(&self.words, self.size) } else { width(&self.words, self.size) };
        let [x, y] = self.at;
        let left = match self.align {
            Align::Left => x,
            Align::Middle => x - wide / 2,
            Align::Right => x - wide,
        };
        [left, y - self.size * 6 / 10, left + wide, y + self.size * 6 / 10]
    }
}

/// A drawing in progress.
pub(super) struct Canvas<'a>(DrawingArea<SVGBackend<'a>, plotters::coord::Shift>);

pub(super) type DrawResult = Result<(), DrawingAreaErrorKind<std::io::Error>>;
const FONT: &str = "sans-serif";
/// The size that plotters writes is smaller by this factor.
const FONT_SCALE: f64 = 1.24;

/// The text of an SVG file, without a fixed size on the page, with a title for screen readers.
pub(super) fn svg(title: &str, size: [i32; 2], draw: impl FnOnce(&Canvas) -> DrawResult) -> String {
    let mut text = String::new();
    let [width, height] = size.map(|side| side as u32);
    let canvas = Canvas(SVGBackend::with_string(&mut text, (width, height)).into_drawing_area());
    // Writing into a string cannot fail.
    canvas.0.fill(&Ink::Paper.color()).and_then(|()| draw(&canvas)).expect("drawing into memory");
    drop(canvas);
    let named = text.replacen(&format!("width=\"{width}\" height=\"{height}\" "), "role=\"img\" ", 1);
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    match named.find('\n') {
        Some(end) => format!("{}\n<title>{title}</title>\n{}{}", &named[..end], dark(), &named[end..]),
        None => named,
    }
}

/// The rules that replace the colours on screens set to dark. The paper changes too, so a drawing can be read
/// on any page, whatever that page does.
fn dark() -> String {
    let mut rules = String::new();
    for (_, [light, dark]) in INKS {
        for part in ["fill", "stroke"] {
            rules += &format!("svg [{part}=\"#{light:06X}\"] {{ {part}: #{dark:06x} }}\n");
        }
    }
    format!("<style>@media screen and (prefers-color-scheme: dark) {{\n{rules}}}</style>")
}

impl Canvas<'_> {
    pub fn path(&self, points: &[[i32; 2]], ink: Ink, width: u32, dashed: bool) -> DrawResult {
        let points: Vec<_> = points.iter().map(|&[x, y]| (x, y)).collect();
        let style = ink.color().stroke_width(width);
        match dashed {
            true => self.0.draw(&DashedPathElement::new(points, 12, 8, style)),
            false => self.0.draw(&PathElement::new(points, style)),
        }
    }
    /// A pale area.
    pub fn area(&self, points: &[[i32; 2]], ink: Ink) -> DrawResult {
        let points: Vec<_> = points.iter().map(|&[x, y]| (x, y)).collect();
        self.0.draw(&Polygon::new(points, ink.color().mix(0.15).filled()))
    }
    pub fn mark(&self, [x, y]: [i32; 2], mark: Mark, ink: Ink, size: i32) -> DrawResult {
        let (at, color) = ((x, y), ink.color());
        match mark {
            Mark::Dot => self.0.draw(&Circle::new(at, size, color.filled())),
            Mark::Triangle => self.0.draw(&TriangleMarker::new(at, size + 2, color.filled())),
            Mark::Square => {
                self.0.draw(&Rectangle::new([(x - size, y - size), (x + size, y + size)], color.filled()))
            }
            Mark::Cross => self.0.draw(&Cross::new(at, size, color.stroke_width(3))),
            Mark::Ring => self.0.draw(&Circle::new(at, size, color.stroke_width(3))),
        }
    }
    pub fn text(&self, text: &Text) -> DrawResult {
        let font = (FONT, f64::from(text.size) * FONT_SCALE).into_font();
        let font = if text.bold { font.style(FontStyle::Bold) } else { font };
        let horizontal = match text.align {
            Align::Left => HPos::Left,
            Align::Middle => HPos::Center,
            Align::Right => HPos::Right,
        };
        let style = font.color(&text.ink.color()).pos(Pos::new(horizontal, VPos::Center));
        self.0.draw_text(&text.words, &style, (text.at[0], text.at[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawing_scales_has_a_title_and_colours_for_dark_pages() {
        let drawn = svg("a < b", [40, 30], |canvas| {
            canvas.path(&[[0, 0], [10, 10]], Ink::Default, 2, false)?;
            canvas.text(&Text { at: [1, 2], words: "word".into(), size: 20, ..Text::default() })
        });
        assert!(drawn.starts_with("<svg role=\"img\" viewBox=\"0 0 40 30\""), "{drawn}");
        for part in
            ["<title>a &lt; b</title>", "stroke=\"#0072B2\"", "font-size=\"20\"", "prefers-color-scheme"]
        {
            assert!(drawn.contains(part), "{part} in {drawn}");
        }
        // Every colour that is drawn with has a rule.
        for part in drawn.split("fill=\"#").skip(1) {
            assert!(drawn.contains(&format!("svg [fill=\"#{}\"]", &part[..6])), "{}", &part[..6]);
        }
    }

    /// Relative luminance and contrast as WCAG 2 defines them.
    #[test]
    fn text_and_lines_stand_out_on_light_and_on_dark_paper() {
        let luminance = |color: u32| {
            let channel = |shift: u32| {
                let c = f64::from(color >> shift & 255) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            };
            0.2126 * channel(16) + 0.7152 * channel(8) + 0.0722 * channel(0)
        };
        let papers = INKS[0].1;
        for (ink, colors) in INKS {
            let least = match ink {
                Ink::Paper | Ink::Grid | Ink::Front => 1.0,
                Ink::Text | Ink::Remark => 4.5,
                _ => 3.0,
            };
            for (paper, color) in papers.into_iter().zip(colors) {
                let [a, b] = [paper, color].map(|color| luminance(color) + 0.05);
                assert!(a.max(b) / a.min(b) >= least, "{ink:?} {color:06x}: {}", a.max(b) / a.min(b));
            }
        }
    }
}
