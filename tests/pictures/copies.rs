//! The laws of copies: of every scene in `scenes/`, one that is moved or scaled has the same film, a mirrored
//! one the mirrored film, and one of white materials in a white furnace is white.

use crate::common::statistics::{allowed, mean_and_error};
use crate::common::*;
use octray::scene::{LightShape, load_from};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// The paths of all scene files.
fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let within = |folder: PathBuf| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let all = within(folder.clone()).chain(within(folder.join("book")));
    let files: Vec<_> = all.filter(|path| path.extension().is_some_and(|kind| kind == "json")).collect();
    assert!(files.len() >= 12, "{files:?}");
    files
}

fn load(path: &Path, change: impl Fn(&mut Value)) -> Scene {
    let mut json = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    change(&mut json);
    let scene = path.to_path_buf();
    let read = move |file: &Path| match file == scene {
        true => Ok(json.to_string().into_bytes()),
        false => fs::read(file),
    };
    let scene = load_from(path, read).unwrap().scene;
    Scene { resolution: [48, 28], ..scene }
}

/// Scales and moves all that a scene file says of places and lengths, after rounding it so that no sum
/// rounds, and scales intensities so that surfaces stay as bright.
fn place(json: &mut Value, key: &str, scale: f64, offset: [f64; 3]) {
    let is_point = matches!(key, "position" | "look_at" | "focus_on" | "center" | "translate" | "vertices");
    let is_length = key.ends_with("radius")
        || key.ends_with("distance")
        || matches!(key, "scale" | "texture_size" | "range" | "orthographic_height");
    match json {
        Value::Object(entries) => {
            entries.iter_mut().for_each(|(key, value)| place(value, key, scale, offset));
        }
        Value::Array(numbers) if is_point && numbers[0].is_number() => {
            for (number, offset) in numbers.iter_mut().zip(offset) {
                let rounded = (number.as_f64().unwrap() * 65536.0).round() / 65536.0;
                *number = (rounded * scale + offset).into();
            }
        }
        Value::Array(numbers) if key == "intensity" => {
            numbers.iter_mut().for_each(|number| *number = (number.as_f64().unwrap() * scale * scale).into())
        }
        Value::Array(items) => items.iter_mut().for_each(|item| place(item, key, scale, offset)),
        length if is_length => {
            *length = (length.as_f64().unwrap() * scale).into();
        }
        _ => {}
    }
}

#[test]
fn moved_and_scaled_scenes_have_the_bits_of_the_film() {
    // The camera of the thesis's files stands where it is.
    let is_native = |path: &PathBuf| fs::read_to_string(path).unwrap().contains("octray-1");
    for path in files().into_iter().filter(is_native) {
        let film = |scale: f64, offset| {
            let scene = load(&path, |json| {
                // The one that a scene gets without it.
                json.as_object_mut().unwrap().remove("origin");
                place(json, "", scale, offset);
            });
            bits(&render_by_random(&scene, LightChoice::Auto, 2))
        };
        let own = film(1.0, [0.0; 3]);
        // Textures of triangles without coordinates stay where they are in the file: they repeat.
        for (scale, offset) in [(1.0, [524_288.0, -16_384.0, 8192.0]), (1024.0, [0.0; 3])] {
            assert!(film(scale, offset) == own, "{} at {offset:?}, scaled by {scale}", path.display());
        }
        let [small, large] = [-44.0, 40.0].map(f64::exp2).map(|size| film(size, [0.0; 3]));
        assert!(small == own && large == own, "{} of another unit", path.display());
    }
}

