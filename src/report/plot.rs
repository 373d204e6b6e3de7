//! Lines in a plane, drawn as SVG.
//!
//! For: [`Figure`]. May import: `axis`; `plotters`, which no other file uses. Must not know: the meaning of
//! the numbers.
//!
//! Only the SVG backend of plotters is used, so no font library is needed: the viewer of the file has the
//! fonts.

pub use super::axis::Axis;
use super::axis::Range;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A drawing.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    pub title: String,
    /// Explanations under the title, one line each.
    pub notes: Vec<String>,
    pub x: Axis,
    pub y: Axis,
    pub lines: Vec<Line>,
    /// Thin lines behind the data, such as those of equal efficiency.
    pub guides: Vec<[[f64; 2]; 2]>,
}

/// A polyline.
#[derive(Clone, Debug, Default)]
pub struct Line {
    pub name: String,
    /// Drawn thicker, with its name in bold: the default.
    pub strong: bool,
    /// Number of its colour and mark, so that a line looks the same in all figures; by default its index in
    /// the figure.
    pub style: Option<usize>,
    /// Distinguishes two families of lines.
    pub dashed: bool,
    pub points: Vec<[f64; 2]>,
    /// x, and the lower and upper end in y; none or one a point.
    pub band: Vec<[f64; 3]>,
    /// Indices of points with a ring: those on the Pareto front.
    pub ringed: Vec<usize>,
}

/// Width and height in units of the drawing, which scales to its place on the page. A unit is half a pixel
/// there, because plotters rounds to whole units.
const SIZE: [u32; 2] = [1_800, 1_080];
const TEXT: u32 = 26;
const LEGEND_LINE: i32 = 34;
/// Width of a letter, as a share of the size of the text.
const LETTER: f64 = 0.55;

/// The colours of Okabe and Ito, distinguishable with any kind of colour vision; without yellow, which is too
/// pale on white.
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(80, 80, 80),
];
const FONT: &str = "sans-serif";

type Canvas<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type DrawResult = Result<(), DrawingAreaErrorKind<std::io::Error>>;

impl Figure {
    /// The drawing as the text of an SVG file, without a fixed size on the page.
    pub fn svg(&self) -> String {
        let mut text = String::new();
        let area = SVGBackend::with_string(&mut text, (SIZE[0], SIZE[1])).into_drawing_area();
        // Writing into a string cannot fail.
        self.draw(&area).expect("drawing into memory");
        drop(area);
        without_fixed_size(&text, &self.title)
    }

    fn draw(&self, area: &Canvas) -> DrawResult {
        area.fill(&WHITE)?;
        let title = (FONT, TEXT + 10).into_font().style(FontStyle::Bold).color(&BLACK);
        area.draw_text(&self.title, &title, (30, 24))?;
        let small = (FONT, TEXT - 2).into_font().color(&RGBColor(70, 70, 70));
        for (number, note) in self.notes.iter().enumerate() {
            area.draw_text(note, &small, (30, 74 + 32 * number as i32))?;
        }
        let top = 84 + 32 * self.notes.len() as i32;
        let longest = self.lines.iter().map(|line| line.name.chars().count()).max().unwrap_or(0);
        let legend = (longest as f64 * LETTER * f64::from(TEXT)) as i32 + 120;
        let [width, height] = SIZE.map(|side| side as i32);
        self.draw_plane(area, [150, width - legend - 20], [top, height - 100])?;
        self.draw_legend(area, width - legend + 10, top + 20)
    }

