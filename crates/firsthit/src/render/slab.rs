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
use super::accumulation::{ALPHA, Accumulation, Activity};
use super::mattes::Mattes;
use super::region::{Part, Region};
use crate::channel::{self, Kind, Shots};
use crate::edge::Lines;
use crate::error::{Error, Result};
use crate::geometry::{Color, DVec3, Filtered, Hit, Ray, RayFilter, Rays, Side, single};
use crate::image::{Channel, ColorBar, Data, Frame};
use crate::memory::zeroed;
use crate::scene::{Background, Scene};
use crate::shade::{AmbientOcclusion, Samples, Shade, Shader, Shading};
use crate::shoot::{First, Hits, Prefetcher, trace_into};
use crate::watch::Watch;

/// How many pixels are shaded at a time: enough that their shadow rays go together, few enough for slow shaders.
const SHADED: usize = 256;

/// The side of the squares in whose order they are: rays from sixteen neighbours on all sides go together better than from a row.
const SQUARE: usize = 4;

/// See [the module](self).
pub(super) struct Slab<'a> {
    picture: &'a Picture<'a>,
    part: Part<'a>,
    hits: Hits,
    known: Accumulation,
    /// What is made of ambient occlusion, if anything: its shader, and the sum over the samples.
    occlusion: Option<(Shading<'a>, Vec<f64>)>,
    samples: u32,
    /// All channels that are made from the first sample, in their order.
    channels: Vec<Channel>,
    /// The counts of the channels of mattes, in their order.
    mattes: Vec<Mattes>,
    /// What is drawn over the colours.
    bar: Option<ColorBar>,
    /// How much of each pixel lines of edges cover; nothing where there are none.
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

    /// Another part of the picture, in the same memory: memory that is new takes the system longer to give than rays take to fill it.
    pub(super) fn next(self, part: (Region, Option<&Lines>), watch: &dyn Watch) -> Result<Self> {
        Self::in_memory((self.hits, self.known), self.picture, part, watch)
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
        let part = Part::new(picture.sensor, region);
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
                engine: picture.engine,
                ..shader.on(picture.scene)
            };
            Ok((shading, zeroed(part.len())?))
        });
        Ok(Self {
            mattes: mattes.collect::<Result<_>>()?,
            bar: picture.bar()?,
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

    /// Goes on where a picture was left, of which all samples but the channels of the first are known.
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

    /// What [`resume`](Self::resume) takes.
    pub(super) fn state(&self) -> Result<Frame> {
        let mut state = self.picture.frame(&self.part.region, self.samples);
        self.known.put_into(&mut state)?;
        Ok(state)
    }

    /// How many samples there are.
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
            let is_plain = |kind: &&Kind| !kind.needs_samples() && !kind.is_edge();
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

    /// Adds the colours of the current hits to the sums, of the pixels that go on.
    fn shade(&mut self, activity: Option<&Activity>, watch: &dyn Watch) -> Result<()> {
        let (part, hits, sample) = (&self.part, &self.hits, self.samples);
        let width = part.region.columns.len();
        let band = SQUARE * width;
        let Picture {
            scene, shade, cull, ..
        } = *self.picture;
        let is_transparent = shade.is_transparent();
        let Accumulation {
            sums,
            squares,
            counts,
            ..
        } = &mut self.known;
        let rest = squares
            .par_chunks_mut(band)
            .zip(counts.par_chunks_mut(band));
        let bands = sums.par_chunks_mut(band).zip(rest).enumerate();
        bands.try_for_each_init(Batch::new, |batch, (number, (sums, (squares, counts)))| {
            let first = number * band;
            for block in Block::all(sums.len(), width) {
                if watch.is_stopped() {
                    return Err(Error::Interrupted);
                }
                watch.advance(block.len() as u64);
                let goes_on = |k: usize| activity.is_none_or(|activity| activity.has(first + k));
                if !batch.read((scene, part), hits, (first, block), goes_on) {
                    continue;
                }
                let (places, colors, coverage) = batch.shade((shade, cull), sample);
                for ((&k, color), covered) in places.iter().zip(colors).zip(coverage) {
                    let pixel = (&mut sums[k], &mut squares[k], &mut counts[k]);
                    Accumulation::add(pixel, (*color, *covered), is_transparent);
                }
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
        let band = SQUARE * width;
        let bands = sums.par_chunks_mut(band).enumerate();
        bands.try_for_each_init(Batch::new, |batch, (number, sums)| {
            for block in Block::all(sums.len(), width) {
                if watch.is_stopped() {
                    return Err(Error::Interrupted);
                }
                watch.advance(block.len() as u64);
                batch.read((scene, part), hits, (number * band, block), |_| true);
                let (places, colors, _) = batch.shade((shading, cull), sample);
                for (&k, color) in places.iter().zip(colors) {
                    sums[k] += color.x;
                }
            }
            Ok(())
        })
    }

    /// The part of the picture as it is, its colour the mean of the samples so far.
    pub(super) fn frame(&self) -> Result<Frame> {
        self.frame_with(self.channels.clone())
    }

    /// The same, without a copy: it can be taken once.
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
            frame.push(if kind.matte().is_some() {
                let mattes = mattes.next().expect("there are some for each such kind");
                kind.channel(mattes.data(kind.components, self.samples.max(1))?)
            } else if kind.is_edge() {
                let mut covered = zeroed(self.covered.len())?;
                covered.copy_from_slice(&self.covered);
                kind.channel(Data::Float32(covered))
            } else if kind.is_sample_count() {
                kind.channel(self.known.counts()?)
            } else if kind.is_alpha() {
                kind.channel(self.alpha()?)
            } else if kind.occlusion().is_some() {
                kind.channel(self.mean_occlusion()?)
            } else if !kind.needs_shade() {
                plain.next().expect("it was made with the first sample")
            } else if self.picture.shade.is_transparent() {
                kind.transparent_channel(self.colors([0, 1, 2, ALPHA])?)
            } else {
                kind.channel(self.colors([0, 1, 2])?)
            })?;
        }
        Ok(frame)
    }

    /// Means of colours, with lines of edges and the bar of a colour map where there is one.
    fn colors<const N: usize>(&self, which: [usize; N]) -> Result<Data> {
        let mut means = self.known.means(which)?;
        self.draw_lines::<N>(&mut means);
        if let Some(bar) = &self.bar {
            let Region { rows, columns } = &self.part.region;
            bar.draw(&mut means, N, (rows, columns));
        }
        Ok(means)
    }

    /// The alpha of the colours, lines and bar included.
    fn alpha(&self) -> Result<Data> {
        if self.line_color().is_none() && self.bar.is_none() {
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
        let pixels = values.par_chunks_mut(N).zip(&self.covered);
        pixels.for_each(|(color, &covered)| {
            for (value, line) in color.iter_mut().zip(line) {
                let (mean, covered) = (f64::from(*value), f64::from(covered));
                *value = single((1.0 - covered) * mean + covered * line);
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

/// Pixels of a band of rows that are shaded at a time: some of its columns.
#[derive(Clone, Copy)]
struct Block {
    /// The pixels of a row of the picture's part.
    width: usize,
    rows: usize,
    /// The first of its columns, and that after the last.
    columns: [usize; 2],
}

impl Block {
    /// All those of a band of so many pixels, from the left to the right.
    fn all(pixels: usize, width: usize) -> impl Iterator<Item = Self> {
        let rows = pixels / width;
        let step = SHADED / rows;
        (0..width).step_by(step).map(move |first| Self {
            width,
            rows,
            columns: [first, width.min(first + step)],
        })
    }

    fn len(self) -> usize {
        let [first, end] = self.columns;
        self.rows * (end - first)
    }

    /// Rows and columns of its pixels within it, square by square.
    fn pixels(self) -> impl Iterator<Item = [usize; 2]> {
        let width = self.columns[1] - self.columns[0];
        (0..width).step_by(SQUARE).flat_map(move |left| {
            let columns = left..width.min(left + SQUARE);
            (0..self.rows).flat_map(move |row| columns.clone().map(move |column| [row, column]))
        })
    }
}

/// Some hundred hits that are shaded at a time, and their colours. It is used again and again.
struct Batch {
    rays: Box<[Ray; SHADED]>,
    hits: Box<[Hit; SHADED]>,
    pixels: [u64; SHADED],
    /// Which pixel of the band each is of.
    places: [usize; SHADED],
    /// Rays and numbers of all pixels of a block, row by row, and where among them those of each are.
    read: Box<[Ray; SHADED]>,
    numbers: [u64; SHADED],
    read_at: [usize; SHADED],
    colors: [Color; SHADED],
    coverage: [f64; SHADED],
    count: usize,
}

impl Batch {
    fn new() -> Self {
        Self {
            rays: Box::new([Ray::new(DVec3::ZERO, DVec3::ZERO); SHADED]),
            hits: Box::new([Hit::MISS; SHADED]),
            pixels: [0; SHADED],
            places: [0; SHADED],
            read: Box::new([Ray::new(DVec3::ZERO, DVec3::ZERO); SHADED]),
            numbers: [0; SHADED],
            read_at: [0; SHADED],
            colors: [Color::ZERO; SHADED],
            coverage: [0.0; SHADED],
            count: 0,
        }
    }

    /// Takes those of a block's pixels that go on, in a band that begins with the pixel `first` of the part. Their triangles are on their
    /// way to the caches afterwards. Returns whether there are any.
    fn read(
        &mut self,
        (scene, part): (&Scene, &Part<'_>),
        hits: &Hits,
        (first, block): (usize, Block),
        goes_on: impl Fn(usize) -> bool,
    ) -> bool {
        let [left, right] = block.columns;
        let columns = right - left;
        let mut going = 0;
        for [row, column] in block.pixels() {
            let place = row * block.width + left + column;
            if goes_on(place) {
                self.places[going] = place;
                self.read_at[going] = row * columns + column;
                going += 1;
            }
        }
        self.count = going;
        if going == 0 {
            return false;
        }
        for row in 0..block.rows {
            let start = first + row * block.width + left;
            let of_row = row * columns..(row + 1) * columns;
            part.read(start, &mut self.read[of_row.clone()]);
            part.number(start, &mut self.numbers[of_row]);
            let mut prefetcher = Prefetcher::new(scene, hits, start, columns);
            (0..columns).for_each(|k| prefetcher.advance(k));
        }
        for k in 0..going {
            self.rays[k] = self.read[self.read_at[k]];
            self.pixels[k] = self.numbers[self.read_at[k]];
            self.hits[k] = hits.get(first + self.places[k]);
        }
        true
    }

    /// The pixels of all, their colours and coverage.
    fn shade(
        &mut self,
        (shade, cull): (&dyn Shade, Option<Side>),
        sample: u32,
    ) -> (&[usize], &[Color], &[f64]) {
        let count = self.count;
        let samples = Samples {
            rays: &self.rays[..count],
            hits: &self.hits[..count],
            pixels: &self.pixels[..count],
            sample,
            cull,
        };
        let (colors, coverage) = (&mut self.colors[..count], &mut self.coverage[..count]);
        colors.fill(Color::ZERO);
        for (covered, hit) in coverage.iter_mut().zip(samples.hits) {
            *covered = f64::from(u8::from(!hit.is_miss()));
        }
        shade.shade_all(&samples, colors, coverage);
        (&self.places[..count], colors, coverage)
    }
}
