//! Reports: the figures of the commands as text, JSON, CSV, SVG and HTML.
//!
//! | file | what it holds |
//! |---|---|
//! | `bench`, `compare`, `rays`, `render`, `stability_table` | the report of a command: JSON and text |
//! | `inspection`, with `defaults` and `traversal` | the report of `inspect` |
//! | [`chart`], `chart_text`, `tables`, [`page`] | the report of `chart`: JSON, text, CSV, HTML |
//! | `chart_drawings`, `chart_kernels`, `drawing` | the drawings of `chart` |
//! | `stability` | the drawings of `stability` |
//! | `stats` | the tables of `--stats` |
//! | `figure`, `plot`, `layout`, `axis`, `labels` | lines in planes, with their names beside them |
//! | `dots`, `canvas` | tables of dots; shapes and text as SVG |
//! | `numbers`, `paragraph`, `busy` | numbers as text; lines of a width; the warning of a busy machine |

pub(crate) mod bench;
pub(crate) mod busy;
pub mod chart;
pub(crate) mod chart_drawings;
pub(crate) mod chart_kernels;
pub(crate) mod chart_text;
pub(crate) mod compare;
pub(crate) mod defaults;
pub(crate) mod dots;
pub(crate) mod drawing;
pub(crate) mod figure;
pub(crate) mod inspection;
pub(crate) mod numbers;
pub mod page;
pub(crate) mod rays;
pub(crate) mod render;
pub(crate) mod scale;
pub(crate) mod stability;
pub(crate) mod stability_table;
pub(crate) mod stats;
pub(crate) mod tables;
pub(crate) mod text;
pub(crate) mod traversal;
