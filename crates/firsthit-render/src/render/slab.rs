//! A part of a picture that is rendered at once, sample by sample.
//!
//! 1. Trace the rays through the pixels' centres, a grid of them.
//! 2. Make from these hits all channels but the colour.
//! 3. Shade the hits, a few hundred at a time, and add the colours to the pixels' sums; count them
//!    for mattes.
//! 4. For each further sample, trace the grid moved to another point of the pixels, and of the
//!    lens, shade, add and count.
//!
//! Every sample goes by the tiles of `shoot`. Sums are in the order of the samples, so it does not
//! matter how many are added at a time.

use super::Picture;
use super::accumulation::{ALPHA, Accumulation, Activity};
use super::batch::{Batch, Block, split};
use super::mattes::Mattes;
use super::region::{Region, RegionRays};
use crate::channel::{self, ChannelInput, ChannelKind, Make};
use crate::edge::Lines;
use crate::error::{Error, Result};
use crate::geometry::{Color, Filtered, RayFilter, Rays, single};
use crate::image::{Channel, Data, Frame};
use crate::memory::zeroed;
use crate::parallel;
use crate::scene::Background;
use crate::shade::{AmbientOcclusion, Shader, Shading};
use crate::shoot::{First, Hits, trace_into};
use crate::watch::{Watch, stop_if_asked};

/// See [the module](self).
pub(super) struct Slab<'a> {
    picture: &'a Picture<'a>,
    part: RegionRays<'a>,
    hits: Hits,
    known: Accumulation,
    /// The ambient occlusion, if it is asked for: its shader, and the sum over the samples.
    occlusion: Option<(Shading<'a>, Vec<f64>)>,
    samples: u32,
    /// All channels that are made from the first sample, in their order.
    channels: Vec<Channel>,
    /// The counts of the channels of mattes, in their order.
    mattes: Vec<Mattes>,
    /// The share of each pixel that lines of edges cover; empty where there are none.
    covered: Vec<f32>,
}

impl<'a> Slab<'a> {
    pub(super) fn new(
        picture: &'a Picture<'a>,
        part: (Region, Option<&Lines>),
        watch: &dyn Watch,
    ) -> Result<Self> {
        let memory = (Hits::default(), Accumulation::empty(picture.shade));
        Self::in_memory(memory, picture, part, watch)
    }

    /// Another part of the picture, in the same memory.
    pub(super) fn next(self, part: (Region, Option<&Lines>), watch: &dyn Watch) -> Result<Self> {
        // All else goes first: there may not be room for both.
        let Self { picture, hits, known, .. } = self;
        Self::in_memory((hits, known), picture, part, watch)
    }

    fn in_memory(
        (hits, mut known): (Hits, Accumulation),
        picture: &'a Picture<'a>,
        (region, lines): (Region, Option<&Lines>),
        watch: &dyn Watch,
    ) -> Result<Self> {
        let covered = lines.map(|lines| {
            let Region { rows, columns } = region.clone();
            lines.coverage(rows, columns, watch)
        });
        let covered = covered.transpose()?.unwrap_or_default();
        let part = RegionRays::new(picture.sensor, region);
        let pixels = if picture.has_color() { part.len() } else { 0 };
        known.reset(pixels)?;
        let mattes = picture.channels.iter();
        let mattes = mattes.map(|kind| Mattes::new(kind, picture.scene, part.len()));
        let mattes = mattes.filter_map(Result::transpose);
        let occlusion = picture.channels.iter().find_map(|kind| kind.occlusion());
        let occlusion = occlusion.map(|reach| {
            let shader = Shader::AmbientOcclusion(AmbientOcclusion { reach });
            let shading = Shading {
                background: Background::Uniform(Color::ONE),
                sees_environment: false,
                engine: picture.engine,
                ..shader.on(picture.scene)
            };
            Ok((shading, zeroed(part.len())?))
        });
        Ok(Self {
            mattes: mattes.collect::<Result<_>>()?,
            picture,
            known,
            occlusion: occlusion.transpose()?,
            part,
            hits,
            samples: 0,
            channels: Vec::new(),
            covered,
        })
    }

