//! OBJ and MTL: what they mean as scenes and as meshes in scenes, and the way back to a scene file.

use super::coordinates::in_file;
use crate::folder::Folder;
use glam::{Vec2, Vec3, vec3};
use octray::scene::{Material, MaterialKind, Scene, SceneError, Sky, Texels, Triangle, convert_model, load};
use std::path::Path;

fn load_obj(text: impl AsRef<[u8]>) -> Scene {
    let folder = Folder::new();
    in_file(folder.load("m.obj", text).unwrap_or_else(|error| panic!("{error}")))
}

/// The model of one triangle that uses a library's material `a`.
fn load_with_mtl(folder: &Folder, library: &str) -> Result<Scene, SceneError> {
    folder.write("m.mtl", library);
    folder.load("m.obj", format!("mtllib m.mtl\nusemtl a\n{ONE}"))
}

fn one_material(scene: &Scene) -> &Material {
    &scene.materials[scene.triangles[0].material as usize]
}

const ONE: &str = "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n";

#[test]
fn obj_alone_is_framed_under_a_plain_sky() {
    let scene = load_obj("v -1 -1 -1\nv 3 -1 -1\nv 3 5 2\nf 1 2 3\n");
    assert_eq!(scene.name, "m.obj");
    assert_eq!((scene.resolution, scene.max_bounces), ([240, 135], 8));
    // Brighter above than below, and grey: form shows, colours stay.
    let Sky::Gradient { bottom, top } = scene.sky else { panic!("{:?}", scene.sky) };
    assert_eq!((top, bottom), (Vec3::ONE, Vec3::splat(bottom.x)));
    assert!((0.01..0.2).contains(&bottom.x), "{bottom}");
    // Bounds from (-1,-1,-1) to (3,5,2): centre (1, 2, 0.5), diagonal sqrt(16 + 36 + 9).
    let center = vec3(1.0, 2.0, 0.5);
    let position = center + 1.2 * 61.0_f32.sqrt() / 3.5_f32.sqrt() * vec3(1.0, 0.5, 1.5);
    assert_eq!((scene.camera.look_at, scene.camera.vertical_fov), (center, 40.0));
    assert!(scene.camera.position.distance(position) < 1e-5, "{}", scene.camera.position);
    let material = one_material(&scene);
    assert_eq!((material.kind, material.color), (MaterialKind::Diffuse, Vec3::splat(0.8)));
}

#[test]
fn convex_polygons_become_fans_around_their_first_corner() {
    let scene = load_obj("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n");
    let [a, b, c, d, e] = [[0., 0.], [2., 0.], [3., 1.], [2., 2.], [0., 2.]].map(|[x, y]| vec3(x, y, 0.0));
    let triangles: Vec<[Vec3; 3]> = scene.triangles.iter().map(|triangle| triangle.vertices).collect();
    assert_eq!(triangles, [[a, b, c], [a, c, d], [a, d, e]]);
}

#[test]
fn negative_indices_count_back_from_the_latest() {
    let scene = load_obj("v 9 9 9\nv 0 0 0\nv 2 0 0\nv 0 2 0\nf -3 -2 -1\nv 0 0 5\nf -1 -3 -2\n");
    assert_eq!(scene.triangles[0].vertices, [Vec3::ZERO, 2.0 * Vec3::X, 2.0 * Vec3::Y]);
    assert_eq!(scene.triangles[1].vertices, [5.0 * Vec3::Z, 2.0 * Vec3::X, 2.0 * Vec3::Y]);
}

#[test]
fn statements_in_the_wild_are_read_or_passed_over() {
    let text = b"\xef\xbb\xbf# caf\xe9 in Latin-1\r\no thing\r\ng a b\r\ns 1\r\nv 0 0 0 1.0\r\nv 2 0 0 0.5 0.5 0.5\r\n\
        \tv  0\t2 0\r\nvt 0.5\r\nvn 0 1 1\r\nl 1 2\r\np 1\r\nf 1//1 2//1 \\\r\n 3//1\r\n\r\n";
    let scene = load_obj(text);
    assert_eq!(scene.triangles[0].vertices, [Vec3::ZERO, 2.0 * Vec3::X, 2.0 * Vec3::Y]);
    assert_eq!(scene.normals, [[vec3(0.0, 1.0, 1.0).normalize(); 3]]);
}

