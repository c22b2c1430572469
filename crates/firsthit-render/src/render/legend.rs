//! The legend of a picture's colours by numbers.

use crate::image::ColorsRecord;
use crate::scene::{Colored, Coloring};

/// The legend of a scene's colours.
pub(super) fn record(colored: &Colored) -> ColorsRecord {
    let Coloring { by, map, below, above, missing, .. } = colored.coloring();
    ColorsRecord {
        by: by.text(),
        map: map.name().to_owned(),
        range: colored.range(),
        below: below.map(Into::into),
        above: above.map(Into::into),
        missing: missing.map(Into::into),
    }
}
