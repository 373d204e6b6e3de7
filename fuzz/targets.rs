//! What each fuzz target does with its bytes: everything that octray does with a file of a user, from parsing
//! to a tiny picture. No file is opened: what a file names comes from [`SIDE_FILES`].
//!
//! `tests/scenes/replay.rs` runs the same functions on `fuzz/seeds` and `fuzz/findings`.
//!
//! A target panics where octray must not: on a panic, on an error without a remedy, on pixels that are not
//! finite or that differ between widths, on a view that changes when it is written.

use octray_engine::adaptive;
use octray_engine::camera::PreparedCamera;
use octray_engine::film::Film;
use octray_engine::lane::WIDTHS;
use octray_engine::render::Methods;
use octray_engine::render::{Renderer, Settings};
use octray_engine::scene::{MAX_BOUNCES, Scene};
use octray_formats::checkpoint::Checkpoint;
use octray_formats::checkpoint::merge::Parts;
use octray_formats::scene::{Loaded, Rendering, View, load, load_from};
use std::io::ErrorKind;
use std::path::Path;

type Target = fn(&[u8]);

/// All targets by name.
pub const TARGETS: [(&str, Target); 9] = [
    ("obj", obj),
    ("mtl", mtl),
    ("ply", ply),
    ("gltf", gltf),
    ("scenes", scenes),
    ("thesis", thesis),
    ("views", views),
    ("checkpoints", checkpoints),
    ("images", images),
];

/// The files that a file under test may name, in whatever folder it says.
const SIDE_FILES: [(&str, &[u8]); 7] = [
    ("a.png", include_bytes!("side/a.png")),
    ("a.hdr", include_bytes!("side/a.hdr")),
    ("a.obj", b"mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"),
    ("a.mtl", b"newmtl a\nKd 0.5 0.5 0.5\nmap_Kd a.png\nnewmtl b\nillum 7\nNi 1.5\n"),
    ("a.bin", include_bytes!("side/a.bin")),
    ("a.gltf", include_bytes!("side/a.gltf")),
    ("a.json", b"{\"format\":\"octray-1\",\"spheres\":[{\"center\":[0,0,0],\"radius\":1}]}"),
];

/// Largest scene that is rendered, so that a run takes milliseconds.
const MOST_PRIMITIVES: usize = 2_000;
const MOST_TEXELS: usize = 1 << 16;

/// Scenes in the native format.
pub fn scenes(bytes: &[u8]) {
    read("scene.json", bytes, &[]);
}

/// Scenes in the thesis's format.
pub fn thesis(bytes: &[u8]) {
    read("scene.json", bytes, &[]);
}

/// Views.
pub fn views(bytes: &[u8]) {
    read("view.json", bytes, &[]);
}

/// OBJ models.
pub fn obj(bytes: &[u8]) {
    read("model.obj", bytes, &[]);
}

/// Material libraries of OBJ models.
pub fn mtl(bytes: &[u8]) {
    const MODEL: &[u8] = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 2\nvt 0 0\nvt 1 0\nvt 0 1\n\
        usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 2 3 4\nusemtl c d\nf 1/1 4/2 3/3\n";
    read("model.obj", MODEL, &[("m.mtl", bytes)]);
}

/// glTF models, as text or binary.
pub fn gltf(bytes: &[u8]) {
    read("model.glb", bytes, &[]);
}

/// PLY models.
pub fn ply(bytes: &[u8]) {
    read("model.ply", bytes, &[]);
}

/// Images of all formats, as textures.
pub fn images(bytes: &[u8]) {
    const SCENE: &str = r#"{"format":"octray-1","sky":{"texture":"x.tga"},
        "materials":{"a":{"type":"diffuse","texture":"x.tga","normal_map":"x.tga"}},
        "spheres":[{"center":[0,0,0],"radius":1,"material":"a"}]}"#;
    read("scene.json", SCENE.as_bytes(), &[("x.tga", bytes)]);
}

/// Checkpoints and shards: as they are, and with the checksums that belong to them.
pub fn checkpoints(bytes: &[u8]) {
    resume(bytes);
    if let Some(repaired) = with_checksums(bytes) {
        resume(&repaired);
    }
}

/// Loads a file and renders what it shows.
fn read(name: &'static str, bytes: &[u8], beside: &[(&'static str, &[u8])]) {
    let mut files: Vec<(&str, Vec<u8>)> = vec![(name, bytes.to_vec())];
    files.extend(beside.iter().map(|&(name, content)| (name, content.to_vec())));
    files.extend(SIDE_FILES.map(|(name, content)| (name, content.to_vec())));
    let given = move |path: &Path| {
        let wanted = path.file_name().and_then(|name| name.to_str());
        let found = files.iter().find(|(name, _)| Some(*name) == wanted);
        found.map(|(_, content)| content.clone()).ok_or_else(|| ErrorKind::NotFound.into())
    };
    match load_from(Path::new(name), given.clone()) {
        Err(error) => {
            assert!(error.mend.is_some() && error.file.is_some(), "an error without help: {error}");
            assert!(!error.what.is_empty());
        }
        Ok(loaded) => {
            if let Some(view) = &loaded.view {
                let text = view.text().into_bytes();
                let again = load_from(Path::new(name), move |path| match path == Path::new(name) {
                    true => Ok(text.clone()),
                    false => given(path),
                });
                let again = again.expect("a view that is written can be read");
                assert_eq!(again.view.as_ref(), Some(view), "a view is what was written");
            }
            show(&loaded);
        }
    }
}

