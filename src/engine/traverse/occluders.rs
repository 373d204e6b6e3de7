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
use glam::DVec3;

/// How far beyond a plane or sphere a surface may reach that counts as on its near side, as a multiple of the
/// largest coordinate, of a light its own: what rounding of a wall's vertices does to its plane. Rays leave
/// surfaces four times as far above them ([`crate::kernel::surface::triangle_offset`]).
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
        let (mut list, surfaces) = (PrimitiveList::default(), Surfaces::of(scene, lights));
        let may_occlude = |number: usize, primitive: Primitive| surfaces.may_occlude(number, primitive);
        list.keep(scene, may_occlude);
        let count = list.quadrics.len() + list.triangles.len();
        (count < scene.primitives()).then(|| {
            let hierarchy = hierarchy.map(|(all, traversal)| {
                // Hits are clamped to padded boxes: the padding of the whole scene gives the same bits.
                let mut listed = Hierarchy::new(&scene.only(may_occlude), traversal.trees());
                listed.padding = all.padding;
                listed
            });
            Self { list, hierarchy }
        })
    }
}

/// Points and spheres between which shadow rays run.
struct Surfaces {
    /// Centre and radius: of spheres, and 0 of a triangle's vertices. Whether it is of a light.
    balls: Vec<(DVec3, f64, bool)>,
    /// The sphere that is the only light.
    only_light: Option<usize>,
    /// The largest coordinate.
    largest: f64,
}

impl Surfaces {
    fn of(scene: &Scene, lights: &Lights) -> Self {
        let is_light = |number: usize| lights.probabilities[number] > 0.0;
        let mut balls = Vec::new();
        for (number, primitive) in scene.all_primitives().enumerate() {
            balls.extend(primitive.balls().map(|(center, radius)| (center, radius, is_light(number))));
        }
        let largest = balls.iter().map(|(center, radius, _)| center.abs().max_element() + radius);
        Self {
            only_light: (0..scene.spheres.len()).find(|&number| lights.len() == 1 && is_light(number)),
            largest: largest.fold(0.0, f64::max),
            balls,
        }
    }

    /// [`TOLERANCE`] in units of the scene.
    fn tolerance(&self, (center, radius, is_light): (DVec3, f64, bool)) -> f64 {
        TOLERANCE * if is_light { center.abs().max_element() + radius } else { self.largest }
    }

    /// Whether a primitive may come between a surface and a light.
    fn may_occlude(&self, number: usize, primitive: Primitive) -> bool {
        match primitive {
            Primitive::Sphere(sphere) if self.only_light == Some(number) || self.are_inside(sphere) => false,
            Primitive::Triangle(triangle) => self.may_separate(triangle),
            _ => true,
        }
    }

    /// Whether a sphere has all surfaces inside: it is convex, so that no ray between them leaves it.
    fn are_inside(&self, sphere: &Sphere) -> bool {
        let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        self.balls.iter().all(|&ball| ball.0.distance(center) + ball.1 <= radius + self.tolerance(ball))
    }

    /// Whether some surface and some light lie on different sides of a triangle's plane.
    fn may_separate(&self, triangle: &Triangle) -> bool {
        let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
        let normal = (b - a).cross(c - a).normalize();
        // By side: whether any surface reaches there, and any light.
        let (mut surfaces, mut lights) = ([false; 2], [false; 2]);
        for &ball in &self.balls {
            let ((center, radius, is_light), tolerance) = (ball, self.tolerance(ball));
            let distance = normal.dot(center - a);
            for (side, reach) in [radius - distance, radius + distance].into_iter().enumerate() {
                let reaches = reach > tolerance;
                surfaces[side] |= reaches;
                lights[side] |= reaches && is_light;
            }
        }
        surfaces[0] && lights[1] || surfaces[1] && lights[0]
    }
}
