//! The methods as tests of lists and hierarchies, with which a renderer traces its rays.

use super::{MollerTrumbore, Naive, Robust, SphereMethod, TriangleMethod, Woop};
use crate::kernel::ray_box::{BoxRay, Padding, own_box};
use crate::kernel::ray_triangle::TriangleHit;
use crate::lane::{F32x8, F32x16, Lane, Mask};
use crate::math::Vec3;
use crate::rays::{Geometry, Hits, PrimitiveTests, Rays, keep_if_nearer};
use crate::render::{Methods, Renderer, Settings, SphereChoice, TriangleChoice};
use crate::scene::Scene;
use std::marker::PhantomData;
use std::sync::Arc;

/// Builds a renderer with any intersection methods. [`Renderer::new`] has only the robust ones.
pub fn renderer(scene: &Scene, settings: Settings) -> Renderer {
    Renderer::with_tests(scene, settings, tests(&settings.methods, scene))
}

/// Returns the tests of a scene's primitives by these intersection methods; `None` for the robust ones, which
/// the engine has.
pub fn tests(methods: &Methods, scene: &Scene) -> Option<Arc<dyn PrimitiveTests>> {
    Some(match (methods.sphere, methods.triangle) {
        (SphereChoice::Robust, TriangleChoice::Woop) => return None,
        (SphereChoice::Robust, TriangleChoice::MollerTrumbore) => {
            Arc::new(MethodTests::<Robust, MollerTrumbore>::new(&scene.geometry()))
        }
        (SphereChoice::Naive, TriangleChoice::Woop) => {
            Arc::new(MethodTests::<Naive, Woop>::new(&scene.geometry()))
        }
        (SphereChoice::Naive, TriangleChoice::MollerTrumbore) => {
            Arc::new(MethodTests::<Naive, MollerTrumbore>::new(&scene.geometry()))
        }
    })
}

/// A geometry whose spheres one method tests, and whose triangles another.
pub struct MethodTests<S, T: TriangleMethod> {
    /// Centres and squared radii.
    spheres: Vec<(glam::Vec3, f32)>,
    triangles: Vec<T::Stored>,
    padding: Padding,
    of_spheres: PhantomData<S>,
}

impl<S: SphereMethod, T: TriangleMethod> MethodTests<S, T> {
    /// Stores the primitives for the methods.
    pub fn new(geometry: &Geometry) -> Self {
        Self {
            spheres: geometry.spheres.iter().map(|ball| (ball.center, ball.radius * ball.radius)).collect(),
            triangles: geometry.triangles.iter().map(|&vertices| T::store(vertices)).collect(),
            padding: geometry.padding(),
            of_spheres: PhantomData,
        }
    }

    /// Shapes: packets of `WIDTH` rays; one primitive at a time is broadcast to all lanes.
    fn improve_packets<L: Lane>(&self, rays: &Rays, hits: &mut Hits, primitives: &[u32]) {
        let first_triangle = self.spheres.len() as u32;
        let spheres = primitives.partition_point(|&number| number < first_triangle);
        let (spheres, triangles) = primitives.split_at(spheres);
        let endless = L::splat(f32::INFINITY);
        for at in (0..rays.len()).step_by(L::WIDTH) {
            let (ray, mut hit) = (rays.packet::<L>(at), hits.packet::<L>(at));
            let precalculated = S::precalculate(&ray);
            for &number in spheres {
                let (center, radius2) = self.spheres[number as usize];
                let (center, radius2) = (Vec3::splat(center), L::splat(radius2));
                let (mask, t) = S::test(&precalculated, center, radius2, endless);
                keep_if_nearer(mask, number, [t, L::zero(), L::zero()], &mut hit);
            }
            let precalculated = T::precalculate(&ray);
            for &number in triangles {
                let triangle = &self.triangles[(number - first_triangle) as usize];
                let TriangleHit { mut mask, mut t, u, v } = T::test(&precalculated, triangle, endless);
                if !mask.any() {
                    continue;
                }
                if let Some([lo, hi]) = T::own_box(triangle) {
                    let corners = (Vec3::splat(lo), Vec3::splat(hi));
                    (mask, t) = own_box(&BoxRay::new(&ray, self.padding), corners, mask, t, endless);
                }
                keep_if_nearer(mask, number, [t, u, v], &mut hit);
            }
            hits.store(at, &hit);
        }
    }
}

impl<S: SphereMethod, T: TriangleMethod> PrimitiveTests for MethodTests<S, T> {
    fn improve(&self, rays: &Rays, hits: &mut Hits, primitives: &[u32], lanes: usize) {
        match lanes {
            1 => self.improve_packets::<f32>(rays, hits, primitives),
            8 => self.improve_packets::<F32x8>(rays, hits, primitives),
            _ => self.improve_packets::<F32x16>(rays, hits, primitives),
        }
    }
}
