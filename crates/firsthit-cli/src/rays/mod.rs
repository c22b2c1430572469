//! Rays from files: a file per kind of file.

mod csv;
mod npy;
mod stdin;

use std::fmt::Display;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use firsthit::error::escaped;
use firsthit::image::{Points, points_of};
use firsthit::{DVec3, Ray, RayFilter, Rays, Side};

use crate::console::warn;
use crate::failure::Failure;
pub(crate) use stdin::Feed;

pub(crate) type Triples = Vec<[f64; 3]>;

/// Rays as numbers: for each an origin and a direction.
pub(crate) struct RayArrays {
    origins: Triples,
    directions: Triples,
    limits: Limits,
}

/// The limits of rays.
#[derive(Clone, Copy)]
pub(crate) struct Limits {
    /// Hits have a t above this.
    pub(crate) t_min: f64,
    /// Hits have a t up to this.
    pub(crate) t_max: f64,
    /// The side of surfaces that rays pass through.
    pub(crate) cull: Option<Side>,
}

/// Rays of lines that come bit by bit.
pub(crate) struct RayLines {
    lines: csv::Lines,
    limits: Limits,
}

impl RayLines {
    pub(crate) fn new(limits: Limits) -> Self {
        Self { lines: csv::Lines::new(csv::OF_RAYS), limits }
    }

    /// The rays of some more lines; and, where a line is wrong, why: the rays are then those before
    /// it.
    pub(crate) fn read(&mut self, bytes: &[u8]) -> (RayArrays, Result<(), Failure>) {
        let mut values = Vec::new();
        let read = self.lines.read(bytes, &mut values);
        let columns = self.lines.numbers();
        let table = Table { columns, values };
        let mut rays =
            RayArrays { origins: Vec::new(), directions: Vec::new(), limits: self.limits };
        let of_table = origins_and_directions(std::slice::from_ref(&table));
        let read = match of_table {
            Ok((origins, directions)) => {
                (rays.origins, rays.directions) = (origins, directions);
                read
            }
            Err(what) => read.and(Err(what)),
        };
        (rays, read.map_err(|what| bad(Path::new("-"), &what)))
    }
}

/// Whether a text of rays begins so, and not an array.
pub(crate) fn is_text(mark: &[u8]) -> bool {
    !mark.starts_with(NPY) && !mark.starts_with(NPZ)
}

const NPY: &[u8] = b"\x93NUMPY";
const NPZ: &[u8] = b"PK";

impl Rays for RayArrays {
    fn len(&self) -> usize {
        self.origins.len()
    }

    fn ray(&self, index: usize) -> Ray {
        Ray::new(DVec3::from(self.origins[index]), DVec3::from(self.directions[index]))
            .beyond(self.limits.t_min)
            .up_to(self.limits.t_max)
    }

    fn is_filtered(&self) -> bool {
        self.limits.cull.is_some()
    }

