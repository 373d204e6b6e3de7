//! What becomes of events that come while other things go on: scenes that are being read, files that change,
//! an end.

use crate::program::octray;
use crate::seat::options;
use crate::waiting::wait_for;
use octray::render::PipelineChoice;
use octray::scene::Loaded;
use octray::tone::Tone;
use octray::traverse::Methods;
use octray::viewer::frame::Frame;
use octray::viewer::keys::Key;
use octray::viewer::playlist::Playlist;
use octray::viewer::state::Event;
use octray::viewer::{Options, Summary, Viewer};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::Duration;

struct Seat {
    viewer: Viewer,
    frame: Frame,
}

impl Seat {
    fn start(options: Options, names: &[&str]) -> Self {
        let scene = octray::scene::load_with_view(names[0]).unwrap();
        Self::start_with(options, names, scene)
    }
    /// The first scene is read already.
    fn start_with(options: Options, names: &[&str], scene: Loaded) -> Self {
        let playlist = Playlist::new(&names.iter().map(|name| name.to_string()).collect::<Vec<_>>()).unwrap();
        Self { viewer: Viewer::start(options, playlist, scene, Arc::new(|| {})), frame: Frame::default() }
    }
    fn press(&self, key: Key) {
        for down in [true, false] {
            self.viewer.send(Event::Key { key, down, repeat: false });
        }
    }
    /// Takes frames until one is as wanted.
    fn wait(&mut self, what: &str, wanted: impl Fn(&Frame) -> bool) {
        wait_for(what, || (self.viewer.take(&mut self.frame) && wanted(&self.frame)).then_some(()));
    }
    fn end(self) -> Summary {
        self.viewer.finish()
    }
}

/// One ball, or the model beside the file.
fn scene(shown: &str) -> String {
    let thing = match shown {
        "ball" => r#""spheres": [{ "center": [0, 0, 0], "radius": 1 }]"#,
        _ => r#""meshes": [{ "obj": "model.obj" }]"#,
    };
    format!(
        r#"{{ "format": "octray-1", "camera": {{ "position": [0, 0, 5], "look_at": [0, 0, 0] }}, {thing} }}"#
    )
}

/// A fan of so many triangles.
fn model(triangles: usize) -> String {
    let mut text = "v 0 0 0\n".to_string();
    for at in 0..=triangles {
        let turn = at as f64 / triangles as f64;
        writeln!(text, "v {} {} 0", turn.cos(), turn.sin()).unwrap();
    }
    (0..triangles).for_each(|at| writeln!(text, "f 1 {} {}", at + 2, at + 3).unwrap());
    text
}

#[test]
fn what_was_chosen_is_not_lost_where_another_scene_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let broken = folder.path().join("broken.json");
    fs::write(&broken, "{").unwrap();
    let options = options([16, 9], 1, folder.path());
    // Many triangles: another way to render them takes a while to be made ready.
    let mut seat = Seat::start(options, &["builtin:terrain:200000", broken.to_str().unwrap()]);
    seat.wait("figures", |frame| frame.figures.contains("8 lanes, 1 thread"));
    seat.press(Key::Char('l'));
    seat.wait("the order", |frame| {
        frame.figures.contains("being prepared") || frame.figures.contains("scalar, 1")
    });
    seat.press(Key::PageDown);
    seat.wait("an error", |frame| frame.message.contains("broken.json"));
    seat.wait("what was chosen", |frame| frame.figures.contains("scalar, 1 thread"));
    assert!(seat.frame.message.contains("broken.json"), "and the error stays");
    seat.end();
}

#[test]
fn both_widths_are_measured_side_by_side() {
    let mut seat = Seat::start(options([64, 36], 1, Path::new(".")), &["builtin:three"]);
    seat.wait("a rate of one", |frame| frame.figures.contains("L measures scalar beside it"));
    seat.press(Key::Char('l'));
    seat.wait("the rates of both", |frame| {
        frame.figures.contains("scalar, 1 thread · SIMD ") && frame.figures.contains("×\n")
    });
    // With other equations nothing is the same.
    seat.press(Key::Char('x'));
    seat.press(Key::Char('x'));
    seat.wait("a rate of one again", |frame| frame.figures.contains("L measures SIMD beside it"));
    seat.end();
}

