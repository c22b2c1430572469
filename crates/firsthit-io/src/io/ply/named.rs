//! Properties that mean nothing to us, kept by their names.

use super::body::Table;
use super::header::{Element, PropertyKind, Type};
use crate::error::escape_controls;
use crate::memory::Storage;
use crate::shape::{Between, Property, PropertyOf, PropertyValues};

/// The named numbers of an element's rows.
#[derive(Debug, Default)]
pub(super) struct NamedRows {
    /// The place among `named` of each property of the element, if it has one.
    places: Vec<Option<usize>>,
    named: Vec<Property>,
}

impl NamedRows {
    /// The scalars of `element` that `is_named` by their index.
    pub(super) fn new(element: &Element, of: PropertyOf, is_named: impl Fn(usize) -> bool) -> Self {
        let mut rows = Self::default();
        for (k, property) in element.properties.iter().enumerate() {
            let kind = match property.kind {
                PropertyKind::Scalar(kind) if is_named(k) => kind,
                _ => {
                    rows.places.push(None);
                    continue;
                }
            };
            rows.places.push(Some(rows.named.len()));
            let values = match kind {
                Type::Int32 | Type::Uint32 | Type::Float64 => {
                    PropertyValues::Double(Storage::default())
                }
                _ => PropertyValues::Single(Storage::default()),
            };
            let name = escape_controls(&property.name);
            let between = match kind {
                Type::Float32 | Type::Float64 => Between::Interpolated,
                _ => Between::NearestCorner,
            };
            rows.named.push(Property { between, ..Property::new(name, of, values) });
        }
        rows
    }

    pub(super) fn reserve(&mut self, count: usize) {
        for property in &mut self.named {
            match &mut property.values {
                PropertyValues::Single(values) => values.edit(|values| values.reserve_exact(count)),
                PropertyValues::Double(values) => values.edit(|values| values.reserve_exact(count)),
            }
        }
    }

    /// The size of a row in bytes.
    pub(super) fn row_bytes(&self) -> usize {
        let sizes = self.named.iter().map(|property| match property.values {
            PropertyValues::Single(_) => size_of::<f32>(),
            PropertyValues::Double(_) => size_of::<f64>(),
        });
        sizes.sum()
    }

    /// Takes the value of the element's property of that index.
    pub(super) fn push(&mut self, property: usize, value: f64) {
        let place = self.places.get(property).copied().flatten();
        if let Some(named) = place.and_then(|place| self.named.get_mut(place)) {
            named.values.push(value);
        }
    }

    /// Takes the values of all rows.
    pub(super) fn read_table(&mut self, element: &Element, table: &Table) {
        let mut offset = 0;
        for (property, place) in element.properties.iter().zip(&self.places) {
            let (PropertyKind::Scalar(kind) | PropertyKind::List { count: kind, .. }) =
                property.kind;
            if let Some(named) = place.and_then(|place| self.named.get_mut(place)) {
                table.columns([(offset, kind)]).for_each(|[value]| named.values.push(value));
            }
            offset += usize::try_from(kind.size()).unwrap_or(0);
        }
    }

    pub(super) fn into_properties(self) -> Vec<Property> {
        self.named
    }
}
