//! Lines in planes with two logarithmic axes, drawn as SVG.
//!
//! Planes are drawn one below the other with shared axes. Each has its legend to the right, in the order in
//! which its lines end.

use super::drawing::{LINE, MARGIN, line_class, marks, path, stroke, svg, text};
use super::scale::Scale;
use maud::{Markup, html};
use std::cmp::Reverse;
use textwrap::wrap;

/// A drawing.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    pub title: String,
    /// Explanations, a paragraph each.
    pub notes: Vec<String>,
    /// The names of the axes.
    pub x: String,
    pub y: String,
    pub panels: Vec<Panel>,
}

/// A plane with lines.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    pub title: String,
    pub lines: Vec<Line>,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    #[default]
    Plain,
    /// Thick, its name bold.
    Default,
    /// Thin: something else is better everywhere.
    Behind,
    /// Outside the comparison.
    Dashed,
    /// Broad, behind the others, without marks.
    Front,
}

/// A polyline.
#[derive(Clone, Debug, Default)]
pub struct Line {
    pub name: String,
    /// A figure after its name, such as a ratio; may be empty.
    pub figure: String,
    pub look: Look,
    /// Its colour and its mark; those of the default and of the front have their own.
    pub number: usize,
    pub points: Vec<[f64; 2]>,
    /// x, and the lower and upper end in y; none or one a point.
    pub band: Vec<[f64; 3]>,
}

/// Left and right edge of the planes, and their height, which is that of the longest legend, too.
const LEFT: i32 = 136;
const RIGHT: i32 = 1_090;
const HEIGHT: i32 = 450;
/// The sample of a line in the legend, and where its name begins.
const SAMPLE: [i32; 2] = [RIGHT + 24, RIGHT + 70];
const NAME: i32 = RIGHT + 84;
/// Most letters of a line of the legend.
const LABEL_LETTERS: usize = 24;
const TICKS: usize = 7;

impl Figure {
    /// Returns the drawing as the text of an SVG file.
    pub fn svg(&self) -> String {
        svg(&self.title, &self.notes, |top, parts| {
            let lines = || self.panels.iter().flat_map(|panel| &panel.lines);
            let of =
                |axis: usize| lines().flat_map(move |line| line.points.iter().map(move |point| point[axis]));
            let bands = lines().flat_map(|line| line.band.iter().flat_map(|band| [band[1], band[2]]));
            let numbers: Vec<f64> = of(1).chain(bands).collect();
            let x = Scale::log(&of(0).collect::<Vec<f64>>(), TICKS, [LEFT, RIGHT]);
            let name = |at, words: &str| text(at, "start", "strong words", &format!("{words} (log scale)"));
            let mut y = top + LINE;
            parts.push(name([MARGIN, y], &self.y));
            for panel in &self.panels {
                y += if panel.title.is_empty() { LINE } else { 2 * LINE };
                panel.draw(&x, &Scale::log(&numbers, TICKS, [y + HEIGHT, y]), y, parts);
                y += HEIGHT + LINE;
            }
            parts.push(name([LEFT, y + LINE], &self.x));
            y + LINE * 3 / 2
        })
    }
}

impl Panel {
    fn draw(&self, x: &Scale, y: &Scale, top: i32, parts: &mut Vec<Markup>) {
        let bottom = top + HEIGHT;
        if !self.title.is_empty() {
            parts.push(text([LEFT, top - LINE * 3 / 4], "start", "strong words", &self.title));
        }
        for (at, label) in x.ticks() {
            parts.push(stroke("grid", 2, &[[at, top], [at, bottom]]));
            parts.push(text([at, bottom + LINE * 3 / 4], "middle", "words", &label));
        }
        for (at, label) in y.ticks() {
            parts.push(stroke("grid", 2, &[[LEFT, at], [RIGHT, at]]));
            parts.push(text([LEFT - 12, at], "end", "words", &label));
        }
        parts.push(stroke("remark", 2, &[[LEFT, top], [LEFT, bottom], [RIGHT, bottom]]));
        // The thick ones first, so that thinner ones of equal values lie on them.
        let mut lines: Vec<&Line> = self.lines.iter().filter(|line| !line.points.is_empty()).collect();
        lines.sort_by_key(|line| Reverse(line.look.thickness()));
        parts.extend(lines.iter().map(|line| line.drawn(x, y)));
        // The legend has the order in which they end.
        lines.sort_by_key(|line| line.points.last().map(|point| y.at(point[1])));
        let mut row = top + LINE / 2;
        for line in lines {
            let [left, right] = SAMPLE;
            parts.push(line.stroke(&[[left, row], [right, row]], &[[(left + right) / 2, row]]));
            let class = if line.look == Look::Default { "strong words" } else { "words" };
            let label = format!("{} {}", line.name, line.figure);
            for words in wrap(label.trim_end(), LABEL_LETTERS) {
                parts.push(text([NAME, row], "start", class, &words));
                row += LINE;
            }
        }
    }
}

impl Look {
    fn thickness(self) -> i32 {
        match self {
            Self::Front => 18,
            Self::Default => 8,
            Self::Plain | Self::Dashed => 4,
            Self::Behind => 2,
        }
    }
}

impl Line {
    fn drawn(&self, x: &Scale, y: &Scale) -> Markup {
        let points: Vec<[i32; 2]> =
            self.points.iter().map(|point| [x.at(point[0]), y.at(point[1])]).collect();
        let below = self.band.iter().map(|band| [x.at(band[0]), y.at(band[1])]);
        let above = self.band.iter().rev().map(|band| [x.at(band[0]), y.at(band[2])]);
        let band: Vec<[i32; 2]> = below.chain(above).collect();
        html! {
            @if !band.is_empty() {
                polygon class={ (self.class()) " mark" } opacity="0.15" points=(path(&band)) {}
            }
            (self.stroke(&points, &points))
        }
    }

    fn class(&self) -> String {
        match self.look {
            Look::Default => "main".into(),
            Look::Front => "front".into(),
            _ => line_class(self.number),
        }
    }

    /// Returns a polyline, and marks at some points.
    fn stroke(&self, points: &[[i32; 2]], marked: &[[i32; 2]]) -> Markup {
        let (class, dashes) = (self.class(), (self.look == Look::Dashed).then_some("12 8"));
        html! {
            polyline class={ (class) " stroke" } stroke-width=(self.look.thickness()) stroke-dasharray=[dashes] points=(path(points)) {}
            @if self.look != Look::Front { (marks(&class, self.number, marked)) }
        }
    }
}
