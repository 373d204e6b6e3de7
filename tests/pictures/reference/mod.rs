//! The judge is judged by closed forms and by integrals that it does not compute itself.

#[path = "../common/mod.rs"]
mod common;

mod closest;
mod paths;
mod scenes;
mod textures;
mod verdicts;
