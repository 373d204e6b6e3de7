//! Moves, turns, zooms and focuses the camera by keys and mouse.

use glam::{DQuat, DVec3};
use octray_formats::scene::{Camera, Coordinates, Lens, Projection, Scene, VERTICAL_FOV};
use std::collections::BTreeSet;

/// Turning speed of a held arrow key, in radians per second.
const TURN_SPEED: f64 = 1.2;
/// Radians per pixel of mouse travel at a field of view of 90°; less at narrower ones.
const MOUSE_SENSITIVITY: f64 = 0.0025;
/// Speed factor of [`Motion::Fast`].
const FAST_FACTOR: f64 = 4.0;
/// Largest pitch in radians: short of the pole, where yaw is undefined.
const MAX_PITCH: f64 = 89.0 * std::f64::consts::PI / 180.0;
/// Bounds of the field of view in degrees.
const FOV_RANGE: [f32; 2] = [1.0, 150.0];
/// Factor of the image plane's width per step of zooming.
const FOV_STEP: f64 = 0.9;

/// Bounds of an open aperture's radius, relative to half the height of the focal plane: with the least one,
/// the picture of a point at infinity is 1/128 of the picture high.
const APERTURE_RANGE: [f64; 2] = [1.0 / 128.0, 1.0];
/// Factor of the radius per stop, so that twice as much light passes.
const STOP: f64 = std::f64::consts::SQRT_2;

/// A motion that lasts while a key is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Motion {
    Forward,
    Back,
    Left,
    Right,
    Up,
    Down,
    TurnLeft,
    TurnRight,
    TurnUp,
    TurnDown,
    /// Makes walking four times and turning twice as fast.
    Fast,
}

/// A camera that keys and mouse move. Until it is moved, it has the bits of the scene's camera.
#[derive(Clone, Debug)]
pub struct CameraController {
    /// The scene's camera.
    home: Camera,
    coordinates: Coordinates,
    camera: Camera,
    position: DVec3,
    /// The up direction, of unit length.
    up: DVec3,
    /// Horizontal direction at yaw 0, of unit length.
    forward: DVec3,
    /// Radians around `up`, positive to the left.
    yaw: f64,
    /// Radians above the horizontal.
    pitch: f64,
    /// The lens of an orthographic camera when it becomes perspective again.
    lens: Lens,
}

impl CameraController {
    pub fn new(scene: &Scene) -> Self {
        Self::from_camera(scene.camera, scene.coordinates)
    }
    fn from_camera(home: Camera, coordinates: Coordinates) -> Self {
        let position = home.position.as_dvec3();
        let up = home.up.as_dvec3().normalize();
        let sight = (home.look_at.as_dvec3() - position).normalize();
        let level = sight - up * sight.dot(up);
        let forward = level.try_normalize().unwrap_or_else(|| up.any_orthonormal_vector());
        let pitch = sight.dot(up).clamp(-1.0, 1.0).asin();
        let lens = home.lens();
        Self { home, coordinates, camera: home, position, up, forward, yaw: 0.0, pitch, lens }
    }
    pub fn camera(&self) -> &Camera {
        &self.camera
    }
    /// Returns the horizontal forward direction, and up.
    pub fn forward_and_up(&self) -> (DVec3, DVec3) {
        (DQuat::from_axis_angle(self.up, self.yaw) * self.forward, self.up)
    }
    /// Resets to the scene's camera.
    pub fn reset(&mut self) {
        *self = Self::from_camera(self.home, self.coordinates);
    }
    /// Replaces the scene's camera after a reload. A camera that was not moved takes its place; a moved one
    /// keeps its position in the coordinates of the file.
    pub fn set_home(&mut self, scene: &Scene) {
        if self.camera == self.home {
            *self = Self::new(scene);
            return;
        }
        let before = std::mem::replace(&mut self.coordinates, scene.coordinates);
        self.home = scene.camera;
        if before != self.coordinates {
            self.position = self.coordinates.to_scene(before.to_file(self.position));
            self.turn(0.0, 0.0);
        }
    }

