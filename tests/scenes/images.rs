//! Image files: what is read of them, and what is said of the rest.

use crate::folder::Folder;
use exr::prelude::*;
use octray::scene::load;

/// The first texel of the image as a sky, and what is said of it; or why it is refused.
fn seen(folder: &Folder, name: &str) -> std::result::Result<([f64; 3], String), String> {
    texels(folder, name).map(|(texels, said)| (texels[0], said))
}

fn texels(folder: &Folder, name: &str) -> std::result::Result<(Vec<[f64; 3]>, String), String> {
    let ball = r#""spheres": [{ "center": [0,0,0], "radius": 1 }]"#;
    let keys = format!(r#"{ball}, "sky": {{ "texture": "{name}" }}"#);
    let scene = folder.load_keys(&keys).map_err(|error| error.to_string())?;
    assert!(scene.warnings.iter().all(|warning| warning.contains(&format!("{name}: "))));
    let texels = &scene.textures[0].texels;
    Ok(((0..texels.len()).map(|at| texels.linear(at)).collect(), scene.warnings.concat()))
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
    folder.write("sky.exr", bytes);
    seen(&folder, "sky.exr")
}

/// Tests whether warnings say this, or nothing where there is nothing to say.
fn is_said(said: &str, what: &str) -> bool {
    said.contains(what) && said.is_empty() == what.is_empty()
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
        (
            &[("R", -1e-6), ("G", 0.5), ("B", 1.0)],
            [0.0, 0.5, 1.0],
            "values below 0, down to -1e-6, became 0 in 640 pixels",
        ),
    ] {
        let (found, said) = exr(Compression::ZIP16, channels).unwrap();
        assert!(found == texel && is_said(&said, what), "{channels:?}: {found:?}, {said}");
    }
    let error = exr(Compression::RLE, &[("U", 1.0), ("V", 1.0)]).unwrap_err();
    assert!(error.contains("neither red, green and blue channels nor a grey one"), "{error}");
    let error = exr(Compression::HTJ2K256, &rgb).unwrap_err();
    assert!(error.contains("ht j2k") && error.contains("oiiotool"), "{error}");
}

/// Of a data window of 2 × 2 pixels, two lie in the display window of 3 × 2.
#[test]
fn exr_windows_primaries_and_types_of_numbers_are_honoured() {
    let folder = Folder::new();
    let pixel = |at: Vec2<usize>| (f16::from_f32(0.25), 1.0_f32 + at.x() as f32 + 2.0 * at.y() as f32, 3_u32);
    let mut layer = Layer::new(
        (2, 2),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        SpecificChannels::rgb(pixel),
    );
    layer.attributes.layer_position = Vec2(11, 19);
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::new((10, 20), (3, 2));
    image.write().to_file(folder.path("w.exr")).unwrap();
    let (black, at) = ([0.0; 3], |green| [0.25, green, 3.0]);
    let wanted = vec![black, at(3.0), at(4.0), black, black, black];
    assert_eq!(texels(&folder, "w.exr").unwrap(), (wanted, String::new()));
    // ACEScg: the colours of the light, by CIE XYZ.
    let [red, green, blue, white] =
        [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], [0.32168, 0.33767]].map(|[x, y]| Vec2(x, y));
    image.attributes.chromaticities = Some(attribute::Chromaticities { red, green, blue, white });
    image.write().to_file(folder.path("w.exr")).unwrap();
    let (texels, said) = texels(&folder, "w.exr").unwrap();
    let off = (0..3).map(|at| (texels[1][at] - [0.00000, 3.34558, 2.81352][at]).abs()).fold(0.0, f64::max);
    assert!(off < 1e-4 && said.contains("below 0"), "{texels:?} {said}");
}

#[test]
fn numbers_that_are_no_radiance_are_replaced_and_counted() {
    let folder = Folder::new();
    let pixels = [[f32::INFINITY, 1.0, 2.0], [3.5, f32::NAN, 0.5], [-1.0, f32::NEG_INFINITY, 1.0]];
    crate::openexr::write(&folder.path("sky.exr"), 3, &pixels);
    let (texels, said) = texels(&folder, "sky.exr").unwrap();
    assert_eq!(texels, [[3.5, 1.0, 2.0], [3.5, 0.0, 0.5], [0.0, 0.0, 1.0]]);
    for what in
        ["NaN or negative infinity became 0 in 2 pixels", "infinity became 3.5", "below 0, down to -1e0"]
    {
        assert!(said.contains(what), "{said}");
    }
}

