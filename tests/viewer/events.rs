//! What becomes of events that come while other things go on: scenes that are being read, files that change,
//! an end.

use crate::folder::Folder;
use crate::pictures::assert_renders_again;
use crate::seat::{Seat, options};
use crate::waiting::wait_for;
use octray::render::{PipelineChoice, Settings};
use octray::scene::Loaded;
use octray::tone::Tone;
use octray::viewer::Options;
use octray::viewer::frame::Frame;
use octray::viewer::keys::Key;
use octray::viewer::state::Event;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread::sleep;
use std::time::Duration;

/// Takes frames until one is as wanted.
fn wait(seat: &mut Seat, what: &str, wanted: impl Fn(&Frame) -> bool) {
    wait_for(what, || (seat.viewer.swap_newer(&mut seat.frame) && wanted(&seat.frame)).then_some(()));
}

/// Takes frames until one has these words in its message.
fn wait_for_word(seat: &mut Seat, words: &str) {
    wait(seat, words, |frame| frame.message.contains(words));
}

/// Frames of 16×9 on one thread.
fn small(folder: &Folder) -> Options {
    options([16, 9], 1, &folder.path(""))
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
    let folder = Folder::new();
    let broken = folder.write("broken.json", "{");
    // Many triangles: another way to render them takes a while to be made ready.
    let mut seat = Seat::start(small(&folder), &["builtin:terrain:200000", &broken]);
    wait(&mut seat, "figures", |frame| frame.figures.contains("8 lanes, 1 thread"));
    seat.press(Key::Char('l'));
    wait(&mut seat, "the order", |frame| {
        frame.figures.contains("being prepared") || frame.figures.contains("scalar, 1")
    });
    seat.press(Key::PageDown);
    wait_for_word(&mut seat, "broken.json");
    wait(&mut seat, "what was chosen", |frame| frame.figures.contains("scalar, 1 thread"));
    assert!(seat.frame.message.contains("broken.json"), "and the error stays");
    seat.viewer.finish();
}

#[test]
fn both_widths_are_measured_side_by_side() {
    let mut seat = Seat::start(options([64, 36], 1, Path::new(".")), &["builtin:three"]);
    wait(&mut seat, "a rate of one", |frame| frame.figures.contains("L measures scalar beside it"));
    seat.press(Key::Char('l'));
    wait(&mut seat, "the rates of both", |frame| {
        frame.figures.contains("scalar, 1 thread · SIMD ") && frame.figures.contains("×\n")
    });
    let (_, rates) = seat.frame.figures.split_once(" · SIMD ").unwrap();
    let factor = rates.split_once("passes/s, ").unwrap().1.split_once('×').unwrap().0;
    assert!(factor.parse::<f64>().unwrap() > 1.0, "{}", seat.frame.figures);
    // With other equations nothing is the same.
    (0..2).for_each(|_| seat.press(Key::Char('x')));
    wait(&mut seat, "a rate of one again", |frame| frame.figures.contains("L measures SIMD beside it"));
    seat.viewer.finish();
}

#[test]
fn coarser_pixels_are_fewer_and_finer_ones_more() {
    let mut seat = Seat::start(options([64, 36], 1, Path::new(".")), &["builtin:three"]);
    for (letter, width) in [('j', 45), ('k', 64), ('k', 91)] {
        seat.press(Key::Char(letter));
        wait(&mut seat, "pixels", |frame| frame.width == width);
    }
    seat.viewer.finish();
}

#[test]
fn a_model_that_is_missing_or_broken_is_read_when_it_can_be() {
    let folder = Folder::new();
    let text = scene("model").replace("model.obj", "../models/model.obj");
    let file = folder.write("scenes/scene.json", text);
    let mut seat = Seat::start(small(&folder), &["builtin:three", &file]);
    seat.press(Key::PageDown);
    wait_for_word(&mut seat, "no such file");
    folder.write("models/model.obj", "f 1 2 3\n");
    wait_for_word(&mut seat, "line 1");
    folder.write("models/model.obj", model(3));
    wait(&mut seat, "the model", |frame| frame.title.ends_with("scene.json") && frame.message.is_empty());
    seat.viewer.finish();
}

