//! The state machine: what happened becomes where the camera is, what is chosen, and what is to be done.
//!
//! For: [`State`]. May import: `keys`, `walker`, `controls`, `playlist`. Must never know: threads, windows, terminals, files.

use super::controls::Controls;
use super::keys::{self, Action, Command, Key};
use super::playlist::Playlist;
use super::walker::{Held, Walker};
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// What a front end reports.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    Key {
        key: Key,
        down: bool,
        repeat: bool,
    },
    /// The mouse went so many pixels right and down.
    Mouse([f64; 2]),
    /// Steps away from the user.
    Wheel(f64),
    Click,
    /// The front end has lost its user's attention: no key is known to be down.
    Unfocused,
    /// The name of a scene, or of a folder of some.
    Dropped(String),
    /// Frames a second that the display shows.
    Rate(f64),
    Quit,
}

/// What is to be done by whoever runs the state machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Show the playlist's current scene.
    Load,
    /// Read the current scene again.
    Reload,
    Screenshot,
    Quit,
}

/// Longest time that the camera moves by between two frames: after a longer pause it does not jump.
const LONGEST_STEP: Duration = Duration::from_millis(250);

#[derive(Clone, Debug)]
pub struct State {
    pub playlist: Playlist,
    pub walker: Walker,
    pub controls: Controls,
    /// Scene units a second; 0 until something was seen of the scene.
    pub speed: f64,
    /// Is the mouse to be caught?
    pub caught: bool,
    /// Frames a second to show.
    pub rate: f64,
    held: Held,
    /// Up to when the camera has moved, and for how long keys were down since the last frame.
    now: Instant,
    moved: Duration,
    /// Asked for on the command line, for every scene.
    bounces: Option<u32>,
    /// Those of the scene, unless the command line has others.
    own_bounces: u32,
    /// By names of scenes.
    left: BTreeMap<String, Left>,
}

/// How a scene was left.
#[derive(Clone, Debug)]
struct Left {
    walker: Walker,
    /// If others were chosen than the scene's own.
    bounces: Option<u32>,
}

impl State {
    /// `bounces`: for every scene, whatever it says itself.
    pub fn new(
        playlist: Playlist,
        scene: &Scene,
        controls: Controls,
        bounces: Option<u32>,
        now: Instant,
    ) -> Self {
        Self {
            playlist,
            walker: Walker::new(scene.camera),
            controls,
            speed: 0.0,
            caught: false,
            rate: 60.0,
            held: Held::default(),
            now,
            moved: Duration::ZERO,
            bounces,
            own_bounces: bounces.unwrap_or(scene.max_bounces),
            left: BTreeMap::new(),
        }
    }

    /// Another scene is there in the place of the one of this name, or, with `again`, the same one was read once more. Who comes back to a scene
    /// finds it as it was left.
    pub fn arrive(&mut self, scene: &Scene, again: bool, before: &str) {
        let own = self.bounces.unwrap_or(scene.max_bounces);
        let own_before = std::mem::replace(&mut self.own_bounces, own);
        let mut bounces = Some(self.controls.bounces).filter(|chosen| *chosen != own_before);
        if !again {
            self.left.insert(before.to_string(), Left { walker: self.walker.clone(), bounces });
            let fresh = Left { walker: Walker::new(scene.camera), bounces: None };
            Left { walker: self.walker, bounces } =
                self.left.remove(self.playlist.current()).unwrap_or(fresh);
            // Keys that are down go on at the pace of this scene, not of the one before.
            self.speed = 0.0;
        }
        self.controls.bounces = bounces.unwrap_or(own);
        // It may have been changed since.
        self.walker.rehome(scene.camera);
    }

    /// Moves the camera on to where a frame sees it.
    pub fn advance(&mut self, to: Instant) {
        self.walk(to);
        self.moved = Duration::ZERO;
    }

    /// Moves the camera on as the keys that are down say.
    fn walk(&mut self, to: Instant) {
        let step = to.saturating_duration_since(self.now).min(LONGEST_STEP - self.moved);
        self.now = self.now.max(to);
        if self.held != Held::default() {
            self.walker.advance(&self.held, step.as_secs_f64(), self.speed);
            self.moved += step;
        }
    }

    /// Takes in what happened at a moment: keys hold from when they went down to when they came up, however many frames that is.
    pub fn handle(&mut self, event: &Event, at: Instant) -> Option<Effect> {
        self.walk(at);
        match *event {
            Event::Key { key, down, repeat } => return self.key(key, down, repeat),
            Event::Mouse(travel) if self.caught => self.walker.look(travel),
            Event::Mouse(_) => {}
            Event::Wheel(steps) => self.walker.zoom_by(steps),
            Event::Click => self.caught = true,
            Event::Unfocused => {
                self.held = Held::default();
                self.caught = false;
            }
            Event::Dropped(ref name) => return self.playlist.drop_in(name).then_some(Effect::Load),
            // Displays that do not know their rate say 0.
            Event::Rate(rate) if rate.is_finite() && rate >= 1.0 => self.rate = rate,
            Event::Rate(_) => {}
            Event::Quit => return Some(Effect::Quit),
        }
        None
    }

