//! The numbers of a file that was read, and the checks that all decoders share.

use super::super::metadata::{Encoding, Metadata};

/// The content of an output file that was read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Output {
    /// The channels, as numbers. Those of ours have the values that were written, misses included.
    pub arrays: Vec<Array>,
    /// The file's metadata; `None` for a file of another program.
    pub metadata: Option<Metadata>,
    /// The doubts about the file: a line each.
    pub notes: Vec<String>,
}

/// The numbers of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// The channel's name; `None` where the file does not tell it.
    pub name: Option<String>,
    /// `[rows, columns]`, or `[n]`; then the components, if there are several.
    pub shape: Vec<usize>,
    /// The number of components of each element.
    pub components: usize,
    /// The numbers, row by row.
    pub numbers: ArrayValues,
    /// The NumPy name of the type in the file.
    pub dtype: String,
    /// Whether they are bytes to look at, not values.
    pub is_picture: bool,
}

/// Numbers of any type, in one that holds them exactly.
#[derive(Debug, Clone, PartialEq)]
pub enum ArrayValues {
    /// Double precision.
    Float64(Vec<f64>),
    /// Single precision, or half.
    Float32(Vec<f32>),
    /// Whole numbers, and truth values as 0 and 1.
    Integer(Vec<i64>),
}

impl Array {
    /// Elements in this shape; several components are one more axis.
    pub(super) fn new(
        name: Option<&str>,
        mut shape: Vec<usize>,
        components: usize,
        numbers: ArrayValues,
        dtype: impl Into<String>,
        is_picture: bool,
    ) -> Self {
        if components > 1 {
            shape.push(components);
        }
        Self {
            name: name.map(str::to_owned),
            shape,
            components,
            numbers,
            dtype: dtype.into(),
            is_picture,
        }
    }
}

impl Output {
    /// The channel of that name.
    pub fn array(&self, name: &str) -> Option<&Array> {
        (self.arrays.iter()).find(|array| array.name.as_deref() == Some(name))
    }
}

impl ArrayValues {
    /// The number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Float64(values) => values.len(),
            Self::Float32(values) => values.len(),
            Self::Integer(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The metadata of a file as its text; those that cannot be read are a note, not an error: the
/// numbers are there all the same.
pub(super) fn metadata_of(text: Option<&str>, notes: &mut Vec<String>) -> Option<Metadata> {
    match Metadata::from_json(text?) {
        Ok(metadata) => Some(metadata),
        Err(what) => {
            notes.push(crate::error::escape_controls(&what));
            None
        }
    }
}

/// The channel of `metadata` that a file with one channel holds, and how it is stored.
pub(super) fn only_channel(metadata: Option<&Metadata>) -> Option<(&str, Encoding, Option<f64>)> {
    let [channel] = metadata?.channels.as_slice() else {
        return None;
    };
    let stored = channel.stored.as_ref()?;
    Some((&channel.name, stored.encoding, stored.scale))
}

/// The number of an array's elements, if its numbers fit into memory.
pub(super) fn elements(shape: &[u64], bytes_each: u64, most: u64) -> Result<usize, String> {
    let count = shape.iter().try_fold(1_u64, |n, &side| n.checked_mul(side));
    let fits = |count: &u64| count.checked_mul(bytes_each).is_some_and(|n| n <= most);
    (count.filter(fits))
        .and_then(|count| usize::try_from(count).ok())
        .ok_or_else(|| format!("{shape:?} numbers are over the limit of {most} bytes"))
}

/// `values` in memory, if there is room for `count` of them.
pub(super) fn collected<T>(
    count: usize,
    values: impl Iterator<Item = T>,
) -> Result<Vec<T>, String> {
    let mut all = Vec::new();
    all.try_reserve_exact(count)
        .map_err(|_| format!("no memory is free for its {count} numbers"))?;
    all.extend(values.take(count));
    Ok(all)
}
