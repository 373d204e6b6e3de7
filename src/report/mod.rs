//! Reports: the figures of the commands as text, JSON, CSV, SVG and HTML.

pub(crate) mod baseline;
pub(crate) mod bench;
pub(crate) mod camera;
pub(crate) mod chart;
pub(crate) mod chart_drawings;
pub(crate) mod chart_kernels;
pub(crate) mod compare;
pub(crate) mod dots;
pub(crate) mod drawing;
pub(crate) mod figure;
pub(crate) mod inspection;
pub(crate) mod methods;
pub(crate) mod numbers;
pub(crate) mod page;
pub(crate) mod path;
pub(crate) mod punctual;
pub(crate) mod rays;
pub(crate) mod render;
pub(crate) mod scale;
pub(crate) mod settings;
pub(crate) mod stability;
pub(crate) mod stats;
pub(crate) mod tables;
pub(crate) mod text;