/// Left and right exchanged; the fronts of surfaces and textures stay.
fn mirrored(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let mirror = |vector: &mut Vec3| vector.x = -vector.x;
    let Camera { position, look_at, up, .. } = &mut scene.camera;
    [position, look_at, up].into_iter().for_each(mirror);
    for sphere in &mut scene.spheres {
        mirror(&mut sphere.center);
        sphere.texture_turn = (-sphere.texture_turn - 0.5).rem_euclid(1.0);
        sphere.texture_side = if sphere.texture_side == Side::Inside { Side::Outside } else { Side::Inside };
    }
    for triangle in &mut scene.triangles {
        triangle.vertices.iter_mut().for_each(mirror);
        triangle.vertices.swap(1, 2);
    }
    for portal in &mut scene.portals {
        portal.vertices.iter_mut().for_each(mirror);
        portal.vertices.swap(1, 3);
    }
    for light in &mut scene.lights {
        match &mut light.shape {
            LightShape::Point { position, .. } => mirror(position),
            LightShape::Spot { position, direction, .. } => {
                [position, direction].into_iter().for_each(mirror)
            }
            LightShape::Directional { direction, .. } => mirror(direction),
        }
    }
    scene.uvs.iter_mut().for_each(|uvs| uvs.swap(1, 2));
    scene.normals.iter_mut().flatten().for_each(mirror);
    scene.normals.iter_mut().for_each(|normals| normals.swap(1, 2));
    scene
}

#[test]
fn mirrored_scenes_have_the_mirrored_film() {
    let scenes: Vec<(PathBuf, Scene)> =
        files().into_iter().map(|path| (path.clone(), load(&path, |_| {}))).collect();
    let (blocks, mut tested) = ([6, 4], 0);
    for (path, scene) in scenes.iter().filter(|(_, scene)| !matches!(scene.sky, Sky::Texture { .. })) {
        let [own, other] =
            [scene, &mirrored(scene)].map(|scene| render_by_random(scene, LightChoice::Auto, 256));
        let [width, height] = [own.width, own.height];
        for block in places(blocks) {
            let is_inside = |(x, y): &(u32, u32)| (x * blocks[0] / width, y * blocks[1] / height) == block;
            let at =
                |picture: &Picture, x: u32, y: u32| f64::from(picture.pixels[(y * width + x) as usize][0]);
            let differences: Vec<f64> = places([width, height])
                .filter(is_inside)
                .map(|(x, y)| at(&own, x, y) - at(&other, width - 1 - x, y))
                .collect();
            let (mean, error) = mean_and_error(&differences);
            let most = allowed(24 * scenes.len()) * error + 1e-5;
            assert!(mean.abs() <= most, "{} {block:?}: {mean} beyond {most}", path.display());
            tested += 1;
        }
    }
    assert!(tested >= 24 * 10, "{tested}");
}

#[test]
fn white_scenes_vanish_in_a_white_furnace() {
    for path in files() {
        let mut scene = load(&path, |_| {});
        scene.lights.clear();
        for material in &mut scene.materials {
            // An emitter of the radiance of the sky vanishes too.
            let emission = if material.kind == Emitter { Vec3::ONE } else { Vec3::ZERO };
            (material.color, material.emission) = (Vec3::ONE, emission);
            (material.texture, material.emission_map) = (None, None);
            material.extras.attenuation = None;
            // The thesis's lobe absorbs.
            if matches!(material.kind, FuzzyMirror { .. }) {
                material.kind = Diffuse;
            }
        }
        let scene = Scene { sky: Sky::Color(Vec3::ONE), max_bounces: 1000, ..scene };
        let shown = mean(&render_by_random(&scene, LightChoice::Off, 16));
        // A rough coat of plastic keeps what bounces between its facets.
        let is_coated = scene.materials.iter().any(|material| matches!(material.kind, Plastic { .. }));
        let least = if is_coated { 0.93 } else { 0.98 };
        // Rough glass and clear coats return all light within the errors of tables and fits, and with noise.
        let has_layers = |material: &Material| {
            matches!(material.kind, RoughGlass { .. }) || material.extras != MaterialExtras::default()
        };
        let most = if scene.materials.iter().any(has_layers) { 1.004 } else { 1.0001 };
        assert!((least..=most).contains(&shown), "{}: {shown}", path.display());
    }
}
