//! Loops over rows of pixels, parallel inside a pool of threads.

use octray_engine::lane::{F32x8, Lane};
use rayon::prelude::*;

/// Outside of a pool, parallel iterators would start rayon's global one.
fn in_a_pool() -> bool {
    rayon::current_thread_index().is_some()
}

/// Calls `row` with the index and the slice of every row of `length` values.
pub fn each<T: Send>(values: &mut [T], length: usize, row: impl Fn(usize, &mut [T]) + Sync) {
    match in_a_pool() {
        true => values.par_chunks_mut(length).enumerate().for_each(|(y, values)| row(y, values)),
        false => values.chunks_mut(length).enumerate().for_each(|(y, values)| row(y, values)),
    }
}

/// As [`each`], for the rows of two slices at once.
pub fn each_two<T: Send, U: Send>(
    (first, of_first): (&mut [T], usize),
    (second, of_second): (&mut [U], usize),
    row: impl Fn(usize, &mut [T], &mut [U]) + Sync,
) {
    let row = |(y, (first, second)): (usize, (&mut [T], &mut [U]))| row(y, first, second);
    match in_a_pool() {
        true => {
            let second = second.par_chunks_mut(of_second);
            first.par_chunks_mut(of_first).zip(second).enumerate().for_each(row);
        }
        false => first.chunks_mut(of_first).zip(second.chunks_mut(of_second)).enumerate().for_each(row),
    }
}

/// Eight values of a row from `at` on; 0 beyond its end.
#[inline(always)]
pub fn packet(row: &[f32], at: usize) -> F32x8 {
    match row.get(at..at + F32x8::WIDTH) {
        Some(whole) => F32x8::load(whole),
        None => F32x8::from_fn(|lane| row.get(at + lane).copied().unwrap_or(0.0)),
    }
}
