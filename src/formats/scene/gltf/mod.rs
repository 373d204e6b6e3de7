//! Reads the triangles, materials and camera of a scene from a glTF 2.0 file.
//!
//! Meshes are copied to every node that shows them, because the hierarchy is flat. Instances share the
//! numbers read from the file, materials and textures, but no triangles. A file may be hostile: no number in
//! it is used as an index or a size before it is checked, nodes are visited once, and [`MAX_COPIES`] bounds
//! the number of copied triangles.
//!
//! Entries of lists that do not follow the standard are faults only if they are used.

mod accessor;
mod bytes;
mod extensions;
mod geometry;
mod light;
mod material;
mod nodes;
mod ranges;
mod schema;
mod texture;

use super::builder::{MAX_COPIES, SceneBuilder};
use super::check::is_near;
use super::error::SceneError;
use super::files::Files;
use super::json::Source;
use super::mesh::{self, Unusable};
use super::notes::Notes;
use super::placement::Placement;
use super::portal::portal;
use accessor::Accessors;
use bytes::Document;
use geometry::{Geometry, Transform};
use glam::DVec4;
use material::{Added, Materials};
use octray_engine::scene::{Camera, MaterialKind, Projection, VERTICAL_FOV};
use schema::{Orthographic, Perspective, Root};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::f64::consts::PI;
use std::path::Path;

/// A glTF file whose geometry [`Gltf::add`] checks.
pub struct Gltf {
    root: Root,
    /// The text of the JSON part, for messages.
    text: String,
    buffers: Vec<Result<bytes::Content, String>>,
    nodes: nodes::Placed,
}

/// Reads the content of a .gltf or .glb file, and the buffers that it names.
pub fn read(content: &[u8], path: &Path, files: &Files) -> Result<Gltf, SceneError> {
    let (text, binary) = bytes::split(content, path)?;
    let source = Source { file: path, text };
    let root: Root = super::json::read(&source)?;
    let place = source.root();
    let version = root.asset.version.as_deref().unwrap_or("without a version");
    let needed = root.asset.min_version.as_deref().filter(|least| *least != "2.0");
    if let Some(version) = needed.or(Some(version).filter(|version| !version.starts_with('2'))) {
        let mend = "export the model as glTF 2.0, which has \"asset\": { \"version\": \"2.0\" }";
        return Err(place.key("asset").key("version").error(format!("glTF {version} is not read"), mend));
    }
    let mut required = root.extensions_required.iter().enumerate();
    if let Some((index, name)) = required.find(|(_, name)| !extensions::READ.contains(&name.as_str())) {
        let is_compression = extensions::COMPRESSIONS.contains(&name.as_str());
        let why = if is_compression { ": its geometry is compressed" } else { "" };
        let what = format!("the file requires the extension `{name}`, which is not read{why}");
        let mend = "export the model without it, or remove it from this list if the model does not need it";
        return Err(place.key("extensionsRequired").item(index).error(what, mend));
    }
    let buffers = bytes::buffers(&root, binary, path, files);
    let mut gltf = Gltf { text: text.to_string(), buffers, nodes: nodes::Placed::default(), root };
    gltf.nodes = nodes::place(&gltf.document(path))?;
    Ok(gltf)
}

impl Gltf {
    fn document<'a>(&'a self, path: &'a Path) -> Document<'a> {
        let source = Source { file: path, text: &self.text };
        Document { source, root: &self.root, buffers: &self.buffers }
    }

