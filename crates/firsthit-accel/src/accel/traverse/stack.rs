//! The stack of a traversal.

use crate::accel::build::binary::SAH_DEPTH;

/// Nodes and leaves still to be visited. An entry has the index in its lower half, and in its upper
/// half the bits of the depth, or a mask of a packet's rays.
#[derive(Debug)]
pub(in crate::accel) struct Stack {
    entries: Box<[u64; STACK]>,
    height: usize,
}

/// A tree has no more levels than the binary one it is made from: `SAH_DEPTH`, then 31 halvings of
/// at most 2^31 items, the leaf, and one to spare. A quick tree adds a level of lowest nodes to
/// such a tree, which has far fewer items.
pub(in crate::accel) const LEVELS: usize = SAH_DEPTH as usize + 33;
/// A power of two. The last entry is always the next, so each level leaves up to 15 behind, and the
/// lowest all 16.
const STACK: usize = 2048;
const _: () = assert!(15 * LEVELS + 1 < STACK);

impl Stack {
    pub(in crate::accel) fn new() -> Self {
        Self { entries: vec![0; STACK].try_into().expect("it has that length"), height: 0 }
    }

    #[inline(always)]
    pub(in crate::accel) fn clear(&mut self) {
        self.height = 0;
    }

    #[inline(always)]
    pub(in crate::accel) fn len(&self) -> usize {
        self.height
    }

    #[inline(always)]
    pub(in crate::accel) fn push(&mut self, key: u64) {
        debug_assert!(self.height < STACK, "a tree is not that deep");
        self.entries[self.height % STACK] = key;
        self.height += 1;
    }

    /// Pushes `key` if it `is` wanted, without a branch.
    #[inline(always)]
    pub(in crate::accel) fn push_if(&mut self, is: bool, key: u64) {
        debug_assert!(self.height < STACK, "a tree is not that deep");
        self.entries[self.height % STACK] = key;
        self.height += usize::from(is);
    }

    /// The entries from `base` on.
    #[inline(always)]
    pub(in crate::accel) fn entries_from(&self, base: usize) -> &[u64] {
        &self.entries[base.min(STACK)..self.height.min(STACK)]
    }

    /// Takes the last entry.
    #[inline(always)]
    pub(in crate::accel) fn pop(&mut self) -> Option<u64> {
        self.height = self.height.checked_sub(1)?;
        Some(self.entries[self.height % STACK])
    }

    /// Puts `key` among those from `base` on, the smallest on top.
    #[inline(always)]
    pub(in crate::accel) fn insert(&mut self, base: usize, key: u64) {
        debug_assert!(self.height < STACK, "a tree is not that deep");
        let mut at = self.height;
        while at > base && self.entries[(at - 1) % STACK] < key {
            self.entries[at % STACK] = self.entries[(at - 1) % STACK];
            at -= 1;
        }
        self.entries[at % STACK] = key;
        self.height += 1;
    }

    /// The next that is at a depth of at most `limit`: the depth, and what is there.
    #[inline(always)]
    pub(in crate::accel) fn pop_within(&mut self, limit: f32) -> Option<(f32, u32)> {
        loop {
            self.height = self.height.checked_sub(1)?;
            let key = self.entries[self.height % STACK];
            let depth = f32::from_bits((key >> 32) as u32);
            if depth <= limit {
                #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
                return Some((depth, key as u32));
            }
        }
    }

    #[inline(always)]
    pub(in crate::accel) fn top(&self) -> Option<u64> {
        Some(self.entries[self.height.checked_sub(1)? % STACK])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree as deep as one can be, with all sixteen children of each node met.
    #[test]
    fn the_stack_holds_what_is_left_of_the_deepest_tree() {
        let mut stack = Stack::new();
        stack.push(0);
        let mut highest = 0;
        // Only the way down: the entries of higher levels stay.
        for level in 0..LEVELS as u64 {
            assert_eq!(stack.pop(), Some(level));
            for _ in 0..16 {
                stack.push_if(true, level + 1);
            }
            highest = highest.max(stack.len());
            // An unwanted entry is written, but not kept.
            stack.push_if(false, 0);
        }
        assert_eq!(highest, 15 * LEVELS + 1);
    }
}
