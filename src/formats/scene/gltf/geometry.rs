//! Reads the geometry of primitives, and adds their triangles to the scene.

use super::super::builder::{Attributes, SceneBuilder};
use super::super::check::is_within_bounds;
use super::super::error::SceneError;
use super::super::json::JsonPath;
use super::super::mesh::{Unusable, add_triangle};
use super::super::notes::Notes;
use super::super::placement::Placement;
use super::accessor::{Accessors, Numbers};
use super::bytes::broken;
use super::material::Added;
use super::schema::{Lenient, Primitive};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3};
use std::rc::Rc;

/// The mode of primitives that are lists of triangles. The next one is that of strips.
const LIST: usize = 4;
/// The mode of primitives that are fans.
const FAN: usize = 6;

/// The numbers of one primitive, shared by primitives and nodes.
pub struct Geometry {
    positions: Rc<Numbers>,
    normals: Option<Rc<Numbers>>,
    uvs: Option<Rc<Numbers>>,
    colors: Option<Rc<Numbers>>,
    indices: Option<Rc<Numbers>>,
    mode: usize,
    has_tangents: bool,
}

impl Geometry {
    /// Notes the attributes of vertices that the material cannot use, and those that it lacks.
    pub fn note_unused(&self, material: u32, place: &JsonPath, builder: &mut SceneBuilder) {
        let is_textured = builder.scene.materials[material as usize].textures().next().is_some();
        if self.has_tangents && builder.scene.materials[material as usize].normal_map.is_some() {
            let what = "tangents are left out: they follow from the texture coordinates";
            builder.notes.add(&place.key("attributes").key("TANGENT"), what);
        }
        if is_textured && self.uvs.is_none() {
            builder
                .notes
                .add(place, "a textured mesh without its texture coordinates has one texel's colour");
        }
        if self.colors.is_some() && builder.colored(material).is_none() {
            builder.notes.add(place, "vertex colours are left out, as the material has textures");
        }
    }
    /// Tests whether some vertex has an alpha below 1.
    pub fn has_alpha(&self) -> bool {
        let colors = self.colors.iter().filter(|colors| colors.components == 4);
        colors.flat_map(|colors| colors.values.chunks_exact(4)).any(|color| color[3] < 1.0)
    }
    /// Removes the vertex colours if all vertices have the same colour, and returns it unless it is white.
    /// The material can have such a colour and textures too.
    pub fn take_uniform_color(&mut self) -> Option<Vec3> {
        let is_uniform = |colors: &mut Rc<Numbers>| {
            (1..colors.count).all(|vertex| colors.element::<3>(vertex) == colors.element(0))
        };
        let colors = self.colors.take_if(is_uniform)?;
        let color = (colors.count > 0).then(|| color(&colors, 0))?;
        Some(color).filter(|color| *color != Vec3::ONE)
    }
    /// Returns the positions of all vertices.
    pub fn points(&self) -> impl Iterator<Item = DVec3> + Clone {
        (0..self.positions.count).map(|vertex| DVec3::from_array(self.positions.element(vertex)))
    }
    /// Returns the number of corners.
    fn corners(&self) -> usize {
        self.indices.as_ref().map_or(self.positions.count, |indices| indices.count)
    }
    /// Returns the number of triangles.
    pub fn triangles(&self) -> usize {
        match self.mode {
            LIST => self.corners() / 3,
            _ => self.corners().saturating_sub(2),
        }
    }
    /// Returns the corners of a quad of two triangles, in their order around its front, after a transform;
    /// `None` for other geometry.
    pub fn quad(&self, transform: &DMat4) -> Option<[DVec3; 4]> {
        if self.triangles() != 2 {
            return None;
        }
        let point = |vertex| transform.transform_point3(DVec3::from_array(self.positions.element(vertex)));
        let [first, second] = [0, 1].map(|number| self.triangle(number).map(point));
        let is_shared = |point: &DVec3| second.contains(point);
        let apex = (0..3).find(|&corner| !is_shared(&first[corner]))?;
        let fourth = second.into_iter().find(|point| !first.contains(point))?;
        let [a, b, c] = [0, 1, 2].map(|step| first[(apex + step) % 3]);
        let is_mirrored = DMat3::from_mat4(*transform).determinant() < 0.0;
        let quad = if is_mirrored { [a, c, fourth, b] } else { [a, b, fourth, c] };
        (is_shared(&b) && is_shared(&c)).then_some(quad)
    }
    /// Returns the vertices of a triangle, counter-clockwise as seen from its front.
    fn triangle(&self, number: usize) -> [usize; 3] {
        let corners = match self.mode {
            LIST => [3 * number, 3 * number + 1, 3 * number + 2],
            FAN => [0, number + 1, number + 2],
            _ if number.is_multiple_of(2) => [number, number + 1, number + 2],
            _ => [number + 1, number, number + 2],
        };
        let indices = self.indices.as_ref();
        corners.map(|corner| indices.map_or(corner, |indices| indices.element::<1>(corner)[0] as usize))
    }
}

