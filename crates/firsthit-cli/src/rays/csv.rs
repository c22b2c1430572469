//! Rays as text.

use super::Table;

/// The names that columns may have in a header: sets of them, each in the order that is wanted.
pub(crate) type Names = &'static [&'static [&'static str]];

/// The names of the columns of pairs of points.
pub(super) const OF_PAIRS: Names =
    &[&["ax", "ay", "az", "bx", "by", "bz"], &["x1", "y1", "z1", "x2", "y2", "z2"]];

/// The names of the columns of rays, or of their origins.
pub(super) const OF_RAYS: Names = &[
    &["ox", "oy", "oz", "dx", "dy", "dz"],
    &["x", "y", "z", "dx", "dy", "dz"],
    &["ox", "oy", "oz"],
    &["x", "y", "z"],
    &["position_x", "position_y", "position_z"],
];

/// The names of the columns of directions.
pub(super) const OF_DIRECTIONS: Names =
    &[&["dx", "dy", "dz"], &["x", "y", "z"], &["normal_x", "normal_y", "normal_z"]];

/// Lines of numbers; the first one may be a header, lines with # are comments.
pub(super) fn csv(bytes: &[u8], names: Names) -> Result<Table, String> {
    let mut lines = Lines::new(names);
    let mut values = Vec::new();
    lines.read(bytes, &mut values)?;
    if let (Some(doubt), true) = (lines.doubt.take(), values.is_empty()) {
        return Err(doubt);
    }
    let columns = lines.numbers();
    Ok(Table { columns, values })
}

/// The state of reading a text in parts.
#[derive(Debug)]
pub(super) struct Lines {
    names: Names,
    /// The number of fields of each line, from the first on.
    columns: Option<usize>,
    /// The fields that are wanted, if a header has named them; else all are.
    wanted: Option<Vec<usize>>,
    /// The number of lines before the part that is being read.
    before: u64,
    /// The fault of unknown names, where no numbers follow.
    doubt: Option<String>,
}

impl Lines {
    pub(super) fn new(names: Names) -> Self {
        Self { names, columns: None, wanted: None, before: 0, doubt: None }
    }

    /// The number of numbers of each line. No lines are rays too.
    pub(super) fn numbers(&self) -> usize {
        let wanted = self.wanted.as_ref().map(Vec::len);
        wanted.or(self.columns).unwrap_or(6)
    }

    /// Adds the numbers of the next lines, which are whole, to `values`: of all lines before one
    /// that is wrong.
    pub(super) fn read(&mut self, bytes: &[u8], values: &mut Vec<f64>) -> Result<(), String> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .flexible(true)
            .from_reader(bytes);
        let mut record = csv::ByteRecord::new();
        while reader.read_byte_record(&mut record).map_err(|error| error.to_string())? {
            let before = self.before;
            let at_line = |what| {
                // A record's own position is before the blank lines and the comments that were
                // skipped.
                let end = usize::try_from(reader.position().byte()).unwrap_or(usize::MAX);
                let read = bytes.get(..end).unwrap_or(bytes);
                let read = read.strip_suffix(b"\n").unwrap_or(read);
                format!("line {}: {what}", before + breaks(read) + 1)
            };
            let is_first = self.columns.is_none();
            self.record(&record, values).map_err(at_line)?;
            if is_first {
                self.doubt = self.doubt.take().map(at_line);
            }
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
            return Err(format!("expected {expected} columns, got {got}"));
        }
        if is_first && record.iter().all(is_name) {
            return self.header(record);
        }
        let start = values.len();
        let wanted = self.wanted.as_deref();
        let fields: &mut dyn Iterator<Item = &[u8]> = match wanted {
            Some(wanted) => &mut wanted.iter().filter_map(|&column| record.get(column)),
            None => &mut record.iter(),
        };
        for field in fields {
            let Some(number) = number(field) else {
                values.truncate(start);
                let got = shortened(field);
                return Err(format!("expected numbers with commas between them, got {got}"));
            };
            values.push(number);
        }
        Ok(())
    }

    /// Takes columns by their names. Where those that are known stand in their places, columns are
    /// taken in order.
    fn header(&mut self, record: &csv::ByteRecord) -> Result<(), String> {
        let is = |name: &str, field: &[u8]| field.eq_ignore_ascii_case(name.as_bytes());
        let of = |name: &&str| record.iter().position(|field| is(name, field));
        let mut known = self.names.concat();
        known.retain(|name| of(name).is_some());
        let twice = |name: &&&str| record.iter().filter(|field| is(name, field)).count() > 1;
        if let Some(name) = known.iter().find(twice) {
            return Err(format!("two columns are named {name}"));
        }
        let is_in_order = |set: &&[&str]| {
            let is_in_place = |name: &&str| of(name).is_some_and(|at| set.get(at) == Some(name));
            set.len() == record.len() && known.iter().all(is_in_place)
        };
        // Unknown names stand for as many numbers as are wanted.
        let is_as_wide = self.names.iter().any(|set| set.len() == record.len());
        let names = self.names;
        let unknown = || {
            let sets: Vec<String> = names.iter().map(|set| set.join(",")).collect();
            let fields: Vec<String> = record.iter().map(shortened).collect();
            format!("the columns must be named {}, got {}", sets.join(" or "), fields.join(","))
        };
        if known.is_empty() && is_as_wide {
            self.doubt = Some(unknown());
            return Ok(());
        }
        if self.names.iter().any(is_in_order) {
            return Ok(());
        }
        let order = |set: &&[&str]| set.iter().map(of).collect::<Option<Vec<usize>>>();
        self.wanted = self.names.iter().find_map(order);
        if self.wanted.is_none() {
            return Err(unknown());
        }
        Ok(())
    }
}

/// Whether a field is that of a header: no number, and none that is misspelt or followed by others.
fn is_name(field: &[u8]) -> bool {
    let starts_like_a_number = |c: &u8| c.is_ascii_digit() || b"+-.".contains(c);
    number(field).is_none() && !field.first().is_some_and(starts_like_a_number)
}

/// A field as a message shows it.
fn shortened(field: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(field);
    let start: String = text.chars().take(MOST).collect();
    let rest = if text.chars().nth(MOST).is_some() { "..." } else { "" };
    format!("{start:?}{rest}")
}

/// The number of line breaks.
fn breaks(bytes: &[u8]) -> u64 {
    // A break more is a piece more.
    bytes.split(|&byte| byte == b'\n').count() as u64 - 1
}

fn number(field: &[u8]) -> Option<f64> {
    std::str::from_utf8(field).ok()?.parse().ok()
}
