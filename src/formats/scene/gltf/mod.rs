//! glTF 2.0: from a file to the triangles, materials and camera of a scene.
//!
//! For: [`read`], [`Gltf`].
//!
//! | file | what it does |
//! |---|---|
//! | `bytes` | binary files, buffers, data URIs |
//! | `accessor` | numbers in buffers |
//! | `geometry` | triangles, and their way into the scene |
//! | `extensions` | which are read; notes about the others |
//! | `nodes` | the tree of nodes as placed meshes and a camera |
//! | `material`, `texture` | materials and their textures |
//!
//! Meshes are copied to every node that shows them, because the hierarchy is flat: instances share the
//! numbers read from the file while it is loaded, and their materials and textures, but no triangles. A file
//! may be hostile: no number in it is used as an index or a size before it is checked, nodes are visited
//! once, and [`MAX_COPIES`] bounds what copies add up to.
//!
//! The types come from `gltf-json`, the data types of the `gltf` crate. The rest of that crate is not used:
//! its validation and its readers index by numbers from the file.

mod accessor;
mod bytes;
mod extensions;
mod geometry;
mod material;
mod nodes;
mod texture;

use super::builder::{MAX_COPIES, SceneBuilder};
use super::check::is_near;
use super::error::SceneError;
use super::files::Files;
use super::json::Source;
use super::mesh::{Tally, Unusable};
use super::placement::Placement;
use accessor::Accessors;
use bytes::Document;
use geometry::{Geometry, Transform};
use glam::DVec4;
use gltf_json::Root;
use material::{Added, Materials};
use octray_engine::scene::{Camera, Material, MaterialKind};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::Path;
use texture::UvMap;

/// A glTF file, read. Its geometry is checked by [`Gltf::add`].
pub struct Gltf {
    root: Root,
    /// The text of the JSON part, for messages.
    text: String,
    buffers: Vec<bytes::Buffer>,
    nodes: nodes::Placed,
}

/// Reads the content of a .gltf or .glb file, and the buffers that it names.
pub fn read(content: &[u8], path: &Path, files: &Files) -> Result<Gltf, SceneError> {
    let (text, binary) = bytes::split(content, path)?;
    let source = Source { file: path, text };
    let root: Root = super::json::read(&source)?;
    let place = source.root();
    let needed = root.asset.min_version.as_ref().filter(|least| *least != "2.0");
    if let Some(version) = needed.or(Some(&root.asset.version).filter(|version| !version.starts_with("2."))) {
        let what = format!("glTF {version} is not read");
        return Err(place.key("asset").key("version").error(what, "export the model as glTF 2.0"));
    }
    let mut required = root.extensions_required.iter().enumerate();
    if let Some((index, name)) = required.find(|(_, name)| !extensions::READ.contains(&name.as_str())) {
        let is_compression = extensions::COMPRESSIONS.contains(&name.as_str());
        let why = if is_compression { ": its geometry is compressed" } else { "" };
        let what = format!("the file requires the extension `{name}`, which is not read{why}");
        let mend = "export the model without it, or, if it shows without, take it out of this list";
        return Err(place.key("extensionsRequired").item(index).error(what, mend));
    }
    let buffers = bytes::buffers(&source, &root, binary, files)?;
    let nodes = nodes::place(&place, &root)?;
    Ok(Gltf { text: text.to_string(), buffers, nodes, root })
}

