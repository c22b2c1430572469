//! Textures: texels, and the filter between them.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::geometry::summary::summary;
use crate::geometry::{Color, DVec2, named, srgb_decode_level};
use crate::memory::Storage;

/// Texels of 8-bit red, green, blue and alpha. Colours are encoded as sRGB, alpha is linear; row 0
/// is the top one.
///
/// ```
/// use firsthit::Texture;
///
/// // Red above blue.
/// let texture = Texture::new(1, 2, vec![[255, 0, 0, 255], [0, 0, 255, 255]])?;
/// assert_eq!((texture.columns(), texture.rows()), (1, 2));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct Texture {
    columns: usize,
    rows: usize,
    texels: Storage<[u8; 4]>,
}

// Texels are many.
summary!(Texture, "Texture", |texture| "columns": texture.columns, "rows": texture.rows);

impl Texture {
    /// The texture of `texels`, row by row from the top.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] without texels, and when there are not `columns * rows` of them.
    pub fn new(columns: usize, rows: usize, texels: impl Into<Storage<[u8; 4]>>) -> Result<Self> {
        let texels = texels.into();
        if texels.is_empty() || columns.checked_mul(rows) != Some(texels.len()) {
            let got = format!("{} for {columns} x {rows}", texels.len());
            let expected = "columns times rows, at least one";
            return Err(Error::argument("texels", expected, got));
        }
        Ok(Self { columns, rows, texels })
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
    pub fn texels(&self) -> &[[u8; 4]] {
        &self.texels
    }

    /// Whether some texel is not opaque.
    pub fn has_alpha(&self) -> bool {
        self.texels.iter().any(|texel| texel[3] != u8::MAX)
    }

    /// The texture with other alphas.
    #[doc(hidden)]
    pub fn with_alpha_from(&self, alpha: impl Fn([u8; 4]) -> u8) -> Self {
        let texels = self.texels.iter().map(|&texel| {
            let [red, green, blue, _] = texel;
            [red, green, blue, alpha(texel)]
        });
        Self { texels: texels.collect(), ..*self }
    }

    fn texel(&self, column: usize, row: usize, levels: Levels) -> Sample {
        let [red, green, blue, alpha] = self.texels[row * self.columns + column];
        let share = |level: u8| f64::from(level) / 255.0;
        Sample {
            color: match levels {
                Levels::Srgb => Color::from([red, green, blue].map(srgb_decode_level)),
                Levels::Plain => Color::from([red, green, blue].map(share)),
            },
            alpha: share(alpha),
        }
    }
}

/// The encoding of the levels of red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Levels {
    /// Light, encoded as sRGB.
    Srgb,
    /// Numbers from 0 to 1.
    Plain,
}

/// The value of a texture at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The linear colour.
    pub color: Color,
    /// The opacity, from 0, not there, to 1, opaque.
    pub alpha: f64,
}

named! {
    /// The continuation of a texture beyond its edges.
    pub enum Wrap, "wrap":
    /// The texture again.
    #[default]
    "repeat" => Repeat;
    /// The texture again, every other time mirrored.
    "mirror" => Mirror;
    /// The texels at the edge.
    "clamp" => Clamp;
}

impl Wrap {
    /// The texel at an index that may lie beyond the `count` that there are; `texel` is whole.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and count - 1"
    )]
    fn index(self, texel: f64, count: usize) -> usize {
        let n = count as f64;
        // Remainders of whole numbers are exact; far outside, where texels are finer than float64,
        // any will do.
        let remainder = |period: f64| {
            let remainder = texel % period;
            if remainder < 0.0 { remainder + period } else { remainder }
        };
        let inside = match self {
            Self::Repeat => remainder(n),
            Self::Mirror => {
                let k = remainder(2.0 * n);
                if k < n { k } else { 2.0 * n - 1.0 - k }
            }
            Self::Clamp => texel,
        };
        (inside.clamp(0.0, n - 1.0)) as usize
    }
}

named! {
    /// The filter between texel centres. There are no mipmaps: more samples per pixel serve
    /// instead.
    pub enum Filter, "filter":
    /// The nearest texel's colour.
    "nearest" => Nearest;
    /// The mean of the four around, by distance, in linear light.
    #[default]
    "linear" => Linear;
}

/// One of the two sets of texture coordinates that a mesh may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum UvSet {
    /// [`Mesh::uvs`](crate::shape::Mesh::uvs).
    #[default]
    First,
    /// [`Mesh::second_uvs`](crate::shape::Mesh::second_uvs).
    Second,
}

/// A texture on a surface.
///
/// ```
/// use std::sync::Arc;
///
/// use firsthit::{DVec2, Texture, TextureMap};
///
/// let texture = Arc::new(Texture::new(1, 1, vec![[255, 255, 255, 0]])?);
/// let map = TextureMap::new(texture, TextureMap::V_UP);
/// assert_eq!(map.at(DVec2::splat(0.5)).map(|sample| sample.alpha), Some(0.0));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TextureMap {
    /// The texels; materials may share them.
    pub texture: Arc<Texture>,
    /// The continuation beyond the left and right edge, and beyond the top and bottom one.
    pub wrap: [Wrap; 2],
    /// The filter between texels.
    pub filter: Filter,
    /// The mesh's set of texture coordinates that the map takes: the first, or the second.
    pub uv_set: UvSet,
    /// The rows of the map from a mesh's texture coordinates (u, v, 1) to the picture's, which run
    /// from 0 at the left to 1 at the right, and from 0 at the top to 1 at the bottom.
    pub picture_from_uv: [[f64; 3]; 2],
}

