//! The faces and triangle strips of a PLY file.

use super::body::{Rows, scalar_at, skip, skip_value};
use super::header::{Element, PropertyKind, Type};
use super::levels::Levels;
use super::named::NamedRows;
use crate::error::Place;
use crate::io::fault::{Checked, Fault};
use crate::io::report::Report;
use crate::io::surface::Surface;
use crate::shape::PropertyOf;

/// The memory is charged after this many rows.
pub(super) const CHECK_EVERY: u64 = 1 << 16;

/// The faces that were read.
pub(super) struct Faces {
    pub(super) surface: Surface,
    /// A linear colour for each face, where all faces so far have one.
    pub(super) colors: Vec<[f32; 3]>,
    /// All other numbers.
    pub(super) named: NamedRows,
    vertex_count: u64,
}

impl Faces {
    /// An empty list of faces, of `vertex_count` vertices, which need not have been read.
    pub(super) fn new(vertex_count: u64) -> Self {
        Self {
            surface: Surface::default(),
            colors: Vec::new(),
            named: NamedRows::default(),
            vertex_count,
        }
    }

    pub(super) fn read<R: Rows>(
        &mut self,
        element: &Element,
        rows: &mut R,
        report: &mut Report,
    ) -> Checked<()> {
        if element.count == 0 {
            return Ok(());
        }
        let indices = list_at(element, &["vertex_indices", "vertex_index"]).ok_or_else(|| {
            Fault::line(element.line, "element 'face' has no list 'vertex_indices'")
        })?;
        warn_of_lists(element, report);
        self.surface.reserve(rows.capacity(element))?;
        let colors = ColorColumns::of(element);
        self.named = NamedRows::new(element, PropertyOf::Faces, |k| !colors.has(k));
        let mut ring = Vec::new();
        let mut left = element.count;
        let mut checked = left;
        while left > 0 {
            let surface = &mut self.surface;
            let push = |corners| surface.push_triangle(corners);
            let most = left.min(CHECK_EVERY);
            left -= rows.plain_triangles(element, most, self.vertex_count, push);
            if checked - left >= CHECK_EVERY || left == 0 {
                checked = left;
                report.budget.charge_growth(self.bytes())?;
                report.advance_until(rows.left())?;
            }
            if left == 0 {
                break;
            }
            left -= 1;
            self.read_row(element, indices, &colors, rows, &mut ring)?;
        }
        Ok(())
    }

    /// The size in bytes.
    fn bytes(&self) -> usize {
        let faces = self.surface.face_count() as usize;
        let named = faces.saturating_mul(self.named.row_bytes());
        self.surface.bytes() + size_of_val(self.colors.as_slice()) + named
    }

    /// Reads a row by its properties, of which `indices` is the ring of vertices.
    fn read_row<R: Rows>(
        &mut self,
        element: &Element,
        indices: usize,
        colors: &ColorColumns,
        rows: &mut R,
        ring: &mut Vec<u32>,
    ) -> Checked<()> {
        let mut color = [0.0; 3];
        rows.begin(element)?;
        for (k, property) in element.properties.iter().enumerate() {
            match property.kind {
                PropertyKind::List { count, item } if k == indices => {
                    self.read_ring(count, item, rows, ring)?;
                }
                PropertyKind::Scalar(kind) if colors.has(k) => {
                    let value = rows.value(kind)?;
                    let levels = color.iter_mut().zip(colors.columns.iter().flatten());
                    levels
                        .filter(|&(_, &column)| column == k)
                        .for_each(|(level, _)| *level = value);
                }
                PropertyKind::Scalar(kind) => self.named.push(k, rows.value(kind)?),
                kind @ PropertyKind::List { .. } => skip_value(kind, rows)?,
            }
        }
        rows.finish();
        self.surface.push(ring);
        if colors.columns.is_some() {
            let color = color.map(|level| colors.levels.linear(level));
            self.colors.push(color);
        }
        Ok(())
    }