    /// Applies the held motions for `seconds`, at `speed` scene units per second. Unless the camera turns
    /// while it walks, two half steps lead to the same place as one whole step, up to rounding.
    pub fn advance(&mut self, held: &BTreeSet<Motion>, seconds: f64, speed: f64) {
        let pace = if held.contains(&Motion::Fast) { FAST_FACTOR } else { 1.0 };
        let axis = |back, forth| f64::from(held.contains(&forth)) - f64::from(held.contains(&back));
        let turn = TURN_SPEED * pace.sqrt() * self.turn_scale() * seconds;
        let yaw = axis(Motion::TurnRight, Motion::TurnLeft) * turn;
        let pitch = axis(Motion::TurnDown, Motion::TurnUp) * turn;
        let (forward, up) = self.forward_and_up();
        let step = forward * axis(Motion::Back, Motion::Forward)
            + forward.cross(up) * axis(Motion::Left, Motion::Right)
            + up * axis(Motion::Down, Motion::Up);
        if step == DVec3::ZERO && yaw == 0.0 && pitch == 0.0 {
            return;
        }
        self.position += step.normalize_or_zero() * (speed * pace * seconds);
        self.turn(yaw, pitch);
    }

    /// Turns by mouse travel in pixels, right and down.
    pub fn mouse_look(&mut self, [right, down]: [f64; 2]) {
        if right != 0.0 || down != 0.0 {
            let scale = MOUSE_SENSITIVITY * self.turn_scale();
            self.turn(-right * scale, -down * scale);
        }
    }

    /// Narrows the picture by `steps`; negative steps widen it.
    pub fn zoom_by(&mut self, steps: f64) {
        if let Projection::Orthographic { height } = &mut self.camera.projection {
            *height = (f64::from(*height) * FOV_STEP.powf(steps)).clamp(1e-12, 1e12) as f32;
            return;
        }
        let half = f64::from(self.camera.vertical_fov).to_radians() / 2.0;
        let half = (half.tan() * FOV_STEP.powf(steps)).atan();
        self.camera.vertical_fov = ((2.0 * half).to_degrees() as f32).clamp(FOV_RANGE[0], FOV_RANGE[1]);
    }

    /// Opens the aperture by `stops`; negative ones close it, in the end to a pinhole.
    pub fn open_by(&mut self, stops: f64) {
        let focus = self.camera.focus();
        let most = focus * self.camera.half_height();
        if let Projection::Perspective(lens) = &mut self.camera.projection {
            let [least, most] = APERTURE_RANGE.map(|share| share * most);
            let radius = f64::from(lens.radius);
            let opened = if radius == 0.0 { least } else { (radius * STOP.powf(stops)).min(most) };
            let closes = stops < 0.0 && (radius == 0.0 || opened < 0.99 * least);
            lens.radius = if closes { 0.0 } else { opened as f32 };
            // So that a view of a scene with a lens names the closed aperture.
            lens.focus.get_or_insert(focus as f32);
        }
    }

    /// Focuses a perspective camera on a distance.
    pub fn focus_at(&mut self, distance: f32) {
        if let Projection::Perspective(lens) = &mut self.camera.projection {
            lens.focus = Some(distance);
        }
    }

    /// Switches between perspective and orthographic; the picture of the focal plane has the same size.
    pub fn switch_projection(&mut self) {
        match self.camera.projection {
            Projection::Perspective(lens) => {
                let (focus, half_height) = (self.camera.focus(), self.camera.half_height());
                self.lens = Lens { focus: Some(focus as f32), ..lens };
                let height = (2.0 * focus * half_height) as f32;
                self.camera.projection = Projection::Orthographic { height };
                self.camera.vertical_fov = VERTICAL_FOV;
            }
            Projection::Orthographic { height } => {
                self.camera.projection = Projection::Perspective(self.lens);
                let half = (f64::from(height) / 2.0 / self.camera.focus()).atan();
                self.camera.vertical_fov =
                    ((2.0 * half).to_degrees() as f32).clamp(FOV_RANGE[0], FOV_RANGE[1]);
            }
        }
    }

