//! Asks where rays meet a mesh, exactly: `cargo run --release --example query_mesh`

use octray_rays::query::{MISS, Precision, Rays, Surfaces};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A pyramid with the corner (0, 0, 0), on a square. Coordinates are f64 or f32, as rows or as columns.
    let vertices = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0], [2.0, 2.0, 3.0]];
    let faces = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let mut surfaces = Surfaces::new();
    surfaces.add_mesh(&vertices, &faces)?;
    let pyramid = surfaces.build(Precision::Exact)?;

    // Straight down from a row of points: beside the pyramid, onto its sides, and onto its tip.
    let origins: Vec<[f64; 3]> = (0..6).map(|i| [f64::from(i) - 1.0, 2.0, 10.0]).collect();
    let directions = vec![[0.0, 0.0, -1.0]; origins.len()];
    let rays = Rays::new(&origins, &directions);

    let closest = pyramid.closest(&rays)?;
    let crossings = pyramid.count(&rays)?;
    for (at, [x, y, z]) in origins.iter().enumerate() {
        let (t, face) = (closest.t[at], closest.primitive[at]);
        match face {
            MISS => println!("at ({x}, {y}): nothing"),
            _ => println!("at ({x}, {y}): face {face} at height {}, {} crossings", z - t, crossings[at]),
        }
    }

    // The tip belongs to four faces, and the diagonal of the square to two.
    let all = pyramid.all_hits(&rays)?;
    let through_tip = all.offsets[3]..all.offsets[4];
    println!("through the tip: faces {:?}", &all.hits.primitive[through_tip]);
    println!("inside: {:?}", pyramid.contains(&[[2.0, 2.0, 1.0], [0.0, 0.0, 1.0]])?);
    Ok(())
}
