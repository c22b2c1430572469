//! Sizes that tell of a mistake.

use super::Facts;
use super::report::FindingCollector;
use super::subject::Subject;
use crate::error::Result;
use crate::geometry::{Bounds, single};
use crate::shape::Positions;
use crate::watch::Watch;

/// The least number of steps of its coordinates that a float32 mesh should have across its largest
/// side. It has 2^24 at the origin: ten of 24 binary digits may be lost to the offset.
const STEPS: f64 = 16384.0;

/// Scenes are not expected to be smaller or larger, in scene units. In metres the first is a
/// millimetre; in millimetres the second is a kilometre.
const SIZES: [f64; 2] = [1e-3, 1e6];

/// A mesh in float32 whose offset takes its digits.
#[expect(clippy::unnecessary_wraps, reason = "a check may fail")]
pub(super) fn far(
    subject: &Subject<'_>,
    found: &mut FindingCollector<'_>,
    _watch: &dyn Watch,
) -> Result<()> {
    let bounds = subject.mesh.bounds();
    let Bounds { low, high } = bounds;
    let is_single = matches!(**subject.mesh.positions(), Positions::Single(_));
    let size = bounds.size().max_element();
    let farthest = single(low.abs().max(high.abs()).max_element());
    let step = f64::from(farthest.next_up()) - f64::from(farthest);
    if is_single && size > 0.0 && step * STEPS > size {
        found.add(subject, &[], bounds.centre());
        if found.note.is_empty() {
            let object = subject.object;
            found.note = format!("coordinates of object {object} come in steps of {step}");
        }
    }
    Ok(())
}

/// A scene of an unlikely size.
#[expect(clippy::unnecessary_wraps, reason = "a check may fail")]
pub(super) fn units(
    facts: &Facts<'_>,
    found: &mut FindingCollector<'_>,
    _watch: &dyn Watch,
) -> Result<()> {
    let bounds = facts.scene.bounds();
    let size = bounds.size().max_element();
    let [least, most] = SIZES;
    if size > 0.0 && !(least..=most).contains(&size) {
        found.add_elsewhere(None, bounds.centre());
        found.note = format!("the largest side is {size:e}");
    }
    Ok(())
}
