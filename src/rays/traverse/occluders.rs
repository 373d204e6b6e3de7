//! Finds the primitives that can lie between surfaces and targets, such as the lights of a room.
//!
//! Segments run from surfaces to targets. A triangle whose plane has all surfaces on one side, such as a
//! room's wall, blocks no segment; nor does a triangle whose plane holds all targets, nor a sphere that has
//! everything inside. In rooms with few other surfaces, few tests remain.

use super::hierarchy::Hierarchy;
use super::structure::MAX_LIST_COST;
use crate::bvh::Trees;
use crate::kind::{Geometry, Shape};
use crate::numbering::Candidates;
use glam::DVec3;

/// How far a surface may reach beyond a plane or sphere and still count as on its near side, relative to the
/// largest coordinate (for a target, its own): rounding of vertices moves a wall's plane so far. Rays leave
/// surfaces four times as far above them ([`crate::kernel::surface::triangle_offset`]).
const TOLERANCE: f64 = 4.0 * (f32::EPSILON / 2.0) as f64;

/// The primitives that can lie between a surface and a target, in scenes where some cannot.
///
/// Every traversal skips the others: a ray that starts a rounding error behind a wall, as some do in corners,
/// would hit it, and then traversals would differ.
pub(super) struct Occluders {
    /// The occluders for a list.
    pub candidates: Candidates,
    /// The occluders for the traversals of a hierarchy.
    pub hierarchy: Option<Hierarchy>,
}

impl Occluders {
    /// Finds the occluders of a geometry, which may have a `hierarchy`; `None` if every primitive may be one.
    ///
    /// Occluders are sought only if testing all primitives would be fast, up to [`MAX_LIST_COST`], which
    /// bounds the time of the search, too.
    pub fn find(
        geometry: &Geometry,
        is_target: impl Fn(usize) -> bool,
        hierarchy: Option<(&Hierarchy, Trees)>,
    ) -> Option<Self> {
        if geometry.counts().list_cost() > MAX_LIST_COST {
            return None;
        }
        let (mut candidates, surfaces) = (Candidates::default(), Surfaces::new(geometry, is_target));
        let may_occlude = |number: usize, shape: Shape| surfaces.may_occlude(number, shape);
        geometry.find_candidates(&mut candidates, may_occlude);
        (candidates.len() < geometry.len()).then(|| {
            let hierarchy = hierarchy.map(|(all, trees)| {
                // Hits are clamped to padded boxes: the padding of the whole scene gives the same bits.
                let mut kept = Hierarchy::new(&geometry.only(may_occlude), trees);
                kept.padding = all.padding;
                kept
            });
            Self { candidates, hierarchy }
        })
    }
}

/// The points and spheres between which segments run.
struct Surfaces {
    /// Centre and radius (0 for a triangle's vertices), and whether the ball belongs to a target.
    balls: Vec<(DVec3, f64, bool)>,
    /// The number of the only target, unless it is flat.
    only_target: Option<usize>,
    /// The largest coordinate.
    largest: f64,
}

impl Surfaces {
    fn new(geometry: &Geometry, is_target: impl Fn(usize) -> bool) -> Self {
        let mut balls = Vec::new();
        for (number, shape) in geometry.shapes().enumerate() {
            balls.extend(shape.balls().map(|(center, radius)| (center, radius, is_target(number))));
        }
        let largest = balls.iter().map(|(center, radius, _)| center.abs().max_element() + radius);
        let mut targets = (0..geometry.len()).filter(|&number| is_target(number));
        let only = targets.next().filter(|_| targets.next().is_none());
        Self {
            only_target: only.filter(|&number| geometry.shape(number).plane().is_none()),
            largest: largest.fold(0.0, f64::max),
            balls,
        }
    }

    /// Returns [`TOLERANCE`] in units of the scene.
    fn tolerance(&self, (center, radius, is_target): (DVec3, f64, bool)) -> f64 {
        TOLERANCE * if is_target { center.abs().max_element() + radius } else { self.largest }
    }

    /// Returns whether a primitive may come between a surface and a target.
    fn may_occlude(&self, number: usize, shape: Shape) -> bool {
        match shape.plane() {
            Some(plane) => self.may_separate(plane),
            None => self.only_target != Some(number) && !shape.balls().all(|ball| self.are_inside(ball)),
        }
    }

    /// Tests whether a ball has all surfaces inside: it is convex, so no ray between them leaves it.
    fn are_inside(&self, (center, radius): (DVec3, f64)) -> bool {
        self.balls.iter().all(|&ball| ball.0.distance(center) + ball.1 <= radius + self.tolerance(ball))
    }

    /// Returns whether some surface and some target lie on different sides of a plane, given by a
    /// point and the unit normal.
    fn may_separate(&self, (point, normal): (DVec3, DVec3)) -> bool {
        // For each side: whether any surface reaches it, and whether any target does.
        let (mut surfaces, mut targets) = ([false; 2], [false; 2]);
        for &ball in &self.balls {
            let ((center, radius, is_target), tolerance) = (ball, self.tolerance(ball));
            let distance = normal.dot(center - point);
            for (side, reach) in [radius - distance, radius + distance].into_iter().enumerate() {
                let reaches = reach > tolerance;
                surfaces[side] |= reaches;
                targets[side] |= reaches && is_target;
            }
        }
        surfaces[0] && targets[1] || surfaces[1] && targets[0]
    }
}