#[test]
fn a_file_that_changes_while_it_is_read_for_the_first_time_is_read_again() {
    let folder = Folder::new();
    let file = folder.write("scene.json", scene("model"));
    folder.write("model.obj", model(150_000));
    let mut seat = Seat::start(small(&folder), &["builtin:three", &file]);
    wait(&mut seat, "a frame", |_| true);
    seat.press(Key::PageDown);
    wait_for_word(&mut seat, "reading");
    folder.write("scene.json", scene("ball"));
    // It has no triangles and no hierarchy for them.
    wait(&mut seat, "the scene as it has become", |frame| {
        frame.figures.contains("scene.json (2 of 2)") && frame.figures.contains(", linear")
    });
    seat.viewer.finish();
}

#[test]
fn a_screenshot_just_before_the_end_is_taken_and_its_view_says_how() {
    let folder = Folder::new();
    let given = options([64, 36], 1, &folder.path(""));
    let (seed, clamp, pipeline) = (9, 0.75, PipelineChoice::General);
    let options = Options {
        settings: Box::new(move |scene| Settings { seed, clamp, pipeline, ..(given.settings)(scene) }),
        tone: Tone { exposure: -64.0, ..Tone::default() },
        ..options([64, 36], 1, &folder.path(""))
    };
    let mut seat = Seat::start(options, &["builtin:three"]);
    wait(&mut seat, "a picture", |frame| !frame.figures.is_empty());
    seat.press(Key::Tab);
    seat.viewer.finish();
    let view: Value =
        serde_json::from_slice(&fs::read(folder.path("octray-three-0001.json")).unwrap()).unwrap();
    let render = &view["render"];
    assert_eq!((&render["seed"], &render["clamp"]), (&9.into(), &0.75.into()), "{view}");
    assert_eq!((&render["pipeline"], &render["exposure"]), (&"general".into(), &(-64.0).into()), "{view}");
    for word in ["samples", "tone", "sphere", "triangle", "traversal", "lights", "sampler"] {
        assert!(!render[word].is_null(), "{word}: {view}");
    }
    assert!(octray::scene::load(&folder.name("octray-three-0001.json")).is_ok());
}

#[test]
fn a_screenshot_is_what_is_shown_beside_the_raw_film() {
    let folder = Folder::new();
    let mut seat = Seat::start(options([64, 36], 1, &folder.path("")), &["builtin:cornell"]);
    for (number, key, said) in [(1, None, "(raw, "), (2, Some('n'), "(denoised, "), (3, Some('2'), "(")] {
        key.into_iter().for_each(|key| seat.press(Key::Char(key)));
        seat.press(Key::Tab);
        let file = format!("octray-cornell-{number:04}.png");
        wait(&mut seat, "a message", |frame| frame.message.contains(&file));
        assert!(seat.frame.message.contains(&format!("{file} {said}")), "{}", seat.frame.message);
        let shot = folder.path(&file);
        let render = |file: &str| {
            let view = folder.name(&format!("octray-cornell-{number:04}.json"));
            let done = crate::program::octray().args(["render", &view, "-o", &folder.name(file)]).output();
            assert!(done.unwrap().status.success());
            fs::read(folder.path(file)).unwrap()
        };
        assert!(render("film.exr") == fs::read(shot.with_extension("exr")).unwrap(), "{number}");
        assert_eq!(render("film.png") == fs::read(shot).unwrap(), number == 1, "{number}");
    }
    seat.viewer.finish();
}

