//! The primitives that can occlude a light.
//!
//! Shadow rays run from surfaces to lights. A triangle's plane with all surfaces on one side, such as a
//! room's wall, comes between no two points of them; nor does one that holds all lights, nor a sphere with
//! everything inside. In rooms with few other surfaces that leaves few tests.

use super::hierarchy::Hierarchy;
use super::methods::{MAX_LIST_COST, list_cost};
use super::primitive_list::PrimitiveList;
use super::tree::Traversal;
use crate::buffers::Lights;
use crate::scene::{Primitive, Scene, Sphere, Triangle};
use glam::{DVec3, Vec3};

/// How far beyond a plane or sphere a surface may reach that counts as on its near side, as a multiple of the
/// largest coordinate: what rounding of a wall's vertices does to its plane. Rays leave surfaces four times
/// as far above them ([`crate::kernel::surface::triangle_offset`]).
const TOLERANCE: f64 = 4.0 * (f32::EPSILON / 2.0) as f64;

/// The primitives that can occlude a light, where some cannot.
///
/// Every traversal leaves out the others: a ray that starts a rounding error behind a wall, as some do in
/// corners, would hit it and must not in one traversal alone.
pub struct Occluders {
    /// For linear traversal.
    pub list: PrimitiveList,
    /// For the others.
    pub hierarchy: Option<Hierarchy>,
}

impl Occluders {
    /// Those of a scene, which may have a `hierarchy`; `None` if every primitive may occlude a light.
    ///
    /// Found only where testing all would be fast, up to [`MAX_LIST_COST`], which bounds the time for it,
    /// too. Not where the sky is a light, which lies behind all walls, nor with vertex normals, where rays
    /// start above the triangles.
    pub fn of(scene: &Scene, lights: &Lights, hierarchy: Option<(&Hierarchy, Traversal)>) -> Option<Self> {
        let has_normals = !scene.normals.is_empty();
        if lights.is_empty() || lights.sky.is_some() || has_normals || list_cost(scene) > MAX_LIST_COST {
            return None;
        }
        let list = Surfaces::of(scene, lights).occluders(scene);
        let count = list.spheres.len() + list.triangles.len();
        (count < scene.primitives()).then(|| {
            let hierarchy = hierarchy.map(|(all, traversal)| {
                // Hits are clamped to padded boxes: the padding of the whole scene gives the same bits.
                let mut listed = Hierarchy::new(&with_primitives(scene, &list), traversal.trees());
                listed.padding = all.padding;
                listed
            });
            Self { list, hierarchy }
        })
    }
}

/// A scene of the listed primitives alone, without what they look like.
fn with_primitives(scene: &Scene, list: &PrimitiveList) -> Scene {
    Scene {
        spheres: list.spheres.iter().map(|&index| scene.spheres[index as usize]).collect(),
        triangles: list.triangles.iter().map(|&index| scene.triangles[index as usize]).collect(),
        name: scene.name.clone(),
        materials: scene.materials.clone(),
        camera: scene.camera,
        resolution: scene.resolution,
        max_bounces: scene.max_bounces,
        sky: scene.sky,
        textures: Vec::new(),
        uvs: Vec::new(),
        normals: Vec::new(),
        warnings: Vec::new(),
        files: Vec::new(),
    }
}

/// Points and spheres between which shadow rays run.
struct Surfaces {
    /// Centre and radius: of spheres, and 0 of a triangle's vertices. Whether it is of a light.
    balls: Vec<(DVec3, f64, bool)>,
    /// The sphere that is the only light.
    only_light: Option<usize>,
    /// [`TOLERANCE`] in units of the scene.
    tolerance: f64,
}

impl Surfaces {
    fn of(scene: &Scene, lights: &Lights) -> Self {
        let is_light = |number: usize| lights.probabilities[number] > 0.0;
        let mut balls = Vec::new();
        for number in 0..scene.primitives() {
            let mut add = |center: Vec3, radius: f32| {
                balls.push((center.as_dvec3(), f64::from(radius), is_light(number)));
            };
            match scene.primitive(number) {
                Primitive::Sphere(&Sphere { center, radius, .. }) => add(center, radius),
                Primitive::Triangle(triangle, _) => triangle.vertices.iter().for_each(|&v| add(v, 0.0)),
            }
        }
        let largest = balls.iter().map(|(center, radius, _)| center.abs().max_element() + radius);
        Self {
            only_light: (0..scene.spheres.len()).find(|&number| lights.len() == 1 && is_light(number)),
            tolerance: TOLERANCE * largest.fold(0.0, f64::max),
            balls,
        }
    }

    fn occluders(&self, scene: &Scene) -> PrimitiveList {
        let spheres = (0u32..)
            .zip(&scene.spheres)
            .filter(|(index, sphere)| self.only_light != Some(*index as usize) && !self.are_inside(sphere));
        let triangles = (0u32..).zip(&scene.triangles).filter(|(_, triangle)| self.may_separate(triangle));
        PrimitiveList {
            spheres: spheres.map(|(index, _)| index).collect(),
            triangles: triangles.map(|(index, _)| index).collect(),
        }
    }

    /// Whether a sphere has all surfaces inside: it is convex, so that no ray between them leaves it.
    fn are_inside(&self, sphere: &Sphere) -> bool {
        let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        self.balls.iter().all(|&(other, r, _)| other.distance(center) + r <= radius + self.tolerance)
    }

    /// Whether some surface and some light lie on different sides of a triangle's plane.
    fn may_separate(&self, triangle: &Triangle) -> bool {
        let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
        let normal = (b - a).cross(c - a).normalize();
        // By side: whether any surface reaches there, and any light.
        let (mut surfaces, mut lights) = ([false; 2], [false; 2]);
        for &(center, radius, is_light) in &self.balls {
            let distance = normal.dot(center - a);
            for (side, reach) in [radius - distance, radius + distance].into_iter().enumerate() {
                let reaches = reach > self.tolerance;
                surfaces[side] |= reaches;
                lights[side] |= reaches && is_light;
            }
        }
        surfaces[0] && lights[1] || surfaces[1] && lights[0]
    }
}