    /// Axes and data inside this rectangle, in units of the drawing.
    fn draw_plane(&self, area: &Canvas, [left, right]: [i32; 2], [top, bottom]: [i32; 2]) -> DrawResult {
        let of = |axis: usize| {
            let points =
                self.lines.iter().flat_map(move |line| line.points.iter().map(move |point| point[axis]));
            let bands =
                self.lines.iter().flat_map(|line| line.band.iter().flat_map(|band| [band[1], band[2]]));
            points.chain(bands.filter(move |_| axis == 1)).collect::<Vec<_>>()
        };
        let x = Range::of(&self.x, &of(0), [left, right]);
        let y = Range::of(&self.y, &of(1), [bottom, top]);
        let grid = RGBColor(225, 225, 225).stroke_width(2);
        let text = |font: FontDesc<'static>, x, y| font.color(&BLACK).pos(Pos::new(x, y));
        let font = || (FONT, TEXT).into_font();
        for &tick in &x.ticks {
            let at = x.unit(tick);
            area.draw(&PathElement::new([(at, top), (at, bottom)], grid))?;
            area.draw_text(&x.label(tick), &text(font(), HPos::Center, VPos::Top), (at, bottom + 12))?;
        }
        for &tick in &y.ticks {
            let at = y.unit(tick);
            area.draw(&PathElement::new([(left, at), (right, at)], grid))?;
            area.draw_text(&y.label(tick), &text(font(), HPos::Right, VPos::Center), (left - 12, at))?;
        }
        area.draw(&Rectangle::new([(left, top), (right, bottom)], RGBColor(90, 90, 90).stroke_width(2)))?;
        let style = text(font(), HPos::Center, VPos::Top);
        area.draw_text(&self.x.name(), &style, ((left + right) / 2, bottom + 56))?;
        let style = text(font().transform(FontTransform::Rotate270), HPos::Center, VPos::Top);
        area.draw_text(&self.y.name(), &style, (16, (top + bottom) / 2))?;
        let place = |[a, b]: [f64; 2]| (x.unit(x.place(a)), y.unit(y.place(b)));
        for guide in &self.guides {
            let ends = guide.map(|[a, b]| (x.place(a), y.place(b)));
            if let Some(ends) = clip(ends, [x.low, x.high], [y.low, y.high]) {
                let ends = ends.map(|(a, b)| (x.unit(a), y.unit(b)));
                area.draw(&DashedPathElement::new(ends, 4, 8, RGBColor(150, 150, 150).stroke_width(1)))?;
            }
        }
        for (number, line) in self.lines.iter().enumerate() {
            draw_line(area, line, line.style.unwrap_or(number), &place)?;
        }
        Ok(())
    }

    fn draw_legend(&self, area: &Canvas, left: i32, top: i32) -> DrawResult {
        for (number, line) in self.lines.iter().enumerate() {
            let y = top + LEGEND_LINE * number as i32;
            let style = line.style.unwrap_or(number);
            draw_path(area, line, style, &[(left, y), (left + 56, y)])?;
            draw_mark(area, (left + 28, y), style)?;
            let font = (FONT, TEXT).into_font();
            let font = if line.strong { font.style(FontStyle::Bold) } else { font };
            let style = font.color(&BLACK).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw_text(&line.name, &style, (left + 70, y))?;
        }
        Ok(())
    }
}

fn draw_line(
    area: &Canvas,
    line: &Line,
    number: usize,
    place: &impl Fn([f64; 2]) -> (i32, i32),
) -> DrawResult {
    let color = COLORS[number % COLORS.len()];
    if line.band.len() > 1 {
        let below = line.band.iter().map(|&[x, low, _]| place([x, low]));
        let above = line.band.iter().rev().map(|&[x, _, high]| place([x, high]));
        area.draw(&Polygon::new(below.chain(above).collect::<Vec<_>>(), color.mix(0.15).filled()))?;
    }
    let points: Vec<_> = line.points.iter().map(|&point| place(point)).collect();
    draw_path(area, line, number, &points)?;
    for &point in &points {
        draw_mark(area, point, number)?;
    }
    for &point in line.ringed.iter().filter_map(|&at| points.get(at)) {
        area.draw(&Circle::new(point, 14, BLACK.stroke_width(3)))?;
    }
    Ok(())
}

