//! Rays as text.

use super::Table;

/// Lines of numbers; the first one may be a header, lines with # are comments.
pub(super) fn csv(bytes: &[u8]) -> Result<Table, String> {
    let mut lines = Lines::default();
    let mut values = Vec::new();
    lines.read(bytes, &mut values)?;
    // No rays are rays too.
    let columns = lines.columns.unwrap_or(6);
    Ok(Table { columns, values })
}

/// What is known of a text that is read in parts.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// How many numbers each line has, from the first on.
    pub(super) columns: Option<usize>,
    /// How many lines came before the part that is being read.
    before: u64,
}

impl Lines {
    /// Adds the numbers of the next lines, which are whole, to `values`: of all lines before one that is wrong.
    pub(super) fn read(&mut self, bytes: &[u8], values: &mut Vec<f64>) -> Result<(), String> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .flexible(true)
            .from_reader(bytes);
        let mut record = csv::ByteRecord::new();
        while reader
            .read_byte_record(&mut record)
            .map_err(|error| error.to_string())?
        {
            self.record(&record, values).map_err(|what| {
                // A record's own position is before the blank lines and the comments that were skipped.
                let end = usize::try_from(reader.position().byte()).unwrap_or(usize::MAX);
                let read = bytes.get(..end).unwrap_or(bytes);
                let read = read.strip_suffix(b"\n").unwrap_or(read);
                format!("line {}: {what}", self.before + breaks(read) + 1)
            })?;
        }
        self.before += breaks(bytes);
        Ok(())
    }

    fn record(&mut self, record: &csv::ByteRecord, values: &mut Vec<f64>) -> Result<(), String> {
        let first = record.get(0).unwrap_or_default();
        let is_blank = record.len() == 1 && first.is_empty();
        // The reader takes blanks away after it has looked for comments.
        if is_blank || first.starts_with(b"#") {
            return Ok(());
        }
        let is_first = self.columns.is_none();
        let expected = *self.columns.get_or_insert(record.len());
        if record.len() != expected {
            let got = record.len();
            return Err(format!("expected {expected} numbers, got {got}"));
        }
        if is_first && record.iter().all(is_name) {
            return Ok(());
        }
        let start = values.len();
        for field in record {
            let Some(number) = number(field) else {
                values.truncate(start);
                return Err("expected numbers with commas between them".into());
            };
            values.push(number);
        }
        Ok(())
    }
}

/// Whether a field is that of a header: no number, and none that is misspelt or followed by others.
fn is_name(field: &[u8]) -> bool {
    let starts_like_a_number = |c: &u8| c.is_ascii_digit() || b"+-.".contains(c);
    number(field).is_none() && !field.first().is_some_and(starts_like_a_number)
}

/// How many line breaks there are.
fn breaks(bytes: &[u8]) -> u64 {
    // A break more is a piece more.
    bytes.split(|&byte| byte == b'\n').count() as u64 - 1
}

fn number(field: &[u8]) -> Option<f64> {
    std::str::from_utf8(field).ok()?.parse().ok()
}
