//! Picture files hold what they should, and are whole or absent.

use crate::folder::Folder;
use image::ImageDecoder;
use image::codecs::{hdr::HdrDecoder, jpeg::JpegDecoder, png::PngDecoder};
use octray::film::Picture;
use octray::output::{Existing, Format, OutputError, check, encode, save, write_atomically};
use octray::scene::srgb_to_linear;
use octray::tone::{Operator, Tone};
use std::fs;
use std::io::{self, Cursor, Write};
use std::path::Path;

fn encoded(picture: &Picture, format: Format, tone: &Tone) -> Cursor<Vec<u8>> {
    let mut file = Cursor::new(Vec::new());
    encode(&mut file, picture, (format, ""), tone).unwrap();
    file.set_position(0);
    file
}

/// Width, height and samples of what a decoder reads.
fn decoded(decoder: impl ImageDecoder) -> (u32, u32, Vec<u8>) {
    let (width, height) = decoder.dimensions();
    let mut bytes = vec![0; decoder.total_bytes() as usize];
    decoder.read_image(&mut bytes).unwrap();
    (width, height, bytes)
}

/// A PNG file's bytes, whose size is that of the picture.
fn png(picture: &Picture, tone: &Tone) -> Vec<u8> {
    let (width, height, bytes) = decoded(PngDecoder::new(encoded(picture, Format::Png, tone)).unwrap());
    assert_eq!((width, height), (picture.width, picture.height));
    bytes
}

/// The numbers of an HDR file, whose size is that of the picture.
fn hdr(picture: &Picture, tone: &Tone) -> Vec<f32> {
    let (width, height, bytes) = decoded(HdrDecoder::new(encoded(picture, Format::Hdr, tone)).unwrap());
    assert_eq!((width, height), (picture.width, picture.height));
    bytemuck::pod_collect_to_vec(&bytes)
}

fn picture(width: u32, height: u32, color: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
    let pixels = (0..width * height).map(|at| color(at % width, at / width)).collect();
    Picture { width, height, pixels }
}

#[test]
fn png_holds_the_srgb_values_of_known_intensities() {
    // Every stored value, from the intensity that stands for it; and what is out of range.
    let gray = picture(256, 1, |x, _| [srgb_to_linear(f64::from(x) / 255.0) as f32; 3]);
    let expected: Vec<u8> = (0..=255).flat_map(|value| [value; 3]).collect();
    assert_eq!(png(&gray, &Tone::default()), expected);

    let odd = picture(2, 2, |x, y| match (x, y) {
        (0, 0) => [0.0, 0.5, 1.0],
        (1, 0) => [-1.0, 2.0, f32::INFINITY],
        (0, 1) => [f32::NAN, 0.001, 0.18],
        _ => [0.214_041, 0.0, 0.0],
    });
    let bytes = png(&odd, &Tone::default());
    assert_eq!(bytes, [0, 188, 255, 0, 255, 255, 0, 3, 118, 127, 0, 0], "row by row from the top, red first");
}

#[test]
fn png_applies_exposure_and_operator() {
    let gray = picture(1, 1, |_, _| [0.25; 3]);
    // The bytes of 0.5, 0.5, 0.2, and of 0.25 * (2.51 * 0.25 + 0.03) / (0.25 * (2.43 * 0.25 + 0.59) + 0.14).
    for (exposure, operator, byte) in [
        (1.0, Operator::Clamp, 188),
        (2.0, Operator::Reinhard, 188),
        (0.0, Operator::Reinhard, 124),
        (0.0, Operator::Aces, 165),
    ] {
        let bytes = png(&gray, &Tone { exposure, operator });
        assert_eq!(bytes, [byte; 3], "{operator:?} at {exposure} stops");
    }
}

#[test]
fn jpeg_holds_nearly_the_srgb_values() {
    let ramp = picture(64, 48, |x, y| [x as f32 / 64.0, y as f32 / 48.0, 0.25]);
    let (width, height, bytes) =
        decoded(JpegDecoder::new(encoded(&ramp, Format::Jpeg, &Tone::default())).unwrap());
    assert_eq!((width, height), (64, 48));
    let exact = Tone::default().bytes(&ramp);
    let error: u64 = bytes.iter().zip(&exact).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    assert!(error < 2 * exact.len() as u64, "mean error {}", error as f64 / exact.len() as f64);
}

#[test]
fn exr_holds_every_bit() {
    let special = [0.0, -0.0, 1.0, -1.5, 1e-42, 0.1, 1.0 / 3.0, 65_505.0, 1e-9];
    let special = [&special[..], &[f32::MIN_POSITIVE, f32::MAX, f32::INFINITY]].concat();
    let all = picture(12, 3, |x, y| std::array::from_fn(|c| special[(x as usize + 5 * y as usize + c) % 12]));
    // Exposure is for screens: it changes nothing here.
    let tone = Tone { exposure: 3.0, operator: Operator::Aces };
    let folder = Folder::new();
    folder.write("a.exr", encoded(&all, Format::Exr, &tone).into_inner());
    // What every reader knows: `compression` 3 (ZIP), `lineOrder` 0 (increasing y), no tiles.
    let bytes = folder.bytes("a.exr");
    let value =
        |key: &[u8]| bytes[bytes.windows(key.len()).position(|at| at == key).unwrap() + key.len() + 4];
    let found = [value(b"compression\0compression\0"), value(b"lineOrder\0lineOrder\0"), bytes[5] & 2];
    assert_eq!(found, [3, 0, 0]);
    let (width, height, pixels) = crate::openexr::read(&folder.path("a.exr"));
    assert_eq!((width, height), (12, 3));
    let bits =
        |values: &[[f32; 3]]| values.as_flattened().iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&pixels), bits(&all.pixels));
}

