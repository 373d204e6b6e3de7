//! The bodies of the fuzz targets on what is committed for them: the seeds, and what was found and mended.

#[path = "../../fuzz/targets.rs"]
mod targets;

use octray::checkpoint::Checkpoint;
use std::fs;
use std::path::Path;

#[test]
fn fuzz_targets_pass_their_seeds_and_what_was_found() {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    for (name, target) in targets::TARGETS {
        let folders = ["seeds", "findings"].map(|folder| fuzz.join(folder).join(name));
        let files = folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten();
        let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        files.sort();
        assert!(!files.is_empty(), "{name} has seeds");
        for file in files {
            println!("{}", file.display());
            target(&fs::read(file).unwrap());
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
