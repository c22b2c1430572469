//! Accessors: arrays of numbers in the bytes of a document, each checked once and as a whole.

use super::super::fault::{Checked, Fault};
use super::super::report::Report;
use super::buffers::Buffers;
use super::document::{Accessor, Document};
use super::index::Index;
use super::place::Entry;
use super::problem::Problem;
use super::resource::Bytes;
use crate::geometry::single;

/// The type of a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Uint32,
    Float32,
}

impl Component {
    fn of(Index(code): Index) -> Option<Self> {
        Some(match code {
            5120 => Self::Int8,
            5121 => Self::Uint8,
            5122 => Self::Int16,
            5123 => Self::Uint16,
            5125 => Self::Uint32,
            5126 => Self::Float32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Int8 | Self::Uint8 => 1,
            Self::Int16 | Self::Uint16 => 2,
            Self::Uint32 | Self::Float32 => 4,
        }
    }

    /// The number that stands for one in a normalised number of this type.
    pub(super) fn largest(self) -> f64 {
        match self {
            Self::Int8 => f64::from(i8::MAX),
            Self::Uint8 => f64::from(u8::MAX),
            Self::Int16 => f64::from(i16::MAX),
            Self::Uint16 => f64::from(u16::MAX),
            Self::Uint32 => f64::from(u32::MAX),
            Self::Float32 => 1.0,
        }
    }

    pub(super) fn is_unsigned(self) -> bool {
        matches!(self, Self::Uint8 | Self::Uint16 | Self::Uint32)
    }
}

/// The type that elements are read as.
pub(super) trait Number: Copy + Default {
    fn from_single(value: f32) -> Self;
    /// The value of a whole number, or its share of `largest` where it is normalised.
    fn from_whole(value: i64, largest: Option<f64>) -> Self;
}

impl Number for f64 {
    fn from_single(value: f32) -> Self {
        value.into()
    }

    fn from_whole(value: i64, largest: Option<f64>) -> Self {
        let value = value as Self;
        largest.map_or(value, |largest| (value / largest).max(-1.0))
    }
}

impl Number for f32 {
    fn from_single(value: f32) -> Self {
        value
    }

    fn from_whole(value: i64, largest: Option<f64>) -> Self {
        single(f64::from_whole(value, largest))
    }
}

/// Indices are read from unsigned components that are not normalised.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the largest component is a u32"
)]
impl Number for u32 {
    fn from_single(value: f32) -> Self {
        value as Self
    }

    fn from_whole(value: i64, _largest: Option<f64>) -> Self {
        value as Self
    }
}

/// An accessor whose elements are all known to be there.
#[derive(Debug)]
pub(super) struct Elements<'a> {
    pub(super) entry: Entry,
    pub(super) count: usize,
    pub(super) component: Component,
    pub(super) normalized: bool,
    packed: Option<Packed<'a>>,
    sparse: Option<(Vec<usize>, Packed<'a>)>,
}

/// Elements in a row.
#[derive(Debug)]
struct Packed<'a> {
    bytes: Bytes<'a>,
    stride: usize,
}

/// The shape of an accessor's elements: the number of components, and its name.
pub(super) struct Shape {
    pub(super) components: usize,
    pub(super) name: &'static str,
}

impl Shape {
    const fn new(components: usize, name: &'static str) -> Self {
        Self { components, name }
    }

    pub(super) const SCALAR: Self = Self::new(1, "SCALAR");
    pub(super) const VEC2: Self = Self::new(2, "VEC2");
    pub(super) const VEC3: Self = Self::new(3, "VEC3");
    pub(super) const VEC4: Self = Self::new(4, "VEC4");
    pub(super) const MAT4: Self = Self::new(16, "MAT4");
}

pub(super) fn entry(Index(index): Index) -> Entry {
    Entry::new("accessors", index)
}

/// An accessor's declaration.
pub(super) fn declared<'a>(document: &'a Document<'a>, index: Index) -> Checked<&'a Accessor<'a>> {
    let accessor = document.accessors.get(index.0);
    accessor.ok_or_else(|| entry(index).fault("", "there is no such accessor"))
}

