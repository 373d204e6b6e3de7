//! Small scenes, filled in by hand, and a generator of random numbers for tests.

use glam::{Vec2, Vec3};
use octray::reference::PathSettings;
use octray::scene::{
    Camera, Filter, Material, MaterialKind, Scene, Side, Sky, Sphere, Texels, Texture, Triangle,
};

/// Nothing under a white sky, seen from (0, 0, 5) along −z through so narrow a lens that all rays are one.
pub fn empty() -> Scene {
    Scene {
        name: "test".into(),
        camera: Camera { position: Vec3::Z * 5.0, look_at: Vec3::ZERO, up: Vec3::Y, vertical_fov: 1e-6 },
        resolution: [1, 1],
        max_bounces: 4,
        sky: Sky::Color(Vec3::ONE),
        materials: Vec::new(),
        textures: Vec::new(),
        spheres: Vec::new(),
        triangles: Vec::new(),
        uvs: Vec::new(),
        normals: Vec::new(),
        warnings: Vec::new(),
    }
}

pub fn one_pixel(max_bounces: u32) -> PathSettings {
    PathSettings { resolution: [1, 1], max_bounces, seed: 7 }
}

pub fn material(kind: MaterialKind) -> Material {
    Material { name: "m".into(), kind, color: Vec3::ONE, texture: None, emission: Vec3::ZERO }
}

pub fn lamp(radiance: Vec3) -> Material {
    Material { color: Vec3::ZERO, emission: radiance, ..material(MaterialKind::Emitter) }
}

pub fn sphere(center: Vec3, radius: f32) -> Sphere {
    Sphere { center, radius, material: 0, turn: 0.0, picture_from: Side::Outside }
}

pub fn triangle(vertices: [Vec3; 3]) -> Triangle {
    Triangle { vertices, material: 0 }
}

/// A unit sphere at the origin.
pub fn ball(kind: MaterialKind) -> Scene {
    Scene { materials: vec![material(kind)], spheres: vec![sphere(Vec3::ZERO, 1.0)], ..empty() }
}

/// A triangle in the plane z = 0, large enough to fill the view.
pub fn wall(kind: MaterialKind) -> Scene {
    let vertices = [Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, -9.0, 0.0), Vec3::new(0.0, 18.0, 0.0)];
    Scene {
        materials: vec![material(kind)],
        triangles: vec![triangle(vertices)],
        uvs: vec![[Vec2::ZERO; 3]],
        ..empty()
    }
}

/// Texel (column, row) is (column, row, 1).
pub fn numbered(width: u32, height: u32, filter: Filter) -> Texture {
    let texel = |i: u32| [(i % width) as f32, (i / width) as f32, 1.0, 0.0];
    Texture {
        name: "numbered".into(),
        width,
        height,
        filter,
        texels: Texels::Linear((0..width * height).map(texel).collect()),
    }
}

/// xorshift64*: unrelated to the numbers under test.
pub struct Dice(pub u64);

impl Dice {
    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }
    /// Uniform in [−1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.signed() as f32, self.signed() as f32, self.signed() as f32);
            if v.length_squared() <= 1.0 && v.length_squared() > 1e-4 {
                return v.normalize();
            }
        }
    }
    /// From `low` to `high`, uniform in the logarithm.
    pub fn scale(&mut self, low: f64, high: f64) -> f32 {
        (low * (high / low).powf(self.unit())) as f32
    }
}