/// A key stops the sample under way, and leaves some pixels with more samples than others.
#[test]
fn a_screenshot_in_the_middle_of_a_sample_is_rendered_again() {
    let folder = Folder::new();
    let mut seat = Seat::start(options([320, 180], 1, &folder.path("")), &["builtin:cornell"]);
    seat.viewer.send(Event::Rate(1e6));
    wait(&mut seat, "a second sample", |frame| frame.figures.contains(" samples · "));
    for number in 1..=3 {
        seat.press(Key::Tab);
        let shot = folder.path(&format!("octray-cornell-{number:04}"));
        wait_for("a screenshot", || {
            for _ in 0..20 {
                seat.viewer.send(Event::Mouse([1.0, 0.0]));
                sleep(Duration::from_millis(1));
            }
            shot.with_extension("json").exists().then_some(())
        });
    }
    seat.viewer.finish();
    for number in 1..=3 {
        assert_renders_again(&folder.path(&format!("octray-cornell-{number:04}")));
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
            wait(&mut seat, "a frame", |frame| {
                frame.pixels.len() == size[0] as usize * size[1] as usize && !frame.inset.is_empty()
            });
        }
        for letter in "ffnffntwffnffn".chars() {
            seat.press(Key::Char(letter));
            wait(&mut seat, "a frame", |frame| [frame.width, frame.height] == size);
        }
        seat.viewer.finish();
    }
}

