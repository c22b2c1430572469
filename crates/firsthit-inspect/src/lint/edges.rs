//! Edges at which faces do not fit together.

use super::report::FindingCollector;
use super::subject::{EdgeUse, Subject};
use crate::error::Result;
use crate::watch::Watch;

/// Edges with two faces that both go the same way along it.
#[expect(clippy::unnecessary_wraps, reason = "a check may fail")]
pub(super) fn winding(
    subject: &Subject<'_>,
    found: &mut FindingCollector<'_>,
    _watch: &dyn Watch,
) -> Result<()> {
    for uses in subject.edge_uses() {
        if let [a, b] = uses
            && a.is_forward == b.is_forward
        {
            add(subject, uses, found);
        }
    }
    Ok(())
}

/// Edges with more than two faces.
#[expect(clippy::unnecessary_wraps, reason = "a check may fail")]
pub(super) fn non_manifold(
    subject: &Subject<'_>,
    found: &mut FindingCollector<'_>,
    _watch: &dyn Watch,
) -> Result<()> {
    for uses in subject.edge_uses() {
        if uses.len() > 2 {
            add(subject, uses, found);
        }
    }
    Ok(())
}

fn add(subject: &Subject<'_>, uses: &[EdgeUse], found: &mut FindingCollector<'_>) {
    let [a, b] = uses[0].ends.map(|place| subject.point(place));
    let triangles: Vec<u32> = uses.iter().map(|edge| edge.triangle).collect();
    found.add(subject, &triangles, 0.5 * a + 0.5 * b);
}
