//! Adds the triangles of a model to a scene, and holds the meshes of polygons of OBJ and PLY files.

use super::builder::{Attributes, SceneBuilder};
use super::check::{is_near, is_within_bounds};
use super::error::SceneError;
use super::notes::Notes;
use super::placement::Placement;
use super::texture::Lookup;
use earcut::Earcut;
use glam::{DVec3, Vec2, Vec3};
use octray_engine::scene::{Filter, Material, MaterialKind, TexelKind};
use std::path::Path;

/// The index that stands for a missing entry.
pub const NONE: u32 = u32::MAX;

/// The content of a model's file, checked by [`Mesh::check`].
#[derive(Default)]
pub struct Mesh {
    /// Positions of vertices; NaN for one that is no point.
    pub positions: Vec<DVec3>,
    /// Normals of unit length; zero for one without a direction.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v upwards.
    pub uvs: Vec<Vec2>,
    /// Linear colours of the positions, in [0, 1]; empty if the file has none.
    pub colors: Vec<Vec3>,
    /// The line of the first colour in the file.
    pub colors_line: usize,
    /// The corners of all faces, one face after the other.
    pub corners: Vec<Corner>,
    pub faces: Vec<Face>,
    /// Images of the model's own materials, with the lines that name them.
    pub images: Vec<(String, usize)>,
    /// Notes about the file.
    pub notes: Notes,
}

/// The indices of a face's corner, from 0. An index beyond the mesh's lists is missing.
#[derive(Clone, Copy)]
pub struct Corner {
    pub position: u32,
    pub uv: u32,
    pub normal: u32,
}

/// A polygon.
pub struct Face {
    /// Index after its last corner in the mesh's corners.
    pub end: usize,
    /// Index into the model's own materials.
    pub material: u32,
    /// Linear colour; NaN if the face has none.
    pub color: Vec3,
}

impl Mesh {
    /// Removes the faces that cannot be shown, with a note, and refuses a mesh without other faces. `place`
    /// returns the place of a face by its number; `base` is the index of the first vertex in the file.
    pub fn check(
        &mut self,
        path: &Path,
        base: usize,
        place: impl Fn(usize) -> String,
    ) -> Result<(), SceneError> {
        let Self { positions, normals, uvs, corners, faces, notes, .. } = self;
        let [vertices, uvs, normals] = [positions.len(), uvs.len(), normals.len()];
        let mend = format!(
            "indices count from {base}, and there are {vertices} vertices, {uvs} texture coordinates and {normals} \
             normals; a face needs three corners or more"
        );
        let (mut number, mut start, mut kept) = (0, 0, 0);
        faces.retain_mut(|face| {
            let of_face = std::mem::replace(&mut start, face.end)..face.end;
            let length = of_face.len();
            number += 1;
            let mut fault = |left_out: &str, what: String| {
                let fault =
                    SceneError::new(what).in_file(path).at_place(place(number - 1)).mend(mend.as_str());
                notes.add_fault(left_out, fault);
            };
            let mut why = (length < 3).then(|| "a face needs at least three corners".to_string());
            for &Corner { position, uv, normal } in &corners[of_face.clone()] {
                let index = position as usize + base;
                match positions.get(position as usize) {
                    Some(point) if point.to_array().into_iter().all(is_within_bounds) => {}
                    Some(_) => why = Some(format!("the face uses vertex {index}, which is no point")),
                    None if position == NONE => why = Some("one of its corners is no vertex".to_string()),
                    None => why = Some(format!("the face uses vertex {index}, but the file has {vertices}")),
                }
                for (noun, index, count) in [("texture coordinate", uv, uvs), ("normal", normal, normals)] {
                    if index != NONE && index as usize >= count {
                        let index = index as usize + base;
                        fault(noun, format!("the face uses {noun} {index}, but the file has {count}"));
                    }
                }
            }
            if let Some(why) = why {
                fault("a face", why);
                return false;
            }
            corners.copy_within(of_face, kept);
            kept += length;
            face.end = kept;
            true
        });
        corners.truncate(kept);
        if faces.is_empty() {
            let mend = "export the model with faces: points and lines have no surface";
            let none = SceneError::new("the mesh has no faces").in_file(path).mend(mend);
            return Err(std::mem::take(notes).refusal(none));
        }
        Ok(())
    }

