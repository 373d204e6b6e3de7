//! Wavefront OBJ: from text to a mesh and the names of its materials.
//!
//! For: [`Obj`].
//!
//! No library is used, so that every error has its line, no file can cause a panic, and a corner without
//! texture coordinates never gets another corner's.

use super::builder::SceneBuilder;
use super::error::SceneError;
use super::mesh::{Corner, Face, Mesh, NONE};
use super::mtl;
use super::statements::{Statement, statements};
use glam::{DVec3, Vec2};
use std::collections::HashMap;
use std::path::Path;

/// The content of an OBJ file.
#[derive(Default)]
pub struct Obj {
    pub mesh: Mesh,
    /// The names given to `mtllib`, in order.
    libraries: Vec<String>,
    /// The names given to `usemtl`, each once.
    materials: Vec<String>,
}

impl Obj {
    /// Reads an OBJ text: `v`, `vt`, `vn`, `f`, `mtllib` and `usemtl`; other statements are ignored. Comments
    /// and names may hold bytes that are not UTF-8.
    pub fn parse(text: &[u8], path: &Path) -> Result<Self, SceneError> {
        let mut obj = Self::default();
        // The material in use, and the index of each name.
        let (mut material, mut materials) = (NONE, HashMap::new());
        let mut lines = Vec::new();
        for statement in statements(text, path) {
            let mesh = &mut obj.mesh;
            match statement.keyword() {
                b"v" => mesh.positions.push(DVec3::from(statement.numbers("a vertex")?)),
                b"vt" => {
                    let [u] = statement.numbers("a texture coordinate")?;
                    let v = statement.words().nth(1).map_or(Ok(0.0), |word| statement.number(word))?;
                    mesh.uvs.push(Vec2::new(u as f32, v as f32));
                }
                b"vn" => {
                    let normal = DVec3::from(statement.numbers("a normal")?);
                    mesh.normals.push(normal.normalize_or_zero().as_vec3());
                }
                b"f" => {
                    push_face(mesh, &statement, material)?;
                    lines.push(statement.line);
                }
                b"mtllib" => obj.libraries.push(statement.name()),
                b"usemtl" => {
                    let name = statement.name();
                    material = *materials.entry(name.clone()).or_insert(obj.materials.len() as u32);
                    if materials.len() > obj.materials.len() {
                        obj.materials.push(name);
                    }
                }
                _ => {}
            }
        }
        check_indices(&obj.mesh, &lines, path)?;
        if obj.mesh.faces.is_empty() {
            let mend = "export the model with faces (lines that start with `f`)";
            return Err(SceneError::new("the mesh has no faces").in_file(path).mend(mend));
        }
        Ok(obj)
    }

    /// Adds the model's own materials to the builder: the index of each, `None` where it is not defined.
    pub fn add_materials(
        &self,
        path: &Path,
        builder: &mut SceneBuilder,
    ) -> Result<Vec<Option<u32>>, SceneError> {
        let defined = mtl::load(&self.libraries, path, builder)?;
        let own = self.materials.iter().map(|name| {
            let number = defined.get(name).copied();
            if number.is_none() {
                let path = path.display();
                builder.warn(format!("{path}: the material `{name}` is not defined; a default is used."));
            }
            number
        });
        Ok(own.collect())
    }
}

fn push_face(mesh: &mut Mesh, statement: &Statement, material: u32) -> Result<(), SceneError> {
    let start = mesh.corners.len();
    let counts = [mesh.positions.len(), mesh.uvs.len(), mesh.normals.len()];
    let no_corner = |word: &[u8]| {
        let what = format!("`{}` is not the corner of a face", String::from_utf8_lossy(word));
        let mend = "write `v`, `v/vt`, `v//vn` or `v/vt/vn` with indices that count from 1, or back from -1";
        statement.fault(what, mend)
    };
    for word in statement.words() {
        let mut indices = [NONE; 3];
        for (at, part) in word.split(|&byte| byte == b'/').enumerate() {
            let Some(&count) = counts.get(at) else { return Err(no_corner(word)) };
            if part.is_empty() {
                continue;
            }
            let number = std::str::from_utf8(part).ok().and_then(|part| part.parse().ok());
            let number = number.ok_or_else(|| no_corner(part))?;
            indices[at] = index(number, count).ok_or_else(|| {
                let what =
                    format!("the face uses index {number}, but {count} such entries are defined above it");
                statement.fault(what, "indices count from 1, or back from -1")
            })?;
        }
        let [position, uv, normal] = indices;
        if position == NONE {
            return Err(no_corner(word));
        }
        mesh.corners.push(Corner { position, uv, normal });
    }
    if mesh.corners.len() - start < 3 {
        let mend = "remove the face, or give it three vertices or more";
        return Err(statement.fault("a face needs at least three corners", mend));
    }
    mesh.faces.push(Face { end: mesh.corners.len(), material });
    Ok(())
}

/// Converts an OBJ index to one from 0. Positive ones count from 1; negative ones count back from the last of
/// `count` entries.
fn index(number: i64, count: usize) -> Option<u32> {
    let from_zero = if number < 0 { number.saturating_add(count as i64) } else { number - 1 };
    u32::try_from(from_zero).ok().filter(|&index| index != NONE)
}

/// Every index must exist in the file; it may be defined below the face.
fn check_indices(mesh: &Mesh, lines: &[usize], path: &Path) -> Result<(), SceneError> {
    let mut start = 0;
    for (face, line) in mesh.faces.iter().zip(lines) {
        for corner in &mesh.corners[start..face.end] {
            let uses = [
                (corner.position, mesh.positions.len(), "vertex"),
                (corner.uv, mesh.uvs.len(), "texture coordinate"),
                (corner.normal, mesh.normals.len(), "normal"),
            ];
            let missing = |&(index, count, _): &_| index != NONE && index as usize >= count;
            if let Some((index, count, noun)) = uses.into_iter().find(missing) {
                let what = format!("the face uses {noun} {}, but the file has {count}", index + 1);
                let mend = match count {
                    0 => format!("add the missing {noun}, or leave its index out"),
                    _ => format!("use an index from 1 to {count}, or add what is missing"),
                };
                return Err(SceneError::new(what).in_file(path).at(format!("line {line}")).mend(mend));
            }
        }
        start = face.end;
    }
    Ok(())
}
