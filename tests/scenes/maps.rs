//! Maps of models: the options of MTL's images, relief, packed maps, wraps, WebP; smooth normals.

use super::coordinates::in_file;
use crate::folder::Folder;
use glam::{DVec3, Vec2, Vec3, vec2};
use image::{GrayImage, ImageFormat, Luma, Rgb, RgbImage};
use octray::lights::LightChoice;
use octray::render::{Methods, Renderer, Settings};
use octray::scene::{Material, MaterialKind, Scene, Texels, Texture, Wrap, convert_model, load};

/// A triangle with a material of these statements, and images beside it: `a b.png` of one row of greys,
/// `column.png` of the same one below the other, `n.png` of a normal map, `g.png` of one green texel.
fn loaded(statements: &str) -> (Folder, Scene) {
    let folder = Folder::new();
    GrayImage::from_fn(4, 1, |x, _| Luma([51 * x as u8])).save(folder.path("a b.png")).unwrap();
    GrayImage::from_fn(1, 4, |_, y| Luma([51 * y as u8])).save(folder.path("column.png")).unwrap();
    RgbImage::from_pixel(2, 1, Rgb([153, 127, 230])).save(folder.path("n.png")).unwrap();
    RgbImage::from_pixel(1, 1, Rgb([10, 51, 20])).save(folder.path("g.png")).unwrap();
    folder.write("m.mtl", format!("newmtl a\n{statements}\n"));
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
    let scene = folder.load("m.obj", format!("mtllib m.mtl\nusemtl a\n{corners}f 1/1 2/2 3/3\n")).unwrap();
    (folder, scene)
}

fn map(scene: &Scene, of: fn(&Material) -> Option<u32>) -> &Texture {
    &scene.textures[of(&scene.materials[0]).expect("a map") as usize]
}

#[test]
fn options_of_images_are_read_by_their_numbers_of_values() {
    let identity = [Vec2::ZERO, Vec2::X, Vec2::Y];
    for (options, uvs, wrap, left_out) in [
        ("-s 2 3 1 -o 0.25 -clamp on", [vec2(0.25, 0.0), vec2(2.25, 0.0), vec2(0.25, 3.0)], Wrap::Clamp, ""),
        ("-s 2", [Vec2::ZERO, vec2(2.0, 0.0), Vec2::Y], Wrap::Repeat, ""),
        ("-o -1 0.5 7 -clamp off", identity.map(|uv| uv + vec2(-1.0, 0.5)), Wrap::Repeat, ""),
        ("-blendu off -type cube_top", identity, Wrap::Repeat, "`-blendu`"),
        ("-mm 0 2", identity, Wrap::Repeat, "`-mm`"),
        ("-imfchan r -texres 512 -t 0 0", identity, Wrap::Repeat, "`-imfchan`"),
        ("-bm", identity, Wrap::Repeat, ""),
        ("-mm 1 2", identity, Wrap::Repeat, "`-mm`"),
    ] {
        let (_, scene) = loaded(&format!("map_Kd {options} a b.png"));
        let texture = map(&scene, |material| material.texture);
        assert_eq!((texture.name.as_str(), texture.wrap), ("a b.png", [wrap; 2]), "{options}");
        assert_eq!(scene.uvs[0], uvs, "{options}");
        let is_said = scene.warnings.first().map_or("", |warning| warning.as_str());
        assert!(is_said.contains(left_out) && is_said.is_empty() == left_out.is_empty(), "{is_said}");
    }
    let (_, scene) = loaded("map_Kd -s 2 2 a b.png\nmap_Ke -s 3 3 a b.png\nnorm -s 2 2 n.png");
    let material = &scene.materials[0];
    assert_eq!((material.emission_map, material.normal_map, material.emission), (None, Some(1), Vec3::ZERO));
    assert!(scene.warnings[0].contains("m.mtl:3: a texture is left out: its `-s`"), "{:?}", scene.warnings);
}

