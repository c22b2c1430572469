//! Colours by numbers, to the record and back.

use serde::{Deserialize, Serialize};

use super::number::{Number, Triple};
use crate::error::Result;
use crate::scene::{ColorBy, Coloring};

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ColoringRecord {
    /// The word of the source; without one the numbers are `values`.
    by: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    values: Vec<Number>,
    map: String,
    range: Option<[Number; 2]>,
    below: Option<Triple>,
    above: Option<Triple>,
    missing: Option<Triple>,
}

impl ColoringRecord {
    pub(super) fn new(coloring: &Coloring) -> Self {
        let (by, values) = match &coloring.by {
            ColorBy::Values(values) => (None, values.iter().copied().map(Number).collect()),
            by => (Some(by.text()), Vec::new()),
        };
        Self {
            by,
            values,
            map: coloring.map.name().to_owned(),
            range: coloring.range.map(|range| range.map(Number)),
            below: coloring.below.map(Triple::from),
            above: coloring.above.map(Triple::from),
            missing: coloring.missing.map(Triple::from),
        }
    }

    pub(super) fn coloring(&self) -> Result<Coloring> {
        let by = match &self.by {
            Some(by) => by.parse()?,
            None => ColorBy::Values(self.values.iter().map(|&Number(number)| number).collect()),
        };
        Ok(Coloring {
            map: self.map.parse()?,
            range: self.range.map(|range| range.map(|Number(number)| number)),
            below: self.below.map(Into::into),
            above: self.above.map(Into::into),
            missing: self.missing.map(Into::into),
            ..Coloring::new(by)
        })
    }
}
