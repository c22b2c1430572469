use super::directions::{DirectionTable, place_of};
use super::irradiance::IrradianceCache;
use crate::error::{Error, Result};
use crate::geometry::summary::summary;
use crate::geometry::{Color, DVec3, arrays, luminance};
use crate::memory::{self, Storage};
use crate::parallel;

/// An equirectangular (latitude-longitude) HDR map of incident radiance.
///
/// Texels are linear, and row 0 is up. In its own frame up is +y, its middle looks along +x, and to
/// the right of that is +z. Each texel has its colour at its centre; between centres they are
/// mixed, around the back as well, and beyond the first and the last row's centres those rows go
/// on.
///
/// ```
/// use firsthit::DVec3;
/// use firsthit::scene::EnvironmentMap;
///
/// // Bright above, dim below.
/// let map = EnvironmentMap::new(2, 2, vec![[3.0; 3], [3.0; 3], [0.5; 3], [0.5; 3]])?;
/// assert_eq!(map.radiance(DVec3::Y).x, 3.0);
/// assert_eq!(map.radiance(DVec3::X).x, 1.75);
/// # Ok::<(), firsthit::Error>(())
/// ```
pub struct EnvironmentMap {
    columns: usize,
    rows: usize,
    texels: Storage<[f32; 3]>,
    /// `None` where the light is nearly the same from everywhere.
    table: Option<DirectionTable>,
    irradiance: IrradianceCache,
}

summary!(EnvironmentMap, "EnvironmentMap", |map| "columns": map.columns, "rows": map.rows);

impl PartialEq for EnvironmentMap {
    fn eq(&self, other: &Self) -> bool {
        self.columns == other.columns && self.texels == other.texels
    }
}

/// The most cells of the table to draw from: of larger maps, each cell is of several texels.
const MOST_CELLS: usize = 1 << 22;

impl EnvironmentMap {
    /// The map of `texels`, row by row from the top.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] without texels, where there are not `columns * rows` of them, and for
    /// texels that are negative or not finite; [`Error::Limit`] where memory is short.
    pub fn new(columns: usize, rows: usize, texels: impl Into<Storage<[f32; 3]>>) -> Result<Self> {
        let texels = texels.into();
        if texels.is_empty() || columns.checked_mul(rows) != Some(texels.len()) {
            let got = format!("{} for {columns} x {rows}", texels.len());
            let expected = "columns times rows, at least one";
            return Err(Error::argument("texels", expected, got));
        }
        let is_radiance = |texel: &[f32; 3]| texel.iter().all(|&x| x >= 0.0 && x.is_finite());
        let chunks = texels.chunks(parallel::MANY).enumerate();
        let wrong = parallel::map(chunks, |(chunk, texels)| {
            let place = texels.iter().position(|texel| !is_radiance(texel))?;
            Some(chunk * parallel::MANY + place)
        });
        if let Some(wrong) = wrong.into_iter().flatten().next() {
            let [red, green, blue] = texels[wrong];
            let got = format!("[{red}, {green}, {blue}] in row {}", wrong / columns);
            return Err(Error::argument("texels", "finite and not negative", got));
        }
        let mut map =
            Self { columns, rows, texels, table: None, irradiance: IrradianceCache::default() };
        map.table = map.tabulated(MOST_CELLS)?;
        Ok(map)
    }

