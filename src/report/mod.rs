//! Reports: the figures of the commands as text, JSON, CSV, SVG and HTML.
//!
//! | file | what it holds |
//! |---|---|
//! | `bench`, `compare`, `rays`, `render`, `stability` | the report of a command: JSON and text, drawings |
//! | `inspection`, with `methods`; `path` | the reports of `inspect` |
//! | [`chart`], `tables`, [`page`] | the report of `chart`: JSON and text, CSV, HTML |
//! | `chart_drawings`, `chart_kernels` | the drawings of `chart` |
//! | [`settings`] | how figures were made: a part of every report |
//! | `baseline` | an earlier report of `bench`, and the ratios to it |
//! | `stats` | the tables of `--stats` |
//! | `figure`, `dots`, over `drawing` and `scale` | lines in planes, tables of dots, as SVG |
//! | `numbers`, `text` | numbers as text; paragraphs, rows of tables, the warning of a busy machine |

pub(crate) mod baseline;
pub(crate) mod bench;
pub mod chart;
pub(crate) mod chart_drawings;
pub(crate) mod chart_kernels;
pub(crate) mod compare;
pub(crate) mod dots;
pub(crate) mod drawing;
pub(crate) mod figure;
pub(crate) mod inspection;
pub(crate) mod methods;
pub(crate) mod numbers;
pub mod page;
pub(crate) mod path;
pub(crate) mod rays;
pub(crate) mod render;
pub(crate) mod scale;
pub mod settings;
pub(crate) mod stability;
pub(crate) mod stats;
pub(crate) mod tables;
pub(crate) mod text;

/// A report of checks.
pub(crate) trait Checked {
    /// Whether a check failed.
    fn has_failed(&self) -> bool;
}
