//! Every method of every family by name: the one list from which recipes, charts and tests take them.
//!
//! For: [`Method`], and a macro a family that runs a generic function over all of its methods, such as
//! `sphere_methods!(time)` for `fn time<S: SphereMethod>() -> f64`. May import: `kernel`. Must never know: what is done with them.

/// A method, and something that can be done with it.
#[derive(Clone, Copy, Debug)]
pub struct Method<F> {
    /// As the command line writes it, where it offers the method.
    pub name: &'static str,
    /// The one that pictures are made with, unless another is asked for.
    pub default: bool,
    pub run: F,
}

impl<F> Method<F> {
    pub const fn default(name: &'static str, run: F) -> Self {
        Self { name, default: true, run }
    }
    pub const fn other(name: &'static str, run: F) -> Self {
        Self { name, default: false, run }
    }
}

/// The array of [`Method`]s that hold this function for every [`SphereMethod`](crate::kernel::ray_sphere::SphereMethod).
macro_rules! sphere_methods {
    ($run:ident) => {
        $crate::measure::stability::methods::list!($run, ray_sphere;
            default "robust" Robust, other "robust-any-length" RobustAnyLength, other "naive" Naive)
    };
}

/// The same for every [`TriangleMethod`](crate::kernel::ray_triangle::TriangleMethod).
macro_rules! triangle_methods {
    ($run:ident) => {
        $crate::measure::stability::methods::list!($run, ray_triangle;
            default "woop" Woop, other "woop-contracted" WoopContracted, other "moller-trumbore" MollerTrumbore,
            other "moller-trumbore-epsilon" MollerTrumboreEpsilon, other "baldwin-weber" BaldwinWeber, other "plucker" Plucker)
    };
}

/// The same for every [`BoxMethod`](crate::kernel::ray_box::BoxMethod).
macro_rules! box_methods {
    ($run:ident) => {
        $crate::measure::stability::methods::list!($run, ray_box;
            default "padded-fma" Padded, other "by-sign" BySign, other "by-sign-2-ulp" BySignWidened, other "fma" Contracted,
            other "x86-min-max" X86MinMax, other "ieee-min-max" IeeeMinMax)
    };
}

/// Rows of `default|other "name" Type`, types in a module of `kernel`.
macro_rules! list {
    ($run:ident, $family:ident; $($role:ident $name:literal $method:ident),+) => {
        [$($crate::measure::stability::methods::Method::$role($name, $run::<$crate::kernel::$family::$method>)),+]
    };
}

pub(crate) use {box_methods, list, sphere_methods, triangle_methods};
