//! A part of a sensor's pixels, at one point of each.

use std::ops::Range;

use crate::error::Result;
use crate::geometry::{DVec2, DVec3, PixelGrid, Ray, Rays, require};
use crate::sensor::{Record, Sensor};

use super::sample::Sample;

/// A rectangle of pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Region {
    /// The rows, counted from the top.
    pub rows: Range<usize>,
    /// The columns, counted from the left.
    pub columns: Range<usize>,
}

impl Region {
    /// All pixels of a sensor.
    pub fn all([rows, columns]: [usize; 2]) -> Self {
        Self { rows: 0..rows, columns: 0..columns }
    }

    /// Rows and columns.
    pub fn shape(&self) -> [usize; 2] {
        [self.rows.len(), self.columns.len()]
    }

    /// Refuses a region that has no pixels, or others than a sensor of that shape.
    pub(super) fn check(&self, [rows, columns]: [usize; 2]) -> Result<()> {
        let fits = |part: &Range<usize>, all| part.start < part.end && part.end <= all;
        let is_part = fits(&self.rows, rows) && fits(&self.columns, columns);
        let got = format!("rows {:?} and columns {:?}", self.rows, self.columns);
        require("region", "a part of the picture that is not empty", is_part, got)
    }
}

/// The rays of one sample of the pixels of a region.
#[derive(Debug)]
pub(super) struct RegionRays<'a> {
    pub(super) region: Region,
    sample: Sample<'a>,
}

impl<'a> RegionRays<'a> {
    /// The rays of the first sample, which go through the pixels' centres.
    pub(super) fn new(sensor: &'a dyn Sensor, region: Region) -> Self {
        Self { region, sample: Sample::new(sensor, 0) }
    }

    /// Goes on to another sample.
    pub(super) fn go_to(&mut self, sample: u32) {
        self.sample.go_to(sample);
    }

    fn sensor(&self) -> &dyn Sensor {
        self.sample.sensor()
    }

    /// The number of a pixel in the whole picture.
    pub(super) fn pixel(&self, index: usize) -> usize {
        let [_, columns] = self.sensor().shape();
        let width = self.region.columns.len();
        let row = self.region.rows.start + index / width;
        row * columns + self.region.columns.start + index % width
    }

    /// The numbers in the whole picture of the pixels from one on.
    pub(super) fn number(&self, first: usize, numbers: &mut [u64]) {
        let [_, columns] = self.sensor().shape();
        let width = self.region.columns.len();
        let mut within = first % width;
        let mut pixel = self.pixel(first);
        for number in numbers {
            *number = pixel as u64;
            within += 1;
            pixel += 1;
            if within == width {
                within = 0;
                pixel += columns - width;
            }
        }
    }
}

impl Rays for RegionRays<'_> {
    fn len(&self) -> usize {
        let [rows, columns] = self.region.shape();
        rows.saturating_mul(columns)
    }

    fn ray(&self, index: usize) -> Ray {
        self.sensor().ray_within(self.pixel(index), self.sample.offset())
    }

    fn grid(&self) -> Option<PixelGrid> {
        self.grid_within(self.sample.offset())
    }

    fn read(&self, first: usize, rays: &mut [Ray]) {
        if let Some(grid) = self.grid() {
            return grid.read(first, rays);
        }
        let width = self.region.columns.len();
        let mut first = first;
        let mut rest = rays;
        while !rest.is_empty() {
            let (of_row, after) = rest.split_at_mut(rest.len().min(width - first % width));
            self.sensor().row_within(self.pixel(first), self.sample.offset(), of_row);
            (first, rest) = (first + of_row.len(), after);
        }
    }

    fn read_directions(&self, first: usize, directions: [&mut [f64]; 3]) {
        self.directions_within(first, self.sample.offset(), directions);
    }

    fn picture(&self) -> Option<[usize; 2]> {
        self.sensor().picture().map(|_| self.region.shape())
    }
}

impl Sensor for RegionRays<'_> {
    fn shape(&self) -> [usize; 2] {
        self.region.shape()
    }

    fn ray_within(&self, pixel: usize, offset: DVec2) -> Ray {
        self.sensor().ray_within(self.pixel(pixel), offset)
    }

    fn grid_within(&self, offset: DVec2) -> Option<PixelGrid> {
        let first = [self.region.rows.start, self.region.columns.start];
        let grid = self.sensor().grid_within(offset)?;
        Some(grid.part(first, self.region.shape()))
    }

    fn row_within(&self, first: usize, offset: DVec2, rays: &mut [Ray]) {
        self.sensor().row_within(self.pixel(first), offset, rays);
    }

    fn directions_within(&self, first: usize, offset: DVec2, directions: [&mut [f64]; 3]) {
        let pixel = self.pixel(first);
        self.sensor().directions_within(pixel, offset, directions);
    }

    fn range_and_z(&self, pixel: usize, t: f64) -> [f64; 2] {
        self.sensor().range_and_z(self.pixel(pixel), t)
    }

    fn has_aim(&self) -> bool {
        self.sensor().has_aim()
    }

    fn place(&self, pixel: usize) -> (DVec3, Option<DVec3>) {
        self.sensor().place(self.pixel(pixel))
    }

    fn time(&self, pixel: usize) -> Option<f64> {
        self.sensor().time(self.pixel(pixel))
    }

    fn record(&self) -> Record {
        self.sensor().record()
    }
}