fn draw_path(area: &Canvas, line: &Line, number: usize, points: &[(i32, i32)]) -> DrawResult {
    let style = COLORS[number % COLORS.len()].stroke_width(if line.strong { 7 } else { 3 });
    match line.dashed {
        true => area.draw(&DashedPathElement::new(points.to_vec(), 10, 8, style)),
        false => area.draw(&PathElement::new(points.to_vec(), style)),
    }
}

/// Lines of one colour differ in the marks of their points.
fn draw_mark(area: &Canvas, at: (i32, i32), number: usize) -> DrawResult {
    let color = COLORS[number % COLORS.len()];
    match number / COLORS.len() {
        0 => area.draw(&Circle::new(at, 6, color.filled())),
        1 => area.draw(&TriangleMarker::new(at, 10, color.filled())),
        _ => area.draw(&Cross::new(at, 8, color.stroke_width(3))),
    }
}

/// The part of a line segment inside the ranges.
fn clip(ends: [(f64, f64); 2], x: [f64; 2], y: [f64; 2]) -> Option<[(f64, f64); 2]> {
    let [a, b] = ends;
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for (start, end, [low, high]) in [(a.0, b.0, x), (a.1, b.1, y)] {
        let way = end - start;
        let (first, last) = ((low - start) / way, (high - start) / way);
        if way == 0.0 {
            if start < low || start > high {
                return None;
            }
        } else {
            (from, to) = (from.max(first.min(last)), to.min(first.max(last)));
        }
    }
    let at = |share: f64| (a.0 + (b.0 - a.0) * share, a.1 + (b.1 - a.1) * share);
    (from < to).then(|| [at(from), at(to)])
}

/// Removes the fixed size, so that the drawing fills its place, and adds a title for screen readers.
fn without_fixed_size(text: &str, title: &str) -> String {
    let fixed = format!("width=\"{}\" height=\"{}\" ", SIZE[0], SIZE[1]);
    let named = text.replacen(&fixed, "role=\"img\" ", 1);
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    match named.find("\n") {
        Some(end) => format!("{}\n<title>{title}</title>{}", &named[..end], &named[end..]),
        None => named,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[[f64; 2]]) -> Line {
        Line { name: "way".into(), points: points.to_vec(), ..Line::default() }
    }

    #[test]
    fn guides_end_at_the_edges() {
        let unit = [0.0, 1.0];
        assert_eq!(clip([(-1.0, -1.0), (2.0, 2.0)], unit, unit), Some([(0.0, 0.0), (1.0, 1.0)]));
        assert_eq!(clip([(-1.0, 2.0), (2.0, 2.0)], unit, unit), None);
    }

    #[test]
    fn drawing_holds_names_marks_and_bands_and_scales() {
        let mut figure = Figure {
            title: "time < error".into(),
            notes: vec!["a note".into()],
            x: Axis { label: "time".into(), log: true },
            y: Axis { label: "error".into(), log: true },
            lines: vec![line(&[[1.0, 1.0], [10.0, 0.1], [100.0, 0.0]])],
            guides: vec![[[1.0, 1.0], [100.0, 0.1]]],
        };
        let plain = figure.svg();
        assert!(plain.starts_with("<svg role=\"img\" viewBox="), "{}", &plain[..80]);
        for part in ["<title>time &lt; error</title>", "a note", ">\nway\n<", ">\n0\n<", "</svg>"] {
            assert!(plain.contains(part), "{part}");
        }
        figure.lines[0].ringed = vec![0];
        figure.lines[0].band = vec![[1.0, 0.5, 2.0], [10.0, 0.05, 0.2]];
        let rich = figure.svg();
        assert_eq!(rich.matches("<circle").count(), plain.matches("<circle").count() + 1);
        assert_eq!(rich.matches("<polygon").count(), plain.matches("<polygon").count() + 1);
    }

    #[test]
    fn nothing_to_draw_is_drawn() {
        assert!(Figure::default().svg().ends_with("</svg>\n"));
    }
}
