//! What many rays met.

use bytemuck::Zeroable;

use crate::error::Result;
use crate::geometry::{DVec2, Hit};
use crate::memory;
use crate::simd::Lanes;

/// What many rays met, an array for each quantity; see [`Hit`] for their meaning.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Hits {
    /// The rays' parameters, infinity for a miss.
    pub t: Vec<f64>,
    /// The objects' identifiers, -1 for a miss.
    pub object: Vec<i32>,
    /// The primitives' identifiers, -1 for a miss.
    pub primitive: Vec<i32>,
    /// The weights of a triangle's corners 1 and 2, else NaN.
    pub barycentric: Vec<DVec2>,
}

impl Hits {
    /// Makes room for so many, whatever they are.
    pub(super) fn fit(&mut self, count: usize) -> Result<()> {
        fit(&mut self.t, count)?;
        fit(&mut self.object, count)?;
        fit(&mut self.primitive, count)?;
        fit(&mut self.barycentric, count)
    }

    /// How many rays there were.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there were none.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// What the ray `index` met.
    ///
    /// # Panics
    ///
    /// When there was no such ray.
    pub fn get(&self, index: usize) -> Hit {
        Hit {
            t: self.t[index],
            object: self.object[index],
            primitive: self.primitive[index],
            barycentric: self.barycentric[index],
        }
    }
}

/// Makes a vector so long; its memory is used again where that is enough.
fn fit<T: Zeroable + Clone>(values: &mut Vec<T>, count: usize) -> Result<()> {
    if count <= values.capacity() {
        values.resize(count, T::zeroed());
        return Ok(());
    }
    // What is there goes first: there may not be room for both.
    *values = Vec::new();
    *values = memory::zeroed(count)?;
    Ok(())
}

/// Where hits go.
pub(super) struct Out<'a> {
    pub(super) t: &'a mut [f64],
    pub(super) object: &'a mut [i32],
    pub(super) primitive: &'a mut [i32],
    pub(super) barycentric: &'a mut [DVec2],
}

impl Out<'_> {
    /// Asks for the memory of hits that are written soon.
    #[inline(always)]
    pub(super) fn prefetch<L: Lanes>(&mut self, l: L, first: usize, count: usize) {
        let place = first..first + count;
        l.prefetch_to_write(&mut self.t[place.clone()]);
        l.prefetch_to_write(&mut self.object[place.clone()]);
        l.prefetch_to_write(&mut self.primitive[place.clone()]);
        l.prefetch_to_write(&mut self.barycentric[place]);
    }

    #[inline(always)]
    pub(super) fn put(&mut self, index: usize, hit: &Hit) {
        self.t[index] = hit.t;
        self.object[index] = hit.object;
        self.primitive[index] = hit.primitive;
        self.barycentric[index] = hit.barycentric;
    }

    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> Hit {
        Hit {
            t: self.t[index],
            object: self.object[index],
            primitive: self.primitive[index],
            barycentric: self.barycentric[index],
        }
    }
}
