//! Scans of laser scanners: the returns of beams, their noise, and what is told of each.
//!
//! 1. Shoot the lines of some beams at a time: one of each, or as many as fill its cone
//!    (`lines.rs`).
//! 2. Put hits together that a receiver cannot tell apart, and keep the returns that are wanted
//!    (`returns.rs`).
//! 3. Move returns along their beams by noise, and lose some (`noise.rs`).
//! 4. Make columns of what is left: a [`Scan`].

mod lines;
mod noise;
mod read;
mod returns;
mod settings;
mod table;

pub use settings::{Returns, Rings, ScanSettings};
#[doc(hidden)]
pub use table::metadata;

use std::collections::BTreeMap;
use std::path::Path;
use std::slice::from_ref as one;

use serde_json::{Value, json};

use self::lines::Lines;
use self::noise::Noise;
use self::returns::Kept;
use crate::channel::{ChannelInput, kind, make};
use crate::error::{Error, Result};
use crate::geometry::Rays;
use crate::geometry::summary::summary;
use crate::image::{Data, Frame, Origin, write_scan};
use crate::memory::no_room_for;
use crate::parallel;
use crate::render::origin;
use crate::scene::Scene;
use crate::sensor::{Lidar, Pattern, Return, Sensor};
use crate::shoot::{Hits, RaysOfHits};
use crate::watch::{OnlyStops, Watch};

/// About how many lines are shot at a time.
const BATCH: usize = 1 << 20;

/// The returns of a laser scanner, beam by beam in the order of the picture's rows, and each beam's
/// by range without its noise. A beam that met nothing has none.
///
/// Its [`frame`](Self::frame) has a channel for each quantity: `point` and `sensor_point`, `range`,
/// `object`, `primitive`, `incidence`, `ring`, `row`, `column`, `time`, `return_number` and
/// `number_of_returns`, and where they were asked for `intensity` and `classification`.
/// `docs/sensors.md` says what each is.
#[derive(Clone)]
pub struct Scan {
    frame: Frame,
    shape: [usize; 2],
}

summary!(Scan, "Scan", |it| "returns": it.len(), "shape": it.shape);

/// A return, with all that is told of it.
struct Row {
    place: Return,
    range: f64,
    object: i32,
    primitive: i32,
    incidence: f64,
    number: i32,
    total: i32,
    intensity: f64,
}

/// Scans a scene with a laser scanner, by all threads of the current rayon pool. `watch` is told of
/// every line.
///
/// A beam is a line, whose returns are what the line crosses: the first, or with other
/// [`returns`](ScanSettings::returns) all crossings, as if surfaces let some of the light through.
/// With a [`divergence`](ScanSettings::divergence) it is a cone of lines instead, each of which
/// ends at its first hit.
///
/// ```
/// use firsthit::scan::{Returns, ScanSettings, scan};
/// use firsthit::sensor::{Lidar, LidarModel};
/// use firsthit::{Cuboid, DVec3, Object, Pose, Scene};
///
/// let room = Cuboid::new(DVec3::new(-4.0, -3.0, -1.0), DVec3::new(4.0, 3.0, 2.0))?;
/// let scene = Scene::new(vec![Object::new(room)])?;
/// let lidar = Lidar::new(LidarModel::Vlp16.pattern(10.0, Some(360), 0.0)?, Pose::IDENTITY)?;
/// let settings = ScanSettings { noise: Some([0.01, 0.0]), seed: Some(1), ..ScanSettings::default() };
/// let scan = scan(&lidar, &scene, &settings, &())?;
/// assert_eq!((scan.len(), scan.shape()), (16 * 360, [16, 360]));
/// # let folder = std::env::temp_dir().join("firsthit-scan");
/// # std::fs::create_dir_all(&folder).unwrap();
/// # let file = folder.join("room.las");
/// scan.save(&file)?;
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// The errors of [`ScanSettings::check`], [`Error::Limit`] when the returns do not fit into memory,
/// and [`Error::Interrupted`] when `watch` stops it.
pub fn scan(
    lidar: &Lidar,
    scene: &Scene,
    settings: &ScanSettings,
    watch: &dyn Watch,
) -> Result<Scan> {
    let columns = columns(lidar, scene, settings, watch)?;
    let origin = Origin { scan: Some(settings.record()), ..origin(scene, Some(lidar), None, &[]) };
    Scan::of(columns, lidar.shape(), origin)
}

