//! The list of all intersection methods by family and name, for test cases, charts and tests.
//!
//! `sphere_methods!(time)` instantiates `fn time<S: SphereMethod>() -> f64` for each method.

/// A method, and a function of it.
#[derive(Clone, Copy, Debug)]
pub struct Method<F> {
    /// The name on the command line, where it offers the method.
    pub name: &'static str,
    /// Whether this is the renderer's default.
    pub default: bool,
    /// What the test case, the chart or the test runs with it.
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

/// What each intersection method is, in the order of the lists below, the source included.
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
/// [`SphereMethod`](crate::kernel::ray_sphere::SphereMethod).
macro_rules! sphere_methods {
    ($run:ident) => {
        $crate::measure::stability::methods::list!($run;
            default "robust" Robust, other "robust-any-length" RobustAnyLength, other "naive" Naive)
    };
}

/// The same for every [`TriangleMethod`](crate::kernel::ray_triangle::TriangleMethod).
macro_rules! triangle_methods {
    ($run:ident) => {
        $crate::measure::stability::methods::list!($run;
            default "woop" Woop, other "woop-contracted" WoopContracted, other "moller-trumbore" MollerTrumbore,
            other "moller-trumbore-epsilon" MollerTrumboreEpsilon, other "baldwin-weber" BaldwinWeber, other "plucker" Plucker)
    };
}

/// The same for every [`BoxMethod`](crate::methods::BoxMethod).
macro_rules! box_methods {
    ($run:ident) => {
        $crate::measure::stability::methods::list!($run;
            default "padded-fma" Padded, other "by-sign" BySign, other "by-sign-2-ulp" BySignWidened, other "fma" Contracted,
            other "x86-min-max" X86MinMax, other "ieee-min-max" IeeeMinMax)
    };
}

/// Rows of `default|other "name" Type`.
macro_rules! list {
    ($run:ident; $($role:ident $name:literal $method:ident),+) => {
        [$($crate::measure::stability::methods::Method::$role($name, $run::<$crate::methods::$method>)),+]
    };
}

pub(crate) use {box_methods, list, sphere_methods, triangle_methods};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::ray_sphere::SphereMethod;
    use crate::kernel::ray_triangle::TriangleMethod;
    use crate::methods::BoxMethod;

    fn sphere<S: SphereMethod>() {}
    fn triangle<T: TriangleMethod>() {}
    fn of_box<B: BoxMethod>() {}

    #[test]
    fn every_method_has_a_meaning() {
        let spheres: &[Method<fn()>] = &sphere_methods!(sphere);
        let names = [spheres, &triangle_methods!(triangle), &box_methods!(of_box)].concat();
        assert!(names.iter().map(|method| method.name).eq(MEANINGS.map(|(name, _)| name)));
    }
}
