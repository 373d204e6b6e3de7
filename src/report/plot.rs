//! Draws lines in planes with shared axes, as SVG.
//!
//! For: [`Figure::svg`].

use super::canvas::{Canvas, DrawResult, Ink, svg};
use super::figure::{Figure, Line, Look, Panel};
use super::layout::{Layout, Placed, PlacedLine};

impl Figure {
    /// The drawing as the text of an SVG file, without a fixed size on the page.
    pub fn svg(&self) -> String {
        let layout = Layout::of(self);
        svg(&self.title, layout.size, |canvas| {
            for (panel, placed) in self.panels.iter().zip(&layout.panels) {
                panel.draw(canvas, placed)?;
            }
            layout.texts.iter().try_for_each(|text| canvas.text(text))
        })
    }
}

impl Panel {
    fn draw(&self, canvas: &Canvas, placed: &Placed) -> DrawResult {
        let [left, top, right, bottom] = placed.edges;
        for x in placed.x.ticks.iter().map(|&tick| placed.x.unit(tick)) {
            canvas.path(&[[x, top], [x, bottom]], Ink::Grid, 2, false)?;
        }
        for y in placed.y.ticks.iter().map(|&tick| placed.y.unit(tick)) {
            canvas.path(&[[left, y], [right, y]], Ink::Grid, 2, false)?;
        }
        canvas.path(&[[left, top], [left, bottom], [right, bottom]], Ink::Behind, 2, false)?;
        placed.lines.iter().try_for_each(|line| self.lines[line.line].draw(canvas, placed, line))
    }
}

impl Line {
    fn draw(
        &self,
        canvas: &Canvas,
        placed: &Placed,
        &PlacedLine { ink, mark, label, .. }: &PlacedLine,
    ) -> DrawResult {
        let place = |x, y| [placed.x.at(x), placed.y.at(y)];
        if self.band.len() > 1 {
            let below = self.band.iter().map(|&[x, low, _]| place(x, low));
            let above = self.band.iter().rev().map(|&[x, _, high]| place(x, high));
            canvas.area(&below.chain(above).collect::<Vec<_>>(), ink)?;
        }
        let points: Vec<[i32; 2]> = self.points.iter().map(|&[x, y]| place(x, y)).collect();
        let (thick, dashed, size) = match self.look {
            Look::Front => (18, false, 0),
            Look::Default => (8, false, 8),
            Look::Plain => (4, false, 7),
            Look::Behind => (3, false, 6),
            Look::Dashed => (4, true, 7),
        };
        let right = placed.edges[2];
        if let Some(&[x, y]) = points.last() {
            canvas.path(&[[x, y], [right + 2, y], [right + 16, label]], ink, 1, false)?;
        }
        canvas.path(&points, ink, thick, dashed)?;
        canvas.path(&[[right + 18, label], [right + 44, label]], ink, thick, dashed)?;
        if self.look != Look::Front {
            for &point in points.iter().chain(&[[right + 31, label]]) {
                canvas.mark(point, mark, ink, size)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::{Axis, MOST_LINES};
    use crate::report::layout::collisions;

    fn line(name: &str, points: &[[f64; 2]]) -> Line {
        Line { name: name.into(), points: points.to_vec(), ..Line::default() }
    }

    fn figure(panels: Vec<Panel>) -> Figure {
        let log = |label: &str| Axis { label: label.into(), log: true };
        Figure {
            title: "time < error".into(),
            notes: vec!["a note".into()],
            x: log("time"),
            y: log("error"),
            panels,
        }
    }

    #[test]
    fn drawing_holds_names_at_the_ends_of_lines_and_bands() {
        let mut drawn =
            figure(Panel::split("", &[], vec![line("way", &[[1.0, 1.0], [10.0, 0.1], [100.0, 0.0]])]));
        let plain = drawn.svg();
        for part in ["<title>time &lt; error</title>", ">\na note\n<", ">\nway\n<", ">\n0\n<", "</svg>"] {
            assert!(plain.contains(part), "{part}");
        }
        let line = &mut drawn.panels[0].lines[0];
        line.band = vec![[1.0, 0.5, 2.0], [10.0, 0.05, 0.2]];
        line.figure = "2×".into();
        let rich = drawn.svg();
        assert!(rich.contains(">\nway 2×\n<"));
        assert_eq!(rich.matches("<polygon").count(), plain.matches("<polygon").count() + 1);
    }

    #[test]
    fn nothing_to_draw_is_drawn() {
        assert!(Figure::default().svg().ends_with("</svg>\n"));
        assert!(figure(Panel::split("", &[], Vec::new())).svg().ends_with("</svg>\n"));
    }

    /// Six lines of long names that end in one point, in one panel to five.
    #[test]
    fn no_text_covers_another_or_leaves_the_drawing() {
        let ends = [[1e3, 1e-4], [1.0, 1e-9], [1e6, 1e4]];
        for count in 1..=5 {
            for end in ends {
                let lines: Vec<Line> = (0..MOST_LINES)
                    .map(|number| Line {
                        name: format!("every primitive tested {number}"),
                        figure: "0.33×".into(),
                        ..line("", &[[0.5, 1.0 + number as f64], end])
                    })
                    .collect();
                let panels =
                    (0..count).flat_map(|_| Panel::split("Same picture, other speed", &[], lines.clone()));
                let mut drawn = figure(panels.collect());
                drawn.title =
                    "a folder of a long name/of another/and the scene.json: error against time".into();
                drawn.notes =
                    vec!["A sentence of some length that explains what is to be seen here. ".repeat(3)];
                let layout = Layout::of(&drawn);
                let found = collisions(layout.size, &layout.texts);
                assert!(found.is_empty(), "{count} panels: {found:#?}");
                for panel in &layout.panels {
                    let [left, top, right, bottom] = panel.edges;
                    assert!(right - left > 300 && bottom - top > 300, "the plane keeps its size");
                    for text in &layout.texts {
                        let [text_left, text_top, text_right, text_bottom] = text.edges();
                        let aside = text_right <= left || text_left >= right;
                        let clear = aside || text_bottom <= top || text_top >= bottom;
                        assert!(clear, "{count} panels: {:?} on a plane", text.words);
                    }
                }
            }
        }
    }
}