#[test]
fn normals_count_where_they_are_whole_and_the_triangle_is_not_flat() {
    // Off by what six digits round, and pointing backwards.
    for normal in ["0 0 1", "0 0 -2", "0.00001 0 1"] {
        let scene = load_obj(format!("v 0 0 0\nv 2 0 0\nv 0 2 0\nvn {normal}\nf 1//1 2//1 3//1\n"));
        assert!(scene.normals.is_empty(), "{normal}: {:?}", scene.normals);
    }
    let faces = "f 1//1 2//1 3//1\nf 1//1 2 3//1\nf 1//2 2//1 3//1\n";
    let scene = load_obj(format!("v 0 0 0\nv 2 0 0\nv 0 2 0\nvn 0 3 3\nvn 0 0 0\n{faces}"));
    let tilted = vec3(0.0, 1.0, 1.0).normalize();
    assert_eq!(scene.normals, [[tilted; 3], [Vec3::ZERO; 3], [Vec3::ZERO; 3]]);
}

#[test]
fn groups_and_materials_of_the_mtl_reach_their_triangles() {
    let folder = Folder::new();
    folder.save_picture("mtl/wall.png");
    folder.write(
        "mtl/room.mtl",
        "newmtl wall\nKd 0.5 0.25 1\nmap_Kd -s 1 1 1 wall.png\nKs 1 1 1\nillum 2\n\nnewmtl lamp\nKd 0 0 0\n\
         Ke 4 3 2\nnewmtl mirror\nKd 0 0 0\nKs 0.9 0.8 0.7\nillum 3\nnewmtl bright\nKd 2 1 0.5\n",
    );
    let path = folder.write("m.obj",
        "mtllib mtl/room.mtl\nv 0 0 0\nv 2 0 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 0 1\no first\nf 1 2 3\nusemtl wall\n\
         f 1/1 2/2 3/3\nf 1 2 3\ng second\nusemtl lamp\nf 1/1 2/2 3/3\nusemtl mirror\nf 1 2 3\nusemtl bright\nf 1 2 3\n\
         usemtl nowhere\nf 1 2 3\nf 1 2 3\n",
    );
    let scene = load(&path).unwrap();
    let of = |i: usize| &scene.materials[scene.triangles[i].material as usize];
    let names: Vec<&str> = (0..8).map(|i| of(i).name.as_str()).collect();
    assert_eq!(names, ["default", "wall", "wall", "lamp", "mirror", "bright", "default", "default"]);
    assert_eq!((of(1).kind, of(1).color), (MaterialKind::Diffuse, vec3(0.5, 0.25, 1.0)));
    assert_eq!(scene.textures[of(1).texture.unwrap() as usize].name, "mtl/wall.png");
    assert_eq!((of(3).emission, of(3).color), (vec3(4.0, 3.0, 2.0), Vec3::ZERO));
    assert_eq!((of(4).kind, of(4).color), (MaterialKind::Metal { roughness: 0.0 }, vec3(0.9, 0.8, 0.7)));
    assert_eq!(of(5).color, vec3(1.0, 1.0, 0.5));
    // Given coordinates stay, missing ones are planar (seen from +z: u = x, v = y), untextured triangles have
    // zeros.
    assert_eq!(scene.uvs[1], [Vec2::ZERO, Vec2::X, Vec2::Y]);
    assert_eq!(scene.uvs[2], [Vec2::ZERO, 2.0 * Vec2::X, 2.0 * Vec2::Y]);
    assert_eq!((scene.uvs[0], scene.uvs[3], scene.uvs.len()), ([Vec2::ZERO; 3], [Vec2::ZERO; 3], 8));
    assert_eq!(scene.warnings.len(), 2, "{:?}", scene.warnings);
    assert!(scene.warnings[0].contains("`bright`") && scene.warnings[1].contains("`nowhere`"));
}

/// The warnings of a scene, from the line in this file on.
fn warnings(folder: &Folder, file: &str, scene: &Scene) -> Vec<String> {
    scene.warnings.iter().map(|warning| warning.replacen(&folder.name(file), "", 1)).collect()
}

