//! PLY: from a file of ASCII or either binary order to a mesh, and from a mesh to the triangles of a
//! [`SceneBuilder`].
//!
//! For: [`parse`], [`add`].
//!
//! Reads the elements `vertex` (x, y, z; nx, ny, nz; red, green, blue; s, t or u, v) and `face` (a list
//! `vertex_indices` or `vertex_index`, of any length); others are skipped. Whole numbers as colours are
//! display values (sRGB) over the largest of their type, real ones linear.
//!
//! No library is used: one (`ply-rs-bw`) needs a parser generator and makes a map of each element, the other
//! (`serde-ply`) is at version 0.2. Here every count is checked against the bytes that are there, faults have
//! their line and byte, and the type of a colour says whether it is a display value.
//!
//! Source: G. Turk, "The PLY Polygon File Format", 1994.

mod reader;

use super::builder::SceneBuilder;
use super::check::{WITHIN_BOUNDS, fits};
use super::error::SceneError;
use super::placement::Placement;
use super::tally::{Misplaced, Tally};
use glam::{DVec3, Vec2, Vec3};
use octray_engine::scene::{Material, MaterialKind, srgb_to_linear};
use reader::{Element, Encoding, Property, Reader};
use std::path::Path;

/// The content of a PLY file, indices checked.
#[derive(Default)]
pub struct Mesh {
    positions: Vec<DVec3>,
    /// Of unit length; empty if the file has none.
    normals: Vec<Vec3>,
    /// Linear, in [0, 1]; empty if the file has none.
    colors: Vec<Vec3>,
    /// v upwards; empty if the file has none.
    uvs: Vec<Vec2>,
    /// The vertices of all faces, one face after the other.
    corners: Vec<u32>,
    /// Where each face ends in `corners`.
    ends: Vec<usize>,
}

/// Reads the content of a PLY file.
pub fn parse(bytes: &[u8], path: &Path) -> Result<Mesh, SceneError> {
    let mut reader = Reader::new(path, bytes);
    let (encoding, elements) = reader.header()?;
    let mut mesh = Mesh::default();
    let elements = || elements.iter().filter(|element| !element.properties.is_empty());
    let vertices = elements().filter(|element| element.name == "vertex");
    let vertices = vertices.fold(0, |sum: usize, element| sum.saturating_add(element.count));
    for element in elements() {
        reader.check_count(element, encoding)?;
        match element.name.as_str() {
            "vertex" => mesh.read_vertices(&mut reader, element, encoding)?,
            "face" => mesh.read_faces(&mut reader, element, encoding, vertices)?,
            _ => skip(&mut reader, element, encoding)?,
        }
    }
    if mesh.ends.is_empty() {
        let mend = "export the model with faces: points alone have no surface";
        return Err(SceneError::new("the mesh has no faces").in_file(path).mend(mend));
    }
    Ok(mesh)
}

fn skip(reader: &mut Reader, element: &Element, encoding: Encoding) -> Result<(), SceneError> {
    for _ in 0..element.count {
        for property in &element.properties {
            let count = match property.list {
                Some(length) => reader.number(length, encoding)? as u64,
                None => 1,
            };
            for _ in 0..count {
                reader.number(property.scalar, encoding)?;
            }
        }
    }
    Ok(())
}

