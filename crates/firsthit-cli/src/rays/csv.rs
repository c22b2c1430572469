//! Rays as text.

use super::Table;

/// Lines of numbers; the first one may be a header, lines with # are comments.
pub(super) fn csv(bytes: &[u8]) -> Result<Table, String> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .flexible(true)
        .from_reader(bytes);
    let mut table = Table::default();
    let mut record = csv::ByteRecord::new();
    let mut columns = None;
    while reader
        .read_byte_record(&mut record)
        .map_err(|error| error.to_string())?
    {
        let line = record.position().map_or(0, csv::Position::line);
        let numbers: Vec<Option<f64>> = record.iter().map(number).collect();
        let expected = *columns.get_or_insert(numbers.len());
        if numbers.len() != expected {
            let got = numbers.len();
            return Err(format!(
                "line {line}: expected {expected} numbers, got {got}"
            ));
        }
        let is_first = table.values.is_empty() && table.columns == 0;
        table.columns = expected;
        if is_first && numbers.iter().all(Option::is_none) {
            // A header is a first line in which nothing is a number.
            continue;
        }
        let numbers: Option<Vec<f64>> = numbers.into_iter().collect();
        let expected = || format!("line {line}: expected numbers with commas between them");
        table.values.extend(numbers.ok_or_else(expected)?);
    }
    // No rays are rays too.
    table.columns = columns.unwrap_or(6);
    Ok(table)
}

fn number(field: &[u8]) -> Option<f64> {
    std::str::from_utf8(field).ok()?.parse().ok()
}
