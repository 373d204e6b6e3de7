//! Queries about meshes: exact answers beside integers of any size, and the interface.

mod cases;
mod exact;
mod images;
mod interface;
mod rational;