impl Gltf {
    /// Adds the triangles of all placed meshes to the builder, with `material` or else with their own
    /// materials.
    pub fn add(
        &self,
        path: &Path,
        builder: &mut SceneBuilder,
        material: Option<u32>,
        placement: &Placement,
    ) -> Result<(), Unusable> {
        let source = Source { file: path, text: &self.text };
        let document = Document { source, root: &self.root, buffers: &self.buffers };
        let place = document.source.root();
        nodes::note_ignored(&place, &self.root, &mut builder.notes);
        extensions::note_ignored(&document.source, material.is_none(), &mut builder.notes);
        let mut accessors = Accessors::new(&document);
        let mut materials = Materials::new(&document);
        let mut meshes: HashMap<usize, Vec<(Added, Geometry)>> = HashMap::new();
        let mut triangles = 0;
        for &(mesh, _) in &self.nodes.meshes {
            let parts = match meshes.entry(mesh) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => {
                    let mut parts = Vec::new();
                    for (index, primitive) in self.root.meshes[mesh].primitives.iter().enumerate() {
                        let list = place.key("meshes");
                        let of_mesh = list.item(mesh);
                        let primitives = of_mesh.key("primitives");
                        let place = primitives.item(index);
                        let read = geometry::read(&mut accessors, primitive, &place, &mut builder.notes)?;
                        let Some(mut geometry) = read else { continue };
                        let own = match material {
                            Some(number) => Added { number, uv_map: UvMap::default() },
                            None => {
                                let mut own = materials.of(primitive, &place, builder)?;
                                if let Some(color) = geometry.take_only_color() {
                                    let plain = builder.scene.materials[own.number as usize].clone();
                                    let (of, light) = (plain.color * color, plain.emission * color);
                                    let tinted = match plain.kind {
                                        MaterialKind::Emitter => Material { emission: light, ..plain },
                                        _ => Material { color: of, ..plain },
                                    };
                                    own.number = builder.add_material(tinted, 1.0);
                                }
                                geometry.note_unused(own.number, &place, builder);
                                own
                            }
                        };
                        parts.push((own, geometry));
                    }
                    new.insert(parts)
                }
            };
            triangles += parts.iter().map(|(_, geometry)| geometry.triangles()).sum::<usize>();
            if triangles > MAX_COPIES {
                let what = format!("the model holds more than {MAX_COPIES} triangles, copies counted");
                let mend = "show the mesh on fewer nodes, or simplify it";
                return Err(place.key("nodes").error(what, mend).into());
            }
        }
        builder.warn_of_notes(path, ": ");
        builder.check_room(triangles).map_err(|error| error.in_file(path))?;
        let points = self.nodes.meshes.iter().flat_map(|(mesh, transform)| {
            meshes[mesh]
                .iter()
                .flat_map(|(_, part)| part.points())
                .map(|point| transform.transform_point3(point))
        });
        let placement = &builder.within_scene(placement, points);
        let mut tally = Tally::default();
        for (mesh, transform) in &self.nodes.meshes {
            let transform = Transform::of(transform, placement);
            for (own, geometry) in &meshes[mesh] {
                transform.add(geometry, *own, builder, &mut tally)?;
            }
        }
        tally.finish(path, builder)
    }

    /// The model's first camera, if it is one that octray has.
    pub fn camera(&self, path: &Path, builder: &mut SceneBuilder) -> Option<Camera> {
        let (index, transform) = self.nodes.camera?;
        let (lower, upper) = builder.scene.bounds();
        let position = builder.scene.coordinates.to_scene(transform.w_axis.truncate());
        let mut framed = |why: &str| {
            builder.warn(format!("{}: cameras[{index}] {why}: the model is framed instead.", path.display()));
        };
        let Some(perspective) = &self.root.cameras[index].perspective else {
            framed("is orthographic");
            return None;
        };
        let [forward, up] = [DVec4::NEG_Z, DVec4::Y].map(|axis| (transform * axis).truncate());
        // A point as far away as the model, so that a viewer turns around something.
        let distance = (((lower + upper) / 2.0 - position).length()).max(1e-3 * position.length()).max(1e-6);
        let camera = Camera {
            position: position.as_vec3(),
            look_at: (position + forward.normalize_or_zero() * distance).as_vec3(),
            up: up.normalize_or_zero().as_vec3(),
            vertical_fov: perspective.yfov.to_degrees(),
        };
        let mut points = [camera.position, camera.look_at].into_iter();
        let is_usable = camera.fault().is_none() && points.all(|point| is_near(point.into()));
        if !is_usable {
            framed("cannot be used");
        }
        is_usable.then_some(camera)
    }
}
