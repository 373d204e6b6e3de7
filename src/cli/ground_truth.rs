//! The cache of ground truths: pictures with many samples, which take long to render and stay valid.
//!
//! A ground truth is an .exr of the frame and beside it a .json of its quality. Their name holds a hash of
//! all that decides the picture: the scene with its textures, the size, the bounces, the commit of the
//! program and the build, because a commit with changes has many builds.

use super::error::CliError;
use crate::checkpoint::Fingerprint;
use crate::machine::Machine;
use crate::measure::chart::ground_truth::{GroundTruth, GroundTruthInfo};
use crate::output;
use crate::report::drawing::file_name;
use crate::scene::Scene;
use crate::tone::Tone;
use octray_formats::openexr;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Returns the path of this scene's ground truth, without an extension.
pub fn place(folder: &Path, scene: &Scene, size: [u32; 2], max_bounces: u32) -> PathBuf {
    let picture = (Fingerprint::from_scene(scene), size, max_bounces);
    let mut hasher = DefaultHasher::new();
    format!("{picture:?} {} {:?}", Machine::current().commit, build()).hash(&mut hasher);
    folder.join("truth").join(format!("{}-{:016x}", file_name(&scene.name), hasher.finish()))
}

/// Returns the time at which the program was built, and the size of its file; `None` if the system does not
/// know them.
fn build() -> Option<(SystemTime, u64)> {
    let file = fs::metadata(std::env::current_exe().ok()?).ok()?;
    Some((file.modified().ok()?, file.len()))
}

/// Returns the ground truth at this place; `None` where none can be read or its size differs.
pub fn load(place: &Path, size: [u32; 2]) -> Option<GroundTruth> {
    let quality: GroundTruthInfo =
        serde_json::from_slice(&fs::read(place.with_extension("json")).ok()?).ok()?;
    let bytes = fs::read(place.with_extension("exr")).ok()?;
    let (picture, ..) = openexr::read(&bytes, size.map(u64::from).iter().product()).ok()?;
    (size == [picture.width, picture.height]).then(|| GroundTruth::from_kept(picture, quality))
}

/// Saves a ground truth, the picture first, so that no quality is without a picture.
pub fn save(place: &Path, truth: &GroundTruth) -> Result<(), CliError> {
    let quality = place.with_extension("json");
    output::make_folder(place.parent().unwrap_or(Path::new(".")))?;
    output::save(&place.with_extension("exr"), &truth.frame, &Tone::default())?;
    Ok(output::save_json(&quality, &truth.info)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_differ_in_all_that_decides_a_ground_truth() {
        let scene = crate::scene::load("builtin:cornell").unwrap();
        let of = |scene: &Scene, size, bounces| place(Path::new("."), scene, size, bounces);
        let one = of(&scene, [48, 27], 4);
        assert_ne!(one, of(&scene, [48, 30], 4), "size");
        assert_ne!(one, of(&scene, [48, 27], 5), "bounces");
        let mut shining = scene;
        shining.materials[0].emission.z += 1e-6;
        assert_ne!(one, of(&shining, [48, 27], 4), "light");
    }
}
