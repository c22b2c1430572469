//! Rays from files, and hits as CSV.

use std::fs::File;
use std::io::{self, Cursor, Read, Write};
use std::path::Path;

use firsthit::image::{Data, Frame};
use firsthit::{DVec3, Ray, Rays};
use npyz::{DType, Deserialize, NpyFile, Order, TypeChar};

use crate::failure::Failure;

/// Rays as numbers: for each an origin and a direction.
pub(crate) struct RayArrays {
    origins: Vec<[f64; 3]>,
    directions: Vec<[f64; 3]>,
    t_max: f64,
}

impl Rays for RayArrays {
    fn len(&self) -> usize {
        self.origins.len()
    }

    fn ray(&self, index: usize) -> Ray {
        Ray::new(
            DVec3::from(self.origins[index]),
            DVec3::from(self.directions[index]),
        )
        .up_to(self.t_max)
    }
}

/// A table of numbers, row by row.
struct Table {
    columns: usize,
    values: Vec<f64>,
}

impl Table {
    fn triples(&self, first: usize) -> Vec<[f64; 3]> {
        self.values
            .chunks_exact(self.columns)
            .map(|row| [row[first], row[first + 1], row[first + 2]])
            .collect()
    }
}

/// Reads rays from one or two files, `-` being standard input.
pub(crate) fn read(
    rays: &Path,
    directions: Option<&Path>,
    t_max: Option<f64>,
) -> Result<RayArrays, Failure> {
    if directions == Some(rays) {
        return Err(Failure::usage(
            "origins and directions are the same file; rays of shape (n, 6) need no second one",
        ));
    }
    let name = |path: &Path| {
        if path == Path::new("-") {
            "standard input".into()
        } else {
            firsthit::error::escaped(path)
        }
    };
    let bad = |path: &Path, what: String| Failure::bad_input(format!("{}: {what}", name(path)));
    let t_max = t_max.unwrap_or(f64::INFINITY);
    let load = |path: &Path| -> Result<Vec<Table>, Failure> {
        let bytes =
            bytes(path).map_err(|error| Failure::reading(Path::new(&name(path)), &error))?;
        tables(bytes).map_err(|what| bad(path, what))
    };
    let mut all = load(rays)?;
    if let Some(path) = directions {
        all.extend(load(path)?);
    }
    match &all[..] {
        [table] if table.columns == 6 => Ok(RayArrays {
            origins: table.triples(0),
            directions: table.triples(3),
            t_max,
        }),
        [origins, directions] if origins.columns == 3 && directions.columns == 3 => {
            let (origins, directions) = (origins.triples(0), directions.triples(0));
            if origins.len() != directions.len() {
                let what = format!(
                    "{} origins, but {} directions",
                    origins.len(),
                    directions.len()
                );
                return Err(bad(rays, what));
            }
            Ok(RayArrays {
                origins,
                directions,
                t_max,
            })
        }
        tables => {
            let columns: Vec<String> = tables
                .iter()
                .map(|table| table.columns.to_string())
                .collect();
            let what = format!(
                "rays must be one array of 6 columns, or two of 3 (origins and directions), got columns: {}",
                columns.join(" and ")
            );
            Err(bad(rays, what))
        }
    }
}

fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        io::stdin().lock().read_to_end(&mut bytes)?;
    } else {
        File::open(path)?.read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}

/// The arrays in a file, whose kind its first bytes tell.
fn tables(bytes: Vec<u8>) -> Result<Vec<Table>, String> {
    if bytes.starts_with(b"\x93NUMPY") {
        Ok(vec![npy(&bytes)?])
    } else if bytes.starts_with(b"PK") {
        npz(bytes)
    } else {
        Ok(vec![csv(&bytes)?])
    }
}

fn npz(bytes: Vec<u8>) -> Result<Vec<Table>, String> {
    let mut archive =
        zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let names: Vec<String> = archive
        .file_names()
        .filter_map(|name| Some(name.ok()?.into_owned()))
        .collect();
    let pick = |wanted: &[&str]| {
        let entries = wanted.iter().map(|wanted| format!("{wanted}.npy"));
        entries.into_iter().find(|entry| names.contains(entry))
    };
    let mut table = |name: &str| {
        let mut entry = archive
            .by_name(name)
            .map_err(|error| format!("{name}: {error}"))?;
        let mut bytes = Vec::new();
        entry
            .read_to_end(&mut bytes)
            .map_err(|error| format!("{name}: {error}"))?;
        npy(&bytes).map_err(|error| format!("{name}: {error}"))
    };
    if let Some(rays) = pick(&["rays"]) {
        return Ok(vec![table(&rays)?]);
    }
    let origins = pick(&["origins", "origin"]);
    let directions = pick(&["directions", "direction", "dir"]);
    match (origins, directions) {
        (Some(origins), Some(directions)) => Ok(vec![table(&origins)?, table(&directions)?]),
        _ => Err(format!(
            "expected entries origins and directions, or rays; got {}",
            names.join(", ")
        )),
    }
}

