//! A cloud of points again, with what was found of each.

use std::collections::HashSet;

use firsthit::geometry::srgb_decode;
use firsthit::image::{
    Array, ArrayValues, Channel, Data, Description, Display, Frame, Origin, Points, Unit,
};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::hints::number;

/// A summary of distances: those of points that have one.
pub(super) struct Summary {
    count: usize,
    mean: f64,
    /// The root of the mean square.
    rms: f64,
    /// The numbers up to which 95 of 100 are, and up to which all are, whatever their signs.
    within: [f64; 2],
}

impl Summary {
    /// `None` where there is no distance.
    pub(super) fn of(distances: &[f64]) -> Option<Self> {
        let finite = distances.iter().copied().filter(|distance| distance.is_finite());
        let mut sizes: Vec<f64> = finite.clone().map(f64::abs).collect();
        let count = sizes.len();
        let last = count.checked_sub(1)?;
        let mean = finite.clone().sum::<f64>() / count as f64;
        let rms = (finite.map(|distance| distance * distance).sum::<f64>() / count as f64).sqrt();
        let place = (count * 95).div_ceil(100) - 1;
        let (_, &mut most_are, _) = sizes.select_nth_unstable_by(place, f64::total_cmp);
        let (_, &mut all_are, _) = sizes.select_nth_unstable_by(last, f64::total_cmp);
        Some(Self { count, mean, rms, within: [most_are, all_are] })
    }

    pub(super) fn in_words(&self) -> String {
        let [most_are, all_are] = self.within.map(number);
        let (mean, rms) = (number(self.mean), number(self.rms));
        format!("mean {mean}, RMS {rms}, 95 % within {most_are}, all within {all_are}")
    }

    /// The summary for `--json`.
    pub(super) fn as_json(&self) -> Value {
        let [most_are, all_are] = self.within;
        json!({
            "count": self.count,
            "mean": self.mean,
            "rms": self.rms,
            "within_95": most_are,
            "within": all_are,
        })
    }
}

/// The points with all their columns, but for those that `found` replaces, and with that.
pub(super) fn with_column(
    points: Points,
    found: Channel,
    origin: Origin,
) -> Result<Frame, Failure> {
    let Points { positions, columns, .. } = points;
    let mut frame = Frame::new([positions.len()]).from_origin(origin);
    let mut taken: HashSet<String> = ["position", &found.name].map(str::to_owned).into();
    frame.push(Channel {
        name: "position".into(),
        components: 3,
        data: Data::Float64(positions.into_flattened()),
        display: Display::Position,
        description: Description {
            about: "where the point is that was given",
            unit: Unit::SceneLength,
            frame: Some("world"),
        },
    })?;
    for array in columns {
        let name = plain(array.name.as_deref().unwrap_or_default());
        if name.is_empty() || !taken.insert(name.clone()) {
            continue;
        }
        frame.push(column(name, array))?;
    }
    frame.push(found)?;
    Ok(frame)
}

/// A name as headers of clouds can have it.
fn plain(name: &str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || "_-.:".contains(c);
    let named = name.chars().take(100);
    named.map(|c| if allowed(c) { c } else { '_' }).collect()
}

fn column(name: String, array: Array) -> Channel {
    let Array { components, numbers, is_picture, .. } = array;
    let is_color = is_picture && matches!(components, 3 | 4);
    let data = match numbers {
        ArrayValues::Integer(levels) if is_color => Data::Float64(linear(&levels, components)),
        ArrayValues::Float64(values) => Data::Float64(values),
        ArrayValues::Float32(values) => Data::Float32(values),
        ArrayValues::Integer(values) => {
            let small = values.iter().map(|&value| i32::try_from(value));
            match small.collect() {
                Ok(small) => Data::Int32(small),
                Err(_) => Data::Float64(values.iter().map(|&value| value as f64).collect()),
            }
        }
    };
    Channel {
        name: name.into(),
        components,
        data,
        display: if is_color { Display::Color } else { Display::Quantity },
        description: Description {
            about: "a column of the points that were given",
            unit: Unit::None,
            frame: None,
        },
    }
}

/// Bytes of colours as light, premultiplied by alpha where there is one.
fn linear(levels: &[i64], components: usize) -> Vec<f64> {
    let colors = levels.chunks_exact(components).flat_map(|color| {
        let alpha = color.get(3).map_or(1.0, |&alpha| alpha as f64 / 255.0);
        let level = move |(k, &level): (usize, &i64)| match k {
            3 => alpha,
            _ => alpha * srgb_decode(level as f64 / 255.0),
        };
        color.iter().enumerate().map(level)
    });
    colors.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ninety_five_of_a_hundred_are_within_the_ninety_fifth() {
        let distances: Vec<f64> =
            (1..=100).map(|k| f64::from(k) * if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let summary = Summary::of(&distances).unwrap();
        assert_eq!((summary.mean, summary.within), (0.5, [95.0, 100.0]));
        assert_eq!(summary.rms, (338_350.0_f64 / 100.0).sqrt());
        let one = Summary::of(&[f64::INFINITY, -3.0, f64::NAN]).unwrap();
        assert_eq!((one.count, one.mean, one.within), (1, -3.0, [3.0, 3.0]));
        assert!(Summary::of(&[f64::INFINITY]).is_none());
    }
}
