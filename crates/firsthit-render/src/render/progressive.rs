//! Pictures that are made one sample after the other.

use std::borrow::Cow;

use super::slab::Slab;
use super::{Picture, check_samples};
use crate::channel::ChannelKind;
use crate::error::{Error, Result};
use crate::geometry::require;
use crate::image::Frame;
use crate::watch::Watch;

impl<'a> Picture<'a> {
    /// Begins the picture, to be made one sample after the other.
    ///
    /// # Errors
    ///
    /// The errors of [`Picture::render`].
    pub fn start(&'a self) -> Result<Progressive<'a>> {
        self.start_watched(&())
    }

    pub(super) fn start_watched(&'a self, watch: &dyn Watch) -> Result<Progressive<'a>> {
        let region = self.checked()?;
        if self.needs_samples() {
            check_samples(self.sensor, self.samples)?;
        }
        let lines = self.lines(&region, watch)?;
        let slab = Slab::new(self, (region, lines.as_ref()), watch)?;
        Ok(Progressive { slab })
    }

    /// Resumes a saved progressive render, from what [`Progressive::state`] gave. All must be as it
    /// was. Channels other than those of all samples are made with the first sample, so a resumed
    /// picture has none of them.
    ///
    /// # Errors
    ///
    /// The errors of [`Picture::render`], and [`Error::Argument`] for the state of another picture,
    /// and for a channel that would be missing.
    pub fn resume(&'a self, state: &Frame) -> Result<Progressive<'a>> {
        self.resume_checked(&(), |_| Ok(Cow::Borrowed(state)))
    }

    /// Goes on from a state that is made or checked by what the new picture says of itself.
    pub(super) fn resume_checked<'s>(
        &'a self,
        watch: &dyn Watch,
        state: impl FnOnce(&Frame) -> Result<Cow<'s, Frame>>,
    ) -> Result<Progressive<'a>> {
        let is_lost = |kind: &&&ChannelKind| !kind.needs_shade();
        if let Some(kind) = self.channels.iter().find(is_lost) {
            let expected = "color, alpha or samples of a picture that is gone on with";
            return Err(Error::argument("channel", expected, &*kind.name));
        }
        let mut progressive = self.start_watched(watch)?;
        let state = state(&progressive.state()?)?;
        progressive.slab.resume(&state)?;
        Ok(progressive)
    }
}

/// A picture on the way: the mean of the samples so far.
#[expect(missing_debug_implementations, reason = "it is work on the way")]
pub struct Progressive<'a> {
    slab: Slab<'a>,
}

impl Progressive<'_> {
    /// Adds the next sample. N of them, one after the other, give the bytes of N at once, whatever
    /// [`Picture::samples`] says. Returns whether it did: with a [`Picture::noise`], a picture that
    /// is quiet has had its last.
    ///
    /// # Errors
    ///
    /// The errors of [`Picture::render`].
    pub fn add_sample(&mut self, watch: &dyn Watch) -> Result<bool> {
        self.slab.add_sample(watch)
    }

    /// The number of samples.
    pub fn samples(&self) -> u32 {
        self.slab.samples()
    }

    pub(super) fn pixels(&self) -> usize {
        self.slab.pixels()
    }

    /// The state of the pixels, for [`Picture::resume`]: sums of colours and of squares of
    /// luminance in float64, and the number of samples. `.npz` holds it.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] when it does not fit into memory.
    pub fn state(&self) -> Result<Frame> {
        self.slab.state()
    }

    /// The picture as it is.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] before the first sample, and [`Error::Limit`] when it does not fit into
    /// memory.
    pub fn frame(&self) -> Result<Frame> {
        let is_begun = self.samples() > 0;
        require("frame", "that of a picture with a sample", is_begun, "none")?;
        self.slab.frame()
    }
}
