//! Files that ask for more than they hold: refused before anything of that size is allocated. Long files are
//! read in time that grows with their length.

use crate::folder::Folder;
use octray::film::Picture;
use octray::scene::{Scene, SceneError, load, load_from};
use std::cell::Cell;
use std::fs::File;
use std::io::{Cursor, ErrorKind};
use std::path::Path;
use std::rc::Rc;

/// Loads the first of these files; it may name the others.
fn read(files: &[(&'static str, &[u8])]) -> Result<Scene, SceneError> {
    read_counting(files).0
}

/// The same, and how often a file was read.
fn read_counting(files: &[(&'static str, &[u8])]) -> (Result<Scene, SceneError>, usize) {
    let files: Vec<_> = files.iter().map(|&(name, content)| (name, content.to_vec())).collect();
    let first = Path::new(files[0].0);
    let reads = Rc::new(Cell::new(0));
    let counter = Rc::clone(&reads);
    let content = move |path: &Path| {
        counter.set(counter.get() + 1);
        let found = files.iter().find(|(name, _)| Path::new(name) == path);
        found.map(|(_, content)| content.clone()).ok_or_else(|| ErrorKind::NotFound.into())
    };
    (load_from(first, content).map(|loaded| loaded.scene), reads.get())
}

#[track_caller]
fn refused(files: &[(&'static str, &[u8])], what: &str, mend: &str) {
    let error = read(files).expect_err("the file must be refused");
    assert!(error.what.contains(what), "what: {error}");
    assert!(error.mend.as_ref().is_some_and(|text| text.contains(mend)), "mend: {error}");
    assert!(error.file.is_some(), "where: {error}");
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn deep_nesting_is_refused() {
    for open in ["[", r#"{"a":"#] {
        let scene = format!(r#"{{"format":"octray-1","camera":{}"#, open.repeat(100_000));
        refused(&[("s.json", scene.as_bytes())], "", "");
        let model = format!(r#"{{"asset":{{"version":"2.0"}},"extras":{}"#, open.repeat(100_000));
        refused(&[("m.gltf", model.as_bytes())], "", "");
    }
}

// Long files: each would take minutes if it took time by the square of its length.

#[test]
fn joined_lines_take_time_by_their_length() {
    let joined = format!("{TRIANGLE}f 1 2 3 {}\n", "\\\n".repeat(1_000_000));
    assert_eq!(read(&[("m.obj", joined.as_bytes())]).unwrap().triangles.len(), 1);
}

#[test]
fn names_of_missing_materials_take_time_by_their_number_and_give_a_thousand_warnings() {
    let names: String = (0..100_000).map(|i| format!("usemtl m{i}\n")).collect();
    let scene = read(&[("m.obj", format!("{TRIANGLE}{names}f 1 2 3\n").as_bytes())]).unwrap();
    assert_eq!(scene.warnings.len(), 1_001, "no more is read by anybody");
    assert_eq!(scene.warnings[1_000], "99000 more warnings are left out.");
}

#[test]
fn libraries_are_read_once_and_give_a_hundred_kinds_of_warnings() {
    let model = format!("{}{TRIANGLE}f 1 2 3\n", "mtllib m.mtl\n".repeat(20_000));
    let unknown: String = (0..20_000).map(|i| format!("x{i} 1\n")).collect();
    let library = format!("newmtl a\nnewmtl b\n{unknown}");
    let scene = read(&[("m.obj", model.as_bytes()), ("m.mtl", library.as_bytes())]).unwrap();
    assert_eq!(scene.materials.len(), 3);
    assert_eq!(scene.warnings.len(), 101);
    assert_eq!(scene.warnings[100], "m.mtl: 19900 more of other kinds are left out.");
}

#[test]
fn materials_take_time_by_their_number() {
    let materials: Vec<String> = (0..100_000).map(|i| format!(r#""m{i}":{{"type":"glass"}}"#)).collect();
    let spheres = r#"[{"center":[0,0,0],"radius":1}]"#;
    let scene =
        format!(r#"{{"format":"octray-1","materials":{{{}}},"spheres":{spheres}}}"#, materials.join(","));
    assert_eq!(read(&[("s.json", scene.as_bytes())]).unwrap().materials.len(), 100_001);
}

#[test]
fn long_names_are_not_compared() {
    let name = "m".repeat(100_000);
    let scene = format!(
        "{{\"format\":\"octray-1\",\"materials\":{{\"{name}\":{{\"type\":\"glass\"}}}},\
         \"spheres\":[{{\"center\":[0,0,0],\"radius\":1,\"material\":\"{name}m\"}}]}}"
    );
    refused(&[("s.json", scene.as_bytes())], "there is no material", "add it");
}

#[test]
fn copies_of_a_model_are_bounded_before_they_are_made() {
    let model = format!("{TRIANGLE}{}", "f 1 2 3\n".repeat(1_000));
    let text = |uses: usize| {
        let meshes = vec![r#"{"model":"m.obj"}"#; uses].join(",");
        format!(r#"{{"format":"octray-1","meshes":[{meshes}]}}"#)
    };
    let uses = |uses: usize| read_counting(&[("s.json", text(uses).as_bytes()), ("m.obj", model.as_bytes())]);
    let (scene, reads) = uses(20);
    assert_eq!((scene.unwrap().triangles.len(), reads), (20_000, 2), "a model is read once");
    let error = uses(70_000).0.unwrap_err();
    assert!(error.what.contains("copies of models add up to more than 67108864 triangles"), "{error}");
    assert_eq!(error.mend.as_deref(), Some("name the model fewer times, or simplify it"));
    assert!(error.at.is_some_and(|at| at.starts_with("meshes[0], line 1")));
}

/// Buffers of one file share its content: 5,000 of a megabyte each.
#[test]
fn buffers_of_one_file_are_read_once() {
    let mut content = vec![0; 1 << 20];
    content[12..16].copy_from_slice(&1.0_f32.to_le_bytes());
    content[28..32].copy_from_slice(&1.0_f32.to_le_bytes());
    let buffers = vec![r#"{"uri":"m.bin","byteLength":1048576}"#; 5_000].join(",");
    let model = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"buffers\":[{buffers}],\
         \"bufferViews\":[{{\"buffer\":4999,\"byteLength\":36}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}}],\
         \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\"nodes\":[{{\"mesh\":0}}]}}"
    );
    let (scene, reads) = read_counting(&[("m.gltf", model.as_bytes()), ("m.bin", &content)]);
    assert_eq!((scene.unwrap().triangles.len(), reads), (1, 2));
}

/// A scene with a texture from this image file.
#[track_caller]
fn image_refused(image: &[u8], why: &str) {
    let scene = "{\"format\":\"octray-1\",\"materials\":{\"m\":{\"type\":\"diffuse\",\"texture\":\"m.png\"}},\
                 \"spheres\":[{\"center\":[0,0,0],\"radius\":1,\"material\":\"m\"}]}";
    refused(&[("s.json", scene.as_bytes()), ("m.png", image)], why, "give the path of an image");
}

#[test]
fn images_larger_than_their_file_accounts_for_are_refused() {
    for (width, height) in [(100_000_u32, 100_000_u32), (70_000, 1), (60_000, 60_000)] {
        let mut header = b"IHDR".to_vec();
        header.extend([width.to_be_bytes(), height.to_be_bytes()].concat());
        header.extend([8, 2, 0, 0, 0]);
        let sum = crc32fast::hash(&header);
        let png = [b"\x89PNG\r\n\x1a\n\0\0\0\r", &header[..], &sum.to_be_bytes()].concat();
        image_refused(&[&png[..], b"\0\0\0\0IDAT\x35\xaf\x06\x1e"].concat(), "the image is larger than");
        let hdr = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
        image_refused(hdr.as_bytes(), "the image is larger than");
    }
    let mut jpeg = include_bytes!("../../fuzz/seeds/images/a.jpg").to_vec();
    let frame = jpeg.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..][..4].copy_from_slice(&[0x41, 0x54, 0x49, 0x44]);
    image_refused(&jpeg, &format!("its {} bytes are too few for 18756x16724 pixels", jpeg.len()));
}

#[test]
fn exr_images_larger_than_their_file_accounts_for_are_refused() {
    let written = |width: u32| {
        let picture = Picture { width, height: 1, pixels: vec![[0.5; 3]; width as usize] };
        let mut exr = Cursor::new(Vec::new());
        octray_formats::openexr::write(&mut exr, &picture, "").unwrap();
        exr.into_inner()
    };
    image_refused(&written(70_000), "the image is larger than 65535 texels");
    for window in [&b"displayWindow\0box2i\0"[..], b"dataWindow\0box2i\0"] {
        let mut exr = written(1);
        let at = exr.windows(window.len()).position(|bytes| bytes == window).unwrap() + window.len() + 4;
        for (corner, value) in [-100_000_i32, -100_000, 100_000, 100_000].into_iter().enumerate() {
            exr[at + 4 * corner..][..4].copy_from_slice(&value.to_le_bytes());
        }
        image_refused(&exr, "200001 × 200001 pixels are more than");
    }
}

#[test]
fn files_larger_than_any_scene_are_refused() {
    let folder = Folder::new();
    let path = folder.path("m.ply");
    // Sparse: it takes no space.
    File::create(&path).unwrap().set_len((1 << 34) + 1).unwrap();
    let error = load(path.to_str().unwrap()).unwrap_err();
    assert!(error.what.contains("17179869185 bytes, and at most 17179869184 are read"), "{error}");
}

/// Whoever opens a pipe waits until somebody writes into it.
#[cfg(unix)]
#[test]
fn pipes_are_no_checkpoints_and_are_not_waited_for() {
    use octray_formats::checkpoint::{Checkpoint, CheckpointError, is_checkpoint};
    let folder = Folder::new();
    let path = folder.path("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    assert!(!is_checkpoint(&path));
    assert!(matches!(Checkpoint::open(&path), Err(CheckpointError::NotACheckpoint { .. })));
    let error = load(path.with_extension("json").to_str().unwrap()).unwrap_err();
    assert!(error.what.contains("no such file"), "{error}");
}
