//! The camera of a scene, and its validation.

use crate::math::portable;
use crate::rays::coordinates::MAX_COORDINATE;
use glam::Vec3;

/// The smallest radius, and distance from camera to target: its square, 1e-36, is still a normal f32.
pub const MIN_LENGTH: f64 = 1e-18;
/// The sine of the smallest angle between the camera's line of sight and its `up`: well above f32 rounding
/// (6e-8).
const MIN_UP_SINE: f64 = 1e-5;

/// The vertical field of view in degrees of cameras that name none, and of orthographic ones, which have no
/// use for it.
pub const VERTICAL_FOV: f32 = 40.0;

/// A camera: a pinhole, a thin lens, or orthographic.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Camera {
    /// The position of the eye.
    pub position: Vec3,
    /// The target, which differs from `position`.
    pub look_at: Vec3,
    /// The direction that points up in the image, not parallel to the line of sight.
    pub up: Vec3,
    /// The angle in degrees from the lower to the upper edge of the image; above 0 and below 180.
    pub vertical_fov: f32,
    /// The points from which rays start.
    pub projection: Projection,
}

/// The points from which a camera's rays start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays start on a lens around the camera's position.
    Perspective(Lens),
    /// Rays are parallel and start on the plane through the camera's position; `vertical_fov` is unused.
    Orthographic {
        /// The length in scene units from the lower to the upper edge of the picture, above 0.
        height: f32,
    },
}

impl Default for Projection {
    fn default() -> Self {
        Self::Perspective(Lens::default())
    }
}

/// A thin lens: all rays through a point of the picture meet at one point of the focal plane, which is
/// perpendicular to the line of sight. The default is a pinhole.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Lens {
    /// The radius of the aperture in scene units; 0 for a pinhole.
    pub radius: f32,
    /// The distance of the focal plane along the line of sight, above 0; that of `look_at` if missing.
    pub focus: Option<f32>,
    /// The number of blades, whose corners are on the aperture's circle, one of them at the top; 0 for a
    /// round aperture.
    pub blades: u32,
}

/// The numbers of blades of an aperture that is not round.
const BLADES: std::ops::RangeInclusive<u32> = 3..=16;
/// Half the height in metres of the sensor for which apertures are f-numbers: that of 35 mm film.
const HALF_SENSOR: f64 = 0.012;

/// An error in a camera: its key in the scene file, the problem, and its remedy.
pub type CameraFault = (&'static str, String, &'static str);

impl Camera {
    /// Returns a pinhole camera.
    pub fn pinhole(position: Vec3, look_at: Vec3, up: Vec3, vertical_fov: f32) -> Self {
        Self { position, look_at, up, vertical_fov, projection: Projection::default() }
    }
    /// Returns the first error, if any.
    pub fn fault(&self) -> Option<CameraFault> {
        let Self { position, look_at, up, vertical_fov, projection } = *self;
        if !(vertical_fov > 0.0 && vertical_fov < 180.0) {
            let what = format!("a vertical field of view of {vertical_fov}° is impossible");
            return Some(("vertical_fov", what, "write degrees above 0 and below 180; 40 is a good start"));
        }
        let sight = look_at.as_dvec3() - position.as_dvec3();
        if sight.length() < MIN_LENGTH {
            let what = "the camera looks at its own position".to_string();
            return Some((
                "look_at",
                what,
                "move `look_at` (or `position`) so that the two differ in single precision",
            ));
        }
        let up = up.as_dvec3();
        if sight.normalize().cross(up.normalize_or_zero()).length() < MIN_UP_SINE {
            let what = "`up` is parallel to the line of sight (or zero)".to_string();
            return Some((
                "up",
                what,
                "give an `up` that points to the upper edge of the picture, such as [0, 0, -1]",
            ));
        }
        match projection {
            Projection::Perspective(lens) => lens.fault(),
            Projection::Orthographic { height }
                if is_length(height) && f64::from(height) <= MAX_COORDINATE =>
            {
                None
            }
            Projection::Orthographic { height } => {
                let what = format!("a picture cannot show {height} scene units from edge to edge");
                Some(("orthographic_height", what, "write a length above 0, such as 4"))
            }
        }
    }
    /// Returns the lens; a pinhole for an orthographic camera.
    pub fn lens(&self) -> Lens {
        match self.projection {
            Projection::Perspective(lens) => lens,
            Projection::Orthographic { .. } => Lens::default(),
        }
    }
    /// Returns the distance of the focal plane along the line of sight.
    pub fn focus(&self) -> f64 {
        let sight = || (self.look_at.as_dvec3() - self.position.as_dvec3()).length();
        self.lens().focus.map_or_else(sight, f64::from)
    }
    /// Returns half the picture's height: in scene units for an orthographic camera, else at distance 1.
    pub fn half_height(&self) -> f64 {
        match self.projection {
            Projection::Perspective(_) => portable::tan(f64::from(self.vertical_fov).to_radians() / 2.0),
            Projection::Orthographic { height } => f64::from(height) / 2.0,
        }
    }
    /// Converts between f-numbers and radii of the aperture in metres, in both directions: the focal length
    /// over twice the one is the other. The focal length is that with which a sensor of 24 mm height has the
    /// camera's field of view.
    pub fn f_number_or_radius(&self, radius: f64) -> f64 {
        HALF_SENSOR / self.half_height() / (2.0 * radius)
    }
}

impl Lens {
    fn fault(&self) -> Option<CameraFault> {
        let Self { radius, focus, blades } = *self;
        if !(0.0..=MAX_COORDINATE).contains(&f64::from(radius)) {
            let what = format!("an aperture cannot have a radius of {radius}");
            return Some(("aperture_radius", what, "write a length of 0 or more; 0 is a pinhole"));
        }
        if let Some(focus) = focus.filter(|&focus| !is_length(focus)) {
            let what = format!("nothing can be in focus at a distance of {focus}");
            return Some(("focus_distance", what, "write a length above 0; 1e6 is as good as infinite"));
        }
        if blades != 0 && !BLADES.contains(&blades) {
            let what = format!("an aperture cannot have {blades} blades");
            return Some(("blades", what, "write a number from 3 to 16, or 0 for a round aperture"));
        }
        None
    }
}

fn is_length(x: f32) -> bool {
    x.is_finite() && f64::from(x) >= MIN_LENGTH
}
