//! Figures as people read them: drawn, tabled, on a page.
//!
//! For: [`plot`] (lines in a plane, as SVG), [`stability`] (its figures). May import: `measure` and everything above it. Must never know: command lines, files,
//! terminals.

pub mod plot;
pub mod stability;
