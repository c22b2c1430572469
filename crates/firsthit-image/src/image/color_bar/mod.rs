//! A bar of colours with their numbers, drawn into a picture.

mod canvas;
mod font;
mod numbers;

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::frame::Data;
use crate::error::{Error, Result};
use crate::geometry::{Color, ColorMap, single};
use canvas::Canvas;

/// The record of a colouring by numbers: the legend of such a picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ColorsRecord {
    /// The source of the numbers: `attribute:NAME`, `values`, or another word of `--color-by`.
    pub by: String,
    /// The name of the colour map.
    pub map: String,
    /// The numbers of its first and its last colour.
    pub range: [f64; 2],
    /// The linear colour of numbers below the range; `None` for the map's first.
    pub below: Option<[f64; 3]>,
    /// The linear colour of numbers above the range; `None` for the map's last.
    pub above: Option<[f64; 3]>,
    /// The linear colour where there is no number; `None` for the surface's own.
    pub missing: Option<[f64; 3]>,
    /// Whether the picture has a bar with these colours and numbers.
    pub bar: bool,
}

/// The bar of a picture: at its right edge, half way down.
#[derive(Debug, Clone)]
pub struct ColorBar {
    canvas: Canvas,
    /// The row and the column of the picture that its first pixel is in.
    first: [usize; 2],
}

/// The pixels along the picture's smaller side for each step of a letter's scale, from 1 on.
const PER_SCALE: usize = 360;

// All in pixels of letters.

/// The width of the bar.
const BAR: usize = 9;

/// Between the bar and its numbers, and below it.
const GAP: usize = 4;

/// The margin from the picture's edge.
const MARGIN: usize = 8;

/// The height of a box for numbers outside, with the gap to the bar.
const BOX: usize = 8;

/// The height of the name, with the gap to what is below.
const NAME: usize = 14;

/// The least distance between numbers.
const PITCH: usize = 12;

impl ColorBar {
    /// The bar for a picture with these numbers of rows and columns.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a picture so small that the bar would reach its middle, and for a map that there is not.
    pub fn new(record: &ColorsRecord, [rows, columns]: [usize; 2]) -> Result<Self> {
        let scale = 1 + rows.min(columns) / PER_SCALE;
        let height = rows * 2 / 5;
        let steps = height / (PITCH * scale);
        // A pixel more on each side is for outlines.
        let widest = (columns * 2 / 5 / scale).saturating_sub(MARGIN + 2);
        let steps = [4, 2, 1].into_iter().find(|&count| count <= steps);
        let labels = numbers::labels(record.range, steps.unwrap_or(1));
        let letters = labels.iter().map(|label| canvas::width(label)).max();
        let width = BAR + GAP + letters.unwrap_or(0);
        let is_small = steps.is_none() || width > widest;
        let outside = BOX * scale;
        let all = (NAME + GAP) * scale + height + 2 * outside;
        if is_small || all > rows {
            let expected = "left out of a picture that is too small for it";
            let got = format!("{columns} x {rows} pixels");
            return Err(Error::argument("color_bar", expected, got));
        }
        let name = shortened(&record.by, widest);
        let width = width.max(canvas::width(&name));
        let mut canvas = Canvas::new([all + 2 * scale, (width + 2) * scale], scale);
        canvas.text([scale, scale], &name);
        let top = (1 + NAME) * scale + outside;
        let bar = Bar {
            rows: top..top + height,
            columns: scale..(1 + BAR) * scale,
        };
        bar.draw(record, record.map.parse()?, &mut canvas);
        for (step, label) in labels.iter().enumerate() {
            let middle = top + height - height * step / (labels.len() - 1);
            let half = font::SIZE[1] * scale / 2;
            canvas.text([middle - half, (1 + BAR + GAP) * scale], label);
        }
        canvas.outline();
        let [high, wide] = canvas.size();
        Ok(Self {
            canvas,
            first: [(rows - high.min(rows)) / 2, columns - wide - MARGIN * scale],
        })
    }

    /// Draws it over linear colours, of 3 or 4 numbers each, of some rows and columns of the picture.
    pub fn draw(
        &self,
        colors: &mut Data,
        components: usize,
        (rows, columns): (&Range<usize>, &Range<usize>),
    ) {
        let Data::Float32(values) = colors else {
            return;
        };
        for ([row, column], color) in self.canvas.pixels() {
            let (row, column) = (self.first[0] + row, self.first[1] + column);
            if !rows.contains(&row) || !columns.contains(&column) {
                continue;
            }
            let pixel = (row - rows.start) * columns.len() + column - columns.start;
            let ink = [color.x, color.y, color.z, 1.0].map(single);
            values[pixel * components..][..components].copy_from_slice(&ink[..components]);
        }
    }
}

