//! Reports the camera of a scene.

use super::numbers::figure;
use crate::scene::{Projection, Scene, point_in_file};
use glam::Vec3;
use serde::Serialize;
use std::fmt::Display;

/// The camera, its points in the coordinates of the file.
#[derive(Debug, Serialize)]
pub struct CameraReport {
    position: [f64; 3],
    look_at: [f64; 3],
    up: [f32; 3],
    /// Missing for an orthographic camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    vertical_fov: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    orthographic_height: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lens: Option<LensReport>,
}

/// A lens whose aperture is open, its lengths in units of the file.
#[derive(Debug, Serialize)]
struct LensReport {
    aperture_radius: f64,
    f_number: f64,
    focus_distance: f64,
    blades: u32,
}

impl CameraReport {
    pub fn of(scene: &Scene) -> Self {
        let (camera, unit) = (&scene.camera, scene.coordinates.unit);
        let in_file = |point: Vec3| point_in_file(point, &scene.coordinates).to_array();
        let (position, look_at, up) = (in_file(camera.position), in_file(camera.look_at), camera.up.into());
        let mut report =
            Self { position, look_at, up, vertical_fov: None, orthographic_height: None, lens: None };
        match camera.projection {
            Projection::Orthographic { height } => {
                report.orthographic_height = Some(f64::from(height) * unit)
            }
            Projection::Perspective(lens) => {
                report.vertical_fov = Some(camera.vertical_fov);
                let aperture_radius = f64::from(lens.radius) * unit;
                report.lens = (lens.radius > 0.0).then(|| LensReport {
                    aperture_radius,
                    f_number: camera.f_number_or_radius(aperture_radius),
                    focus_distance: camera.focus() * unit,
                    blades: lens.blades,
                });
            }
        }
        report
    }

    pub fn text(&self) -> String {
        let [position, look_at] = [self.position, self.look_at].map(vector);
        let mut text = format!("at {position} towards {look_at}");
        let mut add = |what: String| text += &format!(", {what}");
        if let Some(degrees) = self.vertical_fov {
            add(format!("vertical field of view {degrees}°"));
        }
        if let Some(height) = self.orthographic_height {
            add(format!("orthographic, {} high", height as f32));
        }
        if let Some(LensReport { aperture_radius, f_number, focus_distance, blades }) = &self.lens {
            let blades = if *blades > 0 { format!(", {blades} blades") } else { String::new() };
            let (radius, focus) = (*aperture_radius as f32, *focus_distance as f32);
            add(format!("lens f/{} (radius {radius}{blades}), focus {focus}", figure(*f_number, 1)));
        }
        text
    }
}

/// Formats a point.
pub fn vector<T: Display>([x, y, z]: [T; 3]) -> String {
    format!("({x}, {y}, {z})")
}
