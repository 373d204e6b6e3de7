//! Kernels: equations over lanes. Values in, (mask, values) out.
//!
//! For: intersections ([`ray_sphere`], [`ray_triangle`], [`ray_box`]), culling of spheres
//! ([`sphere_culling`]), scattering ([`bsdf`]), light sampling ([`light`]), directions guided ([`guiding`])
//! to the strip around a light ([`border`]) and to its images in mirrors ([`mirror_image`]), points on
//! surfaces ([`surface`]), shading normals ([`normals`]), texture lookups ([`texture`]) and how wide they are
//! ([`ray_cone`]), several methods side by side. Kernels allocate nothing, look nothing up and never panic.

pub mod border;
pub mod bsdf;
pub mod guiding;
pub mod light;
pub mod mirror_image;
pub mod normals;
pub mod ray_box;
pub mod ray_cone;
pub mod ray_sphere;
pub mod ray_triangle;
pub mod sphere_culling;
pub mod surface;
pub mod texture;
