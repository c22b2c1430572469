//! Arrays of plain data that have memory of their own, or share that of a mapped file.

use std::fmt::{self, Debug, Formatter};
use std::marker::PhantomData;
use std::mem::ManuallyDrop;
use std::ops::{Deref, Range};
use std::ptr::NonNull;
use std::sync::Arc;

use bytemuck::Pod;

use super::block::Block;

/// An array that is read as a slice. It owns its memory, as a [`Vec`] does, or is a part of a mapped scene file,
/// which it keeps mapped.
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
    owner: Owner,
    /// As a vector, it drops elements.
    elements: PhantomData<T>,
}

/// Who gives the memory back.
enum Owner {
    /// The storage itself: the memory is that of a vector with this capacity.
    Own { capacity: usize },
    /// The last one who holds the block.
    Shared(Arc<Block>),
}

// SAFETY: it gives its elements out as a vector does, and a block may go to any thread.
unsafe impl<T: Send> Send for Storage<T> {}
// SAFETY: as above; there is no way to change an element by a shared reference.
unsafe impl<T: Sync> Sync for Storage<T> {}

impl<T> From<Vec<T>> for Storage<T> {
    fn from(vec: Vec<T>) -> Self {
        let mut vec = ManuallyDrop::new(vec);
        Self {
            // Not from a slice, which would not be all of the vector's room.
            start: NonNull::new(vec.as_mut_ptr()).expect("a vector's pointer is not null"),
            length: vec.len(),
            owner: Owner::Own {
                capacity: vec.capacity(),
            },
            elements: PhantomData,
        }
    }
}

impl<T> Deref for Storage<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: so many elements from there on are the vector's of `From`, or the slice's of `part`, and live as long
        // as the owner. Nobody changes them meanwhile.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.length) }
    }
}

impl<T> Drop for Storage<T> {
    fn drop(&mut self) {
        if let Owner::Own { capacity } = self.owner {
            // SAFETY: these are the parts of the vector of `From`, which is nobody else's since.
            drop(unsafe { Vec::from_raw_parts(self.start.as_ptr(), self.length, capacity) });
        }
    }
}

impl<T> Storage<T> {
    /// The elements as a vector: its own, or a copy of shared ones.
    pub fn into_vec(self) -> Vec<T>
    where
        T: Clone,
    {
        let Owner::Own { capacity } = self.owner else {
            return self.to_vec();
        };
        let storage = ManuallyDrop::new(self);
        // SAFETY: these are the parts of the vector of `From`, and `storage` is not dropped.
        unsafe { Vec::from_raw_parts(storage.start.as_ptr(), storage.length, capacity) }
    }

    /// Whether it is a part of a mapped file.
    pub fn is_shared(&self) -> bool {
        matches!(self.owner, Owner::Shared(_))
    }

    /// Changes the elements as a vector.
    pub(crate) fn edit<R>(&mut self, change: impl FnOnce(&mut Vec<T>) -> R) -> R
    where
        T: Clone,
    {
        let mut vec = std::mem::take(self).into_vec();
        let result = change(&mut vec);
        *self = vec.into();
        result
    }

    /// A part of a block; `None` where the range is not all there, or does not hold whole elements in aligned places.
    pub(crate) fn part(block: &Arc<Block>, range: Range<usize>) -> Option<Self>
    where
        T: Pod,
    {
        let bytes = block.bytes().get(range)?;
        let elements: &[T] = bytemuck::try_cast_slice(bytes).ok()?;
        Some(Self {
            start: NonNull::from(elements).cast(),
            length: elements.len(),
            owner: Owner::Shared(Arc::clone(block)),
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

/// Of shared elements, no copy.
impl<T: Clone> Clone for Storage<T> {
    fn clone(&self) -> Self {
        match &self.owner {
            Owner::Own { .. } => self.to_vec().into(),
            Owner::Shared(block) => Self {
                start: self.start,
                length: self.length,
                owner: Owner::Shared(Arc::clone(block)),
                elements: PhantomData,
            },
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
        storage.edit(|texts| texts.push("c".to_owned()));
        assert_eq!((&copy[..], storage.len()), (&texts[..], 3));
        assert_eq!(copy.into_vec(), texts);
        assert!(Storage::<u8>::default().is_empty());
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
        assert_eq!(
            copy.into_vec(),
            [0x0706_0504_u32, 0x0b0a_0908].map(u32::from_le)
        );
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
