//! Views: files that name another scene and say how it is looked at; and the files that any scene was read
//! from.

use crate::folder::Folder;
use glam::{Vec3, vec3};
use octray::lights::LightChoice;
use octray::measure::stability::Rng;
use octray::render::{PipelineChoice, SphereChoice, TraversalChoice, TriangleChoice};
use octray::sampling::Sampler;
use octray::scene::{
    Camera, CameraPath, Keyframe, Lens, Loaded, Projection, Rendering, Scene, VERTICAL_FOV, View, load,
    load_with_view,
};
use octray::tone::Operator;
use std::fs;
use std::path::{Path, PathBuf};

/// A scene of every format, and two of the program's own; their names as a view in the same folder says them.
fn scenes(folder: &Folder) -> [&'static str; 5] {
    folder.write(
        "native.json",
        r#"{ "format": "octray-1", "spheres": [{ "center": [1,2,3], "radius": 2 }], "max_bounces": 7,
            "camera": { "position": [0,1,9], "look_at": [0.5,1,0], "up": [0.1,1,0], "vertical_fov": 35 } }"#,
    );
    folder.write(
        "thesis.json",
        r#"{ "res": [64, 36], "sphere": [{ "center": [0,0,0], "radius": 9, "roughness": 1 }] }"#,
    );
    folder.write("model.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    ["native.json", "thesis.json", "model.obj", "builtin:three", "builtin:knot:30"]
}

/// As the command line would name it.
fn spec(folder: &Folder, name: &str) -> String {
    if name.starts_with("builtin:") { name.into() } else { folder.name(name) }
}

fn view(scene: &str, more: &str) -> String {
    format!("{{\n  \"format\": \"octray-view-1\",\n  \"scene\": \"{scene}\"{more}\n}}\n")
}

/// Everything of a scene that a picture can show.
fn looks(scene: &Scene) -> String {
    format!("{:?}", Scene { name: String::new(), files: Vec::new(), ..scene.clone() })
}

#[test]
fn view_that_says_nothing_is_the_scene_itself() {
    let folder = Folder::new();
    for base in scenes(&folder) {
        let scene = load_with_view(&folder.write("view.json", view(base, ""))).unwrap();
        assert_eq!(looks(&scene), looks(&load(&spec(&folder, base)).unwrap()), "{base}");
        assert_eq!(scene.name, "view.json");
        let nothing = View {
            scene: base.into(),
            coordinates: scene.coordinates,
            camera: None,
            resolution: None,
            max_bounces: None,
            render: Rendering::default(),
            path: CameraPath::default(),
        };
        assert_eq!(scene.view, Some(nothing));
    }
}

