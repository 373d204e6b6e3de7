//! Equations that know lanes and nothing else: values in, (mask, values) out.
//!
//! For: intersections ([`ray_sphere`], [`ray_triangle`], [`ray_box`]), scattering ([`bsdf`]), points on emitters ([`light`]), points on surfaces
//! ([`surface`]), normals for shading ([`normals`]) and
//! texture lookups ([`texture`]), several methods side by side. May import: `lane`, `math`, `sampling`. Must never know:
//! scenes, queues, pixels. Kernels allocate nothing, look nothing up and never panic.

pub mod bsdf;
pub mod light;
pub mod normals;
pub mod ray_box;
pub mod ray_sphere;
pub mod ray_triangle;
pub mod surface;
pub mod texture;