    /// Adds a material for each image to the builder. Returns their indices; `None` for an unreadable image.
    pub fn add_materials(&self, path: &Path, builder: &mut SceneBuilder) -> Vec<Option<u32>> {
        let lookup = Lookup::repeating(Filter::Bilinear, TexelKind::Color);
        let material = |(name, line): &(String, usize)| {
            let found = builder.textures.find(name, [path; 2], lookup);
            let left_out = |why| builder.notes.add(line, format!("the texture `{name}` is left out: {why}"));
            let texture = Some(found.map_err(left_out).ok()?);
            let material = Material::new(name, MaterialKind::Diffuse, Vec3::ONE);
            Some(builder.add_material(Material { texture, ..material }, 1.0))
        };
        self.images.iter().map(material).collect()
    }

    /// Adds the mesh's triangles to the builder, with `material` or else with the mesh's `own` materials and
    /// colours.
    pub fn add(
        &self,
        path: &Path,
        builder: &mut SceneBuilder,
        material: Option<u32>,
        own: &[Option<u32>],
        placement: &Placement,
    ) -> Result<(), Unusable> {
        let triangles = self.polygons().map(|(_, corners)| corners.len() - 2).sum();
        builder.check_room(triangles).map_err(|error| error.in_file(path))?;
        let points = self.corners.iter().map(|corner| self.positions[corner.position as usize]);
        let placement = builder.within_scene(placement, points);
        let (first, mut count) = (builder.scene.triangles.len(), 0);
        let (mut white, mut triangles, mut cutter) = (None, Vec::new(), Earcut::new());
        for (face, corners) in self.polygons() {
            let is_colored = !self.colors.is_empty() || !face.color.is_nan();
            let number = material.or_else(|| *own.get(face.material as usize)?).unwrap_or_else(|| {
                if !is_colored {
                    return builder.default_material();
                }
                let plain = || Material::new("vertex colours", MaterialKind::Diffuse, Vec3::ONE);
                *white.get_or_insert_with(|| builder.add_material(plain(), 1.0))
            });
            if is_colored && material.is_none() && builder.colored(number).is_none() {
                let name = &builder.scene.materials[number as usize].name;
                let what = format!("vertex colours are left out, as `{name}` has textures");
                builder.notes.add(&self.colors_line, what);
            }
            if !triangulate(&self.positions, corners, &mut cutter, &mut triangles) {
                let what =
                    format!("it has more than {MOST_CORNERS} corners and is shown as a fan, perhaps wrongly");
                builder.notes.add(&" a face", what);
            }
            count += triangles.len();
            for &triangle in &triangles {
                let corners = triangle.map(|corner| corners[corner]);
                let points = corners.map(|corner| placement.point(self.positions[corner.position as usize]));
                let normals = all(&self.normals, corners.map(|corner| corner.normal));
                let rotated = |normal: Vec3| (placement.rotation * normal.as_dvec3()).as_vec3();
                let colors = all(&self.colors, corners.map(|corner| corner.position));
                let attributes = Attributes {
                    uvs: all(&self.uvs, corners.map(|corner| corner.uv)),
                    normals: normals.map(|normals| normals.map(rotated)),
                    colors: colors.or(is_colored.then_some([face.color; 3])).filter(|_| material.is_none()),
                };
                add_triangle(points, number, attributes, builder)?;
            }
        }
        builder.warn_of_notes(path, ":");
        self.notes.warnings(path, ":").for_each(|warning| builder.warn(warning));
        finish(path, builder, first, count)
    }

    /// Returns the faces and their corners.
    fn polygons(&self) -> impl Iterator<Item = (&Face, &[Corner])> {
        let starts = std::iter::once(0).chain(self.faces.iter().map(|face| face.end));
        self.faces.iter().zip(starts).map(|(face, start)| (face, &self.corners[start..face.end]))
    }
}

