//! Arrays of plain data that hold a vector together with their clones, or share the memory of a
//! mapped file.

use std::fmt::{self, Debug, Formatter};
use std::marker::PhantomData;
use std::ops::{Deref, Range};
use std::ptr::NonNull;
use std::sync::Arc;

use bytemuck::Pod;

use super::block::Block;

/// An array that is read as a slice. It holds a [`Vec`], or is a part of a mapped scene file, which
/// it keeps mapped. Clones share the memory.
///
/// ```
/// use firsthit::shape::Storage;
///
/// let numbers = Storage::from(vec![1, 2, 3]);
/// assert_eq!(numbers[1..], [2, 3]);
/// assert_eq!(numbers.into_vec(), [1, 2, 3]);
/// ```
pub struct Storage<T> {
    start: NonNull<T>,
    length: usize,
    owner: Owner<T>,
    elements: PhantomData<T>,
}

/// The owner of the memory, which the last clone gives back.
enum Owner<T> {
    Vec(Arc<Vec<T>>),
    Block(Arc<Block>),
}

impl<T> Clone for Owner<T> {
    fn clone(&self) -> Self {
        match self {
            Self::Vec(vec) => Self::Vec(Arc::clone(vec)),
            Self::Block(block) => Self::Block(Arc::clone(block)),
        }
    }
}

// SAFETY: it gives its elements out as a shared vector does, and a block may go to any thread.
unsafe impl<T: Send + Sync> Send for Storage<T> {}
// SAFETY: as above; there is no way to change an element by a shared reference.
unsafe impl<T: Send + Sync> Sync for Storage<T> {}

impl<T> From<Vec<T>> for Storage<T> {
    fn from(vec: Vec<T>) -> Self {
        let vec = Arc::new(vec);
        let elements = NonNull::from(vec.as_slice());
        Self {
            start: elements.cast(),
            length: elements.len(),
            owner: Owner::Vec(vec),
            elements: PhantomData,
        }
    }
}

impl<T> Deref for Storage<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: that many elements from there on are the vector's of `From`, or the slice's of
        // `part`, and live as long as the owner. They do not change meanwhile: `edit` does only
        // while there is no element here.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.length) }
    }
}

impl<T> Storage<T> {
    /// The elements as a vector: its own, or a copy of shared ones.
    pub fn into_vec(self) -> Vec<T>
    where
        T: Clone,
    {
        match self.owner {
            Owner::Vec(vec) => Arc::unwrap_or_clone(vec),
            Owner::Block(_) => self.to_vec(),
        }
    }

    /// Whether it is a part of a mapped file.
    pub fn is_shared(&self) -> bool {
        matches!(self.owner, Owner::Block(_))
    }

    /// Changes the elements as a vector, copied first where others share them.
    #[doc(hidden)]
    pub fn edit<R>(&mut self, change: impl FnOnce(&mut Vec<T>) -> R) -> R
    where
        T: Clone,
    {
        if let Owner::Vec(vec) = &mut self.owner
            && let Some(vec) = Arc::get_mut(vec)
        {
            // Until the change is through: a panic may leave the vector elsewhere.
            self.length = 0;
            let result = change(vec);
            let elements = NonNull::from(vec.as_slice());
            (self.start, self.length) = (elements.cast(), elements.len());
            return result;
        }
        let mut vec = self.to_vec();
        let result = change(&mut vec);
        *self = vec.into();
        result
    }

    /// A part of a block; `None` where the range is not all there, or does not hold whole elements
    /// in aligned places.
    #[doc(hidden)]
    pub fn part(block: &Arc<Block>, range: Range<usize>) -> Option<Self>
    where
        T: Pod,
    {
        let bytes = block.bytes().get(range)?;
        let elements: &[T] = bytemuck::try_cast_slice(bytes).ok()?;
        Some(Self {
            start: NonNull::from(elements).cast(),
            length: elements.len(),
            owner: Owner::Block(Arc::clone(block)),
            elements: PhantomData,
        })
    }
}

impl<T> Default for Storage<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T> FromIterator<T> for Storage<T> {
    fn from_iter<I: IntoIterator<Item = T>>(elements: I) -> Self {
        elements.into_iter().collect::<Vec<T>>().into()
    }
}

impl<'a, T> IntoIterator for &'a Storage<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// Cloning shares the elements and copies none.
impl<T> Clone for Storage<T> {
    fn clone(&self) -> Self {
        Self {
            start: self.start,
            length: self.length,
            owner: self.owner.clone(),
            elements: PhantomData,
        }
    }
}

impl<T: PartialEq> PartialEq for Storage<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: Eq> Eq for Storage<T> {}

impl<T: Debug> Debug for Storage<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        Debug::fmt(&**self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_elements_are_those_of_the_vector() {
        let texts = vec!["a".to_owned(), "b".to_owned()];
        let mut storage = Storage::from(texts.clone());
        let copy = storage.clone();
        assert_eq!(copy.as_ptr(), storage.as_ptr(), "a clone copies nothing");
        storage.edit(|texts| texts.push("c".to_owned()));
        assert_eq!((&copy[..], storage.len()), (&texts[..], 3));
        storage.edit(|texts| texts.extend(vec!["d".to_owned(); 100]));
        assert_eq!((&storage[2][..], storage.len()), ("c", 103));
        assert_eq!(copy.into_vec(), texts);
        assert!(Storage::<u8>::default().is_empty());
    }

    #[test]
    fn a_change_that_panics_leaves_nothing_that_is_not_there() {
        let mut storage = Storage::from(vec![1; 8]);
        let change = std::panic::AssertUnwindSafe(|| {
            storage.edit(|numbers| {
                numbers.extend([2; 1000]);
                panic!("halfway");
            });
        });
        assert!(std::panic::catch_unwind(change).is_err());
        assert!(storage.is_empty());
    }

    #[test]
    fn shared_elements_outlive_the_block_s_other_holders() {
        let bytes: Vec<u8> = (0..64).collect();
        let block = Arc::new(Block::read(&bytes[..], 64).unwrap());
        let part: Storage<u32> = Storage::part(&block, 4..12).unwrap();
        drop(block);
        let copy = part.clone();
        drop(part);
        assert!(copy.is_shared());
        assert_eq!(copy.into_vec(), [0x0706_0504_u32, 0x0b0a_0908].map(u32::from_le));
    }

    #[test]
    fn only_whole_and_aligned_elements_are_parts() {
        let block = Arc::new(Block::read(&[0; 64][..], 64).unwrap());
        for wrong in [1..5, 0..6, 60..68, 64..68] {
            assert!(Storage::<u32>::part(&block, wrong).is_none());
        }
        assert_eq!(Storage::<u32>::part(&block, 64..64).unwrap().len(), 0);
    }
}
