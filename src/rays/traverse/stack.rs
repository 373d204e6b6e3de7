//! The traversal stack: nodes and leaves still to visit, with the distances at which rays enter them.

use crate::bvh::{Child, MAX_STACK, WIDE};
use crate::lane::{Bits, Lane, Mask, Native, NativeBits, NativeMask};

/// Entries of the stack: a power of two, so that `& (CAPACITY - 1)` keeps every index inside without a bounds
/// check, and with a packet to spare for whole stores.
const CAPACITY: usize = 64 * WIDE;
const _: () = assert!(MAX_STACK + WIDE <= CAPACITY);

/// Working memory of a thread. The number of entries is kept by the traversal, in a register.
pub struct Stack {
    child: [u32; CAPACITY],
    near: [f32; CAPACITY],
}

impl Stack {
    /// An empty stack.
    pub fn new() -> Self {
        Self { child: [0; CAPACITY], near: [0.0; CAPACITY] }
    }

    /// Pushes those of a node's children that are set in `passes` at index `at`, by one compressed store, and
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

    /// The entry at an index: the child, and its entry distance.
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

/// Pops entries of a stack of `len` entries, read by `get`, until one is entered at `limit` or before; `None`
/// once the stack is empty.
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