/// The material of a triangle that uses an MTL of one material, and the warnings.
fn with_material(statements: &str) -> (MaterialKind, Vec3, Vec<String>) {
    let folder = Folder::new();
    let scene = load_with_mtl(&folder, &format!("newmtl a\n{statements}")).unwrap();
    let material = one_material(&scene);
    assert!(material.texture.is_none());
    (material.kind, material.color, warnings(&folder, "m.mtl", &scene))
}

#[test]
fn what_clearly_means_glass_is_glass() {
    for (statements, ior) in [
        ("illum 7\nNi 1.33", 1.33),
        ("illum 6\n", 1.5),
        ("illum 6\nNi 0", 1.5),
        ("illum 7\nd 1", 1.5),
        ("illum 4\nTf 0.5 0.5 0.5\nTf 0 0 0", 1.5),
        ("illum 4\nTr 1\nNi 1.7", 1.7),
        ("illum 9\nd 0.9", 1.5),
        ("d 0.1\nNi 1.45\nillum 2", 1.45),
        ("Tr 0.8\nNi 1.2", 1.2),
    ] {
        let (kind, color, warnings) = with_material(&format!("Kd 0.2 0.3 0.4\n{statements}\n"));
        assert_eq!((kind, color), (MaterialKind::Glass { ior }, Vec3::ONE), "{statements}");
        assert!(warnings.is_empty(), "{statements}: {warnings:?}");
    }
    let (_, color, _) = with_material("illum 7\nTf 0.5 0.75 2\n");
    assert_eq!(color, vec3(0.5, 0.75, 1.0));
    assert_eq!(with_material("illum 7\nTf 0 0 0\n").1, Vec3::ONE, "black glass is no glass");
}

#[test]
fn what_clearly_means_metal_or_plastic_is_that() {
    let metal = |roughness| MaterialKind::Metal { roughness };
    let plastic = |roughness, ior| MaterialKind::Plastic { roughness, ior };
    let kd = vec3(0.5, 0.25, 1.0);
    for (statements, kind, color) in [
        ("illum 3\nKs 0.9 0.8 0.7\nPr 0.25", metal(0.25), vec3(0.9, 0.8, 0.7)),
        ("Pm 1\nPr 0.3\nKs 1 1 1\nPc 0\nPcr 0.03\naniso 0", metal(0.3), kd),
        ("Pm 0.5", metal(0.5), kd),
        ("Pm 0.4\nPr 0.3", plastic(0.3, 1.5), kd),
        ("Pr 2\nNi 1.8", plastic(1.0, 1.8), kd),
        // √(2 / 32) is a quarter, whose root is a half.
        ("Ks 0.1 0.1 0.1\nNs 30\nillum 2\nNi 7", plastic(0.5, 1.5), kd),
        ("Ks 0.1 0.1 0.1\nNs 30\nNi 1", plastic(0.5, 1.5), kd),
        ("Ks 0 0 0\nNs 30\nillum 2", MaterialKind::Diffuse, kd),
        ("Ks 1 1 1\nNs 0\nillum 2", MaterialKind::Diffuse, kd),
        ("Ks 1 1 1\nNs 30\nillum 1", MaterialKind::Diffuse, kd),
    ] {
        let (found, shade, warnings) = with_material(&format!("Kd 0.5 0.25 1\n{statements}\n"));
        assert_eq!((found, shade), (kind, color), "{statements}");
        let layers: Vec<&String> = warnings.iter().filter(|w| !w.contains("`Pcr`")).collect();
        assert!(layers.is_empty(), "{statements}: {warnings:?}");
    }
    assert_eq!(with_material("Pc 0.5\n").2, [":2: `Pc` is not read."]);
}

#[test]
fn maps_of_the_mtl_are_read_as_numbers() {
    let folder = Folder::new();
    image::RgbImage::from_pixel(2, 1, image::Rgb([51, 128, 255])).save(folder.path("n.png")).unwrap();
    let library = "newmtl a\nmap_Kd n.png\nmap_Pr n.png\nnorm -bm 1 n.png\n";
    let scene = load_with_mtl(&folder, library).unwrap();
    let material = one_material(&scene);
    assert_eq!(material.kind, MaterialKind::Plastic { roughness: 1.0, ior: 1.5 });
    // One file, two meanings.
    assert_eq!((material.texture, material.roughness_map, material.normal_map), (Some(0), Some(1), Some(1)));
    assert_eq!(scene.textures[1].texels, Texels::Unorm8(vec![[51, 128, 255, 0]; 2]));
    assert_eq!(scene.textures[0].texels, Texels::Srgb8(vec![[51, 128, 255, 0]; 2]));
    assert!((scene.textures[1].texels.linear(0)[0] - 0.2).abs() < 1e-9);
}

