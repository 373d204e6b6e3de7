//! Reads and writes OpenEXR files.
//!
//! One thread does all work: several would write blocks in the order of their completion, and two files of
//! one picture would differ.

pub use exr::prelude::FlatSamples;

use exr::meta::MetaData;
use exr::prelude::*;
use octray_engine::film::Picture;
use std::io::{Cursor, Seek, Write};

/// The CIE x and y of red, green, blue and white.
pub type Chromaticities = [[f32; 2]; 4];

/// Reads the first layer with red, green and blue channels, or else the first grey one. The picture has the
/// size of the file's display window, and is black outside the layer's data window. Returns it with the
/// primaries of its colours, if the file names them, and one clause for everything that is left out.
///
/// Windows of more than `most` pixels are refused before anything of their size is allocated. DWAA and DWAB,
/// which are lossy, decode to other bits on processors without AVX2.
pub fn read(
    bytes: &[u8],
    most: u64,
) -> std::result::Result<(Picture, Option<Chromaticities>, Vec<String>), String> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(fault)?;
    for header in &meta.headers {
        for size in [header.layer_size, header.shared_attributes.display_window.size] {
            let Vec2(width, height) = size;
            if (width as u64).saturating_mul(height as u64) > most {
                return Err(format!("{width} × {height} pixels are more than the {most} that are read"));
            }
        }
    }
    let (channels, alpha) =
        channels(&meta).ok_or("it has neither red, green and blue channels nor a grey one")?;
    // Reads pixels of red, green, blue and alpha.
    macro_rules! image {
        ($channels:expr, $sample:pat, $type:ty => $pixel:expr) => {
            $channels
                .optional(alpha.clone(), 1.0)
                .collect_pixels(
                    |size, _| (size.width(), vec![[0.0_f32; 4]; size.area()]),
                    |(width, pixels): &mut (usize, Vec<[f32; 4]>), at, $sample: $type| {
                        pixels[at.y() * *width + at.x()] = $pixel;
                    },
                )
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_buffered(Cursor::new(bytes))
                .map(|image| {
                    (image.attributes, image.layer_data.attributes, image.layer_data.channel_data.pixels)
                })
        };
    }
    let file = exr::prelude::read().no_deep_data().largest_resolution_level().specific_channels();
    let image = match channels.as_slice() {
        [r, g, b] => {
            let colors = file.required(r.clone()).required(g.clone()).required(b.clone());
            image!(colors, (r, g, b, a), (f32, f32, f32, f32) => [r, g, b, a])
        }
        grey => image!(file.required(grey[0].clone()), (y, a), (f32, f32) => [y, y, y, a]),
    };
    let (attributes, layer, (layer_width, layer_pixels)) = image.map_err(fault)?;
    let window = attributes.display_window;
    let offset = layer.layer_position - window.position;
    let Vec2(width, height) = window.size;
    let (mut pixels, mut transparent) = (vec![[0.0; 3]; window.size.area()], 0);
    for (index, [r, g, b, a]) in layer_pixels.into_iter().enumerate() {
        let at = Vec2(index % layer_width, index / layer_width).to_i32() + offset;
        if at.x() >= 0 && at.y() >= 0 && (at.x() as usize) < width && (at.y() as usize) < height {
            pixels[at.y() as usize * width + at.x() as usize] = [r, g, b];
            transparent += u32::from(a < 1.0);
        }
    }
    let mut left_out = Vec::new();
    let is_read = |name: &Text| channels.contains(name) || *name == alpha;
    let all = meta.headers.iter().flat_map(|header| &header.channels.list).map(|channel| &channel.name);
    let others: Vec<String> = all.filter(|name| !is_read(name)).map(Text::to_string).collect();
    if !others.is_empty() {
        let count = others.len().saturating_sub(5);
        let more = if count > 0 { format!(" and {count} more") } else { String::new() };
        left_out
            .push(format!("its channels {}{more} are left out", others[..others.len() - count].join(", ")));
    }
    if transparent > 0 {
        left_out.push(format!("{transparent} pixels are transparent and shown over black"));
    }
    let colors = attributes
        .chromaticities
        .filter(|_| channels.len() == 3)
        .map(|file| [file.red, file.green, file.blue, file.white].map(|Vec2(x, y)| [x, y]));
    Ok((Picture { width: width as u32, height: height as u32, pixels }, colors, left_out))
}

/// Returns the names of a layer's channels and of its alpha: red, green and blue of the first layer that has
/// all three, or else the channel of the first grey layer, or else the file's only channel. A layer is a part
/// of the file, or a prefix of names that ends in a point. Names without a prefix come first.
fn channels(meta: &MetaData) -> Option<(Vec<Text>, Text)> {
    let layer = |ends: &[&str]| {
        meta.headers.iter().find_map(|header| {
            let names: Vec<String> =
                header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
            let prefixes = names.iter().filter_map(|name| name.strip_suffix(ends[0]));
            let prefixes = prefixes.filter(|prefix| prefix.ends_with('.'));
            std::iter::once("").chain(prefixes).find_map(|prefix| {
                let name = |end: &&str| format!("{prefix}{end}");
                let found: Vec<String> = ends.iter().map(name).filter(|name| names.contains(name)).collect();
                let texts = found.iter().map(|name| Text::from(name.as_str())).collect();
                (found.len() == ends.len()).then(|| (texts, Text::from(name(&"A").as_str())))
            })
        })
    };
    let only = || match meta.headers.first()?.channels.list.as_slice() {
        [only] => Some((vec![only.name.clone()], Text::from("no alpha"))),
        _ => None,
    };
    layer(&["R", "G", "B"]).or_else(|| layer(&["Y"])).or_else(only)
}

/// Describes what is wrong with a file and, if another program can read it, how to convert it.
fn fault(error: Error) -> String {
    match error {
        Error::NotSupported(what) => {
            format!("{what}: convert it, as with `oiiotool OLD.exr --compression zip -o NEW.exr`")
        }
        other => format!("the image is broken: {other}"),
    }
}

/// Writes a picture as linear f32, without loss: scan lines from the top, ZIP, which every program reads. A
/// `comment`, unless it is empty, is the attribute of this name.
pub fn write(out: impl Write + Seek, picture: &Picture, comment: &str) -> std::io::Result<()> {
    let Picture { width, height, ref pixels } = *picture;
    let size = Vec2(width as usize, height as usize);
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let [r, g, b] = pixels[at.flat_index_for_size(size)];
        (r, g, b)
    });
    let comments = Some(Text::from(comment)).filter(|_| !comment.is_empty());
    let attributes = LayerAttributes { comments, ..LayerAttributes::default() };
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    Image::from_layer(layer).write().non_parallel().to_buffered(out).map_err(io_error)
}

/// Writes named channels of a picture's size without loss, as [`fn@write`] does. A name `layer.channel` makes
/// a layer.
pub fn write_channels(
    out: impl Write + Seek,
    size: [u32; 2],
    channels: Vec<(String, FlatSamples)>,
) -> std::io::Result<()> {
    let [width, height] = size.map(|side| side as usize);
    let named = channels.into_iter().map(|(name, samples)| AnyChannel::new(name.as_str(), samples));
    let channels = AnyChannels::sort(named.collect());
    let size = Vec2(width, height);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, channels);
    Image::from_layer(layer).write().non_parallel().to_buffered(out).map_err(io_error)
}

fn io_error(error: Error) -> std::io::Error {
    match error {
        Error::Io(error) => error,
        other => std::io::Error::other(other),
    }
}
