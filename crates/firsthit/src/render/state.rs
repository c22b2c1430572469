//! The state of a picture in a file, to go on with it another time.

use std::borrow::Cow;
use std::path::Path;
use std::time::{Duration, Instant};

use super::{Picture, Progressive};
use crate::channel::Kind;
use crate::error::{Error, Result, escaped};
use crate::image::{
    self, Array, Channel, Data, Description, Display, Frame, Metadata, Numbers, Origin, Unit,
};
use crate::watch::Watch;

/// How often the state of a picture is kept.
const KEPT_EVERY: Duration = Duration::from_secs(20);

impl<'a> Picture<'a> {
    /// The picture, made from where the file of a state says that it was left, if that is there. The state is kept in the file: now and
    /// then, at the end, and when the watch stops the work, which ends after the sample that is on the way.
    ///
    /// It has the bytes of [`render`](Self::render). More [`samples`](Self::samples) another time go on from there.
    ///
    /// # Errors
    ///
    /// Those of [`render`](Self::render) and of [`resume_from`](Self::resume_from), and [`Error::Argument`] for a picture without colours,
    /// for a file whose name does not end in `.npz`, and for a state that has more samples already.
    pub fn render_resumed(&self, path: &Path, watch: &dyn Watch) -> Result<Frame> {
        let extension = path.extension().unwrap_or_default();
        if !extension.eq_ignore_ascii_case("npz") {
            let expected = "a file whose name ends in .npz";
            return Err(Error::argument("resume", expected, escaped(path)));
        }
        if !self.has_color() {
            let expected = "left out without color, alpha or samples among the channels";
            return Err(Error::argument("resume", expected, escaped(path)));
        }
        let (shaded, plain): (Vec<&Kind>, Vec<&Kind>) =
            self.channels.iter().partition(|kind| kind.needs_shade());
        let shaded = Picture {
            channels: &shaded,
            ..self.clone()
        };
        let mut going_on = if path.exists() {
            shaded.resume_from(path)?
        } else {
            shaded.start()?
        };
        if going_on.samples() > self.samples {
            let known = going_on.samples();
            let got = format!("{}, and {} has {known}", self.samples, escaped(path));
            let expected = "at least as many as the state has";
            return Err(Error::argument("samples", expected, got));
        }
        let mut kept = Instant::now();
        while going_on.samples() < self.samples && going_on.add_sample(&Counted(watch))? {
            let is_stopped = watch.is_stopped();
            // What is done is not lost, whatever happens.
            if is_stopped || kept.elapsed() > KEPT_EVERY {
                going_on.state()?.save(path)?;
                kept = Instant::now();
            }
            if is_stopped {
                return Err(Error::Interrupted);
            }
        }
        going_on.state()?.save(path)?;
        // As many as there are of the colours: a noise may have ended them.
        let plain = Picture {
            channels: &plain,
            samples: going_on.samples(),
            noise: None,
            ..self.clone()
        };
        put_together(self.channels, going_on.frame()?, plain.render(watch)?)
    }

    /// Resumes a progressive render whose state is in a file that [`Frame::save`] wrote of [`Progressive::state`], as [`Picture::resume`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Picture::resume`] and of [`image::read`], and [`Error::Argument`] for the state of another scene, camera or shading.
    pub fn resume_from(&'a self, path: &Path) -> Result<Progressive<'a>> {
        self.resume_checked(|own| {
            let output = image::read(path)?;
            if let Some(what) = difference(&own.metadata(), output.metadata.as_ref()) {
                let got = format!("{}, which has {what}", escaped(path));
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

/// Counts, and is not stopped: half a sample could not be gone on with.
struct Counted<'a>(&'a dyn Watch);

impl Watch for Counted<'_> {
    fn advance(&self, rays: u64) {
        self.0.advance(rays);
    }
}

/// One frame of the colours and of all else, in the order that was asked for.
fn put_together(channels: &[&Kind], colors: Frame, others: Frame) -> Result<Frame> {
    let origin = colors.origin().clone();
    let mut whole = Frame::new(colors.shape().to_vec()).from_origin(Origin {
        names: others.origin().names.clone(),
        cryptomatte: others.origin().cryptomatte.clone(),
        ..origin
    });
    let mut made = [colors.into_channels(), others.into_channels()].concat();
    let place = |name: &str| channels.iter().position(|kind| kind.name == name);
    made.sort_by_key(|channel| place(&channel.name));
    for channel in made {
        whole.push(channel)?;
    }
    Ok(whole)
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