/// An array of shape (n, columns) of any type of number, of either byte order, in C or Fortran order.
fn npy(bytes: &[u8]) -> Result<Table, String> {
    let file = NpyFile::new(bytes).map_err(|error| error.to_string())?;
    let &[rows, columns] = file.shape() else {
        return Err(format!(
            "expected an array of shape (n, 6) or (n, 3), got {:?}",
            file.shape()
        ));
    };
    let DType::Plain(kind) = file.dtype() else {
        return Err("expected plain numbers, got records".into());
    };
    let (rows, columns) = (usize::try_from(rows), usize::try_from(columns));
    let (Ok(rows), Ok(columns)) = (rows, columns) else {
        return Err("the array is too large".into());
    };
    // A header may claim anything; what is there is what counts.
    let size = kind.num_bytes().unwrap_or(1).max(1);
    if columns == 0
        || rows
            .checked_mul(columns)
            .is_none_or(|count| count > bytes.len() / size)
    {
        return Err(format!(
            "the array of shape ({rows}, {columns}) is longer than the file"
        ));
    }
    let order = file.order();
    let values = match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 8) => plain(file, |x: f64| x),
        (TypeChar::Float, 4) => plain(file, <f64 as From<f32>>::from),
        (TypeChar::Int, 4) => plain(file, <f64 as From<i32>>::from),
        (TypeChar::Int, 8) => plain(file, |x: i64| x as f64),
        (TypeChar::Int, 2) => plain(file, <f64 as From<i16>>::from),
        (TypeChar::Int, 1) => plain(file, <f64 as From<i8>>::from),
        (TypeChar::Uint, 4) => plain(file, <f64 as From<u32>>::from),
        (TypeChar::Uint, 8) => plain(file, |x: u64| x as f64),
        (TypeChar::Uint, 2) => plain(file, <f64 as From<u16>>::from),
        (TypeChar::Uint, 1) => plain(file, <f64 as From<u8>>::from),
        _ => {
            return Err(format!(
                "expected floats (32 or 64 bit) or integers, got {kind}"
            ));
        }
    };
    let values = values.map_err(|error| error.to_string())?;
    let values = match order {
        Order::C => values,
        Order::Fortran => (0..rows * columns)
            .map(|k| values[k % columns * rows + k / columns])
            .collect(),
    };
    Ok(Table { columns, values })
}

fn plain<T: Deserialize>(file: NpyFile<&[u8]>, convert: impl Fn(T) -> f64) -> io::Result<Vec<f64>> {
    Ok(file.into_vec::<T>()?.into_iter().map(convert).collect())
}

/// Lines of numbers; the first one may be a header, lines with # are comments.
fn csv(bytes: &[u8]) -> Result<Table, String> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .flexible(true)
        .from_reader(bytes);
    let mut table = Table {
        columns: 0,
        values: Vec::new(),
    };
    let mut record = csv::StringRecord::new();
    let mut first = true;
    while reader
        .read_record(&mut record)
        .map_err(|error| error.to_string())?
    {
        let line = record.position().map_or(0, csv::Position::line);
        let numbers: Option<Vec<f64>> = record.iter().map(|field| field.parse().ok()).collect();
        match numbers {
            // A header is a first line in which nothing is a number.
            None if first && record.iter().all(|field| field.parse::<f64>().is_err()) => {}
            None => {
                return Err(format!(
                    "line {line}: expected numbers with commas between them"
                ));
            }
            Some(numbers) => {
                if table.columns != 0 && table.columns != numbers.len() {
                    return Err(format!(
                        "line {line}: expected {} numbers, got {}",
                        table.columns,
                        numbers.len()
                    ));
                }
                table.columns = numbers.len();
                table.values.extend(numbers);
            }
        }
        first = false;
    }
    if table.columns == 0 {
        // No rays are rays too.
        table.columns = 6;
    }
    Ok(table)
}

/// One line for each ray, after a header; a channel of several numbers makes several columns.
pub(crate) fn write_csv(frame: &Frame, out: &mut dyn Write) -> io::Result<()> {
    let mut header = Vec::new();
    for channel in frame.channels() {
        match (channel.components, channel.name) {
            (1, name) => header.push(name.to_owned()),
            (3, "barycentric") => header.extend((0..3).map(|k| format!("barycentric_{k}"))),
            (2, name) => header.extend(["u", "v"].map(|axis| format!("{name}_{axis}"))),
            (_, name) => header.extend(["x", "y", "z"].map(|axis| format!("{name}_{axis}"))),
        }
    }
    writeln!(out, "{}", header.join(","))?;
    let count: usize = frame.shape().iter().product();
    for row in 0..count {
        let mut separator = "";
        for channel in frame.channels() {
            for k in row * channel.components..(row + 1) * channel.components {
                write!(out, "{separator}")?;
                match &channel.data {
                    // The shortest number that reads back as the same one.
                    Data::Float64(values) if values[k].is_nan() => write!(out, "nan")?,
                    Data::Float64(values) => write!(out, "{}", values[k])?,
                    Data::Float32(values) => write!(out, "{}", values[k])?,
                    Data::Int32(values) => write!(out, "{}", values[k])?,
                    Data::Bool(values) => write!(out, "{}", u8::from(values[k]))?,
                }
                separator = ",";
            }
        }
        writeln!(out)?;
    }
    Ok(())
}
