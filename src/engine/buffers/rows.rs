//! Tables of rows that each lane reads at its own index.

use crate::lane::Lane;
use bytemuck::{Pod, Zeroable};

/// Eight floats, aligned for one vector load.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C, align(32))]
struct Row([f32; 8]);

/// A table of rows of eight floats, and a copy of its first eight rows as columns: a table that small is read
/// by register permutes, without a memory access per lane.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    rows: Vec<Row>,
    first_as_columns: [Row; 8],
}

impl Rows {
    /// Most rows that fit into registers as columns.
    pub const FEW: usize = 8;

    pub fn new(rows: impl Iterator<Item = [f32; 8]>) -> Self {
        let mut rows: Vec<Row> = rows.map(Row).collect();
        rows.shrink_to_fit();
        let mut first_as_columns = [Row([0.0; 8]); 8];
        for (index, row) in rows.iter().take(Self::FEW).enumerate() {
            for (column, value) in first_as_columns.iter_mut().zip(row.0) {
                column.0[index] = value;
            }
        }
        Self { rows, first_as_columns }
    }
    pub fn bytes(&self) -> usize {
        size_of_val(self.rows.as_slice())
    }
    /// Row `index` of each lane. `few` promises that the table has at most [`Rows::FEW`] rows; the result is
    /// the same with and without it.
    ///
    /// # Panics
    /// Without `few`, if an index in any lane is not below the number of rows.
    #[inline(always)]
    pub fn fetch<L: Lane>(&self, index: L::Bits, few: bool) -> [L; 8] {
        if few {
            std::array::from_fn(|column| L::pick(&self.first_as_columns[column].0, index))
        } else {
            L::gather_rows::<8>(bytemuck::cast_slice(&self.rows), index)
        }
    }
}