/// The colours of the map, from the last at the top to the first, and boxes for numbers outside that have colours of their own.
struct Bar {
    rows: Range<usize>,
    columns: Range<usize>,
}

impl Bar {
    fn draw(&self, record: &ColorsRecord, map: ColorMap, canvas: &mut Canvas) {
        let count = self.rows.len() as f64;
        for (step, row) in self.rows.clone().rev().enumerate() {
            let color = map.color((step as f64 + 0.5) / count);
            canvas.fill([row..row + 1, self.columns.clone()], color);
        }
        let (height, gap) = ((BOX - 2) * canvas.scale(), 2 * canvas.scale());
        let (top, bottom) = (self.rows.start - gap, self.rows.end + gap);
        for (color, rows) in [
            (record.above, top - height..top),
            (record.below, bottom..bottom + height),
        ] {
            if let Some(color) = color {
                canvas.fill([rows, self.columns.clone()], Color::from(color));
            }
        }
    }
}

/// A name that is at most so wide, in pixels of letters.
fn shortened(by: &str, widest: usize) -> String {
    let name = by.strip_prefix("attribute:").unwrap_or(by);
    let most = (widest + 1) / canvas::ADVANCE;
    if name.chars().count() <= most {
        return name.to_owned();
    }
    let kept = name.chars().take(most.saturating_sub(2));
    kept.chain("..".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(by: &str) -> ColorsRecord {
        ColorsRecord {
            by: by.to_owned(),
            map: "viridis".to_owned(),
            range: [0.0, 1.0],
            below: Some([1.0, 0.0, 0.0]),
            above: None,
            missing: None,
            bar: true,
        }
    }

    #[expect(clippy::needless_pass_by_value, reason = "as literals")]
    fn drawn(by: &str, [rows, columns]: [usize; 2], part: [Range<usize>; 2]) -> Vec<[f32; 3]> {
        let bar = ColorBar::new(&record(by), [rows, columns]).unwrap();
        let mut colors = Data::Float32(vec![-1.0; part[0].len() * part[1].len() * 3]);
        bar.draw(&mut colors, 3, (&part[0], &part[1]));
        match colors {
            Data::Float32(values) => values.as_chunks().0.to_vec(),
            _ => unreachable!(),
        }
    }

    #[test]
    fn the_bar_has_all_colours_and_leaves_the_middle_alone() {
        for size in [
            [120, 160],
            [480, 640],
            [768, 1024],
            [1080, 1920],
            [400, 200],
        ] {
            let [rows, columns] = size;
            let pixels = drawn(
                "attribute:heat of the day before",
                size,
                [0..rows, 0..columns],
            );
            let ink = |pixel: &[f32; 3]| pixel[0] >= 0.0;
            assert!(pixels.iter().filter(|pixel| ink(pixel)).count() > 200);
            for row in 0..rows {
                let left = &pixels[row * columns..][..columns * 3 / 5];
                assert!(!left.iter().any(ink), "{size:?}");
            }
            for number in [0.011, 0.25, 0.5, 0.75, 0.989] {
                let color = ColorMap::Viridis.color(number);
                let near = |pixel: &&[f32; 3]| {
                    let pixel = Color::from(pixel.map(f64::from));
                    (pixel - color).length() < 0.03
                };
                assert!(
                    pixels.iter().any(|pixel| near(&pixel)),
                    "{size:?}: {number}"
                );
            }
            assert!(pixels.contains(&[1.0, 0.0, 0.0]) && pixels.contains(&[1.0; 3]));
        }
    }

    #[test]
    fn a_part_has_its_part_of_the_bar() {
        let [rows, columns] = [240, 320];
        let whole = drawn("height", [rows, columns], [0..rows, 0..columns]);
        let part = drawn("height", [rows, columns], [100..170, 250..300]);
        for (k, row) in (100..170).enumerate() {
            assert_eq!(
                part[k * 50..][..50],
                whole[row * columns + 250..][..50],
                "{row}"
            );
        }
    }

    #[test]
    fn a_picture_too_small_for_it_is_refused() {
        for size in [[20, 400], [400, 60], [1, 1]] {
            let error = ColorBar::new(&record("height"), size).unwrap_err();
            assert!(error.to_string().contains("too small for it"), "{error}");
        }
    }
}
