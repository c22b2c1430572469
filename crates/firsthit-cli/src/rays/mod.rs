//! Rays from files: a file per kind of file.

mod csv;
mod npy;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use firsthit::{DVec3, Ray, Rays};

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
#[derive(Default)]
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
        Ok(vec![npy::npy(&bytes)?])
    } else if bytes.starts_with(b"PK") {
        npy::npz(bytes)
    } else {
        Ok(vec![csv::csv(&bytes)?])
    }
}
