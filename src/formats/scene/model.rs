//! Models of any format: OBJ, glTF and PLY.
//!
//! For: [`is_model`], [`read`], [`scene`].

use super::builder::{DEFAULT_BOUNCES, DEFAULT_RESOLUTION, SceneBuilder};
use super::error::SceneError;
use super::files::{Files, has_extension};
use super::placement::Placement;
use super::tally::Misplaced;
use super::{gltf, obj, ply};
use glam::Vec3;
use octray_engine::scene::{Scene, Sky};
use std::path::Path;

/// The extensions of the formats that are read.
pub const EXTENSIONS: [&str; 4] = ["obj", "gltf", "glb", "ply"];

/// Whether a file's extension is that of a model.
pub fn is_model(path: &Path) -> bool {
    extension(path).is_some()
}

fn extension(path: &Path) -> Option<&'static str> {
    EXTENSIONS.into_iter().find(|known| has_extension(path, known))
}

/// A model, read and checked.
pub enum Model {
    Obj(obj::Mesh),
    Gltf(Box<gltf::Gltf>),
    Ply(ply::Mesh),
}

/// Reads the content of a model file; a file of another extension is read as OBJ.
pub fn read(bytes: &[u8], path: &Path, files: &Files) -> Result<Model, SceneError> {
    match extension(path) {
        Some("gltf" | "glb") => gltf::read(bytes, path, files).map(Box::new).map(Model::Gltf),
        Some("ply") => ply::parse(bytes, path).map(Model::Ply),
        _ => obj::parse(bytes, path).map(Model::Obj),
    }
}

impl Model {
    /// Adds the model's triangles to the builder, with `material` or else with its own materials. Returns
    /// `Some` if the placement makes the model unusable.
    pub fn add(
        &self,
        path: &Path,
        files: &Files,
        builder: &mut SceneBuilder,
        material: Option<u32>,
        placement: &Placement,
    ) -> Result<Option<Misplaced>, SceneError> {
        match self {
            Self::Obj(mesh) => obj::add(mesh, path, files, builder, material, placement),
            Self::Gltf(gltf) => gltf.add(path, files, builder, material, placement),
            Self::Ply(mesh) => ply::add(mesh, path, builder, material, placement),
        }
    }
}

/// The sky over a model that is loaded as a scene: white above and nearly black below, so that surfaces
/// facing up, sideways and down differ. Under a sky of one colour a diffuse shape shows only its creases.
const SKY: Sky = Sky::Gradient { bottom: Vec3::splat(0.05), top: Vec3::ONE };

/// A model as a scene, under a plain sky: seen by its own camera, or framed automatically.
pub fn scene(bytes: &[u8], path: &Path, files: &Files, name: String) -> Result<Scene, SceneError> {
    let mut builder = SceneBuilder::default();
    let model = read(bytes, path, files)?;
    match model.add(path, files, &mut builder, None, &Placement::IDENTITY)? {
        None => {}
        Some(Misplaced::NoArea) => {
            let mend = "export the model again, or larger: all its faces have zero area in single precision";
            return Err(SceneError::new("the mesh has nothing to see").in_file(path).mend(mend));
        }
        Some(Misplaced::TooFar(point)) => {
            let what = format!("the mesh reaches {point}, too far from the origin");
            return Err(SceneError::new(what).in_file(path).mend("scale the model down, or move it"));
        }
    }
    let own = match &model {
        Model::Gltf(gltf) => gltf.camera(path, &mut builder),
        Model::Obj(_) | Model::Ply(_) => None,
    };
    let camera = own.unwrap_or_else(|| builder.framing(None, None));
    if let Some((_, what, _)) = camera.fault() {
        let mend = "scale the model up, or move it nearer to the origin";
        return Err(SceneError::new(format!("the mesh cannot be framed: {what}")).in_file(path).mend(mend));
    }
    builder
        .finish(name, camera, DEFAULT_RESOLUTION, DEFAULT_BOUNCES, SKY)
        .map_err(|error| error.in_file(path))
}