#[test]
fn radiance_pictures_of_every_orientation_and_in_xyz_are_read() {
    let folder = Folder::new();
    let read = |format: &str, resolution: &str, pixels: &[u8]| {
        let head = format!("#?RADIANCE\nFORMAT=32-bit_rle_{format}\n\n{resolution}\n");
        folder.write("s.hdr", [head.as_bytes(), pixels].concat());
        texels(&folder, "s.hdr").unwrap()
    };
    let pixels: Vec<u8> = (1..7).flat_map(|red| [red, 0, 0, 136]).collect();
    for (resolution, wanted) in [
        ("-Y 2 +X 3", [1, 2, 3, 4, 5, 6]),
        ("+Y 2 +X 3", [4, 5, 6, 1, 2, 3]),
        ("-Y 2 -X 3", [3, 2, 1, 6, 5, 4]),
        ("+Y 2 -X 3", [6, 5, 4, 3, 2, 1]),
        ("+X 3 -Y 2", [1, 3, 5, 2, 4, 6]),
        ("-X 3 -Y 2", [5, 3, 1, 6, 4, 2]),
        ("+X 3 +Y 2", [2, 4, 6, 1, 3, 5]),
        ("-X 3 +Y 2", [6, 4, 2, 5, 3, 1]),
    ] {
        let (texels, said) = read("rgbe", resolution, &pixels);
        assert_eq!(texels.iter().map(|texel| texel[0] as u8).collect::<Vec<_>>(), wanted, "{resolution}");
        assert!(said.is_empty(), "{said}");
    }
    // The white of Rec. 709.
    let (texels, said) = read("xyze", "-Y 1 +X 1", &[122, 128, 139, 129]);
    assert!(texels[0].iter().all(|x| (x - 1.0).abs() < 0.02) && said.is_empty(), "{texels:?} {said}");
}

#[test]
fn colours_of_8_and_16_bits_are_decoded_from_srgb_and_data_are_not() {
    let folder = Folder::new();
    image::RgbImage::from_pixel(1, 1, image::Rgb([51; 3])).save(folder.path("8.png")).unwrap();
    let wide = image::ImageBuffer::from_pixel(1, 1, image::Rgb([51_u16 * 257; 3]));
    wide.save(folder.path("16.png")).unwrap();
    for (key, wanted) in [("emission_map", 0.033105), ("texture", 0.033105), ("roughness_map", 0.2)] {
        for name in ["8.png", "16.png"] {
            let material = format!(r#"{{ "type": "metal", "{key}": "{name}" }}"#);
            let ball = r#""spheres": [{ "center": [0,0,0], "radius": 1, "material": "m" }]"#;
            let keys = format!(r#""materials": {{ "m": {material} }}, {ball}"#);
            let texel = folder.load_keys(&keys).unwrap().textures[0].texels.linear(0);
            assert!(texel.iter().all(|x| (x - wanted).abs() < 1e-5), "{key} {name}: {texel:?}");
        }
    }
}

#[test]
fn colours_of_a_file_are_converted_and_the_rest_is_said() {
    let folder = Folder::new();
    for (head, what) in [("RADIANCE", ""), ("RGBE", ""), ("RGBE\nEXPOSURE=2", "`EXPOSURE=2` is ignored")] {
        let head = format!("#?{head}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n");
        folder.write("s.hdr", [head.as_bytes(), &[128, 64, 32, 129]].concat());
        let (texel, said) = seen(&folder, "s.hdr").unwrap();
        assert!(texel == [1.0, 0.5, 0.25] && is_said(&said, what), "{head}: {said}");
    }
    let plain = [0.57758, 0.12744, 0.03190];
    let textured = r#""materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
        "textures": [{ "source": 0 }], "images": [{ "uri": "p.png" }]"#;
    folder.write_gltf_triangle("m.gltf", "t.bin", textured);
    for (alpha, chunk, wanted, what) in [
        (255, &b"gAMA\0\0\xb1\x8f"[..], plain, ""),
        (255, b"gAMA\0\x01\x86\xa0", [0.78431, 0.39216, 0.19608], ""),
        // Display P3, linear Rec. 2020, PQ.
        (255, b"cICP\x0c\x0d\0\x01", [0.67884, 0.10851, 0.01367], ""),
        (255, b"cICP\x09\x08\0\x01", [1.0, 0.34495, 0.16568], ""),
        (255, b"cICP\x09\x10\0\x01", plain, "its colour profile is left out"),
        (127, b"sRGB\0", plain, "transparency"),
    ] {
        let pixel = image::RgbaImage::from_raw(1, 1, vec![200, 100, 50, alpha]).unwrap();
        let mut png = std::io::Cursor::new(Vec::new());
        pixel.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let (mut png, length) = (png.into_inner(), chunk.len() as u32 - 4);
        let sum = crc32fast::hash(chunk).to_be_bytes();
        // Behind the signature and the header.
        png.splice(33..33, [&length.to_be_bytes(), chunk, &sum].concat());
        folder.write("p.png", png);
        let (texel, said) = seen(&folder, "p.png").unwrap();
        let off = |texel: [f64; 3], wanted: [f64; 3]| (0..3).any(|at| (texel[at] - wanted[at]).abs() > 5e-4);
        assert!(!off(texel, wanted) && is_said(&said, what), "{what}: {texel:?} {said}");
        // In glTF all are sRGB, by its standard.
        let texel = load(&folder.name("m.gltf")).unwrap().textures[0].texels.linear(0);
        assert!(!off(texel, plain), "{what}: {texel:?}");
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
        assert!(is_said(&said, what), "{behind:?}: {said}");
    }
}