#[test]
fn what_is_missing_is_said_and_taken_in_when_it_is_there() {
    let folder = Folder::new();
    let ball = r#"{ "center": [0, 0, 5], "radius": 1, "roughness": 1, "texture": "a.png" }"#;
    let thesis = folder.write("thesis.json", format!(r#"{{ "sphere": [ {ball} ] }}"#));
    let model = folder.write("model.obj", format!("mtllib gone.mtl\n{}", model(3)));
    let picture = image::RgbImage::from_pixel(2, 2, image::Rgb([9, 99, 199]));
    let mut seat = Seat::start(small(&folder), &[&thesis, &model]);
    wait_for_word(&mut seat, "a.png` is left out");
    folder.write("a.png", "no picture");
    wait_for_word(&mut seat, "broken");
    fs::remove_file(folder.path("a.png")).unwrap();
    wait_for_word(&mut seat, "no such file");
    picture.save(folder.path("a.png")).unwrap();
    // It is black, which stays odd.
    wait(&mut seat, "the texture", |frame| frame.figures.contains(", 1 warning"));
    seat.press(Key::PageDown);
    wait_for_word(&mut seat, "gone.mtl");
    folder.write("gone.mtl", "newmtl a\nmap_Kd textures/b.png\n");
    wait_for_word(&mut seat, "b.png");
    folder.write("textures/b.png", "no picture");
    wait_for_word(&mut seat, "broken");
    seat.viewer.finish();
}

/// Takes some six seconds: so long is a screenshot spoken of.
#[test]
fn an_error_is_said_again_after_a_screenshot() {
    let folder = Folder::new();
    let file = folder.write("scene.json", scene("ball"));
    let mut seat = Seat::start(small(&folder), &[&file]);
    wait(&mut seat, "a picture", |frame| !frame.figures.is_empty());
    folder.write("scene.json", "{");
    let broken = |frame: &Frame| frame.message.contains("scene.json") && !frame.message.contains("saved");
    wait(&mut seat, "an error", broken);
    seat.press(Key::Tab);
    wait_for_word(&mut seat, "saved");
    wait(&mut seat, "the error again", broken);
    folder.write("scene.json", scene("ball"));
    wait(&mut seat, "no error any more", |frame| frame.message.is_empty());
    seat.viewer.finish();
}

/// A viewer whose first scene is made ready only when the sender says so, or is gone.
fn waiting_seat(name: &str, options: Options) -> (Seat, Sender<()>) {
    let (go, wait) = channel::<()>();
    let (wait, calls) = (Mutex::new(wait), AtomicU32::new(0));
    let given = options.settings;
    let settings = move |scene: &Loaded| {
        // The front end asks first, then the thread that makes it ready.
        if calls.fetch_add(1, Ordering::SeqCst) > 0 {
            let _ = wait.lock().unwrap().recv();
        }
        given(scene)
    };
    (Seat::start(Options { settings: Box::new(settings), ..options }, &[name]), go)
}

#[test]
fn a_window_is_closed_at_once_while_its_first_scene_is_made_ready() {
    let (mut seat, go) = waiting_seat("builtin:three", options([16, 9], 1, Path::new(".")));
    wait(&mut seat, "a word about it", |frame| frame.message == "preparing builtin:three");
    assert_eq!((seat.frame.width, seat.frame.height, &seat.frame.title[..]), (16, 9, "builtin:three"));
    assert_eq!(seat.viewer.finish().frames, 0);
    drop(go);
}

#[test]
fn what_appears_while_the_first_scene_is_made_ready_is_taken_in() {
    let folder = Folder::new();
    let file = folder.write("model.obj", format!("mtllib gone.mtl\n{}", model(3)));
    let (mut seat, go) = waiting_seat(&file, small(&folder));
    wait_for_word(&mut seat, "preparing");
    folder.write("gone.mtl", "newmtl a\nmap_Kd b.png\n");
    drop(go);
    // What it misses in turn.
    wait_for_word(&mut seat, "b.png");
    seat.viewer.finish();
}

#[test]
fn many_warnings_are_cut_and_counted() {
    let folder = Folder::new();
    let libraries: String = (1..=6).map(|number| format!("mtllib {number}.mtl\n")).collect();
    let file = folder.write("model.obj", libraries + &model(3));
    let mut seat = Seat::start(small(&folder), &[&file]);
    wait_for_word(&mut seat, "1.mtl");
    let said: Vec<&str> = seat.frame.message.lines().collect();
    assert!(said.len() == 5 && said[3].contains("4.mtl") && said[4] == "(and 2 more warnings)", "{said:#?}");
    seat.press(Key::Char('h'));
    wait(&mut seat, "help in the place of figures", |frame| frame.help && frame.figures.is_empty());
    seat.viewer.finish();
}

#[test]
fn a_scene_that_no_memory_is_left_for_is_not_shown() {
    let folder = Folder::new();
    let sized = |size: &str| scene("ball").replacen('{', &format!(r#"{{ "resolution": {size},"#), 1);
    let file = folder.write("huge.json", sized("[16384, 16384]"));
    let fits = |size: [u32; 2]| if size[0] < 1_000 { Ok(()) } else { Err("no memory left".to_string()) };
    let settings = |scene: &Loaded| Settings { lanes: 8, ..Settings::of(scene) };
    let options = Options { settings: Box::new(settings), fits: Box::new(fits), ..small(&folder) };
    let mut seat = Seat::start(options, &["builtin:three", &file]);
    seat.press(Key::PageDown);
    wait(&mut seat, "an error", |frame| frame.message == "huge.json: no memory left");
    assert!(seat.frame.title == "builtin:three" && seat.frame.width < 1_000);
    // Only what is larger than the picture that is there is asked about.
    seat.press(Key::Char('l'));
    wait(&mut seat, "another width", |frame| frame.figures.contains("scalar"));
    folder.write("huge.json", sized("[20, 10]"));
    wait(&mut seat, "a smaller one", |frame| {
        [frame.width, frame.height] == [20, 10] && frame.message.is_empty()
    });
    seat.viewer.finish();
}

#[test]
fn viewer_says_once_why_a_picture_is_black() {
    let folder = Folder::new();
    let file = folder.write("scene.json", scene("ball").replace("[0, 0, 5]", "[0, 0, 0.5]"));
    let mut seat = Seat::start(small(&folder), &[&file]);
    wait_for_word(&mut seat, "the picture is black: the camera is inside spheres[0]");
    wait(&mut seat, "no message any more", |frame| frame.message.is_empty());
    seat.viewer.finish();
}
