//! Reads Wavefront OBJ: a mesh and the names of its materials.
//!
//! No library is used, so that every fault has its line, no file can cause a panic, and a corner without
//! texture coordinates does not get those of another corner.

use super::builder::SceneBuilder;
use super::error::SceneError;
use super::mesh::{Corner, Face, Mesh, NONE};
use super::mtl;
use super::statements::{Statement, statements, without_comment};
use super::vertex_colors::white;
use glam::{DVec3, Vec2, Vec3};
use octray_engine::scene::srgb_to_linear;
use std::collections::HashMap;
use std::path::Path;

/// The content of an OBJ file.
#[derive(Default)]
pub struct Obj {
    pub mesh: Mesh,
    /// The names given to `mtllib`, with their lines.
    libraries: Vec<(String, usize)>,
    /// The names given to `usemtl`, each once, with their lines.
    materials: Vec<(String, usize)>,
}

impl Obj {
    /// Reads an OBJ text. Broken and unknown statements are left out with a note. Comments and names may hold
    /// bytes that are not UTF-8.
    pub fn parse(text: &[u8], path: &Path) -> Result<Self, SceneError> {
        let Self { mut mesh, mut libraries, mut materials } = Self::default();
        // The material in use, and the index of each name.
        let (mut material, mut known) = (NONE, HashMap::new());
        // The line of the smoothing group in use, and those of all faces.
        let (mut smoothing, mut lines) = (None, Vec::new());
        for statement in statements(text, path) {
            let line = statement.line;
            let result = match statement.keyword() {
                b"v" => push_vertex(&mut mesh, &statement),
                b"vt" => {
                    let uv = uv(&statement, &mut mesh);
                    keep(&mut mesh.uvs, uv, Vec2::ZERO)
                }
                b"vn" => {
                    let normal = statement.numbers(&mut statement.words(), "a normal").map(DVec3::from);
                    let normal = normal.map(|normal| normal.normalize_or_zero().as_vec3());
                    keep(&mut mesh.normals, normal, Vec3::ZERO)
                }
                b"f" | b"fo" => push_face(&mut mesh, &statement, material).map(|is_flat| {
                    lines.push(line);
                    if let Some(line) = smoothing.take_if(|_| is_flat) {
                        mesh.notes.add(&line, "`s` is not read: faces without normals (`vn`) are flat");
                    }
                }),
                b"mtllib" => {
                    libraries.push((statement.name(), line));
                    Ok(())
                }
                b"usemtl" => {
                    let name = statement.name();
                    material = *known.entry(name.clone()).or_insert(materials.len() as u32);
                    if known.len() > materials.len() {
                        materials.push((name, line));
                    }
                    Ok(())
                }
                b"s" => {
                    smoothing = (!statement.is_off()).then_some(line);
                    Ok(())
                }
                // Names of parts have no effect.
                b"o" | b"g" => Ok(()),
                _ if statement.is_off() => Ok(()),
                _ => {
                    mesh.notes.add(&line, format!("{} is not read", statement.shown()));
                    Ok(())
                }
            };
            result.unwrap_or_else(|fault| mesh.notes.add_fault(&statement.shown(), fault));
        }
        finish_colors(&mut mesh);
        mesh.check(path, 1, |face| format!("line {}", lines[face]))?;
        Ok(Self { mesh, libraries, materials })
    }

    /// Adds the model's own materials to the builder. Returns their indices; `None` for an undefined one.
    pub fn add_materials(&self, path: &Path, builder: &mut SceneBuilder) -> Vec<Option<u32>> {
        let defined = mtl::load(&self.libraries, path, builder);
        let own = self.materials.iter().map(|(name, line)| {
            let number = without_comment(name).find_map(|name| defined.get(name).copied());
            if number.is_none() {
                let what = format!("the material `{name}` is not defined; a default is used");
                builder.warn(format!("{}:{line}: {what}.", path.display()));
            }
            number
        });
        own.collect()
    }
}

/// Appends an item, or `broken` in the place of a faulty one, so that the next ones keep their numbers.
fn keep<T>(list: &mut Vec<T>, read: Result<T, SceneError>, broken: T) -> Result<(), SceneError> {
    let (item, result) = read.map_or_else(|fault| (broken, Err(fault)), |item| (item, Ok(())));
    list.push(item);
    result
}

