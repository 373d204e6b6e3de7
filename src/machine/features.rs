//! Instruction sets: those the program was compiled for, and those the machine has.
//!
//! The standard library's `is_x86_feature_detected!` cannot be used: for every feature that the program was
//! compiled for, it is true without a query, which is the case to detect. CPUID is read instead.

/// An instruction set that matters to the program.
struct Feature {
    name: &'static str,
    /// Whether the program was compiled for it.
    is_compiled: bool,
    /// Whether the machine has it and its operating system enables it.
    is_present: bool,
}

/// A list of features: name, and whether the machine has it.
macro_rules! features {
    ($($name:tt: $is_present:expr,)*) => {
        vec![$(Feature { name: $name, is_compiled: cfg!(target_feature = $name), is_present: $is_present }),*]
    };
}

/// Returns the instruction sets that the program was compiled for, among those that matter to it.
pub fn compiled() -> Vec<&'static str> {
    known().iter().filter(|feature| feature.is_compiled).map(|feature| feature.name).collect()
}

/// Returns those of the same instruction sets that this machine has and its operating system enables; `None`
/// on processors other than x86-64, where there is no query.
pub fn present() -> Option<Vec<&'static str>> {
    let names = || known().iter().filter(|feature| feature.is_present).map(|feature| feature.name).collect();
    cfg!(target_arch = "x86_64").then(names)
}

#[cfg(not(target_arch = "x86_64"))]
fn known() -> Vec<Feature> {
    features!("neon": false, "sve": false, "sve2": false,)
}

#[cfg(target_arch = "x86_64")]
fn known() -> Vec<Feature> {
    use raw_cpuid::{CpuId, ExtendedFeatures, FeatureInfo};

    // The bytes of register state that the operating system saves per thread show which registers it enables:
    // 512 + 64 for SSE and the header, 256 more for the upper halves of AVX registers, and at least 2432 once
    // AVX-512's are there (2688 on Intel; AMD packs them more tightly). Intel 64 manual, volume 1, section
    // 13.5; CPUID leaf 0Dh, EBX.
    const AVX_STATE: u32 = 832;
    const AVX512_STATE: u32 = 2_432;

    let cpu = CpuId::new();
    let (basic, more) = (cpu.get_feature_info(), cpu.get_extended_feature_info());
    let basic = |has: fn(&FeatureInfo) -> bool| basic.as_ref().is_some_and(has);
    let more = |has: fn(&ExtendedFeatures) -> bool| more.as_ref().is_some_and(has);
    let state = cpu.get_extended_state_info().map_or(0, |state| state.xsave_area_size_enabled_features());
    let avx = basic(FeatureInfo::has_oxsave) && state >= AVX_STATE;
    let avx512 = avx && state >= AVX512_STATE;
    let lzcnt = cpu.get_extended_processor_and_feature_identifiers().is_some_and(|more| more.has_lzcnt());
    features!(
        "sse3": basic(FeatureInfo::has_sse3),
        "ssse3": basic(FeatureInfo::has_ssse3),
        "sse4.1": basic(FeatureInfo::has_sse41),
        "sse4.2": basic(FeatureInfo::has_sse42),
        "popcnt": basic(FeatureInfo::has_popcnt),
        "avx": avx && basic(FeatureInfo::has_avx),
        "avx2": avx && more(ExtendedFeatures::has_avx2),
        "fma": avx && basic(FeatureInfo::has_fma),
        "f16c": avx && basic(FeatureInfo::has_f16c),
        "bmi1": more(ExtendedFeatures::has_bmi1),
        "bmi2": more(ExtendedFeatures::has_bmi2),
        "lzcnt": lzcnt,
        "movbe": basic(FeatureInfo::has_movbe),
        "adx": more(ExtendedFeatures::has_adx),
        "gfni": more(ExtendedFeatures::has_gfni),
        "avx512f": avx512 && more(ExtendedFeatures::has_avx512f),
        "avx512bw": avx512 && more(ExtendedFeatures::has_avx512bw),
        "avx512cd": avx512 && more(ExtendedFeatures::has_avx512cd),
        "avx512dq": avx512 && more(ExtendedFeatures::has_avx512dq),
        "avx512vl": avx512 && more(ExtendedFeatures::has_avx512vl),
        "avx512vbmi": avx512 && more(ExtendedFeatures::has_avx512vbmi),
        "avx512vbmi2": avx512 && more(ExtendedFeatures::has_avx512vbmi2),
        "avx512vnni": avx512 && more(ExtendedFeatures::has_avx512vnni),
        "avx512bitalg": avx512 && more(ExtendedFeatures::has_avx512bitalg),
        "avx512vpopcntdq": avx512 && more(ExtendedFeatures::has_avx512vpopcntdq),
        "avx512ifma": avx512 && more(ExtendedFeatures::has_avx512_ifma),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

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
