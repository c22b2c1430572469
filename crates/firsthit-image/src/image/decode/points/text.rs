//! Points as text, a line each: numbers with commas, semicolons, tabs or blanks between, with or
//! without a line of names before.

use crate::error::escape_controls;
use crate::image::{Array, ArrayValues, Output};

/// The names of a point's coordinates: sets of them, in any case.
const AXES: &[[&str; 3]] = &[
    ["x", "y", "z"],
    ["position_x", "position_y", "position_z"],
    ["point_x", "point_y", "point_z"],
    ["easting", "northing", "elevation"],
    ["easting", "northing", "height"],
    ["ox", "oy", "oz"],
];

/// The beginnings of lines that are no points.
const COMMENTS: [&[u8]; 3] = [b"#", b"//", b"%"];

/// The most columns: far above any real file's.
const MOST_COLUMNS: usize = 256;

/// The separator of a line's fields.
#[derive(Debug, Clone, Copy)]
enum Separator {
    Byte(u8),
    Blanks,
}

impl Separator {
    fn of(line: &[u8]) -> Self {
        if let Some(byte) = b",;".iter().find(|byte| line.contains(byte)) {
            return Self::Byte(*byte);
        }
        // Several tabs in a row line columns up.
        let has_tabs = line.contains(&b'\t');
        if has_tabs && !line.split(|&byte| byte == b'\t').any(|field| field.trim_ascii().is_empty())
        {
            return Self::Byte(b'\t');
        }
        Self::Blanks
    }

    fn fields(self, line: &[u8]) -> Vec<&[u8]> {
        match self {
            Self::Byte(byte) => line.split(|&other| other == byte).map(bare).collect(),
            Self::Blanks => {
                let fields = line.split(u8::is_ascii_whitespace);
                fields.filter(|field| !field.is_empty()).map(bare).collect()
            }
        }
    }
}

/// A field without blanks and quotes around.
fn bare(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    let within = field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\""));
    within.map_or(field, <[u8]>::trim_ascii)
}

/// Numbers by columns.
struct Columns {
    separator: Separator,
    /// The columns of the coordinates.
    axes: [usize; 3],
    /// The columns with names, each as long as it is all numbers.
    named: Vec<(String, Option<Vec<f64>>)>,
    /// The fault of a line of unknown names, where no point follows.
    doubt: Option<String>,
}

/// The points of a text.
pub(in crate::image) fn text(bytes: &[u8]) -> Result<Output, String> {
    if bytes.contains(&0) {
        return Err("neither text nor a PLY, PCD, LAS, LAZ, NPY or NPZ".to_owned());
    }
    let mut table: Option<Columns> = None;
    // A line of names perhaps, or a number of points.
    let mut before: Option<Vec<u8>> = None;
    let mut is_counted = false;
    for (number, line) in (1_u64..).zip(bytes.split(|&byte| byte == b'\n')) {
        let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line).trim_ascii();
        if line.is_empty() {
            continue;
        }
        let comment = COMMENTS.iter().find_map(|mark| line.strip_prefix(*mark));
        if let Some(comment) = comment {
            if table.is_none() {
                before = Some(comment.trim_ascii_start().to_owned());
            }
            continue;
        }
        let at_line = |what: String| format!("line {number}: {what}");
        let Some(table) = &mut table else {
            let separator = Separator::of(line);
            let fields = separator.fields(line);
            // A PTS says first how many points there are.
            if !is_counted && fields.len() == 1 && line.iter().all(u8::is_ascii_digit) {
                is_counted = true;
                continue;
            }
            let mut made =
                Columns::begin(separator, &fields, before.as_deref()).map_err(at_line)?;
            made.doubt = made.doubt.map(at_line);
            table = Some(made);
            continue;
        };
        let fields = table.separator.fields(line);
        table.fields(&fields).map_err(at_line)?;
    }
    match table {
        Some(Columns { doubt: Some(doubt), .. }) => Err(doubt),
        Some(table) => Ok(table.output()),
        None if is_counted => Err("expected points, got a number alone".to_owned()),
        None => Ok(Output { arrays: vec![positions(Vec::new())], ..Output::default() }),
    }
}

