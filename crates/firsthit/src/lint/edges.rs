//! Edges at which faces do not fit together.

use super::report::Found;
use super::subject::{EdgeUse, Subject};
use crate::error::Result;
use crate::watch::Watch;

/// Edges with two faces that both go the same way along it.
#[expect(clippy::unnecessary_wraps, reason = "a check may fail")]
pub(super) fn winding(
    subject: &Subject<'_>,
    found: &mut Found<'_>,
    _watch: &dyn Watch,
) -> Result<()> {
    for meeting in subject.meetings() {
        if let [a, b] = meeting
            && a.is_forward == b.is_forward
        {
            add(subject, meeting, found);
        }
    }
    Ok(())
}

/// Edges with more than two faces.
#[expect(clippy::unnecessary_wraps, reason = "a check may fail")]
pub(super) fn non_manifold(
    subject: &Subject<'_>,
    found: &mut Found<'_>,
    _watch: &dyn Watch,
) -> Result<()> {
    for meeting in subject.meetings() {
        if meeting.len() > 2 {
            add(subject, meeting, found);
        }
    }
    Ok(())
}

fn add(subject: &Subject<'_>, meeting: &[EdgeUse], found: &mut Found<'_>) {
    let [a, b] = meeting[0].ends.map(|place| subject.point(place));
    let triangles: Vec<u32> = meeting.iter().map(|edge| edge.triangle).collect();
    found.add(subject, &triangles, 0.5 * a + 0.5 * b);
}
