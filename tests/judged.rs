//! Law: the estimator's picture is the judge's, path by path, whatever the material; rounding may send a few paths elsewhere.

mod common;

use common::{empty, material, sphere, triangle};
use glam::Vec3;
use octray::reference::{PathSettings, Reference};
use octray::render::{Renderer, Settings};
use octray::scene::{Camera, Material, MaterialKind, Scene, Sky};

/// Two balls, one in front of the other, on a floor; the balls of one kind.
fn balls(kind: MaterialKind) -> Scene {
    let floor = [Vec3::new(-30.0, -1.0, 30.0), Vec3::new(30.0, -1.0, 30.0), Vec3::new(0.0, -1.0, -60.0)];
    Scene {
        camera: Camera {
            position: Vec3::new(0.5, 1.0, 6.0),
            look_at: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov: 40.0,
        },
        sky: Sky::Gradient { bottom: Vec3::new(0.1, 0.3, 0.2), top: Vec3::new(1.0, 0.8, 0.6) },
        materials: vec![
            Material { color: Vec3::new(0.9, 0.8, 0.7), ..material(kind) },
            Material { color: Vec3::new(0.3, 0.5, 0.8), ..material(MaterialKind::Diffuse) },
        ],
        spheres: vec![sphere(Vec3::ZERO, 1.0, 0), sphere(Vec3::new(-1.3, 0.2, -1.5), 1.2, 0)],
        triangles: vec![triangle(floor, 1)],
        ..empty()
    }
}

#[test]
fn picture_is_the_judges_for_every_kind_of_material() {
    for kind in [
        MaterialKind::Diffuse,
        MaterialKind::Metal { roughness: 0.0 },
        MaterialKind::Metal { roughness: 0.5 },
        MaterialKind::Glass { ior: 1.5 },
        MaterialKind::Glass { ior: 0.7 },
        MaterialKind::Scatter { roughness: 0.8 },
        MaterialKind::Plastic { roughness: 0.0, ior: 1.5 },
        MaterialKind::Plastic { roughness: 0.4, ior: 1.8 },
    ] {
        let scene = balls(kind);
        let settings = Settings { resolution: [48, 32], max_bounces: 6, seed: 3, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 2);
        let judge = Reference::new(&scene);
        let path = PathSettings {
            resolution: settings.resolution,
            max_bounces: 6,
            seed: 3,
            sampler: Default::default(),
        };
        let picture = film.picture();
        let off = picture.pixels.iter().zip(0u32..).filter(|(pixel, index)| {
            let truth = judge.pixel(path, index % 48, index / 48, 2);
            (0..3).any(|c| (f64::from(pixel[c]) - truth[c]).abs() > 1e-3)
        });
        let off = off.count();
        println!("{kind:?}: {off} of 1,536 pixels are off");
        assert!(off <= 15, "{kind:?}: {off} of 1,536 pixels are off by more than a thousandth");
    }
}
