//! Small scenes that one ray is enough for.

use crate::common::{self, *};

/// Nothing under a white sky, seen from (0, 0, 5) along −z through so narrow a lens that all rays are one.
pub fn empty() -> Scene {
    let scene = common::empty();
    Scene { camera: Camera { vertical_fov: 1e-6, ..scene.camera }, resolution: [1, 1], ..scene }
}

pub fn one_pixel(max_bounces: u32) -> PathSettings {
    PathSettings { resolution: [1, 1], max_bounces, seed: 7, sampler: Default::default() }
}

/// A unit sphere at the origin.
pub fn ball(kind: MaterialKind) -> Scene {
    Scene { materials: vec![material(kind)], spheres: vec![sphere(Vec3::ZERO, 1.0, 0)], ..empty() }
}

/// A triangle in the plane z = 0, large enough to fill the view.
pub fn wall(kind: MaterialKind) -> Scene {
    let vertices = [vec3(-9.0, -9.0, 0.0), vec3(9.0, -9.0, 0.0), vec3(0.0, 18.0, 0.0)];
    Scene {
        materials: vec![material(kind)],
        triangles: vec![triangle(vertices, 0)],
        uvs: vec![[Vec2::ZERO; 3]],
        ..empty()
    }
}

/// Texel (column, row) is (column, row, 1).
pub fn numbered(width: u32, height: u32, filter: Filter) -> Texture {
    let texel = |i: u32| [(i % width) as f32, (i / width) as f32, 1.0, 0.0];
    texture([width, height], filter, Texels::Float32((0..width * height).map(texel).collect()))
}
