//! One path, vertex by vertex, as plain data: in f32 from the engine, in f64 from the reference.

use serde::Serialize;

/// The end of a path's segment. If there is no primitive, distance, point and normal are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PathVertex<T> {
    /// The primitive, spheres first, in the scene's order, then triangles; `None` for the environment.
    pub primitive: Option<u32>,
    /// The name of the lobe that scatters the path (see [`lobe`]); `None` if the path ends.
    pub lobe: Option<&'static str>,
    /// The distance along the ray.
    pub distance: T,
    /// The point on the surface.
    pub point: [T; 3],
    /// The shading normal, on the side from which the ray arrives.
    pub normal: [T; 3],
    /// The product of weights on arrival.
    pub throughput: [T; 3],
    /// The emission that is added to `radiance`: times throughput and the MIS weight of BSDF sampling.
    pub emitted: [T; 3],
    /// The direction of the shadow ray to a light; `None` without one, and in the reference.
    pub light_direction: Option<[T; 3]>,
    /// The light that it adds to `radiance`: times throughput and MIS weight; 0 if it is occluded.
    pub light: Option<[T; 3]>,
    /// The path's radiance so far, this vertex included.
    pub radiance: [T; 3],
}

/// Returns the name of a lobe; that of a delta lobe has its side, by the scattered cosine with the normal.
pub fn lobe(is_delta: bool, cosine: f64) -> &'static str {
    match (is_delta, cosine < 0.0) {
        (false, _) => "reflection",
        (true, false) => "specular reflection",
        (true, true) => "specular transmission",
    }
}
