//! The judge is judged by closed forms and by integrals that it does not compute itself.

mod closest;
mod paths;
mod scenes;
mod textures;
mod verdicts;
