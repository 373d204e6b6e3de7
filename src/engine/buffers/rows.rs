//! Tables of rows that each lane reads at its own index.

use crate::lane::Lane;
use bytemuck::{Pod, Zeroable};

/// Eight floats, aligned for one vector load.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C, align(32))]
struct Row([f32; 8]);

/// A table of rows of eight floats, and a copy of its first sixteen rows as columns: a table that small is
/// read by register permutes, without a memory access per lane.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    rows: Vec<Row>,
    first_as_columns: Columns,
}

#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Columns([[f32; Rows::COLUMN_LENGTH]; 8]);

impl Rows {
    /// The largest number of rows that fit as columns into registers of eight lanes.
    pub const FEW: usize = 8;
    /// The largest number of rows that are kept as columns.
    const COLUMN_LENGTH: usize = 16;

    /// Stores the rows, padded.
    pub fn new(rows: impl Iterator<Item = [f32; 8]>) -> Self {
        let mut rows: Vec<Row> = rows.map(Row).collect();
        rows.shrink_to_fit();
        let mut first_as_columns = Columns::default();
        for (index, row) in rows.iter().take(Self::COLUMN_LENGTH).enumerate() {
            for (column, value) in first_as_columns.0.iter_mut().zip(row.0) {
                column[index] = value;
            }
        }
        Self { rows, first_as_columns }
    }
    /// Tests whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
    /// Returns row `index` of each lane. `fits_registers` promises that the table has at most [`Rows::FEW`]
    /// rows; the result does not depend on it.
    ///
    /// # Panics
    /// Without `fits_registers`, if the table has more than sixteen rows and an index in any lane is not
    /// below their number.
    #[inline(always)]
    pub fn fetch<L: Lane>(&self, index: L::Bits, fits_registers: bool) -> [L; 8] {
        let columns = &self.first_as_columns.0;
        // A register of sixteen lanes loads a column of sixteen from memory unchanged.
        if fits_registers && L::WIDTH <= Self::FEW {
            columns.each_ref().map(|column| L::pick(column.first_chunk().expect("eight of sixteen"), index))
        } else if fits_registers || self.rows.len() <= Self::COLUMN_LENGTH {
            columns.each_ref().map(|column| L::pick_of_16(column, index))
        } else {
            L::gather_rows::<8>(bytemuck::cast_slice(&self.rows), index)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::{Bits, F32x8, F32x16};

    /// Tests tables of every size: in one register of eight, in one of sixteen or two, and in memory.
    #[test]
    fn every_row_is_fetched_at_every_width() {
        fn check<L: Lane>(count: u32) {
            let row = |index: u32| std::array::from_fn(|column| (index * 8 + column as u32) as f32);
            let rows = Rows::new((0..count).map(row));
            for shift in 0..count {
                let of = |lane: usize| (lane as u32 * 5 + shift) % count;
                for fits_registers in [false, count <= Rows::FEW as u32] {
                    let columns = rows.fetch::<L>(L::Bits::from_fn(of), fits_registers);
                    for lane in 0..L::WIDTH {
                        assert_eq!(columns.map(|column| column.get(lane)), row(of(lane)), "{count} rows");
                    }
                }
            }
        }
        for count in [1, 2, 7, 8, 9, 15, 16, 17, 40] {
            check::<f32>(count);
            check::<F32x8>(count);
            check::<F32x16>(count);
        }
    }
}
