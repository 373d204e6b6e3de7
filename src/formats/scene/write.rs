//! Writes numbers, vectors, cameras and relative paths for the native formats. A number reads back as the
//! same bits.
//!
//! For: [`number`], [`vec2`], [`vec3`], [`camera`], [`keyframes`], [`relative`].

use super::camera_path::Keyframe;
use glam::{Vec2, Vec3};
use octray_engine::scene::Camera;
use std::path::Path;

pub fn camera(camera: &Camera) -> String {
    format!(
        "{{ \"position\": {}, \"look_at\": {}, \"up\": {}, \"vertical_fov\": {} }}",
        vec3(camera.position),
        vec3(camera.look_at),
        vec3(camera.up),
        number(camera.vertical_fov)
    )
}

/// As a view writes them: one a line, for an object that is indented by two spaces.
pub fn keyframes(keyframes: &[Keyframe]) -> String {
    let line =
        |key: &Keyframe| format!("    {{ \"frame\": {}, \"camera\": {} }}", key.frame, camera(&key.camera));
    format!("[\n{}\n  ]", keyframes.iter().map(line).collect::<Vec<_>>().join(",\n"))
}

pub fn vec3(v: Vec3) -> String {
    format!("[{}, {}, {}]", number(v.x), number(v.y), number(v.z))
}

pub fn vec2(v: Vec2) -> String {
    format!("[{}, {}]", number(v.x), number(v.y))
}

/// The shortest decimal that reads back as the same bits. Reading goes through f64, so the shortest decimal
/// of an f32 could in principle round twice; then the f64's digits are written.
pub fn number(x: f32) -> String {
    let short = json_digits(f64::from(x).abs() >= 1e16, &x);
    let read_back = short.parse::<f64>().map(|read| read as f32);
    if read_back.is_ok_and(|read| read.to_bits() == x.to_bits()) {
        short
    } else {
        json_digits(false, &f64::from(x))
    }
}

/// `{:e}` keeps huge numbers short; JSON reads both forms.
fn json_digits<T: std::fmt::Display + std::fmt::LowerExp>(huge: bool, x: &T) -> String {
    if huge { format!("{x:e}") } else { format!("{x}") }
}

/// The path from `folder` to a file that `beside`, another folder, names `file`.
pub fn relative(beside: &Path, file: &str, folder: &Path) -> String {
    // Joined with a dot, an empty path becomes the working directory.
    let folders = [beside, folder].map(|folder| folder.join("."));
    // Only canonical paths can be compared: `a/../b` is `b` unless `a` is a link. A folder that does not
    // exist has none.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_reads_back_as_the_same_bits_at_any_magnitude() {
        // Every bit pattern at a stride that is a large prime: all exponents, many fractions.
        for bits in (0..u32::MAX).step_by(104_729) {
            let x = f32::from_bits(bits);
            if x.is_finite() {
                let read: f64 = serde_json::from_str(&number(x)).unwrap();
                assert_eq!((read as f32).to_bits(), bits, "{x:e} written as {}", number(x));
            }
        }
    }
}