#[test]
fn what_is_left_out_of_a_material_is_a_warning_with_its_line() {
    for (statements, warning) in [
        ("d 0\n", ":2: a material without opacity is invisible."),
        ("illum 7\nmap_d p.png\n", ":3: glass is shown without its `map_d`."),
        ("illum 4\nKs 1 1 1\n", ":2: `illum 4` is shown diffuse: a mirror is `illum 3`, glass `illum 7`."),
        ("illum 7\nNi 1.0\n", ":3: glass with `Ni 1` does not refract and is invisible."),
        ("illum 7\nmap_Kd p.png\n", ":3: glass is shown without its `map_Kd`."),
        ("Kd spectral\n", ":2: `Kd` is left out: `spectral` is not a number."),
        ("Kd 1 1\n", ":2: `Kd` is left out: a colour needs 3 numbers."),
        ("Ns 5\nTf 0.5 1 1\n", ":3: `Tf` is read only for glass."),
        ("illum 10\n", ":2: `illum 10` is not read."),
        ("map_Kd\n", ":2: `map_Kd` is left out: there is no file name."),
        ("newmtl a\n", ":2: a second material of one name replaces the first."),
        ("map_Kd -t 0.5 -s 1 1 1 p.png\n", ":2: the option `-t` of `map_Kd` is not read."),
        ("map_Kd gone.png\n", ": no such file"),
        ("disp b.png\nPm 1\ndisp c.png\n", ":2: `disp` is not read (1 more like it)."),
    ] {
        let (kind, _, warnings) = with_material(statements);
        assert!(warnings[0].contains(warning), "{statements}: {warnings:?}");
        assert_eq!(matches!(kind, MaterialKind::Glass { .. }), warning.contains(": glass "));
    }
    // Maya's, of an opaque material.
    let maya = "illum 4\nKd 0.7 0.1 0.1\nKa 0 0 0\nTf 1.00 1.00 1.00\nNi 1.50\n";
    assert_eq!(with_material(maya), (MaterialKind::Diffuse, vec3(0.7, 0.1, 0.1), vec![]));
    let plastic = MaterialKind::Plastic { roughness: 0.5, ior: 1.5 };
    assert_eq!(with_material(&format!("{maya}Ks 0.5 0.5 0.5\nNs 30\n")).0, plastic);
    let silent = "# note\nKa 1 1 1\nKs 1 1 1\nNs 20\nNi 1.45\nd 1\nTr 0\nTf 1 1 1\nillum 2\n\n";
    assert_eq!(with_material(silent).2, [""; 0]);
    assert_eq!(with_material("Tr 1\n").2, [""; 0], "what some programs write of opaque things");
}

#[test]
fn dissolve_is_opacity() {
    let folder = Folder::new();
    image::RgbaImage::from_raw(2, 1, vec![9, 9, 9, 51, 8, 8, 8, 255])
        .unwrap()
        .save(folder.path("a.png"))
        .unwrap();
    image::GrayImage::from_raw(2, 1, vec![51, 255]).unwrap().save(folder.path("g.png")).unwrap();
    image::RgbImage::from_raw(2, 1, vec![255; 6]).unwrap().save(folder.path("w.png")).unwrap();
    for (statements, opacity, is_mapped) in [
        ("d 0.75", 0.75, false),
        ("Tr 0.75", 0.25, false),
        ("Tr 0.75\nd 0.5", 0.5, false),
        ("d 2", 1.0, false),
        ("map_Kd a.png\nmap_d a.png", 1.0, true),
        ("map_d g.png\nd 0.5", 0.5, true),
        ("map_d w.png", 1.0, false),
        ("illum 7\nd 0.5", 1.0, false),
    ] {
        let scene = load_with_mtl(&folder, &format!("newmtl a\n{statements}\n")).unwrap();
        assert!(scene.warnings.is_empty(), "{statements}: {:?}", scene.warnings);
        let material = one_material(&scene);
        assert_eq!((material.opacity, material.opacity_map.is_some()), (opacity, is_mapped), "{statements}");
        let texels = material.opacity_map.map(|map| &scene.textures[map as usize].texels);
        assert!(
            texels.is_none_or(|texels| *texels == Texels::Unorm8(vec![[51, 51, 51, 0], [255, 255, 255, 0]]))
        );
    }
    let scene = load_with_mtl(&folder, "newmtl a\nmap_Kd a.png\n").unwrap();
    assert!(scene.warnings[0].contains("a.png: its transparency is left out"), "{:?}", scene.warnings);
}

