//! The channels of scans.

use crate::error::{Error, Result};
use crate::image::{Channel, Data, Description, Display, Frame, Metadata, Origin, Unit};

/// A channel of a scan: its name, the numbers of each return, whether these are whole, and what it
/// is.
#[derive(Clone, Copy)]
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) components: usize,
    pub(super) is_whole: bool,
    /// Whether a scan has it only if it was asked for.
    pub(super) is_optional: bool,
    description: Description,
}

const fn whole(name: &'static str, about: &'static str) -> Column {
    column(name, true, Unit::None, None, about)
}

const fn column(
    name: &'static str,
    is_whole: bool,
    unit: Unit,
    frame: Option<&'static str>,
    about: &'static str,
) -> Column {
    Column {
        name,
        components: 1,
        is_whole,
        is_optional: false,
        description: Description { about, unit, frame },
    }
}

const fn point(name: &'static str, frame: &'static str, about: &'static str) -> Column {
    let column = column(name, false, Unit::SceneLength, Some(frame), about);
    Column { components: 3, ..column }
}

const fn optional(column: Column) -> Column {
    Column { is_optional: true, ..column }
}

/// All of them, in their order.
#[rustfmt::skip]
pub(super) const COLUMNS: [Column; 14] = [
    point("point", "world", "where the return is: along the middle of the beam"),
    point("sensor_point", "sensor", "the same from the scanner, forwards, left and up"),
    column("range", false, Unit::SceneLength, Some("sensor"), "distance along the beam"),
    whole("object", "identifier of the object that was met"),
    whole("primitive", "index of the triangle that was met in its mesh"),
    column("incidence", false, Unit::Radian, None, "angle between the beam and the normal"),
    whole("ring", "number of the laser"),
    whole("row", "row of the beam"),
    whole("column", "column of the beam"),
    column("time", false, Unit::Second, None, "time of the beam"),
    whole("return_number", "number of the return in its beam, from 1"),
    whole("number_of_returns", "returns of the beam, kept or not; max_returns at most"),
    optional(column("intensity", false, Unit::None, None, "share of the light that comes back")),
    optional(whole("classification", "class of the object that was met")),
];

/// The channel of that name with `data`.
pub(super) fn channel(name: &str, data: Data) -> Result<Channel> {
    let unknown = || Error::argument("channel", "one of a scan", name);
    let column = COLUMNS.iter().find(|column| column.name == name).ok_or_else(unknown)?;
    Ok(Channel {
        name: column.name.into(),
        components: column.components,
        data,
        display: match (column.components, column.is_whole) {
            (3, _) => Display::Position,
            (_, true) => Display::Identifier,
            (_, false) => Display::Quantity,
        },
        description: column.description,
    })
}

/// The metadata of a scan of `count` returns with the channels of these names.
///
/// # Errors
///
/// [`Error::Argument`] for the name of no channel.
#[doc(hidden)]
pub fn metadata(names: &[String], count: u64, origin: Origin) -> Result<Metadata> {
    let mut frame = Frame::new([0]).from_origin(origin);
    for name in names {
        let is_whole = COLUMNS.iter().any(|column| column.name == name && column.is_whole);
        let none = if is_whole { Data::Int32(Vec::new()) } else { Data::Float64(Vec::new()) };
        frame.push(channel(name, none)?)?;
    }
    let metadata = frame.metadata();
    Ok(Metadata { shape: vec![count], ..metadata })
}