    /// Adds the triangles of all placed meshes to the builder, with `material` or else with their own
    /// materials.
    pub fn add(
        &self,
        path: &Path,
        builder: &mut SceneBuilder,
        material: Option<u32>,
        placement: &Placement,
    ) -> Result<(), Unusable> {
        let document = self.document(path);
        let place = document.source.root();
        let first_material = builder.scene.materials.len();
        nodes::note_ignored(&document, &self.nodes, &mut builder.notes);
        extensions::note_ignored(&document.source, material.is_none(), &mut builder.notes);
        let mut accessors = Accessors::new(&document);
        let mut materials = Materials::new(&document);
        let mut meshes: HashMap<usize, Vec<(Added, Geometry)>> = HashMap::new();
        let mut triangles = 0;
        for &(mesh, _) in &self.nodes.meshes {
            if let Entry::Vacant(new) = meshes.entry(mesh) {
                new.insert(self.parts(mesh, material, &mut accessors, &mut materials, builder)?);
            }
            triangles += meshes[&mesh].iter().map(|(_, geometry)| geometry.triangles()).sum::<usize>();
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
        let scale = placement.scale as f32;
        let placement = &builder.within_scene(placement, points);
        self.add_portals(path, &mut accessors, placement, builder)?;
        let first = builder.scene.triangles.len();
        for material in &mut builder.scene.materials[first_material..] {
            material.extras.attenuation.iter_mut().for_each(|it| it.distance *= scale);
        }
        for (mesh, transform) in &self.nodes.meshes {
            let transform = Transform::new(transform, placement);
            for (own, geometry) in &meshes[mesh] {
                transform.add(geometry, *own, builder)?;
            }
        }
        mesh::finish(path, builder, first, triangles)
    }

    /// Adds the portals to the builder. Those of other shapes are left out with a warning.
    fn add_portals(
        &self,
        path: &Path,
        accessors: &mut Accessors,
        placement: &Placement,
        builder: &mut SceneBuilder,
    ) -> Result<(), SceneError> {
        let root = accessors.document.source.root();
        for &(node, mesh, ref transform) in &self.nodes.portals {
            let file = mesh
                .map(|mesh| accessors.document.get(&self.root.meshes, "meshes", mesh, &root))
                .transpose()?;
            let quad = match file.map_or(&[][..], |file| &file.primitives) {
                [only] => geometry::read(accessors, only, None, &root.key("meshes"), &mut Notes::default())?
                    .and_then(|geometry| geometry.quad(transform)),
                _ => None,
            };
            let placed = quad.map(|quad| quad.map(|point| placement.point(point)));
            let near = placed.filter(|points| points.iter().all(|point| is_near(*point)));
            match near.map(|points| portal(points, &builder.scene.coordinates)) {
                Some(Ok(portal)) => builder.scene.portals.push(portal),
                Some(Err(_)) | None => builder.warn(format!(
                    "{}: nodes[{node}]: a portal is left out: its mesh must be a parallelogram of two triangles.",
                    path.display()
                )),
            }
        }
        Ok(())
    }

    /// Reads the primitives of a mesh, each with `material` or else with its own one.
    fn parts(
        &self,
        mesh: usize,
        material: Option<u32>,
        accessors: &mut Accessors,
        materials: &mut Materials,
        builder: &mut SceneBuilder,
    ) -> Result<Vec<(Added, Geometry)>, SceneError> {
        let document = accessors.document;
        let root = document.source.root();
        let (meshes, mut parts) = (root.key("meshes"), Vec::new());
        let (place, file) = (meshes.item(mesh), document.get(&self.root.meshes, "meshes", mesh, &root)?);
        for (index, primitive) in file.primitives.iter().enumerate() {
            let primitives = place.key("primitives");
            let place = primitives.item(index);
            let set = material::uv_set(primitive, &self.root).or(material.map(|_| 0));
            let read = geometry::read(accessors, primitive, set, &place, &mut builder.notes)?;
            let Some(mut geometry) = read else { continue };
            if let Some(number) = material {
                parts.push((Added { number, uv_map: Default::default() }, geometry));
                continue;
            }
            let mut own = materials.get(primitive, &place, builder)?;
            let file = primitive.material.and_then(|index| self.root.materials.get(index.0));
            if file.is_some_and(|file| file.has_alpha()) && geometry.has_alpha() {
                builder.notes.add(&place, "the alpha of vertex colours is left out");
            }
            if let Some(tint) = geometry.take_uniform_color() {
                let mut tinted = builder.scene.materials[own.number as usize].clone();
                match tinted.kind {
                    MaterialKind::Emitter => tinted.emission *= tint,
                    _ => tinted.color *= tint,
                }
                own.number = builder.add_material(tinted, 1.0);
            }
            geometry.note_unused(own.number, &place, builder);
            parts.push((own, geometry));
        }
        Ok(parts)
    }

    /// Returns the model's first camera, if it is one that octray has, and the aspect ratio that it names.
    pub fn camera(
        &self,
        path: &Path,
        builder: &mut SceneBuilder,
        placement: &Placement,
    ) -> Result<Option<(Camera, Option<f64>)>, SceneError> {
        let Some((index, transform)) = self.nodes.camera else { return Ok(None) };
        let document = self.document(path);
        let user = document.source.root();
        let camera = document.get(&self.root.cameras, "cameras", index, &user.key("nodes"))?;
        let (lower, upper) = builder.scene.bounds();
        let coordinates = builder.scene.coordinates;
        let position = coordinates.to_scene(placement.point(transform.w_axis.truncate()));
        let framed = |builder: &mut SceneBuilder, why: &str| {
            builder.warn(format!("{}: cameras[{index}] {why}: the model is framed instead.", path.display()));
            Ok(None)
        };
        let (vertical_fov, projection, named) = match (&camera.perspective, &camera.orthographic) {
            (Some(Perspective { yfov, .. }), _) if !(0.0..PI).contains(yfov) || *yfov == 0.0 => {
                return framed(builder, &format!("has a `yfov` of {yfov}, not above 0 and below π"));
            }
            (Some(Perspective { yfov, aspect_ratio }), _) => {
                (yfov.to_degrees() as f32, Projection::default(), *aspect_ratio)
            }
            (None, Some(Orthographic { xmag, ymag })) if xmag * ymag == 0.0 => {
                let why = format!("has an `xmag` of {xmag} and a `ymag` of {ymag}, not above 0");
                return framed(builder, &why);
            }
            // The sign of a magnification mirrors the picture, which nobody wants.
            (None, Some(Orthographic { xmag, ymag })) => {
                if xmag.min(*ymag) < 0.0 {
                    let what = format!("`xmag` {xmag} and `ymag` {ymag} are used without their signs");
                    builder.warn(format!("{}: cameras[{index}]: {what}.", path.display()));
                }
                let height = (2.0 * ymag.abs() * placement.scale / coordinates.unit) as f32;
                (VERTICAL_FOV, Projection::Orthographic { height }, Some((xmag / ymag).abs()))
            }
            (None, None) => return framed(builder, "is neither perspective nor orthographic"),
        };
        let rotated = |axis: DVec4| placement.rotation * (transform * axis).truncate();
        let [forward, up] = [DVec4::NEG_Z, DVec4::Y].map(rotated);
        // The point is as far away as the model, which sets the viewer's distances.
        let distance = (((lower + upper) / 2.0 - position).length()).max(1e-3 * position.length()).max(1e-6);
        let camera = Camera {
            position: position.as_vec3(),
            look_at: (position + forward.normalize_or_zero() * distance).as_vec3(),
            up: up.normalize_or_zero().as_vec3(),
            vertical_fov,
            projection,
        };
        let mut points = [camera.position, camera.look_at].into_iter();
        if camera.fault().is_some() || !points.all(|point| is_near(point.into())) {
            return framed(builder, "cannot be used");
        }
        let aspect = named.filter(|aspect| (1.0 / 64.0..=64.0).contains(aspect));
        if let Some(other) = named.xor(aspect) {
            let what = format!("the aspect ratio {other} is not within 1/64 and 64, and left out");
            builder.warn(format!("{}: cameras[{index}]: {what}.", path.display()));
        }
        Ok(Some((camera, aspect)))
    }
}
