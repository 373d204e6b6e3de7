//! PLY: from a file of ASCII or either binary order to a mesh.
//!
//! For: [`parse`].
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

use super::check::{WITHIN_BOUNDS, fits};
use super::error::SceneError;
use super::mesh::{Corner, Face, Mesh};
use super::scalar::{Kind, Scalar};
use glam::{DVec3, Vec2, Vec3};
use octray_engine::scene::srgb_to_linear;
use reader::{Element, Property, Reader};
use std::path::Path;

/// Reads the content of a PLY file.
pub fn parse(bytes: &[u8], path: &Path) -> Result<Mesh, SceneError> {
    let mut reader = Reader::new(path, bytes);
    let elements = reader.header()?;
    let mut mesh = Mesh::default();
    let elements = || elements.iter().filter(|element| !element.properties.is_empty());
    let vertices = elements().filter(|element| element.name == "vertex");
    let vertices = vertices.fold(0, |sum: usize, element| sum.saturating_add(element.count));
    for element in elements() {
        reader.check_count(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(&mut mesh, &mut reader, element)?,
            _ => read_faces(&mut mesh, &mut reader, element, vertices)?,
        }
    }
    if mesh.faces.is_empty() {
        let mend = "export the model with faces: points alone have no surface";
        return Err(SceneError::new("the mesh has no faces").in_file(path).mend(mend));
    }
    Ok(mesh)
}

fn read_vertices(mesh: &mut Mesh, reader: &mut Reader, element: &Element) -> Result<(), SceneError> {
    if !mesh.positions.is_empty() {
        return Err(reader.fault("a second list of vertices", "export the model again"));
    }
    if element.properties.iter().any(|property| property.list.is_some()) {
        return Err(reader.fault("vertices with lists are not read", "export the model without them"));
    }
    let find = |names: &&[&str]| {
        element.properties.iter().position(|property| names.contains(&property.name.as_str()))
    };
    let all = |names: &[&[&str]]| names.iter().map(find).collect::<Option<Vec<usize>>>();
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
            *value = reader.number(property.scalar)?;
            if !fits(*value) {
                let what = format!("{value} is not a number that a scene can hold");
                return Err(reader.fault(what, WITHIN_BOUNDS));
            }
        }
        let three = |at: &[usize]| DVec3::new(values[at[0]], values[at[1]], values[at[2]]);
        mesh.positions.push(three(&position));
        mesh.normals.extend(normal.as_deref().map(|at| three(at).normalize_or_zero().as_vec3()));
        mesh.colors.extend(color.as_ref().map(|at| {
            let channel = |at: usize| channel(&element.properties[at], values[at]);
            Vec3::new(channel(at[0]), channel(at[1]), channel(at[2]))
        }));
        mesh.uvs.extend(uv.as_ref().map(|at| Vec2::new(values[at[0]] as f32, values[at[1]] as f32)));
    }
    Ok(())
}

/// A channel of a colour, linear and in [0, 1].
fn channel(property: &Property, value: f64) -> f32 {
    let scalar = property.scalar;
    if scalar.kind == Kind::Real {
        return value.clamp(0.0, 1.0) as f32;
    }
    let white = Scalar { kind: Kind::Unsigned, ..scalar }.largest();
    srgb_to_linear((value / white).clamp(0.0, 1.0)) as f32
}

/// Reads the faces of a file with this number of vertices, which may come after them; skips other elements.
fn read_faces(
    mesh: &mut Mesh,
    reader: &mut Reader,
    element: &Element,
    vertices: usize,
) -> Result<(), SceneError> {
    const MEND: &str = "vertices count from 0";
    let is_corners = |property: &Property| {
        let is_list = element.name == "face" && property.list.is_some();
        is_list && ["vertex_indices", "vertex_index"].contains(&property.name.as_str())
    };
    let are_corners: Vec<bool> = element.properties.iter().map(is_corners).collect();
    for _ in 0..element.count {
        for (property, &is_corners) in element.properties.iter().zip(&are_corners) {
            // Each number is read, so that a length beyond the file's end fails there.
            for _ in 0..reader.count(property)? {
                let value = reader.number(property.scalar)?;
                if !is_corners {
                    continue;
                }
                if !(value >= 0.0 && value < f64::from(u32::MAX) && value.fract() == 0.0) {
                    return Err(reader.fault(format!("{value} is not a vertex"), MEND));
                }
                if value >= vertices as f64 {
                    let face = mesh.faces.len();
                    let what = format!("face {face} uses vertex {value}, and the file has {vertices}");
                    return Err(reader.fault(what, MEND));
                }
                let index = value as u32;
                mesh.corners.push(Corner { position: index, uv: index, normal: index });
            }
            if is_corners {
                mesh.faces.push(Face { end: mesh.corners.len(), material: 0 });
            }
        }
    }
    Ok(())
}