#[test]
fn view_changes_what_it_says_of_every_format_and_nothing_else() {
    let folder = Folder::new();
    for base in scenes(&folder) {
        let own = load_with_view(&spec(&folder, base)).unwrap();
        assert!(own.view.is_none());
        let more = r#", "resolution": [31, 17], "max_bounces": 1023,
            "camera": { "position": [3.3,40,-5], "look_at": [0.1,0.2,0.3], "up": [0,0,-2], "vertical_fov": 12.7 }"#;
        // The same scene, named from a folder inside.
        let from_below = if base.starts_with("builtin:") { base.into() } else { format!("../{base}") };
        let load_with = |more| folder.load("deep/view.json", view(&from_below, more)).unwrap();
        let scene = load_with(more);
        let place = |point: [f64; 3]| own.coordinates.to_scene(point.into()).as_vec3();
        let camera =
            Camera::pinhole(place([3.3, 40.0, -5.0]), place([0.1, 0.2, 0.3]), vec3(0.0, 0.0, -2.0), 12.7);
        let expected = Scene { camera, resolution: [31, 17], max_bounces: 1023, ..own.scene.clone() };
        assert_eq!(looks(&scene), looks(&expected), "{base}");

        // What a camera leaves out is the scene's own, not a framing.
        let scene = load_with(r#", "camera": { "vertical_fov": 20 }"#);
        assert_eq!(scene.camera, Camera { vertical_fov: 20.0, ..own.camera }, "{base}");
        let scene = load_with(r#", "camera": { "position": [9, 9, 9] }"#);
        assert_eq!(scene.camera, Camera { position: place([9.0; 3]), ..own.camera }, "{base}");
        assert_eq!((scene.resolution, scene.max_bounces), (own.resolution, own.max_bounces), "{base}");
    }
}

/// The bits of all numbers of a view: equality would take −0 for 0.
fn bits(view: &View) -> Vec<u32> {
    let Camera { position, look_at, up, vertical_fov, .. } = view.camera.unwrap();
    let render = [view.render.exposure, view.render.clamp].map(Option::unwrap_or_default);
    let camera = [position, look_at, up].map(|v| v.to_array());
    camera.as_flattened().iter().chain(&[vertical_fov]).chain(&render).map(|x| x.to_bits()).collect()
}

#[test]
fn written_views_read_back_in_every_bit() {
    let folder = Folder::new();
    let render = Rendering {
        samples: Some(16_777_216),
        seed: Some(u32::MAX),
        exposure: Some(0.0),
        tone: Some(Operator::Aces),
        clamp: Some(f32::MIN_POSITIVE),
        sphere: Some(SphereChoice::Robust),
        triangle: Some(TriangleChoice::Woop),
        traversal: Some(TraversalChoice::Auto),
        lights: Some(LightChoice::Auto),
        sampler: Some(Sampler::Random),
        pipeline: Some(PipelineChoice::Auto),
    };
    // Any bits, at magnitudes that a scene may hold: all exponents from 1e-45 on.
    let mut rng = Rng(1);
    let mut numbers = std::iter::repeat_with(|| f32::from_bits(rng.bits())).filter(|x| x.abs() <= 1e12);
    let mut point = || Vec3::from_array(std::array::from_fn(|_| numbers.next().unwrap()));
    let zeros = [Vec3::ZERO, vec3(0.0, 0.0, 1.0), vec3(0.0, 1.0, -0.0)];
    let mut read = 0;
    for turn in 0..2_000 {
        let [position, look_at, up] = if turn == 0 { zeros } else { std::array::from_fn(|_| point()) };
        let vertical_fov = if turn == 0 { 33.3 } else { point().x.abs() };
        let exposure = Some(point().y);
        // Where it is up to chance whether there can be such a camera, there are enough that can.
        let sight = (look_at - position).as_dvec3();
        let sine = sight.normalize_or_zero().cross(up.as_dvec3().normalize_or_zero()).length();
        if !((1e-3..180.0).contains(&vertical_fov) && sight.length() > 1e-17 && sine > 1e-4) {
            assert_ne!(turn, 0);
            continue;
        }
        let [radius, focus] = [point(), point()].map(|point| point.x.abs());
        let projection = match turn % 3 {
            1 if focus >= 1e-17 => Projection::Orthographic { height: focus },
            2 if focus >= 1e-17 => Projection::Perspective(Lens { radius, focus: Some(focus), blades: 7 }),
            _ => Projection::default(),
        };
        let is_parallel = matches!(projection, Projection::Orthographic { .. });
        let vertical_fov = if is_parallel { VERTICAL_FOV } else { vertical_fov };
        let camera = Camera { position, look_at, up, vertical_fov, projection };
        let keyframes = [3, u32::MAX].map(|frame| Keyframe { frame, camera }).to_vec();
        let view = View {
            scene: "builtin:knot:18".into(),
            coordinates: load("builtin:knot:18").unwrap().coordinates,
            camera: Some(camera),
            resolution: Some([16_384, 1]),
            max_bounces: Some(0),
            render: Rendering { exposure, ..render },
            path: CameraPath::new(keyframes),
        };
        let Loaded { scene, view: found, .. } =
            load_with_view(&folder.write("view.json", view.text())).unwrap();
        let found = found.unwrap();
        assert_eq!(found, view);
        assert_eq!(bits(&found), bits(&view), "{}", view.text());
        assert_eq!(found.camera, Some(scene.camera));
        read += 1;
    }
    assert!(read > 100, "{read}");
}

#[test]
fn numbers_of_a_view_are_rounded_once_as_on_the_command_line() {
    let folder = Folder::new();
    // Just below the middle of two neighbours in f32; the nearest f64 is the middle itself, from which a
    // second rounding would go up.
    let digits = "1.00000017881393432617187499";
    let more = format!(r#", "render": {{ "exposure": {digits}, "clamp": {digits} }}"#);
    let render =
        load_with_view(&folder.write("v.json", view("builtin:three", &more))).unwrap().view.unwrap().render;
    let typed: f32 = digits.parse().unwrap();
    assert_ne!(typed, digits.parse::<f64>().unwrap() as f32);
    assert_eq!((render.exposure, render.clamp), (Some(typed), Some(typed)));
}

#[test]
fn views_of_a_scene_name_it_from_any_folder() {
    let folder = Folder::new();
    fs::create_dir_all(folder.path("shots/deep")).unwrap();
    for base in scenes(&folder) {
        let own = load(&spec(&folder, base)).unwrap();
        for place in ["a.json", "shots/a.json", "shots/deep/a.json", "shots/../shots/deep/a.json"] {
            let file = folder.path(place);
            let view = View::from_scene(&own, None, file.parent().unwrap());
            assert!(!Path::new(&view.scene).is_absolute(), "{}", view.scene);
            let scene = load_with_view(&folder.write(place, view.text())).unwrap();
            assert_eq!(looks(&scene), looks(&own), "{base} from {place}");
            // A view of a view is one of the same scene.
            let again = View::from_scene(&scene, scene.view.as_ref(), &folder.path("shots"));
            let scene = folder.load("shots/again.json", again.text()).unwrap();
            assert_eq!(looks(&scene), looks(&own), "{base} from {place}, again");
        }
    }
    let own = load(&spec(&folder, "model.obj")).unwrap();
    assert_eq!(View::from_scene(&own, None, &folder.path("shots/deep")).scene, "../../model.obj");
}

#[test]
fn faults_in_a_view_name_their_place_and_a_remedy() {
    let folder = Folder::new();
    scenes(&folder);
    folder.write("shot.json", view("native.json", ""));
    folder.write("notes.txt", "no scene");
    for (keys, at, words) in [
        (r#""sky": {}"#, "sky, line 4", "the keys known here are"),
        (r#""camera": { "fov": 9 }"#, "camera.fov, line 4", "vertical_fov"),
        (r#""render": { "sample": 9 }"#, "render.sample, line 4, column 25", "did you mean `samples`?"),
        (r#""render": { "tone": 3 }"#, "render.tone, line 4", "write a string here"),
        (r#""render": { "seed": -1 }"#, "render.seed, line 4", "whole number"),
        (r#""render": { "exposure": 1e99 }"#, "render.exposure, line 4", "finite"),
        (r#""resolution": [0, 9]"#, "resolution[0], line 4, column 18", "from 1 to 16384"),
        (r#""max_bounces": 1025"#, "max_bounces, line 4, column 18", "from 0 to 1024"),
        (
            r#""keyframes": [{ "frame": 1, "camera": {} }, { "frame": 2, "camera": { "orthographic_height": 1 } }]"#,
            "keyframes[1].camera, line 4",
            "or none",
        ),
        (r#""camera": { "blades": 5 }"#, "camera.blades, line 4", "add `aperture_radius`"),
        (r#""camera": { "vertical_fov": 180 }"#, "camera.vertical_fov, line 4, column 31", "below 180"),
        // The scene's own camera and the view's keys together make an impossible one.
        (r#""camera": { "up": [0.5, 0, -9] }"#, "camera.up, line 4, column 21", "parallel"),
        (r#""camera": { "position": [0.5, 1, 0] }"#, "camera.look_at", "move `look_at`"),
    ] {
        folder.assert_refused("view.json", view("native.json", &format!(",\n  {keys}")), at, words);
    }
    folder.assert_refused("view.json", r#"{ "format": "octray-view-1" }"#, "", "add `scene`");
    folder.assert_refused("view.json", r#"{ "format": "octray-view-2" }"#, "format", "octray-view-1");
    for (scene, words) in [
        ("gone.json", "gone.json: give the path"),
        ("shot.json", "that it is a view of"),
        ("view.json", "`view.json` is a view itself"),
        ("notes.txt", "a model (.obj, .gltf, .glb, .ply)"),
        ("", "builtin:NAME"),
        ("builtin:thre", "did you mean `builtin:three`?"),
        ("builtin:knot", "builtin:knot:N"),
    ] {
        folder.assert_refused("view.json", view(scene, ""), "scene, line 3, column 12", words);
    }
    // Those of its scene stay the scene's own.
    let broken = folder.write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    let error = folder.load("view.json", view("broken.obj", "")).unwrap_err();
    assert_eq!(error.file, Some(PathBuf::from(broken)));
    assert_eq!(error.at.as_deref(), Some("line 2"));
}

/// Files by their names from the folder on.
fn inside(folder: &Folder, files: &[PathBuf]) -> Vec<String> {
    let name = |file: &PathBuf| {
        file.strip_prefix(folder.path("")).unwrap_or(file).to_str().unwrap().replace('\\', "/")
    };
    files.iter().map(name).collect()
}

#[test]
fn scenes_know_the_files_that_they_were_read_from_and_those_that_are_missing() {
    let folder = Folder::new();
    folder.save_picture("p/a.png");
    folder.save_picture("p/b.png");
    let files = |name: &str| inside(&folder, &load(&spec(&folder, name)).unwrap().files);
    folder.write("m/m.mtl", "newmtl a\nmap_Kd ../p/a.png\nnorm ../p/a.png\nnewmtl b\nmap_Kd ../p/b.png\n");
    let face = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    folder.write("m/m.obj", format!("mtllib m.mtl gone.mtl\n{face}"));
    folder.write(
        "native.json",
        r#"{ "format": "octray-1", "sky": { "texture": "p/b.png" },
            "meshes": [ { "obj": "m/m.obj" }, { "obj": "m/m.obj", "translate": [3, 0, 0] } ],
            "materials": { "x": { "type": "diffuse", "texture": "p/b.png", "filter": "nearest" } } }"#,
    );
    let ball =
        |path: &str| format!(r#"{{ "center": [0,0,0], "radius": 1, "roughness": 1, "texture": "{path}" }}"#);
    let balls = [ball("p/a.png"), ball("p/gone.png"), ball("p/a.png")].join(", ");
    folder.write("s/thesis.json", format!(r#"{{ "sphere": [ {balls} ] }}"#));
    folder.write("view.json", view("m/m.obj", ""));
    folder.write("three.json", view("builtin:three", ""));

    let model = ["m/m.obj", "m/m.mtl", "m/../p/a.png", "m/../p/b.png", "m/gone.mtl"];
    assert_eq!(files("m/m.obj"), model);
    let native = files("native.json");
    assert_eq!(native, [&["native.json", "p/b.png"][..], &model].concat());
    let thesis = files("s/thesis.json");
    for name in ["s/p/a.png", "p/a.png", "s/p/gone.png", "p/gone.png"] {
        assert!(thesis[0] == "s/thesis.json" && thesis.contains(&name.to_string()), "{name}: {thesis:?}");
    }
    assert_eq!(files("view.json"), [&["view.json"][..], &model].concat());
    assert_eq!(files("three.json"), ["three.json"]);
    for inside in ["builtin:thesis", "builtin:chess", "builtin:knot:30"] {
        assert_eq!(load(inside).unwrap().files, Vec::<PathBuf>::new(), "{inside}");
    }
}

#[test]
fn scenes_that_cannot_be_read_know_what_was_looked_for() {
    let folder = Folder::new();
    let files = |name: &str| inside(&folder, &load(&spec(&folder, name)).unwrap_err().files);
    folder.write("view.json", view("m/gone.json", ""));
    folder.write("of_model.json", view("m/m.obj", ""));
    folder.write("m/m.obj", "mtllib m.mtl\nv 0 0 0\nf 1 2 3\n");
    assert_eq!(files("gone.json"), ["gone.json"]);
    assert_eq!(files("view.json"), ["view.json", "m/gone.json"]);
    assert_eq!(files("of_model.json"), ["of_model.json", "m/m.obj"]);
}
