//! Sums over the samples of pixels, and when they are enough.

use bytemuck::Zeroable;

use crate::error::{Error, Result};
use crate::geometry::{Color, luminance, single, srgb_encode};
use crate::image::{Channel, Data, Description, Display, Frame, Unit};
use crate::memory::{self, zeroed};
use crate::parallel;
use crate::shade::Shade;

/// The sums over the samples of each pixel of a part of a picture. Sums are in the order of the
/// samples, so it does not matter how many are added at a time.
pub(super) struct Accumulation {
    /// Red, green, blue and coverage.
    pub(super) sums: Vec<[f64; 4]>,
    /// The sums of the squares of [`brightness`].
    pub(super) squares: Vec<f64>,
    /// The numbers of samples.
    pub(super) counts: Vec<u32>,
    /// Whether what is behind shows through, as alpha says.
    is_transparent: bool,
    /// Whether means below 0 can only be noise.
    has_negative_noise: bool,
}

/// The place of the alpha among the sums of a pixel.
pub(super) const ALPHA: usize = 3;

/// The names of the channels of a state that is kept.
const NAMES: [&str; 3] = ["sums", "squares", "samples"];

impl Accumulation {
    /// The accumulation of no pixel.
    pub(super) fn empty(shade: &dyn Shade) -> Self {
        Self {
            sums: Vec::new(),
            squares: Vec::new(),
            counts: Vec::new(),
            is_transparent: shade.is_transparent(),
            has_negative_noise: shade.has_negative_noise(),
        }
    }

    /// Begins anew, with `pixels` pixels.
    pub(super) fn reset(&mut self, pixels: usize) -> Result<()> {
        reset(&mut self.sums, pixels)?;
        reset(&mut self.squares, pixels)?;
        reset(&mut self.counts, pixels)
    }

    /// Adds a sample to a pixel.
    #[inline]
    pub(super) fn add(
        (sum, square, count): (&mut [f64; 4], &mut f64, &mut u32),
        (color, covered): (Color, f64),
        is_transparent: bool,
    ) {
        for (sum, value) in sum.iter_mut().zip([color.x, color.y, color.z, covered]) {
            *sum += value;
        }
        let brightness = brightness(color, covered, is_transparent);
        *square += brightness * brightness;
        *count += 1;
    }

    /// The means of some of the sums, for each pixel one after the other. Colours are at least 0
    /// where less can only be noise, and alpha is from 0 to 1: a sample of the ground's shadow may
    /// be darkened by more than all.
    pub(super) fn means<const N: usize>(&self, which: [usize; N]) -> Result<Data> {
        let mut means = zeroed::<f32>(self.sums.len().saturating_mul(N))?;
        let chunk = 1 << 12;
        let sums = self.sums.chunks(chunk).zip(self.counts.chunks(chunk));
        let chunks = means.chunks_mut(N * chunk).zip(sums);
        parallel::each(chunks, |(out, (sums, counts))| {
            for ((out, sum), &count) in out.chunks_mut(N).zip(sums).zip(counts) {
                let count = f64::from(count.max(1));
                for (out, which) in out.iter_mut().zip(which) {
                    let mean = sum[which] / count;
                    // Written so that a NaN stays one.
                    *out = single(match which {
                        ALPHA => mean.clamp(0.0, 1.0),
                        _ if mean < 0.0 && self.has_negative_noise => 0.0,
                        _ => mean,
                    });
                }
            }
        });
        Ok(Data::Float32(means))
    }

    /// The number of samples of each pixel.
    pub(super) fn counts(&self) -> Result<Data> {
        let mut counts = zeroed::<i32>(self.counts.len())?;
        for (out, &count) in counts.iter_mut().zip(&self.counts) {
            *out = i32::try_from(count).unwrap_or(i32::MAX);
        }
        Ok(Data::Int32(counts))
    }

