//! Reads a mesh from a PLY file of ASCII or either binary order.
//!
//! The elements are `vertex` (x, y, z; nx, ny, nz; red, green, blue; s, t or u, v), `face` (a list
//! `vertex_indices` or `vertex_index` of any length; a list `texcoord`; `texnumber`, the number of an image;
//! red, green, blue), and `tristrips`. Comments `TextureFile` name the images. Other elements are noted.
//! Colours are linear real numbers up to 1, or display values (sRGB) up to 255, 65,535 or the largest number
//! of their type, whichever fits the largest colour of the file.
//!
//! No library is used: one (`ply-rs-bw`) needs a parser generator and makes a map of each element, the other
//! (`serde-ply`) is at version 0.2. Here every count is checked against the bytes of the file, faults have
//! their line and byte, and the type of a colour shows whether it is a display value.
//!
//! Source: G. Turk, "The PLY Polygon File Format", 1994.

mod reader;

use super::check::is_within_bounds;
use super::error::SceneError;
use super::mesh::{Corner, Face, Mesh, NONE};
use super::scalar::Kind;
use super::vertex_colors::white;
use glam::{DVec3, Vec2, Vec3};
use octray_engine::scene::srgb_to_linear;
use reader::{Element, Property, Reader};
use std::path::Path;

/// Reads the content of a PLY file.
pub fn parse(bytes: &[u8], path: &Path) -> Result<Mesh, SceneError> {
    let mut reader = Reader::new(path, bytes);
    let elements = reader.header()?;
    let mut mesh = Mesh { images: std::mem::take(&mut reader.images), ..Mesh::default() };
    let mut uvs = Vec::new();
    for element in elements.iter().filter(|element| !element.properties.is_empty()) {
        reader.check_count(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(&mut mesh, &mut reader, element)?,
            "face" | "tristrips" => read_faces(&mut mesh, &mut uvs, &mut reader, element)?,
            name => {
                if element.count > 0 {
                    reader.notes.add(&element.line, format!("the element `{name}` is not read"));
                }
                each_row(&mut reader, element, |_| None)?;
            }
        }
    }
    // Faces may come before the vertices.
    let [no_uvs, no_normals] = [mesh.uvs.is_empty(), mesh.normals.is_empty()];
    for corner in &mut mesh.corners {
        corner.uv |= if no_uvs { NONE } else { 0 };
        corner.normal |= if no_normals { NONE } else { 0 };
    }
    for (corner, uv) in uvs {
        mesh.corners[corner].uv = mesh.uvs.len() as u32;
        mesh.uvs.push(uv);
    }
    if let Some((_, line)) = mesh.images.first().filter(|_| mesh.uvs.is_empty()) {
        reader.notes.add(line, "`TextureFile` is not read, as there are no texture coordinates");
        mesh.images.clear();
    }
    let colored = mesh.faces.iter().position(|face| !face.color.is_nan());
    if let Some(face) = colored.filter(|_| !mesh.colors.is_empty()) {
        let what = "colours of faces are left out, as the vertices have theirs";
        reader.notes.add(&format!(" face {face}"), what);
    }
    mesh.notes = reader.notes;
    mesh.check(path, 0, |face| format!("face {face}"))?;
    Ok(mesh)
}

/// A row of an element.
struct Row<'a> {
    /// One number of each property: of a list, the last one.
    values: &'a [f64],
    /// The content of the list `vertex_indices`.
    corners: &'a [f64],
    /// The content of the list `texcoord`: u and v of each corner.
    uvs: &'a [f64],
}

/// Reads the rows of an element, and adds the note that `read` returns about one.
fn each_row(
    reader: &mut Reader,
    element: &Element,
    mut read: impl FnMut(Row) -> Option<&'static str>,
) -> Result<(), SceneError> {
    let (mut values, mut corners) = (vec![0.0; element.properties.len()], Vec::new());
    let mut uvs = Vec::new();
    for number in 0..element.count {
        corners.clear();
        uvs.clear();
        for (value, property) in values.iter_mut().zip(&element.properties) {
            // Each number is read, so that a length beyond the file's end fails there.
            for _ in 0..reader.count(property)? {
                *value = reader.number(property.scalar)?;
                if property.is_corners() {
                    corners.push(*value);
                } else if property.is_uvs() {
                    uvs.push(*value);
                }
            }
        }
        if let Some(note) = read(Row { values: &values, corners: &corners, uvs: &uvs }) {
            reader.notes.add(&format!(" {} {number}", element.name), note);
        }
    }
    Ok(())
}

/// Returns the indices of the properties of these names, for each group that is complete. Notes all others.
fn columns<const N: usize>(
    reader: &mut Reader,
    element: &Element,
    groups: [&[&[&str]]; N],
) -> [Option<Vec<usize>>; N] {
    let find = |names: &&[&str]| {
        let is_named = |name: &String| names.contains(&name.as_str());
        element.properties.iter().position(|property| property.list.is_none() && is_named(&property.name))
    };
    let found = groups.map(|group| group.iter().map(find).collect::<Option<Vec<usize>>>());
    for (at, property) in element.properties.iter().enumerate().filter(|_| element.count > 0) {
        let is_list = property.is_corners() || property.is_uvs() && element.name == "face";
        if !is_list && !found.iter().flatten().flatten().any(|&used| used == at) {
            let what = format!("the property `{}` of `{}` is not read", property.name, element.name);
            reader.notes.add(&property.line, what);
        }
    }
    found
}

const COLOR: &[&[&str]] =
    &[&["red", "r", "diffuse_red"], &["green", "g", "diffuse_green"], &["blue", "b", "diffuse_blue"]];

