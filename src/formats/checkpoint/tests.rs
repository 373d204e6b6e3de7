//! Tests checkpoints in memory: their bits, and damage of every kind.

use super::file::write;
use super::*;
use octray_engine::film::Film;
use octray_engine::render::{Renderer, Settings};
use octray_engine::tone::Tone;
use std::path::Path;

const SHARD: Shard = Shard { number: 2, count: 3 };

/// Returns the header and the film of a shard with two samples.
fn film() -> (Header, Film) {
    let scene = crate::scene::load("builtin:three").unwrap();
    let settings = Settings { resolution: [50, 20], ..Settings::of(&scene) };
    let renderer = Renderer::new(&scene, settings);
    let mut film = renderer.film_with_noise();
    film.keep_tiles(|number| SHARD.contains(number));
    renderer.add_samples(&mut film, 2);
    let identity = Identity::new(&scene, &settings, None, SHARD);
    let (name, display) = (scene.name, Tone::default());
    (Header { name, identity, display, wanted: 7, complete: false, rays: 0, tiles: 0, guides: 0 }, film)
}

fn empty() -> Film {
    Film::new([50, 20], [16, 16]).with_noise()
}

fn words(film: &Film) -> Vec<u32> {
    let mut words = Vec::new();
    let tiles = film.tiles().iter().filter(|sums| SHARD.contains(sums.tile.number));
    tiles.for_each(|sums| sums.words_into(&mut words));
    words
}

fn bytes_of(header: &Header, film: &Film, goals: &[u32]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&mut bytes, header, film, goals, &Vec::new()).unwrap();
    bytes
}

fn written() -> (Vec<u8>, Film) {
    let (header, film) = film();
    (bytes_of(&header, &film, &[0, 5, 0, 0, 4]), film)
}

fn read(bytes: &[u8]) -> Result<(Header, Film, Vec<u32>), CheckpointError> {
    let checkpoint = Checkpoint::read(bytes, Path::new("c"))?;
    let (header, mut film) = (checkpoint.header.clone(), empty());
    checkpoint.fill(&mut film).map(|goals| (header, film, goals))
}

#[test]
fn checkpoint_is_read_as_it_was_written() {
    let (bytes, film) = written();
    let (header, found, goals) = read(&bytes).unwrap();
    assert_eq!((header.wanted, header.complete, header.rays, header.tiles), (7, false, film.rays(), 3));
    assert_eq!(
        (words(&found), found.rays(), goals),
        (words(&film), film.rays(), vec![0, 5, 0, 0, 4, 0, 0, 2])
    );
    assert_eq!(found.pixel_samples(), film.pixel_samples());
}

#[test]
fn every_damage_is_seen() {
    let (bytes, _) = written();
    for length in (0..200).chain([bytes.len() - 5, bytes.len() - 1]) {
        assert!(read(&bytes[..length]).is_err(), "the first {length} bytes");
    }
    let longer = [&bytes[..], &[0]].concat();
    assert!(read(&longer).is_err_and(|error| error.to_string().contains("follows its end")));
    // All bytes before the sums, and some of the sums.
    for at in (0..bytes.len()).filter(|at| *at < 1200 || at % 97 == 0) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        if let Ok((header, ..)) = read(&damaged) {
            panic!("a change of bit {} of byte {at} is not found: {header:?}", at % 8);
        }
    }
}

#[test]
fn goals_above_the_limit_of_samples_are_refused() {
    let (mut header, film) = film();
    header.identity.settings.target = Some((0.1, 1, 4));
    for (goal, fits) in [(4, true), (5, false)] {
        let bytes = bytes_of(&header, &film, &[0, goal, 0, 0, 4]);
        let read = Checkpoint::read(&bytes[..], Path::new("c")).unwrap().fill(&mut empty());
        assert_eq!(read.is_ok(), fits, "{goal}");
    }
}

#[test]
fn headers_that_lie_are_refused() {
    let (header, film) = film();
    let said = |change: &dyn Fn(&mut Header)| {
        let mut header = header.clone();
        change(&mut header);
        read(&bytes_of(&header, &film, &[])).err().unwrap().to_string()
    };
    for (width, height) in [(0, 20), (50, 0), (50, 16_385)] {
        let said = said(&|header| header.identity.settings.resolution = [width, height]);
        assert!(said.contains("its resolution is impossible"), "{said}");
    }
    for tile in [[0, 16], [16, 16_385], [16_384, 16_384]] {
        let said = said(&|header| header.identity.settings.tile_size = tile);
        assert!(said.contains("its resolution is impossible"), "{said}");
    }
    for (number, count) in [(0, 3), (4, 3), (0, 0)] {
        let said = said(&|header| header.identity.shard = Shard { number, count });
        assert!(said.contains("its shard is impossible"), "{said}");
    }
    let whole = said(&|header| header.identity.shard = Shard::WHOLE);
    assert!(whole.contains("it has 3 tiles instead of 8"), "{whole}");
    let first = said(&|header| header.identity.shard.number = 1);
    assert!(first.contains("tile 1 is not where it should be"), "{first}");
    let (mut long, _) = written();
    long[12..16].copy_from_slice(&(1_u32 << 30).to_le_bytes());
    assert!(read(&long).is_err_and(|error| error.to_string().contains("its header is too long")));
}

#[test]
fn files_shorter_than_their_tiles_are_refused_when_they_are_opened() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("c.part");
    let (mut header, film) = film();
    header.identity.settings.resolution = [16_384, 16_384];
    std::fs::write(&path, bytes_of(&header, &film, &[])).unwrap();
    let error = Checkpoint::open(&path).err().unwrap();
    assert!(error.to_string().contains("it ends too early"), "{error}");
}

#[test]
fn discarded_samples_are_kept() {
    let (header, mut film) = film();
    let sums = film.tiles_mut().iter_mut().find(|sums| SHARD.contains(sums.tile.number)).unwrap();
    let words_of_ones = vec![1; sums.words(true)];
    sums.restore(2, true, &words_of_ones);
    let (_, found, _) = read(&bytes_of(&header, &film, &[])).unwrap();
    assert_eq!((words(&found), found.discarded()), (words(&film), film.discarded()));
    assert!(film.discarded() > 0);
}