    /// The standard error of a pixel's brightness as a picture shows it, from 0, black, to 1,
    /// white: upwards or downwards, whichever shows more. Of a pixel that one bright sample has
    /// made white, only downwards shows.
    fn error(&self, pixel: usize) -> f64 {
        let count = f64::from(self.counts[pixel]);
        let [red, green, blue, alpha] = self.sums[pixel].map(|sum| sum / count);
        let mean = brightness(Color::new(red, green, blue), alpha, self.is_transparent);
        let variance = (self.squares[pixel] / count - mean * mean).max(0.0);
        let error = (variance / (count - 1.0)).sqrt();
        let [below, here, above] = [mean - error, mean, mean + error].map(srgb_encode);
        (above - here).max(here - below)
    }

    /// Adds the accumulated sums to a state from which [`Picture::resume`](super::Picture::resume)
    /// continues.
    pub(super) fn put_into(&self, state: &mut Frame) -> Result<()> {
        let data = [
            Data::Float64(self.sums.as_flattened().to_vec()),
            Data::Float64(self.squares.clone()),
            self.counts()?,
        ];
        for ((name, data), components) in NAMES.into_iter().zip(data).zip([4, 1, 1]) {
            state.push(Channel {
                name: name.into(),
                components,
                data,
                display: Display::Quantity,
                description: Description {
                    about: "the state of a picture that can be gone on with",
                    unit: Unit::None,
                    frame: None,
                },
            })?;
        }
        Ok(())
    }

    /// Takes what is known from such a state.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for another frame.
    pub(super) fn taken_from(state: &Frame, pixels: usize, shade: &dyn Shade) -> Result<Self> {
        let wrong = |got: &str| Error::argument("state", "that of this picture", got.to_owned());
        let data = |name: &str| state.channel(name).map(|channel| &channel.data);
        let [sums, squares, counts] = NAMES.map(data);
        let (Some(Data::Float64(sums)), Some(Data::Float64(squares)), Some(Data::Int32(counts))) =
            (sums, squares, counts)
        else {
            return Err(wrong("a frame without sums, squares and samples"));
        };
        let shape = [sums.len(), squares.len(), counts.len()];
        if shape != [4 * pixels, pixels, pixels] {
            return Err(wrong("one of another size"));
        }
        // A caller's own shader may give any number. Squares of light beyond 1e154 are infinite.
        let is_own = shade.recipe().is_none();
        let are_sums = sums.iter().all(|x| x.is_finite()) && squares.iter().all(|&x| x >= 0.0);
        if !(is_own || are_sums) {
            return Err(wrong("one of sums that are no sums of colours"));
        }
        let is_empty =
            |(sums, &count): (&[f64], &i32)| count == 0 && sums.iter().any(|&x| x != 0.0);
        if sums.chunks_exact(4).zip(counts).any(is_empty) {
            return Err(wrong("one of sums without samples"));
        }
        let mut made = Self::empty(shade);
        made.reset(pixels)?;
        made.sums.as_flattened_mut().copy_from_slice(sums);
        made.squares.copy_from_slice(squares);
        for (out, &count) in made.counts.iter_mut().zip(counts) {
            *out =
                u32::try_from(count).map_err(|_| wrong("one of a negative number of samples"))?;
        }
        Ok(made)
    }
}

/// Makes a vector `count` zeros. Its memory is used again where it is enough.
fn reset<T: Zeroable + Clone>(values: &mut Vec<T>, count: usize) -> Result<()> {
    values.clear();
    memory::fit(values, count)
}

/// The brightness of a colour: where what is behind shows through, over white, so that shadows
/// count that alpha alone has.
fn brightness(color: Color, alpha: f64, is_transparent: bool) -> f64 {
    let behind = if is_transparent { 1.0 - alpha } else { 0.0 };
    luminance(color) + behind
}

/// The side of the tiles that stop together, in pixels.
const TILE: usize = 16;

/// The least samples that a standard error is asked for.
const LEAST: u32 = 32;

/// The active tiles of a picture: those that are not quiet, and their eight neighbours. They are
/// found after 32, 64, 128, ... samples, so that they depend on nothing but the samples.
pub(super) struct Activity {
    columns: usize,
    /// Whether each tile is active.
    tiles: Vec<bool>,
    across: usize,
}

