//! Wavefront OBJ: from text to a mesh, and from a mesh to the triangles of a [`SceneBuilder`].
//!
//! For: [`parse`], [`add`].
//!
//! No library is used, so that every error has its line, no file can cause a panic, and a corner without
//! texture coordinates never gets another corner's.

use super::builder::SceneBuilder;
use super::check::fits;
use super::error::SceneError;
use super::files::Files;
use super::mtl;
use super::placement::Placement;
use super::statements::{Fault, logical_lines, name, number, numbers, words};
use super::tally::{Misplaced, Tally};
use glam::{DVec3, Vec2, Vec3};
use std::collections::HashMap;
use std::path::Path;

/// Index of a corner's missing texture coordinate or normal.
const NONE: u32 = u32::MAX;

/// The content of an OBJ file, indices checked.
#[derive(Default)]
pub struct Mesh {
    positions: Vec<DVec3>,
    texcoords: Vec<Vec2>,
    normals: Vec<Vec3>,
    /// The corners of all faces, one face after the other.
    corners: Vec<Corner>,
    faces: Vec<Face>,
    /// The names given to `mtllib`, in order.
    libraries: Vec<String>,
    /// The names given to `usemtl`, each once.
    materials: Vec<String>,
}

/// Indices from 0 into positions, texture coordinates and normals.
#[derive(Clone, Copy)]
struct Corner {
    position: u32,
    texcoord: u32,
    normal: u32,
}

struct Face {
    corners: std::ops::Range<usize>,
    /// Index into the mesh's `materials`.
    material: Option<usize>,
    line: usize,
}

/// Reads an OBJ text: `v`, `vt`, `vn`, `f`, `mtllib` and `usemtl`; other statements are ignored. Comments and
/// names may hold bytes that are not UTF-8.
pub fn parse(text: &[u8], path: &Path) -> Result<Mesh, SceneError> {
    let mut mesh = Mesh::default();
    // The material in use, and the index of each name.
    let (mut material, mut materials) = (None, HashMap::new());
    for (line, content) in logical_lines(text) {
        let fault =
            |(what, mend): Fault| SceneError::new(what).in_file(path).at(format!("line {line}")).mend(mend);
        let content = content.trim_ascii();
        let end = content.iter().position(u8::is_ascii_whitespace).unwrap_or(content.len());
        let (keyword, rest) = (&content[..end], &content[end..]);
        match keyword {
            b"v" => mesh.positions.push(DVec3::from(numbers::<3>(rest, "a vertex").map_err(fault)?)),
            b"vt" => mesh.texcoords.push(texcoord(rest).map_err(fault)?),
            b"vn" => {
                let [x, y, z] = numbers::<3>(rest, "a normal").map_err(fault)?;
                mesh.normals.push(DVec3::new(x, y, z).normalize_or_zero().as_vec3());
            }
            b"f" => mesh.push_face(rest, material, line).map_err(fault)?,
            b"mtllib" => mesh.libraries.push(name(rest)),
            b"usemtl" => {
                let name = name(rest);
                let next = mesh.materials.len();
                material = Some(*materials.entry(name.clone()).or_insert(next));
                if materials.len() > next {
                    mesh.materials.push(name);
                }
            }
            _ => {}
        }
    }
    mesh.check_indices(path)?;
    if mesh.faces.is_empty() {
        let mend = "export the model with faces (lines that start with `f`)";
        return Err(SceneError::new("the mesh has no faces").in_file(path).mend(mend));
    }
    Ok(mesh)
}

/// u, then v, which is 0 where missing.
fn texcoord(rest: &[u8]) -> Result<Vec2, Fault> {
    let [u] = numbers::<1>(rest, "a texture coordinate")?;
    let v = words(rest).nth(1).map_or(Ok(0.0), number)?;
    Ok(Vec2::new(u as f32, v as f32))
}

