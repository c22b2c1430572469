use std::sync::OnceLock;

use super::frame::{Channel, Display};
use super::srgb::unit_byte;
use super::tones::Tones;
use crate::geometry::{ColorMap, DisplayTransform, fraction};
use crate::parallel;

type Rgb = [u8; 3];

/// The colour of a miss, in every picture but those of colours.
const BLACK: Rgb = [0; 3];

/// The mapping from one channel's values to bytes, with the ranges that depend on the whole
/// channel.
pub(super) enum ChannelColors {
    Color(Tones),
    /// Colours with coverage (alpha): four bytes, not three.
    Transparent(Tones),
    Distance(Depths),
    Identifier,
    Direction,
    Position([Range; 3]),
    Fraction,
    Mask,
    Quantity(Vec<Range>),
}

impl ChannelColors {
    /// `display` is for colours alone.
    pub(super) fn of(channel: &Channel, display: DisplayTransform) -> Self {
        match channel.display {
            Display::Color if channel.is_transparent() => Self::Transparent(Tones::of(display)),
            Display::Color => Self::Color(Tones::of(display)),
            Display::Distance => Self::Distance(Depths::of(channel)),
            Display::Identifier => Self::Identifier,
            Display::Direction => Self::Direction,
            Display::Position => Self::Position([0, 1, 2].map(|axis| Range::of(channel, axis))),
            Display::Fraction => Self::Fraction,
            Display::Mask => Self::Mask,
            Display::Matte => unreachable!("formats of pictures refuse it"),
            Display::Quantity => {
                Self::Quantity((0..channel.components).map(|k| Range::of(channel, k)).collect())
            }
        }
    }

    /// The number of bytes of a pixel.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Transparent(_) => 4,
            _ => 3,
        }
    }

    /// Fills `bytes`, as many as [`bytes`](Self::bytes) for every element, from `values`,
    /// `components` for every element.
    pub(super) fn apply(&self, values: &[f64], components: usize, bytes: &mut [u8]) {
        match self {
            Self::Color(tones) => return tones.apply(values, bytes),
            Self::Transparent(tones) => return tones.apply_to_transparent(values, bytes),
            _ => {}
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
            // The rest are numbers; misses are not finite.
            (_, value) if !value.iter().all(|number| number.is_finite()) => BLACK,
            (Self::Distance(depths), &[t]) => viridis()[usize::from(unit_byte(depths.nearness(t)))],
            (Self::Direction, &[x, y, z]) => [x, y, z].map(|axis| unit_byte(axis.midpoint(1.0))),
            (Self::Position(ranges), &[x, y, z]) => {
                [(0, x), (1, y), (2, z)].map(|(axis, at)| unit_byte(ranges[axis].fraction(at)))
            }
            (Self::Quantity(ranges), value) => {
                let mut levels = ranges.iter().zip(value);
                let mut level =
                    || levels.next().map_or(0, |(range, &at)| unit_byte(range.fraction(at)));
                let first = level();
                if value.len() == 1 {
                    viridis()[usize::from(first)]
                } else {
                    [first, level(), level()]
                }
            }
            (Self::Fraction, &[grey]) => [unit_byte(grey); 3],
            (Self::Fraction, &[u, v]) => [unit_byte(u), unit_byte(v), 0],
            (Self::Fraction, &[r, g, b]) => [r, g, b].map(unit_byte),
            _ => unreachable!("`Frame::push` checks the components of each kind of picture"),
        }
    }
}

/// The text that explains a picture of `channel`, for reading values back, with every digit; `None`
/// where it needs no words.
pub fn legend(channel: &Channel) -> Option<String> {
    legend_in(channel, |number| format!("{number:?}"))
}

/// [`legend`] with at most six digits.
pub fn short_legend(channel: &Channel) -> Option<String> {
    legend_in(channel, |number| {
        let rounded = format!("{number:.5e}").parse::<f64>().unwrap_or(number);
        format!("{rounded:?}")
    })
}

