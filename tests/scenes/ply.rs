//! PLY models: the three encodings, and files that lie.

use super::coordinates::in_file;
use crate::folder::Folder;
use crate::obj::area;
use glam::{Vec2, Vec3, vec3};
use octray::render::{Renderer, Settings};
use octray::scene::{Camera, Scene, Sky, Texels, Texture, load, srgb_to_linear};

fn read_bytes(content: &[u8]) -> Result<Scene, String> {
    Folder::new().load("m.ply", content).map(in_file).map_err(|error| error.to_string())
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const FACE: &str = "property list uchar int vertex_indices\n";

/// Properties of one type.
fn properties(kind: &str, names: &str) -> String {
    names.split(' ').map(|name| format!("property {kind} {name}\n")).collect()
}

/// A text file of vertices that have more properties and are followed by more of a header, and its body.
fn ascii(vertices: u64, header: &str, body: &str) -> String {
    format!("ply\nformat ascii 1.0\nelement vertex {vertices}\n{XYZ}{header}end_header\n{body}")
}

fn linear_texels(texture: &Texture) -> &[[f32; 4]] {
    let Texels::Float32(texels) = &texture.texels else { panic!("{texture:?}") };
    texels
}

/// Three encodings of the same numbers, each with its type.
fn encoded(header: &str, numbers: &[(char, f64)]) -> [Vec<u8>; 3] {
    let file = |format: &str, body: Vec<u8>| {
        [format!("ply\nformat {format} 1.0\ncomment made by hand\n{header}end_header\n").into_bytes(), body]
            .concat()
    };
    let binary = |big: bool| {
        let of = |&(kind, number): &(char, f64)| {
            let mut bytes = match kind {
                'c' => vec![number as u8],
                'b' => vec![number as i8 as u8],
                's' => (number as i16).to_le_bytes().to_vec(),
                'u' => (number as u16).to_le_bytes().to_vec(),
                'i' => (number as i32).to_le_bytes().to_vec(),
                'd' => number.to_le_bytes().to_vec(),
                _ => (number as f32).to_le_bytes().to_vec(),
            };
            if big {
                bytes.reverse();
            }
            bytes
        };
        numbers.iter().flat_map(of).collect::<Vec<u8>>()
    };
    let words: Vec<String> = numbers.iter().map(|(_, number)| number.to_string()).collect();
    [
        file("ascii", words.join(" ").into_bytes()),
        file("binary_little_endian", binary(false)),
        file("binary_big_endian", binary(true)),
    ]
}

#[test]
fn all_encodings_give_the_same_polygons_normals_and_colours() {
    let [places, colors] = [properties("float", "y z nx ny nz"), properties("uchar", "red green blue alpha")];
    let vertex = format!("element vertex 5\nproperty double x\n{places}{colors}");
    let face = format!("element face 2\n{FACE}property uchar flags\nobj_info x\n");
    let header = &format!("element edge 1\nproperty int a\n{vertex}{face}");
    let mut numbers = vec![('i', 77.0)];
    for (x, y, red) in
        [(0.0, 0.0, 0.0), (1.0, 0.0, 255.0), (1.5, 1.0, 128.0), (0.5, 2.0, 0.0), (-0.5, 1.0, 0.0)]
    {
        numbers.extend([('d', x), ('f', y), ('f', 0.0), ('f', 0.6), ('f', 0.0), ('f', 0.8)]);
        numbers.extend([('c', red), ('c', 0.0), ('c', 255.0), ('c', 3.0)]);
    }
    for face in [&[0, 1, 2, 3, 4][..], &[2, 1, 0]] {
        numbers.push(('c', face.len() as f64));
        numbers.extend(face.iter().map(|&corner| ('i', f64::from(corner))));
        numbers.push(('c', 9.0));
    }
    for content in encoded(header, &numbers) {
        let scene = read_bytes(&content).unwrap();
        assert_eq!(scene.triangles.len(), 4, "a fan of three, and one");
        let second = [[0.0, 0.0, 0.0], [1.5, 1.0, 0.0], [0.5, 2.0, 0.0]].map(Vec3::from);
        assert_eq!(scene.triangles[1].vertices, second);
        assert!(scene.normals[0][0].abs_diff_eq(vec3(0.6, 0.0, 0.8), 1e-6));
        // The colours at the corners: the texels around them.
        let texture = &scene.textures[0];
        let at = |uv: Vec2| {
            let (x, y) =
                ((uv.x * texture.width as f32) as u32, ((1.0 - uv.y) * texture.height as f32) as u32);
            Vec3::from_slice(&linear_texels(texture)[(y * texture.width + x) as usize])
        };
        let grey = srgb_to_linear(128.0 / 255.0) as f32;
        assert_eq!(scene.uvs[0].map(at), [Vec3::Z, vec3(1.0, 0.0, 1.0), vec3(grey, 0.0, 1.0)]);
    }
}

#[test]
fn colours_are_linear_between_vertices() {
    let colors = properties("float", "red green blue");
    let face = "element face 1\nproperty list uchar uint vertex_index\n";
    let header = &format!("element vertex 3\n{XYZ}{colors}{face}");
    let rows =
        [[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, 1.0]];
    let mut numbers: Vec<(char, f64)> = rows.iter().flatten().map(|&x| ('f', x)).collect();
    numbers.extend([('c', 3.0), ('i', 0.0), ('i', 1.0), ('i', 2.0)]);
    let mut scene = read_bytes(&encoded(header, &numbers)[1]).unwrap();
    // Seen from straight above under a white sky, each colour is that of its point.
    let [position, look_at] = [10.0, 0.0].map(|z| vec3(0.5, 0.5, z));
    let vertical_fov = 2.0 * 0.05_f32.atan().to_degrees();
    scene.camera = Camera::pinhole(position, look_at, Vec3::Y, vertical_fov);
    scene.sky = Sky::Color(Vec3::ONE);
    let settings = Settings { resolution: [20, 20], max_bounces: 1, ..Settings::of(&scene) };
    let renderer = Renderer::new(&scene, settings);
    let mut film = renderer.film();
    renderer.add_samples(&mut film, 16);
    let picture = film.picture();
    for (x, y) in [(1, 18), (5, 9), (8, 15), (2, 4)] {
        let at = |p: usize| (p as f32 + 0.5) / 20.0;
        let (u, v) = (at(x), 1.0 - at(y));
        let found = Vec3::from(picture.pixels[y * 20 + x]);
        let wanted = vec3(1.0 - u - v, u, v);
        assert!(found.abs_diff_eq(wanted, 0.02), "({u}, {v}): {found}, not {wanted}");
    }
}

#[test]
fn files_that_lie_are_refused() {
    let file = |header: &str, body: &str| read_bytes(format!("ply\n{header}end_header\n{body}").as_bytes());
    let (text, little) = ("format ascii 1.0\n", "format binary_little_endian 1.0\n");
    let three = "0 0 0 1 0 0 0 1 0 ";
    let vertices = |count: u64, more: &str, body: &str| read_bytes(ascii(count, more, body).as_bytes());
    let faces = |body: &str| vertices(3, &format!("element face 1\n{FACE}"), body);
    let cases = [
        (faces(&format!("{three}3 0 1 3")), "face uses vertex 3"),
        (faces("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "m.ply: face 0"),
        (faces(&format!("{three}3 0 1")), "ends too early"),
        (faces(&format!("{three}3 0 1 -1")), "no vertex"),
        (vertices(3, "", three), "no faces"),
        (vertices(3, "", "0 0 zero 1 0 0 0 1 0"), "`zero` is not a number"),
        (vertices(3, "", "0 0 1e30 1 0 0 0 1 0"), "no faces"),
        (vertices(9_999_999_999, "", "000"), "more than the file holds"),
        (
            file(&format!("{little}element vertex 99999999999999999\n{XYZ}"), "000"),
            "more than the file holds",
        ),
        (file(&format!("{little}element face 1\n{FACE}"), "\u{7f}00"), "ends too early"),
        (file(&format!("{text}element vertex 3\nproperty float x\n"), "0 0 0"), "without x, y and z"),
        (file(&format!("{text}element vertex 3\nproperty real x\n"), ""), "type of the property"),
        (file(&format!("{text}property float x\n"), ""), "property of no element"),
        (file("element vertex 3\n", ""), "no `format`"),
        (vertices(1, &format!("element vertex 1\n{XYZ}"), "0 0 0 0 0 0"), "a second list of vertices"),
        (faces(&format!("{three}-3 0 1 2")), "-3 is not the length of a list"),
        (faces(&format!("{three}2 0 1")), "at least three corners"),
        (faces("0 0 nan 1 0 0 0 1 0 3 0 1 2"), "which is no point"),
        (file("format ascii 1.0\nelement vertex -3\n", ""), "not a count"),
        (read_bytes(b"plx\n"), "not a PLY file"),
        (read_bytes(b"ply\nformat ascii 1.0\n"), "ends too early"),
    ];
    for (result, what) in cases {
        let error = result.err().unwrap_or_else(|| panic!("{what}"));
        assert!(error.contains(what) && error.contains("m.ply"), "{what}: {error}");
    }
    // A file of another kind has no place where it went wrong.
    assert!(!read_bytes(b"plx\n").unwrap_err().contains("byte"));
    // Elements without properties take no bytes, and no time.
    let empty =
        format!("{text}element nothing 99999999999999\nelement vertex 3\n{XYZ}element face 1\n{FACE}");
    assert_eq!(file(&empty, &format!("{three}3 0 1 2")).unwrap().triangles.len(), 1);
}

#[test]
fn placed_models_turn_their_normals_and_keep_their_coordinates() {
    let folder = Folder::new();
    image::RgbImage::new(1, 1).save(folder.path("p.png")).unwrap();
    let more = properties("float", "nx ny nz s t red green blue");
    let corners = "0 0 0  1.2 0 1.6  0.25 0.125  1 0 0\n1 0 0  0 1.2 1.6  0.5 0.125  0 1 0\n\
                   0 1 0  0 -1.2 1.6  0.25 0.75  0 0 1\n3 0 1 2\n";
    folder.write("m.ply", ascii(3, &format!("{more}element face 1\n{FACE}"), corners));
    let keys = r#""materials": { "p": { "type": "diffuse", "texture": "p.png" } }, "meshes": [
        { "model": "m.ply", "material": "p", "scale": 2, "rotate_degrees": [0, 0, 90], "translate": [0, 0, 1] } ]"#;
    let scene = in_file(folder.load_keys(keys).unwrap());
    let turned = [[0.0, 0.0, 1.0], [0.0, 2.0, 1.0], [-2.0, 0.0, 1.0]].map(Vec3::from);
    assert_eq!(scene.triangles[0].vertices, turned);
    assert_eq!(scene.uvs[0], [[0.25, 0.125], [0.5, 0.125], [0.25, 0.75]].map(Vec2::from), "v upwards");
    for (found, wanted) in scene.normals[0].iter().zip([[0.0, 0.6, 0.8], [-0.6, 0.0, 0.8], [0.6, 0.0, 0.8]]) {
        assert!(found.abs_diff_eq(wanted.into(), 1e-6), "{found}, not {wanted:?}");
    }
    assert_eq!(scene.materials.len(), 1, "its own material takes the colours' place");
}

#[test]
fn numbers_of_every_type_and_lists_of_other_names_have_their_place() {
    let header = "element strip 1\nproperty list uchar int vertex_indices\nelement vertex 3\nproperty short x\n\
                  property int y\nproperty char z\nproperty ushort red\nproperty ushort green\nproperty float blue\n\
                  element face 1\nproperty list uchar float texcoord\nproperty uchar vertex_index\n\
                  property list ushort uint vertex_indices\n";
    let mut numbers = vec![('c', 2.0), ('i', 7.0), ('i', 8.0)];
    for (x, y) in [(-300.0, -70_000.0), (300.0, -70_000.0), (-300.0, 70_000.0)] {
        numbers.extend([('s', x), ('i', y), ('b', -3.0), ('u', 65_535.0), ('u', 257.0), ('f', 2.0)]);
    }
    // Three coordinates are no corners, and 9 is no vertex.
    numbers.extend([('c', 3.0), ('f', 0.0), ('f', 1.0), ('f', 2.0)]);
    numbers.extend([('c', 9.0), ('u', 3.0), ('i', 0.0), ('i', 1.0), ('i', 2.0)]);
    for content in encoded(header, &numbers) {
        let scene = read_bytes(&content).unwrap();
        let wanted =
            [[-300.0, -70_000.0, -3.0], [300.0, -70_000.0, -3.0], [-300.0, 70_000.0, -3.0]].map(Vec3::from);
        assert_eq!((scene.triangles.len(), scene.triangles[0].vertices), (1, wanted));
        let texels = linear_texels(&scene.textures[0]);
        let dark = srgb_to_linear(1.0 / 255.0) as f32;
        assert!(texels.iter().any(|texel| texel[..3] == [1.0, dark, 1.0]), "{texels:?}");
    }
}

#[test]
fn what_is_not_read_is_a_warning_with_its_place_and_the_rest_is_shown() {
    let read = |header: &str, body: &str| {
        let scene = read_bytes(ascii(4, header, body).as_bytes()).unwrap();
        let warnings =
            scene.warnings.iter().map(|warning| warning.split_once("m.ply:").unwrap().1.to_string());
        (warnings.collect::<Vec<_>>(), area(&scene), scene)
    };
    let faces = &format!("element face 2\n{FACE}");
    let square = |end: &str| format!("0 0 0 {end} 1 0 0 {end} 1 1 0 {end} 0 1 0 {end} ");
    // Of what is not read.
    for number in ["nan", "-nan(ind)", "1.#QNAN", "inf"] {
        let (warnings, area, _) =
            read(&format!("property float q\n{faces}"), &(square(number) + "3 0 1 2 3 0 2 3"));
        assert_eq!((warnings, area), (vec!["7: the property `q` of `vertex` is not read.".to_string()], 1.0));
    }
    let (warnings, area, _) = read(faces, "0 0 nan 1 0 0 1 1 0 0 1 0 3 1 2 3 3 0 2 9");
    let left_out = " face 1: a face is left out: the face uses vertex 9, but the file has 4.";
    assert_eq!((warnings, area), (vec![left_out.to_string()], 0.5));
    let header = "comment TextureFile a b.png\nproperty list uchar int l\nelement edge 1\nproperty int a\n";
    let (warnings, area, _) = read(&format!("{header}{faces}"), &(square("2 7 7") + "5 4 0 1 2 3 2 0 1"));
    let texture = "7: `TextureFile` is not read, as there are no texture coordinates.";
    let list = "8: the property `l` of `vertex` is not read.";
    let edge = "9: the element `edge` is not read.";
    let face = " face 1: a face is left out: a face needs at least three corners.";
    assert_eq!((warnings, area), ([list, edge, texture, face].map(String::from).to_vec(), 1.0));
    // Colours of faces, a concave polygon.
    let (warnings, area, scene) = read(
        &format!("element face 1\n{FACE}{}", properties("uchar", "red green blue alpha")),
        "0 0 0 4 0 0 1 1 0 0 4 0 4 1 2 3 0 255 0 255 255",
    );
    assert_eq!((warnings, area), (vec!["12: the property `alpha` of `face` is not read.".to_string()], 4.0));
    let texels = linear_texels(&scene.textures[0]);
    assert!(texels.iter().all(|texel| texel[..3] == [1.0, 0.0, 1.0]), "{texels:?}");
    // Two strips of one front, the second with a turn.
    let strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    let (warnings, area, scene) = read(strips, &(square("") + "9 0 1 3 2 -1 0 0 3 1"));
    assert_eq!((warnings.len(), area, scene.triangles.len()), (0, 1.5, 3), "{warnings:?}");
}

#[test]
fn colours_of_every_type_have_the_scale_of_their_numbers() {
    let grey = srgb_to_linear(128.0 / 255.0) as f32;
    for (name, colors, wanted) in [
        ("int", "0 128 255", grey),
        ("ushort", "0 32896 65535", grey),
        ("uint", "0 2155905152 4294967295", grey),
        ("float", "0 128 255", grey),
        // A little above white is no other scale.
        ("float", "0 128 300", grey),
        ("double", "-1 0.5 1.5", 0.5),
    ] {
        let header = format!("element face 1\n{FACE}{}", properties(name, "red green blue"));
        let text = ascii(3, &header, &format!("0 0 0 1 0 0 0 1 0 3 0 1 2 {colors}\n"));
        let scene = read_bytes(text.as_bytes()).unwrap();
        let texels = linear_texels(&scene.textures[0]);
        let off = Vec3::from_slice(&texels[0]) - vec3(0.0, wanted, 1.0);
        assert!(off.abs().max_element() < 1e-6, "{name}: {texels:?}");
    }
}

/// Scans name their images in comments, with texture coordinates of vertices or of the corners of faces.
#[test]
fn images_that_comments_name_are_textures() {
    let folder = Folder::new();
    for (name, color) in [("a b.png", [255, 0, 0]), ("c.png", [0, 0, 255])] {
        image::RgbImage::from_pixel(1, 1, image::Rgb(color)).save(folder.path(name)).unwrap();
    }
    let read = |vertex: &str, face: &str, body: &str| {
        let images = "comment TextureFile a b.png\ncomment TextureFile c.png\ncomment TextureFile d.png\n";
        let header = format!("{images}{vertex}element face 4\n{FACE}{face}");
        let scene = load(&folder.write("m.ply", ascii(3, &header, body))).unwrap();
        let texture = |material: u32| scene.materials[material as usize].texture;
        let first = |texture: u32| scene.textures[texture as usize].texels.linear(0);
        let colors: Vec<_> =
            scene.triangles.iter().map(|triangle| texture(triangle.material).map(first)).collect();
        (colors, scene.uvs, scene.warnings)
    };
    let [red, blue] = [Some([1.0, 0.0, 0.0]), Some([0.0, 0.0, 1.0])];
    let uvs = [0.0, 1.0, 0.5].map(|v| Vec2::new(0.25, v));
    let st = &properties("float", "texture_u texture_v");
    let body = "0 0 0 0.25 0 1 0 0 0.25 1 0 1 0 0.25 0.5 ";
    let (colors, found, warnings) = read(st, "", &(body.to_string() + &"3 0 1 2 ".repeat(4)));
    assert_eq!((colors, found), (vec![red; 4], vec![uvs; 4]));
    assert!(warnings.len() == 1 && warnings[0].contains("m.ply:9: the texture `d.png`"), "{warnings:?}");
    let texcoord = "property list uchar float texcoord\nproperty int texnumber\n";
    let corners = "6 0.25 0 0.25 1 0.25 0.5";
    let faces = format!("3 0 1 2 {corners} 0 3 0 1 2 {corners} 1 3 0 1 2 0 -1 3 0 1 2 2 1 1 1");
    let (colors, found, warnings) = read("", texcoord, &format!("0 0 0 1 0 0 0 1 0 {faces}"));
    assert_eq!(colors, [red, blue, None, blue]);
    assert_eq!(found[..2], [uvs; 2]);
    assert!(warnings.iter().any(|warning| warning.contains("a `texcoord` that is not")), "{warnings:?}");
}
