//! A scene's primitives, ready for the chosen intersection methods, which are dispatched once a batch of rays
//! and not once a ray.

use super::batch::Traversal;
use super::candidates::{AllSpheres, AllTriangles, ListedSpheres, ListedTriangles, SphereCandidates};
use super::hierarchy::{Hierarchy, padding_of};
use super::linear::{self, Batch};
use super::methods::{BoxChoice, Methods, SphereChoice, TriangleChoice};
use super::primitive_list::PrimitiveList;
use crate::buffers::{Buffers, store_culled_spheres, store_triangles};
use crate::bvh::Trees;
use crate::kernel::ray_box::Padding;
use crate::kernel::ray_sphere;
use crate::kernel::ray_triangle::{self, TriangleMethod};
use crate::kernel::sphere_culling::CulledSphere;
use crate::lane::Lane;
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

    /// The numbers of spheres and triangles that [`Primitives::trace_linear`] tests each ray against.
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

    /// Finds the nearest hits with the chosen methods, by testing every primitive; only without a hierarchy.
    /// `listed` holds all primitives that the rays can hit; without it every primitive is tested. In scenes
    /// without triangles no barycentric weights are stored.
    pub fn trace_linear<L: Lane>(
        &self,
        buffers: &Buffers,
        listed: Option<&PrimitiveList>,
        batch: &mut impl Batch<L>,
    ) {
        let [spheres, triangles] = self.linear(buffers, listed);
        // Without any candidate, the loop over none of the spheres stores the misses.
        if spheres > 0 || triangles == 0 {
            let all = AllSpheres { spheres: &buffers.spheres, culled: &self.culled_spheres };
            match listed {
                Some(PrimitiveList { spheres, .. }) => {
                    self.trace_spheres(&ListedSpheres { all, listed: spheres }, batch)
                }
                None => self.trace_spheres(&all, batch),
            }
        }
        let (first, after_spheres) = (buffers.spheres.len() as u32, spheres > 0);
        match &self.triangles {
            Triangles::Woop(stored) => {
                self.trace_triangles::<L, ray_triangle::Woop>((first, stored), listed, after_spheres, batch)
            }
            Triangles::MollerTrumbore(stored) => self.trace_triangles::<L, ray_triangle::MollerTrumbore>(
                (first, stored),
                listed,
                after_spheres,
                batch,
            ),
            Triangles::BaldwinWeber(stored) => self.trace_triangles::<L, ray_triangle::BaldwinWeber>(
                (first, stored),
                listed,
                after_spheres,
                batch,
            ),
        }
    }

    fn trace_spheres<L: Lane>(&self, spheres: &impl SphereCandidates, batch: &mut impl Batch<L>) {
        match self.sphere {
            SphereChoice::Robust => linear::trace_spheres::<L, ray_sphere::Robust>(spheres, batch),
            SphereChoice::Naive => linear::trace_spheres::<L, ray_sphere::Naive>(spheres, batch),
        }
    }

    fn trace_triangles<L: Lane, T: TriangleMethod>(
        &self,
        (first, triangles): (u32, &[T::Stored]),
        listed: Option<&PrimitiveList>,
        after_spheres: bool,
        batch: &mut impl Batch<L>,
    ) {
        if triangles.is_empty() {
            return;
        }
        let all = AllTriangles { first, triangles };
        match listed {
            Some(PrimitiveList { triangles, .. }) if triangles.is_empty() => {
                for at in batch.range().step_by(L::WIDTH) {
                    batch.store_barycentrics(at, L::zero(), L::zero());
                }
            }
            Some(PrimitiveList { triangles, .. }) => {
                let listed = ListedTriangles { all, listed: triangles };
                linear::trace_triangles::<L, T>(&listed, self.padding, after_spheres, batch);
            }
            None => linear::trace_triangles::<L, T>(&all, self.padding, after_spheres, batch),
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