impl TextureMap {
    /// Texture coordinates that run downwards, as in glTF.
    pub const V_DOWN: [[f64; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// Texture coordinates that run upwards, as in OBJ and PLY.
    pub const V_UP: [[f64; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, -1.0, 1.0]];

    /// The texture repeated, filtered, its coordinates running as `picture_from_uv` says.
    pub fn new(texture: Arc<Texture>, picture_from_uv: [[f64; 3]; 2]) -> Self {
        Self {
            texture,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
            uv_set: UvSet::First,
            picture_from_uv,
        }
    }

    /// The value at texture coordinates; `None` where those are not finite.
    pub fn at(&self, uv: DVec2) -> Option<Sample> {
        self.sample(uv, Levels::Srgb)
    }

    /// The value at texture coordinates of a texture that holds numbers, not colours; `None` where
    /// those are not finite.
    pub fn data_at(&self, uv: DVec2) -> Option<[f64; 4]> {
        let sample = self.sample(uv, Levels::Plain)?;
        Some(sample.color.extend(sample.alpha).to_array())
    }

    fn sample(&self, uv: DVec2, levels: Levels) -> Option<Sample> {
        let texel = |column, row| self.texel(column, row, levels);
        let [x, y] = self.picture_from_uv.map(|[a, b, c]| a * uv.x + b * uv.y + c);
        let (x, y) = (x * self.texture.columns as f64, y * self.texture.rows as f64);
        if !(x.is_finite() && y.is_finite()) {
            return None;
        }
        Some(match self.filter {
            Filter::Nearest => texel(x.floor(), y.floor()),
            Filter::Linear => {
                // Texel centres are at +1/2.
                let (x, y) = (x - 0.5, y - 0.5);
                let (left, top) = (x.floor(), y.floor());
                let across = |row: f64| mix(texel(left, row), texel(left + 1.0, row), x - left);
                mix(across(top), across(top + 1.0), y - top)
            }
        })
    }

    fn texel(&self, column: f64, row: f64, levels: Levels) -> Sample {
        let [across, down] = self.wrap;
        self.texture.texel(
            across.index(column, self.texture.columns),
            down.index(row, self.texture.rows),
            levels,
        )
    }
}

fn mix(a: Sample, b: Sample, share: f64) -> Sample {
    Sample {
        color: a.color + share * (b.color - a.color),
        alpha: a.alpha + share * (b.alpha - a.alpha),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of three: black to red, then transparent to opaque.
    fn map(wrap: Wrap, filter: Filter) -> TextureMap {
        let texels = vec![
            [0, 0, 0, 255],
            [255, 0, 0, 255],
            [0, 255, 0, 255],
            [0, 0, 0, 0],
            [0, 0, 255, 128],
            [255, 255, 255, 255],
        ];
        TextureMap {
            wrap: [wrap; 2],
            filter,
            ..TextureMap::new(Arc::new(Texture::new(3, 2, texels).unwrap()), TextureMap::V_DOWN)
        }
    }

    #[test]
    fn texels_are_found_at_their_centres_whatever_the_filter() {
        for filter in [Filter::Nearest, Filter::Linear] {
            let map = map(Wrap::Repeat, filter);
            for (k, texel) in map.texture.texels().iter().enumerate() {
                let (column, row) = ((k % 3) as f64, (k / 3) as f64);
                let uv = DVec2::new((column + 0.5) / 3.0, 0.25 + 0.5 * row);
                let sample = map.at(uv).unwrap();
                let expected = texel.map(|level| f64::from(level) / 255.0);
                // 0 and 255 are the same in sRGB as in linear light.
                let got = sample.color.extend(sample.alpha).to_array();
                for (got, expected) in got.into_iter().zip(expected) {
                    assert!((got - expected).abs() < 1e-12, "{k}: {got} {expected}");
                }
            }
        }
    }

    #[test]
    fn wrapping_is_what_the_words_say() {
        let column = |wrap: Wrap| (-4..7).map(move |k| wrap.index(f64::from(k), 3).to_string());
        let spelled = |wrap| column(wrap).collect::<String>();
        assert_eq!(spelled(Wrap::Repeat), "20120120120");
        assert_eq!(spelled(Wrap::Mirror), "22100122100");
        assert_eq!(spelled(Wrap::Clamp), "00000122222");
    }

    #[test]
    fn between_two_texels_light_is_mixed_not_levels() {
        let sample = map(Wrap::Clamp, Filter::Linear).at(DVec2::new(1.0 / 3.0, 0.25));
        assert!((sample.unwrap().color.x - 0.5).abs() < 1e-12);
    }

    #[test]
    fn coordinates_beyond_all_bounds_are_harmless() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for filter in [Filter::Nearest, Filter::Linear] {
                for far in [1e10, -1e17, 1e300, -1e300] {
                    assert!(map(wrap, filter).at(DVec2::splat(far)).is_some());
                }
                assert_eq!(map(wrap, filter).at(DVec2::NAN), None);
                assert_eq!(map(wrap, filter).at(DVec2::splat(f64::MAX)), None);
            }
        }
    }

    #[test]
    fn a_texture_has_as_many_texels_as_it_says() {
        assert!(Texture::new(2, 2, vec![[0; 4]; 3]).is_err());
        assert!(Texture::new(0, 2, vec![]).is_err());
    }
}