/// Renders a scene, at every width, as its view asks.
fn show(loaded: &Loaded) {
    let scene = &loaded.scene;
    let texels: usize = scene.textures.iter().map(|texture| texture.texels.len()).sum();
    if scene.spheres.len() + scene.triangles.len() > MOST_PRIMITIVES || texels > MOST_TEXELS {
        return;
    }
    assert!(scene.max_bounces <= MAX_BOUNCES);
    let methods = loaded.view.as_ref().map_or(Methods::default(), |view| methods(&view.render));
    let settings = Settings {
        resolution: [4, 3],
        max_bounces: scene.max_bounces.min(4),
        methods,
        seed: loaded.view.as_ref().and_then(|view| view.render.seed).unwrap_or(0),
        ..Settings::of(scene)
    };
    let bits = WIDTHS.map(|lanes| {
        let renderer = Renderer::new(scene, Settings { lanes, ..settings });
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 1);
        let channels = film.picture().pixels.into_iter().flatten();
        channels.inspect(|x| assert!(x.is_finite() && *x >= 0.0, "{x}")).map(f32::to_bits).collect::<Vec<_>>()
    });
    assert!(bits.iter().all(|of_width| *of_width == bits[0]), "all widths have the same bits");
    if let Some(view) = &loaded.view {
        fly(view);
    }
}

/// A view's methods, where it names some.
fn methods(render: &Rendering) -> Methods {
    let own = Methods::default();
    Methods {
        sphere: render.sphere.unwrap_or(own.sphere),
        triangle: render.triangle.unwrap_or(own.triangle),
        traversal: render.traversal.unwrap_or(own.traversal),
        lights: render.lights.unwrap_or(own.lights),
        sampler: render.sampler.unwrap_or(own.sampler),
    }
}

/// Some cameras along a view's keyframes.
fn fly(view: &View) {
    let Some([first, last]) = view.path.frames() else { return };
    for part in 0..=7 {
        let frame = first + (u64::from(last - first) * part / 7) as u32;
        let camera = view.path.camera_at(frame).expect("the frame is on the path");
        if camera.fault().is_none() {
            PreparedCamera::new(&camera, [4, 3]);
        }
    }
}

/// Reads a checkpoint, alone and as the parts of a picture, and goes on rendering.
fn resume(bytes: &[u8]) {
    let path = Path::new("checkpoint");
    let read = || match Checkpoint::read(bytes, path) {
        Ok(checkpoint) => Some(checkpoint),
        Err(error) => {
            assert!(!error.to_string().is_empty());
            None
        }
    };
    let Some(checkpoint) = read() else { return };
    let settings = checkpoint.header.identity.settings.clone();
    // The program asks the system for memory first.
    if settings.resolution.iter().any(|&side| side > 64) {
        return;
    }
    let scene = small_scene();
    let own =
        Settings { resolution: settings.resolution, tile_size: settings.tile_size, ..Settings::of(&scene) };
    let mut film = Film::new(own.resolution, own.tile_size);
    if settings.target.is_some() {
        film = film.with_noise();
    }
    if checkpoint.fill(&mut film).is_ok() {
        film.picture();
        assert!(film.discarded() <= film.pixel_samples());
        if let Some((error, least, most)) = settings.target {
            let target = adaptive::Target { error, least, most };
            let round = target.next(&film);
            assert!(round.is_none_or(|round| round.goals.len() == film.tiles().len()));
        }
        if film.most_samples() < u32::MAX {
            Renderer::new(&scene, own).add_samples(&mut film, 1);
        }
    }
    for copies in 1..=2 {
        let parts = (0..copies).map(|_| read().expect("it was read before")).collect();
        if let Ok(parts) = Parts::new(parts) {
            let _ = parts.film(true);
        }
    }
}

fn small_scene() -> Scene {
    load("builtin:three").expect("the scene is built in")
}

/// A checkpoint with its two checksums corrected, so that what they protect is tested too.
fn with_checksums(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut file = bytes.to_vec();
    let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
    let header = 16_usize.checked_add(length)?;
    let end = bytes.len().checked_sub(4)?;
    if header + 4 > end {
        return None;
    }
    let sum = crc32fast::hash(&file[..header]).to_le_bytes();
    file[header..header + 4].copy_from_slice(&sum);
    let sum = crc32fast::hash(&file[..end]).to_le_bytes();
    file[end..].copy_from_slice(&sum);
    Some(file)
}
