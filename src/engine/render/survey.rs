//! What pixels see and what they take, besides light: for filters, views of the scene, and heat maps.

use super::Renderer;
use crate::integrate::guides::{self, Aovs};
use crate::integrate::queue::{PathShape, Work};
use crate::camera::Tile;
use crate::integrate::cost;
use rayon::prelude::*;
use std::sync::Mutex;

pub use crate::integrate::cost::Cost;

/// A number or a few for each pixel, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map<T> {
    pub width: u32,
    pub height: u32,
    /// `width · height` of them.
    pub pixels: Vec<T>,
}

impl<T: Clone + Default> Map<T> {
    /// Takes memory only where the map grows. What it holds afterwards is unspecified.
    fn resize(&mut self, [width, height]: [u32; 2]) {
        (self.width, self.height) = (width, height);
        self.pixels.resize(width as usize * height as usize, T::default());
    }
}

impl Renderer {
    /// The surface under the middle of every pixel.
    pub fn guides_into(&self, guides: &mut Aovs) {
        guides.resize(self.settings.resolution);
        let (length, rows) = guides.rows();
        self.each_row(rows, length, |y, row, work| guides::look(&self.world, y, row, work));
    }

    /// What it takes to find what the ray through the middle of each pixel meets, that ray by itself.
    pub fn costs_into(&self, costs: &mut Map<Cost>) {
        costs.resize(self.settings.resolution);
        let width = costs.width as usize;
        self.each_row(&mut costs.pixels, width, |y, row, work| {
            cost::of_row(&self.world, self.settings.tile_size, y, row, work);
        });
    }

    /// Does something to every row of so many numbers, given its number from the top and a thread's working memory.
    fn each_row<T: Send>(
        &self,
        numbers: &mut [T],
        length: usize,
        row: impl Fn(u32, &mut [T], &mut Work) + Sync,
    ) {
        let row = |(y, numbers): (usize, &mut [T])| row(y as u32, numbers, &mut self.threads.own());
        match self.threads.alone() {
            true => numbers.chunks_mut(length).enumerate().for_each(row),
            false => self.threads.run(|| numbers.par_chunks_mut(length).enumerate().for_each(row)),
        }
    }

    /// How far the paths of one sample go, as packets of [`super::Settings::lanes`] trace them.
    pub fn path_shapes_into(&self, sample: u32, shapes: &mut Map<PathShape>) {
        shapes.resize(self.settings.resolution);
        let width = shapes.width as usize;
        let shapes = Mutex::new(shapes);
        let trace = |tile: Tile| {
            let mut work = self.threads.own();
            work.start_probe();
            (self.pipeline)(&self.world, tile, sample, &mut work);
            work.enter(None);
            let probe = work.end_probe();
            let mut shapes = shapes.lock().expect("no thread panicked while it copied");
            let rows = shapes.pixels.chunks_mut(width).skip(tile.y as usize);
            for (row, paths) in rows.zip(probe.paths[..tile.pixels()].chunks(tile.width as usize)) {
                row[tile.x as usize..][..paths.len()].copy_from_slice(paths);
            }
        };
        let tiles = Tile::cover(self.settings.resolution, self.settings.tile_size);
        match self.threads.alone() {
            true => tiles.for_each(trace),
            false => self.threads.run(|| tiles.par_bridge().for_each(trace)),
        }
    }
}
