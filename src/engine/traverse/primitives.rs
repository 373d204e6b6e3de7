//! A scene's primitives, ready for the chosen intersection methods, which are dispatched once a batch of rays
//! and not once a ray.

use super::batch::Traversal;
use super::hierarchy::{Hierarchy, padding_of};
use super::linear::{self, All, Listed};
use super::methods::{BoxChoice, Methods, SphereChoice, TriangleChoice};
use super::primitive_list::PrimitiveList;
use crate::buffers::{Buffers, store_culled_spheres, store_triangles};
use crate::bvh::Trees;
use crate::kernel::ray_box::Padding;
use crate::kernel::ray_sphere::{self, SphereMethod};
use crate::kernel::ray_triangle::{self, TriangleMethod};
use crate::kernel::sphere_culling::CulledSphere;
use crate::lane::Lane;
use crate::math::{Hit, Ray};
use crate::scene::Scene;

/// The scene's triangles as the chosen method stores them.
enum Triangles {
    Woop(Vec<<ray_triangle::Woop as TriangleMethod>::Stored>),
    MollerTrumbore(Vec<<ray_triangle::MollerTrumbore as TriangleMethod>::Stored>),
    BaldwinWeber(Vec<<ray_triangle::BaldwinWeber as TriangleMethod>::Stored>),
}

/// A scene's primitives ready for intersection by the chosen methods.
pub struct Primitives {
    sphere: SphereChoice,
    triangles: Triangles,
    culled_spheres: Vec<CulledSphere>,
    padding: Padding,
    /// The hierarchy and its traversal, where there is one; then the other fields are empty.
    hierarchy: Option<(Hierarchy, Traversal)>,
}

/// A loop over a batch of rays, generic over the closest-hit function: closures cannot be generic.
pub trait Batch<L: Lane> {
    /// Calls `closest` for each ray.
    fn run(self, closest: impl Fn(&Ray<L>) -> Hit<L>);
}

impl Primitives {
    /// For packets of `lanes` rays, with a hierarchy if [`Methods::traversal_of`] names a traversal.
    pub fn new(scene: &Scene, methods: Methods, lanes: usize) -> Self {
        if let Some(traversal) = methods.traversal_of(scene, lanes) {
            let mut hierarchy = Hierarchy::new(scene, trees_of(traversal));
            hierarchy.padding = padded(hierarchy.padding, methods.boxes);
            return Self {
                sphere: methods.sphere,
                triangles: Triangles::Woop(Vec::new()),
                culled_spheres: Vec::new(),
                padding: Padding::default(),
                hierarchy: Some((hierarchy, traversal)),
            };
        }
        let triangles = match methods.triangle {
            TriangleChoice::Woop => Triangles::Woop(store_triangles::<ray_triangle::Woop>(scene)),
            TriangleChoice::MollerTrumbore => {
                Triangles::MollerTrumbore(store_triangles::<ray_triangle::MollerTrumbore>(scene))
            }
            TriangleChoice::BaldwinWeber => {
                Triangles::BaldwinWeber(store_triangles::<ray_triangle::BaldwinWeber>(scene))
            }
        };
        let padding = padded(padding_of(scene), methods.boxes);
        let culled_spheres = store_culled_spheres(scene);
        Self { sphere: methods.sphere, triangles, culled_spheres, padding, hierarchy: None }
    }

    /// The hierarchy and its traversal, where there is one: then [`super::batch::Tracer`] traces batches.
    #[inline(always)]
    pub fn hierarchy(&self) -> Option<(&Hierarchy, Traversal)> {
        self.hierarchy.as_ref().map(|(hierarchy, traversal)| (hierarchy, *traversal))
    }

    /// The padding of boxes.
    pub fn padding(&self) -> Padding {
        self.hierarchy.as_ref().map_or(self.padding, |(hierarchy, _)| hierarchy.padding)
    }