    fn read_ring<R: Rows>(
        &self,
        count: Type,
        item: Type,
        rows: &mut R,
        ring: &mut Vec<u32>,
    ) -> Checked<()> {
        if rows.plain_list(count, item, self.vertex_count, ring) {
            return Ok(());
        }
        ring.clear();
        for _ in 0..rows.length(count, item)? {
            let index = rows.value(item)?;
            ring.push(self.vertex(index, rows)?);
        }
        Ok(())
    }

    /// Makes the index of a vertex from a number, here alone.
    #[inline]
    fn vertex<R: Rows>(&self, index: f64, rows: &R) -> Checked<u32> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the way back tells whether anything was lost"
        )]
        let vertex = index as u32;
        if f64::from(vertex) == index && u64::from(vertex) < self.vertex_count {
            return Ok(vertex);
        }
        let count = self.vertex_count;
        let what = format!("a vertex index must be whole and from 0 to below {count}, got {index}");
        Err(Fault::at(rows.place(), what))
    }

    /// Reads strips: each vertex makes a triangle with the two before it, every other one turned
    /// over; a negative index begins anew.
    pub(super) fn read_strips<R: Rows>(&mut self, element: &Element, rows: &mut R) -> Checked<()> {
        let Some(strip) = list_at(element, &["vertex_indices", "vertex_index"]) else {
            return skip(element, rows);
        };
        for _ in 0..element.count {
            rows.begin(element)?;
            for (k, property) in element.properties.iter().enumerate() {
                match property.kind {
                    PropertyKind::List { count, item } if k == strip => {
                        let length = rows.length(count, item)?;
                        self.read_strip(length, item, rows)?;
                    }
                    kind => skip_value(kind, rows)?,
                }
            }
            rows.finish();
        }
        Ok(())
    }

    fn read_strip<R: Rows>(&mut self, length: u64, item: Type, rows: &mut R) -> Checked<()> {
        let triangles = usize::try_from(length).unwrap_or(usize::MAX);
        self.surface.reserve(triangles)?;
        let (mut last, mut is_odd) = ([None; 2], false);
        for _ in 0..length {
            let index = rows.value(item)?;
            if index < 0.0 {
                (last, is_odd) = ([None; 2], false);
                continue;
            }
            let vertex = self.vertex(index, rows)?;
            if let [Some(a), Some(b)] = last {
                let corners = if is_odd { [b, a, vertex] } else { [a, b, vertex] };
                self.surface.push_triangle(corners);
                is_odd = !is_odd;
            }
            last = [last[1], Some(vertex)];
        }
        Ok(())
    }
}

/// The columns of the colours of faces.
struct ColorColumns {
    /// The columns of red, green and blue; `None` unless all three are there.
    columns: Option<[usize; 3]>,
    levels: Levels,
}

impl ColorColumns {
    fn of(element: &Element) -> Self {
        let found = ["red", "green", "blue"].map(|name| scalar_at(element, &[name]));
        let kind = found.iter().flatten().next().map(|&(_, kind)| kind);
        let columns = match found {
            [Some((red, _)), Some((green, _)), Some((blue, _))] => Some([red, green, blue]),
            _ => None,
        };
        Self { columns, levels: Levels::new(kind.unwrap_or(Type::Uint8)) }
    }

    fn has(&self, property: usize) -> bool {
        self.columns.iter().flatten().any(|&column| column == property)
    }
}

fn list_at(element: &Element, names: &[&str]) -> Option<usize> {
    let mut properties = element.properties.iter();
    properties.position(|property| {
        matches!(property.kind, PropertyKind::List { .. })
            && names.contains(&property.name.as_str())
    })
}

fn warn_of_lists(element: &Element, report: &mut Report) {
    if list_at(element, &["texcoord"]).is_some() {
        report.warn("texcoord", &Place::Line(element.line), || {
            "texture coordinates of faces (property 'texcoord') are not read yet".to_owned()
        });
    }
}
