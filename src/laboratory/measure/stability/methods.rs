//! The list of all intersection methods by family and name, for test cases, charts and tests.
//!
//! `all_methods!(sphere, time)` instantiates `fn time<S: SphereMethod>() -> f64` for each method.

/// A method, and a function of it.
#[derive(Clone, Copy, Debug)]
pub struct Method<F> {
    /// The name on the command line, where it offers the method.
    pub name: &'static str,
    /// Whether this is the renderer's default.
    pub default: bool,
    /// Function that the test case, the chart or the test runs with the method.
    pub run: F,
}

impl<F> Method<F> {
    pub(crate) const fn default(name: &'static str, run: F) -> Self {
        Self { name, default: true, run }
    }
    pub(crate) const fn other(name: &'static str, run: F) -> Self {
        Self { name, default: false, run }
    }
}

/// Explanation of each intersection method, in the order of the lists below, with its source.
pub const MEANINGS: [(&str, &str); 15] = [
    ("robust", "the discriminant from the distance of the line to the centre (Haines et al. 2019)"),
    ("robust-any-length", "the same for directions of any length"),
    ("naive", "the textbook quadratic formula"),
    (
        "woop",
        "edge functions in the ray's space, differences of two rounded products: watertight (Woop et al. 2013)",
    ),
    ("woop-contracted", "the same with FMA in the edge functions, as a contracting compiler makes it"),
    ("moller-trumbore", "Cramer's rule, without an epsilon on the determinant (Möller, Trumbore 1997)"),
    ("moller-trumbore-epsilon", "the same with the paper's epsilon, which drops small triangles"),
    ("baldwin-weber", "a stored map for each triangle (Baldwin, Weber 2016)"),
    ("plucker", "signed volumes that the ray spans with each edge (Shevtsov et al. 2007)"),
    ("padded-fma", "one FMA a plane, with padding that covers its rounding"),
    ("by-sign", "(p − o) · (1 / d), planes picked by the direction's sign (Williams et al. 2005)"),
    ("by-sign-2-ulp", "the same with the far distance widened by 2 ulp (Ize 2013)"),
    ("fma", "one FMA a plane, without padding"),
    ("x86-min-max", "planes ordered by the minimum and maximum of x86 (Kay, Kajiya 1986)"),
    ("ieee-min-max", "planes ordered by those of IEEE 754-2008, which ignore NaN"),
];

/// The array of [`Method`]s with this function for every
/// [`SphereMethod`](crate::methods::SphereMethod), [`TriangleMethod`](crate::methods::TriangleMethod) or
/// [`BoxMethod`](crate::methods::BoxMethod). The last rule has rows of `default|other "name" Type`.
macro_rules! all_methods {
    (sphere, $run:ident) => {
        $crate::measure::stability::methods::all_methods!($run;
            default "robust" Robust, other "robust-any-length" RobustAnyLength, other "naive" Naive)
    };
    (triangle, $run:ident) => {
        $crate::measure::stability::methods::all_methods!($run;
            default "woop" Woop, other "woop-contracted" WoopContracted, other "moller-trumbore" MollerTrumbore,
            other "moller-trumbore-epsilon" MollerTrumboreEpsilon, other "baldwin-weber" BaldwinWeber, other "plucker" Plucker)
    };
    (box, $run:ident) => {
        $crate::measure::stability::methods::all_methods!($run;
            default "padded-fma" Padded, other "by-sign" BySign, other "by-sign-2-ulp" BySignWidened, other "fma" Contracted,
            other "x86-min-max" X86MinMax, other "ieee-min-max" IeeeMinMax)
    };
    ($run:ident; $($role:ident $name:literal $method:ident),+) => {
        [$($crate::measure::stability::methods::Method::$role($name, $run::<$crate::methods::$method>)),+]
    };
}

pub(crate) use all_methods;