fn legend_in(channel: &Channel, text: impl Fn(f64) -> String) -> Option<String> {
    let name = &channel.name;
    // It is no picture.
    if channel.display == Display::Matte {
        return None;
    }
    match ChannelColors::of(channel, DisplayTransform::default()) {
        ChannelColors::Color(_)
        | ChannelColors::Transparent(_)
        | ChannelColors::Fraction
        | ChannelColors::Mask => None,
        ChannelColors::Distance(depths) if depths.range.is_empty() => {
            Some(format!("{name}: nothing but misses"))
        }
        ChannelColors::Distance(Depths { range, middle }) => Some(format!(
            "{name} from {} (yellow) to {} (violet), half of it nearer than {}; misses black",
            text(range.low),
            text(range.high),
            text(middle)
        )),
        ChannelColors::Identifier => {
            Some(format!("{name}: a colour for each number; misses black"))
        }
        ChannelColors::Direction => Some(format!(
            "{name}: (x + 1) / 2, (y + 1) / 2, (z + 1) / 2 as red, green, blue; misses black"
        )),
        ChannelColors::Quantity(ranges) if ranges.iter().all(Range::is_empty) => {
            Some(format!("{name}: nothing but misses"))
        }
        ChannelColors::Quantity(ranges) => {
            if let [Range { low, high }] = &ranges[..] {
                return Some(format!(
                    "{name} from {} (violet) to {} (yellow), linear; misses black",
                    text(*low),
                    text(*high)
                ));
            }
            let range = |(Range { low, high }, ink): (&Range, &str)| {
                format!("from {} to {} as {ink}", text(*low), text(*high))
            };
            let inks = ["red", "green", "blue"];
            let ranges: Vec<String> = ranges.iter().zip(inks).map(range).collect();
            Some(format!("{name}: {}, linear; misses black", ranges.join(", ")))
        }
        ChannelColors::Position(ranges) if ranges[0].is_empty() => {
            Some(format!("{name}: nothing but misses"))
        }
        ChannelColors::Position(ranges) => {
            let [x, y, z] =
                ranges.map(|Range { low, high }| format!("{} to {}", text(low), text(high)));
            Some(format!(
                "{name}: x from {x} as red, y from {y} as green, z from {z} as blue, linear; misses black"
            ))
        }
    }
}

/// The smallest and the largest finite value of one component of a channel.
pub(super) struct Range {
    low: f64,
    high: f64,
}

impl Range {
    fn of(channel: &Channel, component: usize) -> Self {
        let mut range = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };
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

    /// The place of `value` in the range: 0 at the low end, 1 at the high end; 0 if both are equal.
    fn fraction(&self, value: f64) -> f64 {
        fraction(value, [self.low, self.high])
    }
}

/// The mapping from the distances of a channel to the colour scale.
///
/// On a linear scale a ground that runs to the horizon takes nearly all colours, and the objects on
/// it look alike. So the colour depends on `1 / (1 + x)`, where `x` is 0 at the nearest distance
/// and 1 at the median: the nearer half of the pixels gets about half of the colours, however far
/// the others are.
pub(super) struct Depths {
    range: Range,
    middle: f64,
}

impl Depths {
    fn of(channel: &Channel) -> Self {
        let range = Range::of(channel, 0);
        let values = (0..channel.data.len()).map(|index| channel.data.value(index));
        let mut hits: Vec<f64> = values.filter(|t| t.is_finite()).collect();
        let half = hits.len() / 2;
        let middle = if hits.is_empty() {
            0.0
        } else {
            *hits.select_nth_unstable_by(half, f64::total_cmp).1
        };
        // Where more than half is at the nearest distance, the farthest serves.
        let middle = if middle > range.low { middle } else { range.high };
        Self { range, middle }
    }

    /// The nearness: from 1 at the nearest to 0 at the farthest distance.
    fn nearness(&self, t: f64) -> f64 {
        let Range { low, high } = self.range;
        if low == high {
            return 1.0;
        }
        let nearness = |t: f64| 1.0 / (1.0 + fraction(t, [low, self.middle]));
        let farthest = nearness(high);
        (nearness(t) - farthest) / (1.0 - farthest)
    }
}

/// The colour of an identifier as bytes of red, green and blue, equal in all pictures; misses,
/// which are negative, are black.
pub fn color_of_identifier(identifier: i32) -> [u8; 3] {
    identifier_color(f64::from(identifier))
}

/// The colour of an identifier, equal in all pictures; misses are black.
///
/// Three multiplicative sequences, which spread evenly however many identifiers there are: the
/// golden ratio's for the hue, so that neighbours are 137.5 degrees apart, and those of the plastic
/// number (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018) for saturation
/// and value.
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
    // The first one is blue.
    let hue = (0.58 + spread(2_654_435_769)).fract(); // 2^32 / 1.618034
    let saturation = 0.8 - 0.5 * spread(3_242_174_889); // 2^32 / 1.324718
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

/// The levels of viridis, from violet to yellow.
fn viridis() -> &'static [Rgb; 256] {
    static LEVELS: OnceLock<[Rgb; 256]> = OnceLock::new();
    parallel::once(&LEVELS, || std::array::from_fn(|step| ColorMap::Viridis.levels(step)))
}