/// The type of an accessor's components.
pub(super) fn component(document: &Document<'_>, index: Index) -> Checked<Component> {
    let code = declared(document, index)?.component_type;
    let wrong = || {
        let Index(code) = code;
        let what = format!("must be one of 5120, 5121, 5122, 5123, 5125, 5126, got {code}");
        entry(index).fault("componentType", what)
    };
    Component::of(code).ok_or_else(wrong)
}

/// Whether an accessor's elements have a shape.
pub(super) fn has_shape(document: &Document<'_>, index: Index, shape: &Shape) -> bool {
    declared(document, index).is_ok_and(|accessor| accessor.kind == shape.name)
}

/// Refuses an accessor whose elements have another shape.
pub(super) fn check_shape(document: &Document<'_>, index: Index, shape: &Shape) -> Checked<()> {
    let kind = &declared(document, index)?.kind;
    if *kind == shape.name {
        return Ok(());
    }
    let kind = crate::error::escape_controls(kind);
    Err(entry(index).fault("type", format!("must be {} here, got {kind}", shape.name)))
}

impl<'a> Packed<'a> {
    /// The bytes of elements: a view, where in it they begin, and how many there are. The caller
    /// knows the place of these numbers.
    fn new(
        [view, Index(offset), Index(count)]: [Index; 3],
        size: usize,
        buffers: &mut Buffers<'a>,
        report: &mut Report,
    ) -> Result<Self, Problem> {
        let bytes = buffers.view(view, report)?;
        let stride = buffers.stride(view).unwrap_or(size);
        if stride < size {
            let what = format!("the view's byteStride is {stride}, an element has {size} bytes");
            return Err(what.into());
        }
        let needed = match count.checked_sub(1) {
            None => Some(0),
            Some(steps) => steps.checked_mul(stride).and_then(|start| start.checked_add(size)),
        };
        let part = needed.and_then(|needed| bytes.part(offset, needed));
        let bytes = part.ok_or_else(|| {
            let (view, there) = (view.0, bytes.get().len());
            format!(
                "{count} elements, {stride} bytes apart, from byte {offset} on: \
                 buffer view {view} has {there} bytes"
            )
        })?;
        Ok(Self { bytes, stride })
    }
}

impl<'a> Elements<'a> {
    /// Checks that all of an accessor is there.
    pub(super) fn new(
        document: &'a Document<'a>,
        index: Index,
        shape: &Shape,
        buffers: &mut Buffers<'a>,
        report: &mut Report,
    ) -> Checked<Self> {
        check_shape(document, index, shape)?;
        let accessor = declared(document, index)?;
        let component = component(document, index)?;
        let (entry, Index(count)) = (entry(index), accessor.count);
        let size = component.size() * shape.components;
        let mut packed = |extent, size, place: &str, report: &mut Report| {
            let packed = Packed::new(extent, size, buffers, report);
            packed.map_err(|problem| problem.at(entry.at(place)))
        };
        let whole = accessor.buffer_view.map(|view| {
            let extent = [view, accessor.byte_offset, accessor.count];
            packed(extent, size, "count", report)
        });
        let whole = whole.transpose()?;
        let sparse = match &accessor.sparse {
            None => None,
            Some(sparse) => {
                let kind = Component::of(sparse.indices.component_type);
                let kind = kind.filter(|kind| kind.is_unsigned()).ok_or_else(|| {
                    let code = sparse.indices.component_type.0;
                    let what = format!("must be one of 5121, 5123, 5125, got {code}");
                    entry.fault("sparse/indices/componentType", what)
                })?;
                let extent = [sparse.indices.buffer_view, sparse.indices.byte_offset, sparse.count];
                let indices = packed(extent, kind.size(), "sparse/count", report)?;
                // The indices twice, and the values at their largest: a byte may stand behind each.
                let each = (size_of::<u32>() + size_of::<usize>()) as u64;
                let each = each + (size_of::<f64>() * shape.components) as u64;
                let needed = (sparse.count.0 as u64).saturating_mul(each);
                let place = entry.at("sparse/count");
                (report.budget).charge_at(place, needed, "a sparse accessor")?;
                let indices = indices.read(kind, None, sparse.count.0);
                let indices = rising(&indices, count, entry)?;
                let extent = [sparse.values.buffer_view, sparse.values.byte_offset, sparse.count];
                Some((indices, packed(extent, size, "sparse/count", report)?))
            }
        };
        Ok(Self { entry, count, component, normalized: accessor.normalized, packed: whole, sparse })
    }

