//! Writes numbers, points, vectors, cameras and relative paths. Numbers read back as the same bits.

use super::camera_path::Keyframe;
use glam::{DVec3, Vec3};
use octray_engine::scene::{Camera, Coordinates, Lens, Projection};
use std::path::Path;

/// Returns the file's point, with the fewest digits, that reads back as this point of a scene.
pub fn point_in_file(point: Vec3, coordinates: &Coordinates) -> DVec3 {
    let exact = coordinates.to_file(point.into()).to_array();
    DVec3::from_array(std::array::from_fn(|axis| {
        let rounded = |digits: usize| format!("{:.digits$e}", exact[axis]).parse().unwrap_or(exact[axis]);
        let reads_back = |x: &f64| {
            let placed = coordinates.to_scene(DVec3::splat(*x))[axis] as f32;
            placed.to_bits() == point[axis].to_bits()
        };
        if reads_back(&0.0) {
            return 0.0;
        }
        // With more digits, a number is as near or nearer.
        let all: [usize; 17] = std::array::from_fn(|digits| digits);
        let fewest = all.partition_point(|&digits| !reads_back(&rounded(digits)));
        Some(rounded(fewest)).filter(reads_back).unwrap_or(exact[axis])
    }))
}

pub fn camera(camera: &Camera, coordinates: &Coordinates) -> String {
    let length = |x: f32| match f64::from(x) * coordinates.unit {
        length if coordinates.unit == 1.0 => number(length as f32),
        length => json_digits(length.abs() >= 1e16, &length),
    };
    let projection = match camera.projection {
        Projection::Orthographic { height } => format!("\"orthographic_height\": {}", length(height)),
        Projection::Perspective(lens) => {
            let mut keys = format!("\"vertical_fov\": {}", number(camera.vertical_fov));
            if lens != Lens::default() {
                keys += &format!(", \"aperture_radius\": {}", length(lens.radius));
                keys += &lens.focus.map_or(String::new(), |x| format!(", \"focus_distance\": {}", length(x)));
                keys += &format!(", \"blades\": {}", lens.blades);
            }
            keys
        }
    };
    format!(
        "{{ \"position\": {}, \"look_at\": {}, \"up\": {}, {projection} }}",
        placed(camera.position, coordinates),
        placed(camera.look_at, coordinates),
        vector(camera.up),
    )
}

/// Writes keyframes one a line, for an object that is indented by two spaces.
pub fn keyframes(keyframes: &[Keyframe], coordinates: &Coordinates) -> String {
    let line = |key: &Keyframe| {
        format!("    {{ \"frame\": {}, \"camera\": {} }}", key.frame, camera(&key.camera, coordinates))
    };
    format!("[\n{}\n  ]", keyframes.iter().map(line).collect::<Vec<_>>().join(",\n"))
}

/// Writes a point of a scene in the coordinates of the file.
pub fn placed(p: Vec3, coordinates: &Coordinates) -> String {
    let [x, y, z] = point_in_file(p, coordinates).to_array().map(|x| json_digits(x.abs() >= 1e16, &x));
    format!("[{x}, {y}, {z}]")
}

/// Writes a vector.
pub fn vector<const N: usize>(v: impl Into<[f32; N]>) -> String {
    format!("[{}]", v.into().map(number).join(", "))
}

/// Writes the shortest decimal that reads back as the same bits. Numbers are read as f64, so that the
/// shortest decimal of an f32 could round twice; in that case the digits of the f64 are written.
pub fn number(x: f32) -> String {
    let short = json_digits(f64::from(x).abs() >= 1e16, &x);
    let read_back = short.parse::<f64>().map(|read| read as f32);
    if read_back.is_ok_and(|read| read.to_bits() == x.to_bits()) {
        short
    } else {
        json_digits(false, &f64::from(x))
    }
}

/// Writes a number, in the form of `{:e}` if it is huge. JSON has both forms.
fn json_digits<T: std::fmt::Display + std::fmt::LowerExp>(huge: bool, x: &T) -> String {
    if huge { format!("{x:e}") } else { format!("{x}") }
}

/// Returns the path, relative to `folder`, of the file at `file` relative to another folder, `beside`.
pub fn relative(beside: &Path, file: &str, folder: &Path) -> String {
    // Joined with a dot, an empty path becomes the working directory.
    let folders = [beside, folder].map(|folder| folder.join("."));
    // Only canonical paths can be compared, as `a/../b` is `b` unless `a` is a link. A folder that does not
    // exist has no canonical path.
    let real = folders.each_ref().map(|folder| folder.canonicalize());
    let [beside, folder] = match real {
        [Ok(beside), Ok(folder)] => [beside, folder],
        _ => folders.map(|folder| std::path::absolute(&folder).unwrap_or(folder)),
    };
    let target = beside.join(file);
    let shared = target.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return target.to_string_lossy().into_owned();
    }
    let up = folder.components().skip(shared).map(|_| "..".to_string());
    let down = target.components().skip(shared).map(|part| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}