impl Mesh {
    /// The number of its triangles, those without area included.
    fn triangles(&self) -> usize {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, end)| (end - start).saturating_sub(2)).sum()
    }
    fn read_vertices(
        &mut self,
        reader: &mut Reader,
        element: &Element,
        encoding: Encoding,
    ) -> Result<(), SceneError> {
        if !self.positions.is_empty() {
            return Err(reader.fault("a second list of vertices", "export the model again"));
        }
        if element.properties.iter().any(|property| property.list.is_some()) {
            return Err(reader.fault("vertices with lists are not read", "export the model without them"));
        }
        let find = |names: &[&str]| {
            element.properties.iter().position(|property| names.contains(&property.name.as_str()))
        };
        let all = |names: &[&[&str]]| names.iter().map(|names| find(names)).collect::<Option<Vec<usize>>>();
        let Some(position) = all(&[&["x"], &["y"], &["z"]]) else {
            return Err(reader.fault("vertices without x, y and z", "export the model again"));
        };
        let normal = all(&[&["nx"], &["ny"], &["nz"]]);
        let color = all(&[
            &["red", "r", "diffuse_red"],
            &["green", "g", "diffuse_green"],
            &["blue", "b", "diffuse_blue"],
        ]);
        let uv = all(&[&["s", "u", "texture_u"], &["t", "v", "texture_v"]]);
        let mut values = vec![0.0; element.properties.len()];
        for _ in 0..element.count {
            for (value, property) in values.iter_mut().zip(&element.properties) {
                *value = reader.number(property.scalar, encoding)?;
                if !fits(*value) {
                    return Err(
                        reader.fault(format!("{value} is not a number that a scene can hold"), WITHIN_BOUNDS)
                    );
                }
            }
            self.positions.push(DVec3::new(values[position[0]], values[position[1]], values[position[2]]));
            if let Some(at) = &normal {
                let normal = DVec3::new(values[at[0]], values[at[1]], values[at[2]]);
                self.normals.push(normal.normalize_or_zero().as_vec3());
            }
            if let Some(at) = &color {
                let channel = |at: usize| {
                    let white = element.properties[at].scalar.white();
                    let x = (values[at] / white).clamp(0.0, 1.0);
                    if white > 1.0 { srgb_to_linear(x) as f32 } else { x as f32 }
                };
                self.colors.push(Vec3::new(channel(at[0]), channel(at[1]), channel(at[2])));
            }
            if let Some(at) = &uv {
                self.uvs.push(Vec2::new(values[at[0]] as f32, values[at[1]] as f32));
            }
        }
        Ok(())
    }

    /// Of a file with this number of vertices, which may come after the faces.
    fn read_faces(
        &mut self,
        reader: &mut Reader,
        element: &Element,
        encoding: Encoding,
        vertices: usize,
    ) -> Result<(), SceneError> {
        let is_corners = |property: &Property| {
            property.list.is_some() && ["vertex_indices", "vertex_index"].contains(&property.name.as_str())
        };
        for _ in 0..element.count {
            for property in &element.properties {
                let count = match property.list {
                    Some(length) => reader.number(length, encoding)?,
                    None => 1.0,
                };
                // Each is read, so that a length beyond the file's end fails there.
                for _ in 0..count as u64 {
                    let value = reader.number(property.scalar, encoding)?;
                    if is_corners(property) {
                        let mend = "vertices count from 0";
                        if !(value >= 0.0 && value < f64::from(u32::MAX) && value.fract() == 0.0) {
                            return Err(reader.fault(format!("{value} is not a vertex"), mend));
                        }
                        if value >= vertices as f64 {
                            let face = self.ends.len();
                            let what =
                                format!("face {face} uses vertex {value}, and the file has {vertices}");
                            return Err(reader.fault(what, mend));
                        }
                        self.corners.push(value as u32);
                    }
                }
                if is_corners(property) {
                    self.ends.push(self.corners.len());
                }
            }
        }
        Ok(())
    }
}

/// Adds a mesh's triangles to the builder, with `material` or else a diffuse one of the mesh's colours.
/// Polygons become fans around their first corner. Returns `Some` if the placement makes the mesh unusable.
pub fn add(
    mesh: &Mesh,
    path: &Path,
    builder: &mut SceneBuilder,
    material: Option<u32>,
    placement: &Placement,
) -> Result<Option<Misplaced>, SceneError> {
    builder.check_room(mesh.triangles()).map_err(|error| error.in_file(path))?;
    let colored = (material.is_none() && !mesh.colors.is_empty()).then(|| {
        let white = Material::new("vertex colours", MaterialKind::Diffuse, Vec3::ONE);
        let white = builder.add_material(white, 1.0);
        builder.colored(white).expect("the material has no texture")
    });
    let material = colored.or(material).unwrap_or_else(|| builder.default_material());
    let positions: Vec<DVec3> = mesh.positions.iter().map(|&p| placement.point(p)).collect();
    if let Some(&outside) = positions.iter().find(|p| !p.to_array().into_iter().all(fits)) {
        return Ok(Some(Misplaced::TooFar(outside)));
    }
    let rotated = |normal: &Vec3| (placement.rotation * normal.as_dvec3()).as_vec3();
    let normals: Vec<Vec3> = mesh.normals.iter().map(rotated).collect();
    let mut tally = Tally::default();
    let mut start = 0;
    for &end in &mesh.ends {
        let corners = &mesh.corners[start..end];
        start = end;
        for i in 1..corners.len().saturating_sub(1) {
            let fan = [corners[0], corners[i], corners[i + 1]].map(|corner| corner as usize);
            let vertices = fan.map(|corner| positions[corner].as_vec3());
            let normals = (!normals.is_empty())
                .then(|| fan.map(|corner| normals[corner]))
                .filter(|normals| normals.iter().all(|&normal| normal != Vec3::ZERO));
            tally.count(match colored {
                Some(material) => builder.add_colored_triangle(
                    vertices,
                    material,
                    fan.map(|corner| mesh.colors[corner]),
                    normals,
                ),
                None => {
                    let uvs = (!mesh.uvs.is_empty()).then(|| fan.map(|corner| mesh.uvs[corner]));
                    builder.add_triangle(vertices, material, uvs, normals)
                }
            });
        }
    }
    Ok(tally.finish(path, builder))
}
