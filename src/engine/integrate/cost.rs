//! Measures the traversal cost of primary rays, for the heat maps of the viewer.

use super::context::TraceContext;
use super::generate::pixel_centers;
use super::scratch::Scratch;
use crate::camera::MAX_PIXELS;
use crate::rays::Counts;

/// The intersection tests of one ray, traced by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// The number of boxes tested.
    pub boxes: u32,
    /// The number of spheres and triangles tested.
    pub primitives: u32,
}

impl From<Counts> for Cost {
    fn from(counts: Counts) -> Self {
        Self { boxes: counts.boxes.tests as u32, primitives: counts.primitives() as u32 }
    }
}

/// Fills a row with the costs of the rays through the pixels' centres.
pub(crate) fn render_row(
    context: &TraceContext,
    tile_size: [u32; 2],
    y: u32,
    row: &mut [Cost],
    scratch: &mut Scratch,
) {
    let tiles_across = row.len().div_ceil(tile_size[0] as usize);
    let first = (y / tile_size[1]) as usize * tiles_across;
    for (part, pixels) in row.chunks_mut(MAX_PIXELS).enumerate() {
        pixel_centers(context, [(part * MAX_PIXELS) as u32, y], pixels.len(), scratch);
        scratch.tracer.start_counting();
        for (at, cost) in pixels.iter_mut().enumerate() {
            let x = part * MAX_PIXELS + at;
            let visible = context.visible.get(first + x / tile_size[0] as usize);
            let (rays, mut hits) = scratch.queue.queries(at..at + 1, context.camera.common_origin());
            scratch.tracer.closest_one_by_one(&context.structure, &rays.among(visible), &mut hits);
            *cost = scratch.tracer.take_counts().into();
        }
        scratch.tracer.stop_counting();
    }
}