    /// Texels across.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Texels down.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// All texels, row by row from the top.
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.texels
    }

    /// The radiance from a direction of any length in the map's own frame; black where there is
    /// none.
    pub fn radiance(&self, direction: DVec3) -> Color {
        let place = place_of(direction);
        if place.is_nan() {
            return Color::ZERO;
        }
        let [left, across] = split(place.x * self.columns as f64 - 0.5);
        let [top, down] = split(place.y * self.rows as f64 - 0.5);
        let mixed = |row| {
            let [a, b] = arrays::map([left, left + 1.0], |column| self.texel(column, row));
            a + across * (b - a)
        };
        let (above, below) = (mixed(top), mixed(top + 1.0));
        above + down * (below - above)
    }

    pub(super) fn irradiance_cache(&self) -> &IrradianceCache {
        &self.irradiance
    }

    pub(super) fn table(&self) -> Option<&DirectionTable> {
        self.table.as_ref()
    }

    /// A texel by its whole numbers, which may be one beyond the last or before the first.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and the number of texels"
    )]
    fn texel(&self, column: f64, row: f64) -> Color {
        let (columns, rows) = (self.columns as f64, self.rows as f64);
        let column = if column < 0.0 {
            column + columns
        } else if column >= columns {
            column - columns
        } else {
            column
        };
        let (column, row) = (column as usize, row.clamp(0.0, rows - 1.0) as usize);
        color(self.texels[row * self.columns + column])
    }

    /// The table to draw from; `most` is as in [`mean_luminances`](Self::mean_luminances).
    fn tabulated(&self, most: usize) -> Result<Option<DirectionTable>> {
        let (columns, luminances) = self.mean_luminances(most)?;
        Ok(DirectionTable::new(columns, luminances))
    }

    /// The number of cells in a row, and the mean luminance of each cell, which is positive where
    /// any texel shines. There are at most `most` cells, or one row or column more.
    fn mean_luminances(&self, most: usize) -> Result<(usize, Vec<f64>)> {
        // As few texels to a cell, across and down, as keep the table small.
        let step = (1..=self.texels.len()).find(|step| self.texels.len() / (step * step) <= most);
        let step = step.unwrap_or(1);
        let (columns, rows) = (self.columns.div_ceil(step), self.rows.div_ceil(step));
        let count = columns * rows;
        memory::check("the table of an environment", 2 * count * size_of::<f64>())?;
        let mut luminances = memory::filled(count, 0.0)?;
        let lines = luminances.chunks_mut(columns).enumerate();
        parallel::each(lines, |(row, cells)| {
            let texel_rows = covered(row, rows, self.rows);
            let down = texel_rows.len() as f64;
            for texel_row in texel_rows {
                self.add_row(texel_row, cells);
            }
            for (column, cell) in cells.iter_mut().enumerate() {
                let across = covered(column, columns, self.columns).len() as f64;
                *cell /= across * down;
            }
        });
        Ok((columns, luminances))
    }

    /// Adds to each cell the mean luminances over its texels of a row, between whose centres
    /// colours are mixed.
    fn add_row(&self, row: usize, cells: &mut [f64]) {
        let rows = [row.saturating_sub(1), row, (row + 1).min(self.rows - 1)];
        let down = |column: usize| {
            let texel = |row: usize| luminance(color(self.texels[row * self.columns + column]));
            mean(rows.map(texel))
        };
        let columns = self.columns;
        let last = columns - 1;
        let count = cells.len();
        let line: Vec<f64> = (0..columns).map(down).collect();
        for (cell, sum) in cells.iter_mut().enumerate() {
            for column in covered(cell, count, columns) {
                let left = if column == 0 { last } else { column - 1 };
                let right = if column == last { 0 } else { column + 1 };
                *sum += mean([left, column, right].map(|column| line[column]));
            }
        }
    }
}

/// The mean over a texel of what is mixed between its centre and those of both neighbours.
fn mean([before, own, after]: [f64; 3]) -> f64 {
    0.75 * own + 0.125 * (before + after)
}

/// The texels that a cell is of: all that it has a part of.
fn covered(cell: usize, cells: usize, texels: usize) -> std::ops::Range<usize> {
    cell * texels / cells..((cell + 1) * texels).div_ceil(cells)
}

/// A whole number and what is above it.
fn split(position: f64) -> [f64; 2] {
    let whole = position.floor();
    [whole, position - whole]
}

