//! Rays from files: a file per kind of file.

mod csv;
mod npy;

use std::fmt::Display;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use firsthit::{DVec3, Ray, Rays};

use crate::failure::Failure;

type Triples = Vec<[f64; 3]>;

/// Rays as numbers: for each an origin and a direction.
pub(crate) struct RayArrays {
    origins: Triples,
    directions: Triples,
    t_min: f64,
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
        .beyond(self.t_min)
        .up_to(self.t_max)
    }
}

/// A table of numbers, row by row.
#[derive(Default)]
struct Table {
    columns: usize,
    values: Vec<f64>,
}

impl Table {
    fn triples(&self, first: usize) -> Triples {
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
    (t_min, t_max): (Option<f64>, Option<f64>),
) -> Result<RayArrays, Failure> {
    if directions == Some(rays) {
        return Err(Failure::usage(
            "origins and directions are the same file; rays of shape (n, 6) need no second one",
        ));
    }
    let mut tables = load(rays)?;
    if let Some(path) = directions {
        tables.extend(load(path)?);
    }
    let (origins, directions) = origins_and_directions(&tables).map_err(|what| bad(rays, &what))?;
    Ok(RayArrays {
        origins,
        directions,
        t_min: t_min.unwrap_or(0.0),
        t_max: t_max.unwrap_or(f64::INFINITY),
    })
}

fn origins_and_directions(tables: &[Table]) -> Result<(Triples, Triples), String> {
    match tables {
        [table] if table.columns == 6 => Ok((table.triples(0), table.triples(3))),
        [origins, directions] if origins.columns == 3 && directions.columns == 3 => {
            let (origins, directions) = (origins.triples(0), directions.triples(0));
            if origins.len() == directions.len() {
                Ok((origins, directions))
            } else {
                let (origins, directions) = (origins.len(), directions.len());
                Err(format!("{origins} origins, but {directions} directions"))
            }
        }
        tables => {
            let columns = tables.iter().map(|table| table.columns.to_string());
            Err(format!(
                "rays must be one array of 6 columns, or two of 3 (origins and directions), got columns: {}",
                columns.collect::<Vec<_>>().join(" and ")
            ))
        }
    }
}

fn load(path: &Path) -> Result<Vec<Table>, Failure> {
    let bytes = bytes(path).map_err(|error| bad(path, &error))?;
    tables(bytes).map_err(|what| bad(path, &what))
}

fn bad(path: &Path, what: &dyn Display) -> Failure {
    if path == Path::new("-") {
        Failure::bad_input(format!("standard input: {what}"))
    } else {
        Failure::bad_input(format!("{}: {what}", firsthit::error::escaped(path)))
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
        Ok(vec![npy::npy(&bytes)?])
    } else if bytes.starts_with(b"PK") {
        npy::npz(bytes)
    } else {
        Ok(vec![csv::csv(&bytes)?])
    }
}
