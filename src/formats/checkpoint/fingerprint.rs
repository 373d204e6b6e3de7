//! Condenses the content of a scene to a few checksums.

use crc32fast::Hasher;
use octray_engine::scene::{Scene, Sphere, Texels, Texture, Triangle};
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// A CRC-32 of each part of a scene that changes its picture, in hexadecimal. Resolution and bounces are
/// settings. The scene's name, its files and its warnings change no picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fingerprint {
    /// Position, direction and angle of view.
    pub camera: String,
    /// The sky without its texture.
    pub sky: String,
    /// All materials, in their order.
    pub materials: String,
    /// All texels and their filters.
    pub textures: String,
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
            spheres,
            triangles,
            uvs,
            normals,
            warnings: _,
            files: _,
        } = scene;
        let mut vertices = Hasher::new();
        add_words(&mut vertices, uvs.iter().flatten().flat_map(|uv| uv.to_array()).map(f32::to_bits));
        add_words(&mut vertices, [u32::MAX].into_iter());
        let normals = normals.iter().flatten().flat_map(|normal| normal.to_array());
        add_words(&mut vertices, normals.map(f32::to_bits));
        Self {
            camera: hash_debug(camera),
            sky: hash_debug(sky),
            materials: hash_debug(materials),
            textures: hash_textures(textures),
            spheres: hash_words(spheres.iter().flat_map(sphere_words)),
            triangles: hash_words(triangles.iter().flat_map(triangle_words)),
            vertices: hexadecimal(vertices),
        }
    }
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
    for Texture { name: _, width, height, filter, texels } in textures {
        let kind = std::mem::discriminant(texels);
        hasher.update(format!("{width} {height} {filter:?} {kind:?}").as_bytes());
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;
    use glam::{Vec2, Vec3};
    use octray_engine::scene::{Filter, Side, Sky};

    #[test]
    fn each_change_of_a_scene_changes_one_checksum() {
        let mut scene = load("builtin:thesis").unwrap();
        scene.textures.truncate(1);
        for texels in [Texels::Srgb8(vec![[5; 4]]), Texels::Float32(vec![[0.5, 0.25, 0.125, 0.0]])] {
            let filter = Filter::Nearest;
            scene.textures.push(Texture { name: "t".into(), width: 1, height: 1, filter, texels });
        }
        scene.triangles = vec![Triangle { vertices: [Vec3::ZERO, Vec3::X, Vec3::Y], material: 0 }];
        (scene.uvs, scene.normals) = (vec![[Vec2::ZERO; 3]], vec![[Vec3::Z; 3]]);
        let sums = |scene: &Scene| serde_json::to_value(Fingerprint::from_scene(scene)).unwrap();
        let own = sums(&scene);
        type Change = fn(&mut Scene);
        let changes: [(Change, &str); 16] = [
            (|scene| scene.name.push('x'), ""),
            (|scene| scene.resolution[0] += 1, ""),
            (|scene| scene.camera.position.x += 1e-3, "camera"),
            (|scene| scene.sky = Sky::Color(Vec3::splat(0.123)), "sky"),
            (|scene| scene.materials[0].color.y *= 0.5, "materials"),
            (|scene| scene.textures[0].width += 1, "textures"),
            (|scene| scene.textures[1].texels = Texels::Srgb8(vec![[5, 4, 5, 5]]), "textures"),
            (|scene| scene.textures[1].filter = Filter::Bilinear, "textures"),
            (|scene| scene.textures[2].texels = Texels::Float32(vec![[0.5, 0.25, 0.25, 0.0]]), "textures"),
            (|scene| scene.spheres[0].radius *= 1.000_001, "spheres"),
            (|scene| scene.spheres[0].texture_turn += 0.5, "spheres"),
            (|scene| scene.spheres[0].texture_side = Side::Outside, "spheres"),
            (|scene| scene.spheres[0].material += 1, "spheres"),
            (|scene| scene.triangles[0].vertices[2].y = 2.0, "triangles"),
            (|scene| scene.uvs[0][1].x = 1.0, "vertices"),
            (|scene| scene.normals[0][1] = Vec3::X, "vertices"),
        ];
        for (number, (change, part)) in changes.into_iter().enumerate() {
            let mut other = scene.clone();
            change(&mut other);
            let other = sums(&other);
            let parts = own.as_object().unwrap().keys().filter(|part| own[*part] != other[*part]);
            assert_eq!(parts.cloned().collect::<Vec<_>>().join(" "), part, "change {number}");
        }
    }
}
