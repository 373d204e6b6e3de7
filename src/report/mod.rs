//! Reports: the figures of the commands as text, JSON, CSV, SVG and HTML.
//!
//! May import: `measure`, `machine` and everything above them. Must not know: command lines, files,
//! terminals.
//!
//! | file | what it holds |
//! |---|---|
//! | [`mod@bench`], [`compare`], [`rays`], [`render`], [`stability_table`] | the report of a command: JSON and text |
//! | [`inspection`], with [`defaults`] and [`traversal`] | the report of `inspect` |
//! | [`chart`], [`chart_text`], [`tables`], [`page`] | the report of `chart`: JSON, text, CSV, HTML |
//! | [`chart_drawings`], [`chart_kernels`], [`drawing`] | the drawings of `chart` |
//! | [`stability`] | the drawings of `stability` |
//! | [`stats`] | the tables of `--stats` |
//! | [`figure`], [`plot`], [`layout`], [`axis`], [`labels`] | lines in planes, with their names beside them |
//! | [`dots`], [`canvas`] | tables of dots; shapes and text as SVG |
//! | [`numbers`] | numbers as text |

pub mod axis;
pub mod bench;
pub mod canvas;
pub mod chart;
pub mod chart_drawings;
pub mod chart_kernels;
pub mod chart_text;
pub mod compare;
pub mod defaults;
pub mod dots;
pub mod drawing;
pub mod figure;
pub mod inspection;
pub mod labels;
pub mod layout;
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