/// Returns the colour of a vertex within [0, 1].
fn color(colors: &Numbers, vertex: usize) -> Vec3 {
    DVec3::from_array(colors.element(vertex)).as_vec3().clamp(Vec3::ZERO, Vec3::ONE)
}

/// Reads the numbers of a primitive; `None`, with a note, if it is not made of triangles. Texture coordinates
/// are those of this `set`, if any.
pub fn read(
    accessors: &mut Accessors,
    primitive: &Primitive,
    set: Option<usize>,
    place: &JsonPath,
    notes: &mut Notes,
) -> Result<Option<Geometry>, SceneError> {
    if primitive.targets.0.as_ref().is_some_and(|targets| !targets.is_empty()) {
        notes.add(place, "morph targets are not read: the mesh is shown as it is without them");
    }
    let mode = primitive.mode.map_or(LIST, |mode| mode.0);
    match mode {
        LIST..=FAN => {}
        0..LIST => {
            notes.add(place, "points and lines are left out");
            return Ok(None);
        }
        _ => return Err(place.key("mode").error("the mode is unknown", "write a number from 0 to 6")),
    }
    let attributes = place.key("attributes");
    let mut read = |key: &str, components: &[usize], vertices: usize| {
        let Some(Lenient(index)) = primitive.attributes.get(key) else { return Ok(None) };
        let place = attributes.key(key);
        let index = index.ok_or_else(|| broken(&place, "this is not the index of an accessor"))?;
        let numbers = accessors.vertices(index.0, components, &place)?;
        if numbers.count < vertices {
            return Err(broken(&place, format!("{} values for {vertices} vertices", numbers.count)));
        }
        Ok(Some(numbers))
    };
    let Some(positions) = read("POSITION", &[3], 0)? else {
        notes.add(place, "a mesh without positions is left out");
        return Ok(None);
    };
    let normals = read("NORMAL", &[3], positions.count)?;
    let colors = read("COLOR_0", &[3, 4], positions.count)?;
    let uv_key = set.map(|set| format!("TEXCOORD_{set}"));
    let uvs = uv_key.map(|key| read(&key, &[2], positions.count)).transpose()?.flatten();
    let place = place.key("indices");
    let indices = primitive.indices.map(|index| accessors.indices(index.0, &place)).transpose()?;
    let mut values = indices.iter().flat_map(|indices| &indices.values);
    if let Some(outside) = values.find(|&&index| index >= positions.count as f64) {
        return Err(broken(&place, format!("the mesh uses vertex {outside} of {}", positions.count)));
    }
    let has_tangents = primitive.attributes.contains_key("TANGENT");
    Ok(Some(Geometry { positions, normals, uvs, colors, indices, mode, has_tangents }))
}

/// A transform of a mesh's coordinates to the scene's.
pub struct Transform {
    matrix: DMat4,
    /// The transform of normals: the inverse transpose, if there is one.
    normal_matrix: Option<DMat3>,
    /// Whether it mirrors, which reverses the order of a triangle's vertices.
    mirrors: bool,
}

impl Transform {
    /// Combines the transform of a node with the placement of the model.
    pub fn new(node: &DMat4, placement: &Placement) -> Self {
        let linear = placement.rotation * DMat3::from_diagonal(DVec3::splat(placement.scale));
        let placed = DMat4::from_mat3(linear);
        let matrix = DMat4::from_translation(placement.translate) * placed * *node;
        let linear = DMat3::from_mat4(matrix);
        let determinant = linear.determinant();
        let inverse = linear.inverse().transpose();
        let invertible = determinant != 0.0 && inverse.is_finite();
        Self { matrix, normal_matrix: invertible.then_some(inverse), mirrors: determinant < 0.0 }
    }

    /// Adds the triangles of a primitive to the builder.
    pub fn add(
        &self,
        geometry: &Geometry,
        material: Added,
        builder: &mut SceneBuilder,
    ) -> Result<(), Unusable> {
        for number in 0..geometry.triangles() {
            let mut corners = geometry.triangle(number);
            if self.mirrors {
                corners.swap(1, 2);
            }
            let points = corners.map(|corner| {
                let point = DVec3::from_array(geometry.positions.element(corner));
                self.matrix.transform_point3(point)
            });
            let normals = geometry.normals.as_ref().zip(self.normal_matrix).map(|(normals, matrix)| {
                corners.map(|corner| {
                    let normal = matrix * DVec3::from_array(normals.element(corner));
                    normal.normalize_or_zero().as_vec3()
                })
            });
            let colors = geometry.colors.as_ref();
            let colors = colors.map(|colors| corners.map(|corner| color(colors, corner)));
            let uvs = geometry.uvs.as_ref();
            let uvs = uvs.map(|uvs| corners.map(|corner| material.uv_map.apply(uvs.element(corner))));
            let uvs =
                uvs.filter(|uvs| uvs.iter().all(|uv| uv.is_finite() && is_within_bounds(uv.length().into())));
            let attributes = Attributes { uvs: uvs.or(Some([Vec2::ZERO; 3])), normals, colors };
            add_triangle(points, material.number, attributes, builder)?;
        }
        Ok(())
    }
}
