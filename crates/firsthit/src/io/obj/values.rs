//! What corners and faces name: texture coordinates, normals, colours and materials.

use std::collections::HashMap;

use super::index::NONE;
use crate::error::Place;
use crate::io::mend::{Kind, mend};
use crate::io::report::Report;
use crate::scene::Material;

/// Values that corners name by index.
#[derive(Debug, Default)]
pub(super) struct Values {
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    /// Linear colours of vertices: none, or as many as vertices.
    pub(super) colors: Vec<[f32; 3]>,
}

impl Values {
    pub(super) fn mend(&mut self, report: &mut Report) {
        mend(&mut self.normals, Kind::Normals, &Place::File, report);
        mend(&mut self.uvs, Kind::Coordinates, &Place::File, report);
        mend(&mut self.colors, Kind::Colors, &Place::File, report);
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
