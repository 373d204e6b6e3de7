//! What the law tests share: the names that nearly all of them use, random numbers, scenes filled in by hand.
#![allow(dead_code, unused_imports)] // Every test file takes its own part.

pub mod rays;
pub mod skipped;
pub mod statistics;

pub use glam::{DVec3, Vec2, Vec3, dvec3, vec2, vec3};
pub use octray::buffers::Features;
pub use octray::film::{Film, Picture};
pub use octray::lane::{Bits, F32x8, F32x16, Lane, Mask, NATIVE_WIDTH, WIDTHS};
pub use octray::lights::{LightChoice, Lights};
pub use octray::math::{self, MISS, Ray};
pub use octray::methods::{self, SphereMethod, TriangleMethod};
pub use octray::rays::bvh::Trees;
pub use octray::rays::traverse::List;
pub use octray::rays::traverse::{Traversal, hierarchy::Hierarchy};
pub use octray::reference::{PathSettings, Reference};
pub use octray::render::{Methods, SphereChoice, TraversalChoice, TriangleChoice};
pub use octray::render::{PipelineChoice, Renderer, Settings};
pub use octray::sampling::Sampler;
pub use octray::scene::MaterialKind::{
    Diffuse, Emitter, FuzzyMirror, Glass, Metal, MetalRough, Plastic, RoughGlass, ThinGlass,
};
pub use octray::scene::{
    Attenuation, Camera, Filter, Material, MaterialExtras, MaterialKind, Scene, Side, Sky, Sphere, Texels,
    Texture, Triangle, Wrap, load,
};
pub use octray::tone::Tone;

// The numbers and rays of `octray stability`.
pub use octray::measure::stability::Rng;
pub use octray::measure::stability::rays::ray;

/// Nothing under a white sky, seen from (0, 0, 5) along −z.
pub fn empty() -> Scene {
    Scene {
        name: "test".into(),
        camera: Camera::pinhole(Vec3::Z * 5.0, Vec3::ZERO, Vec3::Y, 40.0),
        resolution: [24, 16],
        max_bounces: 4,
        sky: Sky::Color(Vec3::ONE),
        ..Scene::default()
    }
}

pub fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    (b - a).cross(c - a).length() > 0.0
}

/// Nothing but a white diffuse material.
pub fn diffuse() -> Scene {
    Scene { materials: vec![material(Diffuse)], ..empty() }
}

/// Upright.
pub fn camera(position: Vec3, look_at: Vec3, vertical_fov: f32) -> Camera {
    Camera::pinhole(position, look_at, Vec3::Y, vertical_fov)
}

/// Every kind of material that scatters, rough and smooth.
pub const KINDS: [MaterialKind; 13] = [
    Diffuse,
    Metal { roughness: 0.0 },
    Metal { roughness: 0.5 },
    Glass { ior: 1.5 },
    Glass { ior: 0.7 },
    ThinGlass { ior: 1.5 },
    FuzzyMirror { roughness: 0.8 },
    Plastic { roughness: 0.0, ior: 1.5 },
    Plastic { roughness: 0.4, ior: 1.8 },
    MetalRough { roughness: 0.0, metallic: 0.3, ior: 1.5 },
    MetalRough { roughness: 0.6, metallic: 0.5, ior: 1.3 },
    RoughGlass { roughness: 0.5, ior: 1.5, thin: false },
    RoughGlass { roughness: 0.7, ior: 1.3, thin: true },
];

pub fn material(kind: MaterialKind) -> Material {
    Material::new("m", kind, Vec3::ONE)
}

pub fn sphere(center: Vec3, radius: f32, material: u32) -> Sphere {
    Sphere { center, radius, material, texture_turn: 0.0, texture_side: Side::Outside }
}

pub fn triangle(vertices: [Vec3; 3], material: u32) -> Triangle {
    Triangle { vertices, material }
}

pub fn emitter(emission: Vec3) -> Material {
    Material { emission, ..material(Emitter) }
}

/// Shines in all colours alike.
pub fn lamp(radiance: f32) -> Material {
    emitter(Vec3::splat(radiance))
}

/// The corners of a triangle on the ground at a height, around the y axis, so far in front and to the sides.
pub fn ground(size: f32, y: f32) -> [Vec3; 3] {
    [vec3(-size, y, -size), vec3(0.0, y, 2.0 * size), vec3(size, y, -size)]
}

/// A floor that fills the picture, seen from straight above at `height`, near `foot`, and dark otherwise.
pub fn floor(foot: Vec3, height: f32) -> Scene {
    Scene {
        camera: Camera::pinhole(foot + Vec3::Y * height, foot, Vec3::Z, 0.5),
        resolution: [8, 8],
        max_bounces: 1,
        sky: Sky::Color(Vec3::ZERO),
        triangles: vec![triangle(ground(100.0 * height, 0.0).map(|corner| foot + corner), 0)],
        ..diffuse()
    }
}

