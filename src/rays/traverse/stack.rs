//! The traversal stack: the nodes and leaves still to visit, with the distances at which rays enter them.

use crate::bvh::{Child, MAX_STACK, WIDE};
use crate::lane::{Bits, Lane, Mask, Native, NativeBits, NativeMask};

/// The number of entries: a power of two, so that `& (CAPACITY - 1)` keeps every index inside without a
/// bounds check, with one packet to spare for whole stores.
const CAPACITY: usize = 64 * WIDE;
const _: () = assert!(MAX_STACK + WIDE <= CAPACITY);

/// The stack of one thread. The traversal keeps the number of entries, in a register.
pub struct Stack {
    child: [u32; CAPACITY],
    near: [f32; CAPACITY],
}

impl Stack {
    /// Creates an empty stack.
    pub fn new() -> Self {
        Self { child: [0; CAPACITY], near: [0.0; CAPACITY] }
    }

    /// Pushes the children of a node that are set in `passes` at index `at`, by one compressed store, and
    /// swaps the nearest to the top. Returns their number.
    #[inline(always)]
    pub fn push(&mut self, at: usize, children: &[Child; WIDE], near: Native, passes: NativeMask) -> usize {
        let children = NativeBits::load(bytemuck::cast_slice(children));
        children.compress(passes).store(&mut self.child[at & (CAPACITY - 1)..]);
        Native::from_bits(near.to_bits().compress(passes)).store(&mut self.near[at & (CAPACITY - 1)..]);
        let count = passes.count();
        if count > 1 {
            let last = at + count - 1;
            let mut nearest = last;
            for i in at..last {
                if self.near[i & (CAPACITY - 1)] < self.near[nearest & (CAPACITY - 1)] {
                    nearest = i;
                }
            }
            self.child.swap(nearest & (CAPACITY - 1), last & (CAPACITY - 1));
            self.near.swap(nearest & (CAPACITY - 1), last & (CAPACITY - 1));
        }
        count
    }

    /// Returns the entry at an index: the child, and its entry distance.
    #[inline(always)]
    pub fn get(&self, at: usize) -> (Child, f32) {
        (Child(self.child[at & (CAPACITY - 1)]), self.near[at & (CAPACITY - 1)])
    }
}

impl Default for Stack {
    fn default() -> Self {
        Self::new()
    }
}

/// Pops entries of a stack of `len` entries, read by `get`, until one has an entry distance up to `limit`.
/// Returns `None` once the stack is empty.
#[inline(always)]
pub fn pop_within<T>(len: &mut usize, limit: f32, get: impl Fn(usize) -> (T, f32)) -> Option<T> {
    while *len > 0 {
        *len -= 1;
        let (entry, near) = get(*len);
        if near <= limit {
            return Some(entry);
        }
    }
    None
}
