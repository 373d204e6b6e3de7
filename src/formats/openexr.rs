//! OpenEXR files: linear f32, lossless.
//!
//! For: [`read()`], [`write()`].
//!
//! Single-threaded: several threads would write blocks in the order of their completion, and two files of one
//! picture would differ.

use exr::meta::MetaData;
use exr::prelude::*;
use octray_engine::film::Picture;
use std::io::{Cursor, Seek, Write};

/// The first layer with red, green and blue channels, in the size of the file's display window; black outside
/// the layer's data window. Windows of more than `most` pixels are refused before anything of their size is
/// allocated.
pub fn read(bytes: &[u8], most: u64) -> std::result::Result<Picture, String> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| error.to_string())?;
    for header in &meta.headers {
        for size in [header.layer_size, header.shared_attributes.display_window.size] {
            let Vec2(width, height) = size;
            if (width as u64).saturating_mul(height as u64) > most {
                return Err(format!("{width} × {height} pixels are more than the {most} that are read"));
            }
        }
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![[0.0_f32; 3]; size.area()]),
            |(width, pixels): &mut (usize, Vec<[f32; 3]>), at, (r, g, b): (f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| error.to_string())?;
    let window = image.attributes.display_window;
    let layer = image.layer_data;
    let (layer_width, layer_pixels) = layer.channel_data.pixels;
    let offset = layer.attributes.layer_position - window.position;
    let Vec2(width, height) = window.size;
    let mut pixels = vec![[0.0; 3]; window.size.area()];
    for (index, pixel) in layer_pixels.into_iter().enumerate() {
        let at = Vec2(index % layer_width, index / layer_width).to_i32() + offset;
        if at.x() >= 0 && at.y() >= 0 && (at.x() as usize) < width && (at.y() as usize) < height {
            pixels[at.y() as usize * width + at.x() as usize] = pixel;
        }
    }
    Ok(Picture { width: width as u32, height: height as u32, pixels })
}

/// Writes a picture without loss.
pub fn write(out: impl Write + Seek, picture: &Picture) -> std::io::Result<()> {
    let Picture { width, height, ref pixels } = *picture;
    let size = Vec2(width as usize, height as usize);
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let [r, g, b] = pixels[at.flat_index_for_size(size)];
        (r, g, b)
    });
    let written = Image::from_channels(size, channels).write().non_parallel().to_buffered(out);
    written.map_err(|error| match error {
        Error::Io(error) => error,
        other => std::io::Error::other(other),
    })
}
