//! Pixels to draw letters and boxes on.

use std::ops::Range;

use super::font::{self, is_ink};
use crate::geometry::Color;

/// The distance from one letter to the next, in pixels of letters.
pub(super) const ADVANCE: usize = font::SIZE[0] + 1;

/// The width of a text, in pixels of letters.
pub(super) fn width(text: &str) -> usize {
    (ADVANCE * text.chars().count()).saturating_sub(1)
}

/// Pixels, of which most are empty.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    pixels: Vec<Option<Color>>,
    columns: usize,
    /// The width and height of a letter's pixel, in pixels of the picture.
    scale: usize,
}

impl Canvas {
    pub(super) fn new([rows, columns]: [usize; 2], scale: usize) -> Self {
        Self {
            pixels: vec![None; rows * columns],
            columns,
            scale,
        }
    }

    /// Rows and columns.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.pixels.len() / self.columns, self.columns]
    }

    pub(super) fn scale(&self) -> usize {
        self.scale
    }

    /// Fills the rows and columns of a box.
    pub(super) fn fill(&mut self, [rows, columns]: [Range<usize>; 2], color: Color) {
        for row in rows {
            let row = &mut self.pixels[row * self.columns..][..self.columns];
            row[columns.clone()].fill(Some(color));
        }
    }

    /// Writes white letters, the first one's upper left corner being in a row and a column.
    pub(super) fn text(&mut self, [top, left]: [usize; 2], text: &str) {
        let scale = self.scale;
        for (number, letter) in text.chars().enumerate() {
            for row in 0..font::SIZE[1] {
                for column in 0..font::SIZE[0] {
                    if is_ink(letter, row, column) {
                        let row = top + row * scale;
                        let column = left + (number * ADVANCE + column) * scale;
                        self.fill([row..row + scale, column..column + scale], Color::ONE);
                    }
                }
            }
        }
    }

    /// Draws a black line around all that is drawn: so it stands out from any picture.
    pub(super) fn outline(&mut self) {
        let drawn = self.pixels.clone();
        let [rows, columns] = self.size();
        let around =
            |at: usize, most: usize| at.saturating_sub(self.scale)..(at + self.scale + 1).min(most);
        for (k, pixel) in self.pixels.iter_mut().enumerate() {
            let (row, column) = (k / columns, k % columns);
            let mut near = around(row, rows).flat_map(|row| {
                let near = around(column, columns);
                &drawn[row * columns + near.start..row * columns + near.end]
            });
            if pixel.is_none() && near.any(Option::is_some) {
                *pixel = Some(Color::ZERO);
            }
        }
    }

    /// The drawn pixels: rows, columns and colours.
    pub(super) fn pixels(&self) -> impl Iterator<Item = ([usize; 2], Color)> {
        let pixels = self.pixels.iter().enumerate();
        pixels.filter_map(|(k, color)| Some(([k / self.columns, k % self.columns], (*color)?)))
    }
}
