//! The state machine: from events to camera, controls, playlist and effects.
//!
//! For: [`Event`], `State`.

use super::camera_controller::{CameraController, Motion};
use super::controls::Controls;
use super::keys::{self, Action, Key};
use super::playlist::Playlist;
use octray_formats::scene::Scene;
use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

/// An event from a front end.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A key goes down or up.
    Key {
        /// Which one.
        key: Key,
        /// Pressed; false for released.
        down: bool,
        /// Sent again by the system while the key is held. Always false for releases.
        repeat: bool,
    },
    /// Mouse travel in pixels, right and down.
    Mouse([f64; 2]),
    /// Steps of the mouse wheel, positive away from the user.
    Wheel(f64),
    /// The left mouse button goes down: captures the mouse.
    Click,
    /// The window lost the focus: all keys count as released.
    Unfocused,
    /// A dropped scene file or folder.
    Dropped(String),
    /// Refresh rate of the display, in frames per second.
    Rate(f64),
    /// The front end closes: the render loop ends.
    Quit,
}

/// What the render loop has to do after an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effect {
    /// Load the playlist's current scene.
    Load,
    Screenshot,
    Quit,
}

/// Longest time step of the camera between two frames: no jump after a pause.
const MAX_STEP: Duration = Duration::from_millis(250);

/// The viewer's state.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub playlist: Playlist,
    pub camera_controller: CameraController,
    pub controls: Controls,
    /// Walking speed in scene units per second; 0 until the first frame of a scene.
    pub speed: f64,
    /// Whether the mouse is captured.
    pub mouse_captured: bool,
    /// Frames per second to show.
    pub rate: f64,
    held: BTreeSet<Motion>,
    /// The time up to which the camera has moved, and for how long it has moved since the last frame.
    now: Instant,
    moved_for: Duration,
    /// The command line's bounces, for every scene.
    bounces: Option<u32>,
    /// The scene's bounces, or the command line's.
    scene_bounces: u32,
    /// The playlist name of the scene that is shown.
    pub name: String,
    /// Scenes that were left, by playlist name.
    saved: BTreeMap<String, SavedScene>,
}

/// Camera and bounces of a scene that was left.
#[derive(Clone, Debug)]
struct SavedScene {
    camera_controller: CameraController,
    /// `Some` if they differ from the scene's.
    bounces: Option<u32>,
}

impl State {
    /// `bounces` overrides every scene's.
    pub fn new(
        playlist: Playlist,
        scene: &Scene,
        controls: Controls,
        bounces: Option<u32>,
        now: Instant,
    ) -> Self {
        Self {
            name: playlist.current().to_string(),
            playlist,
            camera_controller: CameraController::new(scene.camera),
            controls,
            speed: 0.0,
            mouse_captured: false,
            rate: 60.0,
            held: BTreeSet::new(),
            now,
            moved_for: Duration::ZERO,
            bounces,
            scene_bounces: bounces.unwrap_or(scene.max_bounces),
            saved: BTreeMap::new(),
        }
    }

    /// Whether the playlist's current scene is the one that is shown.
    pub fn shows_current(&self) -> bool {
        self.name == self.playlist.current()
    }

    /// Enters the playlist's current scene; a scene that was left before gets its camera and bounces back.
    /// One that is shown already was reloaded: it keeps them.
    pub fn enter_scene(&mut self, scene: &Scene) {
        let own = self.bounces.unwrap_or(scene.max_bounces);
        let own_before = std::mem::replace(&mut self.scene_bounces, own);
        let mut bounces = Some(self.controls.bounces).filter(|chosen| *chosen != own_before);
        if !self.shows_current() {
            let before = std::mem::replace(&mut self.name, self.playlist.current().to_string());
            let left = SavedScene { camera_controller: self.camera_controller.clone(), bounces };
            self.saved.insert(before, left);
            let fresh = SavedScene { camera_controller: CameraController::new(scene.camera), bounces: None };
            SavedScene { camera_controller: self.camera_controller, bounces } =
                self.saved.remove(&self.name).unwrap_or(fresh);
            // No motion until this scene's speed is known.
            self.speed = 0.0;
        }
        self.controls.bounces = bounces.unwrap_or(own);
        // The file's camera may have changed.
        self.camera_controller.set_home(scene.camera);
    }

    /// Moves the camera up to the time of a frame.
    pub fn advance(&mut self, to: Instant) {
        self.move_camera(to);
        self.moved_for = Duration::ZERO;
    }

    /// Moves the camera by the held motions.
    fn move_camera(&mut self, to: Instant) {
        let step = to.saturating_duration_since(self.now).min(MAX_STEP - self.moved_for);
        self.now = self.now.max(to);
        if !self.held.is_empty() {
            self.camera_controller.advance(&self.held, step.as_secs_f64(), self.speed);
            self.moved_for += step;
        }
    }

