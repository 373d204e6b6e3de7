//! A mesh of polygons, as OBJ and PLY files hold it, and the way of a model's triangles into the scene.
//!
//! For: [`Mesh`], [`Placement`], [`Tally`], [`Unusable`].

use super::builder::{Attributes, SceneBuilder};
use super::check::fits;
use super::error::SceneError;
use glam::{DMat3, DVec3, Vec2, Vec3};
use octray_engine::math::portable;
use std::path::Path;

/// The index of something missing.
pub const NONE: u32 = u32::MAX;

/// The content of a model's file, indices checked.
#[derive(Default)]
pub struct Mesh {
    pub positions: Vec<DVec3>,
    /// Of unit length, or zero where the file has no direction.
    pub normals: Vec<Vec3>,
    /// v upwards.
    pub uvs: Vec<Vec2>,
    /// Of the positions, linear, in [0, 1]; empty if the file has none.
    pub colors: Vec<Vec3>,
    /// The corners of all faces, one face after the other.
    pub corners: Vec<Corner>,
    pub faces: Vec<Face>,
}

/// Indices from 0. What its mesh does not hold is missing.
#[derive(Clone, Copy)]
pub struct Corner {
    pub position: u32,
    pub uv: u32,
    pub normal: u32,
}

pub struct Face {
    /// Where it ends in the mesh's corners.
    pub end: usize,
    /// Index into the model's own materials.
    pub material: u32,
}

impl Mesh {
    /// Adds the mesh's triangles to the builder, with `material` or else with its `own` materials and
    /// colours. Polygons become fans around their first corner.
    pub fn add(
        &self,
        path: &Path,
        builder: &mut SceneBuilder,
        material: Option<u32>,
        own: &[Option<u32>],
        placement: &Placement,
    ) -> Result<(), Unusable> {
        let triangles = self.fans().map(|(_, corners)| corners.len().saturating_sub(2)).sum();
        builder.check_room(triangles).map_err(|error| error.in_file(path))?;
        let mut tally = Tally::default();
        for (face, corners) in self.fans() {
            let number = material.or_else(|| *own.get(face.material as usize)?);
            let number = number.unwrap_or_else(|| builder.default_material());
            for i in 1..corners.len().saturating_sub(1) {
                let fan = [corners[0], corners[i], corners[i + 1]];
                let points = fan.map(|corner| placement.point(self.positions[corner.position as usize]));
                let normals = all(&self.normals, fan.map(|corner| corner.normal));
                let rotated = |normal: Vec3| (placement.rotation * normal.as_dvec3()).as_vec3();
                let attributes = Attributes {
                    uvs: all(&self.uvs, fan.map(|corner| corner.uv)),
                    normals: normals.map(|normals| normals.map(rotated)),
                    colors: all(&self.colors, fan.map(|corner| corner.position))
                        .filter(|_| material.is_none()),
                };
                tally.add(points, number, attributes, builder)?;
            }
        }
        tally.finish(path, builder)
    }

    /// The faces and their corners.
    fn fans(&self) -> impl Iterator<Item = (&Face, &[Corner])> {
        let starts = std::iter::once(0).chain(self.faces.iter().map(|face| face.end));
        self.faces.iter().zip(starts).map(|(face, start)| (face, &self.corners[start..face.end]))
    }
}

/// What three corners have; `None` if one has it not.
fn all<T: Copy>(list: &[T], indices: [u32; 3]) -> Option<[T; 3]> {
    let [a, b, c] = indices.map(|index| list.get(index as usize).copied());
    Some([a?, b?, c?])
}

/// Why a model cannot be used.
pub enum Unusable {
    /// One of its files cannot be read.
    Broken(SceneError),
    /// This point lies beyond the bounds of a scene, where it is placed.
    TooFar(DVec3),
    /// No triangle has an area in single precision, where it is placed.
    NoArea,
}

impl From<SceneError> for Unusable {
    fn from(error: SceneError) -> Self {
        Self::Broken(error)
    }
}

/// Counts a model's triangles as they enter the builder.
#[derive(Default)]
pub struct Tally {
    with_area: usize,
    without_area: usize,
}

impl Tally {
    /// Adds a triangle. It is flat where one of its normals has no direction.
    pub fn add(
        &mut self,
        points: [DVec3; 3],
        material: u32,
        attributes: Attributes,
        builder: &mut SceneBuilder,
    ) -> Result<(), Unusable> {
        if let Some(&outside) = points.iter().find(|point| !point.to_array().into_iter().all(fits)) {
            return Err(Unusable::TooFar(outside));
        }
        let normals = attributes.normals.filter(|normals| !normals.contains(&Vec3::ZERO));
        match builder.add_triangle(points.map(DVec3::as_vec3), material, Attributes { normals, ..attributes })
        {
            true => self.with_area += 1,
            false => self.without_area += 1,
        }
        Ok(())
    }
    /// Warns of triangles without area.
    pub fn finish(self, path: &Path, builder: &mut SceneBuilder) -> Result<(), Unusable> {
        let Self { with_area, without_area } = self;
        if with_area == 0 {
            return Err(Unusable::NoArea);
        }
        if without_area > 0 {
            let (noun, verb) = if without_area == 1 { ("triangle", "was") } else { ("triangles", "were") };
            builder.warn(format!("{}: {without_area} {noun} of zero area {verb} left out.", path.display()));
        }
        Ok(())
    }
}

/// A mesh's transformation: scaled, then rotated, then translated.
pub struct Placement {
    pub rotation: DMat3,
    pub scale: f64,
    pub translate: DVec3,
}

impl Placement {
    /// The model's own coordinates.
    pub const IDENTITY: Self = Self { rotation: DMat3::IDENTITY, scale: 1.0, translate: DVec3::ZERO };

    /// Rotates about the x axis, then the y axis, then the z axis, in degrees; counterclockwise seen from the
    /// axis' tip.
    pub fn new(scale: f64, [x, y, z]: [f64; 3], translate: DVec3) -> Self {
        let sin_cos = |degrees: f64| {
            // Right angles are exact: a mesh rotated by 90° keeps its flat faces flat.
            match degrees.rem_euclid(360.0) {
                0.0 => (0.0, 1.0),
                90.0 => (1.0, 0.0),
                180.0 => (0.0, -1.0),
                270.0 => (-1.0, 0.0),
                _ => portable::sin_cos(degrees.to_radians()),
            }
        };
        let ((sx, cx), (sy, cy), (sz, cz)) = (sin_cos(x), sin_cos(y), sin_cos(z));
        let about_x = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
        let about_y = DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
        let about_z = DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
        Self { rotation: about_z * about_y * about_x, scale, translate }
    }

    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * (p * self.scale) + self.translate
    }
}
