//! The camera that walks: place, direction, field of view, and how keys and the mouse move them.
//!
//! For: [`Walker`] and [`Held`]. May import: `scene`'s camera, `keys`. Must never know: pixels, clocks.

use super::keys::Motion;
use crate::scene::Camera;
use glam::{DQuat, DVec3};

/// Radians a second that a held arrow key turns by.
const TURN: f64 = 1.2;
/// Radians that a pixel of mouse travel turns by, at a field of view of 90°; narrower ones turn less.
const MOUSE: f64 = 0.0025;
/// How much faster everything is with [`Motion::Fast`].
const FAST: f64 = 4.0;
/// Steepest look up or down, in radians: short of the pole, where left and right end.
const STEEPEST: f64 = 89.0 * std::f64::consts::PI / 180.0;
/// Field of view: bounds in degrees, and what a step multiplies the picture's width by.
const FIELD: [f32; 2] = [1.0, 150.0];
const FIELD_STEP: f64 = 0.9;

/// The motions whose keys are down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Held([bool; Motion::COUNT]);

impl Held {
    pub fn set(&mut self, motion: Motion, held: bool) {
        self.0[motion as usize] = held;
    }
    pub fn is(&self, motion: Motion) -> bool {
        self.0[motion as usize]
    }
    /// −1, 0 or 1.
    fn axis(&self, back: Motion, forth: Motion) -> f64 {
        f64::from(self.is(forth)) - f64::from(self.is(back))
    }
}

/// A camera in the hands of somebody. Until it is moved, it is the scene's own to the last bit.
#[derive(Clone, Debug)]
pub struct Walker {
    home: Camera,
    camera: Camera,
    position: DVec3,
    /// Which way is up for whoever walks; of unit length.
    up: DVec3,
    /// Level, of unit length: where a heading of 0 looks.
    ahead: DVec3,
    /// Radians, leftwards around `up`.
    heading: f64,
    /// Radians above the level.
    pitch: f64,
}

impl Walker {
    pub fn new(home: Camera) -> Self {
        let position = home.position.as_dvec3();
        let up = home.up.as_dvec3().normalize();
        let sight = (home.look_at.as_dvec3() - position).normalize();
        let level = sight - up * sight.dot(up);
        let ahead = level.try_normalize().unwrap_or_else(|| up.any_orthonormal_vector());
        let pitch = sight.dot(up).clamp(-1.0, 1.0).asin();
        Self { home, camera: home, position, up, ahead, heading: 0.0, pitch }
    }
    pub fn camera(&self) -> &Camera {
        &self.camera
    }
    /// The way that is level ahead of it, and which way is up.
    pub fn level(&self) -> (DVec3, DVec3) {
        (DQuat::from_axis_angle(self.up, self.heading) * self.ahead, self.up)
    }
    /// Back to where the scene has it.
    pub fn go_home(&mut self) {
        *self = Self::new(self.home);
    }
    /// A scene of the same kind was read again: its own camera is this one from now on. Who has not moved looks through it at once.
    pub fn rehome(&mut self, home: Camera) {
        if self.camera == self.home {
            *self = Self::new(home);
        } else {
            self.home = home;
        }
    }

    /// Moves as `held` says for so many seconds, at `speed` scene units a second. Two halves of a time lead to the same place as the whole,
    /// but for rounding, unless it turns as it walks.
    pub fn advance(&mut self, held: &Held, seconds: f64, speed: f64) {
        let pace = if held.is(Motion::Fast) { FAST } else { 1.0 };
        let turn = TURN * pace.sqrt() * self.zoom() * seconds;
        let heading = held.axis(Motion::TurnRight, Motion::TurnLeft) * turn;
        let pitch = held.axis(Motion::TurnDown, Motion::TurnUp) * turn;
        let (ahead, up) = self.level();
        let step = ahead * held.axis(Motion::Back, Motion::Forward)
            + ahead.cross(up) * held.axis(Motion::Left, Motion::Right)
            + up * held.axis(Motion::Down, Motion::Up);
        if step == DVec3::ZERO && heading == 0.0 && pitch == 0.0 {
            return;
        }
        self.position += step.normalize_or_zero() * (speed * pace * seconds);
        self.turn(heading, pitch);
    }

