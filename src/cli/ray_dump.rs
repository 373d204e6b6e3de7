//! Rays, hits and triangles as files, so that other programs can trace the same rays: `perf/README.md`
//! describes their format.

use crate::math::MISS;
use crate::measure::ray_sets::RaysWithHits;
use crate::output::{Existing, OutputError, write_atomically};
use crate::scene::Scene;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

const RAYS: &[u8; 8] = b"OCTRAYS1";
const TRIANGLES: &[u8; 8] = b"OCTRITR1";

/// Returns all files that are written into a folder.
pub fn files(folder: &Path) -> [PathBuf; 4] {
    ["primary.rays", "shadow.rays", "diffuse.rays", "triangles.bin"].map(|name| folder.join(name))
}

/// Writes all files into a folder.
pub fn write(folder: &Path, scene: &Scene, rays: &[RaysWithHits]) -> Result<(), OutputError> {
    for RaysWithHits { set, nearest } in rays {
        let path = folder.join(format!("{}.rays", set.kind.name()));
        write_atomically(&path, Existing::Replace, |file| {
            head(file, RAYS, set.len())?;
            for column in set.origin.iter().chain(&set.direction).chain([&set.t_max]) {
                floats(file, column.iter().copied())?;
            }
            let found = nearest.t.iter().zip(&nearest.primitive);
            floats(file, found.map(|(&t, &primitive)| if primitive == MISS { f32::INFINITY } else { t }))?;
            nearest.primitive.iter().try_for_each(|primitive| file.write_all(&primitive.to_le_bytes()))?;
            floats(file, nearest.u.iter().copied())?;
            floats(file, nearest.v.iter().copied())
        })?;
    }
    write_atomically(&folder.join("triangles.bin"), Existing::Replace, |file| {
        head(file, TRIANGLES, scene.triangles.len())?;
        let vertices = scene.triangles.iter().flat_map(|triangle| triangle.vertices);
        floats(file, vertices.flat_map(|vertex| vertex.to_array()))
    })
}

fn head(file: &mut impl Write, magic: &[u8; 8], count: usize) -> io::Result<()> {
    file.write_all(magic)?;
    file.write_all(&(count as u64).to_le_bytes())
}

fn floats(file: &mut impl Write, mut numbers: impl Iterator<Item = f32>) -> io::Result<()> {
    numbers.try_for_each(|number| file.write_all(&number.to_le_bytes()))
}
