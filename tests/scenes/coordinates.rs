//! Where coordinates stand: scenes anywhere and of any size are the same scene.

use crate::folder::Folder;
use glam::{DVec3, dvec3};
use octray::render::{Renderer, Settings};
use octray::scene::{Coordinates, Scene, View, load_with_view};
use serde_json::{Value, json};

/// The scene in the coordinates of its file, as far as single precision holds them.
pub fn in_file(mut scene: Scene) -> Scene {
    let Coordinates { unit, .. } = scene.coordinates;
    let place = |point: &mut glam::Vec3| *point = scene.coordinates.to_file(point.as_dvec3()).as_vec3();
    scene.triangles.iter_mut().flat_map(|triangle| &mut triangle.vertices).for_each(place);
    scene.portals.iter_mut().flat_map(|portal| &mut portal.vertices).for_each(place);
    for sphere in &mut scene.spheres {
        place(&mut sphere.center);
        sphere.radius *= unit as f32;
    }
    [&mut scene.camera.position, &mut scene.camera.look_at].into_iter().for_each(place);
    scene
}

/// What rays see of it.
fn seen(scene: &Scene) -> String {
    format!("{:?}", (&scene.camera, &scene.spheres, &scene.triangles, &scene.uvs, &scene.normals))
}

/// A native scene with what is given for its camera, at this place and of this scale.
fn scene(folder: &Folder, mut camera: Value, translate: [f64; 3], scale: f64) -> Scene {
    folder.write("m.obj", "v 0.5 0.25 0\nv 2.125 0 7\nv 0.75 2 1.5\nf 1 2 3\n");
    let point = |p: [f64; 3]| json!([0, 1, 2].map(|axis| p[axis] * scale + translate[axis]));
    for key in ["position", "look_at"] {
        if let Some(p) = camera.get_mut(key) {
            *p = point(serde_json::from_value(p.clone()).unwrap());
        }
    }
    let corners = [[1.0, 2.0, 3.0], [1.5, 2.0, -3.0], [0.0, 0.0, 8.25]];
    let text = json!({
        "format": "octray-1",
        "camera": camera,
        "spheres": [{ "center": point([0.25, -3.5, 1.0]), "radius": 1.5 * scale }],
        "triangles": [{ "vertices": corners.map(point) }],
        "meshes": [{ "model": "m.obj", "scale": 0.5 * scale, "translate": point([-1.0, 0.125, 9.0]) }],
    });
    folder.load("s.json", text.to_string()).unwrap()
}

#[test]
fn scenes_are_the_same_wherever_they_stand_and_at_any_size() {
    let folder = Folder::new();
    let [position, look_at] = [[1.25, 2.5, 30.0], [0.5, 0.75, 0.0]];
    let whole = json!({ "position": position, "look_at": look_at });
    for camera in [whole, json!({ "position": position }), json!({ "look_at": look_at }), json!({})] {
        let here = seen(&scene(&folder, camera.clone(), [0.0; 3], 1.0));
        for place in [[1024.0, -0.5, 3e6], [-4e9, 5_411_873.25, 1.0]] {
            assert_eq!(seen(&scene(&folder, camera.clone(), place, 1.0)), here, "{camera} {place:?}");
        }
        // Beyond the usual sizes, all are brought to the same.
        let [small, large] =
            [-60.0, 50.0].map(f64::exp2).map(|size| scene(&folder, camera.clone(), [0.0; 3], size));
        assert_eq!(seen(&small), seen(&large), "{camera}");
    }
}

