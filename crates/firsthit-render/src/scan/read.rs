//! Scans from files.

use std::path::Path;

use super::Scan;
use super::table::{COLUMNS, Column};
use crate::error::{Error, Place, Result};
use crate::image::{Array, ArrayValues, Data, Metadata, Origin, Output, read};

/// The kinds of sensors that scans are of: scanners, and rays of one's own.
const KINDS: [&str; 2] = ["lidar", "rays"];

/// Reads a scan from an NPZ.
pub(super) fn scan(path: &Path) -> Result<Scan> {
    let wrong = |what: String| Error::Parse { path: path.to_owned(), place: Place::File, what };
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npz")) {
        return Err(wrong("a scan is read from an .npz".to_owned()));
    }
    let scan = fitting(read(path)?);
    scan.map_err(|what| wrong(format!("not a scan of a lidar: {what}")))
}

/// The scan of arrays that fit together.
fn fitting(output: Output) -> std::result::Result<Scan, String> {
    let Output { mut arrays, metadata, .. } = output;
    let metadata = metadata.filter(|metadata| {
        let sensor = metadata.sensor.as_ref();
        sensor.is_some_and(|sensor| KINDS.contains(&&*sensor.kind))
    });
    let metadata = metadata.ok_or("its metadata lack a lidar")?;
    let shape = shape(&metadata)?;
    let mut columns = Vec::new();
    for column in &COLUMNS {
        let is_it = |array: &Array| array.name.as_deref() == Some(column.name);
        match arrays.iter().position(is_it) {
            Some(place) => columns.push((column, arrays.swap_remove(place))),
            None if column.is_optional => {}
            None => return Err(format!("it has no {}", column.name)),
        }
    }
    let count = columns.iter().find(|(column, _)| column.name == "range");
    let count = count.map_or(0, |(_, array)| array.numbers.len());
    let columns = columns.into_iter().map(|(column, array)| {
        let data = numbers(column, count, array)?;
        let most = match column.name {
            "row" => shape[0],
            "column" => shape[1],
            _ => usize::MAX,
        };
        let fits = |&number: &i32| usize::try_from(number).is_ok_and(|number| number < most);
        match &data {
            Data::Int32(values) if most < usize::MAX && !values.iter().all(fits) => {
                Err(format!("{} must be from 0 on and below {most}", column.name))
            }
            _ => Ok((column.name.to_owned(), data)),
        }
    });
    let columns = columns.collect::<std::result::Result<_, String>>()?;
    let origin = Origin {
        scene: metadata.scene,
        sensor: metadata.sensor,
        scan: metadata.scan,
        scans: metadata.scans,
        ..Origin::default()
    };
    Scan::of(columns, shape, origin).map_err(|error| error.to_string())
}

/// Rows and columns of all scans together.
fn shape(metadata: &Metadata) -> std::result::Result<[usize; 2], String> {
    let sensor = metadata.sensor.as_ref();
    let (rows, columns) = sensor.map_or((0, 0), |sensor| (sensor.rows, sensor.columns));
    let each = match &metadata.scans {
        None => vec![columns],
        Some(scans) => {
            let each = scans.as_array().into_iter().flatten();
            let each: Option<Vec<u64>> = each.map(|scan| scan["columns"].as_u64()).collect();
            each.filter(|each| !each.is_empty()).ok_or("its scans have no columns")?
        }
    };
    if !each.iter().all(|count| (1..1 << 31).contains(count)) {
        return Err(format!("its scans have {each:?} columns"));
    }
    let columns: u64 = each.iter().sum();
    let beams = rows.checked_mul(columns).filter(|beams| (1..1 << 62).contains(beams));
    let sides =
        beams.and_then(|_| Some([usize::try_from(rows).ok()?, usize::try_from(columns).ok()?]));
    sides.ok_or_else(|| format!("its lidar has {rows} x {columns} beams"))
}

/// The numbers of a column of `count` returns.
fn numbers(column: &Column, count: usize, array: Array) -> std::result::Result<Data, String> {
    let dtype = if column.is_whole { "int32" } else { "float64" };
    let mut wanted = vec![count];
    wanted.extend(Some(column.components).filter(|&count| count > 1));
    if array.shape != wanted || array.dtype != dtype {
        return Err(format!(
            "{} must be {dtype} of the shape {}, got {} of {}",
            column.name,
            tuple(&wanted),
            array.dtype,
            tuple(&array.shape)
        ));
    }
    match array.numbers {
        ArrayValues::Float64(values) => Ok(Data::Float64(values)),
        ArrayValues::Integer(values) => {
            let small = values.into_iter().map(i32::try_from);
            let small = small.collect::<std::result::Result<_, _>>();
            small.map(Data::Int32).map_err(|error| error.to_string())
        }
        ArrayValues::Float32(_) => Err(format!("{} must be {dtype}", column.name)),
    }
}

/// A shape as NumPy writes it.
fn tuple(shape: &[usize]) -> String {
    if let [one] = shape {
        return format!("({one},)");
    }
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("({})", sides.join(", "))
}
