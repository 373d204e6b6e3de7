//! Files of the tests' own, in folders that are made for them.

use std::fs;
use std::path::Path;

/// Writes a file, and the folders that it lies in; returns its path.
pub fn write(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_string()
}

/// Saves a picture of four pixels of one colour.
pub fn save_picture(folder: &Path, name: &str) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    image::RgbImage::from_pixel(2, 2, image::Rgb([200, 100, 50])).save(path).unwrap();
}