impl Activity {
    /// The activity before another sample, whose number is `sample`, in a picture of that shape:
    /// only tiles with as many samples can be active.
    pub(super) fn at(
        accumulation: &Accumulation,
        [rows, columns]: [usize; 2],
        sample: u32,
        noise: f64,
    ) -> Self {
        let [down, across] = [rows, columns].map(|side| side.div_ceil(TILE));
        let is_asked = sample >= LEAST && sample.is_power_of_two();
        let loud = parallel::map(0..down * across, |tile| {
            let (top, left) = (tile / across * TILE, tile % across * TILE);
            let mut pixels = (top..rows.min(top + TILE))
                .flat_map(|row| (left..columns.min(left + TILE)).map(move |c| row * columns + c));
            let mut goes_on = pixels.clone().any(|pixel| accumulation.counts[pixel] == sample);
            if is_asked && goes_on {
                goes_on = pixels.any(|pixel| accumulation.error(pixel) > noise);
            }
            goes_on
        });
        let tiles = if is_asked {
            spread(&loud, [down, across], |tile| {
                let pixel = tile / across * TILE * columns + tile % across * TILE;
                accumulation.counts[pixel] == sample
            })
        } else {
            loud
        };
        Self { columns, tiles, across }
    }

    /// Whether any tile is active.
    pub(super) fn is_any(&self) -> bool {
        self.tiles.iter().any(|&goes_on| goes_on)
    }

    /// Whether a pixel's tile is active.
    pub(super) fn has(&self, pixel: usize) -> bool {
        let (row, column) = (pixel / self.columns, pixel % self.columns);
        self.tiles[row / TILE * self.across + column / TILE]
    }
}

/// The loud tiles and their neighbours, of those that may be active.
fn spread(
    loud: &[bool],
    [down, across]: [usize; 2],
    may_go_on: impl Fn(usize) -> bool,
) -> Vec<bool> {
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let is_near = |tile: usize| {
        let (row, column) = (tile / across, tile % across);
        let mut around = near(row, down).flat_map(|r| near(column, across).map(move |c| (r, c)));
        around.any(|(r, c)| loud[r * across + c])
    };
    (0..loud.len()).map(|tile| may_go_on(tile) && is_near(tile)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{DVec3, Hit};

    #[test]
    fn quiet_tiles_stop_unless_a_neighbour_is_loud() {
        let shape = [48, 64];
        let own = |_: f64, _: DVec3, _: DVec3, _: &Hit| Color::ZERO;
        let mut known = Accumulation::empty(&own);
        known.reset(48 * 64).unwrap();
        for sample in 0..32_u32 {
            for pixel in 0..48 * 64 {
                let is_loud = pixel == 20 * 64 + 60;
                let value = if is_loud && sample % 2 == 0 { 1.0 } else { 0.4 };
                let one =
                    (&mut known.sums[pixel], &mut known.squares[pixel], &mut known.counts[pixel]);
                Accumulation::add(one, (Color::splat(value), 1.0), false);
            }
        }
        // Half of its samples are 0.4 and half are 1: 0.3 from their mean.
        let error = 0.3 / f64::from(32 - 1).sqrt();
        let shown = srgb_encode(0.7) - srgb_encode(0.7 - error);
        assert!((known.error(20 * 64 + 60) - shown).abs() < 1e-12);
        // The loud pixel is in the fourth tile of the second row of three.
        let active = Activity::at(&known, shape, 32, 0.005);
        let expected = [false, false, true, true].repeat(3);
        assert_eq!(active.tiles, expected);
        assert!(active.is_any() && active.has(5 * 64 + 40) && !active.has(5 * 64 + 20));
        assert!(!Activity::at(&known, shape, 32, 0.9).is_any());
        // Not at other numbers: 33 samples are not there yet, so no tile is active.
        assert!(!Activity::at(&known, shape, 33, 0.0).is_any());
    }
}
