//! Turns events into changes of camera, controls and playlist, and into effects.

use super::camera_controller::{CameraController, Motion};
use super::controls::Controls;
use super::keys::{self, Action, Key};
use super::playlist::Playlist;
use octray_formats::scene::Scene;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::time::{Duration, Instant};

/// An event from a front end.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A key goes down or up.
    Key {
        /// The key.
        key: Key,
        /// Whether it is pressed; false if it is released.
        down: bool,
        /// Whether the system sent the event because the key is held. Always false for releases.
        repeat: bool,
    },
    /// Mouse travel in pixels, right and down.
    Mouse([f64; 2]),
    /// Steps of the mouse wheel, positive away from the user.
    Wheel(f64),
    /// The left mouse button goes down, which captures the mouse.
    Click,
    /// The window lost the focus, so that all keys count as released.
    Unfocused,
    /// A dropped scene file or folder.
    Dropped(OsString),
    /// Refresh rate of the display, in frames per second.
    Rate(f64),
    /// The front end closes, and the render loop ends.
    Quit,
}

/// An action of the render loop after an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effect {
    /// Load the playlist's current scene.
    Load,
    /// Focus on what is in the middle of the picture.
    Focus,
    Screenshot,
    Quit,
}

/// Longest time step of the camera between two frames, so that it does not jump after a pause.
const MAX_STEP: Duration = Duration::from_millis(250);

/// The viewer's state.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub playlist: Playlist,
    pub camera_controller: CameraController,
    pub controls: Controls,
    /// Walking speed in scene units per second; `None` until a frame of the scene is painted.
    pub speed: Option<f64>,
    /// Whether the mouse is captured.
    pub mouse_captured: bool,
    /// Frames per second to show.
    pub rate: f64,
    held: BTreeSet<Motion>,
    /// The time up to which the camera has moved.
    now: Instant,
    /// How long the camera has moved since the last frame.
    moved_for: Duration,
    /// The bounces requested for the scene: its own, or the command line's.
    requested_bounces: u32,
    /// The playlist name of the scene that is shown.
    name: OsString,
    /// Camera and chosen bounces of scenes that were left, by playlist name.
    saved: BTreeMap<OsString, (CameraController, Option<u32>)>,
}

impl State {
    /// Starts with a scene.
    pub fn new(playlist: Playlist, scene: &Scene, controls: Controls) -> Self {
        Self {
            name: playlist.current().to_os_string(),
            playlist,
            camera_controller: CameraController::new(scene),
            controls,
            speed: None,
            mouse_captured: false,
            rate: 60.0,
            held: BTreeSet::new(),
            now: Instant::now(),
            moved_for: Duration::ZERO,
            requested_bounces: controls.bounces,
            saved: BTreeMap::new(),
        }
    }

    /// Tests whether the playlist's current scene is the one that is shown.
    pub fn shows_current(&self) -> bool {
        self.name == self.playlist.current()
    }

    /// Enters the playlist's current scene, for which so many bounces are requested. A scene that was left
    /// before gets its camera and bounces back; one that is shown already was reloaded and keeps them.
    pub fn enter_scene(&mut self, scene: &Scene, requested: u32) {
        let before = std::mem::replace(&mut self.requested_bounces, requested);
        let mut bounces = Some(self.controls.bounces).filter(|chosen| *chosen != before);
        if !self.shows_current() {
            let before = std::mem::replace(&mut self.name, self.playlist.current().to_os_string());
            let (camera, chosen) =
                self.saved.remove(&self.name).unwrap_or_else(|| (CameraController::new(scene), None));
            let left = std::mem::replace(&mut self.camera_controller, camera);
            self.saved.insert(before, (left, std::mem::replace(&mut bounces, chosen)));
            // No motion until this scene's speed is known.
            self.speed = None;
        }
        self.controls.bounces = bounces.unwrap_or(requested);
        // The file's camera may have changed.
        self.camera_controller.set_home(scene);
    }

    /// Moves the camera up to the time of a frame, `to`.
    pub fn advance(&mut self, to: Instant) {
        self.move_camera(to);
        self.moved_for = Duration::ZERO;
    }

    /// Moves the camera by the held motions up to a time.
    fn move_camera(&mut self, to: Instant) {
        let step = to.saturating_duration_since(self.now).min(MAX_STEP - self.moved_for);
        self.now = self.now.max(to);
        if !self.held.is_empty() {
            self.camera_controller.advance(&self.held, step.as_secs_f64(), self.speed.unwrap_or(0.0));
            self.moved_for += step;
        }
    }

