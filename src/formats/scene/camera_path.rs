//! Interpolates cameras between keyframes.
//!
//! Position, target, up, field of view, aperture, focus and orthographic height follow a Catmull-Rom spline
//! each: a cubic Hermite spline through the keyframes whose slope at a keyframe is the slope between its two
//! neighbours, or, at an end, towards its only neighbour. The speed does not jump at keyframes. Keyframes on
//! a line and evenly apart give a straight line at even speed. Elsewhere the curve may swing beyond its
//! keyframes, by at most 4/27 of the slopes times the frames between them. Source: Catmull, Rom, "A class of
//! local interpolating splines", 1974, for keyframes that need not be evenly apart in time.

use glam::DVec3;
use octray_engine::scene::{Camera, Lens, Projection};

/// A camera at a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// The frame's number.
    pub frame: u32,
    /// The camera at that frame.
    pub camera: Camera,
}

/// A path of a camera: keyframes in ascending order of their frames, or none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraPath(Vec<Keyframe>);

impl CameraPath {
    /// Makes a path of keyframes.
    ///
    /// # Panics
    /// If their frames do not ascend.
    pub fn new(keyframes: Vec<Keyframe>) -> Self {
        assert!(keyframes.is_sorted_by(|a, b| a.frame < b.frame), "keyframes ascend");
        Self(keyframes)
    }

    /// Returns the keyframes in ascending order of their frames.
    pub fn keyframes(&self) -> &[Keyframe] {
        &self.0
    }

    /// Returns the first and the last frame, if there are keyframes.
    pub fn frames(&self) -> Option<[u32; 2]> {
        Some([self.0.first()?.frame, self.0.last()?.frame])
    }

    /// Returns the camera of a frame; at a keyframe, exactly the keyframe's. Returns `None` outside
    /// [`CameraPath::frames`]. The spline can pass through an impossible camera: see [`Camera::fault`].
    pub fn camera_at(&self, frame: u32) -> Option<Camera> {
        let next = self.0.partition_point(|key| key.frame < frame);
        let key = self.0.get(next)?;
        if key.frame == frame {
            return Some(key.camera);
        }
        let before = next.checked_sub(1)?;
        let first = before.saturating_sub(1);
        // Two keyframes on each side. A missing outer one repeats the inner one, whose slope is then
        // one-sided.
        let keys = [first, before, next, (next + 1).min(self.0.len() - 1)].map(|index| &self.0[index]);
        let times = keys.map(|key| f64::from(key.frame));
        let spline = |value: fn(&Camera) -> DVec3| {
            hermite(times, keys.map(|key| value(&key.camera)), f64::from(frame)).as_vec3()
        };
        let number = |value: fn(&Camera) -> f64| {
            hermite(times, keys.map(|key| DVec3::splat(value(&key.camera))), f64::from(frame)).x as f32
        };
        let projection = match keys[1].camera.projection {
            Projection::Orthographic { .. } => {
                Projection::Orthographic { height: number(|camera| 2.0 * camera.half_height()) }
            }
            Projection::Perspective(Lens { blades, .. }) => Projection::Perspective(Lens {
                // The spline may swing below 0.
                radius: number(|camera| camera.lens().radius.into()).max(0.0),
                // On `look_at` all the time, or at distances.
                focus: keys
                    .iter()
                    .any(|key| key.camera.lens().focus.is_some())
                    .then(|| number(Camera::focus)),
                blades,
            }),
        };
        Some(Camera {
            position: spline(|camera| camera.position.as_dvec3()),
            look_at: spline(|camera| camera.look_at.as_dvec3()),
            up: spline(|camera| camera.up.as_dvec3()),
            vertical_fov: number(|camera| camera.vertical_fov.into()),
            projection,
        })
    }
}

/// Evaluates the spline between the second and the third point, at a time between theirs.
fn hermite(times: [f64; 4], points: [DVec3; 4], time: f64) -> DVec3 {
    let [t0, t1, t2, t3] = times;
    let [p0, p1, p2, p3] = points;
    let span = t2 - t1;
    let t = (time - t1) / span;
    // Slopes per frame.
    let (m1, m2) = ((p2 - p0) / (t2 - t0), (p3 - p1) / (t3 - t1));
    let (square, cube) = (t * t, t * t * t);
    p1 * (2.0 * cube - 3.0 * square + 1.0)
        + m1 * span * (cube - 2.0 * square + t)
        + p2 * (3.0 * square - 2.0 * cube)
        + m2 * span * (cube - square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn camera(x: f32) -> Camera {
        Camera::pinhole(Vec3::new(x, 0.0, 5.0), Vec3::ZERO, Vec3::Y, 40.0 + x)
    }

    fn path(keys: &[(u32, f32)]) -> CameraPath {
        CameraPath::new(keys.iter().map(|&(frame, x)| Keyframe { frame, camera: camera(x) }).collect())
    }

    #[test]
    fn path_passes_its_keyframes_and_ends_with_them() {
        let path = path(&[(3, 0.1), (5, 7.3), (20, -2.7)]);
        for key in path.keyframes() {
            assert_eq!(path.camera_at(key.frame), Some(key.camera));
        }
        assert_eq!((path.camera_at(2), path.camera_at(21), path.frames()), (None, None, Some([3, 20])));
        assert_eq!(CameraPath::default().camera_at(0), None);
    }

    #[test]
    fn path_is_straight_and_even_where_its_keyframes_are() {
        let path = path(&[(0, 0.0), (10, 5.0), (30, 15.0), (32, 16.0)]);
        for frame in 0..=32 {
            let found = path.camera_at(frame).unwrap();
            let expected = camera(frame as f32 / 2.0);
            assert!((found.position - expected.position).length() < 1e-5, "{frame}: {found:?}");
            assert!((found.vertical_fov - expected.vertical_fov).abs() < 1e-5, "{frame}: {found:?}");
            assert_eq!((found.look_at, found.up), (expected.look_at, expected.up));
        }
    }

    #[test]
    fn lens_and_orthographic_height_are_interpolated_too() {
        let camera_at = |projections: [Projection; 2]| {
            let key = |(frame, projection)| Keyframe { frame, camera: Camera { projection, ..camera(0.0) } };
            CameraPath::new([0, 10].into_iter().zip(projections).map(key).collect()).camera_at(5).unwrap()
        };
        let lens = |radius, focus| Projection::Perspective(Lens { radius, focus, blades: 5 });
        let middle = |keys| camera_at(keys).projection;
        assert_eq!(middle([lens(0.1, Some(2.0)), lens(0.3, Some(6.0))]), lens(0.2, Some(4.0)));
        assert_eq!(middle([lens(0.1, None), lens(0.3, None)]), lens(0.2, None), "on `look_at` all the time");
        assert_eq!(middle([lens(0.1, None), lens(0.3, Some(7.0))]), lens(0.2, Some(6.0)), "5 to `look_at`");
        let height = |height| Projection::Orthographic { height };
        assert_eq!(middle([height(1.0), height(2.0)]), height(1.5));
    }

    #[test]
    fn path_keeps_its_speed_at_a_keyframe() {
        // In steps of a thousandth of the way, the speed before and after the keyframe is the same.
        let path = path(&[(0, 0.0), (1000, 3.0), (3000, -1.0), (4000, 8.0)]);
        let x = |frame| f64::from(path.camera_at(frame).unwrap().position.x);
        for key in [1000, 3000] {
            let [before, after] = [x(key) - x(key - 1), x(key + 1) - x(key)];
            assert!((before - after).abs() < 2e-5, "{key}: {before} and {after}");
        }
    }
}
