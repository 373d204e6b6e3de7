//! The picture that a front end of the viewer should show.

use crate::folder::Folder;
use crate::program::octray;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;

/// Bytes of red, green and blue, row by row from the top.
pub type Bytes = Vec<[u8; 3]>;

/// The mean over all pixels and channels, in steps of a byte.
pub fn difference(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let steps = |(a, b): (&[u8; 3], &[u8; 3])| (0..3).map(|c| u64::from(a[c].abs_diff(b[c]))).sum::<u64>();
    a.iter().zip(b).map(steps).sum::<u64>() as f64 / (3 * a.len()) as f64
}

/// Renders a scene into a file; `more` are options.
fn render(scene: impl AsRef<OsStr>, file: &Path, more: &[&str]) {
    let done = octray().arg("render").arg(scene).arg("-o").arg(file).args(more).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

/// What `octray render` makes of a scene.
pub fn rendered(scene: &str, size: &str, samples: u32) -> Bytes {
    let folder = Folder::new();
    let file = folder.path("picture.png");
    render(scene, &file, &["--size", size, "--samples", &samples.to_string()]);
    image::open(file).unwrap().to_rgb8().pixels().map(|pixel| pixel.0).collect()
}

/// Asserts that the view of a screenshot gives the bytes of the pictures beside it.
pub fn assert_renders_again(shot: &Path) {
    let folder = Folder::new();
    for extension in ["png", "exr"] {
        let again = folder.path("again").with_extension(extension);
        render(shot.with_extension("json"), &again, &[]);
        let [again, bytes] = [again, shot.with_extension(extension)].map(|file| fs::read(file).unwrap());
        assert!(again == bytes, "{}.{extension}: {} and {} bytes", shot.display(), bytes.len(), again.len());
    }
}
