//! The bodies of the fuzz targets on what is committed for them: the seeds, and what was found and mended.

#[path = "../../fuzz/targets.rs"]
mod targets;

use octray::checkpoint::Checkpoint;
use octray::measure::stability::Rng;
use std::fs;
use std::path::Path;

#[test]
fn fuzz_targets_pass_their_seeds_changed_bytes_of_them_and_what_was_found() {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    for (name, target) in targets::TARGETS {
        let folders = ["seeds", "findings"].map(|folder| fuzz.join(folder).join(name));
        let files = folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten();
        let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        files.sort();
        assert!(!files.is_empty(), "{name} has seeds");
        // Few of each: the fuzzer tries millions.
        let mut rng = Rng(11);
        for file in files {
            println!("{}", file.display());
            let content = fs::read(file).unwrap();
            target(&content);
            for round in 0..50 {
                let mut changed = content.clone();
                for _ in 0..=round % 3 {
                    let at = rng.bits() as usize % changed.len().max(1);
                    // Digits become digits, so that numbers change and texts stay whole.
                    let [digit, any] = [b'0' + (rng.bits() % 10) as u8, rng.bits() as u8];
                    if let Some(byte) = changed.get_mut(at) {
                        *byte = if byte.is_ascii_digit() { digit } else { any };
                    }
                }
                target(&changed);
            }
        }
    }
}

#[test]
fn seeds_of_checkpoints_can_be_read() {
    // Else the fuzzer begins with files that are refused for their version.
    for name in ["whole", "shard", "noise"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/checkpoints").join(name);
        let bytes = fs::read(&file).unwrap();
        let read = Checkpoint::read(bytes.as_slice(), &file);
        assert!(read.is_ok(), "{name}: {}", read.err().unwrap());
    }
}