#[test]
fn coarser_pixels_are_fewer_and_finer_ones_more() {
    let mut seat = Seat::start(options([64, 36], 1, Path::new(".")), &["builtin:three"]);
    for (letter, width) in [('j', 45), ('k', 64), ('k', 91)] {
        seat.press(Key::Char(letter));
        seat.wait("pixels", |frame| frame.width == width);
    }
    seat.end();
}

#[test]
fn a_model_that_cannot_be_read_is_read_again_when_it_is_mended() {
    let folder = tempfile::tempdir().unwrap();
    let [file, obj] = ["scenes/scene.json", "models/model.obj"].map(|name| folder.path().join(name));
    for path in [&file, &obj] {
        fs::create_dir(path.parent().unwrap()).unwrap();
    }
    fs::write(&file, scene("model").replace("model.obj", "../models/model.obj")).unwrap();
    fs::write(&obj, "f 1 2 3\n").unwrap();
    let names = ["builtin:three", file.to_str().unwrap()];
    let mut seat = Seat::start(options([16, 9], 1, folder.path()), &names);
    seat.press(Key::PageDown);
    seat.wait("an error", |frame| frame.message.contains("model.obj"));
    fs::write(&obj, model(3)).unwrap();
    seat.wait("the model", |frame| frame.title.ends_with("scene.json") && frame.message.is_empty());
    seat.end();
}

#[test]
fn a_file_that_changes_while_it_is_read_for_the_first_time_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    fs::write(&file, scene("model")).unwrap();
    fs::write(folder.path().join("model.obj"), model(400_000)).unwrap();
    let options = options([16, 9], 1, folder.path());
    let mut seat = Seat::start(options, &["builtin:three", file.to_str().unwrap()]);
    seat.wait("a frame", |_| true);
    seat.press(Key::PageDown);
    seat.wait("a word about it", |frame| frame.message.contains("reading"));
    fs::write(&file, scene("ball")).unwrap();
    // It has no triangles and no hierarchy for them.
    seat.wait("the scene as it has become", |frame| {
        frame.figures.contains("scene.json (2 of 2)") && frame.figures.contains(", linear")
    });
    seat.end();
}

#[test]
fn a_screenshot_just_before_the_end_is_taken_and_its_view_says_how() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        seed: 9,
        clamp: 0.75,
        pipeline: PipelineChoice::General,
        tone: Tone { exposure: -64.0, ..Tone::default() },
        ..options([64, 36], 1, folder.path())
    };
    let mut seat = Seat::start(options, &["builtin:three"]);
    seat.wait("a picture", |frame| !frame.figures.is_empty());
    seat.press(Key::Tab);
    seat.end();
    let file = folder.path().join("octray-three-0001.json");
    let view: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    let render = &view["render"];
    assert_eq!((&render["seed"], &render["clamp"]), (&9.into(), &0.75.into()), "{view}");
    assert_eq!((&render["pipeline"], &render["exposure"]), (&"general".into(), &(-64.0).into()), "{view}");
    for word in ["samples", "tone", "sphere", "triangle", "traversal", "lights", "sampler"] {
        assert!(!render[word].is_null(), "{word}: {view}");
    }
    assert!(octray::scene::load(file.to_str().unwrap()).is_ok());
}

/// A key stops the sample under way, and leaves some pixels with more samples than others.
#[test]
fn a_screenshot_in_the_middle_of_a_sample_is_rendered_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut seat = Seat::start(options([320, 180], 1, folder.path()), &["builtin:cornell"]);
    seat.viewer.send(Event::Rate(1e6));
    seat.wait("a second sample", |frame| frame.figures.contains(" samples · "));
    for number in 1..=3 {
        seat.press(Key::Tab);
        let shot = folder.path().join(format!("octray-cornell-{number:04}"));
        wait_for("a screenshot", || {
            for _ in 0..20 {
                seat.viewer.send(Event::Mouse([1.0, 0.0]));
                sleep(Duration::from_millis(1));
            }
            shot.with_extension("json").exists().then_some(())
        });
    }
    seat.end();
    for number in 1..=3 {
        let shot = folder.path().join(format!("octray-cornell-{number:04}"));
        let again = folder.path().join("again.exr");
        let mut render = octray();
        render.arg("render").arg(shot.with_extension("json")).arg("-o").arg(&again);
        assert!(render.output().unwrap().status.success());
        assert!(fs::read(&again).unwrap() == fs::read(shot.with_extension("exr")).unwrap(), "{number}");
    }
}

