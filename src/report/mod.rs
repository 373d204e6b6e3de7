//! Reports: the figures of the commands as text, JSON, CSV, SVG and HTML.
//!
//! May import: `measure`, `machine` and everything above them. Must not know: command lines, files,
//! terminals.
//!
//! | file | what it holds |
//! |---|---|
//! | [`mod@bench`], [`compare`], [`rays`], [`render`], [`stability_table`] | the report of a command: JSON and text |
//! | [`inspection`], with [`defaults`] and [`traversal`] | the report of `inspect` |
//! | [`chart`], [`chart_text`], [`tables`], [`page`] | the report of `chart`: JSON and drawings, text, CSV, HTML |
//! | [`stability`] | the drawings of `stability` |
//! | [`stats`] | the tables of `--stats` |
//! | [`plot`], [`axis`] | lines in a plane, as SVG |
//! | [`numbers`] | numbers as text |

pub mod axis;
pub mod bench;
pub mod chart;
pub mod chart_text;
pub mod compare;
pub mod defaults;
pub mod inspection;
pub mod numbers;
pub mod page;
pub mod plot;
pub mod rays;
pub mod render;
pub mod stability;
pub mod stability_table;
pub mod stats;
pub mod tables;
pub mod traversal;
