//! The values that corners and faces refer to: texture coordinates, normals, colours and materials.

use std::collections::HashMap;

use super::index::NONE;
use crate::error::Place;
use crate::io::report::Report;
use crate::io::sanitize::{ValueKind, linear, sanitize, sanitize_levels};
use crate::scene::Material;

/// Values that corners name by index.
#[derive(Debug, Default)]
pub(super) struct Values {
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    /// Linear colours of vertices: none, or as many as vertices.
    pub(super) colors: Vec<[f32; 3]>,
    /// The seventh number of vertices that have one, else NaN: none, or as many as vertices up to
    /// the last that has one.
    pub(super) sevenths: Vec<f32>,
}

impl Values {
    /// Adds what follows the coordinates of the vertex that comes after `count` others: at most a
    /// colour, and one number more.
    pub(super) fn push_color(&mut self, count: usize, extra: &[f64]) {
        let (color, seventh) = match *extra {
            [r, g, b] => (Some([r, g, b]), None),
            [a, b, c, d] => (Some([a, b, c]), Some(d)),
            _ => (None, None),
        };
        if color.is_some() || !self.colors.is_empty() {
            // Vertices without a colour are white.
            self.colors.resize(count, [1.0; 3]);
            self.colors.push(color.map_or([1.0; 3], |color| color.map(linear)));
        }
        if let Some(seventh) = seventh {
            self.sevenths.resize(count, f32::NAN);
            self.sevenths.push(linear(seventh));
        }
    }

    /// The size in bytes.
    pub(super) fn bytes(&self) -> usize {
        let corners = size_of_val(self.uvs.as_slice()) + size_of_val(self.normals.as_slice());
        let colors = size_of_val(self.colors.as_slice()) + size_of_val(self.sevenths.as_slice());
        corners + colors
    }

    /// Tells whether seven numbers of vertices are `x y z w red green blue` or
    /// `x y z red green blue alpha`, by which of the two is one.
    fn sort_sevenths(&mut self, report: &mut Report) {
        let sevenths = std::mem::take(&mut self.sevenths);
        let mut rows: Vec<_> = (self.colors.iter_mut().zip(&sevenths))
            .filter(|(_, seventh)| !seventh.is_nan())
            .collect();
        let is_one = |level: f32| level == 1.0;
        let has_weights = rows.iter().all(|(color, _)| is_one(color[0]));
        let has_alphas = (rows.iter()).all(|&(_, &seventh)| is_one(seventh) || seventh == 255.0);
        if rows.is_empty() || (has_alphas && !has_weights) {
            return;
        }
        if has_alphas == has_weights {
            report.warn("seven", &Place::File, || {
                "vertices of seven numbers are taken for x y z w red green blue; w is not read"
                    .to_owned()
            });
        }
        for (color, seventh) in &mut rows {
            let [_, red, green] = **color;
            **color = [red, green, **seventh];
        }
    }

    pub(super) fn sanitize(&mut self, report: &mut Report) {
        sanitize(&mut self.normals, ValueKind::Normals, &Place::File, report);
        sanitize(&mut self.uvs, ValueKind::Coordinates, &Place::File, report);
        self.sort_sevenths(report);
        sanitize_levels(&mut self.colors, report);
    }
}

/// The materials that faces use, by number.
#[derive(Debug, Default)]
pub(super) struct Materials {
    pub(super) numbers: HashMap<Vec<u8>, u32>,
    pub(super) looks: Vec<Option<Material>>,
}

impl Materials {
    pub(super) fn number(&mut self, name: &[u8]) -> u32 {
        if let Some(&known) = self.numbers.get(name) {
            return known;
        }
        let next = u32::try_from(self.numbers.len()).unwrap_or(NONE);
        self.numbers.insert(name.to_vec(), next);
        next
    }

    /// The look of a material, if its library states one.
    pub(super) fn look(&self, number: u32) -> Option<&Material> {
        self.looks.get(number as usize)?.as_ref()
    }
}