/// Enough rows that a writer on several threads would finish its blocks in another order.
#[test]
fn exr_files_of_a_picture_are_the_same_bytes_every_time() {
    let all = picture(300, 200, |x, y| [x as f32, y as f32, (x * y % 7) as f32 / 7.0]);
    let bytes = || encoded(&all, Format::Exr, &Tone::default()).into_inner();
    let first = bytes();
    assert!((0..8).all(|_| bytes() == first));
}

#[test]
fn hdr_holds_radiance_to_half_a_step() {
    // 7 pixels across are stored plainly, 200 run-length encoded.
    for width in [7, 200] {
        let wide = picture(width, 40, |x, y| {
            let x = x as f32 / width as f32;
            // From 2⁻¹¹⁸ to 2¹¹².
            let largest = (5.9 * (y as f32 - 20.0)).exp2();
            [largest, largest * x, if y % 3 == 0 { 0.0 } else { 1.0 }]
        });
        let tone = Tone { exposure: -2.0, operator: Operator::Reinhard };
        for (before, after) in wide.pixels.iter().zip(hdr(&wide, &tone).chunks(3)) {
            let largest = before.iter().fold(0.0_f32, |a, b| a.max(*b));
            for (before, after) in before.iter().zip(after) {
                let off = (before - after).abs();
                assert!(off <= largest / 256.0, "{before} became {after} beside {largest}");
            }
        }
    }
}

#[test]
fn hdr_neither_wraps_around_nor_keeps_what_is_not_light() {
    let odd = picture(4, 1, |x, _| {
        [[1e-42, 0.0, 0.0], [f32::MAX, 1.0, 0.0], [f32::NAN, -1.0, 0.5], [f32::INFINITY; 3]][x as usize]
    });
    let read = hdr(&odd, &Tone::default());
    assert_eq!(read[..3], [0.0; 3]);
    assert!(read[3] > 1e38 && read[4] == 0.0);
    assert_eq!(read[6..9], [0.0, 0.0, 0.5]);
    assert!(read[9] > 1e38 && read[9].is_finite());
}

#[test]
fn save_writes_each_format_by_its_extension() {
    let folder = Folder::new();
    let small = |[width, height]: [u32; 2]| picture(width, height, |x, y| [x as f32, y as f32, 0.5]);
    for size in [[3, 2], [1, 1], [9, 1], [1, 9], [17, 13]] {
        for (name, magic) in [
            ("a.png", &b"\x89PNG"[..]),
            ("a.jpg", b"\xFF\xD8\xFF"),
            ("b.jpeg", b"\xFF\xD8\xFF"),
            ("a.exr", b"\x76\x2f\x31\x01"),
            ("a.HDR", b"#?RADIANCE"),
        ] {
            let path = folder.path(name);
            save(&path, &small(size), &Tone::default()).unwrap();
            assert!(folder.bytes(name).starts_with(magic), "{name}");
            let pixels = match name {
                "a.exr" => crate::openexr::read(&path).2.len() as u32,
                _ => image::image_dimensions(&path).map(|(width, height)| width * height).unwrap(),
            };
            assert_eq!(pixels, size[0] * size[1], "{name}");
        }
    }
    assert_eq!(folder.names(), ["a.HDR", "a.exr", "a.jpg", "a.png", "b.jpeg"]);
    let unknown = save(&folder.path("a.gif"), &small([3, 2]), &Tone::default());
    assert!(matches!(unknown, Err(OutputError::UnknownFormat { .. })));
}

fn half_then_fail(file: &mut impl Write) -> io::Result<()> {
    // More than any buffer, so that some of it reaches the disk.
    file.write_all(&vec![b'x'; 1 << 20])?;
    file.write_all(b"tail")?;
    Err(io::Error::other("the disk is full, say"))
}

#[test]
fn a_write_that_fails_or_panics_leaves_no_file_no_temporary_and_the_old_file_as_it_was() {
    let folder = Folder::new();
    let path = folder.path("new.png");
    for existing in [Existing::Replace, Existing::Keep] {
        let error = write_atomically(&path, existing, |file| half_then_fail(file)).unwrap_err();
        assert!(matches!(&error, OutputError::Write { .. }), "{error}");
        assert_eq!(folder.names(), [""; 0]);
    }
    let panics = || write_atomically(&path, Existing::Replace, |_| panic!("an encoder's bug, say"));
    assert!(std::panic::catch_unwind(panics).is_err());
    assert_eq!(folder.names(), [""; 0]);

    fs::write(&path, "old").unwrap();
    write_atomically(&path, Existing::Replace, |file| half_then_fail(file)).unwrap_err();
    assert_eq!((folder.bytes("new.png"), folder.names()), (b"old".to_vec(), vec!["new.png".to_string()]));
    write_atomically(&path, Existing::Replace, |file| file.write_all(b"new")).unwrap();
    assert_eq!((folder.bytes("new.png"), folder.names()), (b"new".to_vec(), vec!["new.png".to_string()]));
}

