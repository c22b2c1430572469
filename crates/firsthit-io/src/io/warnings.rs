//! The warnings about one file: one for each kind, however often it occurs.

use std::path::Path;

use super::fault::{Fault, shortened};
use crate::error::{Error, Place, escaped};

/// The warnings so far.
#[derive(Debug, Default)]
pub struct Warnings {
    kinds: Vec<WarningKind>,
    dropped: u64,
    first_dropped: String,
    /// The place and reason where a file seems to end too early.
    cut: Option<Error>,
    /// Warnings of files that this one names, worded.
    absorbed: Vec<String>,
}

#[derive(Debug)]
struct WarningKind {
    key: &'static str,
    line: String,
    count: u64,
}

impl Warnings {
    /// Adds a warning about a place of the file at `path`. `key` tells the kinds apart; only the
    /// first of a kind is worded.
    pub(crate) fn add(
        &mut self,
        path: &Path,
        key: &'static str,
        place: &Place,
        what: impl FnOnce() -> String,
    ) {
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.key == key) {
            kind.count += 1;
        } else {
            let line = format!("{}{place}: {}", escaped(path), shortened(what()));
            let count = 1;
            self.kinds.push(WarningKind { key, line, count });
        }
    }

    /// Adds that the file at `path` seems to be truncated, and why.
    pub(crate) fn cut_short(&mut self, path: &Path, place: Place, why: &str) {
        let what = format!("the file seems to be truncated: {why}");
        self.add(path, "cut", &place, || what.clone());
        let fault = Fault::at(place, what);
        self.cut.get_or_insert_with(|| fault.into_error(path));
    }

    /// Adds the warnings about a file that this one names.
    pub(crate) fn absorb(&mut self, lines: Vec<String>) {
        self.absorbed.extend(lines);
    }

    /// The first reason why strict reading of the file at `path` fails.
    pub(crate) fn strict_error(&mut self, path: &Path) -> Option<Error> {
        let dropped = self.dropped().map(Fault::file);
        let dropped = dropped.map(|fault| fault.into_error(path));
        self.cut.take().or(dropped)
    }

    /// Counts triangles that cannot be used; `first` words which one came first.
    pub(crate) fn drop_triangles(&mut self, count: u64, first: impl FnOnce() -> String) {
        if self.dropped == 0 && count > 0 {
            self.first_dropped = first();
        }
        self.dropped += count;
    }

    /// The warning about dropped triangles, if there are any.
    fn dropped(&self) -> Option<String> {
        (self.dropped > 0).then(|| {
            let (count, first) = (self.dropped, &self.first_dropped);
            let have = if count == 1 { "triangle has" } else { "triangles have" };
            format!(
                "{count} {have} a corner that is not finite or not below 1e30; \
                 the first is {first}"
            )
        })
    }

    /// The warnings about the file at `path`, ready to print.
    pub(crate) fn take_lines(&mut self, path: &Path) -> Vec<String> {
        let dropped = self.dropped();
        let dropped = dropped.map(|what| format!("{}: dropped: {what}", escaped(path)));
        let worded = std::mem::take(&mut self.kinds);
        let worded = worded.into_iter().map(|kind| match kind.count {
            1 => kind.line,
            count => format!("{} (and {} more like it)", kind.line, count - 1),
        });
        let absorbed = std::mem::take(&mut self.absorbed);
        worded.chain(dropped).chain(absorbed).collect()
    }
}
