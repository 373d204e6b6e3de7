//! Renders AOVs and heat maps: feature buffers of the scene, traversal cost, and path lengths, by pixel.

use super::Renderer;
use crate::camera::{PreparedCamera, Tile};
use crate::film::Film;
use crate::integrate::aovs::{self, Aovs, Plane};
use crate::integrate::edge_aovs::{self, DenoiserAovs, EdgePixel, EdgeSample};
use crate::integrate::meter::PathShape;
use crate::integrate::{Scratch, cost};
use crate::math::MISS;
use crate::scene::Scene;
use rayon::prelude::*;
use std::sync::Mutex;

pub use crate::film::Map;
pub use crate::integrate::cost::Cost;

/// The values of a channel, a pixel each, row by row from the top.
pub enum ChannelValues {
    /// Numbers.
    Numbers(Vec<f32>),
    /// Counts, or indices; `u32::MAX` means nothing.
    Indices(Vec<u32>),
}

impl Renderer {
    /// Returns a film and the AOVs of its camera as channels named `layer.channel`, for other programs. The
    /// AOVs are those of [`Renderer::aovs_into`] and [`Renderer::denoiser_aovs_into`].
    ///
    /// | channels | what |
    /// |---|---|
    /// | `R`, `G`, `B` | the film |
    /// | `albedo.R` to `.B`, `normal.X` to `.Z` | the denoiser's (`guides`): in mirrors and through glass, those of what is seen there; at edges the means of several points; out of focus a white albedo |
    /// | `depth.Z`, `position.X` to `.Z` | at the pixel's centre: distance from the camera, and the point in the file's coordinates; infinite, and NaN, where nothing is seen |
    /// | `material.ID`, `object.ID` | at the pixel's centre: the material's index, and one number for each sphere and for all triangles of a material |
    /// | `samples.N` | the number of samples |
    pub fn channels(
        &self,
        scene: &Scene,
        film: &Film,
        (aovs, guides): &(Aovs, DenoiserAovs),
    ) -> Vec<(String, ChannelValues)> {
        let mut channels = Vec::new();
        let [width, height] = film.resolution();
        let (picture, counts) = (film.picture(), film.counts());
        let mut add = |name: &str, values| channels.push((name.to_string(), values));
        for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
            add(name, ChannelValues::Numbers(picture.pixels.iter().map(|pixel| pixel[channel]).collect()));
        }
        let of_guides = |plane: Plane, mean: &dyn Fn(&EdgeSample) -> f32| {
            let row = |y: u32| {
                let mut row = guides.centers().row(plane, y).to_vec();
                for edge in guides.edges(y) {
                    let sum: f32 = edge.samples.iter().map(mean).sum();
                    row[edge.x as usize] = sum / edge.samples.len() as f32;
                }
                // The albedo of a surface that glows is its radiance.
                row.iter_mut().for_each(|value| *value = value.min(1.0));
                row
            };
            ChannelValues::Numbers((0..height).flat_map(row).collect())
        };
        let albedo = [Plane::AlbedoRed, Plane::AlbedoGreen, Plane::AlbedoBlue];
        for (channel, name) in ["albedo.R", "albedo.G", "albedo.B"].into_iter().enumerate() {
            add(name, of_guides(albedo[channel], &|sample| sample.albedo[channel]));
        }
        let normal = [Plane::NormalX, Plane::NormalY, Plane::NormalZ];
        for (axis, name) in ["normal.X", "normal.Y", "normal.Z"].into_iter().enumerate() {
            add(name, of_guides(normal[axis], &|sample| sample.normal[axis]));
        }
        let pixels = || (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]));
        let point = |[x, y]: [u32; 2]| {
            let ray = self.context.camera.rays::<f32>(x as f32 + 0.5, y as f32 + 0.5);
            let along = ray.direction.get(0).as_dvec3() * f64::from(aovs.pixel(x, y).distance);
            let point = scene.coordinates.to_file(ray.origin.get(0).as_dvec3() + along);
            if point.is_finite() { point.as_vec3() } else { glam::Vec3::NAN }
        };
        let unit = scene.coordinates.unit as f32;
        let distances = pixels().map(|[x, y]| aovs.pixel(x, y).distance * unit);
        add("depth.Z", ChannelValues::Numbers(distances.collect()));
        let points: Vec<glam::Vec3> = pixels().map(point).collect();
        for (axis, name) in ["position.X", "position.Y", "position.Z"].into_iter().enumerate() {
            add(name, ChannelValues::Numbers(points.iter().map(|point| point[axis]).collect()));
        }
        let objects: Vec<u32> = (0..height).flat_map(|y| aovs.objects(y)).copied().collect();
        let material = |&object: &u32| match object {
            MISS => MISS,
            object => self.context.primitives.material_of_object(scene, object),
        };
        add("material.ID", ChannelValues::Indices(objects.iter().map(material).collect()));
        add("object.ID", ChannelValues::Indices(objects));
        add("samples.N", ChannelValues::Indices(counts.pixels.iter().map(|pixel| pixel[0] as u32).collect()));
        channels
    }

    /// Returns the AOVs, and those of the denoiser.
    pub fn aovs(&self) -> (Aovs, DenoiserAovs) {
        let (mut first, mut guides) = (Aovs::default(), DenoiserAovs::default());
        self.aovs_into(&mut first);
        self.denoiser_aovs_into(&first, &mut guides);
        (first, guides)
    }

    /// Computes the AOVs of the surface at the centre of every pixel.
    pub fn aovs_into(&self, aovs: &mut Aovs) {
        aovs.resize(self.settings.resolution);
        let (length, rows) = aovs.rows();
        self.each_row(rows, length, |y, row, scratch| aovs::render_row(&self.context, y, row, scratch));
    }

    /// Computes the denoiser's AOVs, through the middle of the lens; `first` are those of
    /// [`Renderer::aovs_into`] for the same camera.
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
        whiten_unfocused(&self.context.camera, aovs);
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

/// The diameters in pixels of the circles of confusion at which surfaces begin and end to lose their albedo.
const BLUR: [f32; 2] = [1.0, 9.0];

/// Turns the albedo of pixels white, gradually, and their radiance unknown, if they are out of focus: the
/// picture shows means over the lens, and the denoiser would draw the sharp texture over them.
fn whiten_unfocused(camera: &PreparedCamera, aovs: &mut DenoiserAovs) {
    if !camera.has_lens() {
        return;
    }
    let DenoiserAovs { centers, edges } = aovs;
    for (edges, y) in edges.iter_mut().zip(0..) {
        let share = |&t: &f32| ((camera.blur_at(t) - BLUR[0]) / (BLUR[1] - BLUR[0])).clamp(0.0, 1.0);
        let shares: Vec<f32> = centers.row(Plane::Distance, y).iter().map(share).collect();
        for plane in [Plane::AlbedoRed, Plane::AlbedoGreen, Plane::AlbedoBlue, Plane::Scale] {
            for (value, &share) in centers.row_mut(plane, y).iter_mut().zip(&shares) {
                match plane {
                    Plane::Scale if share > 0.0 => *value = value.min(0.0),
                    Plane::Scale => {}
                    _ => *value += (1.0 - *value) * share,
                }
            }
        }
        for EdgePixel { x, samples } in edges {
            for sample in samples {
                sample.albedo = sample.albedo.map(|value| value + (1.0 - value) * shares[*x as usize]);
                sample.emits &= shares[*x as usize] == 0.0;
            }
        }
    }
}