#[test]
fn options_of_maps_come_before_names_that_may_hold_spaces() {
    for options in ["", "-s 1 1 1 ", "-o 0 0 -clamp off ", "-blendu on -mm 0 1 -bm 1.0 "] {
        let folder = Folder::new();
        image::RgbImage::new(1, 1).save(folder.path("a b.png")).unwrap();
        let scene = load_with_mtl(&folder, &format!("newmtl a\nmap_Kd {options}a b.png\n")).unwrap();
        assert_eq!((scene.textures[0].name.as_str(), scene.warnings.len()), ("a b.png", 0), "{options}");
    }
}

#[test]
fn tall_models_are_framed_whole_and_others_as_ever() {
    let column =
        |height: f32| format!("v 0 0 0\nv 1 0 0\nv 0 {height} 0\nv 0 {height} 1\nf 1 2 3\nf 2 3 4\n");
    for (height, least) in [(30.0, 0.9), (300.0, 0.9), (1.0, 0.3)] {
        let scene = load_obj(column(height));
        let camera = scene.camera;
        let forward = (camera.look_at - camera.position).normalize();
        let up = forward.cross(camera.up).cross(forward).normalize();
        let reach = |corner: Vec3| {
            let from = corner - camera.position;
            from.dot(up).abs() / from.dot(forward) / (camera.vertical_fov / 2.0).to_radians().tan()
        };
        let farthest =
            scene.triangles.iter().flat_map(|triangle| triangle.vertices).map(reach).fold(0.0, f32::max);
        assert!((least..0.99).contains(&farthest), "{height}: {farthest} of half the picture's height");
    }
}

