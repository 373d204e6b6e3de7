//! OpenEXR files as the `exr` crate itself reads and writes them.

use exr::prelude::*;
use std::path::Path;

/// Width, height, and pixels row by row.
#[allow(dead_code)]
pub fn read(path: &Path) -> (usize, usize, Vec<[f32; 3]>) {
    let pixels = |size: Vec2<usize>, _: &RgbaChannels| (size, vec![[0.0; 3]; size.area()]);
    let set = |(size, pixels): &mut (Vec2<usize>, Vec<[f32; 3]>),
               at: Vec2<usize>,
               (r, g, b, _): (f32, f32, f32, f32)| {
        pixels[at.flat_index_for_size(*size)] = [r, g, b];
    };
    let image = read_first_rgba_layer_from_file(path, pixels, set).unwrap();
    let (size, pixels) = image.layer_data.channel_data.pixels;
    (size.width(), size.height(), pixels)
}

/// Writes `width` pixels a row.
#[allow(dead_code)]
pub fn write(path: &Path, width: usize, pixels: &[[f32; 3]]) {
    write_rgb_file(path, width, pixels.len() / width, |x, y| {
        let [r, g, b] = pixels[y * width + x];
        (r, g, b)
    })
    .unwrap();
}