fn color(texel: [f32; 3]) -> Color {
    Color::from(arrays::map(texel, f64::from))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::sampling::Draws;

    fn map() -> EnvironmentMap {
        let texel = |k: usize| [0.5 + k as f32, if k == 9 { 400.0 } else { 0.25 }, (k % 3) as f32];
        EnvironmentMap::new(6, 4, (0..24).map(texel).collect::<Vec<_>>()).unwrap()
    }

    /// A direction by the longitude from the picture's left edge and the angle from straight up, as
    /// shares.
    fn towards(across: f64, down: f64) -> DVec3 {
        let (sin, cos) = libm::sincos(PI * down);
        let (z, x) = libm::sincos(TAU * across - PI);
        DVec3::new(sin * x, cos, sin * z)
    }

    #[test]
    fn texels_are_found_at_their_centres() {
        let map = map();
        for (k, &texel) in map.texels().iter().enumerate() {
            let (across, down) = (((k % 6) as f64 + 0.5) / 6.0, ((k / 6) as f64 + 0.5) / 4.0);
            let got = map.radiance(7.0 * towards(across, down));
            assert!((got - color(texel)).abs().max_element() < 1e-9, "{k}: {got}");
        }
    }

    #[test]
    fn colours_are_mixed_around_the_back_and_go_on_at_the_poles() {
        let map = map();
        let mean = 0.5 * (color(map.texels()[6]) + color(map.texels()[11]));
        for across in [0.0, 1.0] {
            let got = map.radiance(towards(across, 1.5 / 4.0));
            assert!((got - mean).abs().max_element() < 1e-9, "{got}");
        }
        let got = map.radiance(towards(0.5 / 6.0, 0.01));
        assert!((got - color(map.texels()[0])).abs().max_element() < 1e-9);
        assert_eq!(map.radiance(DVec3::ZERO), Color::ZERO);
        assert_eq!(map.radiance(DVec3::NAN), Color::ZERO);
    }

    /// The mean of what is drawn, over its pdf, is the integral over all directions.
    #[test]
    fn what_is_drawn_has_the_mean_of_the_whole() {
        let map = map();
        let table = map.table().unwrap();
        let count = 1 << 16;
        let (mut sum, mut squares) = (0.0, 0.0);
        for k in 0..count {
            let (direction, pdf) = table.draw(Draws::new(k, 0).two());
            let value = luminance(map.radiance(direction)) / pdf;
            (sum, squares) = (sum + value, squares + value * value);
        }
        let count = count as f64;
        let mean = sum / count;
        let error = ((squares / count - mean * mean) / count).sqrt();
        let mut whole = 0.0;
        for k in 0..600 * 400 {
            let (across, down) =
                ((f64::from(k % 600) + 0.5) / 600.0, (f64::from(k / 600) + 0.5) / 400.0);
            let solid_angle = TAU / 600.0 * PI / 400.0 * libm::sin(PI * down);
            whole += solid_angle * luminance(map.radiance(towards(across, down)));
        }
        // A dim direction is drawn seldom, so this is a noisy sum.
        assert!(error < 0.01 * whole, "{error} {whole}");
        assert!((mean - whole).abs() < 3.0 * error, "{mean} {whole} {error}");
    }

    /// The claim holds too where cells are of several texels, and not of whole ones.
    #[test]
    fn no_direction_that_shines_is_left_out() {
        for (columns, rows, most) in [(7, 5, 35), (61, 31, 200), (30, 15, 1)] {
            let mut texels = vec![[0.0; 3]; columns * rows];
            texels[(rows / 3) * columns + columns - 1] = [0.0, 9.0, 0.0];
            let map = EnvironmentMap::new(columns, rows, texels).unwrap();
            let table = map.tabulated(most).unwrap().unwrap();
            let (width, height) = (columns as f64, rows as f64);
            let mut seen = 0;
            for k in 0..400 {
                // Three texels around it, across the back.
                let across = (width - 2.0 + 3.0 * f64::from(k % 20) / 20.0) / width % 1.0;
                let down = ((rows / 3) as f64 - 1.0 + 3.0 * f64::from(k / 20) / 20.0) / height;
                let direction = towards(across, down);
                if map.radiance(direction).y > 1e-6 {
                    seen += 1;
                    assert!(table.pdf(direction) > 0.0, "{across} {down}");
                }
            }
            assert!(seen > 100, "{seen}");
        }
    }

    /// Cells at the border are of as many texels as others, or of one more.
    #[test]
    fn a_uniform_map_has_an_even_density_whatever_its_size() {
        for (columns, rows, most) in [(61, 31, 200), (30, 15, 4), (64, 32, 128)] {
            let grey = vec![[0.25; 3]; columns * rows];
            let mut map = EnvironmentMap::new(columns, rows, grey).unwrap();
            let (_, luminances) = map.mean_luminances(most).unwrap();
            for luminance in luminances {
                assert!((luminance - 0.25).abs() < 1e-12, "{columns} {luminance}");
            }
            // Below a bright row, for which directions are worth drawing.
            let mut texels = map.texels().to_vec();
            texels[..columns].fill([100.0; 3]);
            map = EnvironmentMap::new(columns, rows, texels).unwrap();
            let table = map.tabulated(most).unwrap().unwrap();
            let pdf = table.pdf(DVec3::NEG_Y);
            for k in 0..400 {
                let below = 0.6 + 0.4 * f64::from(k / 20) / 20.0;
                let direction = towards(f64::from(k % 20) / 20.0, below);
                let ratio = table.pdf(direction) / pdf;
                assert!((ratio - 1.0).abs() < 1e-9, "{columns} {direction} {ratio}");
            }
        }
    }

    #[test]
    fn texels_that_are_no_radiance_are_refused() {
        for wrong in [f32::NAN, -1.0, f32::INFINITY] {
            let error = EnvironmentMap::new(2, 1, vec![[0.0; 3], [1.0, wrong, 0.0]]);
            assert!(error.unwrap_err().to_string().contains("texels"));
        }
        assert!(EnvironmentMap::new(2, 2, vec![[0.0; 3]; 3]).is_err());
        assert!(EnvironmentMap::new(0, 0, vec![]).is_err());
    }
}
