//! Faces that should not be there.

use rayon::prelude::*;

use super::report::Found;
use super::subject::{Subject, sorted};
use crate::error::Result;
use crate::watch::Watch;

/// Faces without an area.
#[expect(clippy::unnecessary_wraps, reason = "a check may fail")]
pub(super) fn degenerate(
    subject: &Subject<'_>,
    found: &mut Found<'_>,
    _watch: &dyn Watch,
) -> Result<()> {
    for triangle in 0..subject.len() {
        if !subject.has_area[triangle as usize] {
            found.add(subject, &[triangle], subject.middle(triangle));
        }
    }
    Ok(())
}

/// Faces that have an area and the corners of an earlier one.
#[expect(clippy::unnecessary_wraps, reason = "a check may fail")]
pub(super) fn duplicate(
    subject: &Subject<'_>,
    found: &mut Found<'_>,
    _watch: &dyn Watch,
) -> Result<()> {
    let with_area = (0..)
        .zip(&subject.welded)
        .filter(|&(k, _): &(u32, _)| subject.has_area[k as usize]);
    let mut order: Vec<([u32; 3], u32)> = with_area
        .map(|(k, &places)| (sorted(places).0, k))
        .collect();
    order.par_sort_unstable();
    let same = order.chunk_by(|(a, _), (b, _)| a == b);
    let mut later: Vec<u32> = same
        .flat_map(|same| same[1..].iter().map(|&(_, k)| k))
        .collect();
    later.sort_unstable();
    for triangle in later {
        found.add(subject, &[triangle], subject.middle(triangle));
    }
    Ok(())
}
