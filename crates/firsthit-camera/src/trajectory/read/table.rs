//! Poses in columns that a header names.

use std::path::Path;

use super::super::Trajectory;
use super::rows::Rows;
use super::text::{Field, Line, Lines, Unit, shown, wrong};
use crate::error::{Error, Place, Result};

/// The names that a column may have, in small letters.
pub(super) type Names<'a> = &'a [&'a str];

/// The numbers of the columns in a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    /// The number of the column with the time.
    pub(super) time: usize,
    /// The unit of the times.
    pub(super) unit: Unit,
    /// The numbers of the columns `x y z qx qy qz qw`.
    pub(super) pose: [usize; 7],
}

/// The header of a table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Header<'a> {
    line: Line<'a>,
}

impl Header<'_> {
    /// The number of the column that has one of these names, and which of them, if there is one.
    ///
    /// # Errors
    ///
    /// Where two have.
    pub(super) fn find(&self, names: Names) -> Result<Option<(usize, usize)>> {
        let mut found: Option<(usize, usize, Field)> = None;
        for (column, field) in self.line.fields().enumerate() {
            let mut of_name = names.iter();
            let is_it = |name: &&str| field.text.eq_ignore_ascii_case(name.as_bytes());
            let Some(which) = of_name.position(is_it) else {
                continue;
            };
            if let Some((_, _, first)) = found {
                let [first, second] = [first.text, field.text].map(shown);
                return Err(field.error(format!(
                    "the columns '{first}' and '{second}' are for the same; one of them is expected"
                )));
            }
            found = Some((column, which, field));
        }
        Ok(found.map(|(column, which, _)| (column, which)))
    }

    /// The numbers of the seven columns of these names.
    ///
    /// # Errors
    ///
    /// Where one is missing.
    pub(super) fn pose(&self, names: [Names; 7]) -> Result<[usize; 7]> {
        let mut pose = [0; 7];
        for (column, names) in pose.iter_mut().zip(names) {
            let found = self.find(names)?;
            (*column, _) = found.ok_or_else(|| self.missing(names))?;
        }
        Ok(pose)
    }

    /// The error that a column is missing.
    pub(super) fn missing(&self, names: Names) -> Error {
        let names = names.join(" or ");
        let what = format!("there is no column {names}; the first line is the header");
        self.line.error(what)
    }
}

/// Reads a table whose first line is a header that `columns` understands.
pub(super) fn read_table(
    text: &[u8],
    path: &Path,
    columns: impl FnOnce(&Header<'_>) -> Result<Columns>,
) -> Result<Trajectory> {
    let mut lines = Lines::new(text, path)?;
    let Some(line) = lines.next() else {
        return Err(wrong(path, Place::File, "there are no poses in it"));
    };
    let columns = columns(&Header { line })?;
    let expected = line.fields().count();
    let mut rows = Rows::default();
    for line in lines {
        let (mut time, mut pose) = (Field::missing(line), [Field::missing(line); 7]);
        let mut got = 0;
        for (column, field) in line.fields().enumerate() {
            got = column + 1;
            if column == columns.time {
                time = field;
            }
            for (into, wanted) in pose.iter_mut().zip(columns.pose) {
                if column == wanted {
                    *into = field;
                }
            }
        }
        if got != expected {
            let what = format!("expected {expected} columns, as in the header, got {got}");
            return Err(line.error(what));
        }
        rows.add(time.seconds(columns.unit)?, time, &pose)?;
    }
    rows.finish(path)
}