    /// Returns the factor of the turning speed: 1 at a field of view of 90° and above, less at narrower ones.
    fn turn_scale(&self) -> f64 {
        (f64::from(self.camera.vertical_fov).to_radians() / 2.0).tan().min(1.0)
    }

    fn turn(&mut self, yaw: f64, pitch: f64) {
        self.yaw += yaw;
        // The pitch of the scene's camera may exceed the bound and stays until the pitch is changed.
        if pitch != 0.0 {
            self.pitch = (self.pitch + pitch).clamp(-MAX_PITCH, MAX_PITCH);
        }
        let (forward, up) = self.forward_and_up();
        let sight = forward * self.pitch.cos() + up * self.pitch.sin();
        // The focal plane stays where it is when `look_at` moves along the line of sight.
        let focus = self.camera.focus() as f32;
        if let Projection::Perspective(lens) = &mut self.camera.projection
            && lens.radius > 0.0
        {
            lens.focus.get_or_insert(focus);
        }
        self.camera.position = self.position.as_vec3();
        // At this distance, single precision resolves the direction to 1e-7 rad.
        let own = f64::from(self.home.look_at.distance(self.home.position));
        let distance = own.max(self.position.abs().max_element());
        self.camera.look_at = (self.camera.position.as_dvec3() + sight * distance).as_vec3();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn controller(camera: Camera) -> CameraController {
        CameraController::new(&Scene { camera, ..Scene::default() })
    }

    fn home() -> Camera {
        let [position, look_at] = [3.0, -7.0].map(|z| Vec3::new(1.0, 2.0, z));
        Camera::pinhole(position, look_at, Vec3::Y, 40.0)
    }
    fn held(motions: &[Motion]) -> BTreeSet<Motion> {
        motions.iter().copied().collect()
    }
    fn after(motions: &[Motion], seconds: f64) -> Camera {
        let mut controller = controller(home());
        controller.advance(&held(motions), seconds, 2.0);
        *controller.camera()
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
        assert_eq!(after(&[Motion::Left, Motion::Right], 1.0), home(), "opposites cancel");
        let fast = after(&[Motion::Forward, Motion::Fast], 0.5).position.z;
        assert_eq!(fast, home().position.z - 4.0);
        let diagonal = after(&[Motion::Forward, Motion::Right], 0.5).position.distance(home().position);
        assert!((diagonal - 1.0).abs() < 1e-6, "diagonal motion is no faster: {diagonal}");
    }

    #[test]
    fn the_frame_rate_does_not_change_where_it_leads() {
        for motions in [&[Motion::Forward][..], &[Motion::Right, Motion::Up], &[Motion::TurnLeft]] {
            let (held, mut steps) = (held(motions), controller(home()));
            for _ in 0..240 {
                steps.advance(&held, 1.0 / 240.0, 2.0);
            }
            let once = after(motions, 1.0);
            assert!(steps.camera().position.distance(once.position) < 1e-5, "{motions:?}");
            assert!(steps.camera().look_at.distance(once.look_at) < 1e-4, "{motions:?}");
        }
    }

    #[test]
    fn a_camera_that_was_not_moved_is_the_scenes_own() {
        let mut controller = controller(home());
        controller.advance(&held(&[]), 1.0, 2.0);
        controller.advance(&held(&[Motion::Fast]), 1.0, 2.0);
        controller.mouse_look([0.0, 0.0]);
        assert_eq!(*controller.camera(), home());
        controller.advance(&held(&[Motion::Forward, Motion::TurnUp]), 1.0, 2.0);
        assert_ne!(*controller.camera(), home());
        controller.reset();
        assert_eq!(*controller.camera(), home());
    }

    #[test]
    fn a_moved_camera_stays_where_it_is_in_the_file() {
        let mut controller = controller(home());
        controller.advance(&held(&[Motion::Forward, Motion::TurnUp]), 1.0, 2.0);
        let before = *controller.camera();
        let coordinates = Coordinates::around(glam::dvec3(10.0, 20.0, -5.0), 1.0);
        controller.set_home(&Scene { camera: home(), coordinates, ..Scene::default() });
        let after = *controller.camera();
        assert_eq!(after.position + Vec3::new(10.0, 20.0, -5.0), before.position);
        let sights = [before, after].map(|camera| (camera.look_at - camera.position).normalize());
        assert!(sights[0].distance(sights[1]) < 1e-6, "{sights:?}");
    }

    #[test]
    fn up_is_the_scenes_up_wherever_that_is() {
        for up in [Vec3::NEG_Y, Vec3::Z, Vec3::new(0.3, 1.0, -0.2)] {
            let sight = up.any_orthonormal_vector();
            let home = Camera::pinhole(Vec3::ZERO, sight, up, 60.0);
            let mut controller = controller(home);
            controller.advance(&held(&[Motion::Up]), 1.0, 1.0);
            assert!(controller.camera().position.distance(up.normalize()) < 1e-6);
            controller.advance(&held(&[Motion::Right]), 1.0, 1.0);
            let right = sight.cross(up).normalize();
            assert!(controller.camera().position.distance(up.normalize() + right) < 1e-6);
        }
    }

    #[test]
    fn looking_stops_before_the_poles_and_forward_stays_level() {
        let mut controller = controller(home());
        controller.advance(&held(&[Motion::TurnUp]), 100.0, 1.0);
        let sight = (controller.camera().look_at - controller.camera().position).normalize();
        assert!((sight.y - 1.0).abs() < 1e-3 && sight.y < 1.0);
        controller.advance(&held(&[Motion::Forward]), 1.0, 1.0);
        assert!((controller.camera().position.y - home().position.y).abs() < 1e-6);
    }

    #[test]
    fn aperture_opens_and_closes_by_stops_and_projections_show_the_focal_plane_alike() {
        let mut controller = controller(home());
        controller.focus_at(4.0);
        controller.open_by(-1.0);
        assert_eq!(controller.camera().lens().radius, 0.0);
        let radii = [1.0, 1.0, -1.0, -1.0].map(|stops| {
            controller.open_by(stops);
            controller.camera().lens().radius
        });
        assert!(radii[0] > 0.0 && (radii[1] / radii[0]).powi(2) - 2.0 < 1e-6 && radii[3] == 0.0, "{radii:?}");
        assert!((radii[2] / radii[0] - 1.0).abs() < 1e-6, "{radii:?}");
        controller.open_by(1.0);
        let before = *controller.camera();
        controller.switch_projection();
        let Projection::Orthographic { height } = controller.camera().projection else { panic!() };
        assert!((f64::from(height) - 8.0 * before.half_height()).abs() < 1e-6, "{height}");
        controller.zoom_by(1.0);
        controller.advance(&held(&[Motion::TurnLeft]), 0.1, 1.0);
        controller.switch_projection();
        assert_eq!(controller.camera().lens(), before.lens());
        assert!((controller.camera().half_height() / before.half_height() - FOV_STEP).abs() < 1e-6);
    }

    #[test]
    fn field_of_view_stays_within_bounds() {
        let mut controller = controller(home());
        for (steps, bound) in [(-1_000.0, FOV_RANGE[1]), (1_000.0, FOV_RANGE[0])] {
            controller.zoom_by(steps);
            assert_eq!(controller.camera().vertical_fov, bound);
        }
    }
}