#[cfg(test)]
mod tests {
    use super::super::frame::Data;
    use super::*;

    fn colors(display: Display, components: usize, data: Data) -> (Vec<Rgb>, Option<String>) {
        let channel = Channel::new("it", components, data, display);
        let values: Vec<f64> =
            (0..channel.data.len()).map(|index| channel.data.value(index)).collect();
        let mut bytes = vec![7; values.len() / components * 3];
        let map = ChannelColors::of(&channel, DisplayTransform::default());
        map.apply(&values, components, &mut bytes);
        (bytes.as_chunks().0.to_vec(), legend(&channel))
    }

    #[test]
    fn near_is_yellow_and_far_is_violet() {
        let t = Data::Float32(vec![9.5, f32::INFINITY, 3.25, 6.375]);
        let (colors, legend) = colors(Display::Distance, 1, t);
        assert_eq!(colors[..3], [[68, 1, 84], BLACK, [253, 231, 37]]);
        // The median is half way down from 1, and 9.5, twice as far, two thirds: a quarter of that
        // is left.
        assert_eq!(colors[3], viridis()[64]);
        let expected =
            "it from 3.25 (yellow) to 9.5 (violet), half of it nearer than 6.375; misses black";
        assert_eq!(legend.as_deref(), Some(expected));
    }

    #[test]
    fn the_least_of_a_quantity_is_no_miss() {
        let (one, legend) = colors(Display::Quantity, 1, Data::Float64(vec![-1.0, 3.0, f64::NAN]));
        assert_eq!(one, [[68, 1, 84], [253, 231, 37], BLACK]);
        let expected = "it from -1.0 (violet) to 3.0 (yellow), linear; misses black";
        assert_eq!(legend.as_deref(), Some(expected));
        let (two, _) = colors(Display::Quantity, 2, Data::Float64(vec![-1.0, 5.0, 3.0, 4.0]));
        assert_eq!(two, [[0, 255, 0], [255, 0, 0]]);
    }

    #[test]
    fn pictures_without_a_range_are_not_divided_by_it() {
        let (same, _) = colors(Display::Distance, 1, Data::Float64(vec![2.0, 2.0]));
        assert_eq!(same, [[253, 231, 37]; 2]);
        let (misses, legend) = colors(Display::Distance, 1, Data::Float64(vec![f64::INFINITY]));
        assert_eq!(misses, [BLACK]);
        assert_eq!(legend.as_deref(), Some("it: nothing but misses"));
        let (extremes, _) = colors(Display::Distance, 1, Data::Float64(vec![-1.7e308, 1.7e308]));
        assert_eq!(extremes, [[253, 231, 37], [68, 1, 84]]);
    }

    #[test]
    fn vectors_points_and_fractions_are_red_green_blue() {
        let nan = f64::NAN;
        let normals = Data::Float64(vec![0.0, 1.0, -1.0, nan, nan, nan]);
        assert_eq!(colors(Display::Direction, 3, normals).0, [[128, 255, 0], BLACK]);
        let points = Data::Float64(vec![1.0, 5.0, 0.0, 3.0, 5.0, -4.0, nan, nan, nan]);
        let position = colors(Display::Position, 3, points);
        assert_eq!(position.0, [[0, 0, 255], [255, 0, 0], BLACK]);
        let text = position.1.unwrap();
        assert!(text.contains("x from 1.0 to 3.0 as red"), "{text}");
        let uv = Data::Float64(vec![0.5, 2.0, nan, nan]);
        assert_eq!(colors(Display::Fraction, 2, uv).0, [[128, 255, 0], BLACK]);
        let mask = Data::Bool(vec![true, false]);
        assert_eq!(colors(Display::Mask, 1, mask).0, [[255; 3], BLACK]);
    }

    #[test]
    fn neighbouring_identifiers_look_different() {
        let (colors, _) = colors(Display::Identifier, 1, Data::Int32((-1..10_000).collect()));
        assert_eq!(colors[0], BLACK);
        for pair in colors[1..].windows(2) {
            let apart = (0..3).map(|k| pair[0][k].abs_diff(pair[1][k])).max();
            assert!(apart >= Some(48), "{pair:?}");
        }
        assert!(colors[1..].iter().all(|color| color.iter().any(|&byte| byte > 150)));
        let first: std::collections::HashSet<_> = colors[1..=2000].iter().collect();
        assert_eq!(first.len(), 2000, "the first 2000 are all different");
    }
}