/// A ramp of a fifth from texel to texel.
#[test]
fn heights_become_normals_by_central_differences() {
    let slope = |statement: &str, texel: usize| {
        let (_, scene) = loaded(statement);
        assert!(scene.warnings.is_empty(), "{statement}: {:?}", scene.warnings);
        let normal =
            DVec3::from(map(&scene, |material| material.normal_map).texels.linear(texel)) * 2.0 - 1.0;
        assert!((normal.length() - 1.0).abs() < 1e-6, "{normal}");
        [-normal.x / normal.z, -normal.y / normal.z]
    };
    for (statement, texel, wanted) in [
        ("map_Bump a b.png", 1, [0.2, 0.0]),
        ("bump -bm 2 -mm 0.5 3 a b.png", 2, [1.2, 0.0]),
        ("map_bump a b.png -bm 0.5", 1, [0.1, 0.0]),
        ("bump -imfchan g g.png", 0, [0.0, 0.0]),
        // From the last texel to the second, and from the first one itself.
        ("bump a b.png", 0, [(0.2 - 0.6) / 2.0, 0.0]),
        ("bump -clamp on a b.png", 0, [0.1, 0.0]),
        // Higher further down, where v is smaller.
        ("bump column.png", 1, [0.0, -0.2]),
    ] {
        let found = slope(statement, texel);
        let off = (0..2).map(|axis| (found[axis] - wanted[axis]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{statement}: {found:?}");
    }
    // A normal map under the name of heights.
    for (scale, slope) in [(1.0, 0.25), (2.0, 0.5)] {
        let (_, scene) = loaded(&format!("map_Bump -bm {scale} n.png"));
        let [x, _, z] = map(&scene, |material| material.normal_map).texels.linear(0).map(|x| 2.0 * x - 1.0);
        assert!((x / z - slope).abs() < 0.01, "{x} {z}");
        assert!(scene.warnings[0].contains("is a normal map and is read as one"), "{:?}", scene.warnings);
    }
    let (_, scene) = loaded("norm n.png\nbump a b.png");
    assert_eq!(map(&scene, |material| material.normal_map).name, "n.png");
    assert!(scene.warnings[0].contains("m.mtl:3: `map_Bump` is left out beside a normal map"));
}

#[test]
fn maps_of_roughness_and_metal_are_packed_at_the_larger_size() {
    let (folder, scene) =
        loaded("map_Pr -imfchan g g.png\nmap_Pm a b.png\nPm 0.5\nKd 1 1 1\nillum 3\nKs 0.1 0.1 0.1");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let material = &scene.materials[0];
    assert_eq!(material.kind, MaterialKind::MetalRough { roughness: 1.0, metallic: 0.5, ior: 1.5 });
    assert_eq!(material.color, Vec3::ONE);
    let packed = map(&scene, |material| material.roughness_map);
    assert_eq!(packed.texels, Texels::Unorm8([0, 51, 102, 153].map(|metal| [51, 51, metal, 0]).to_vec()));
    // Texels made of others survive conversion, as files of their own.
    let converted = convert_model(&folder.path("m.obj"), &folder.path("s.json")).unwrap();
    for (name, bytes) in converted.pictures {
        folder.write(name.to_str().unwrap(), bytes);
    }
    let again = folder.load("s.json", converted.text).unwrap();
    assert_eq!(map(&again, |material| material.roughness_map).texels, packed.texels);
    let (_, scene) = loaded("map_Pm column.png");
    let texels = Texels::Unorm8([0, 51, 102, 153].map(|metal| [255, 255, metal, 0]).to_vec());
    assert_eq!(map(&scene, |material| material.roughness_map).texels, texels);
    let (_, scene) = loaded("map_Pm a b.png\nmap_Pr gone.png");
    assert!(
        scene.warnings[0].contains("m.mtl:3: the texture `gone.png` is left out"),
        "{:?}",
        scene.warnings
    );
    // Interpolated: 1 × 4 texels between those of 4 × 1.
    let (_, scene) = loaded("map_Pm a b.png\nmap_Pr column.png");
    let packed = map(&scene, |material| material.roughness_map);
    assert_eq!((packed.width, packed.height), (4, 4));
    let texels = &packed.texels;
    assert_eq!((texels.linear(6), texels.linear(13)), ([0.2, 0.2, 0.4], [0.6, 0.6, 0.2]));
}

/// A floor under a triangle that glows as its map says, found by light sampling or by chance.
#[test]
fn emission_maps_of_the_mtl_light_the_scene() {
    let (folder, scene) = loaded("Ke 0 0 0\nmap_Ke a b.png");
    assert_eq!((scene.materials[0].emission, scene.warnings.len()), (Vec3::ONE, 0));
    let (_, dim) = loaded("Ke 2 1 0\nmap_Ke a b.png");
    assert_eq!(dim.materials[0].emission, Vec3::new(2.0, 1.0, 0.0));
    let floor = r#""triangles": [{ "vertices": [[-4,-0.2,-4], [-4,-0.2,4], [4,-0.2,0]] }]"#;
    let camera = r#""camera": { "position": [0.3,2,1], "look_at": [0.3,-0.2,0.3] }"#;
    let scene =
        folder.load_keys(&format!(r#"{camera}, {floor}, "meshes": [{{ "model": "m.obj" }}]"#)).unwrap();
    let mean = |lights| {
        let methods = Methods { lights, ..Methods::default() };
        let settings = Settings { resolution: [24, 16], methods, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 512);
        let pixels = film.picture().pixels;
        f64::from(pixels.iter().map(|pixel| pixel[0]).sum::<f32>()) / pixels.len() as f64
    };
    let [on, off] = [LightChoice::On, LightChoice::Off].map(mean);
    assert!(on > 1e-3 && (on / off - 1.0).abs() < 0.02, "{on} {off}");
}

#[test]
fn wraps_of_scene_files_are_for_both_directions_or_for_each() {
    let folder = Folder::new();
    folder.save_picture("p.png");
    let with = |wrap: &str, texture: &str| {
        let material = format!(r#"{{ "type": "diffuse", "wrap": {wrap}{texture} }}"#);
        folder.load_keys(&format!(
            r#""materials": {{ "a": {material} }}, "spheres": [{{ "center": [0,0,0], "radius": 1, "material": "a" }}]"#
        ))
    };
    let textured = r#", "texture": "p.png""#;
    for (key, wrap) in
        [(r#""mirror""#, [Wrap::Mirror; 2]), (r#"["clamp", "repeat"]"#, [Wrap::Clamp, Wrap::Repeat])]
    {
        assert_eq!(with(key, textured).unwrap().textures[0].wrap, wrap);
    }
    for (key, texture, words) in [
        (
            r#""mirrored""#,
            textured,
            r#"as in "wrap": "clamp", "mirror" or "repeat", or ["clamp", "repeat"] for"#,
        ),
        (r#"["clamp"]"#, textured, "\"clamp\""),
        (r#""clamp""#, "", "`wrap` without a `texture`"),
    ] {
        let error = with(key, texture).unwrap_err().to_string();
        assert!(error.contains("materials.a.wrap") && error.contains(words), "{error}");
    }
}

#[test]
fn webp_files_have_the_texels_of_png_files() {
    let folder = Folder::new();
    let picture = RgbImage::from_fn(5, 3, |x, y| Rgb([50 * x as u8, 100 * y as u8, (17 * x * y) as u8]));
    for (name, format) in [("p.png", ImageFormat::Png), ("p.webp", ImageFormat::WebP)] {
        picture.save_with_format(folder.path(name), format).unwrap();
    }
    // One pixel, lossy; and many in few bytes.
    let lossy = b"RIFF\x22\x00\x00\x00WEBPVP8 \x16\x00\x00\x000\x01\x00\x9d\x01*\x01\x00\x01\x00\x0e\xc0\xfe%\xa4\x00\x03p\x00\x00\x00\x00";
    folder.write("lossy.webp", lossy);
    RgbImage::new(2000, 2000).save_with_format(folder.path("large.webp"), ImageFormat::WebP).unwrap();
    let texture = |name: &str| {
        let ball = r#""spheres": [{ "center": [0,0,0], "radius": 1 }]"#;
        let scene = folder.load_keys(&format!(r#"{ball}, "sky": {{ "texture": "{name}" }}"#)).unwrap();
        assert!(scene.warnings.iter().all(|warning| !warning.contains(name)), "{:?}", scene.warnings);
        scene.textures[0].clone()
    };
    assert_eq!(texture("p.webp").texels, texture("p.png").texels);
    assert_eq!(texture("lossy.webp").texels.len(), 1);
    assert_eq!(texture("large.webp").width, 2000);
}

/// The normals of a mesh in a scene.
fn smoothed(text: &str, degrees: f64) -> Scene {
    let folder = Folder::new();
    folder.write("m.obj", text);
    let keys = format!(r#""meshes": [{{ "model": "m.obj", "smooth": {degrees} }}]"#);
    in_file(folder.load_keys(&keys).unwrap())
}

/// The cube's squares are cut along diagonals: weights by angle do not see them.
#[test]
fn edges_up_to_the_angle_are_smooth() {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| if bit == 1 { 1 } else { -1 });
    let vertices = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect::<String>();
    let faces = "vn 0 1 1\nf 1//1 3//1 4//1 2//1\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    let cube = vertices + faces;
    for sharp in [0.0, 89.0] {
        assert!(smoothed(&cube, sharp).normals.is_empty(), "{sharp}");
    }
    for smooth in [91.0, 180.0] {
        let scene = smoothed(&cube, smooth);
        for (triangle, normals) in scene.triangles.iter().zip(&scene.normals) {
            for (corner, normal) in triangle.vertices.iter().zip(normals) {
                assert!(normal.abs_diff_eq(corner.normalize(), 1e-6), "{normal} at {corner}");
            }
        }
        assert_eq!(scene.normals.len(), 12);
    }
    let folder = Folder::new();
    folder.write("m.obj", &cube);
    for degrees in ["-1", "180.5"] {
        let keys = format!(r#""meshes": [{{ "model": "m.obj", "smooth": {degrees} }}]"#);
        let error = folder.load_keys(&keys).unwrap_err().to_string();
        assert!(error.contains("meshes[0].smooth") && error.contains("from 0 (flat) to 180"), "{error}");
    }
}

#[test]
fn a_smooth_ball_has_radial_normals_and_the_same_bits_on_both_sides_of_edges() {
    let point = |column: u32, row: u32| {
        let [turn, fall] = [column as f64 / 24.0, row as f64 / 24.0].map(|x| x * std::f64::consts::PI);
        let (y, around) = (fall.cos(), fall.sin());
        DVec3::new((2.0 * turn).cos() * around, y, -(2.0 * turn).sin() * around)
    };
    let mut text = String::new();
    for (column, row) in (0..24).flat_map(|column| (0..24).map(move |row| (column, row))) {
        // Every face has corners of its own: positions count, not indices.
        let next = (column + 1) % 24;
        for p in [point(column, row), point(column, row + 1), point(next, row + 1), point(next, row)] {
            text += &format!("v {:.6} {:.6} {:.6}\n", p.x, p.y, p.z);
        }
        text += "f -4 -3 -2 -1\n";
    }
    let scene = smoothed(&text, 60.0);
    let mut known = std::collections::HashMap::new();
    for (triangle, normals) in scene.triangles.iter().zip(&scene.normals) {
        for (corner, normal) in triangle.vertices.iter().zip(normals) {
            assert!(normal.dot(corner.normalize()) > 0.9999, "{normal} at {corner}");
            let first = known.entry(corner.to_array().map(|x| (x + 0.0).to_bits())).or_insert(*normal);
            assert_eq!(first, normal);
        }
    }
    assert_eq!(known.len(), 2 + 23 * 24);
    assert!(load("builtin:three").unwrap().normals.is_empty());
}
