//! Image files: what is read of them, and what is said of the rest.

use crate::folder::Folder;
use exr::prelude::*;
use std::fs;

/// The first texel of the image as a sky, and what is said of it; or why it is refused.
fn seen(folder: &Folder, name: &str) -> std::result::Result<([f64; 3], String), String> {
    let ball = r#""spheres": [{ "center": [0,0,0], "radius": 1 }]"#;
    let text = format!(r#"{{ "format": "octray-1", {ball}, "sky": {{ "texture": "{name}" }} }}"#);
    let scene = folder.load("scene.json", text).map_err(|error| error.to_string())?;
    assert!(scene.warnings.iter().all(|warning| warning.contains(&format!("{name}: "))));
    Ok((scene.textures[0].texels.linear(0), scene.warnings.concat()))
}

/// The same of an EXR file of 40 × 16 pixels with these channels, each of one value.
fn exr(
    compression: Compression,
    channels: &[(&str, f32)],
) -> std::result::Result<([f64; 3], String), String> {
    let folder = Folder::new();
    let of = |&(name, value): &(&str, f32)| AnyChannel::new(name, FlatSamples::F32(vec![value; 40 * 16]));
    let channels = AnyChannels::sort(channels.iter().map(of).collect());
    let encoding = Encoding { compression, ..Encoding::SMALL_LOSSLESS };
    let layer = Layer::new((40, 16), LayerAttributes::named("part"), encoding, channels);
    let mut bytes = std::io::Cursor::new(Vec::new());
    // JPEG 2000 is not written: its number, 10, takes another's place.
    let is_new = compression == Compression::HTJ2K256;
    let layer = if is_new { Layer { encoding: Encoding::SMALL_LOSSLESS, ..layer } } else { layer };
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    let (mut bytes, name) = (bytes.into_inner(), b"compression\0compression\0");
    let at = bytes.windows(name.len()).position(|at| at == name).unwrap() + name.len() + 4;
    bytes[at] = if is_new { 10 } else { bytes[at] };
    fs::write(folder.path("sky.exr"), bytes).unwrap();
    seen(&folder, "sky.exr")
}

#[test]
fn exr_files_of_any_compression_and_naming_are_read() {
    let rgb = [("R", 0.25), ("G", 0.5), ("B", 1.0)];
    let lossy = [Compression::DWAA(None), Compression::DWAB(None), Compression::B44];
    for compression in lossy.into_iter().chain([Compression::PIZ, Compression::RLE]) {
        let ([r, g, b], said) = exr(compression, &rgb).unwrap();
        let off = (r - 0.25).abs().max((g - 0.5).abs()).max((b - 1.0).abs());
        assert!(off < 1e-2 && said.is_empty(), "{compression}: {r} {g} {b} {said}");
    }
    let layer = [("Diffuse.R", 2.0), ("Diffuse.G", 3.0), ("Diffuse.B", 4.0)];
    let (color, layered, grey) = ([0.25, 0.5, 1.0], [2.0, 3.0, 4.0], [0.5; 3]);
    for (channels, texel, what) in [
        (&layer[..], layered, ""),
        (&[("Y", 0.5), ("A", 1.0)], grey, ""),
        (&[("mask", 0.5)], grey, ""),
        (&[&layer[..], &rgb].concat(), color, "channels Diffuse.B, Diffuse.G, Diffuse.R are left out."),
        (&[&[("Y", 7.0), ("Z", 9.0)], &layer[..]].concat(), layered, "channels Y, Z are left out."),
        (&[&[("A", 0.5)], &rgb[..]].concat(), color, "640 pixels are transparent"),
        (&[("R", -1e-6), ("G", 0.5), ("B", 1.0)], [0.0, 0.5, 1.0], "640 pixels below 0 became 0"),
    ] {
        let (found, said) = exr(Compression::ZIP16, channels).unwrap();
        let is_said = said.contains(what) && said.is_empty() == what.is_empty();
        assert!(found == texel && is_said, "{channels:?}: {found:?}, {said}");
    }
    let error = exr(Compression::RLE, &[("U", 1.0), ("V", 1.0)]).unwrap_err();
    assert!(error.contains("neither red, green and blue channels nor a grey one"), "{error}");
    let error = exr(Compression::HTJ2K256, &rgb).unwrap_err();
    assert!(error.contains("ht j2k") && error.contains("oiiotool"), "{error}");
}

#[test]
fn what_would_change_the_colours_of_a_file_is_said() {
    let folder = Folder::new();
    for (head, what) in [("RADIANCE", ""), ("RGBE", ""), ("RGBE\nEXPOSURE=2", "`EXPOSURE` is not undone")] {
        let head = format!("#?{head}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n");
        folder.write("s.hdr", [head.as_bytes(), &[128, 64, 32, 129]].concat());
        let (texel, said) = seen(&folder, "s.hdr").unwrap();
        let is_said = said.contains(what) && said.is_empty() == what.is_empty();
        assert!(texel == [1.0, 0.5, 0.25] && is_said, "{head}: {said}");
    }
    for (alpha, chunk, what) in [
        (255, &b"gAMA\0\0\xb1\x8f"[..], ""),
        (255, b"gAMA\0\x01\x86\xa0", "or gamma, is left out"),
        (255, b"cICP\x09\x10\0\x01", "colour profile"),
        (127, b"sRGB\0", "transparency"),
    ] {
        let pixel = image::RgbaImage::from_raw(1, 1, vec![255, 0, 0, alpha]).unwrap();
        let mut png = std::io::Cursor::new(Vec::new());
        pixel.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let (mut png, length) = (png.into_inner(), chunk.len() as u32 - 4);
        let sum = crc32fast::hash(chunk).to_be_bytes();
        // Behind the signature and the header.
        png.splice(33..33, [&length.to_be_bytes(), chunk, &sum].concat());
        folder.write("p.png", png);
        let (texel, said) = seen(&folder, "p.png").unwrap();
        let is_said = said.contains(what) && said.is_empty() == what.is_empty();
        assert!(texel == [1.0, 0.0, 0.0] && is_said, "{what}: {said}");
    }
}

#[test]
fn a_jpeg_that_ends_early_is_said_to() {
    let folder = Folder::new();
    let picture = image::RgbImage::from_fn(64, 64, |x, y| image::Rgb([x as u8, y as u8, 255]));
    let mut jpeg = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut jpeg, image::ImageFormat::Jpeg).unwrap();
    let jpeg = jpeg.into_inner();
    let (cut, what) = (&jpeg[..jpeg.len() - 20], "its end is missing");
    // Behind the picture may come another one, cut or not, or anything.
    let behind: [&[u8]; 4] = [&[], &[0xff, 0xda, 1], &[0xff, 0xd8, 0xff, 0xd9], cut];
    for (file, behind, what) in behind
        .map(|behind| (&jpeg[..], behind, ""))
        .into_iter()
        .chain([(cut, &[][..], what), (&jpeg[..jpeg.len() - 2], &[], what)])
    {
        folder.write("p.jpg", [file, behind].concat());
        let (_, said) = seen(&folder, "p.jpg").unwrap();
        assert!(said.contains(what) && said.is_empty() == what.is_empty(), "{behind:?}: {said}");
    }
}
