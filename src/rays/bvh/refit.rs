//! Refits a hierarchy to primitives that have moved.

use super::bounds::Bounds;
use super::tree::Bvh;

impl Bvh {
    /// Replaces the boxes by those around the primitives' present boxes. The tree stays as it was built: the
    /// further primitives move from their neighbours, the slower are queries.
    ///
    /// # Panics
    /// If the hierarchy has a binary tree.
    pub fn refit(&mut self, bounds: impl Fn(usize) -> Bounds) {
        assert!(self.binary.is_empty(), "only the wide tree can be refitted");
        let union = |boxes: &mut dyn Iterator<Item = Bounds>| boxes.fold(Bounds::EMPTY, Bounds::union);
        // Children follow their parents.
        for index in (0..self.wide.len()).rev() {
            let children = *self.wide[index].children();
            for (slot, &child) in children[..self.wide[index].filled()].iter().enumerate() {
                let bounds = match child.is_leaf() {
                    true => {
                        let primitives = self.leaf(child).primitives().iter();
                        union(&mut primitives.map(|&primitive| bounds(primitive as usize)))
                    }
                    false => {
                        let node = &self.wide[child.index()];
                        union(&mut (0..node.filled()).map(|slot| node.bounds(slot)))
                    }
                };
                self.wide[index].set(slot, bounds, child);
            }
        }
        let root = &self.wide[0];
        self.bounds = union(&mut (0..root.filled()).map(|slot| root.bounds(slot)));
    }
}