    /// Handles an event at its time: a key moves the camera from press to release, independent of frames.
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
            _ if repeat => {}
            Action::Switch(change) => change(&mut self.controls),
            Action::Home => self.camera_controller.reset(),
            Action::ReleaseMouse => self.mouse_captured = false,
            Action::Screenshot => return Some(Effect::Screenshot),
            Action::Reload => return Some(Effect::Load),
            Action::NextScene => {
                self.playlist.next();
                return Some(Effect::Load);
            }
            Action::PreviousScene => {
                self.playlist.previous();
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
    use octray_engine::render::LaneChoice;
    use octray_engine::tone::Tone;

    fn start() -> (State, Instant) {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let names = ["builtin:three".to_string(), "builtin:thesis".to_string()];
        let now = Instant::now();
        let controls = Controls::new(scene.max_bounces, 2, LaneChoice::Eight, Tone::default());
        (State::new(Playlist::new(&names).unwrap(), &scene, controls, None, now), now)
    }
    fn key(key: Key, down: bool) -> Event {
        Event::Key { key, down, repeat: false }
    }
    fn ms(time: u64) -> Duration {
        Duration::from_millis(time)
    }

    #[test]
    fn a_key_moves_for_as_long_as_it_is_down_between_frames_too() {
        let (mut state, now) = start();
        state.speed = 10.0;
        let from = state.camera_controller.camera().position;
        state.handle(&key(Key::Char('w'), true), now + ms(100));
        assert!(!state.held.is_empty());
        state.handle(&key(Key::Char('w'), false), now + ms(120));
        assert!(state.held.is_empty());
        state.advance(now + ms(500));
        let walked = state.camera_controller.camera().position.distance(from);
        assert!((walked - 0.2).abs() < 1e-4, "20 ms at 10 units a second: {walked}");
    }

    #[test]
    fn a_display_without_a_rate_changes_nothing() {
        let (mut state, now) = start();
        for (reported, rate) in [(0.0, 60.0), (f64::NAN, 60.0), (144.0, 144.0), (-1.0, 144.0), (0.2, 144.0)] {
            state.handle(&Event::Rate(reported), now);
            assert_eq!(state.rate, rate, "{reported}");
        }
    }

    #[test]
    fn nothing_jumps_after_a_pause() {
        let (mut state, now) = start();
        state.speed = 1.0;
        let from = state.camera_controller.camera().position;
        state.handle(&key(Key::Char('w'), true), now);
        state.advance(now + ms(60_000));
        assert!(state.camera_controller.camera().position.distance(from) < 0.26);
        // However many events arrive meanwhile.
        let from = state.camera_controller.camera().position;
        for second in 61..70 {
            state.handle(&Event::Mouse([0.0; 2]), now + ms(second * 1_000));
        }
        state.advance(now + ms(70_000));
        let walked = state.camera_controller.camera().position.distance(from);
        assert!((0.2..0.26).contains(&walked), "{walked}");
        state.advance(now + ms(70_100));
        assert!(
            state.camera_controller.camera().position.distance(from) > walked + 0.09,
            "each frame goes on"
        );
    }

    #[test]
    fn a_key_that_comes_late_in_a_long_frame_moves_too() {
        let (mut state, now) = start();
        state.speed = 10.0;
        let from = state.camera_controller.camera().position;
        state.handle(&key(Key::Char('w'), true), now + ms(300));
        state.handle(&key(Key::Char('w'), false), now + ms(400));
        state.advance(now + ms(500));
        let walked = state.camera_controller.camera().position.distance(from);
        assert!((walked - 1.0).abs() < 1e-4, "100 ms at 10 units a second: {walked}");
    }

    #[test]
    fn keys_are_released_when_the_focus_is_lost() {
        let (mut state, now) = start();
        state.handle(&Event::Click, now);
        state.handle(&key(Key::Up, true), now);
        state.handle(&Event::Unfocused, now);
        assert!(state.held.is_empty() && !state.mouse_captured);
    }

    #[test]
    fn the_mouse_turns_only_while_caught_and_escape_lets_it_go() {
        let (mut state, now) = start();
        let home = *state.camera_controller.camera();
        state.handle(&Event::Mouse([50.0, 0.0]), now);
        assert_eq!(*state.camera_controller.camera(), home);
        state.handle(&Event::Click, now);
        state.handle(&Event::Mouse([50.0, 0.0]), now);
        assert_ne!(*state.camera_controller.camera(), home);
        state.handle(&key(Key::Escape, true), now);
        assert!(!state.mouse_captured);
        state.handle(&key(Key::Home, true), now);
        assert_eq!(*state.camera_controller.camera(), home);
    }

    #[test]
    fn commands_become_effects_once_a_press() {
        let (mut state, now) = start();
        assert_eq!(state.handle(&key(Key::PageDown, true), now), Some(Effect::Load));
        assert_eq!(state.playlist.current(), "builtin:thesis");
        assert_eq!(state.handle(&key(Key::PageDown, false), now), None);
        let repeated = Event::Key { key: Key::PageDown, down: true, repeat: true };
        assert_eq!(state.handle(&repeated, now), None, "held keys do not repeat it");
        assert_eq!(state.handle(&key(Key::Char(','), true), now), Some(Effect::Load));
        assert_eq!(state.playlist.current(), "builtin:three");
        assert_eq!(state.handle(&key(Key::Tab, true), now), Some(Effect::Screenshot));
        assert_eq!(state.handle(&key(Key::Char('r'), true), now), Some(Effect::Load));
        assert_eq!(state.handle(&Event::Quit, now), Some(Effect::Quit));
        assert_eq!(state.handle(&Event::Dropped("new.obj".into()), now), Some(Effect::Load));
        assert_eq!(state.playlist.current(), "new.obj");
        state.handle(&key(Key::Char('2'), true), now);
        assert_eq!(state.controls.mode, DisplayMode::Normals);
        let (field, exposure) = (state.camera_controller.camera().vertical_fov, state.controls.tone.exposure);
        let held = |key| Event::Key { key, down: true, repeat: true };
        state.handle(&held(Key::Char('+')), now);
        state.handle(&held(Key::Char('e')), now);
        assert!(
            state.camera_controller.camera().vertical_fov < field && state.controls.tone.exposure > exposure
        );
        state.handle(&Event::Wheel(-1.0), now);
        assert!((state.camera_controller.camera().vertical_fov - field).abs() < 1e-4);
    }

    #[test]
    fn another_scene_has_its_own_camera_and_bounces_and_is_found_again_as_it_was_left() {
        let (mut state, now) = start();
        let three = octray_formats::scene::load("builtin:three").unwrap();
        let mut thesis = octray_formats::scene::load("builtin:thesis").unwrap();
        thesis.max_bounces = 7;
        state.playlist.next();
        state.enter_scene(&thesis);
        assert_eq!((*state.camera_controller.camera(), state.controls.bounces), (thesis.camera, 7));
        state.handle(&Event::Wheel(1.0), now);
        state.controls.bounces = 3;
        let moved = *state.camera_controller.camera();
        state.enter_scene(&thesis);
        assert_eq!((*state.camera_controller.camera(), state.controls.bounces), (moved, 3), "read again");
        state.playlist.next();
        state.enter_scene(&three);
        assert_eq!(
            (*state.camera_controller.camera(), state.controls.bounces),
            (three.camera, three.max_bounces)
        );
        state.playlist.next();
        thesis.camera.vertical_fov = 50.0;
        state.enter_scene(&thesis);
        assert_eq!((*state.camera_controller.camera(), state.controls.bounces), (moved, 3), "as it was left");
        state.handle(&key(Key::Home, true), now);
        assert_eq!(*state.camera_controller.camera(), thesis.camera, "home is where the file has it now");
    }

    #[test]
    fn bounces_are_as_the_file_has_them_until_others_are_chosen() {
        let (mut state, now) = start();
        let mut three = octray_formats::scene::load("builtin:three").unwrap();
        let thesis = octray_formats::scene::load("builtin:thesis").unwrap();
        let mut enter_scene = |state: &mut State, bounces| {
            three.max_bounces = bounces;
            state.enter_scene(&three);
            state.controls.bounces
        };
        assert_eq!(enter_scene(&mut state, 9), 9, "changed in its file");
        state.playlist.next();
        state.enter_scene(&thesis);
        state.playlist.next();
        assert_eq!(enter_scene(&mut state, 8), 8, "changed while another one was shown");
        state.handle(&key(Key::Char(']'), true), now);
        assert_eq!(enter_scene(&mut state, 5), 9, "chosen");
    }

    #[test]
    fn a_key_that_is_down_takes_no_step_into_another_scene_before_its_pace_is_known() {
        let (mut state, now) = start();
        state.speed = 1e6;
        state.handle(&key(Key::Char('w'), true), now);
        state.playlist.next();
        let thesis = octray_formats::scene::load("builtin:thesis").unwrap();
        state.enter_scene(&thesis);
        state.advance(now + ms(100));
        assert_eq!(state.camera_controller.camera().position, thesis.camera.position);
    }

    #[test]
    fn bounces_of_the_command_line_are_for_every_scene() {
        let (mut state, _) = start();
        state.bounces = Some(2);
        let mut thesis = octray_formats::scene::load("builtin:thesis").unwrap();
        thesis.max_bounces = 7;
        state.playlist.next();
        state.enter_scene(&thesis);
        assert_eq!(state.controls.bounces, 2);
    }
}