/// The columns of a scan by their names.
#[doc(hidden)]
pub fn columns(
    lidar: &Lidar,
    scene: &Scene,
    settings: &ScanSettings,
    watch: &dyn Watch,
) -> Result<Vec<(String, Data)>> {
    settings.check()?;
    let noise = Noise::of(settings);
    let step = (BATCH / settings.lines()).max(1);
    let mut rows = Vec::new();
    for first in (0..lidar.len()).step_by(step) {
        let beams = first..lidar.len().min(first + step);
        let lines = Lines::new(lidar, beams, settings)?;
        let met = lines.shot(scene, settings, watch)?;
        let kept = returns::of(&met, &lines, scene, settings, watch)?;
        let angles = incidences(&met.hits, &lines, scene, &kept, watch)?;
        let parts = kept.chunks(parallel::MANY).zip(angles.chunks(parallel::MANY));
        let mut more = parallel::gather(parts, |(kept, angles)| {
            let row = |(kept, &incidence): (&Kept, &f64)| {
                let range = noise.of_return(kept, settings)?;
                Some(Row {
                    place: lidar.return_at(kept.beam, range),
                    range,
                    object: met.hits.object[kept.at],
                    primitive: met.hits.primitive[kept.at],
                    incidence,
                    number: kept.number,
                    total: kept.total,
                    intensity: kept.echo,
                })
            };
            kept.iter().zip(angles).filter_map(row).collect()
        });
        let room = rows.try_reserve(more.len());
        room.map_err(|_| no_room_for("returns of a scan"))?;
        rows.append(&mut more);
    }
    if settings.rings == Rings::LowestFirst {
        let places = from_lowest(lidar.pattern());
        for row in &mut rows {
            row.place.ring = places[&row.place.ring];
        }
    }
    table_of(&rows, settings.intensity)
}

/// The angles between beams and surfaces at the nearest hits of returns.
fn incidences(
    hits: &Hits,
    lines: &Lines<'_>,
    scene: &Scene,
    kept: &[Kept],
    watch: &dyn Watch,
) -> Result<Vec<f64>> {
    let some = Hits {
        t: kept.iter().map(|kept| hits.t[kept.at]).collect(),
        object: kept.iter().map(|kept| hits.object[kept.at]).collect(),
        primitive: kept.iter().map(|kept| hits.primitive[kept.at]).collect(),
        barycentric: kept.iter().map(|kept| hits.barycentric[kept.at]).collect(),
    };
    let numbers: Vec<i32> = kept.iter().map(|kept| kept.line).collect();
    let shots =
        ChannelInput { scene, rays: &RaysOfHits::new(lines, &numbers), hits: &some, sensor: None };
    let made = make(&[kind("incidence")?], &shots, &OnlyStops(watch))?;
    let angles = made.into_iter().next().map(|channel| channel.data);
    match angles {
        Some(Data::Float64(angles)) => Ok(angles),
        _ => Ok(Vec::new()),
    }
}

/// The place of each laser from that with the lowest beam on, by its number.
fn from_lowest(pattern: &Pattern) -> BTreeMap<i32, i32> {
    let mut lowest: BTreeMap<i32, f64> = BTreeMap::new();
    for (&ring, &elevation) in pattern.rings().iter().zip(pattern.elevations()) {
        let low = lowest.entry(ring).or_insert(elevation);
        *low = low.min(elevation);
    }
    let mut lasers: Vec<(i32, f64)> = lowest.into_iter().collect();
    // Stable: of equal ones that with the lower number is first.
    lasers.sort_by(|a, b| a.1.total_cmp(&b.1));
    lasers.into_iter().map(|laser| laser.0).zip(0..).collect()
}