impl Columns {
    /// Takes up the first line: of names, or of the first point.
    fn begin(
        separator: Separator,
        fields: &[&[u8]],
        comment: Option<&[u8]>,
    ) -> Result<Self, String> {
        if fields.len() > MOST_COLUMNS {
            return Err(format!("more than {MOST_COLUMNS} columns"));
        }
        let is_header = fields.iter().all(is_name);
        let said = comment.map(|comment| Separator::of(comment).fields(comment));
        let said = said.filter(|said| said.len() == fields.len() && !is_header);
        let names: Vec<String> =
            (said.as_deref().unwrap_or(fields).iter()).map(|name| named(name)).collect();
        let by_name = AXES.iter().find_map(|set| places(set, &names));
        let is_named = is_header || (said.is_some() && by_name.is_some());
        let expected = || {
            let got: Vec<String> = fields.iter().take(8).map(|field| shown(field)).collect();
            let expected =
                "expected x, y and z of a point, or a line that names the columns x, y and z";
            format!("{expected}, got {}", got.join(" "))
        };
        // Three names stand for three numbers, unless one that is known stands elsewhere.
        let is_elsewhere = |(k, name): (usize, &String)| {
            let set = AXES
                .iter()
                .find_map(|set| set.iter().position(|axis| name.eq_ignore_ascii_case(axis)));
            set.is_some_and(|place| place != k)
        };
        let is_in_order = fields.len() == 3 && !names.iter().enumerate().any(is_elsewhere);
        let axes = match by_name {
            Some(axes) if is_named => axes,
            _ if is_in_order || (!is_header && fields.len() >= 3) => [0, 1, 2],
            _ => return Err(expected()),
        };
        if let Some(name) = twice(&names).filter(|_| is_named) {
            return Err(format!("two columns are named {}", escape_controls(name)));
        }
        let numbered = names.into_iter().enumerate();
        let columns = numbered.map(|(k, name)| {
            let name = if is_named { name } else { format!("column_{k}") };
            (name, Some(Vec::new()))
        });
        let mut made = Self {
            separator,
            axes,
            named: columns.collect(),
            doubt: by_name.is_none().then(expected),
        };
        if !is_header {
            made.fields(fields).map_err(|_| expected())?;
        }
        Ok(made)
    }

    fn fields(&mut self, fields: &[&[u8]]) -> Result<(), String> {
        if fields.len() != self.named.len() {
            let (expected, got) = (self.named.len(), fields.len());
            return Err(format!("expected {expected} columns, got {got}"));
        }
        self.doubt = None;
        for (k, (field, (name, values))) in fields.iter().zip(&mut self.named).enumerate() {
            let value = match number(field) {
                None if self.axes.contains(&k) => {
                    let (name, got) = (shown(name.as_bytes()), shown(field));
                    return Err(format!("expected a number for {name}, got {got}"));
                }
                // An empty field is a missing number.
                None if field.is_empty() => Some(f64::NAN),
                value => value,
            };
            match (value, values.as_mut()) {
                (Some(value), Some(values)) => values.push(value),
                _ => *values = None,
            }
        }
        Ok(())
    }

    fn output(self) -> Output {
        let axis = |axis: usize| {
            let column = self.named.get(axis).and_then(|(_, values)| values.as_deref());
            column.unwrap_or_default()
        };
        let [x, y, z] = self.axes.map(axis);
        let points = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]);
        let mut arrays = vec![positions(points.collect())];
        let count = x.len();
        let others = self.named.iter().enumerate();
        let others = others.filter(|(k, _)| !self.axes.contains(k));
        arrays.extend(others.filter_map(|(_, (name, values))| {
            let values = values.clone()?;
            let is_known = !values.iter().all(|value| value.is_nan());
            let values = ArrayValues::Float64(values);
            is_known.then(|| Array::new(Some(name), vec![count], 1, values, "float64", false))
        }));
        Output { arrays, ..Output::default() }
    }
}

fn positions(points: Vec<[f64; 3]>) -> Array {
    let shape = vec![points.len()];
    let numbers = ArrayValues::Float64(points.into_flattened());
    Array::new(Some("position"), shape, 3, numbers, "float64", false)
}

/// The indices of the columns with these names.
fn places(set: &[&str; 3], names: &[String]) -> Option<[usize; 3]> {
    let [x, y, z] =
        set.map(|wanted| names.iter().position(|name| name.eq_ignore_ascii_case(wanted)));
    Some([x?, y?, z?])
}

/// A name that two columns have.
fn twice(names: &[String]) -> Option<&String> {
    let mut sorted: Vec<&String> = names.iter().filter(|name| !name.is_empty()).collect();
    sorted.sort();
    let mut pairs = sorted.iter().zip(sorted.iter().skip(1));
    pairs.find(|(a, b)| a == b).map(|(a, _)| *a)
}

/// A column's name without its unit, as in `X [m]`.
fn named(field: &[u8]) -> String {
    let name = field.split(|byte| b"[(".contains(byte)).next().unwrap_or_default();
    String::from_utf8_lossy(name.trim_ascii()).into_owned()
}

/// Whether a field is that of a header: no number, and none that is misspelt.
fn is_name(field: &&[u8]) -> bool {
    let starts_like_a_number = |c: &u8| c.is_ascii_digit() || b"+-.".contains(c);
    number(field).is_none() && !field.first().is_some_and(starts_like_a_number)
}

fn number(field: &[u8]) -> Option<f64> {
    std::str::from_utf8(field).ok()?.parse().ok()
}

/// A field as a message shows it.
fn shown(field: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(field);
    let start: String = text.chars().take(MOST).collect();
    let rest = if text.chars().nth(MOST).is_some() { "..." } else { "" };
    format!("'{}'{rest}", escape_controls(&start))
}
