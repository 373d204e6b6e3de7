//! `octray view` as its users have it: a window on a display, keys, and what is to be seen then.
//!
//! The display is the test's own (Xvfb), the keys come from xdotool; where one of them is missing, nothing is
//! tested, and it says so.

mod screen;
use crate::folder::Folder;
use crate::pictures::{Bytes, assert_renders_again, difference, rendered};
use crate::waiting::wait_for;
use screen::{SIZE, SIZE_TEXT, Viewer};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Samples of the pictures that the window's are held against: many enough for their noise to be below a
/// byte.
const SAMPLES: u32 = 4096;
/// Bytes by which the same picture may differ in the mean while it gathers samples, and by which another one
/// does at least.
const SAME: f64 = 1.5;
const OTHER: f64 = 8.0;

/// Waits until the window shows this.
fn wait_for_picture(viewer: &Viewer, what: &str, wanted: &Bytes) {
    wait_for(what, || (difference(&viewer.picture(), wanted) < SAME).then_some(()));
}
/// Waits until the window shows something else.
fn wait_for_another(viewer: &Viewer, what: &str, than: &Bytes) -> Bytes {
    wait_for(what, || Some(viewer.picture()).filter(|picture| difference(picture, than) > OTHER))
}

#[test]
fn window_shows_what_render_writes_and_ends_when_it_is_closed() {
    let folder = Folder::new();
    let Some(viewer) = Viewer::start(&folder, "builtin:three") else { return };
    wait_for("its title", || (viewer.title() == "octray · builtin:three").then_some(()));
    assert_eq!(viewer.size(), [256, 144]);
    let wanted = rendered("builtin:three", SIZE_TEXT, SAMPLES);
    // The figures lie over the picture until nobody wants them.
    wait_for("figures", || (count(&viewer, [255; 3]) > 200).then_some(()));
    assert!(difference(&viewer.picture(), &wanted) > OTHER, "text on a darkened ground");
    viewer.press("i");
    wait_for("the same picture as render's", || {
        let picture = viewer.picture();
        let near = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).all(|c| a[c].abs_diff(b[c]) <= 2);
        let most = picture.iter().zip(&wanted).filter(near).count() > wanted.len() * 3 / 4;
        (most && difference(&picture, &wanted) < 1.0).then_some(())
    });
    viewer.close();
    assert_eq!(viewer.end(), "");
}

#[test]
fn window_closes_when_the_program_is_told_to_end() {
    let folder = Folder::new();
    let Some(viewer) = Viewer::start(&folder, "builtin:three") else { return };
    viewer.tell_to_end();
    assert_eq!(viewer.end(), "");
}

#[test]
fn keys_move_the_camera_and_show_views_and_help() {
    let folder = Folder::new();
    let Some(viewer) = Viewer::start(&folder, "builtin:three") else { return };
    viewer.press("i");
    let home = rendered("builtin:three", SIZE_TEXT, SAMPLES);
    wait_for_picture(&viewer, "the scene", &home);
    for key in ["w", "d", "space", "Left", "Up"] {
        viewer.hold(key, || wait_for_another(&viewer, key, &home));
        viewer.press("Home");
        wait_for_picture(&viewer, "home", &home);
    }
    // A wide aperture, focused on what is in the middle, and without perspective.
    let wide = viewer.hold("u", || wait_for_another(&viewer, "blur", &home));
    viewer.press("b");
    viewer.press("End");
    wait_for_another(&viewer, "parallel rays", &wide);
    viewer.press("Home");
    wait_for_picture(&viewer, "the scene's own lens", &home);
    let mut before = home.clone();
    for digit in ["2", "3", "4", "6", "8", "0"] {
        viewer.press(digit);
        before = wait_for_another(&viewer, digit, &before);
        assert!(difference(&before, &home) > OTHER, "view {digit} is not the picture");
    }
    viewer.press("1");
    wait_for_picture(&viewer, "the picture again", &home);
    viewer.press("h");
    wait_for("help", || (count(&viewer, [255; 3]) > 1_000).then_some(()));
    wait_for_another(&viewer, "a darkened ground", &home);
    viewer.press("h");
    wait_for_picture(&viewer, "no help any more", &home);
}

#[test]
fn scenes_follow_each_other_and_files_are_read_again_when_they_change() {
    let folder = Folder::new();
    let ball = folder.write("ball.json", scene([0.9, 0.1, 0.1]));
    let Some(viewer) = Viewer::start(&folder, "builtin:three ball.json") else { return };
    viewer.press("i");
    let three = rendered("builtin:three", SIZE_TEXT, SAMPLES);
    let red = rendered(&ball, SIZE_TEXT, SAMPLES);
    wait_for_picture(&viewer, "the first scene", &three);
    viewer.press("Next");
    wait_for("the second title", || (viewer.title() == "octray · ball.json").then_some(()));
    wait_for_picture(&viewer, "the second scene", &red);
    viewer.press("Prior");
    wait_for("the first title", || (viewer.title() == "octray · builtin:three").then_some(()));
    wait_for_picture(&viewer, "the first scene again", &three);
    // There is none before the first: it goes around.
    viewer.press("Prior");
    wait_for_picture(&viewer, "the last scene", &red);

    folder.write("ball.json", scene([0.1, 0.2, 0.9]));
    let blue = rendered(&ball, SIZE_TEXT, SAMPLES);
    assert!(difference(&red, &blue) > OTHER);
    wait_for_picture(&viewer, "the scene as its file has become", &blue);
    let yellow = || count(&viewer, [255, 255, 0]);
    assert_eq!(yellow(), 0);
    folder.write("ball.json", "{ \"format\": \"octray-1\",");
    wait_for("an error", || (yellow() > 200).then_some(()));
    // Below the text.
    let lower = SIZE[0] * SIZE[1] * 2 / 3;
    assert!(difference(&viewer.picture()[lower..], &blue[lower..]) < SAME, "what was there before stays");
    folder.write("ball.json", scene([0.9, 0.1, 0.1]));
    wait_for_picture(&viewer, "the scene as it was mended", &red);
    assert_eq!(yellow(), 0, "the error is over");
}