#[test]
fn keeping_refuses_a_file_that_is_there_or_that_appears() {
    let folder = Folder::new();
    let path = folder.path("scene.json");
    let racing = write_atomically(&path, Existing::Keep, |file| {
        fs::write(&path, "someone else's")?;
        file.write_all(b"ours")
    });
    assert!(matches!(racing, Err(OutputError::Exists { .. })));
    assert!(matches!(check(&path, Existing::Keep), Err(OutputError::Exists { .. })));
    assert_eq!(fs::read(&path).unwrap(), b"someone else's");
    assert_eq!(folder.names(), ["scene.json"]);
}

#[test]
fn check_leaves_nothing_and_touches_nothing() {
    let folder = Folder::new();
    let path = folder.path("picture.png");
    check(&path, Existing::Replace).unwrap();
    assert_eq!(folder.names(), [""; 0]);
    fs::write(&path, "old").unwrap();
    check(&path, Existing::Replace).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(folder.names(), ["picture.png"]);
}

#[test]
fn check_names_what_is_wrong_with_a_place() {
    let folder = Folder::new();
    let at = |name: &str| check(&folder.path(name), Existing::Replace).unwrap_err();
    folder.write("file", "");
    fs::create_dir(folder.path("folder.png")).unwrap();

    let missing = at("no/such/picture.png");
    let names = matches!(&missing, OutputError::MissingFolder { folder, .. } if folder.ends_with("no/such"));
    assert!(names && missing.to_string().contains("mkdir -p"), "{missing}");
    assert!(matches!(at("file/picture.png"), OutputError::NotAFolder { .. }));
    assert!(matches!(at("file/deeper/picture.png"), OutputError::NotAFolder { .. }));
    assert!(matches!(at("folder.png"), OutputError::IsFolder { .. }));
    assert!(matches!(at("new.png/"), OutputError::IsFolder { .. }));
    assert!(matches!(check(Path::new(".."), Existing::Replace), Err(OutputError::IsFolder { .. })));

    let protected = folder.path("protected.png");
    fs::write(&protected, "old").unwrap();
    let mut permissions = fs::metadata(&protected).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&protected, permissions).unwrap();
    assert!(matches!(at("protected.png"), OutputError::ReadOnly { .. }));
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn a_new_file_has_usual_permissions_and_a_replaced_one_keeps_its_own() {
        let folder = Folder::new();
        let (ordinary, ours) = (folder.path("ordinary"), folder.path("ours"));
        fs::write(&ordinary, "").unwrap();
        write_atomically(&ours, Existing::Replace, |file| file.write_all(b"new")).unwrap();
        assert_eq!(mode(&ours), mode(&ordinary));
        fs::set_permissions(&ours, fs::Permissions::from_mode(0o640)).unwrap();
        write_atomically(&ours, Existing::Replace, |file| file.write_all(b"newer")).unwrap();
        assert_eq!(mode(&ours), 0o640);
    }

    #[test]
    fn a_symbolic_link_stays_one_and_its_target_is_written() {
        let folder = Folder::new();
        let there = folder.path("there");
        fs::create_dir(&there).unwrap();
        let link = folder.path("link.png");
        symlink("there/target.png", &link).unwrap();
        for content in ["a new target", "an old target"] {
            write_atomically(&link, Existing::Replace, |file| file.write_all(content.as_bytes())).unwrap();
            assert!(link.is_symlink());
            assert_eq!(fs::read(there.join("target.png")).unwrap(), content.as_bytes());
            assert_eq!(fs::read_dir(&there).unwrap().count(), 1, "no other file");
        }
    }

    #[test]
    fn a_pipe_or_device_is_refused() {
        let folder = Folder::new();
        let link = folder.path("device.png");
        symlink("/dev/null", &link).unwrap();
        assert!(matches!(check(&link, Existing::Replace), Err(OutputError::NotAFile { .. })));
    }

    #[test]
    fn a_folder_one_may_not_write_in_is_named() {
        let folder = Folder::new();
        fs::set_permissions(folder.path(""), fs::Permissions::from_mode(0o555)).unwrap();
        // The superuser may write anywhere.
        if fs::write(folder.path("probe"), "").is_err() {
            let error = check(&folder.path("picture.png"), Existing::Replace).unwrap_err();
            assert!(matches!(&error, OutputError::FolderNotWritable { .. }), "{error}");
        }
        fs::set_permissions(folder.path(""), fs::Permissions::from_mode(0o755)).unwrap();
    }
}
