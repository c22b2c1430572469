//! The state of a picture in a file, to go on with it another time.

use std::borrow::Cow;
use std::path::Path;

use super::{Picture, Progressive};
use crate::error::{Error, Result};
use crate::image::{
    self, Array, Channel, Data, Description, Display, Frame, Metadata, Numbers, Unit,
};

impl<'a> Picture<'a> {
    /// Resumes a progressive render whose state is in a file that [`Frame::save`] wrote of [`Progressive::state`], as [`Picture::resume`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Picture::resume`] and of [`image::read`], and [`Error::Argument`] for the state of another scene, camera or shading.
    pub fn resume_from(&'a self, path: &Path) -> Result<Progressive<'a>> {
        self.resume_checked(|own| {
            let output = image::read(path)?;
            if let Some(what) = difference(&own.metadata(), output.metadata.as_ref()) {
                let got = format!("{}, which has {what}", crate::error::escaped(path));
                return Err(Error::argument("state", "that of this picture", got));
            }
            let mut state = Frame::new(own.shape().to_vec());
            for array in output.arrays {
                state.push(channel(array)?)?;
            }
            Ok(Cow::Owned(state))
        })
    }
}

/// What of another picture's metadata differs, in words.
fn difference(own: &Metadata, other: Option<&Metadata>) -> Option<&'static str> {
    let Some(other) = other else {
        return Some("no metadata");
    };
    if other.scene != own.scene {
        Some("another scene")
    } else if (&other.camera, &other.sensor) != (&own.camera, &own.sensor) {
        Some("another camera")
    } else if (&other.shape, &other.pixels) != (&own.shape, &own.pixels) {
        Some("another part of the picture")
    } else if other.shading != own.shading {
        Some("another shader, other light, or another background")
    } else if other.colors != own.colors {
        Some("other colours by numbers")
    } else {
        None
    }
}

fn channel(array: Array) -> Result<Channel> {
    let wrong = || Error::argument("state", "that of this picture", "one of other numbers");
    let data = match array.numbers {
        Numbers::Float64(values) => Data::Float64(values),
        Numbers::Integer(values) => {
            let values = values.into_iter().map(i32::try_from);
            Data::Int32(
                values
                    .collect::<std::result::Result<_, _>>()
                    .map_err(|_| wrong())?,
            )
        }
        Numbers::Float32(_) => return Err(wrong()),
    };
    Ok(Channel {
        name: array.name.ok_or_else(wrong)?.into(),
        components: array.components,
        data,
        display: Display::Quantity,
        description: Description {
            about: "",
            unit: Unit::None,
            frame: None,
        },
    })
}