#[test]
fn pictures_of_any_shape_are_shown_in_every_view_and_by_every_filter() {
    for (size, exposure) in [([1, 1], 64.0), ([16_384, 1], -64.0), ([1, 16_384], 64.0), ([7, 3], 0.0)] {
        let tone = Tone { exposure, ..Tone::default() };
        let options = Options { tone, ..options(size, 2, Path::new(".")) };
        let mut seat = Seat::start(options, &["builtin:cornell-spheres"]);
        seat.viewer.send(Event::Rate(1e6));
        for letter in "m234567890gggg1".chars() {
            seat.press(Key::Char(letter));
            seat.wait("a frame", |frame| {
                frame.pixels.len() == size[0] as usize * size[1] as usize && !frame.inset.is_empty()
            });
        }
        for letter in "ffnffntwffnffn".chars() {
            seat.press(Key::Char(letter));
            seat.wait("a frame", |frame| [frame.width, frame.height] == size);
        }
        seat.end();
    }
}

#[test]
fn what_is_missing_is_said_and_taken_in_when_it_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let ball = r#"{ "center": [0, 0, 5], "radius": 1, "roughness": 1, "texture": "a.png" }"#;
    fs::write(at("thesis.json"), format!("{{ \"sphere\": [ {ball} ] }}")).unwrap();
    let mut model = model(3);
    model.insert_str(0, "mtllib gone.mtl\n");
    fs::write(at("model.obj"), model).unwrap();
    let picture = image::RgbImage::from_pixel(2, 2, image::Rgb([9, 99, 199]));
    let scene = |name: &str| at(name).to_str().unwrap().to_string();
    let [thesis, model] = ["thesis.json", "model.obj"].map(scene);
    let mut seat = Seat::start(options([16, 9], 1, folder.path()), &[&thesis, &model]);
    seat.wait("a word about the texture", |frame| frame.message.contains("a.png` is left out"));
    fs::write(at("a.png"), "no picture").unwrap();
    seat.wait("another word", |frame| frame.message.contains("broken"));
    fs::remove_file(at("a.png")).unwrap();
    seat.wait("the first one again", |frame| frame.message.contains("no such file"));
    picture.save(at("a.png")).unwrap();
    // It is black, which stays odd.
    seat.wait("the texture", |frame| frame.figures.contains(", 1 warning"));
    seat.press(Key::PageDown);
    seat.wait("a word about the materials", |frame| frame.message.contains("gone.mtl"));
    fs::write(at("gone.mtl"), "newmtl a\nmap_Kd textures/b.png\n").unwrap();
    seat.wait("a word about their picture", |frame| frame.message.contains("b.png"));
    fs::create_dir(at("textures")).unwrap();
    fs::write(at("textures/b.png"), "no picture").unwrap();
    seat.wait("a word about what is in it", |frame| frame.message.contains("broken"));
    seat.end();
}

#[test]
fn a_file_that_a_broken_scene_misses_is_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    fs::write(&file, scene("model")).unwrap();
    let names = ["builtin:three", file.to_str().unwrap()];
    let mut seat = Seat::start(options([16, 9], 1, folder.path()), &names);
    seat.press(Key::PageDown);
    seat.wait("an error", |frame| frame.message.contains("model.obj"));
    fs::write(folder.path().join("model.obj"), model(3)).unwrap();
    seat.wait("the model", |frame| frame.title.ends_with("scene.json") && frame.message.is_empty());
    seat.end();
}

/// Takes some six seconds: so long is a screenshot spoken of.
#[test]
fn an_error_is_said_again_after_a_screenshot() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    fs::write(&file, scene("ball")).unwrap();
    let mut seat = Seat::start(options([16, 9], 1, folder.path()), &[file.to_str().unwrap()]);
    seat.wait("a picture", |frame| !frame.figures.is_empty());
    fs::write(&file, "{").unwrap();
    let broken = |frame: &Frame| frame.message.contains("scene.json") && !frame.message.contains("saved");
    seat.wait("an error", broken);
    seat.press(Key::Tab);
    seat.wait("a word about the screenshot", |frame| frame.message.contains("saved"));
    seat.wait("the error again", broken);
    fs::write(&file, scene("ball")).unwrap();
    seat.wait("no error any more", |frame| frame.message.is_empty());
    seat.end();
}

