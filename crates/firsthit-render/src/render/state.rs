//! The state of a picture in a file, to resume it another time.

use std::borrow::Cow;
use std::path::Path;
use std::time::{Duration, Instant};

use super::{Picture, Progressive, work};
use crate::channel::ChannelKind;
use crate::error::{Error, Result, escaped};
use crate::image::{
    self, Array, ArrayValues, Channel, Data, Description, Display, Frame, Metadata, Origin, Unit,
};
use crate::watch::{OnlyCounts, OnlyStops, Watch};

/// The time between saves of a picture's state.
const SAVE_INTERVAL: Duration = Duration::from_secs(20);

impl<'a> Picture<'a> {
    /// Renders the picture, resuming from the state in the file if that exists. The state is saved
    /// every 20 s, at the end, and when the watch stops the work, which takes effect after the
    /// current sample.
    ///
    /// It has the bytes of [`render`](Self::render). More [`samples`](Self::samples) another time
    /// resume from there.
    ///
    /// # Errors
    ///
    /// The errors of [`render`](Self::render) and of [`resume_from`](Self::resume_from),
    /// [`Error::Argument`] for a picture without colours, for a file whose name does not end in
    /// `.npz`, and for a state that has more samples already, and [`Error::Write`] where the state
    /// cannot be saved, before anything is rendered.
    pub fn render_resumed(&self, path: &Path, watch: &dyn Watch) -> Result<Frame> {
        check_state_file(path)?;
        if !self.has_color() {
            let expected = "left out without color, alpha or samples among the channels";
            return Err(Error::argument("resume", expected, escaped(path)));
        }
        let (shaded, plain): (Vec<&ChannelKind>, Vec<&ChannelKind>) =
            self.channels.iter().partition(|kind| kind.needs_shade());
        let shaded = Picture { channels: &shaded, ..self.clone() };
        let is_there =
            path.try_exists().map_err(|source| Error::Read { path: path.to_owned(), source })?;
        let mut progressive = if is_there {
            shaded.resume_checked(watch, |own| read_state(path, own))?
        } else {
            shaded.start_watched(watch)?
        };
        let known = progressive.samples();
        if known > self.samples {
            let expected = "at least as many as the state has";
            let got = format!("{}, and {} has {known}", self.samples, escaped(path));
            return Err(Error::argument("samples", expected, got));
        }
        if known < self.samples {
            image::check_writable(path)?;
        }
        let pixels = progressive.pixels();
        watch.advance(work(pixels, shaded.channels, known));
        progressive.render_saved(self.samples, path, watch)?;
        let colors = progressive.frame()?;
        if plain.is_empty() {
            return Ok(colors);
        }
        // Of as many samples as the colours: a noise may have ended them.
        let plain = Picture {
            channels: &plain,
            samples: progressive.samples(),
            noise: None,
            ..self.clone()
        };
        let others = plain.render(&OnlyStops(watch))?;
        let all = work(pixels, self.channels, progressive.samples());
        watch.advance(all - work(pixels, shaded.channels, progressive.samples()));
        put_together(self.channels, colors, others)
    }

    /// Resumes a progressive render whose state is in a file that [`Frame::save`] wrote of
    /// [`Progressive::state`], as [`Picture::resume`] does.
    ///
    /// # Errors
    ///
    /// The errors of [`Picture::resume`] and of [`image::read`], and [`Error::Argument`] for the
    /// state of another scene, camera or shading.
    pub fn resume_from(&'a self, path: &Path) -> Result<Progressive<'a>> {
        self.resume_checked(&(), |own| read_state(path, own))
    }
}

impl Progressive<'_> {
    /// Adds samples up to `samples` in all, or until the picture is quiet, and saves the state.
    fn render_saved(&mut self, samples: u32, path: &Path, watch: &dyn Watch) -> Result<()> {
        let known = self.samples();
        let mut saved = Instant::now();
        while self.samples() < samples {
            if watch.is_stopped() {
                if self.samples() > known {
                    self.state()?.save(path)?;
                }
                return Err(Error::Interrupted);
            }
            // Half a sample could not be resumed.
            if !self.add_sample(&OnlyCounts(watch))? {
                break;
            }
            if saved.elapsed() > SAVE_INTERVAL {
                self.state()?.save(path)?;
                saved = Instant::now();
            }
        }
        if self.samples() > known {
            self.state()?.save(path)?;
        }
        Ok(())
    }
}

/// Fails for a file that cannot hold a state.
///
/// # Errors
///
/// [`Error::Argument`] for one whose name does not end in `.npz`.
pub fn check_state_file(path: &Path) -> Result<()> {
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("npz") {
        return Ok(());
    }
    let expected = "a file whose name ends in .npz";
    Err(Error::argument("resume", expected, escaped(path)))
}

/// The state in a file, of the picture whose empty state is `own`.
fn read_state(path: &Path, own: &Frame) -> Result<Cow<'static, Frame>> {
    let output = image::read(path)?;
    if let Some(what) = difference(&own.metadata(), output.metadata.as_ref()) {
        let got = format!("{}, which has {what}", escaped(path));
        return Err(Error::argument("state", "that of this picture", got));
    }
    let mut state = Frame::new(own.shape().to_vec());
    for array in output.arrays {
        if array.shape[..array.shape.len().min(2)] != *own.shape() {
            return Err(wrong_numbers());
        }
        state.push(channel(array)?)?;
    }
    // Those of before there were digests have none.
    let digest = output.metadata.and_then(|metadata| metadata.state);
    if digest.is_some() && digest != state.metadata().state {
        let expected = "that of this picture, as it was written";
        let got = format!("{}, whose numbers were changed since", escaped(path));
        return Err(Error::argument("state", expected, got));
    }
    Ok(Cow::Owned(state))
}

/// One frame of the colours and of all else, in the order that was asked for.
fn put_together(channels: &[&ChannelKind], colors: Frame, others: Frame) -> Result<Frame> {
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

/// The difference of another picture's metadata, in words.
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
        Some("another shader, other light, another background, or another noise")
    } else if other.colors != own.colors {
        Some("other colours by numbers")
    } else {
        None
    }
}

fn wrong_numbers() -> Error {
    Error::argument("state", "that of this picture", "one of other numbers")
}

fn channel(array: Array) -> Result<Channel> {
    let data = match array.numbers {
        ArrayValues::Float64(values) => Data::Float64(values),
        ArrayValues::Integer(values) => {
            let values = values.into_iter().map(i32::try_from);
            Data::Int32(values.collect::<std::result::Result<_, _>>().map_err(|_| wrong_numbers())?)
        }
        ArrayValues::Float32(_) => return Err(wrong_numbers()),
    };
    Ok(Channel {
        name: array.name.ok_or_else(wrong_numbers)?.into(),
        components: array.components,
        data,
        display: Display::Quantity,
        description: Description { about: "", unit: Unit::None, frame: None },
    })
}
