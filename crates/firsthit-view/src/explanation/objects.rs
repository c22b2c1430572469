//! The objects of an explanation: those that say something about the ray one by one, the others
//! counted.

use firsthit::explain::{Candidate, Reason};

use super::{named, part};
use crate::words::counted;
use crate::words::exact_number;

/// The number of objects of a reason with a line of their own.
const MOST: usize = 5;

/// A line for each object that tells something, or for `all`, and a line for each reason of the
/// others.
pub(super) fn lines(candidates: &[Candidate<'_>], all: bool) -> Vec<String> {
    let mut lines = vec![format!("objects    {} in all", candidates.len())];
    if all {
        lines.extend(candidates.iter().map(line));
        return lines;
    }
    for &reason in Reason::ALL {
        let of_reason = candidates.iter().filter(|it| it.reason == reason);
        let mut of_reason: Vec<&Candidate<'_>> = of_reason.collect();
        if reason > Reason::SurfaceMissed {
            lines.extend(rest(reason, of_reason.len(), ""));
            continue;
        }
        // The nearest first; the order of identifiers is kept where there is no t.
        of_reason.sort_by(|one, other| closeness(one).total_cmp(&closeness(other)));
        lines.extend(of_reason.iter().take(MOST).map(|candidate| line(candidate)));
        let more = of_reason.len().saturating_sub(MOST);
        lines.extend(rest(reason, more, "more "));
    }
    lines
}

/// The distance of a candidate from being the hit.
fn closeness(candidate: &Candidate<'_>) -> f64 {
    let t = candidate.place.map_or(0.0, |place| place.t);
    match candidate.reason {
        Reason::BehindStart => -t,
        _ => t,
    }
}

/// The line about the objects without one of their own.
fn rest(reason: Reason, count: usize, more: &str) -> Option<String> {
    let about = reason.about();
    let objects = counted(count as u64, &format!("{more}object"));
    (count > 0).then(|| format!("           {objects}: {about}"))
}

/// An object and its reason.
fn line(candidate: &Candidate<'_>) -> String {
    let named = named(candidate.object, candidate.name, candidate.shape);
    let place = candidate.place.map_or_else(String::new, |place| {
        let part = part(candidate.shape, place.primitive);
        format!(", at t {}, {part}", exact_number(place.t))
    });
    format!("           {named}: {}{place}", candidate.reason.about())
}
