//! Figures as people read them: drawn, tabled, on a page.
//!
//! For: [`plot`] (lines in a plane, as SVG); [`stability`] (its figures); of a chart: [`chart`] (its drawings), [`tables`] (CSV) and [`page`] (HTML). May import: `measure` and
//! everything above it. Must never know: command lines, files, terminals.

pub mod axis;
pub mod chart;
pub mod page;
pub mod plot;
pub mod stability;
pub mod tables;
