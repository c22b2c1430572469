//! Faces that should not be there.

use super::report::FindingCollector;
use super::subject::Subject;
use crate::error::Result;
use crate::watch::Watch;

/// Faces without an area.
#[expect(clippy::unnecessary_wraps, reason = "a check may fail")]
pub(super) fn degenerate(
    subject: &Subject<'_>,
    found: &mut FindingCollector<'_>,
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
    found: &mut FindingCollector<'_>,
    _watch: &dyn Watch,
) -> Result<()> {
    let with_area = (subject.copies.iter()).filter(|same| subject.has_area[same[0] as usize]);
    let mut later: Vec<u32> = with_area.flat_map(|same| &same[1..]).copied().collect();
    later.sort_unstable();
    for triangle in later {
        found.add(subject, &[triangle], subject.middle(triangle));
    }
    Ok(())
}
