//! Instruction sets: those the program was compiled for, and those the machine has.
//!
//! For: [`compiled`], [`present`].
//!
//! The standard library's `is_x86_feature_detected!` cannot be used: for every feature that the program was
//! compiled for, it is true without a query, which is the case to detect. CPUID is read instead.

/// Target features: name, and whether the program was compiled for it.
macro_rules! compiled_features {
    ($($name:tt)*) => { [$(($name, cfg!(target_feature = $name))),*] };
}

/// The instruction sets that the program was compiled for, among those that matter to it.
pub fn compiled() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    let known = compiled_features!(
        "sse3" "ssse3" "sse4.1" "sse4.2" "popcnt" "avx" "avx2" "fma" "f16c" "bmi1" "bmi2" "lzcnt" "movbe" "adx" "gfni"
        "avx512f" "avx512bw" "avx512cd" "avx512dq" "avx512vl" "avx512vbmi" "avx512vbmi2" "avx512vnni" "avx512bitalg"
        "avx512vpopcntdq" "avx512ifma"
    );
    #[cfg(not(target_arch = "x86_64"))]
    let known = compiled_features!("neon" "sve" "sve2");
    known.into_iter().filter(|(_, enabled)| *enabled).map(|(name, _)| name).collect()
}

/// Those of the same instruction sets that this machine has and its operating system enables; `None` on
/// processors other than x86-64, where there is no query.
pub fn present() -> Option<Vec<&'static str>> {
    #[cfg(target_arch = "x86_64")]
    return Some(x86_64::present());
    #[cfg(not(target_arch = "x86_64"))]
    None
}

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use raw_cpuid::CpuId;

    // The bytes of register state that the operating system saves per thread show which registers it enables:
    // 512 + 64 for SSE and the header, 256 more for the upper halves of AVX registers, and at least 2432 once
    // AVX-512's are there (2688 on Intel; AMD packs them more tightly). Intel 64 manual, volume 1, section
    // 13.5; CPUID leaf 0Dh, EBX.
    const AVX_STATE: u32 = 832;
    const AVX512_STATE: u32 = 2_432;

    pub fn present() -> Vec<&'static str> {
        let cpu = CpuId::new();
        let mut found = Vec::new();
        let mut add = |name, has| {
            if has {
                found.push(name);
            }
        };
        let basic = cpu.get_feature_info();
        let basic = basic.as_ref();
        let switched_on = basic.is_some_and(|basic| basic.has_oxsave());
        let state = cpu.get_extended_state_info().map_or(0, |state| state.xsave_area_size_enabled_features());
        let avx = switched_on && state >= AVX_STATE;
        let avx512 = switched_on && state >= AVX512_STATE;
        if let Some(basic) = basic {
            add("sse3", basic.has_sse3());
            add("ssse3", basic.has_ssse3());
            add("sse4.1", basic.has_sse41());
            add("sse4.2", basic.has_sse42());
            add("popcnt", basic.has_popcnt());
            add("movbe", basic.has_movbe());
            add("avx", avx && basic.has_avx());
            add("fma", avx && basic.has_fma());
            add("f16c", avx && basic.has_f16c());
        }
        if let Some(more) = cpu.get_extended_feature_info() {
            add("avx2", avx && more.has_avx2());
            add("bmi1", more.has_bmi1());
            add("bmi2", more.has_bmi2());
            add("adx", more.has_adx());
            add("gfni", more.has_gfni());
            add("avx512f", avx512 && more.has_avx512f());
            add("avx512bw", avx512 && more.has_avx512bw());
            add("avx512cd", avx512 && more.has_avx512cd());
            add("avx512dq", avx512 && more.has_avx512dq());
            add("avx512vl", avx512 && more.has_avx512vl());
            add("avx512vbmi", avx512 && more.has_avx512vbmi());
            add("avx512vbmi2", avx512 && more.has_avx512vbmi2());
            add("avx512vnni", avx512 && more.has_avx512vnni());
            add("avx512bitalg", avx512 && more.has_avx512bitalg());
            add("avx512vpopcntdq", avx512 && more.has_avx512vpopcntdq());
            add("avx512ifma", avx512 && more.has_avx512_ifma());
        }
        if let Some(extended) = cpu.get_extended_processor_and_feature_identifiers() {
            add("lzcnt", extended.has_lzcnt());
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn present_includes_compiled_because_this_test_runs() {
        let Some(present) = present() else { return };
        for name in compiled() {
            assert!(present.contains(&name), "compiled for {name}, runs, and CPUID does not report it");
        }
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn present_agrees_with_the_standard_library() {
        // For features compiled in, the standard library does not query the machine; the others are the test.
        let present = present().unwrap();
        let agrees = |name, detected: bool| assert_eq!(present.contains(&name), detected, "{name}");
        agrees("sse4.2", std::is_x86_feature_detected!("sse4.2"));
        agrees("avx", std::is_x86_feature_detected!("avx"));
        agrees("avx2", std::is_x86_feature_detected!("avx2"));
        agrees("fma", std::is_x86_feature_detected!("fma"));
        agrees("f16c", std::is_x86_feature_detected!("f16c"));
        agrees("bmi2", std::is_x86_feature_detected!("bmi2"));
        agrees("lzcnt", std::is_x86_feature_detected!("lzcnt"));
        agrees("avx512f", std::is_x86_feature_detected!("avx512f"));
        agrees("avx512vbmi2", std::is_x86_feature_detected!("avx512vbmi2"));
        agrees("gfni", std::is_x86_feature_detected!("gfni"));
    }
}
