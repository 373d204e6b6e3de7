//! One path, vertex by vertex, as plain data: in f32 from the engine, in f64 from the reference.

use serde::Serialize;

/// The end of a path's segment. Without a primitive, distance, point and normal are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PathVertex<T> {
    /// Spheres first, in the scene's order, then triangles; `None` for the environment.
    pub primitive: Option<u32>,
    /// The name of the lobe that scatters the path: see [`lobe`]; `None` where it ends.
    pub lobe: Option<&'static str>,
    /// Along the ray.
    pub distance: T,
    /// On the surface.
    pub point: [T; 3],
    /// Shading normal, on the side from which the ray arrives.
    pub normal: [T; 3],
    /// The product of weights on arrival.
    pub throughput: [T; 3],
    /// What emission adds to `radiance`: times throughput and the MIS weight of BSDF sampling.
    pub emitted: [T; 3],
    /// Of the shadow ray of next event estimation; `None` without one, and in the reference.
    pub light_direction: Option<[T; 3]>,
    /// What that light adds to `radiance`: times throughput and MIS weight; 0 where it is occluded.
    pub light: Option<[T; 3]>,
    /// The path's radiance so far, this vertex included.
    pub radiance: [T; 3],
}

/// The name of a lobe; of a delta lobe also the side, by the scattered direction's cosine with the normal.
pub fn lobe(is_delta: bool, cosine: f64) -> &'static str {
    match (is_delta, cosine < 0.0) {
        (false, _) => "reflection",
        (true, false) => "specular reflection",
        (true, true) => "specular transmission",
    }
}