fn table_of(rows: &[Row], has_intensity: bool) -> Result<Vec<(String, Data)>> {
    let doubles = |name: &str, value: fn(&Row) -> &[f64]| {
        let mut column = Data::Float64(Vec::new());
        column.reserve(rows.len(), rows.first().map_or(1, |row| value(row).len()))?;
        if let Data::Float64(values) = &mut column {
            values.extend(rows.iter().flat_map(value));
        }
        Ok((name.to_owned(), column))
    };
    let integers = |name: &str, value: fn(&Row) -> i32| {
        let mut column = Data::Int32(Vec::new());
        column.reserve(rows.len(), 1)?;
        if let Data::Int32(values) = &mut column {
            values.extend(rows.iter().map(value));
        }
        Ok((name.to_owned(), column))
    };
    let mut columns = vec![
        doubles("point", |row| row.place.point.as_ref())?,
        doubles("sensor_point", |row| row.place.sensor_point.as_ref())?,
        doubles("range", |row| one(&row.range))?,
        integers("object", |row| row.object)?,
        integers("primitive", |row| row.primitive)?,
        doubles("incidence", |row| one(&row.incidence))?,
        integers("ring", |row| row.place.ring)?,
        integers("row", |row| row.place.row)?,
        integers("column", |row| row.place.column)?,
        doubles("time", |row| one(&row.place.time))?,
        integers("return_number", |row| row.number)?,
        integers("number_of_returns", |row| row.total)?,
    ];
    if has_intensity {
        columns.push(doubles("intensity", |row| one(&row.intensity))?);
    }
    Ok(columns)
}

impl Scan {
    /// The scan of columns with the names of the [channels](Self::frame), for `shape` beams.
    #[doc(hidden)]
    pub fn of(columns: Vec<(String, Data)>, shape: [usize; 2], origin: Origin) -> Result<Self> {
        let count = columns.iter().find(|column| column.0 == "range");
        let mut frame = Frame::new([count.map_or(0, |column| column.1.len())]).from_origin(origin);
        for (name, data) in columns {
            frame.push(table::channel(&name, data)?)?;
        }
        Ok(Self { frame, shape })
    }

    /// The returns, with a channel for each quantity.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The returns, taken out of the scan.
    pub fn into_frame(self) -> Frame {
        self.frame
    }

    /// Rows and columns of the scanner's beams.
    pub fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// The number of returns.
    pub fn len(&self) -> usize {
        self.frame.shape().iter().product()
    }

    /// Whether there are no returns.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The scan with a channel `classification`: of each return the class of its object, such as
    /// LAS has it. `classes` are those of the objects, in their order; objects beyond have class 0.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a scan that has classes already.
    pub fn classified(mut self, classes: &[u8]) -> Result<Self> {
        let Some(Data::Int32(objects)) = self.frame.channel("object").map(|channel| &channel.data)
        else {
            return Err(Error::argument("scan", "one with objects", "none"));
        };
        let class = |&object: &i32| {
            let object = usize::try_from(object).ok();
            object.and_then(|object| classes.get(object)).map_or(0, |&class| i32::from(class))
        };
        let data = Data::Int32(objects.iter().map(class).collect());
        self.frame.push(table::channel("classification", data)?)?;
        Ok(self)
    }