    /// Goes on where a picture was left, of which all samples but the channels of the first are
    /// known.
    pub(super) fn resume(&mut self, state: &Frame) -> Result<()> {
        self.known = Accumulation::taken_from(state, self.part.len(), self.picture.shade)?;
        let counts = &self.known.counts;
        self.samples = counts.iter().copied().max().unwrap_or(0);
        let is_even = counts.iter().all(|&count| count == self.samples);
        if self.picture.noise.is_none() && !is_even {
            let expected = "that of a picture without a noise, as this one";
            let got = "one whose samples ended where it was quiet";
            return Err(Error::argument("state", expected, got));
        }
        Ok(())
    }

    /// The state for [`resume`](Self::resume).
    pub(super) fn state(&self) -> Result<Frame> {
        let mut state = self.picture.frame(&self.part.region, self.samples);
        self.known.put_into(&mut state)?;
        Ok(state)
    }

    /// The number of samples.
    pub(super) fn samples(&self) -> u32 {
        self.samples
    }

    pub(super) fn pixels(&self) -> usize {
        self.part.len()
    }

    /// Adds the next sample, unless the picture is as quiet as was asked for; says whether it did.
    pub(super) fn add_sample(&mut self, watch: &dyn Watch) -> Result<bool> {
        let shape = self.part.region.shape();
        let activity = (self.picture.noise.filter(|_| self.samples > 0))
            .map(|noise| Activity::at(&self.known, shape, self.samples, noise));
        if activity.as_ref().is_some_and(|activity| !activity.is_any()) {
            return Ok(false);
        }
        let picture = self.picture;
        self.part.go_to(self.samples);
        let answers = (First, &mut self.hits);
        let cull = picture.cull;
        let filter = RayFilter { cull, ..RayFilter::NONE };
        let rays = Filtered::new(&self.part, filter);
        trace_into(picture.engine, picture.scene, &rays, answers, watch)?;
        if self.samples == 0 {
            let shots = ChannelInput {
                scene: picture.scene,
                rays: &self.part,
                hits: &self.hits,
                sensor: Some(&self.part),
            };
            let plain = picture.channels.iter().copied();
            let is_plain = |kind: &&ChannelKind| !kind.needs_samples() && !kind.is_edge();
            let plain: Vec<_> = plain.filter(is_plain).collect();
            self.channels = channel::make(&plain, &shots, watch)?;
        }
        for mattes in &mut self.mattes {
            mattes.add(picture.scene, &self.hits);
        }
        self.shade(activity.as_ref(), watch)?;
        self.add_occlusion(watch)?;
        self.samples += 1;
        Ok(true)
    }

    /// Adds the colours of the current hits to the sums, of the active pixels.
    fn shade(&mut self, activity: Option<&Activity>, watch: &dyn Watch) -> Result<()> {
        let (part, hits, sample) = (&self.part, &self.hits, self.samples);
        let width = part.region.columns.len();
        let Picture { scene, shade, cull, .. } = *self.picture;
        let is_transparent = shade.is_transparent();
        let Accumulation { sums, squares, counts, .. } = &mut self.known;
        let blocks = Block::all(sums.len(), width).into_iter();
        let rest = split(squares, width).into_iter().zip(split(counts, width));
        let blocks = blocks.zip(split(sums, width).into_iter().zip(rest));
        let new = || Ok(Batch::new());
        parallel::try_each_with(new, blocks, |batch, (block, (sums, (squares, counts)))| {
            stop_if_asked(watch)?;
            watch.advance(block.len() as u64);
            let goes_on = |k: usize| activity.is_none_or(|activity| activity.has(k));
            if !batch.read((scene, part), hits, block, goes_on) {
                return Ok(());
            }
            let (pixels, colors, coverage) = batch.shade((shade, cull), sample);
            for ((&[row, k], color), covered) in pixels.iter().zip(colors).zip(coverage) {
                let pixel = (&mut sums[row][k], &mut squares[row][k], &mut counts[row][k]);
                Accumulation::add(pixel, (*color, *covered), is_transparent);
            }
            Ok(())
        })
    }

    /// Adds the ambient occlusion at the current hits to its sums.
    fn add_occlusion(&mut self, watch: &dyn Watch) -> Result<()> {
        let (part, hits, sample) = (&self.part, &self.hits, self.samples);
        let Picture { scene, cull, .. } = *self.picture;
        let Some((shading, sums)) = &mut self.occlusion else {
            return Ok(());
        };
        let width = part.region.columns.len();
        let blocks = Block::all(sums.len(), width).into_iter();
        let blocks = blocks.zip(split(sums, width));
        let new = || Ok(Batch::new());
        parallel::try_each_with(new, blocks, |batch, (block, sums)| {
            stop_if_asked(watch)?;
            watch.advance(block.len() as u64);
            batch.read((scene, part), hits, block, |_| true);
            let (pixels, colors, _) = batch.shade((shading, cull), sample);
            for (&[row, k], color) in pixels.iter().zip(colors) {
                sums[row][k] += color.x;
            }
            Ok(())
        })
    }

