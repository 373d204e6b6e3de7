//! Does this machine have the instruction sets that the program was compiled for?
//!
//! Limit: this file is compiled with the same instruction sets as all others, and the compiler may use them
//! anywhere. It holds no loop over numbers, so the compiler has no reason to.

use super::error::{CliError, REBUILD};
use super::terminal;
use crate::machine::features;

/// The instruction sets that speed up packets most.
const WORTH_REBUILDING: [&str; 3] = ["avx2", "fma", "avx512f"];

/// The difference between program and machine.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// Compiled for, but not on this machine: the program cannot run.
    pub missing: Vec<&'static str>,
    /// On this machine and worth using, but not compiled for: the program is slower than it could be.
    pub unused: Vec<&'static str>,
}

/// Compares this program with this machine.
pub fn verdict() -> Verdict {
    judge(&features::compiled(), features::present().as_deref())
}

/// Compares instruction sets; `None` is a machine that cannot be queried.
fn judge(compiled: &[&'static str], present: Option<&[&'static str]>) -> Verdict {
    let Some(present) = present else { return Verdict::default() };
    let without = |all: &[&'static str], some: &[&'static str]| {
        all.iter().copied().filter(|name| !some.contains(name)).collect::<Vec<_>>()
    };
    let mut unused = without(&WORTH_REBUILDING, compiled);
    unused.retain(|name| present.contains(name));
    Verdict { missing: without(compiled, present), unused }
}

impl Verdict {
    /// An error if the program cannot run here.
    pub fn require(&self) -> Result<(), CliError> {
        if self.missing.is_empty() {
            Ok(())
        } else {
            Err(CliError::Input(format!(
                "this octray was compiled for instructions that this machine does not have: {}\n  rebuild it here: {REBUILD}",
                self.missing.join(", ")
            )))
        }
    }

    /// Warns on standard error if a rebuild would be faster. For commands whose speed matters.
    pub fn advise(&self) {
        if !self.unused.is_empty() {
            terminal::warn(&format!(
                "this machine has {}, which this octray was not compiled for.\n  for its full speed: {REBUILD}",
                self.unused.join(" and ")
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn judge_names_what_is_missing_and_what_would_be_faster() {
        let present = ["sse3", "sse4.2", "avx", "avx2", "fma"];
        for (compiled, missing, unused) in [
            (&["sse3", "avx", "avx2", "fma"][..], &[][..], &[][..]),
            (&["sse4.2", "avx2", "fma", "avx512f"], &["avx512f"], &[]),
            (&["avx512f", "neon"], &["avx512f", "neon"], &["avx2", "fma"]),
            (&["avx2"], &[], &["fma"]),
            (&[], &[], &["avx2", "fma"]),
        ] {
            let verdict = Verdict { missing: missing.to_vec(), unused: unused.to_vec() };
            assert_eq!(judge(compiled, Some(&present)), verdict, "{compiled:?}");
            let error = verdict.require().err().map_or(String::new(), |error| error.to_string());
            let said = error.contains(&missing.join(", ")) && error.contains(REBUILD);
            assert!(said != missing.is_empty(), "{error}");
        }
        assert!(judge(&["neon"], None).require().is_ok(), "unknown machines may try");
    }
}
