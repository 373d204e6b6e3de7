//! Computes vertex normals of meshes.

use glam::{DVec3, Vec3};
use octray_engine::math::portable;

/// Most triangles around a position: their pairs are compared. A position with more keeps flat normals.
const MOST_AROUND: usize = 1 << 10;

/// Returns the vertex normals of triangles: at each corner the mean of the normals of the triangles that have
/// the same position there, and whose normals differ from its own by at most so many degrees, weighted by
/// their angles at the position. It depends neither on how polygons are cut into triangles nor on their size.
///
/// Triangles without area have zero normals, and add nothing to others. Sums run in the order of the list.
///
/// Source: G. Thürmer, C. A. Wüthrich, "Computing Vertex Normals from Polygonal Facets", Journal of Graphics
/// Tools 3(1), 1998.
pub fn normals(triangles: &[[DVec3; 3]], degrees: f64) -> Vec<[Vec3; 3]> {
    let own: Vec<DVec3> =
        triangles.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a).normalize_or_zero()).collect();
    // Rounded cosines reach 1 and −1 at about these angles.
    let least = portable::cos(degrees.to_radians()).clamp(-1.0 + 1e-12, 1.0 - 1e-12);
    let least = if degrees == 180.0 { -2.0 } else { least };
    let mut corners: Vec<u32> = (0..3 * triangles.len() as u32).collect();
    let point = |corner: u32| triangles[corner as usize / 3][corner as usize % 3];
    // Adding 0 makes −0 the same as 0.
    let key = |corner: &u32| (point(*corner) + 0.0).to_array().map(f64::to_bits);
    corners.sort_by_key(|corner| (key(corner), *corner));
    let mut normals: Vec<[Vec3; 3]> = own.iter().map(|normal| [normal.as_vec3(); 3]).collect();
    for around in corners.chunk_by(|a, b| key(a) == key(b)).filter(|around| around.len() <= MOST_AROUND) {
        let weighted = |&corner: &u32| {
            let normal = own[corner as usize / 3];
            (normal, normal * angle(&triangles[corner as usize / 3], corner as usize % 3))
        };
        let weighted: Vec<(DVec3, DVec3)> = around.iter().map(weighted).collect();
        for (&corner, (normal, _)) in around.iter().zip(&weighted) {
            let near = weighted.iter().filter(|(other, _)| normal.dot(*other) >= least);
            let mean = near.map(|(_, part)| part).sum::<DVec3>().try_normalize().unwrap_or(*normal);
            normals[corner as usize / 3][corner as usize % 3] = mean.as_vec3();
        }
    }
    normals
}

/// Returns the angle of a triangle at a corner, in radians.
fn angle(triangle: &[DVec3; 3], corner: usize) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|next| triangle[(corner + next) % 3]);
    let [u, v] = [b - a, c - a].map(DVec3::normalize_or_zero);
    // Half the angle has the tangent |u − v| / |u + v|: W. Kahan, "How Futile are Mindless Assessments of
    // Roundoff in Floating-Point Computation?", 2006, §12.
    let (opposite, adjacent) = ((u - v).length(), (u + v).length());
    if opposite == 0.0 { 0.0 } else { 2.0 * portable::atan(opposite / adjacent) }
}