    fn key(&mut self, key: Key, down: bool, repeat: bool) -> Option<Effect> {
        match keys::action_of(key)? {
            Action::Hold(motion) => self.held.set(motion, down),
            Action::Do(command) if down && (!repeat || repeats(command)) => return self.command(command),
            Action::Do(_) => {}
        }
        None
    }

    fn command(&mut self, command: Command) -> Option<Effect> {
        self.controls.apply(command);
        match command {
            Command::NextScene => self.playlist.next(),
            Command::PreviousScene => self.playlist.previous(),
            Command::Reload => return Some(Effect::Reload),
            Command::Screenshot => return Some(Effect::Screenshot),
            Command::Home => self.walker.go_home(),
            Command::Narrower => self.walker.zoom_by(1.0),
            Command::Wider => self.walker.zoom_by(-1.0),
            Command::Release => self.caught = false,
            _ => return None,
        }
        matches!(command, Command::NextScene | Command::PreviousScene).then_some(Effect::Load)
    }
}

/// Does a key that stays down do it again and again?
fn repeats(command: Command) -> bool {
    use Command::*;
    matches!(command, Narrower | Wider | FewerBounces | MoreBounces | Coarser | Finer | Brighter | Darker)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tone::Tone;
    use crate::viewer::keys::Motion;
    use crate::viewer::views::View;

    fn start() -> (State, Instant) {
        let scene = crate::scene::load("builtin:three").unwrap();
        let names = ["builtin:three".to_string(), "builtin:thesis".to_string()];
        let now = Instant::now();
        let controls = Controls::new(scene.max_bounces, 2, 8, Tone::default());
        (State::new(Playlist::new(&names).unwrap(), &scene, controls, None, now), now)
    }
    /// Is a key down that moves the camera?
    fn moving(state: &State) -> bool {
        use Motion::*;
        let motions = [Forward, Back, Left, Right, Up, Down, TurnLeft, TurnRight, TurnUp, TurnDown];
        motions.into_iter().any(|motion| state.held.is(motion))
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
        let from = state.walker.camera().position;
        state.handle(&key(Key::Char('w'), true), now + ms(100));
        assert!(moving(&state));
        state.handle(&key(Key::Char('w'), false), now + ms(120));
        assert!(!moving(&state));
        state.advance(now + ms(500));
        let walked = state.walker.camera().position.distance(from);
        assert!((walked - 0.2).abs() < 1e-4, "20 ms at 10 units a second: {walked}");
    }

    #[test]
    fn a_display_without_a_rate_changes_nothing() {
        let (mut state, now) = start();
        for (told, rate) in [(0.0, 60.0), (f64::NAN, 60.0), (144.0, 144.0), (-1.0, 144.0), (0.2, 144.0)] {
            state.handle(&Event::Rate(told), now);
            assert_eq!(state.rate, rate, "{told}");
        }
    }

    #[test]
    fn nothing_jumps_after_a_pause() {
        let (mut state, now) = start();
        state.speed = 1.0;
        let from = state.walker.camera().position;
        state.handle(&key(Key::Char('w'), true), now);
        state.advance(now + ms(60_000));
        assert!(state.walker.camera().position.distance(from) < 0.26);
        // However much is heard of meanwhile.
        let from = state.walker.camera().position;
        for second in 61..70 {
            state.handle(&Event::Mouse([0.0; 2]), now + ms(second * 1_000));
        }
        state.advance(now + ms(70_000));
        let walked = state.walker.camera().position.distance(from);
        assert!((0.2..0.26).contains(&walked), "{walked}");
        state.advance(now + ms(70_100));
        assert!(state.walker.camera().position.distance(from) > walked + 0.09, "each frame goes on");
    }

    #[test]
    fn a_key_that_comes_late_in_a_long_frame_moves_too() {
        let (mut state, now) = start();
        state.speed = 10.0;
        let from = state.walker.camera().position;
        state.handle(&key(Key::Char('w'), true), now + ms(300));
        state.handle(&key(Key::Char('w'), false), now + ms(400));
        state.advance(now + ms(500));
        let walked = state.walker.camera().position.distance(from);
        assert!((walked - 1.0).abs() < 1e-4, "100 ms at 10 units a second: {walked}");
    }

    #[test]
    fn keys_are_let_go_when_the_user_looks_away() {
        let (mut state, now) = start();
        state.handle(&Event::Click, now);
        state.handle(&key(Key::Up, true), now);
        state.handle(&Event::Unfocused, now);
        assert!(!moving(&state) && !state.caught);
    }

    #[test]
    fn the_mouse_turns_only_while_caught_and_escape_lets_it_go() {
        let (mut state, now) = start();
        let home = *state.walker.camera();
        state.handle(&Event::Mouse([50.0, 0.0]), now);
        assert_eq!(*state.walker.camera(), home);
        state.handle(&Event::Click, now);
        state.handle(&Event::Mouse([50.0, 0.0]), now);
        assert_ne!(*state.walker.camera(), home);
        state.handle(&key(Key::Escape, true), now);
        assert!(!state.caught);
        state.handle(&key(Key::Home, true), now);
        assert_eq!(*state.walker.camera(), home);
    }

    #[test]
    fn commands_become_effects_once_a_press() {
        let (mut state, now) = start();
        assert_eq!(state.handle(&key(Key::PageDown, true), now), Some(Effect::Load));
        assert_eq!(state.playlist.current(), "builtin:thesis");
        assert_eq!(state.handle(&key(Key::PageDown, false), now), None);
        let again = Event::Key { key: Key::PageDown, down: true, repeat: true };
        assert_eq!(state.handle(&again, now), None, "held keys do not leaf on");
        assert_eq!(state.handle(&key(Key::Char(','), true), now), Some(Effect::Load));
        assert_eq!(state.playlist.current(), "builtin:three");
        assert_eq!(state.handle(&key(Key::Tab, true), now), Some(Effect::Screenshot));
        assert_eq!(state.handle(&key(Key::Char('r'), true), now), Some(Effect::Reload));
        assert_eq!(state.handle(&Event::Quit, now), Some(Effect::Quit));
        assert_eq!(state.handle(&Event::Dropped("new.obj".into()), now), Some(Effect::Load));
        assert_eq!(state.playlist.current(), "new.obj");
        state.handle(&key(Key::Char('2'), true), now);
        assert_eq!(state.controls.view, View::Normals);
        let (field, exposure) = (state.walker.camera().vertical_fov, state.controls.tone.exposure);
        let held = |key| Event::Key { key, down: true, repeat: true };
        state.handle(&held(Key::Char('+')), now);
        state.handle(&held(Key::Char('e')), now);
        assert!(state.walker.camera().vertical_fov < field && state.controls.tone.exposure > exposure);
        state.handle(&Event::Wheel(-1.0), now);
        assert!((state.walker.camera().vertical_fov - field).abs() < 1e-4);
    }

    #[test]
    fn another_scene_has_its_own_camera_and_bounces_and_is_found_again_as_it_was_left() {
        let (mut state, now) = start();
        let three = crate::scene::load("builtin:three").unwrap();
        let mut thesis = crate::scene::load("builtin:thesis").unwrap();
        thesis.max_bounces = 7;
        state.playlist.next();
        state.arrive(&thesis, false, "builtin:three");
        assert_eq!((*state.walker.camera(), state.controls.bounces), (thesis.camera, 7));
        state.handle(&Event::Wheel(1.0), now);
        state.controls.bounces = 3;
        let moved = *state.walker.camera();
        state.arrive(&thesis, true, "builtin:thesis");
        assert_eq!((*state.walker.camera(), state.controls.bounces), (moved, 3), "read again");
        state.playlist.next();
        state.arrive(&three, false, "builtin:thesis");
        assert_eq!((*state.walker.camera(), state.controls.bounces), (three.camera, three.max_bounces));
        state.playlist.next();
        thesis.camera.vertical_fov = 50.0;
        state.arrive(&thesis, false, "builtin:three");
        assert_eq!((*state.walker.camera(), state.controls.bounces), (moved, 3), "as it was left");
        state.handle(&key(Key::Home, true), now);
        assert_eq!(*state.walker.camera(), thesis.camera, "home is where the file has it now");
    }

    #[test]
    fn bounces_are_as_the_file_has_them_until_others_are_chosen() {
        let (mut state, now) = start();
        let mut three = crate::scene::load("builtin:three").unwrap();
        let thesis = crate::scene::load("builtin:thesis").unwrap();
        let mut arrive = |state: &mut State, bounces, again, before| {
            three.max_bounces = bounces;
            state.arrive(&three, again, before);
            state.controls.bounces
        };
        assert_eq!(arrive(&mut state, 9, true, "builtin:three"), 9, "changed in its file");
        state.playlist.next();
        state.arrive(&thesis, false, "builtin:three");
        state.playlist.next();
        assert_eq!(arrive(&mut state, 8, false, "builtin:thesis"), 8, "changed while another one was shown");
        state.handle(&key(Key::Char(']'), true), now);
        assert_eq!(arrive(&mut state, 5, true, "builtin:three"), 9, "chosen");
    }

    #[test]
    fn a_key_that_is_down_takes_no_step_into_another_scene_before_its_pace_is_known() {
        let (mut state, now) = start();
        state.speed = 1e6;
        state.handle(&key(Key::Char('w'), true), now);
        state.playlist.next();
        let thesis = crate::scene::load("builtin:thesis").unwrap();
        state.arrive(&thesis, false, "builtin:three");
        state.advance(now + ms(100));
        assert_eq!(state.walker.camera().position, thesis.camera.position);
    }

    #[test]
    fn bounces_of_the_command_line_are_for_every_scene() {
        let (mut state, _) = start();
        state.bounces = Some(2);
        let mut thesis = crate::scene::load("builtin:thesis").unwrap();
        thesis.max_bounces = 7;
        state.playlist.next();
        state.arrive(&thesis, false, "builtin:three");
        assert_eq!(state.controls.bounces, 2);
    }
}