fn uv(statement: &Statement, mesh: &mut Mesh) -> Result<Vec2, SceneError> {
    let mut words = statement.words();
    let [u] = statement.numbers(&mut words, "a texture coordinate")?;
    let mut next = || words.next().map_or(Ok(0.0), |word| statement.number(word));
    let (v, w) = (next()?, next()?);
    if w != 0.0 {
        mesh.notes.add(&statement.line, "the third coordinate of `vt` is not read");
    }
    Ok(Vec2::new(u as f32, v as f32))
}

fn push_vertex(mesh: &mut Mesh, statement: &Statement) -> Result<(), SceneError> {
    let mut words = statement.words();
    let position = statement.numbers(&mut words, "a vertex").map(DVec3::from);
    let is_point = position.is_ok();
    keep(&mut mesh.positions, position, DVec3::NAN)?;
    let further: Vec<&[u8]> = words.collect();
    match further.len() {
        0 => return Ok(()),
        3 | 4 if is_point => match statement.numbers(&mut further.iter().copied(), "a colour") {
            Ok(color) => {
                mesh.colors_line = if mesh.colors.is_empty() { statement.line } else { mesh.colors_line };
                mesh.colors.resize(mesh.positions.len() - 1, Vec3::NAN);
                mesh.colors.push(DVec3::from(color).as_vec3());
            }
            Err(fault) => mesh.notes.add_fault("the colour of `v`", fault),
        },
        _ => {}
    }
    // A weight or an opacity of 1 has no effect.
    let last = further[further.len() - 1];
    if further.len() != 3 && !statement.number(last).is_ok_and(|number| number == 1.0) {
        mesh.notes.add(&statement.line, "the weight or opacity of `v` is not read");
    }
    Ok(())
}

/// Makes the vertices' colours linear, from display values up to 1 or to 255. Vertices without one are white.
fn finish_colors(mesh: &mut Mesh) {
    if mesh.colors.is_empty() {
        return;
    }
    mesh.colors.resize(mesh.positions.len(), Vec3::NAN);
    let white = white(mesh.colors.iter().flat_map(|color| color.to_array()), &[1.0, 255.0]);
    let linear = |x: f32| srgb_to_linear((f64::from(x) / white).clamp(0.0, 1.0)) as f32;
    for color in &mut mesh.colors {
        *color = if color.is_nan() { Vec3::ONE } else { color.to_array().map(linear).into() };
    }
}

/// Adds a face. Returns whether one of its corners has no normal.
fn push_face(mesh: &mut Mesh, statement: &Statement, material: u32) -> Result<bool, SceneError> {
    let counts = [mesh.positions.len(), mesh.uvs.len(), mesh.normals.len()];
    let (start, mut is_flat) = (mesh.corners.len(), false);
    for word in statement.words() {
        let corner = corner(statement, word, counts).inspect_err(|_| mesh.corners.truncate(start))?;
        is_flat |= corner.normal == NONE;
        mesh.corners.push(corner);
    }
    mesh.faces.push(Face { end: mesh.corners.len(), material, color: Vec3::NAN });
    Ok(is_flat)
}

fn corner(statement: &Statement, word: &[u8], counts: [usize; 3]) -> Result<Corner, SceneError> {
    let no_corner = |word: &[u8]| {
        let what = format!("`{}` is not the corner of a face", String::from_utf8_lossy(word));
        let mend = "write `v`, `v/vt`, `v//vn` or `v/vt/vn` with indices that count from 1, or back from -1";
        statement.fault(what, mend)
    };
    let mut indices = [NONE; 3];
    for (at, part) in word.split(|&byte| byte == b'/').enumerate() {
        let Some(&count) = counts.get(at) else { return Err(no_corner(word)) };
        if part.is_empty() {
            continue;
        }
        let number = std::str::from_utf8(part).ok().and_then(|part| part.parse().ok());
        let number = number.ok_or_else(|| no_corner(part))?;
        indices[at] = index(number, count).ok_or_else(|| {
            let what = format!("the face uses index {number}, but {count} such entries are defined above it");
            statement.fault(what, "indices count from 1, or back from -1")
        })?;
    }
    let [position, uv, normal] = indices;
    if position == NONE { Err(no_corner(word)) } else { Ok(Corner { position, uv, normal }) }
}

/// Converts an OBJ index to one from 0. Positive ones count from 1, negative ones back from the last of
/// `count` entries.
fn index(number: i64, count: usize) -> Option<u32> {
    let from_zero = if number < 0 { number.saturating_add(count as i64) } else { number - 1 };
    u32::try_from(from_zero).ok().filter(|&index| index != NONE)
}