    /// The numbers of spheres and triangles that [`Primitives::for_batch`] tests each ray against.
    pub fn linear(&self, buffers: &Buffers, listed: Option<&PrimitiveList>) -> [usize; 2] {
        if let Some(listed) = listed {
            return [listed.spheres.len(), listed.triangles.len()];
        }
        let triangles = match &self.triangles {
            Triangles::Woop(stored) => stored.len(),
            Triangles::MollerTrumbore(stored) => stored.len(),
            Triangles::BaldwinWeber(stored) => stored.len(),
        };
        [buffers.spheres.len(), triangles]
    }

    /// Whether these are the default methods: only they are compiled into pipelines.
    #[inline(always)]
    pub fn uses_default_methods(&self) -> bool {
        self.sphere == SphereChoice::default() && matches!(self.triangles, Triangles::Woop(_))
    }

    /// Runs a batch of rays against every primitive with the chosen methods, each pair of methods compiled
    /// separately; only without a hierarchy. `listed` holds all primitives that the rays can hit; without it
    /// every primitive is tested.
    #[inline(always)]
    pub fn for_batch<L: Lane>(
        &self,
        buffers: &Buffers,
        listed: Option<&PrimitiveList>,
        batch: impl Batch<L>,
    ) {
        match self.sphere {
            SphereChoice::Robust => self.with_sphere::<L, ray_sphere::Robust>(buffers, listed, batch),
            SphereChoice::Naive => self.with_sphere::<L, ray_sphere::Naive>(buffers, listed, batch),
        }
    }

    /// [`Primitives::for_batch`] with the default methods alone: a sixth of its code.
    ///
    /// # Panics
    /// If another triangle method was chosen: not [`Primitives::uses_default_methods`].
    #[inline(always)]
    pub fn for_default_batch<L: Lane>(
        &self,
        buffers: &Buffers,
        listed: Option<&PrimitiveList>,
        batch: impl Batch<L>,
    ) {
        let Triangles::Woop(stored) = &self.triangles else {
            unreachable!("other methods than the default ones go through for_batch");
        };
        self.with_both::<L, ray_sphere::Robust, ray_triangle::Woop>(buffers, stored, listed, batch);
    }

    #[inline(always)]
    fn with_sphere<L: Lane, S: SphereMethod>(
        &self,
        buffers: &Buffers,
        listed: Option<&PrimitiveList>,
        batch: impl Batch<L>,
    ) {
        match &self.triangles {
            Triangles::Woop(stored) => {
                self.with_both::<L, S, ray_triangle::Woop>(buffers, stored, listed, batch)
            }
            Triangles::MollerTrumbore(stored) => {
                self.with_both::<L, S, ray_triangle::MollerTrumbore>(buffers, stored, listed, batch)
            }
            Triangles::BaldwinWeber(stored) => {
                self.with_both::<L, S, ray_triangle::BaldwinWeber>(buffers, stored, listed, batch)
            }
        }
    }

    #[inline(always)]
    fn with_both<L: Lane, S: SphereMethod, T: TriangleMethod>(
        &self,
        buffers: &Buffers,
        triangles: &[T::Stored],
        listed: Option<&PrimitiveList>,
        batch: impl Batch<L>,
    ) {
        let (culled_spheres, padding) = (self.culled_spheres.as_slice(), self.padding);
        let all = All { spheres: &buffers.spheres, culled_spheres, triangles };
        match listed {
            Some(listed) => {
                let listed = Listed { all, listed };
                batch.run(|ray| linear::closest::<L, S, T>(&listed, padding, ray));
            }
            None => batch.run(|ray| linear::closest::<L, S, T>(&all, padding, ray)),
        }
    }
}

/// The trees that a traversal reads.
pub(super) fn trees_of(traversal: Traversal) -> Trees {
    if traversal == Traversal::Scalar { Trees::WideAndBinary } else { Trees::Wide }
}

/// The padding with a box method.
fn padded(padding: Padding, boxes: BoxChoice) -> Padding {
    match boxes {
        BoxChoice::PaddedFma => padding,
        BoxChoice::Fma => padding.without_padding(),
    }
}
