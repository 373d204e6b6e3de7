//! Renders a scene that is changed in code into a buffer of bytes:
//! `cargo run --release --example render_to_buffer`

use glam::Vec3;
use octray_engine::lane::INSTRUCTIONS;
use octray_engine::render::{Renderer, Settings};
use octray_engine::scene::{Material, MaterialKind, Scene, Sphere};
use octray_engine::tone::Tone;
use octray_formats::scene::load;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A scene's existence is the proof that it is valid: change one that was loaded.
    let mut scene: Scene = load("builtin:three")?;
    let gold = Material {
        name: "gold".into(),
        kind: MaterialKind::Metal { roughness: 0.3 },
        color: Vec3::new(0.95, 0.72, 0.35),
        ..scene.materials[0].clone()
    };
    scene.materials.push(gold);
    let material = scene.materials.len() as u32 - 1;
    scene.spheres.push(Sphere {
        center: Vec3::new(0.0, 0.4, 1.5),
        radius: 0.4,
        material,
        ..scene.spheres[0]
    });

    let threads = std::thread::available_parallelism()?.get();
    let settings = Settings { resolution: [320, 180], threads, ..Settings::of(&scene) };
    let renderer = Renderer::new(&scene, settings);
    let mut film = renderer.film();
    renderer.add_samples(&mut film, 16);

    let picture = film.picture();
    let rgb: Vec<u8> = Tone::default().bytes(&picture);
    println!("Compiled for {INSTRUCTIONS}.");
    println!("{} bytes of 8-bit sRGB, {} rays, hash {:016x}", rgb.len(), film.rays(), picture.hash());
    Ok(())
}
