//! The vertices of a PLY file.

use super::body::{Rows, Table, scalar_at, skip_value};
use super::faces::CHECK_EVERY;
use super::header::{Element, Format, Header, PropertyKind, Type};
use super::levels::Levels;
use super::named::NamedRows;
use crate::geometry::single;
use crate::io::fault::{Checked, Fault};
use crate::io::report::Report;
use crate::memory::Storage;
use crate::shape::{Positions, PropertyOf};

/// The properties that are read, by all the names they go by.
const NAMES: [&[&str]; 11] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["s", "u", "texture_u"],
    &["t", "v", "texture_v"],
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
];

/// The vertices that were read.
pub(super) struct VertexRows {
    /// The index into [`NAMES`] of each property of the element.
    slots: Vec<Option<usize>>,
    /// All other numbers.
    pub(super) named: NamedRows,
    levels: Levels,
    /// The positions in float64, if they are to be, not yet compact.
    pub(super) points: Positions,
    pub(super) normals: Option<Vec<[f32; 3]>>,
    pub(super) uvs: Option<Vec<[f32; 2]>>,
    pub(super) colors: Option<Vec<[f32; 3]>>,
}

impl VertexRows {
    pub(super) fn new(element: &Element, header: &Header) -> Checked<Self> {
        let found = NAMES.map(|names| scalar_at(element, names));
        let [x, y, z, nx, ny, nz, u, v, r, g, b] = found;
        for (name, property) in [("x", x), ("y", y), ("z", z)] {
            if property.is_none() {
                let what = format!("element 'vertex' has no property '{name}'");
                return Err(Fault::line(element.line, what));
            }
        }
        let mut slots = vec![None; element.properties.len()];
        for (slot, property) in found.into_iter().enumerate() {
            if let Some(at) = property.and_then(|(at, _)| slots.get_mut(at)) {
                *at = Some(slot);
            }
        }
        let is_single = |property: Option<(usize, Type)>| {
            property.is_some_and(|(_, kind)| kind == Type::Float32)
        };
        // Text may have more digits than the float that it declares: those are kept.
        let single = header.format != Format::Ascii && [x, y, z].into_iter().all(is_single);
        let is_named = |k: usize| slots.get(k).is_some_and(Option::is_none);
        Ok(Self {
            named: NamedRows::new(element, PropertyOf::Vertices, is_named),
            slots,
            levels: Levels::new(r.map_or(Type::Uint8, |(_, kind)| kind)),
            points: if single {
                Positions::Single(Storage::default())
            } else {
                Positions::Double(Storage::default())
            },
            normals: (nx.is_some() && ny.is_some() && nz.is_some()).then(Vec::new),
            uvs: (u.is_some() && v.is_some()).then(Vec::new),
            colors: (r.is_some() && g.is_some() && b.is_some()).then(Vec::new),
        })
    }

    pub(super) fn read<R: Rows>(
        &mut self,
        element: &Element,
        rows: &mut R,
        report: &mut Report,
    ) -> Checked<()> {
        let capacity = rows.capacity(element);
        report.budget.charge_growth(capacity.saturating_mul(self.row_bytes()))?;
        self.reserve(capacity);
        if let Some(table) = rows.table(element)? {
            self.read_table(element, &table);
            return Ok(());
        }
        let mut row = [0.0; NAMES.len()];
        for number in 0..element.count {
            if number.is_multiple_of(CHECK_EVERY) {
                report.advance_until(rows.left())?;
            }
            rows.begin(element)?;
            for (k, (property, slot)) in element.properties.iter().zip(&self.slots).enumerate() {
                match (property.kind, slot.and_then(|slot| row.get_mut(slot))) {
                    (PropertyKind::Scalar(kind), Some(value)) => *value = rows.value(kind)?,
                    (PropertyKind::Scalar(kind), None) => self.named.push(k, rows.value(kind)?),
                    (kind @ PropertyKind::List { .. }, _) => skip_value(kind, rows)?,
                }
            }
            rows.finish();
            self.push(row);
        }
        Ok(())
    }

    /// The size of a vertex in bytes.
    fn row_bytes(&self) -> usize {
        let position = match self.points {
            Positions::Single(_) => size_of::<[f32; 3]>(),
            Positions::Double(_) => size_of::<[f64; 3]>(),
        };
        let normal = self.normals.as_ref().map_or(0, |_| size_of::<[f32; 3]>());
        let uv = self.uvs.as_ref().map_or(0, |_| size_of::<[f32; 2]>());
        let color = self.colors.as_ref().map_or(0, |_| size_of::<[f32; 3]>());
        position + normal + uv + color + self.named.row_bytes()
    }

    /// Reads all rows column by column.
    fn read_table(&mut self, element: &Element, table: &Table) {
        // A property that is missing is never asked for: it has no column.
        let mut columns = [(usize::MAX, Type::Uint8); NAMES.len()];
        let mut offset = 0;
        for (property, slot) in element.properties.iter().zip(&self.slots) {
            let (PropertyKind::Scalar(kind) | PropertyKind::List { count: kind, .. }) =
                property.kind;
            if let Some(column) = slot.and_then(|slot| columns.get_mut(slot)) {
                *column = (offset, kind);
            }
            offset += usize::try_from(kind.size()).unwrap_or(0);
        }
        self.named.read_table(element, table);
        let [x, y, z, nx, ny, nz, u, v, r, g, b] = columns;
        match &mut self.points {
            Positions::Single(points) => {
                let rows = table.columns([x, y, z]).map(|point| point.map(single));
                points.edit(|points| points.extend(rows));
            }
            Positions::Double(points) => {
                points.edit(|points| points.extend(table.columns([x, y, z])));
            }
        }
        if let Some(normals) = &mut self.normals {
            normals.extend(table.columns([nx, ny, nz]).map(|normal| normal.map(single)));
        }
        if let Some(uvs) = &mut self.uvs {
            uvs.extend(table.columns([u, v]).map(|uv| uv.map(single)));
        }
        if let Some(colors) = &mut self.colors {
            let levels = &self.levels;
            let linear = |color: [f64; 3]| color.map(|level| levels.linear(level));
            colors.extend(table.columns([r, g, b]).map(linear));
        }
    }

    fn reserve(&mut self, count: usize) {
        self.named.reserve(count);
        match &mut self.points {
            Positions::Single(points) => points.edit(|points| points.reserve_exact(count)),
            Positions::Double(points) => points.edit(|points| points.reserve_exact(count)),
        }
        let vectors = self.normals.iter_mut().chain(&mut self.colors);
        vectors.for_each(|values| values.reserve_exact(count));
        self.uvs.iter_mut().for_each(|values| values.reserve_exact(count));
    }

    fn push(&mut self, [x, y, z, nx, ny, nz, u, v, r, g, b]: [f64; NAMES.len()]) {
        match &mut self.points {
            Positions::Single(points) => points.edit(|points| points.push([x, y, z].map(single))),
            Positions::Double(points) => points.edit(|points| points.push([x, y, z])),
        }
        if let Some(normals) = &mut self.normals {
            normals.push([nx, ny, nz].map(single));
        }
        if let Some(uvs) = &mut self.uvs {
            uvs.push([u, v].map(single));
        }
        if let Some(colors) = &mut self.colors {
            colors.push([r, g, b].map(|level| self.levels.linear(level)));
        }
    }
}