/// A film of so many samples, all of them finite.
pub fn film(scene: &Scene, settings: Settings, samples: u32) -> Film {
    let renderer = Renderer::new(scene, settings);
    let mut film = renderer.film();
    renderer.add_samples(&mut film, samples);
    assert_eq!(film.discarded(), 0);
    film
}

/// Its picture.
pub fn render(scene: &Scene, settings: Settings, samples: u32) -> Picture {
    film(scene, settings, samples).picture()
}

/// The scene's own settings, with lights that are found in this way.
pub fn with_lights(scene: &Scene, lights: LightChoice) -> Settings {
    Settings { methods: Methods { lights, ..Methods::default() }, ..Settings::of(scene) }
}

/// The picture of so many samples with independent numbers.
pub fn render_by_random(scene: &Scene, lights: LightChoice, samples: u32) -> Picture {
    let methods = Methods { lights, sampler: Sampler::Random, ..Methods::default() };
    render(scene, Settings { methods, ..Settings::of(scene) }, samples)
}

/// What the judge is told to render the same.
pub fn path_settings(settings: Settings) -> PathSettings {
    let Settings { resolution, max_bounces, seed, methods, .. } = settings;
    PathSettings { resolution, max_bounces, seed, sampler: methods.sampler }
}

pub fn bits(picture: &Picture) -> Vec<[u32; 3]> {
    picture.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// Columns and rows, row by row.
pub fn places([width, height]: [u32; 2]) -> impl Iterator<Item = (u32, u32)> + Clone {
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// Of all pixels and channels.
pub fn mean(picture: &Picture) -> f64 {
    let sum: f64 = picture.pixels.iter().flatten().map(|&x| f64::from(x)).sum();
    sum / (3 * picture.pixels.len()) as f64
}

pub fn texture([width, height]: [u32; 2], filter: Filter, texels: Texels) -> Texture {
    Texture { name: "texture".into(), width, height, filter, wrap: [Wrap::Repeat; 2], texels }
}

/// The root of the mean square of their differences.
pub fn rmse(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    let squares = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
    (squares.sum::<f64>() / (3 * a.pixels.len()) as f64).sqrt()
}

/// A texture of random numbers in [0, 1).
pub fn noise(rng: &mut Rng, width: u32, height: u32, filter: Filter) -> Texture {
    let mut number = || rng.unit() as f32;
    let texels = (0..width * height).map(|_| [number(), number(), number(), 0.0]);
    // Both forms of texels, by turns.
    let texels = if width.is_multiple_of(2) {
        Texels::Float32(texels.collect())
    } else {
        Texels::Srgb8(texels.map(|texel| texel.map(|x| (255.0 * x) as u8)).collect())
    };
    texture([width, height], filter, texels)
}

/// A ball of 80 triangles of one material with the normals of the sphere, seen under a sky that tells
/// directions.
pub fn smooth_ball(kind: MaterialKind) -> Scene {
    let golden = 0.5 * (1.0 + 5.0_f32.sqrt());
    let mut corners = Vec::new();
    for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        corners.extend([vec3(0.0, a, b), vec3(a, b, 0.0), vec3(b, 0.0, a)]);
    }
    let near = |a: Vec3, b: Vec3| (a.distance(b) - 2.0).abs() < 1e-3;
    let mut scene = Scene {
        camera: Camera { position: vec3(0.4, 0.6, 3.6), ..empty().camera },
        sky: Sky::Gradient { bottom: vec3(0.1, 0.3, 0.2), top: vec3(1.0, 0.8, 0.6) },
        materials: vec![Material { color: vec3(0.9, 0.8, 0.7), ..material(kind) }],
        ..empty()
    };
    for (i, &a) in corners.iter().enumerate() {
        for (j, &b) in corners.iter().enumerate().skip(i + 1) {
            for &c in corners.iter().skip(j + 1) {
                if !(near(a, b) && near(b, c) && near(c, a)) {
                    continue;
                }
                // Outwards.
                let [a, b, c] = if a.dot(b.cross(c)) > 0.0 { [a, b, c] } else { [a, c, b] };
                let [ab, bc, ca] = [a + b, b + c, c + a];
                for face in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                    let normals = face.map(Vec3::normalize);
                    scene.triangles.push(triangle(normals, 0));
                    scene.normals.push(normals);
                }
            }
        }
    }
    assert_eq!(scene.triangles.len(), 80);
    scene
}

/// The same, but the sphere itself.
pub fn round_ball(kind: MaterialKind) -> Scene {
    let spheres = vec![sphere(Vec3::ZERO, 1.0, 0)];
    Scene { triangles: Vec::new(), normals: Vec::new(), spheres, ..smooth_ball(kind) }
}
