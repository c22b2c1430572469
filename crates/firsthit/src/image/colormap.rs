use std::sync::LazyLock;

use super::srgb::SRGB;
use super::{Channel, Picture};

type Rgb = [u8; 3];

/// What a miss looks like, in every picture but those of colours.
const BLACK: Rgb = [0; 3];

/// How the values of one channel become bytes, with what had to be known of the whole channel first.
pub(super) enum ColorMap {
    Color,
    Distance(Range),
    Identifier,
    Direction,
    Position([Range; 3]),
    Fraction,
    Mask,
}

impl ColorMap {
    pub(super) fn of(channel: &Channel) -> Self {
        match channel.picture {
            Picture::Color => Self::Color,
            Picture::Distance => Self::Distance(Range::of(channel, 0)),
            Picture::Identifier => Self::Identifier,
            Picture::Direction => Self::Direction,
            Picture::Position => Self::Position([0, 1, 2].map(|axis| Range::of(channel, axis))),
            Picture::Fraction => Self::Fraction,
            Picture::Mask => Self::Mask,
        }
    }

    /// Fills `bytes`, three for every element, from `values`, `components` for every element.
    pub(super) fn apply(&self, values: &[f64], components: usize, bytes: &mut [u8]) {
        if matches!(self, Self::Color) {
            // The most frequent picture: without a decision per pixel it takes half the time.
            let srgb = &*SRGB;
            for (byte, &value) in bytes.iter_mut().zip(values) {
                *byte = srgb.byte(value);
            }
            return;
        }
        let (pixels, _) = bytes.as_chunks_mut::<3>();
        for (pixel, value) in pixels.iter_mut().zip(values.chunks_exact(components)) {
            *pixel = self.rgb(value);
        }
    }

    fn rgb(&self, value: &[f64]) -> Rgb {
        match (self, value) {
            (Self::Identifier, &[identifier]) => identifier_color(identifier),
            (Self::Mask, &[truth]) => [unit_byte(truth); 3],
            // What is left are numbers, of which misses are not finite.
            (_, value) if !value.iter().all(|number| number.is_finite()) => BLACK,
            (Self::Distance(range), &[t]) => {
                VIRIDIS[usize::from(unit_byte(1.0 - range.fraction(t)))]
            }
            (Self::Direction, &[x, y, z]) => [x, y, z].map(|axis| unit_byte(axis.midpoint(1.0))),
            (Self::Position(ranges), &[x, y, z]) => {
                [(0, x), (1, y), (2, z)].map(|(axis, at)| unit_byte(ranges[axis].fraction(at)))
            }
            (Self::Fraction, &[grey]) => [unit_byte(grey); 3],
            (Self::Fraction, &[u, v]) => [unit_byte(u), unit_byte(v), 0],
            (Self::Fraction | Self::Color, &[r, g, b]) => [r, g, b].map(unit_byte),
            _ => unreachable!("`Frame::push` checks the components of each kind of picture"),
        }
    }
}

/// How to read a picture of `channel` back, in words; nothing where it needs none.
pub fn legend(channel: &Channel) -> Option<String> {
    let name = channel.name;
    match ColorMap::of(channel) {
        ColorMap::Color | ColorMap::Fraction | ColorMap::Mask => None,
        ColorMap::Distance(range) if range.is_empty() => {
            Some(format!("{name}: nothing but misses"))
        }
        ColorMap::Distance(Range { low, high }) => Some(format!(
            "{name} from {low:?} (yellow) to {high:?} (violet), linear; misses black"
        )),
        ColorMap::Identifier => Some(format!("{name}: a colour for each number; misses black")),
        ColorMap::Direction => Some(format!(
            "{name}: (x + 1) / 2, (y + 1) / 2, (z + 1) / 2 as red, green, blue; misses black"
        )),
        ColorMap::Position(ranges) if ranges[0].is_empty() => {
            Some(format!("{name}: nothing but misses"))
        }
        ColorMap::Position([x, y, z]) => Some(format!(
            "{name}: x from {:?} to {:?} as red, y from {:?} to {:?} as green, \
             z from {:?} to {:?} as blue, linear; misses black",
            x.low, x.high, y.low, y.high, z.low, z.high
        )),
    }
}

/// The smallest and the largest finite value of one component of a channel.
pub(super) struct Range {
    low: f64,
    high: f64,
}

impl Range {
    fn of(channel: &Channel, component: usize) -> Self {
        let mut range = Self {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        };
        for index in (component..channel.data.len()).step_by(channel.components) {
            let value = channel.data.value(index);
            if value.is_finite() {
                range.low = range.low.min(value);
                range.high = range.high.max(value);
            }
        }
        range
    }

    fn is_empty(&self) -> bool {
        self.low > self.high
    }

    /// Where `value` lies: 0 at the low end, 1 at the high end; 0 if both are the same.
    fn fraction(&self, value: f64) -> f64 {
        if self.low == self.high {
            return 0.0;
        }
        // Halves, because the difference of two float64 may be infinite.
        (value / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0)
    }
}

/// A number from 0 to 1 as a byte, rounded to nearest.
pub(super) fn unit_byte(unit: f64) -> u8 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "`as` saturates, which is what is wanted here; NaN becomes 0"
    )]
    {
        (unit * 255.0).round() as u8
    }
}

/// Each identifier's own colour, the same in every picture; misses are black.
///
/// Three multiplicative sequences, which spread evenly however many identifiers there are: the golden
/// ratio's for the hue, so that neighbours are 137.5 degrees apart, and those of the plastic number
/// (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018) for saturation and value.
fn identifier_color(identifier: f64) -> Rgb {
    if identifier < 0.0 {
        return BLACK;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "it was an i32, and not negative"
    )]
    let identifier = identifier as u32;
    let spread = |factor: u32| f64::from(identifier.wrapping_mul(factor)) / 4_294_967_296.0;
    let hue = spread(2_654_435_769); // 2^32 / 1.618034
    let saturation = 1.0 - 0.5 * spread(3_242_174_889); // 2^32 / 1.324718
    let value = 1.0 - 0.4 * spread(2_447_445_414); // 2^32 / 1.324718^2
    hsv(hue, saturation, value)
}

/// Hue in turns. Smith, "Color Gamut Transform Pairs" (1978).
fn hsv(hue: f64, saturation: f64, value: f64) -> Rgb {
    // A channel is full within a sixth of a turn of its own hue, and nothing from two sixths on.
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|own| {
        let away = (hue - own).abs();
        let away = away.min(1.0 - away);
        let strength = (2.0 - 6.0 * away).clamp(0.0, 1.0);
        unit_byte(value * (1.0 - saturation * (1.0 - strength)))
    })
}

/// 256 steps of viridis, from violet to yellow.
static VIRIDIS: LazyLock<[Rgb; 256]> = LazyLock::new(|| {
    std::array::from_fn(|step| {
        let color = colorous::VIRIDIS.eval_rational(step, 256);
        [color.r, color.g, color.b]
    })
});
