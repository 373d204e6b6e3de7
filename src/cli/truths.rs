//! Truths that were rendered before: a picture takes long to become true, and stays so.
//!
//! For: [`load`], [`save`]. May import: `output`, `measure::chart`. Must never know: how a truth is made.
//!
//! A truth is kept as an .exr of the frame and a .json of its quality beside it, under a name that holds a fingerprint of all that decides
//! it: the scene with all its pictures, size, bounces, the commit of the program, and which build of it this is: a commit with changes is many
//! programs.

use super::error::CliError;
use crate::machine::Machine;
use crate::measure::chart::ground_truth::{GroundTruthInfo, GroundTruth};
use crate::output;
use crate::report::chart::file_name;
use crate::scene::Scene;
use crate::tone::Tone;
use octray_formats::openexr;
use std::fmt::Write;
use std::fs;
use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Where the truth of this scene is kept, without an extension.
pub fn place(folder: &Path, scene: &Scene, size: [u32; 2], max_bounces: u32) -> PathBuf {
    struct Hashed(DefaultHasher);
    impl Write for Hashed {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            self.0.write(text.as_bytes());
            Ok(())
        }
    }
    let mut hashed = Hashed(DefaultHasher::new());
    // Where a scene was read changes nothing of its truth.
    let Scene {
        files: _,
        name,
        camera,
        resolution,
        max_bounces: own_bounces,
        sky,
        materials,
        textures,
        spheres,
        triangles,
        uvs,
        normals,
        warnings,
    } = scene;
    // Debugging text holds all that they are, and every f32 in as many digits as tell it from all others.
    let looks = (name, camera, resolution, own_bounces, sky, materials, textures, warnings);
    let shapes = (spheres, triangles, uvs, normals);
    let program = (Machine::current().commit, build());
    let _ = write!(hashed, "{looks:?} {shapes:?} {size:?} {max_bounces} {program:?}");
    folder.join("truth").join(format!("{}-{:016x}", file_name(&scene.name), hashed.0.finish()))
}

/// When the program was built, and its length; `None` where the system does not say.
fn build() -> Option<(SystemTime, u64)> {
    let file = fs::metadata(std::env::current_exe().ok()?).ok()?;
    Some((file.modified().ok()?, file.len()))
}

/// The truth that is kept there; `None` where there is none that can be read, or its size is another.
pub fn load(place: &Path, size: [u32; 2]) -> Option<GroundTruth> {
    let quality: GroundTruthInfo = serde_json::from_slice(&fs::read(place.with_extension("json")).ok()?).ok()?;
    let picture = openexr::read(&fs::read(place.with_extension("exr")).ok()?).ok()?;
    (size == [picture.width, picture.height]).then(|| GroundTruth::from_kept(picture, quality))
}

/// Keeps a truth: the picture first, so that there is no quality without one.
pub fn save(place: &Path, truth: &GroundTruth) -> Result<(), CliError> {
    let quality = place.with_extension("json");
    output::make_folder(place.parent().unwrap_or(Path::new(".")))?;
    output::save(&place.with_extension("exr"), &truth.frame, &Tone::default())?;
    Ok(output::save_json(&quality, &truth.info)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Picture;

    #[test]
    fn places_differ_in_all_that_decides_a_truth() {
        let scene = crate::scene::load("builtin:cornell").unwrap();
        let of = |scene: &Scene, size, bounces| place(Path::new("."), scene, size, bounces);
        let one = of(&scene, [48, 27], 4);
        let elsewhere = Scene { files: vec!["elsewhere.json".into()], ..scene.clone() };
        assert_eq!(one, of(&elsewhere, [48, 27], 4), "the same scene from another place");
        let mut moved = scene.clone();
        moved.triangles[7].vertices[1].y = moved.triangles[7].vertices[1].y.next_up();
        let mut shining = scene.clone();
        shining.materials[0].emission.z += 1e-6;
        for (other, what) in [
            (of(&scene, [48, 30], 4), "size"),
            (of(&scene, [48, 27], 5), "bounces"),
            (of(&moved, [48, 27], 4), "one bit of a vertex"),
            (of(&shining, [48, 27], 4), "light"),
        ] {
            assert_ne!(one, other, "{what}");
        }
    }

    #[test]
    fn truth_is_kept_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("truth").join("one");
        let pixels = (0..18).map(|at| [at as f32 / 7.0, 1e-9 * at as f32, 1e4 / (1 + at) as f32]).collect();
        let frame = Picture { width: 6, height: 3, pixels };
        let quality =
            GroundTruthInfo { samples: 14, frame_rmse: 0.1, small_rmse: 0.1 / 3.0, budget_s: 1.5, cached: false };
        let truth = GroundTruth::from_kept(frame, quality);
        save(&place, &truth).unwrap();
        assert_eq!(load(&place, [6, 3]), Some(truth));
        assert_eq!(load(&place, [3, 6]), None);
        fs::remove_file(place.with_extension("json")).unwrap();
        assert_eq!(load(&place, [6, 3]), None, "a picture of which nothing is known");
    }
}
