//! Files: scenes of every format as they are read, what is refused and how, and picture files as they are
//! written.

#[path = "../common/folder.rs"]
mod folder;
#[path = "../common/openexr.rs"]
mod openexr;

mod coordinates;
mod errors;
mod files;
mod fingerprint;
mod gltf;
mod hostile;
mod images;
mod lights;
mod maps;
mod obj;
mod output;
mod ply;
mod replay;
mod thesis;
mod views;
