//! Computes the power of emitters, by which next event estimation chooses among them.

use super::{flat, sphere};
use crate::buffers::mip_chain::halve;
use crate::rays::Kind;
use crate::scene::{Material, MaterialKind, Primitive, Scene, Sphere, Texture};
use glam::{DVec2, DVec3, Vec3};
use std::collections::{HashMap, HashSet};

/// The emission of the primitives of a scene.
pub(super) struct Emitted<'a> {
    pub(super) scene: &'a Scene,
    /// The textures that multiply emission, by index.
    textures: HashMap<u32, BlockMeans<'a>>,
}

impl<'a> Emitted<'a> {
    /// Reads the textures of all emitters.
    pub(super) fn by(scene: &'a Scene) -> Self {
        let used: HashSet<u32> = scene.all_primitives().map(|primitive| primitive.material()).collect();
        let materials = used.into_iter().map(|material| &scene.materials[material as usize]);
        let emitters = materials.filter(|material| material.emission != Vec3::ZERO);
        let used: HashSet<u32> = emitters.filter_map(emission_texture).collect();
        let means = |index| (index, BlockMeans::of(&scene.textures[index as usize]));
        Self { scene, textures: used.into_iter().map(means).collect() }
    }

    /// Returns the power that a primitive emits; 0 for a sphere around the camera, unless `surrounding` ones
    /// count.
    pub(super) fn power(&self, number: usize, surrounding: bool) -> f64 {
        let unit_power = match self.scene.primitive(number) {
            Primitive::Sphere(sphere) if !surrounding && surrounds(self.scene, sphere) => return 0.0,
            Primitive::Sphere(sphere) => sphere::unit_power(sphere),
            Primitive::Triangle(triangle) => flat::unit_power(triangle),
        };
        unit_power * self.mean_radiance(number)
    }

    /// Returns the emitted radiance of a primitive, the mean of its points and channels.
    fn mean_radiance(&self, number: usize) -> f64 {
        let material = &self.scene.materials[self.scene.primitive(number).material() as usize];
        let Some(texture) = self.texture(material) else {
            return f64::from(material.emission.element_sum()) / 3.0;
        };
        let (sum, weights) = match self.scene.primitive(number) {
            Primitive::Sphere(_) => sphere::sum_of_texels(texture),
            Primitive::Triangle(_) => {
                match self.scene.uvs.get(number - self.scene.counts().first(Kind::Triangle)) {
                    Some(uvs) => flat::sum_of_texels(texture, uvs),
                    None => return 0.0,
                }
            }
        };
        (material.emission.as_dvec3() * sum).element_sum() / (3.0 * weights)
    }

    /// Returns the texture that multiplies a material's emission.
    pub(super) fn texture(&self, material: &Material) -> Option<&BlockMeans<'a>> {
        emission_texture(material).and_then(|index| self.textures.get(&index))
    }
}

/// Tests whether the camera is within this sphere: then every ray that misses the other primitives hits it.
fn surrounds(scene: &Scene, sphere: &Sphere) -> bool {
    let to = scene.camera.position.as_dvec3() - sphere.center.as_dvec3();
    to.length() < f64::from(sphere.radius)
}

/// Returns the index of the texture that multiplies a material's emission.
fn emission_texture(material: &Material) -> Option<u32> {
    let of_emitter = material.texture.filter(|_| material.kind == MaterialKind::Emitter);
    material.emission_map.or(of_emitter)
}

/// Tests whether a texture multiplies a primitive's emission.
pub(super) fn has_texture(scene: &Scene, number: usize) -> bool {
    emission_texture(&scene.materials[scene.primitive(number).material() as usize]).is_some()
}

/// The number of points along each side of a grid over a primitive at which its texture is read, and the
/// largest multiple of it along a side that has more texels.
pub(super) const GRID: usize = 16;
const MOST_FINER: f64 = 16.0;

/// Iterates over the centres of the cells of a grid of columns and rows over the unit square.
fn grid([columns, rows]: [usize; 2]) -> impl Iterator<Item = DVec2> + Clone {
    let center = move |cell| DVec2::new((cell % columns) as f64 + 0.5, (cell / columns) as f64 + 0.5);
    (0..columns * rows).map(move |cell| center(cell) / DVec2::new(columns as f64, rows as f64))
}

/// A texture and the means of its blocks of 2, 4, 8 … texels a side: if the points that read it are farther
/// apart than texels, no bright texel is lost between them.
pub(super) struct BlockMeans<'a> {
    pub(super) texture: &'a Texture,
    levels: Vec<([u32; 2], Vec<[f32; 3]>)>,
}

impl<'a> BlockMeans<'a> {
    fn of(texture: &'a Texture) -> Self {
        let mut levels: Vec<([u32; 2], Vec<[f32; 3]>)> = Vec::new();
        for size in texture.halved_sizes() {
            let means = match levels.last() {
                None => halve([texture.width, texture.height], size, |at| texture.texels.linear(at)),
                Some((before, means)) => halve(*before, size, |at| means[at].map(f64::from)),
            };
            levels.push((size, means.into_iter().map(|mean| mean.map(|x| x as f32)).collect()));
        }
        Self { texture, levels }
    }

    /// Returns how to read a parallelogram of texture coordinates with these sides: the level whose blocks
    /// are as close as the points, and the points in the unit square, `count` along each side or more along
    /// the longer.
    pub(super) fn points(
        &self,
        sides: [DVec2; 2],
        count: usize,
    ) -> (usize, impl Iterator<Item = DVec2> + Clone + use<>) {
        let size = DVec2::new(f64::from(self.texture.width), f64::from(self.texture.height));
        let texels = sides.map(|side| side.abs() * size / count as f64);
        let steps = texels.map(|texels| texels.max_element());
        let finer = steps[0].min(steps[1]).max(1.0);
        let more = steps.map(|step| (step / finer).ceil().clamp(1.0, MOST_FINER));
        let step = (texels[0] / more[0] + texels[1] / more[1]).max_element();
        let block = (step.ceil() as u32).clamp(1, 1 << 16).next_power_of_two();
        let level = (block.ilog2() as usize).min(self.levels.len());
        (level, grid(more.map(|more| count * more as usize)))
    }

    /// Returns the mean of the block around texture coordinates; on level 0 the texel.
    pub(super) fn mean(&self, level: usize, uv: DVec2) -> DVec3 {
        let above = level.checked_sub(1).map(|above| &self.levels[above]);
        let [width, height] = above.map_or([self.texture.width, self.texture.height], |(size, _)| *size);
        let at = |x: f64, count: u32| (x.rem_euclid(1.0) * f64::from(count)) as usize % count as usize;
        let index = at(1.0 - uv.y, height) * width as usize + at(uv.x, width);
        DVec3::from_array(match above {
            None => self.texture.texels.linear(index),
            Some((_, means)) => means[index].map(f64::from),
        })
    }

    /// Returns the mix of the four texels around texture coordinates.
    pub(super) fn bilinear(&self, uv: DVec2) -> DVec3 {
        let size = DVec2::new(f64::from(self.texture.width), f64::from(self.texture.height));
        let (half, part) = (0.5 / size, (uv * size - 0.5).fract_gl());
        let at = |right: f64, up: f64| self.mean(0, uv + half * DVec2::new(right, up));
        let row = |up: f64| at(-1.0, up).lerp(at(1.0, up), part.x);
        row(-1.0).lerp(row(1.0), part.y)
    }
}
