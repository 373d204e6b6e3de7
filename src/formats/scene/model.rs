//! Reads models of any format, and makes a scene of one.

use super::builder::{DEFAULT_RESOLUTION, SceneBuilder};
use super::error::SceneError;
use super::files::{Files, has_extension};
use super::gltf::{self, Gltf};
use super::mesh::{Mesh, Unusable};
use super::obj::Obj;
use super::placement::Placement;
use super::ply;
use glam::Vec3;
use octray_engine::scene::{Scene, Sky};
use std::path::Path;

/// The extensions of the formats that are read.
pub const EXTENSIONS: [&str; 4] = ["obj", "gltf", "glb", "ply"];

/// Tests whether a file's extension is that of a model.
pub fn is_model(path: &Path) -> bool {
    EXTENSIONS.iter().any(|known| has_extension(path, known))
}

/// A model, read and checked.
pub enum Model {
    Obj(Obj),
    Gltf(Box<Gltf>),
    Ply(Mesh),
}

/// Reads the content of a model file; a file of another extension is read as OBJ.
pub fn read(bytes: &[u8], path: &Path, files: &Files) -> Result<Model, SceneError> {
    if has_extension(path, "gltf") || has_extension(path, "glb") {
        gltf::read(bytes, path, files).map(Box::new).map(Model::Gltf)
    } else if has_extension(path, "ply") {
        ply::parse(bytes, path).map(Model::Ply)
    } else {
        Obj::parse(bytes, path).map(Model::Obj)
    }
}

impl Model {
    /// Adds the model's triangles to the builder, with `material` or else with its own materials.
    pub fn add(
        &self,
        path: &Path,
        builder: &mut SceneBuilder,
        material: Option<u32>,
        placement: &Placement,
    ) -> Result<(), Unusable> {
        let (mesh, own) = match self {
            Self::Gltf(gltf) => {
                // The standard of glTF demands this.
                builder.textures.ignores_profiles = true;
                let added = gltf.add(path, builder, material, placement);
                builder.textures.ignores_profiles = false;
                return added;
            }
            Self::Obj(obj) if material.is_none() => (&obj.mesh, obj.add_materials(path, builder)),
            Self::Ply(mesh) if material.is_none() => (mesh, mesh.add_materials(path, builder)),
            Self::Obj(Obj { mesh, .. }) | Self::Ply(mesh) => (mesh, Vec::new()),
        };
        mesh.add(path, builder, material, &own, placement)
    }
}

/// The sky over a model that is loaded as a scene. Surfaces facing up, sideways and down differ under it;
/// under a sky of one colour, a diffuse shape would show only its creases.
const SKY: Sky = Sky::Gradient { bottom: Vec3::splat(0.05), top: Vec3::ONE };

/// Most scattering events on a path in a model that is loaded as a scene. Light can pass both sides of two
/// panes and come back.
const BOUNCES: u32 = 8;

/// Makes a scene of a model under a plain sky, seen by the model's camera, or framed automatically.
pub fn scene(bytes: &[u8], path: &Path, files: &Files, name: String) -> Result<Scene, SceneError> {
    let fault = |what: String, mend: &str| SceneError::new(what).in_file(path).mend(mend);
    let mut builder = SceneBuilder::new(files);
    let model = read(bytes, path, files)?;
    model.add(path, &mut builder, None, &Placement::IDENTITY).map_err(|unusable| match unusable {
        Unusable::Broken(error) => error,
        Unusable::NoArea => fault(
            "the mesh has nothing to see".to_string(),
            "export the model again, or larger: all its faces have zero area in single precision",
        ),
        Unusable::TooFar(point) => fault(
            format!("the mesh reaches {point}, too far from its other points"),
            "move this point nearer to them, or leave it out",
        ),
    })?;
    let own = match &model {
        Model::Gltf(gltf) => {
            gltf.add_lights(path, &mut builder, &Placement::IDENTITY, None)?;
            gltf.camera(path, &mut builder, &Placement::IDENTITY)?
        }
        Model::Obj(_) | Model::Ply(_) => None,
    };
    let (camera, aspect) = own.unwrap_or_else(|| (builder.scene.framing(None, None), None));
    if let Some((_, what, _)) = camera.fault() {
        let mend = "scale the model up, or move it nearer to the origin";
        return Err(fault(format!("the mesh cannot be framed: {what}"), mend));
    }
    let resolution = aspect.map_or(DEFAULT_RESOLUTION, resolution);
    builder.finish(name, camera, resolution, BOUNCES, SKY).map_err(|error| error.in_file(path))
}

/// Returns a resolution of this aspect ratio, width over height, with about as many pixels as the default.
pub fn resolution(aspect: f64) -> [u32; 2] {
    let [width, height] = DEFAULT_RESOLUTION.map(f64::from);
    let width = (width * height * aspect).sqrt();
    [width, width / aspect].map(|side| side.round() as u32)
}