    /// The part of the picture as it is, its colour the mean of the samples so far.
    pub(super) fn frame(&self) -> Result<Frame> {
        self.frame_with(self.channels.clone())
    }

    /// The frame without a copy: it can be taken once.
    pub(super) fn take_frame(&mut self) -> Result<Frame> {
        let plain = std::mem::take(&mut self.channels);
        self.frame_with(plain)
    }

    fn frame_with(&self, plain: Vec<Channel>) -> Result<Frame> {
        let mut plain = plain.into_iter();
        let mut mattes = self.mattes.iter();
        let samples = if self.picture.needs_samples() && self.samples > 0 {
            self.samples
        } else {
            self.picture.samples
        };
        let mut frame = self.picture.frame(&self.part.region, samples);
        for kind in self.picture.channels {
            frame.push(match kind.make {
                Make::Matte(_) => {
                    let mattes = mattes.next().expect("there are some for each such kind");
                    kind.channel(mattes.data(kind.components, self.samples.max(1))?)
                }
                Make::Edge => {
                    let mut covered = zeroed(self.covered.len())?;
                    covered.copy_from_slice(&self.covered);
                    kind.channel(Data::Float32(covered))
                }
                Make::Samples => kind.channel(self.known.counts()?),
                Make::Alpha => kind.channel(self.alpha()?),
                Make::Occlusion(_) => kind.channel(self.mean_occlusion()?),
                Make::Color if self.picture.shade.is_transparent() => {
                    kind.transparent_channel(self.colors([0, 1, 2, ALPHA])?)
                }
                Make::Color => kind.channel(self.colors([0, 1, 2])?),
                _ => plain.next().expect("it was made with the first sample"),
            })?;
        }
        Ok(frame)
    }

    /// Means of colours, with lines of edges where there are some.
    fn colors<const N: usize>(&self, which: [usize; N]) -> Result<Data> {
        let mut means = self.known.means(which)?;
        self.draw_lines::<N>(&mut means);
        Ok(means)
    }

    /// The alpha of the colours, lines included.
    fn alpha(&self) -> Result<Data> {
        if self.line_color().is_none() {
            return self.known.means([ALPHA]);
        }
        let mut alpha = zeroed::<f32>(self.part.len())?;
        if let Data::Float32(colors) = self.colors([0, 1, 2, ALPHA])? {
            for (alpha, color) in alpha.iter_mut().zip(colors.chunks_exact(4)) {
                *alpha = color[ALPHA];
            }
        }
        Ok(Data::Float32(alpha))
    }

    /// The lines' colour, if there are lines over the colours.
    fn line_color(&self) -> Option<[f64; 4]> {
        let Color { x, y, z } = self.picture.edges?.color;
        Some([x, y, z, 1.0])
    }

    /// Draws the lines of edges over colours of `N` numbers.
    fn draw_lines<const N: usize>(&self, colors: &mut Data) {
        let (Some(line), Data::Float32(values)) = (self.line_color(), colors) else {
            return;
        };
        let covered = self.covered.chunks(parallel::MANY);
        let chunks = values.chunks_mut(N * parallel::MANY).zip(covered);
        parallel::each(chunks, |(colors, covered)| {
            for (color, &covered) in colors.chunks_mut(N).zip(covered) {
                for (value, line) in color.iter_mut().zip(line) {
                    let (mean, covered) = (f64::from(*value), f64::from(covered));
                    *value = single((1.0 - covered) * mean + covered * line);
                }
            }
        });
    }

    fn mean_occlusion(&self) -> Result<Data> {
        let sums = self.occlusion.as_ref().map_or(&[][..], |(_, sums)| sums);
        let mut means = zeroed::<f32>(sums.len())?;
        for (out, sum) in means.iter_mut().zip(sums) {
            *out = single(sum / f64::from(self.samples.max(1)));
        }
        Ok(Data::Float32(means))
    }
}
