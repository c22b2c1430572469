//! The length of listings.

use crate::args::InfoArgs;

/// The most entries of each kind in texts for people: small files can hold thousands.
const MOST_IN_TEXT: usize = 20;

/// The most entries in JSON for programs, which are told how many there are in all.
const MOST_IN_JSON: usize = 10_000;

/// The most entries of each kind that are listed.
pub(super) fn most_listed(args: &InfoArgs) -> usize {
    match (args.all, args.json) {
        (true, _) => usize::MAX,
        (false, true) => MOST_IN_JSON,
        (false, false) => MOST_IN_TEXT,
    }
}

/// The first `most` of `lines`, after `indent`, and how many there are beside.
pub(super) fn listed(
    most: usize,
    indent: &str,
    lines: impl ExactSizeIterator<Item = String>,
) -> Vec<String> {
    let more = lines.len().saturating_sub(most);
    let shown = lines.take(most).map(|line| format!("{indent}{line}"));
    let more = (more > 0).then(|| format!("{indent}... and {more} more (--all lists them)"));
    shown.chain(more).collect()
}