#[test]
fn faults_that_leave_nothing_name_file_line_and_remedy() {
    let folder = Folder::new();
    let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (text, at, words) in [
        ("v 0 0\n", "line 1", "write 3 numbers"),
        ("v 0 0 0\nv 1 x 0\n", "line 2", "`x` is not a number"),
        ("v 0 0 0\n\n# note\nv nan 0 0\n", "line 4", "-1e18 to 1e18"),
        ("v 0 1e19 0\n", "line 1", "-1e18 to 1e18"),
        ("v 0 0 0\nvn 0 nan 0 # north\nf 1 2\n", "line 2", "-1e18 to 1e18"),
        ("v 0 0 0\nvt\n", "line 2", "write 1 numbers"),
        (&format!("{three}f 1 2 4\n"), "line 4", "vertex 4, but the file has 3"),
        (&format!("{three}f 1 2 0\n"), "line 4", "count from 1"),
        (&format!("{three}f 1 2 -4\n"), "line 4", "back from -1"),
        (&format!("{three}f 1//9999999999 2 3\n"), "line 4", "count from 1"),
        ("v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3", "three corners"),
        ("v 0 0 0\nf 1 2 a\n", "line 2", "v/vt/vn"),
        ("v 0 0 0\n", "", "with faces"),
        ("v 0 0 0\nf 1 1 1\n", "", "zero area"),
    ] {
        folder.assert_refused("m.obj", text, at, words);
    }
    // The file is the model's, in a conversion and in a scene that uses it.
    let broken = folder.write("m.obj", "v 0 0 0\nf 1 2 3\n");
    let error = convert_model(Path::new(&broken), &folder.path("s.json")).err().unwrap();
    for error in [error, folder.load_keys(r#""meshes": [ { "obj": "m.obj" } ]"#).unwrap_err()] {
        assert_eq!((error.file.as_deref(), error.at.as_deref()), (Some(Path::new(&broken)), Some("line 2")));
    }
    let gone = convert_model(&folder.path("gone.obj"), &folder.path("s.json"));
    assert!(gone.err().unwrap().what.contains("no such file"));
}

/// The warnings about what is left out of a model, and the area of the rest.
fn rest_of(text: impl AsRef<[u8]>) -> (Vec<String>, f32) {
    let folder = Folder::new();
    let scene = folder.load("m.obj", text).unwrap_or_else(|error| panic!("{error}"));
    (warnings(&folder, "m.obj", &scene), area(&scene))
}

/// Of all triangles; where they lie in one plane, their fronts on one side.
pub fn area(scene: &Scene) -> f32 {
    let areas = scene.triangles.iter().map(|Triangle { vertices: [a, b, c], .. }| (b - a).cross(c - a) / 2.0);
    let (sum, total) =
        areas.fold((Vec3::ZERO, 0.0), |(sum, total), area| (sum + area, total + area.length()));
    assert!((sum.length() - total).abs() < 1e-4, "{sum}, {total}");
    total
}

#[test]
fn what_is_left_out_of_a_model_is_a_warning_with_its_line() {
    for (text, warning) in [
        ("vn -nan(ind) 0 0\nf 1//1 2//1 3//1", ":4: `vn` is left out: `-nan(ind)` is not a number."),
        ("f 1 2\nf 1 3", ":4: a face is left out: a face needs at least three corners (1 more like it)."),
        ("f 1 2 x", ":4: `f` is left out: `x` is not the corner of a face."),
        ("f 1 2 9", ":4: a face is left out: the face uses vertex 9, but the file has 3."),
        ("f 1 2 -9", ":4: `f` is left out: the face uses index -9, but 3 such entries are defined above it."),
        (
            "f 1/7 2 3",
            ":4: texture coordinate is left out: the face uses texture coordinate 7, but the file has 0.",
        ),
        ("vt 0 0 0.5", ":4: the third coordinate of `vt` is not read."),
        ("v 0 0 0 0.5", ":4: the weight or opacity of `v` is not read."),
        ("v 0 0 0 1 0 x", ":4: the colour of `v` is left out: `x` is not a number."),
        ("s 1", ":4: `s` is not read: faces without normals (`vn`) are flat."),
        ("usemtl gone # sic", ":4: the material `gone # sic` is not defined; a default is used."),
        ("mtllib gone.mtl", ":4: cannot read the materials `gone.mtl`: no such file."),
        ("f 1 1 2\nf 1 1 3\nf 1 2 2", "3 triangles of zero area"),
    ] {
        let (warnings, area) = rest_of(format!("v 0 0 0\nv 2 0 0\nv 0 2 0\n{text}\nf 1 2 3\n"));
        let is_said = warnings.len() == 1 && warnings[0].contains(warning);
        assert!(is_said && area >= 2.0, "{text}: {warnings:?}");
    }
    let silent = "o a\ng b c\ns off\nlod 0\nbevel off\nv nan 0 0\nvt 0 0 0\nv 0 0 0 1.0\n";
    let (warnings, area) = rest_of(format!("{silent}v 2 0 0\nv 0 2 0\nf 2 3 4\nf 1 2 3\n"));
    let point = ":6: `v` is left out: `nan` is not a number that a scene can hold.";
    let face = ":12: a face is left out: the face uses vertex 1, which is no point.";
    assert_eq!((warnings, area), (vec![point.to_string(), face.to_string()], 2.0));
}

#[test]
fn polygons_of_any_form_keep_their_area() {
    for (points, area) in [
        ("0 0, 3 0, 3 3, 2 3, 2 1, 1 1, 1 3, 0 3", 7.0),
        ("0 3, 1 3, 1 1, 2 1, 2 3, 3 3, 3 0, 0 0", 7.0),
        ("0 0, 2 0, 4 0, 4 4, 2 4, 2 4, 2 2, 0 2, 0 0", 12.0),
        ("0 0, 4 0, 4 1, 4 2, 4 4, 0 4, 0 2", 16.0),
        // A square hole, joined to the outline by an edge that is walked twice.
        ("0 0, 3 0, 3 3, 0 3, 0 0, 1 1, 1 2, 2 2, 2 1, 1 1", 8.0),
    ] {
        // Flat, on an inclined plane that is √2 as large, and far away.
        for (form, scale) in [("v {} 0\n", 1.0), ("v {0} {1} {0}\n", 2_f32.sqrt()), ("v 500000 {}\n", 1.0)] {
            let point = |point: &str| {
                let (x, y) = point.trim().split_once(' ').unwrap();
                form.replace("{}", point.trim()).replace("{0}", x).replace("{1}", y)
            };
            let mut text: String = points.split(',').map(point).collect();
            text += &(1..=points.split(',').count()).fold("f".to_string(), |face, i| format!("{face} {i}"));
            let found = rest_of(&text).1;
            assert!((found - area * scale).abs() < 1e-4, "{text}: {found}, not {}", area * scale);
        }
    }
}

#[test]
fn a_comment_begins_at_any_hash_that_is_not_part_of_a_name() {
    let folder = Folder::new();
    folder.write("m#1.mtl", "newmtl red # of a kind\nKd 1 0 0 # red\nnewmtl a #2\nKd 0 1 0#green\n");
    let text = format!("{}# C:\\dir\\\nusemtl red#!\nf 1 2 3 # a\nusemtl a #2\nf 1 2 3#b\n", &ONE[..24]);
    for library in ["m#1.mtl", "m#1.mtl # note", "gone.mtl m#1.mtl # note"] {
        let scene = folder.load("m.obj", format!("mtllib {library}\n{text}")).unwrap();
        let colors = scene.triangles.iter().map(|triangle| scene.materials[triangle.material as usize].color);
        assert_eq!(colors.collect::<Vec<_>>(), [Vec3::X, Vec3::Y], "{library}: {:?}", scene.warnings);
    }
}

#[test]
fn files_named_on_another_machine_are_found() {
    let folder = Folder::new();
    folder.save_picture("Wood.png");
    folder.save_picture("maps/tile#1.png");
    folder.write("mtl/m.mtl", "");
    for (name, found) in [
        ("maps/tile#1.png", "maps/tile#1.png"),
        ("maps\\tile#1.png # old", "maps/tile#1.png"),
        ("MAPS/Tile#1.PNG", "maps/tile#1.png"),
        ("C:\\x y\\WOOD.PNG", "Wood.png"),
        ("/home/x/wood.png", "Wood.png"),
    ] {
        folder.write("m.mtl", format!("newmtl a\nKd 0 0 0\nmap_Kd {name}\n"));
        let scene = folder.load("m.obj", format!("mtllib .\\M.mtl\nusemtl a\n{ONE}")).unwrap();
        assert_eq!(scene.textures.first().map(|texture| texture.name.as_str()), Some(found), "{name}");
        assert_eq!(one_material(&scene).color, Vec3::ONE, "black beside a texture");
        assert!(scene.warnings.is_empty(), "{name}: {:?}", scene.warnings);
    }
}

#[test]
fn colours_of_vertices_are_display_values_that_multiply_the_material() {
    let folder = Folder::new();
    folder.write("m.mtl", "newmtl a\nKd 0.5 0.5 0.5\nnewmtl b\nmap_Kd p.png\n");
    folder.save_picture("p.png");
    for (white, grey) in [("1", "0.501961"), ("255", "128")] {
        let text = format!("mtllib m.mtl\nv 0 0 0 {white} 0 0\nv 1 0 0 0 {grey} 0\nv 0 1 0\n");
        let scene = folder.load("m.obj", format!("{text}usemtl a\nf 1 2 3\n")).unwrap();
        assert_eq!(one_material(&scene).color, Vec3::splat(0.5));
        let Texels::Float32(texels) = &scene.textures[1].texels else { panic!("linear") };
        let near = |at: usize, color: [f32; 3]| Vec3::from_slice(&texels[at]).abs_diff_eq(color.into(), 1e-4);
        assert!(near(0, [1.0, 0.0, 0.0]) && near(1, [0.0, 0.21586, 0.0]) && near(2, [1.0; 3]), "{texels:?}");
        let scene = folder.load("m.obj", format!("{text}usemtl b\nf 1 2 3\n")).unwrap();
        let warning = "m.obj:2: vertex colours are left out, as `b` has textures.";
        assert!(scene.warnings[0].ends_with(warning), "{:?}", scene.warnings);
    }
}

/// A scene file with one mesh entry and a material.
fn load_mesh(folder: &Folder, mesh: &str) -> Scene {
    let red = r#""materials": { "red": { "type": "diffuse", "color": [1,0,0] } }"#;
    in_file(folder.load_keys(&format!(r#"{red}, "meshes": [ {mesh} ]"#)).unwrap())
}

#[test]
fn mesh_is_scaled_then_turned_about_x_y_z_then_moved() {
    let folder = Folder::new();
    folder.write("one.obj", "v 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\n");
    let of = |keys: &str| load_mesh(&folder, &format!(r#"{{ "obj": "one.obj", {keys} }}"#));
    let vertices = |keys: &str| of(keys).triangles[0].vertices;
    // About x by 90 degrees: y goes to z, z to -y. About y: z to x, x to -z. About z: x to y, y to -x.
    assert_eq!(vertices(r#""rotate_degrees": [90, 0, 0]"#), [Vec3::X, Vec3::Z, -Vec3::Y]);
    assert_eq!(vertices(r#""rotate_degrees": [0, 90, 0]"#), [-Vec3::Z, Vec3::Y, Vec3::X]);
    assert_eq!(vertices(r#""rotate_degrees": [0, 0, 90]"#), [Vec3::Y, -Vec3::X, Vec3::Z]);
    // x first: (y to z), then y: (z to x). The other order would leave y where z takes it: at z.
    assert_eq!(vertices(r#""rotate_degrees": [90, 90, 0]"#), [-Vec3::Z, Vec3::X, -Vec3::Y]);
    let all = vertices(r#""scale": 3, "rotate_degrees": [0, 0, -90], "translate": [10, 0, 0]"#);
    assert_eq!(all, [[10.0, -3.0, 0.0], [13.0, 0.0, 0.0], [10.0, 0.0, 3.0]].map(Vec3::from));
    assert_eq!(of(r#""scale": 3, "rotate_degrees": [90, 0, 0]"#).normals, [[Vec3::Z; 3]]);
}

#[test]
fn mesh_material_overrides_the_models_own() {
    let folder = Folder::new();
    folder.write("m.mtl", "newmtl blue\nKd 0 0 1\n");
    folder.write("one.obj", format!("mtllib m.mtl\nusemtl blue\n{ONE}"));
    let color = |mesh: &str| one_material(&load_mesh(&folder, mesh)).color;
    assert_eq!(color(r#"{ "obj": "one.obj", "material": "red" }"#), Vec3::X);
    assert_eq!(color(r#"{ "obj": "one.obj" }"#), Vec3::Z);
}

#[test]
fn converted_model_loads_as_the_same_scene() {
    let folder = Folder::new();
    folder.save_picture("models/p.png");
    let awkward =
        "v 0.1 1e-30 -3.4028e10\nv 16.32150076329708 28.073750436306 -24.97914992272854\nv 1e17 0.3 7e-9\n";
    folder.write("models/m.mtl",
        "newmtl a \"quoted\"\nKd 0.1 0.7 0.3\nmap_Kd p.png\nnewmtl lamp\nKe 0.1 100 3e9\nnewmtl mirror\nillum 3\n",
    );
    let text = format!(
        "mtllib m.mtl\n{awkward}vt 0.1 0.9\nvt 1e-7 3\nvt -0.3 0.2\nusemtl a \"quoted\"\nf 1/1 2/2 3/3\nf 3 2 1\n\
         usemtl lamp\nf 1 2 3\nusemtl mirror\nf 1 3 2\nusemtl unknown\nf 1 2 3\n"
    );
    let model = folder.write("models/m.obj", text);
    let direct = load(&model).unwrap();

    // Beside the model and elsewhere.
    for (name, picture) in [("models/scene.json", "p.png"), ("scenes/deep/scene.json", "../../models/p.png")]
    {
        let converted = convert_model(Path::new(&model), &folder.path(name)).unwrap().text;
        let converted = folder.load(name, converted).unwrap();
        // Everything but the names of textures, which depend on the folder.
        let short = |scene: &Scene| {
            (scene.camera, scene.resolution, scene.max_bounces, scene.sky, scene.textures.len())
        };
        assert_eq!(short(&direct), short(&converted));
        let long = |scene: &Scene| (scene.triangles.clone(), scene.materials.clone(), scene.uvs.clone());
        assert_eq!(long(&direct), long(&converted));
        assert_eq!(converted.textures[0].name, picture);
    }
}
