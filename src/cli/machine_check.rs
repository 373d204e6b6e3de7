//! Checks that this machine has the instruction sets that the program was compiled for.
//!
//! Limit: this file is compiled with the same instruction sets as all others, and the compiler may use them
//! anywhere. It holds no loop over numbers, so the compiler has no reason to.

use super::error::{CliError, REBUILD};
use crate::machine::features;

/// The instruction sets that speed up packets most.
const WORTH_REBUILDING: [&str; 3] = ["avx2", "fma", "avx512f"];

/// Compares this program with this machine. Returns an error if the program cannot run here, and advice, for
/// commands whose speed matters, if a rebuild would be faster.
pub fn check() -> Result<Option<String>, CliError> {
    judge(&features::compiled(), features::present().as_deref())
}

/// Compares instruction sets; `present` is `None` on a machine that cannot be queried.
fn judge(compiled: &[&str], present: Option<&[&str]>) -> Result<Option<String>, CliError> {
    let Some(present) = present else { return Ok(None) };
    let missing: Vec<&str> = compiled.iter().copied().filter(|name| !present.contains(name)).collect();
    if !missing.is_empty() {
        return Err(CliError::Input(format!(
            "this octray was compiled for instructions that this machine does not have: {}\n  rebuild it here: {REBUILD}",
            missing.join(", ")
        )));
    }
    let is_unused = |name: &&str| present.contains(name) && !compiled.contains(name);
    let unused: Vec<&str> = WORTH_REBUILDING.into_iter().filter(is_unused).collect();
    let advice = || {
        let unused = unused.join(" and ");
        format!(
            "this machine has {unused}, which this octray was not compiled for.\n  for its full speed: {REBUILD}"
        )
    };
    Ok((!unused.is_empty()).then(advice))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn judge_names_what_is_missing_or_what_would_be_faster() {
        let present = ["sse3", "sse4.2", "avx", "avx2", "fma"];
        for (compiled, said) in [
            (&["sse3", "avx", "avx2", "fma"][..], ""),
            (&["avx512f", "neon"], "does not have: avx512f, neon"),
            (&["avx2"], "this machine has fma, which"),
            (&[], "this machine has avx2 and fma, which"),
        ] {
            let found = judge(compiled, Some(&present)).map(Option::unwrap_or_default);
            let found = found.unwrap_or_else(|error| error.to_string());
            assert!(found.contains(said) && found.is_empty() == said.is_empty(), "{compiled:?}: {found}");
        }
        assert!(judge(&["neon"], None).is_ok(), "unknown machines may try");
    }
}
