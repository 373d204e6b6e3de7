//! Records what the program is built from and with: `OCTRAY_COMMIT`, `OCTRAY_RUSTC`, `OCTRAY_FLAGS`; and how
//! to build it for the machine at hand: `OCTRAY_REBUILD`. Never fails a build.

use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    // All files that go into the program, built-in scenes included: changes to them are the commit's
    // `+changes`.
    const SOURCES: [&str; 6] = ["src", "scenes", "build.rs", "Cargo.toml", "Cargo.lock", ".cargo"];
    let mut watched: Vec<PathBuf> = SOURCES.iter().map(PathBuf::from).collect();

    let commit = if is_checkout() { git(&["rev-parse", "--short=12", "HEAD"]) } else { None };
    let commit = commit.map(|commit| {
        // HEAD, its branch, and the log that changes with either, also where branches are packed.
        let branch = git(&["symbolic-ref", "-q", "HEAD"]);
        let heads = ["HEAD".to_string(), "logs/HEAD".to_string(), "packed-refs".to_string()];
        for name in heads.into_iter().chain(branch) {
            watched.extend(git(&["rev-parse", "--git-path", &name]).map(PathBuf::from));
        }
        let status = ["status", "--porcelain", "--untracked-files=no", "--"];
        let changes = git(&[&status[..], &SOURCES[..]].concat());
        if changes.is_some_and(|changes| !changes.is_empty()) { format!("{commit}+changes") } else { commit }
    });
    // A package from a registry has no `.cargo/config.toml`, and names its commit in this file.
    let package = std::fs::read_to_string(".cargo_vcs_info.json").ok();
    let commit = commit.or_else(|| {
        let (_, rest) = package.as_ref()?.split_once("\"sha1\": \"")?;
        rest.get(..12).map(str::to_owned)
    });
    let rebuild =
        if package.is_some() { "cargo install --locked --force octray" } else { "cargo build --release" };
    // As in `.cargo/config.toml`.
    let flags = "-C target-cpu=native -C force-frame-pointers=yes";
    println!("cargo:rustc-env=OCTRAY_REBUILD=RUSTFLAGS=\"{flags}\" {rebuild}");
    // Cargo counts a missing file as changed.
    for path in watched.iter().filter(|path| path.exists()) {
        println!("cargo:rerun-if-changed={}", path.display());
    }
    let compiler =
        std::env::var("RUSTC").ok().and_then(|rustc| output_of(Command::new(rustc).arg("--version")));
    // Cargo separates the flags by this character.
    let of_build = |name| std::env::var(name).unwrap_or_default().replace('\u{1f}', " ");
    let profile = [of_build("PROFILE"), of_build("CARGO_ENCODED_RUSTFLAGS")].join(" ");
    println!("cargo:rustc-env=OCTRAY_FLAGS=--profile {profile}");
    println!("cargo:rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    println!("cargo:rustc-env=OCTRAY_COMMIT={}", commit.as_deref().unwrap_or("unknown"));
    println!("cargo:rustc-env=OCTRAY_RUSTC={}", compiler.as_deref().unwrap_or("rustc (version unknown)"));
}

/// Is this folder a checkout of its own, not a folder inside another checkout?
fn is_checkout() -> bool {
    let here = std::env::var("CARGO_MANIFEST_DIR").ok().and_then(|here| Path::new(&here).canonicalize().ok());
    let top = git(&["rev-parse", "--show-toplevel"]).and_then(|top| Path::new(&top).canonicalize().ok());
    here.is_some() && here == top
}

fn git(arguments: &[&str]) -> Option<String> {
    // Without the first option `status` takes the index lock, which other git commands need; without the
    // other, git says nothing of a checkout of another user's. Whoever builds it runs its code anyway.
    output_of(Command::new("git").args(["--no-optional-locks", "-c", "safe.directory=*"]).args(arguments))
}

/// The standard output of a command that succeeds.
fn output_of(command: &mut Command) -> Option<String> {
    let output = command.output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_string())
}