/// A viewer whose first scene is made ready only when the sender says so, or is gone.
fn waiting_seat(names: &[&str], folder: &Path) -> (Seat, Sender<()>) {
    let (go, wait) = channel::<()>();
    let wait = Mutex::new(wait);
    let methods = move |_: &Loaded| {
        let _ = wait.lock().unwrap().recv();
        Methods::default()
    };
    let options = Options { methods: Box::new(methods), ..options([16, 9], 1, folder) };
    (Seat::start(options, names), go)
}

#[test]
fn a_window_is_closed_at_once_while_its_first_scene_is_made_ready() {
    let (mut seat, go) = waiting_seat(&["builtin:three"], Path::new("."));
    seat.wait("a word about it", |frame| frame.message == "preparing builtin:three");
    assert_eq!((seat.frame.width, seat.frame.height, &seat.frame.title[..]), (16, 9, "builtin:three"));
    assert_eq!(seat.end().frames, 0);
    drop(go);
}

#[test]
fn what_appears_while_the_first_scene_is_made_ready_is_taken_in() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.obj");
    fs::write(&file, format!("mtllib gone.mtl\n{}", model(3))).unwrap();
    let (mut seat, go) = waiting_seat(&[file.to_str().unwrap()], folder.path());
    seat.wait("a word about it", |frame| frame.message.contains("preparing"));
    fs::write(folder.path().join("gone.mtl"), "newmtl a\nmap_Kd b.png\n").unwrap();
    drop(go);
    seat.wait("a word about what it misses in turn", |frame| frame.message.contains("b.png"));
    seat.end();
}

#[test]
fn many_warnings_are_cut_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.obj");
    let libraries: String = (1..=6).map(|number| format!("mtllib {number}.mtl\n")).collect();
    fs::write(&file, libraries + &model(3)).unwrap();
    let mut seat = Seat::start(options([16, 9], 1, folder.path()), &[file.to_str().unwrap()]);
    seat.wait("warnings", |frame| frame.message.contains("1.mtl"));
    let said: Vec<&str> = seat.frame.message.lines().collect();
    assert!(said.len() == 5 && said[3].contains("4.mtl") && said[4] == "(and 2 more warnings)", "{said:#?}");
    seat.press(Key::Char('h'));
    seat.wait("help in the place of figures", |frame| frame.help && frame.figures.is_empty());
    seat.end();
}

#[test]
fn a_scene_that_no_memory_is_left_for_is_not_shown() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("huge.json");
    let huge = scene("ball").replacen('{', r#"{ "resolution": [16384, 16384],"#, 1);
    fs::write(&file, huge).unwrap();
    let fits = |size: [u32; 2]| if size[0] < 1_000 { Ok(()) } else { Err("no memory left".to_string()) };
    let options = Options { size: None, fits: Box::new(fits), ..options([16, 9], 1, folder.path()) };
    let mut seat = Seat::start(options, &["builtin:three", file.to_str().unwrap()]);
    seat.press(Key::PageDown);
    seat.wait("an error", |frame| frame.message == "huge.json: no memory left");
    assert!(seat.frame.title == "builtin:three" && seat.frame.width < 1_000);
    // Only what is larger than the picture that is there is asked about.
    seat.press(Key::Char('l'));
    seat.wait("another width", |frame| frame.figures.contains("scalar"));
    fs::write(&file, scene("ball").replacen('{', r#"{ "resolution": [20, 10],"#, 1)).unwrap();
    seat.wait("a smaller one", |frame| [frame.width, frame.height] == [20, 10] && frame.message.is_empty());
    seat.end();
}

#[test]
fn viewer_says_once_why_a_picture_is_black() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    fs::write(&path, scene("ball").replace("[0, 0, 5]", "[0, 0, 0.5]")).unwrap();
    let mut seat = Seat::start(options([16, 9], 1, folder.path()), &[path.to_str().unwrap()]);
    seat.wait("the reason", |frame| {
        frame.message.contains("the picture is black: the camera is inside spheres[0]")
    });
    seat.wait("no message any more", |frame| frame.message.is_empty());
    seat.end();
}
