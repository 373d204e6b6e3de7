//! The extension module `_octray`, on which the Python package `octray` is built: it takes and returns NumPy
//! arrays, and the package checks and converts what users give.
//!
//! | module | what it holds |
//! |---|---|
//! | `pool` | threads, and long work in parts |
//! | `mesh` | meshes, and queries about rays and points |
//! | `render` | pictures of scenes |

#![forbid(unsafe_code)]

mod mesh;
mod pool;
mod render;

use pyo3::prelude::*;

/// Returns the best of the processor levels "v2", "v3" and "v4" (x86-64's) that this machine has.
#[pyfunction]
fn level() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        macro_rules! has {
            ($($feature:tt),*) => { true $(&& std::arch::is_x86_feature_detected!($feature))* };
        }
        if has!("avx2", "fma", "bmi1", "bmi2", "f16c", "lzcnt", "movbe") {
            let is_v4 = has!("avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl");
            return if is_v4 { "v4" } else { "v3" };
        }
    }
    "v2"
}

#[pymodule]
fn _octray(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<mesh::Mesh>()?;
    module.add_function(wrap_pyfunction!(level, module)?)?;
    module.add_function(wrap_pyfunction!(render::render, module)?)?;
    module.add_function(wrap_pyfunction!(render::encode_png, module)?)
}