impl Mesh {
    /// The number of its triangles, those without area included.
    fn triangles(&self) -> usize {
        self.corners.len() - 2 * self.faces.len()
    }
    fn push_face(&mut self, rest: &[u8], material: Option<usize>, line: usize) -> Result<(), Fault> {
        let start = self.corners.len();
        for word in words(rest) {
            let mut indices = word.split(|&byte| byte == b'/');
            let counts = [self.positions.len(), self.texcoords.len(), self.normals.len()];
            let [position, texcoord, normal] = counts.map(|count| index(indices.next(), count));
            let corner = Corner { position: position?, texcoord: texcoord?, normal: normal? };
            if corner.position == NONE || indices.next().is_some() {
                return Err(face_fault(word));
            }
            self.corners.push(corner);
        }
        if self.corners.len() - start < 3 {
            let what = "a face needs at least three corners".to_string();
            return Err((what, "remove the face, or give it three vertices or more".to_string()));
        }
        self.faces.push(Face { corners: start..self.corners.len(), material, line });
        Ok(())
    }
    /// Every index must exist in the file; it may be defined below the face.
    fn check_indices(&self, path: &Path) -> Result<(), SceneError> {
        for face in &self.faces {
            for corner in &self.corners[face.corners.clone()] {
                let uses = [
                    (corner.position, self.positions.len(), "vertex"),
                    (corner.texcoord, self.texcoords.len(), "texture coordinate"),
                    (corner.normal, self.normals.len(), "normal"),
                ];
                for (index, count, noun) in uses {
                    if index != NONE && index as usize >= count {
                        let what = format!("the face uses {noun} {}, but the file has {count}", index + 1);
                        return Err(SceneError::new(what)
                            .in_file(path)
                            .at(format!("line {}", face.line))
                            .mend(match count {
                                0 => format!("add the missing {noun}, or leave its index out"),
                                _ => format!("use an index from 1 to {count}, or add what is missing"),
                            }));
                    }
                }
            }
        }
        Ok(())
    }
}

fn face_fault(word: &[u8]) -> Fault {
    let what = format!("`{}` is not the corner of a face", String::from_utf8_lossy(word));
    (
        what,
        "write `v`, `v/vt`, `v//vn` or `v/vt/vn` with indices that count from 1, or back from -1".to_string(),
    )
}

/// Converts an OBJ index to one from 0. Positive ones count from 1; negative ones count back from the last of
/// `count` entries.
fn index(word: Option<&[u8]>, count: usize) -> Result<u32, Fault> {
    let Some(word) = word.filter(|word| !word.is_empty()) else { return Ok(NONE) };
    let number: i64 =
        std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()).ok_or_else(|| face_fault(word))?;
    let from_zero = if number < 0 { number.saturating_add(count as i64) } else { number - 1 };
    u32::try_from(from_zero).ok().filter(|&index| index != NONE).ok_or_else(|| {
        let what = format!("the face uses index {number}, but {count} such entries are defined above it");
        (what, "indices count from 1, or back from -1".to_string())
    })
}

/// Adds a mesh's triangles to the builder. Polygons become fans around their first corner; triangles without
/// area are left out, with one warning that counts them. All have `material`, or else the materials of the
/// model's MTL. Returns `Some` if the placement makes the mesh unusable.
pub fn add(
    mesh: &Mesh,
    path: &Path,
    files: &Files,
    builder: &mut SceneBuilder,
    material: Option<u32>,
    placement: &Placement,
) -> Result<Option<Misplaced>, SceneError> {
    builder.check_room(mesh.triangles()).map_err(|error| error.in_file(path))?;
    let own = match material {
        Some(_) => HashMap::new(),
        None => mtl::load(&mesh.libraries, path, files, builder)?,
    };
    let own: Vec<Option<u32>> = mesh.materials.iter().map(|name| own.get(name).copied()).collect();
    if material.is_none() {
        for (name, _) in mesh.materials.iter().zip(&own).filter(|(_, number)| number.is_none()) {
            builder.warn(format!(
                "{}: the material `{name}` is not defined; a default is used.",
                path.display()
            ));
        }
    }
    let positions: Vec<DVec3> = mesh.positions.iter().map(|&p| placement.point(p)).collect();
    if let Some(&outside) = positions.iter().find(|p| !p.to_array().into_iter().all(fits)) {
        return Ok(Some(Misplaced::TooFar(outside)));
    }
    let normals: Vec<Vec3> =
        mesh.normals.iter().map(|n| (placement.rotation * n.as_dvec3()).as_vec3()).collect();

    let mut tally = Tally::default();
    for face in &mesh.faces {
        let material = match material.or_else(|| own[face.material?]) {
            Some(material) => material,
            None => builder.default_material(),
        };
        let corners = &mesh.corners[face.corners.clone()];
        for i in 1..corners.len() - 1 {
            let fan = [corners[0], corners[i], corners[i + 1]];
            let vertices = fan.map(|corner| positions[corner.position as usize].as_vec3());
            let all_have = |index: fn(&Corner) -> u32| fan.iter().all(|corner| index(corner) != NONE);
            let uvs = all_have(|corner| corner.texcoord)
                .then(|| fan.map(|corner| mesh.texcoords[corner.texcoord as usize]));
            let normals = all_have(|corner| corner.normal)
                .then(|| fan.map(|corner| normals[corner.normal as usize]))
                .filter(|normals| normals.iter().all(|&normal| normal != Vec3::ZERO));
            tally.count(builder.add_triangle(vertices, material, uvs, normals));
        }
    }
    Ok(tally.finish(path, builder))
}