/// Share of a polygon's area that a fan may cover twice. Single precision and six digits round by as much.
const OVERLAP: f64 = 1e-6;
/// Most corners of a polygon whose ears are cut off, which can take time by the square of their number.
const MOST_CORNERS: usize = 1 << 14;

/// Cuts a polygon into triangles of indices of its corners: a fan around the first corner if that covers the
/// polygon, as it does a convex one, or else by cutting off ears, seen along its normal. Returns false for a
/// polygon with too many corners for that, which stays a fan.
fn triangulate(
    positions: &[DVec3],
    corners: &[Corner],
    cutter: &mut Earcut<f64>,
    triangles: &mut Vec<[usize; 3]>,
) -> bool {
    let point = |corner: usize| positions[corners[corner].position as usize];
    let twice_area = |[a, b, c]: [usize; 3]| (point(b) - point(a)).cross(point(c) - point(a));
    triangles.clear();
    triangles.extend((1..corners.len() - 1).map(|corner| [0, corner, corner + 1]));
    // Newell's method: the sum does not depend on the first corner.
    let normal: DVec3 = triangles.iter().map(|&triangle| twice_area(triangle)).sum();
    let backwards = triangles.iter().map(|&triangle| -twice_area(triangle).dot(normal).min(0.0));
    if backwards.sum::<f64>() <= OVERLAP * normal.length_squared() {
        return true;
    }
    if corners.len() > MOST_CORNERS {
        return false;
    }
    let axis = normal.abs().max_position();
    let seen = (0..corners.len()).map(|corner| {
        let point = point(corner).to_array();
        [point[(axis + 1) % 3], point[(axis + 2) % 3]]
    });
    let mut indices = Vec::new();
    cutter.earcut(seen, &[], &mut indices);
    if !indices.is_empty() {
        triangles.clear();
    }
    for &[a, b, c] in indices.as_chunks::<3>().0 {
        // Each triangle has its front on the front of the polygon.
        triangles.push(if twice_area([a, b, c]).dot(normal) < 0.0 { [a, c, b] } else { [a, b, c] });
    }
    true
}

/// Returns the items of three corners; `None` if one is missing.
fn all<T: Copy>(list: &[T], indices: [u32; 3]) -> Option<[T; 3]> {
    let [a, b, c] = indices.map(|index| list.get(index as usize).copied());
    Some([a?, b?, c?])
}

/// The reason why a placed model cannot be used.
pub enum Unusable {
    /// One of its files cannot be read.
    Broken(SceneError),
    /// This point lies beyond the bounds of a scene.
    TooFar(DVec3),
    /// No triangle has an area in single precision.
    NoArea,
}

impl From<SceneError> for Unusable {
    fn from(error: SceneError) -> Self {
        Self::Broken(error)
    }
}

/// Adds a triangle of a model, in the coordinates of the scene, to the builder. It is flat if one of its
/// normals has no direction, and left out if it has no area.
pub fn add_triangle(
    points: [DVec3; 3],
    material: u32,
    attributes: Attributes,
    builder: &mut SceneBuilder,
) -> Result<(), Unusable> {
    if let Some(&outside) = points.iter().find(|point| !is_near(**point)) {
        return Err(Unusable::TooFar(builder.scene.coordinates.to_file(outside)));
    }
    let normals = attributes.normals.filter(|normals| !normals.contains(&Vec3::ZERO));
    let _ = builder.add_triangle(points, material, Attributes { normals, ..attributes });
    Ok(())
}

/// Warns of the triangles without an area, of the `count` that a model added to the builder from the index
/// `first` on. Refuses a model that has no others.
pub fn finish(path: &Path, builder: &mut SceneBuilder, first: usize, count: usize) -> Result<(), Unusable> {
    let without_area = count - (builder.scene.triangles.len() - first);
    if without_area == count {
        return Err(Unusable::NoArea);
    }
    if without_area > 0 {
        let (noun, verb) = if without_area == 1 { ("triangle", "was") } else { ("triangles", "were") };
        builder.warn(format!("{}: {without_area} {noun} of zero area {verb} left out.", path.display()));
    }
    Ok(())
}