    /// Handles an event at its time. A key moves the camera from its press to its release, whatever the
    /// frame rate.
    pub fn handle(&mut self, event: &Event, at: Instant) -> Option<Effect> {
        self.move_camera(at);
        match *event {
            Event::Key { key, down, repeat } => return self.key(key, down, repeat),
            Event::Mouse(travel) if self.mouse_captured => self.camera_controller.mouse_look(travel),
            Event::Mouse(_) => {}
            Event::Wheel(steps) => self.camera_controller.zoom_by(steps),
            Event::Click => self.mouse_captured = true,
            Event::Unfocused => {
                self.held.clear();
                self.mouse_captured = false;
            }
            Event::Dropped(ref name) => return self.playlist.drop_in(name).then_some(Effect::Load),
            // Displays without a known rate report 0.
            Event::Rate(rate) if rate.is_finite() && rate >= 1.0 => self.rate = rate,
            Event::Rate(_) => {}
            Event::Quit => return Some(Effect::Quit),
        }
        None
    }

    fn key(&mut self, key: Key, down: bool, repeat: bool) -> Option<Effect> {
        match keys::action_of(key)? {
            Action::Hold(motion) if down => {
                self.held.insert(motion);
            }
            Action::Hold(motion) => {
                self.held.remove(&motion);
            }
            _ if !down => {}
            Action::Step(change) => change(&mut self.controls),
            Action::Zoom(steps) => self.camera_controller.zoom_by(steps),
            Action::Open(stops) => self.camera_controller.open_by(stops),
            _ if repeat => {}
            Action::Switch(change) => change(&mut self.controls),
            Action::Home => self.camera_controller.reset(),
            Action::Project => self.camera_controller.switch_projection(),
            Action::Focus => return Some(Effect::Focus),
            Action::ReleaseMouse => self.mouse_captured = false,
            Action::Screenshot => return Some(Effect::Screenshot),
            Action::Reload => return Some(Effect::Load),
            Action::Scene(turn) => {
                turn(&mut self.playlist);
                return Some(Effect::Load);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display_mode::DisplayMode;
    use octray_formats::scene::{Camera, load};

    /// A state whose times are milliseconds after a start.
    struct Test {
        state: State,
        start: Instant,
    }

    fn scenes() -> [Scene; 2] {
        let [three, thesis] = ["builtin:three", "builtin:thesis"].map(|name| load(name).unwrap());
        [three, Scene { max_bounces: 7, ..thesis }]
    }

    impl Test {
        fn new() -> Self {
            let [three, thesis] = scenes();
            let playlist = Playlist::new(&[three.name.clone(), thesis.name]).unwrap();
            let controls = Controls { bounces: three.max_bounces, ..Controls::default() };
            Self { state: State::new(playlist, &three, controls), start: Instant::now() }
        }
        fn handle(&mut self, event: Event, ms: u64) -> Option<Effect> {
            self.state.handle(&event, self.start + Duration::from_millis(ms))
        }
        fn key(&mut self, key: Key, down: bool, ms: u64) {
            self.handle(Event::Key { key, down, repeat: false }, ms);
        }
        fn press(&mut self, key: Key) -> Option<Effect> {
            self.handle(Event::Key { key, down: true, repeat: false }, 0)
        }
        fn repeat(&mut self, key: Key) -> Option<Effect> {
            self.handle(Event::Key { key, down: true, repeat: true }, 0)
        }
        fn advance(&mut self, ms: u64) {
            self.state.advance(self.start + Duration::from_millis(ms));
        }
        /// Returns how far the camera moves up to a frame at this time.
        fn walked_until(&mut self, ms: u64) -> f32 {
            let from = self.camera().position;
            self.advance(ms);
            self.camera().position.distance(from)
        }
        fn camera(&self) -> Camera {
            *self.state.camera_controller.camera()
        }
        /// Returns camera and bounces in the next scene of the list.
        fn enter(&mut self, scene: &Scene) -> (Camera, u32) {
            self.state.playlist.next();
            self.reload(scene)
        }
        fn reload(&mut self, scene: &Scene) -> (Camera, u32) {
            self.state.enter_scene(scene, scene.max_bounces);
            (self.camera(), self.state.controls.bounces)
        }
    }

    #[test]
    fn a_key_moves_for_as_long_as_it_is_down_between_frames_and_late_in_a_long_one() {
        for (from, to, way) in [(100, 120, 0.2), (300, 400, 1.0)] {
            let mut test = Test::new();
            test.state.speed = Some(10.0);
            let before = test.camera().position;
            test.key(Key::Char('w'), true, from);
            test.key(Key::Char('w'), false, to);
            assert!(test.state.held.is_empty());
            test.advance(500);
            let walked = test.camera().position.distance(before);
            assert!((walked - way).abs() < 1e-4, "{from} to {to} ms at 10 units a second: {walked}");
        }
    }

    #[test]
    fn nothing_jumps_after_a_pause() {
        let mut test = Test::new();
        test.state.speed = Some(1.0);
        test.key(Key::Char('w'), true, 0);
        assert!(test.walked_until(60_000) < 0.26);
        // However many events arrive meanwhile.
        let from = test.camera().position;
        for second in 61..70 {
            test.handle(Event::Mouse([0.0; 2]), second * 1_000);
        }
        test.advance(70_000);
        let walked = test.camera().position.distance(from);
        assert!((0.2..0.26).contains(&walked), "{walked}");
        assert!(test.walked_until(70_100) > 0.09, "each frame goes on");
    }

    #[test]
    fn the_mouse_turns_only_while_captured_and_escape_releases_it() {
        let mut test = Test::new();
        let home = test.camera();
        test.handle(Event::Mouse([50.0, 0.0]), 0);
        assert_eq!(test.camera(), home);
        test.handle(Event::Click, 0);
        test.handle(Event::Mouse([50.0, 0.0]), 0);
        assert_ne!(test.camera(), home);
        test.press(Key::Esc);
        assert!(!test.state.mouse_captured);
        test.press(Key::Home);
        assert_eq!(test.camera(), home);
    }

    #[test]
    fn keys_have_effects_once_a_press() {
        let mut test = Test::new();
        assert_eq!(test.press(Key::PageDown), Some(Effect::Load));
        assert_eq!(test.state.playlist.current(), "builtin:thesis");
        let up = Event::Key { key: Key::PageDown, down: false, repeat: false };
        assert_eq!(test.handle(up, 0), None);
        assert_eq!(test.repeat(Key::PageDown), None, "held keys do not repeat it");
        assert_eq!(test.press(Key::Char(',')), Some(Effect::Load));
        assert_eq!(test.state.playlist.current(), "builtin:three");
        assert_eq!(test.press(Key::Tab), Some(Effect::Screenshot));
        assert_eq!(test.press(Key::Char('r')), Some(Effect::Load));
        assert_eq!(test.handle(Event::Quit, 0), Some(Effect::Quit));
        assert_eq!(test.handle(Event::Dropped("new.obj".into()), 0), Some(Effect::Load));
        assert_eq!(test.state.playlist.current(), "new.obj");
        test.press(Key::Char('2'));
        assert_eq!(test.state.controls.mode, DisplayMode::Normals);
        let (field, exposure) = (test.camera().vertical_fov, test.state.controls.tone.exposure);
        test.repeat(Key::Char('+'));
        test.repeat(Key::Char('e'));
        assert!(test.camera().vertical_fov < field && test.state.controls.tone.exposure > exposure);
        test.handle(Event::Wheel(-1.0), 0);
        assert!((test.camera().vertical_fov - field).abs() < 1e-4);
    }

    #[test]
    fn another_scene_has_its_own_camera_and_bounces_and_is_found_again_as_it_was_left() {
        let (mut test, [three, mut thesis]) = (Test::new(), scenes());
        assert_eq!(test.enter(&thesis), (thesis.camera, 7));
        test.handle(Event::Wheel(1.0), 0);
        test.state.controls.bounces = 3;
        let moved = test.camera();
        assert_eq!(test.reload(&thesis), (moved, 3), "read again");
        assert_eq!(test.enter(&three), (three.camera, three.max_bounces));
        thesis.camera.vertical_fov = 50.0;
        assert_eq!(test.enter(&thesis), (moved, 3), "as it was left");
        test.press(Key::Home);
        assert_eq!(test.camera(), thesis.camera, "home is where the file has it now");
    }

    #[test]
    fn bounces_are_as_the_file_has_them_until_others_are_chosen() {
        let (mut test, [mut three, thesis]) = (Test::new(), scenes());
        three.max_bounces = 9;
        assert_eq!(test.reload(&three).1, 9, "changed in its file");
        test.enter(&thesis);
        three.max_bounces = 8;
        assert_eq!(test.enter(&three).1, 8, "changed while another one was shown");
        test.press(Key::Char(']'));
        three.max_bounces = 5;
        assert_eq!(test.reload(&three).1, 9, "chosen");
        test.state.playlist.next();
        test.state.enter_scene(&thesis, 2);
        assert_eq!(test.state.controls.bounces, 2, "those of the command line are for every scene");
    }

    #[test]
    fn a_key_that_is_down_takes_no_step_into_another_scene_before_its_pace_is_known() {
        let (mut test, [_, thesis]) = (Test::new(), scenes());
        test.state.speed = Some(1e6);
        test.press(Key::Char('w'));
        test.enter(&thesis);
        assert_eq!(test.walked_until(100), 0.0);
    }
}