    /// Turns by a mouse's travel in pixels, rightwards and downwards.
    pub fn look(&mut self, [right, down]: [f64; 2]) {
        if right != 0.0 || down != 0.0 {
            let scale = MOUSE * self.zoom();
            self.turn(-right * scale, -down * scale);
        }
    }

    /// Narrows the field of view by so many steps, widens it by negative ones.
    pub fn zoom_by(&mut self, steps: f64) {
        let half = f64::from(self.camera.vertical_fov).to_radians() / 2.0;
        let half = (half.tan() * FIELD_STEP.powf(steps)).atan();
        self.camera.vertical_fov = ((2.0 * half).to_degrees() as f32).clamp(FIELD[0], FIELD[1]);
    }

    /// Turning is slower through a narrow field of view: 1 at 90°.
    fn zoom(&self) -> f64 {
        (f64::from(self.camera.vertical_fov).to_radians() / 2.0).tan().min(1.0)
    }

    fn turn(&mut self, heading: f64, pitch: f64) {
        self.heading += heading;
        // A scene may look steeper than anybody walks: it is left so until somebody looks up or down.
        if pitch != 0.0 {
            self.pitch = (self.pitch + pitch).clamp(-STEEPEST, STEEPEST);
        }
        let (ahead, up) = self.level();
        let sight = ahead * self.pitch.cos() + up * self.pitch.sin();
        self.camera.position = self.position.as_vec3();
        // Far enough away for floats to tell directions apart: 1e-7 of a radian.
        let own = f64::from(self.home.look_at.distance(self.home.position));
        let distance = own.max(self.position.abs().max_element());
        self.camera.look_at = (self.camera.position.as_dvec3() + sight * distance).as_vec3();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn the_mouse_turns_less_through_a_narrow_field_of_view() {
        let turned = |vertical_fov| {
            let mut walker = Walker::new(Camera { vertical_fov, ..home() });
            walker.look([100.0, 0.0]);
            walker.heading
        };
        assert!((turned(90.0) + 100.0 * MOUSE).abs() < 1e-9);
        let ratio = turned(10.0) / turned(20.0);
        assert!((ratio - 5f64.to_radians().tan() / 10f64.to_radians().tan()).abs() < 1e-6, "{ratio}");
    }

    fn home() -> Camera {
        Camera {
            position: Vec3::new(1.0, 2.0, 3.0),
            look_at: Vec3::new(1.0, 2.0, -7.0),
            up: Vec3::Y,
            vertical_fov: 40.0,
        }
    }
    fn held(motions: &[Motion]) -> Held {
        let mut held = Held::default();
        motions.iter().for_each(|&motion| held.set(motion, true));
        held
    }
    fn after(motions: &[Motion], seconds: f64) -> Camera {
        let mut walker = Walker::new(home());
        walker.advance(&held(motions), seconds, 2.0);
        *walker.camera()
    }

    #[test]
    fn every_motion_goes_its_way() {
        let moved = |motion| (after(&[motion], 0.5).position - home().position).to_array();
        assert_eq!(moved(Motion::Forward), [0.0, 0.0, -1.0]);
        assert_eq!(moved(Motion::Back), [0.0, 0.0, 1.0]);
        assert_eq!(moved(Motion::Right), [1.0, 0.0, 0.0]);
        assert_eq!(moved(Motion::Left), [-1.0, 0.0, 0.0]);
        assert_eq!(moved(Motion::Up), [0.0, 1.0, 0.0]);
        assert_eq!(moved(Motion::Down), [0.0, -1.0, 0.0]);
        let looks = |motion| after(&[motion], 0.1).look_at - home().look_at;
        assert!(looks(Motion::TurnRight).x > 0.1 && looks(Motion::TurnLeft).x < -0.1);
        assert!(looks(Motion::TurnUp).y > 0.1 && looks(Motion::TurnDown).y < -0.1);
        assert_eq!(after(&[Motion::Left, Motion::Right], 1.0), home(), "opposites hold each other");
        let fast = after(&[Motion::Forward, Motion::Fast], 0.5).position.z;
        assert_eq!(fast, home().position.z - 4.0);
        let diagonal = after(&[Motion::Forward, Motion::Right], 0.5).position.distance(home().position);
        assert!((diagonal - 1.0).abs() < 1e-6, "no faster in two directions at once: {diagonal}");
    }

    #[test]
    fn the_frame_rate_does_not_change_where_it_leads() {
        for motions in [&[Motion::Forward][..], &[Motion::Right, Motion::Up], &[Motion::TurnLeft]] {
            let (held, mut steps) = (held(motions), Walker::new(home()));
            for _ in 0..240 {
                steps.advance(&held, 1.0 / 240.0, 2.0);
            }
            let once = after(motions, 1.0);
            assert!(steps.camera().position.distance(once.position) < 1e-5, "{motions:?}");
            assert!(steps.camera().look_at.distance(once.look_at) < 1e-4, "{motions:?}");
        }
    }

    #[test]
    fn a_camera_that_nobody_moved_is_the_scenes_own() {
        let mut walker = Walker::new(home());
        walker.advance(&Held::default(), 1.0, 2.0);
        walker.advance(&held(&[Motion::Fast]), 1.0, 2.0);
        walker.look([0.0, 0.0]);
        assert_eq!(*walker.camera(), home());
        walker.advance(&held(&[Motion::Forward, Motion::TurnUp]), 1.0, 2.0);
        assert_ne!(*walker.camera(), home());
        walker.go_home();
        assert_eq!(*walker.camera(), home());
    }

    #[test]
    fn up_is_the_scenes_up_wherever_that_is() {
        for up in [Vec3::NEG_Y, Vec3::Z, Vec3::new(0.3, 1.0, -0.2)] {
            let sight = up.any_orthonormal_vector();
            let home = Camera { position: Vec3::ZERO, look_at: sight, up, vertical_fov: 60.0 };
            let mut walker = Walker::new(home);
            walker.advance(&held(&[Motion::Up]), 1.0, 1.0);
            assert!(walker.camera().position.distance(up.normalize()) < 1e-6);
            walker.advance(&held(&[Motion::Right]), 1.0, 1.0);
            let right = sight.cross(up).normalize();
            assert!(walker.camera().position.distance(up.normalize() + right) < 1e-6);
        }
    }

    #[test]
    fn looking_stops_before_the_poles_and_forward_stays_level() {
        let mut walker = Walker::new(home());
        walker.advance(&held(&[Motion::TurnUp]), 100.0, 1.0);
        let sight = (walker.camera().look_at - walker.camera().position).normalize();
        assert!((sight.y - 1.0).abs() < 1e-3 && sight.y < 1.0);
        walker.advance(&held(&[Motion::Forward]), 1.0, 1.0);
        assert!((walker.camera().position.y - home().position.y).abs() < 1e-6);
    }

    #[test]
    fn field_of_view_stays_within_bounds() {
        let mut walker = Walker::new(home());
        walker.zoom_by(1.0);
        let half = |fov: f32| (f64::from(fov).to_radians() / 2.0).tan();
        assert!((half(walker.camera().vertical_fov) / half(40.0) - FIELD_STEP).abs() < 1e-6);
        walker.zoom_by(-1_000.0);
        assert_eq!(walker.camera().vertical_fov, FIELD[1]);
        walker.zoom_by(1_000.0);
        assert_eq!(walker.camera().vertical_fov, FIELD[0]);
    }
}