fn read_vertices(mesh: &mut Mesh, reader: &mut Reader, element: &Element) -> Result<(), SceneError> {
    if !mesh.positions.is_empty() {
        return Err(reader.fault("a second list of vertices", "export the model again"));
    }
    const UV: &[&[&str]] = &[&["s", "u", "texture_u"], &["t", "v", "texture_v"]];
    let groups: [&[&[&str]]; 4] = [&[&["x"], &["y"], &["z"]], &[&["nx"], &["ny"], &["nz"]], COLOR, UV];
    let [position, normal, color, uv] = columns(reader, element, groups);
    let Some(position) = position else {
        return Err(reader.fault("vertices without x, y and z", "export the model again"));
    };
    mesh.colors_line = color.as_ref().map_or(mesh.colors_line, |at| element.properties[at[0]].line);
    each_row(reader, element, |Row { values, .. }| {
        mesh.positions.push(three(&position, values));
        mesh.normals.extend(normal.as_deref().map(|at| three(at, values).normalize_or_zero().as_vec3()));
        mesh.colors.extend(color.as_deref().map(|at| three(at, values).as_vec3()));
        mesh.uvs.extend(uv.as_ref().map(|at| finite([values[at[0]], values[at[1]]])));
        let mut further = [&normal, &color, &uv].into_iter().flatten().flatten();
        let is_broken = further.any(|&at| !is_within_bounds(values[at]));
        is_broken.then_some("a normal, a colour or a texture coordinate that is no number is left out")
    })?;
    color.iter().for_each(|at| make_linear(element, at, &mut mesh.colors));
    Ok(())
}

fn three(at: &[usize], values: &[f64]) -> DVec3 {
    DVec3::new(values[at[0]], values[at[1]], values[at[2]])
}

/// Converts texture coordinates; 0 stands for those that are no number.
fn finite(uv: [f64; 2]) -> Vec2 {
    uv.map(|x| if is_within_bounds(x) { x as f32 } else { 0.0 }).into()
}

/// Reads the faces of a file, or the triangles of its strips, and the corners' texture coordinates (`uvs`).
fn read_faces(
    mesh: &mut Mesh,
    uvs: &mut Vec<(usize, Vec2)>,
    reader: &mut Reader,
    element: &Element,
) -> Result<(), SceneError> {
    let (is_strips, before) = (element.name == "tristrips", mesh.faces.len());
    let [color, image] = columns(reader, element, [COLOR, &[&["texnumber"]]]);
    mesh.colors_line = color.as_ref().map_or(mesh.colors_line, |at| element.properties[at[0]].line);
    each_row(reader, element, |Row { values, corners, uvs: corner_uvs }| {
        let first = mesh.corners.len();
        let number = image.as_deref().map_or(0.0, |at| values[at[0]]);
        let material = if number < 0.0 { NONE } else { number as u32 };
        let color = color.as_deref().map_or(Vec3::NAN, |at| three(at, values).as_vec3());
        let mut push = |corners: &[f64]| {
            mesh.corners.extend(corners.iter().map(|&value| {
                let is_vertex = value >= 0.0 && value < f64::from(NONE) && value.fract() == 0.0;
                let index = if is_vertex { value as u32 } else { NONE };
                Corner { position: index, uv: index, normal: index }
            }));
            mesh.faces.push(Face { end: mesh.corners.len(), material, color });
        };
        // A negative number ends a strip. A triangle with two equal corners only turns it.
        for strip in corners.split(|&corner| is_strips && corner < 0.0).filter(|_| is_strips) {
            for (at, three) in strip.windows(3).enumerate() {
                let [a, b, c] = if at % 2 == 0 { [0, 1, 2] } else { [1, 0, 2] }.map(|corner| three[corner]);
                if a != b && b != c && c != a {
                    push(&[a, b, c]);
                }
            }
        }
        if !is_strips && element.properties.iter().any(Property::is_corners) {
            push(corners);
        }
        let pairs = corner_uvs.as_chunks().0;
        if mesh.corners.len() - first != pairs.len() {
            return (!pairs.is_empty())
                .then_some("a `texcoord` that is not u and v of each corner is left out");
        }
        uvs.extend(pairs.iter().enumerate().map(|(corner, &uv)| (first + corner, finite(uv))));
        None
    })?;
    if let Some(at) = color {
        let mut colors: Vec<Vec3> = mesh.faces[before..].iter().map(|face| face.color).collect();
        make_linear(element, &at, &mut colors);
        mesh.faces[before..].iter_mut().zip(colors).for_each(|(face, color)| face.color = color);
    }
    Ok(())
}

/// Makes the colours of an element linear and in [0, 1]. White stands for those that are no number.
fn make_linear(element: &Element, at: &[usize], colors: &mut [Vec3]) {
    let scalars = [0, 1, 2].map(|channel| element.properties[at[channel]].scalar);
    let whites = scalars.map(|scalar| {
        let alike = (0..3).filter(|&channel| scalars[channel] == scalar);
        let values = alike.flat_map(|channel| colors.iter().map(move |color| color[channel]));
        match scalar.kind {
            Kind::Real => white(values, &[1.0, 255.0, 65_535.0]),
            _ => white(values, &[255.0, 65_535.0, scalar.largest()]),
        }
    });
    for color in colors {
        *color = Vec3::from_array(std::array::from_fn(|channel| {
            let value = (f64::from(color[channel]) / whites[channel]).clamp(0.0, 1.0);
            let value = if value.is_nan() { 1.0 } else { value };
            (if whites[channel] == 1.0 { value } else { srgb_to_linear(value) }) as f32
        }));
    }
}
