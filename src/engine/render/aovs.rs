//! Renders AOVs and heat maps: feature buffers of the scene, traversal cost, and path lengths, by pixel.

use super::Renderer;
use crate::camera::Tile;
use crate::integrate::aovs::{self, Aovs};
use crate::integrate::edge_aovs::{self, DenoiserAovs};
use crate::integrate::meter::PathShape;
use crate::integrate::{Scratch, cost};
use rayon::prelude::*;
use std::sync::Mutex;

pub use crate::film::Map;
pub use crate::integrate::cost::Cost;

impl Renderer {
    /// Computes the AOVs of the surface at the centre of every pixel.
    pub fn aovs_into(&self, aovs: &mut Aovs) {
        aovs.resize(self.settings.resolution);
        let (length, rows) = aovs.rows();
        self.each_row(rows, length, |y, row, scratch| aovs::render_row(&self.context, y, row, scratch));
    }

    /// Computes the denoiser's AOVs; `first` are those of [`Renderer::aovs_into`] for the same camera.
    ///
    /// # Panics
    /// If `first` has another resolution.
    pub fn denoiser_aovs_into(&self, first: &Aovs, aovs: &mut DenoiserAovs) {
        assert_eq!(first.resolution(), self.settings.resolution, "AOVs of another resolution");
        let DenoiserAovs { centers, edges } = aovs;
        centers.copy_from(first);
        let (length, rows) = centers.rows();
        self.each_row(rows, length, |y, row, scratch| {
            edge_aovs::follow_row(&self.context, y, row, scratch);
        });
        edges.resize_with(self.settings.resolution[1] as usize, Vec::new);
        self.each_row(edges, 1, |y, edges, scratch| {
            edge_aovs::edge_row(&self.context, centers, y, &mut edges[0], scratch);
        });
    }

    /// Computes the traversal cost of the ray through the centre of each pixel, traced by itself.
    pub fn costs_into(&self, costs: &mut Map<Cost>) {
        costs.resize(self.settings.resolution);
        let width = costs.width as usize;
        self.each_row(&mut costs.pixels, width, |y, row, scratch| {
            cost::render_row(&self.context, self.settings.tile_size, y, row, scratch);
        });
    }

    /// Calls `row` for every `length` values, with the row's number from the top and a thread's scratch
    /// memory.
    fn each_row<T: Send>(
        &self,
        values: &mut [T],
        length: usize,
        row: impl Fn(u32, &mut [T], &mut Scratch) + Sync,
    ) {
        let row = |(y, values): (usize, &mut [T])| row(y as u32, values, &mut self.threads.local());
        match self.threads.is_single() {
            true => values.chunks_mut(length).enumerate().for_each(row),
            false => self.threads.run(|| values.par_chunks_mut(length).enumerate().for_each(row)),
        }
    }

    /// Computes the path lengths of one sample, traced in packets of [`super::Settings::lanes`], each tile
    /// alone: frames have fuller packets after two bounces, because tiles continue together.
    pub fn path_shapes_into(&self, sample: u32, shapes: &mut Map<PathShape>) {
        shapes.resize(self.settings.resolution);
        let width = shapes.width as usize;
        let shapes = Mutex::new(shapes);
        let trace = |tile: Tile| {
            let mut scratch = self.threads.local();
            scratch.observer.start_probe();
            (self.pipeline)(&self.context, &[tile], sample, &mut scratch);
            scratch.observer.begin(None);
            let probe = scratch.observer.end_probe();
            let mut shapes = shapes.lock().expect("no thread panicked while it copied");
            for ([x, y], path) in tile.places().zip(&probe.paths) {
                shapes.pixels[y as usize * width + x as usize] = *path;
            }
        };
        let tiles = Tile::cover(self.settings.resolution, self.settings.tile_size);
        match self.threads.is_single() {
            true => tiles.for_each(trace),
            false => self.threads.run(|| tiles.par_bridge().for_each(trace)),
        }
    }
}