#[test]
fn models_in_coordinates_of_a_map_keep_every_digit() {
    let folder = Folder::new();
    let at = |x: f64, z: f64| {
        let of = |[a, b, c]: [f64; 3]| format!("v {} {b} {}\n", a + x, c + z);
        let vertices = [[0.5, 0.25, 0.0], [2.125, 0.0, 7.0], [0.75, 2.0, 1.5]].map(of).concat();
        folder.load("m.obj", vertices + "f 1 2 3\n").unwrap()
    };
    let far = at(447_321.5, -5_411_873.25);
    assert_eq!(seen(&far), seen(&at(0.0, 0.0)));
    assert_eq!(far.coordinates.origin.to_array(), [447_322.0, 0.25, -5_411_873.25]);
    assert!(far.warnings.is_empty());
    // Placed by a scene that moves it home, or elsewhere.
    let placed = |translate: [f64; 3]| {
        let mesh = json!({ "model": "m.obj", "translate": translate });
        folder.load_keys(&format!(r#""meshes": [{mesh}]"#)).unwrap()
    };
    at(447_321.5, -5_411_873.25);
    for translate in [[0.0, 10.0, 0.0], [-447_321.5, 0.0, 5_411_873.25]] {
        let scene = placed(translate);
        let sides =
            |scene: &Scene| scene.triangles[0].vertices.map(|vertex| vertex - scene.triangles[0].vertices[0]);
        assert_eq!(sides(&scene), sides(&far), "{translate:?}");
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
}

#[test]
fn a_line_of_sight_gives_one_picture_whatever_point_of_it_is_named() {
    let folder = Folder::new();
    let seen = |direction: DVec3, distance: f64, fov: f64| {
        let (near, away) = if fov < 1.0 { (0.0, 1e5) } else { (5.0, 0.0) };
        let position = dvec3(0.0, 1.0, near) - direction * away;
        let look_at = (position + direction * distance).to_array();
        let camera = json!({ "position": position.to_array(), "look_at": look_at, "vertical_fov": fov });
        let keys = r#""spheres": [{ "center": [0,1,0], "radius": 1 }],
            "triangles": [{ "vertices": [[-9,0,9],[9,0,9],[0,0,-20]] }]"#;
        let scene = folder.load_keys(&format!(r#""camera": {camera}, {keys}"#)).unwrap();
        let renderer = Renderer::new(&scene, Settings { resolution: [48, 27], ..Settings::of(&scene) });
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 1);
        ((scene.camera.look_at - scene.camera.position).normalize(), film.picture().hash(), scene)
    };
    let lines = [DVec3::NEG_Z, dvec3(-0.1, -0.03, -1.0)].map(|direction| (direction, 40.0));
    let narrow = [DVec3::NEG_Z, dvec3(-0.4, -0.3, -1.0)].map(|direction| (direction, 2e-3));
    for (direction, fov) in lines.into_iter().chain(narrow) {
        let [near, far] = [5.0, 1e5].map(|distance| seen(direction, distance, fov));
        assert!(near.0.distance(far.0) < 2e-7, "{direction}");
        assert!(direction.x != 0.0 || near.1 == far.1, "{direction}, {fov}");
        // What is rounded is seen from near.
        assert!(near.2.spheres[0].center.length() < 10.0, "{:?}", near.2.coordinates);
        for distance in [1e6, 1e7, 1e9, 1e17] {
            assert_eq!(seen(direction, distance, fov).1, far.1, "{direction}, {distance}");
        }
    }
}

#[test]
fn cameras_far_from_the_origin_are_warned_of() {
    let folder = Folder::new();
    folder.load_keys(r#""spheres": [{ "center": [0,0,0], "radius": 1 }]"#).unwrap();
    let camera = r#""camera": { "position": [5e6, 1, 5], "look_at": [5e6, 1, 0] }"#;
    let view = |keys: &str| format!(r#"{{ "format": "octray-view-1", "scene": "scene.json", {keys} }}"#);
    for keys in [camera.to_string(), format!(r#""keyframes": [{{ "frame": 1, {camera} }}]"#)] {
        let warning = folder.load("v.json", view(&keys)).unwrap().warnings.concat();
        assert!(warning.contains("rounded to 6.0e-1") && warning.contains("`origin`"), "{warning}");
    }
    let keys = r#""origin": [1e7, 0, 0], "spheres": [{ "center": [0,0,0], "radius": 1 }]"#;
    let scene = folder.load_keys(keys).unwrap();
    assert!(scene.warnings.concat().contains("`origin`"), "{:?}", scene.warnings);
}

#[test]
fn views_far_from_zero_read_back_as_they_were_written() {
    let folder = Folder::new();
    let keys =
        r#""camera": { "position": [447321.31, -0.2, -5411870.1], "look_at": [447325.9, 0, -5411873.77] }"#;
    let ball = r#""spheres": [{ "center": [447325,4,-5411873], "radius": 1 }]"#;
    let scene = folder.load_keys(&format!("{keys}, {ball}")).unwrap();
    let view = View::from_scene(&scene, None, &folder.path(""));
    let again = load_with_view(&folder.write("v.json", view.text())).unwrap();
    assert_eq!((again.view.as_ref(), again.camera), (Some(&view), scene.camera), "{}", view.text());
    // With the digits of the file.
    assert!(view.text().contains(keys.split_once(" }").unwrap().0), "{}", view.text());
}

#[test]
fn an_origin_of_the_file_is_taken() {
    let keys = r#""origin": [5, 6, 7], "spheres": [{ "center": [5.5, 6, 7], "radius": 1 }]"#;
    let scene = Folder::new().load_keys(keys).unwrap();
    assert_eq!(scene.spheres[0].center.to_array(), [0.5, 0.0, 0.0]);
}

#[test]
fn primitives_too_large_for_their_view_are_named() {
    let folder = Folder::new();
    let warnings = |keys: &str| {
        let camera = r#""camera": { "position": [0,1.5,4], "look_at": [0,-109999998.5,-399999996] }"#;
        folder.load_keys(&format!("{camera}, {keys}")).unwrap().warnings
    };
    let ball = |y: f64, radius: f64| {
        warnings(&format!(r#""spheres": [{{ "center": [0,{y},0], "radius": {radius} }}]"#))
    };
    assert!(ball(-1e5, 1e5).is_empty());
    assert!(ball(0.0, 1e9).is_empty(), "a sky is far away from what is seen");
    let warning = ball(-1e6, 1e6).concat();
    assert!(
        warning.starts_with("spheres[0] is too large") && warning.contains(" times smaller"),
        "{warning}"
    );
    let floor = |l: f64| {
        warnings(&format!(r#""triangles": [{{ "vertices": [[-{l},0,{l}],[{l},0,{l}],[0,0,-{l}]] }}]"#))
    };
    assert!(floor(1e4).is_empty());
    assert!(floor(1e6).concat().starts_with("triangles[0] is too large"));
}

#[test]
fn sizes_beyond_what_single_precision_holds_are_refused_with_the_range() {
    let keys = r#""camera": { "position": [0,1,5], "look_at": [7,0,0] }, "spheres": [{ "center": [0,2e12,0], "radius": 1 }]"#;
    let error = Folder::new().load_keys(keys).unwrap_err().to_string();
    assert!(error.contains("too far away") && error.contains("1.1e12 around [0, 1, 5]"), "{error}");
}
