//! A part of a picture that is rendered at once, sample by sample.
//!
//! 1. Trace the rays through the pixels' centres, a grid of them.
//! 2. Make from these hits all channels but the colour.
//! 3. Shade the hits, a few hundred at a time, and add the colours to the pixels' sums; count them for mattes.
//! 4. For each further sample, trace the grid moved to another point of the pixels, and of the lens, shade, add and count.
//!
//! Every sample goes by the tiles of `shoot`. Sums are in the order of the samples, so it does not matter how many are added
//! at a time.

use rayon::prelude::*;

use super::Picture;
use super::mattes::Mattes;
use super::region::{Part, Region};
use crate::channel::{self, Shots};
use crate::error::{Error, Result};
use crate::geometry::{Color, DVec3, Filtered, Hit, Ray, RayFilter, Rays, single};
use crate::image::{Channel, Data, Frame};
use crate::memory::zeroed;
use crate::shade::Samples;
use crate::shoot::{First, Hits, trace_into};
use crate::watch::Watch;

/// How many pixels are shaded at a time: enough that their shadow rays go together, few enough for slow shaders.
const SHADED: usize = 256;

/// See [the module](self).
pub(super) struct Slab<'a> {
    picture: &'a Picture<'a>,
    part: Part<'a>,
    hits: Hits,
    /// Red, green, blue and coverage, summed over the samples so far.
    sums: Vec<[f64; 4]>,
    samples: u32,
    /// All channels that are made from the first sample, in their order.
    channels: Vec<Channel>,
    /// The counts of the channels of mattes, in their order.
    mattes: Vec<Mattes>,
}

impl<'a> Slab<'a> {
    pub(super) fn new(picture: &'a Picture<'a>, region: Region) -> Result<Self> {
        let part = Part::new(picture.sensor, region);
        let pixels = if picture.has_color() { part.len() } else { 0 };
        let mattes = picture.channels.iter();
        let mattes = mattes.map(|kind| Mattes::new(kind, picture.scene, part.len()));
        let mattes = mattes.filter_map(Result::transpose);
        Ok(Self {
            mattes: mattes.collect::<Result<_>>()?,
            picture,
            sums: zeroed(pixels)?,
            part,
            hits: Hits::default(),
            samples: 0,
            channels: Vec::new(),
        })
    }

    /// Adds the next sample.
    pub(super) fn add_sample(&mut self, watch: &dyn Watch) -> Result<()> {
        let picture = self.picture;
        self.part.go_to(self.samples);
        let answers = (First, &mut self.hits);
        let cull = picture.cull;
        let filter = RayFilter {
            cull,
            ..RayFilter::NONE
        };
        let rays = Filtered::new(&self.part, filter);
        trace_into(picture.engine, picture.scene, &rays, answers, watch)?;
        if self.samples == 0 {
            let shots = Shots {
                scene: picture.scene,
                rays: &self.part,
                hits: &self.hits,
                sensor: Some(&self.part),
            };
            let plain = picture.channels.iter().copied();
            let plain: Vec<_> = plain.filter(|kind| !kind.needs_samples()).collect();
            self.channels = channel::make(&plain, &shots, watch)?;
        }
        for mattes in &mut self.mattes {
            mattes.add(picture.scene, &self.hits);
        }
        self.shade(watch)?;
        self.samples += 1;
        Ok(())
    }

    /// Adds the colours of the current hits to the sums.
    fn shade(&mut self, watch: &dyn Watch) -> Result<()> {
        let (part, hits, sample) = (&self.part, &self.hits, self.samples);
        let shade = self.picture.shade;
        let chunks = self.sums.par_chunks_mut(SHADED).enumerate();
        chunks.try_for_each(|(chunk, sums)| {
            if watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            let pixels = chunk * SHADED..chunk * SHADED + sums.len();
            let mut rays = [Ray::new(DVec3::ZERO, DVec3::ZERO); SHADED];
            let rays = &mut rays[..sums.len()];
            part.read(pixels.start, rays);
            let mut numbers = [0; SHADED];
            part.number(pixels.start, &mut numbers[..sums.len()]);
            let mut met = [Hit::MISS; SHADED];
            let met = &mut met[..sums.len()];
            for (met, index) in met.iter_mut().zip(pixels) {
                *met = hits.get(index);
            }
            let samples = Samples {
                rays,
                hits: met,
                pixels: &numbers[..sums.len()],
                sample,
            };
            let mut colors = [Color::ZERO; SHADED];
            shade.shade_all(&samples, &mut colors[..sums.len()]);
            for ((sum, color), hit) in sums.iter_mut().zip(colors).zip(samples.hits) {
                let covered = f64::from(u8::from(hit.t < f64::INFINITY));
                for (sum, value) in sum.iter_mut().zip([color.x, color.y, color.z, covered]) {
                    *sum += value;
                }
            }
            watch.advance(sums.len() as u64);
            Ok(())
        })
    }

    /// The part of the picture as it is, its colour the mean of the samples so far.
    pub(super) fn frame(&self) -> Result<Frame> {
        self.frame_with(self.channels.clone())
    }

    /// The same, without a copy.
    pub(super) fn into_frame(mut self) -> Result<Frame> {
        let plain = std::mem::take(&mut self.channels);
        self.frame_with(plain)
    }

    fn frame_with(&self, plain: Vec<Channel>) -> Result<Frame> {
        let mut plain = plain.into_iter();
        let mut mattes = self.mattes.iter();
        let mut frame = self.picture.frame(&self.part.region);
        for kind in self.picture.channels {
            frame.push(if kind.matte().is_some() {
                let mattes = mattes.next().expect("there are some for each such kind");
                kind.channel(mattes.data(kind.components, self.samples.max(1))?)
            } else if !kind.needs_shade() {
                plain.next().expect("it was made with the first sample")
            } else if self.picture.shade.is_transparent() {
                kind.transparent_channel(self.means::<4>()?)
            } else {
                kind.channel(self.means::<3>()?)
            })?;
        }
        Ok(frame)
    }

    /// `N` numbers for each pixel: red, green, blue, and with `N` = 4 the coverage.
    fn means<const N: usize>(&self) -> Result<Data> {
        let mut means = zeroed::<f32>(self.sums.len().saturating_mul(N))?;
        let count = f64::from(self.samples.max(1));
        let chunk = 1 << 12;
        let sums = self.sums.par_chunks(chunk);
        let chunks = means.par_chunks_mut(N * chunk).zip(sums);
        chunks.for_each(|(out, sums)| {
            for (out, sum) in out.chunks_mut(N).zip(sums) {
                for (out, sum) in out.iter_mut().zip(sum) {
                    *out = single(sum / count);
                }
            }
        });
        Ok(Data::Float32(means))
    }
}
