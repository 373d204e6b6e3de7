//! Finds what rays of one's own hit: `cargo run --release --example trace_rays`

use octray_engine::lane::INSTRUCTIONS;
use octray_engine::rays::{Hits, MISS, Rays, Structure, Tracer};
use octray_formats::scene::load;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = load("builtin:knot:20000")?;
    let structure = Structure::new(&scene.geometry());

    // A thousand parallel rays straight down, in columns, in the coordinates of the scene's file.
    const COUNT: usize = 1_000;
    let x: Vec<f32> = (0..COUNT).map(|i| i as f32 / COUNT as f32 * 4.0 - 2.0).collect();
    let [zero, up, down] = [0.0, 5.0, -1.0].map(|value| vec![value; COUNT]);
    let rays = Rays::new([&x, &up, &zero], [&zero, &down, &zero]);

    // `t` begins as the largest distance of interest, in lengths of the direction, `primitive` as a miss.
    let (mut t, mut primitive) = (vec![f32::INFINITY; COUNT], vec![MISS; COUNT]);
    let (mut u, mut v) = (vec![0.0; COUNT], vec![0.0; COUNT]);
    let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
    Tracer::new().closest(&structure, &rays, &mut hits);

    let found = primitive.iter().filter(|&&primitive| primitive != MISS).count();
    let highest = t.iter().fold(f32::INFINITY, |nearest, &t| nearest.min(t));
    println!("Compiled for {INSTRUCTIONS}.");
    println!("{found} of {COUNT} rays hit the knot; its highest point on the way is {:.3}", 5.0 - highest);
    Ok(())
}
