//! Does this machine have the instruction sets that the program was compiled for?
//!
//! For: [`verdict`], called first in `main`, because a missing instruction ends a program without a message.
//!
//! Limit: this file is compiled with the same instruction sets as all others, and the compiler may use them
//! anywhere. It holds no loop over numbers, so the compiler has no reason to.

use super::error::{CliError, REBUILD};
use super::terminal;
use crate::machine::features;

/// The instruction sets that speed up packets most.
const WORTH_REBUILDING: [&str; 3] = ["avx2", "fma", "avx512f"];

/// The difference between program and machine.
#[derive(Clone, Debug, PartialEq, Eq)]
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
    let Some(present) = present else { return Verdict { missing: vec![], unused: vec![] } };
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
            Err(CliError::Machine { missing: self.missing.clone() })
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
    fn judge_finds_nothing_where_program_and_machine_agree() {
        let both = ["sse3", "avx", "avx2", "fma"];
        let verdict = judge(&both, Some(&both));
        assert_eq!(verdict, Verdict { missing: vec![], unused: vec![] });
        assert!(verdict.require().is_ok());
    }

    #[test]
    fn judge_names_every_missing_feature_in_order() {
        let verdict = judge(&["sse4.2", "avx2", "fma", "avx512f"], Some(&["sse4.2", "avx"]));
        assert_eq!(verdict.missing, ["avx2", "fma", "avx512f"]);
        let message = verdict.require().unwrap_err().to_string();
        assert!(message.contains("avx2, fma, avx512f") && message.contains(REBUILD), "{message}");
    }

    #[test]
    fn judge_advises_only_on_what_the_machine_has() {
        assert_eq!(judge(&[], Some(&["sse3", "avx", "avx2", "fma"])).unused, ["avx2", "fma"]);
        assert_eq!(judge(&["avx2"], Some(&["avx2", "fma"])).unused, ["fma"]);
        assert_eq!(
            judge(&["avx", "avx2", "fma"], Some(&["avx", "avx2", "fma", "avx512f"])).unused,
            ["avx512f"]
        );
        assert_eq!(judge(&[], Some(&["sse3"])), Verdict { missing: vec![], unused: vec![] });
    }

    #[test]
    fn judge_lets_unknown_machines_try() {
        assert!(judge(&["neon"], None).require().is_ok());
    }

    #[test]
    fn verdict_lets_this_machine_run_its_own_tests() {
        assert_eq!(verdict().missing, [""; 0]);
    }
}