    fn filter(&self, _index: usize) -> RayFilter {
        RayFilter { cull: self.limits.cull, ..RayFilter::NONE }
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
    limits: Limits,
) -> Result<RayArrays, Failure> {
    if directions == Some(rays) {
        return Err(Failure::usage(
            "origins and directions are the same file; rays of shape (n, 6) need no second one",
        ));
    }
    let tables = load(rays, "rays", csv::OF_RAYS)?;
    arrays(tables, (rays, directions), limits)
}

/// The rays from one place to each point of a file.
pub(crate) fn read_from(path: &Path, from: DVec3, limits: Limits) -> Result<RayArrays, Failure> {
    let positions = read_positions(path)?;
    let direction = |point: &[f64; 3]| (DVec3::from(*point) - from).to_array();
    Ok(RayArrays {
        origins: vec![from.to_array(); positions.len()],
        directions: positions.iter().map(direction).collect(),
        limits,
    })
}

/// Reads points of whatever format from a file, `-` being standard input.
pub(crate) fn read_cloud(path: &Path) -> Result<Points, Failure> {
    let bytes = bytes(path).map_err(|error| bad(path, &error))?;
    let is_stdin = path == Path::new("-");
    let name = if is_stdin { Path::new("standard input") } else { path };
    let points = points_of(name, &bytes)?;
    let notes = points.notes.iter().map(|note| format!("{}: {note}", escaped(name)));
    warn(&notes.collect::<Vec<_>>());
    Ok(points)
}

/// The positions of a file's points.
pub(crate) fn read_positions(path: &Path) -> Result<Triples, Failure> {
    read_cloud(path).map(|points| points.positions)
}

/// Pairs of one place and each point of a file.
pub(crate) fn read_pairs_from(path: &Path, from: DVec3) -> Result<Vec<[f64; 6]>, Failure> {
    let [a, b, c] = from.to_array();
    let pair = |[x, y, z]: [f64; 3]| [a, b, c, x, y, z];
    Ok(read_positions(path)?.into_iter().map(pair).collect())
}

/// Reads pairs of points from a file, `-` being standard input.
pub(crate) fn read_pairs(path: &Path) -> Result<Vec<[f64; 6]>, Failure> {
    let tables = load(path, "points", csv::OF_PAIRS)?;
    match &tables[..] {
        [table] if table.columns == 6 => Ok(table.values.as_chunks().0.to_vec()),
        tables => {
            let columns = tables.iter().map(|table| table.columns.to_string());
            let columns = columns.collect::<Vec<_>>().join(" and ");
            let what = format!(
                "pairs of points must be one array of 6 columns, got columns: {columns}; --from X,Y,Z is for points that are seen from one place"
            );
            Err(bad(path, &what))
        }
    }
}

/// [`read`] where the bytes of standard input are there already.
pub(crate) fn read_bytes(bytes: Vec<u8>, limits: Limits) -> Result<RayArrays, Failure> {
    let rays = Path::new("-");
    let tables = tables(bytes, "rays", csv::OF_RAYS).map_err(|what| bad(rays, &what))?;
    arrays(tables, (rays, None), limits)
}

fn arrays(
    mut tables: Vec<Table>,
    (rays, directions): (&Path, Option<&Path>),
    limits: Limits,
) -> Result<RayArrays, Failure> {
    if let Some(path) = directions {
        tables.extend(load(path, "rays", csv::OF_DIRECTIONS)?);
    }
    let (origins, directions) = origins_and_directions(&tables).map_err(|what| bad(rays, &what))?;
    Ok(RayArrays { origins, directions, limits })
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

/// The arrays in a file; `alone` is what the one is called in an archive that is all that is
/// wanted, `names` what columns of text are.
fn load(path: &Path, alone: &str, names: csv::Names) -> Result<Vec<Table>, Failure> {
    let bytes = bytes(path).map_err(|error| bad(path, &error))?;
    tables(bytes, alone, names).map_err(|what| bad(path, &what))
}

fn bad(path: &Path, what: &dyn Display) -> Failure {
    if path == Path::new("-") {
        Failure::bad_input(format!("standard input: {what}"))
    } else {
        Failure::bad_input(format!("{}: {what}", escaped(path)))
    }
}

fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        io::stdin().lock().read_to_end(&mut bytes)?;
    } else {
        if path.is_dir() {
            return Err(io::Error::other("a folder, not a file"));
        }
        File::open(path)?.read_to_end(&mut bytes)?;
        firsthit::inputs::note(path);
    }
    Ok(bytes)
}

/// The arrays in a file, whose kind its first bytes tell.
fn tables(bytes: Vec<u8>, alone: &str, names: csv::Names) -> Result<Vec<Table>, String> {
    if bytes.starts_with(NPY) {
        Ok(vec![npy::npy(&bytes)?])
    } else if bytes.starts_with(NPZ) {
        npy::npz(bytes, alone)
    } else {
        Ok(vec![csv::csv(&bytes, names)?])
    }
}