    /// The returns of several scans as one, such as the turns of a scanner that drives: all of the
    /// first, then all of the next. `column` counts on from scan to scan. The metadata have the
    /// first one's scanner and scene, and under `scans` the digests, columns and settings of each.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for no scans, other numbers of rows, other channels, and 2^31 columns or
    /// more.
    pub fn joined(scans: impl IntoIterator<Item = Self>) -> Result<Self> {
        let mut scans = scans.into_iter();
        let Some(mut all) = scans.next() else {
            return Err(Error::argument("scans", "at least one", "none"));
        };
        let mut digests = digests(&all);
        for scan in scans {
            let different = |expected, [a, b]: [String; 2]| {
                Err(Error::argument("scans", expected, format!("{a} and {b}")))
            };
            let rows = [all.shape[0], scan.shape[0]];
            if rows[0] != rows[1] {
                return different("of as many rows", rows.map(|rows| rows.to_string()));
            }
            let names = [&all, &scan].map(|scan| names(scan).join(", "));
            if names[0] != names[1] {
                return different("of the same arrays", names);
            }
            digests.extend(self::digests(&scan));
            let before = all.shape[1];
            all.shape[1] += scan.shape[1];
            let fits = i32::try_from(all.shape[1]).is_ok();
            let Some(before) = i32::try_from(before).ok().filter(|_| fits) else {
                let expected = "of fewer than 2^31 columns in all";
                return Err(Error::argument("scans", expected, all.shape[1]));
            };
            all = all.then(scan, before)?;
        }
        let mut origin = all.frame.origin().clone();
        origin.scans = Some(Value::Array(digests));
        let Self { frame, shape } = all;
        Ok(Self { frame: frame.from_origin(origin), shape })
    }

    /// The returns with those of another scan behind, whose columns begin at `before`.
    fn then(self, other: Self, before: i32) -> Result<Self> {
        let (origin, shape) = (self.frame.origin().clone(), self.shape);
        let pairs = self.frame.into_channels().into_iter().zip(other.frame.into_channels());
        let joined = pairs.map(|(mut channel, mut more)| {
            if let ("column", Data::Int32(columns)) = (&*more.name, &mut more.data) {
                for column in columns {
                    *column += before;
                }
            }
            channel.data.append(more.data);
            (channel.name.into_owned(), channel.data)
        });
        Self::of(joined.collect(), shape, origin)
    }

    /// Writes the returns to a file, whole or not at all. The extension names the format: `.npz`,
    /// `.ply` and `.csv` are exact; a `.pcd` has all but times, and far points, as float32. `.las`
    /// is LAS 1.4 with point format 6: coordinates are rounded to steps of 1e-4 scene units, of
    /// 1e-3 where these do not reach, and so on; what the format has no place for is in extra
    /// bytes. `.laz` is the same packed.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for another extension, and for numbers that the format cannot hold;
    /// [`Error::Write`] if the system refuses.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.write(path.as_ref(), &())
    }

    /// As [`save`](Self::save); `watch` can stop it.
    ///
    /// # Errors
    ///
    /// The errors of [`save`](Self::save), and [`Error::Interrupted`].
    pub fn write(&self, path: &Path, watch: &dyn Watch) -> Result<()> {
        write_scan(&self.frame, path, watch)
    }

    /// Reads a scan from an `.npz` that [`save`](Self::save) wrote, as it was.
    ///
    /// # Errors
    ///
    /// [`Error::Read`] if the system refuses, and [`Error::Parse`] for what is no such file.
    pub fn read(path: &Path) -> Result<Self> {
        read::scan(path)
    }
}

fn names(scan: &Scan) -> Vec<&str> {
    scan.frame.channels().iter().map(|channel| &*channel.name).collect()
}

/// Of each scan in one the digests of the scanner and the scene, and the settings.
fn digests(scan: &Scan) -> Vec<Value> {
    let origin = scan.frame.origin();
    if let Some(Value::Array(scans)) = &origin.scans {
        return scans.clone();
    }
    let sensor = origin.sensor.as_ref();
    vec![json!({
        "sensor": sensor.map(|sensor| &sensor.digest),
        "columns": sensor.map(|sensor| sensor.columns),
        "scene": origin.scene,
        "scan": origin.scan,
    })]
}
