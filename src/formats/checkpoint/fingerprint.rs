//! Condenses the content of a scene to a few checksums.

use crc32fast::Hasher;
use octray_engine::scene::{PunctualLight, Scene, Sphere, Texels, Texture, Triangle, Wrap};
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// A CRC-32 of each part of a scene that changes its picture, in hexadecimal. Resolution and bounces are
/// settings. The scene's name, its files and its warnings change no picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fingerprint {
    /// Position, direction and angle of view.
    pub camera: String,
    /// The sky without its texture, and the portals to it.
    pub sky: String,
    /// All materials, in their order.
    pub materials: String,
    /// All texels and their filters.
    pub textures: String,
    /// All lights that are no primitives; empty without any.
    #[serde(default)]
    pub lights: String,
    /// Centres, radii, materials and turns.
    pub spheres: String,
    /// Vertices and materials of triangles.
    pub triangles: String,
    /// Texture coordinates and normals of the triangles' vertices.
    pub vertices: String,
}

impl Fingerprint {
    /// Computes the checksums of a scene. Takes about a second for a gigabyte.
    pub fn from_scene(scene: &Scene) -> Self {
        // The pattern names every field, so that a new one does not compile before it is decided whether it
        // changes the picture.
        let Scene {
            name: _,
            coordinates: _,
            unrounded: _,
            camera,
            resolution: _,
            max_bounces: _,
            sky,
            materials,
            textures,
            lights,
            spheres,
            triangles,
            portals,
            uvs,
            normals,
            warnings: _,
            files: _,
        } = scene;
        let uvs = uvs.iter().flatten().flat_map(|uv| uv.to_array()).map(f32::to_bits);
        let normals = normals.iter().flatten().flat_map(|normal| normal.to_array()).map(f32::to_bits);
        Self {
            camera: hash_debug(camera),
            // A scene without portals keeps the checksum of its sky alone.
            sky: if portals.is_empty() { hash_debug(sky) } else { hash_debug(&(sky, portals)) },
            materials: hash_debug(materials),
            textures: hash_textures(textures),
            lights: hash_lights(lights),
            spheres: hash_words(spheres.iter().flat_map(sphere_words)),
            triangles: hash_words(triangles.iter().flat_map(triangle_words)),
            vertices: hash_words(uvs.chain([u32::MAX]).chain(normals)),
        }
    }
}

fn hash_lights(lights: &[PunctualLight]) -> String {
    let shapes: Vec<_> = lights.iter().map(|light| light.shape).collect();
    if shapes.is_empty() { String::new() } else { hash_debug(&shapes) }
}

fn sphere_words(sphere: &Sphere) -> [u32; 7] {
    let Sphere { center, radius, material, texture_turn, texture_side } = *sphere;
    let [x, y, z, radius, turn] = [center.x, center.y, center.z, radius, texture_turn].map(f32::to_bits);
    [x, y, z, radius, material, turn, texture_side as u32]
}

fn triangle_words(triangle: &Triangle) -> impl Iterator<Item = u32> {
    let Triangle { vertices, material } = *triangle;
    let numbers = vertices.into_iter().flat_map(|vertex| vertex.to_array()).map(f32::to_bits);
    numbers.chain([material])
}

fn hash_textures(textures: &[Texture]) -> String {
    let mut hasher = Hasher::new();
    for Texture { name: _, width, height, filter, wrap, texels } in textures {
        let kind = std::mem::discriminant(texels);
        hasher.update(format!("{width} {height} {filter:?} {kind:?}").as_bytes());
        // Textures that repeat keep their checksums from before there were others.
        if *wrap != [Wrap::Repeat; 2] {
            hasher.update(format!(" {wrap:?}").as_bytes());
        }
        match texels {
            Texels::Srgb8(texels) | Texels::Unorm8(texels) => hasher.update(bytemuck::cast_slice(texels)),
            Texels::Float32(texels) => {
                add_words(&mut hasher, texels.iter().flatten().map(|number| number.to_bits()));
            }
        }
    }
    hexadecimal(hasher)
}

/// Hashes the text of `Debug`, which has all digits of every number.
fn hash_debug(what: &impl Debug) -> String {
    format!("{:08x}", crc32fast::hash(format!("{what:?}").as_bytes()))
}

fn hash_words(words: impl Iterator<Item = u32>) -> String {
    let mut hasher = Hasher::new();
    add_words(&mut hasher, words);
    hexadecimal(hasher)
}

fn add_words(hasher: &mut Hasher, mut words: impl Iterator<Item = u32>) {
    let mut bytes = Vec::with_capacity(1 << 12);
    loop {
        bytes.clear();
        bytes.extend(words.by_ref().take(1 << 10).flat_map(u32::to_le_bytes));
        if bytes.is_empty() {
            return;
        }
        hasher.update(&bytes);
    }
}

fn hexadecimal(hasher: Hasher) -> String {
    format!("{:08x}", hasher.finalize())
}