    /// All elements, which must have `N` components.
    pub(super) fn read<T: Number, const N: usize>(
        &self,
        report: &mut Report,
    ) -> Checked<Vec<[T; N]>> {
        // Values that are not in the bytes are zero; their count is only a claim.
        let needed = (self.count as u64).saturating_mul(size_of::<[T; N]>() as u64);
        report.budget.charge_at(self.entry.at("count"), needed, "an accessor")?;
        let largest = self.normalized.then(|| self.component.largest());
        let mut values = match &self.packed {
            Some(packed) => packed.read(self.component, largest, self.count),
            None => reserved(self.count, self.entry)?,
        };
        values.resize(self.count, [T::default(); N]);
        if let Some((indices, replaced)) = &self.sparse {
            let replaced = replaced.read(self.component, largest, indices.len());
            for (&index, value) in indices.iter().zip(replaced) {
                if let Some(place) = values.get_mut(index) {
                    *place = value;
                }
            }
        }
        Ok(values)
    }
}

/// An empty vector with room for `count` values, or an error.
fn reserved<T>(count: usize, entry: Entry) -> Checked<Vec<T>> {
    let mut values = Vec::new();
    let reserved = values.try_reserve_exact(count);
    reserved.map_err(|_| {
        let what = format!("{count} elements are more than what memory is free");
        Fault::too_large(entry.at("count"), what)
    })?;
    Ok(values)
}

/// Sparse indices, which must rise and be in range.
fn rising(indices: &[[u32; 1]], count: usize, entry: Entry) -> Checked<Vec<usize>> {
    let indices: Vec<usize> = indices.iter().map(|&[index]| index as usize).collect();
    let wrong = |what: String| Err(entry.fault("sparse/indices", what));
    if let Some(index) = indices.iter().find(|&&index| index >= count) {
        return wrong(format!("index {index} of {count} elements"));
    }
    match indices.windows(2).find(|pair| pair.first() >= pair.last()) {
        Some(pair) => wrong(format!("must rise, got {pair:?}")),
        None => Ok(indices),
    }
}

impl Packed<'_> {
    fn read<T: Number, const N: usize>(
        &self,
        component: Component,
        largest: Option<f64>,
        count: usize,
    ) -> Vec<[T; N]> {
        let whole = |value: i64| T::from_whole(value, largest);
        match component {
            Component::Int8 => self.map(count, |b| whole(i8::from_le_bytes(b).into())),
            Component::Uint8 => self.map(count, |b| whole(u8::from_le_bytes(b).into())),
            Component::Int16 => self.map(count, |b| whole(i16::from_le_bytes(b).into())),
            Component::Uint16 => self.map(count, |b| whole(u16::from_le_bytes(b).into())),
            Component::Uint32 => self.map(count, |b| whole(u32::from_le_bytes(b).into())),
            Component::Float32 => self.map(count, |b| T::from_single(f32::from_le_bytes(b))),
        }
    }

    fn map<T: Number, const N: usize, const B: usize>(
        &self,
        count: usize,
        number: impl Fn([u8; B]) -> T,
    ) -> Vec<[T; N]> {
        let element = |bytes: &[u8]| {
            let (words, _) = bytes.as_chunks::<B>();
            std::array::from_fn(|k| words.get(k).map_or_else(T::default, |&word| number(word)))
        };
        let bytes = self.bytes.get();
        if self.stride == N * B {
            return bytes.chunks_exact(N * B).take(count).map(element).collect();
        }
        bytes.chunks(self.stride).take(count).map(element).collect()
    }
}