#[test]
fn screenshots_are_rendered_again_byte_by_byte() {
    let folder = Folder::new();
    let shots = folder.path("shots");
    fs::create_dir(&shots).unwrap();
    folder.write("ball.json", scene([0.9, 0.5, 0.1]));
    let arguments = "ball.json builtin:three --seed 7 --screenshots shots";
    let Some(viewer) = Viewer::start(&folder, arguments) else { return };
    viewer.press("i");

    viewer.press("Tab");
    let first = shot(&shots, "octray-ball-0001");
    assert_eq!((&first["render"]["seed"], &first["max_bounces"]), (&7.into(), &3.into()));
    assert_eq!(first["resolution"], Value::from(SIZE.to_vec()));
    assert_renders_again(&shots.join("octray-ball-0001"));

    // Everything else than at first: the scene, bounces, exposure, tone, equations.
    viewer.press("Next");
    wait_for("the second title", || (viewer.title() == "octray · builtin:three").then_some(()));
    for key in ["bracketright", "bracketright", "e", "o", "o", "x", "x"] {
        viewer.press(key);
    }
    // Equations come with another pipeline, which takes a moment: as many pictures as that is.
    let mut number = 0;
    let chosen = wait_for("a screenshot with other equations", || {
        number += 1;
        viewer.press("Tab");
        let shot = shot(&shots, &format!("octray-three-{number:04}"));
        (shot["render"]["sphere"] == "naive").then_some(shot)
    });
    let render = &chosen["render"];
    assert_eq!((&render["exposure"], &render["tone"]), (&0.5.into(), &"aces".into()), "{chosen}");
    assert_eq!((&render["triangle"], &chosen["scene"]), (&"moller-trumbore".into(), &"builtin:three".into()));
    let own = octray::scene::load("builtin:three").unwrap().max_bounces;
    assert_eq!(chosen["max_bounces"], own + 2);
    assert_renders_again(&shots.join(format!("octray-three-{number:04}")));

    let next = format!("octray-three-{:04}", number + 1);
    let before = viewer.picture();
    let walking = viewer.hold("w", || {
        wait_for_another(&viewer, "a walk", &before);
        viewer.press("Tab");
        shot(&shots, &next)
    });
    assert_ne!(walking["camera"], chosen["camera"]);
    assert_renders_again(&shots.join(next));
}

#[test]
fn a_number_of_frames_ends_with_figures_of_them() {
    let folder = Folder::new();
    let Some(viewer) = Viewer::start(&folder, "builtin:three --frames 400 --json") else { return };
    let report: Value = serde_json::from_str(&viewer.end()).unwrap();
    let number = |name: &str| report[name].as_f64().unwrap_or_else(|| panic!("{name}: {report}"));
    assert_eq!((&report["schema"], &report["front_end"]), (&"octray-window-1".into(), &"window".into()));
    assert_eq!(report["frames"], 400);
    // A frame comes when it is due and not before: 60 a second unless the display says otherwise.
    assert!((0.5..80.0).contains(&number("fps")), "{report}");
    assert!(number("passes") >= 200.0 && number("passes_per_s") > number("fps"), "{report}");
    let shares = [number("tracing_share"), number("painting_share")];
    assert!(shares.iter().all(|share| *share > 0.0) && shares.iter().sum::<f64>() < 1.05, "{report}");
    assert!(number("painting_ms") > 0.0 && number("presenting_ms") > 0.0, "{report}");
    assert!(number("answer_ms") <= number("slowest_answer_ms"), "{report}");
}

/// Pixels of the window in this colour.
fn count(viewer: &Viewer, color: [u8; 3]) -> usize {
    viewer.pixels().iter().filter(|&&pixel| pixel == color).count()
}

/// A ball of a colour under a sky of another.
fn scene(color: [f32; 3]) -> String {
    serde_json::json!({
        "format": "octray-1",
        "camera": { "position": [0, 0, 5], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov": 40 },
        "max_bounces": 3,
        "sky": { "color": [0.5, 0.7, 1.0] },
        "materials": { "paint": { "type": "diffuse", "color": color } },
        "spheres": [{ "center": [0, 0, 0], "radius": 1.4, "material": "paint" }],
    })
    .to_string()
}

/// The view of a screenshot, which is the last of its files.
fn shot(folder: &Path, name: &str) -> Value {
    let file = folder.join(name).with_extension("json");
    wait_for(name, || serde_json::from_slice(&fs::read(&file).ok()?).ok())
}
