//! The machine and the build a figure was measured with.

pub(crate) mod features;

use crate::wording::counted;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The origin of a figure: figures are comparable only if their machines are equal.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's model name.
    pub cpu: String,
    /// Hardware threads available to this process.
    pub cores: usize,
    /// Instruction sets that the program was compiled for.
    pub target_features: Vec<String>,
    /// Version of the compiler.
    pub rustc: String,
    /// Cargo's profile and the compiler's flags.
    pub flags: String,
    /// Commit of the source, with `+changes` where files differed from it; `unknown` outside a checkout.
    pub commit: String,
}

impl Machine {
    /// This machine and this build.
    pub fn current() -> Self {
        Self {
            cpu: cpu(),
            cores: cores(),
            target_features: features::compiled().into_iter().map(String::from).collect(),
            rustc: env!("OCTRAY_RUSTC").into(),
            flags: env!("OCTRAY_FLAGS").into(),
            commit: env!("OCTRAY_COMMIT").into(),
        }
    }
}

/// Formats the machine and the build in one line.
impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { cpu, cores, target_features, rustc, commit, .. } = self;
        let vector = ["avx512f", "avx2", "fma", "sse4.1"]
            .into_iter()
            .find(|name| target_features.iter().any(|known| known == name));
        let vector = vector.unwrap_or("plain x86-64");
        let cores = counted(cores, "core", "cores");
        write!(f, "{cpu}, {cores}, built for {vector} by {rustc}, commit {commit}")
    }
}

/// Returns the number of hardware threads available to this process: at least 1.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Returns the bytes available without swapping, by the system's own estimate; `None` on systems other than
/// Linux, where there is no query.
pub fn available_memory() -> Option<u64> {
    mem_available(&std::fs::read_to_string("/proc/meminfo").ok()?)
}

/// Reads `MemAvailable` in the text of `/proc/meminfo`, which counts in KiB.
fn mem_available(info: &str) -> Option<u64> {
    let line = info.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix(" kB")?.parse::<u64>().ok()?.checked_mul(1024)
}

fn cpu() -> String {
    #[cfg(target_arch = "x86_64")]
    if let Some(brand) = raw_cpuid::CpuId::new().get_processor_brand_string() {
        return brand.as_str().split_whitespace().collect::<Vec<_>>().join(" ");
    }
    std::env::consts::ARCH.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mem_available_is_read_in_bytes() {
        let info = "MemTotal:       24000000 kB\nMemFree:  1 kB\nMemAvailable:   16000000 kB\n";
        assert_eq!(mem_available(info), Some(16_384_000_000));
        assert_eq!(mem_available("MemTotal: 1 kB\n"), None);
        assert_eq!(mem_available("MemAvailable: many kB\n"), None);
        #[cfg(target_os = "linux")]
        assert!(available_memory().unwrap() > 1_000_000);
    }
}
