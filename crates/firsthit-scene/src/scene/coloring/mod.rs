//! Colours by numbers: what numbers say of surfaces, in the place of their own colours.

mod by;
mod extent;

use std::sync::Arc;

pub use by::ColorBy;

use super::{Scene, SurfaceInteraction};
use crate::error::{Error, Result};
use crate::geometry::{Color, ColorMap, DVec3, fraction, unit};

/// Colours of surfaces by numbers (false colours), in the place of their own. Every shader sees
/// these colours, and lights them as it does others.
///
/// ```
/// use firsthit::scene::{ColorBy, Coloring};
/// use firsthit::{DVec3, Object, Scene, Shade, Shader, Sphere, shoot};
///
/// let ball = |x| Sphere::new(DVec3::new(x, 0.0, 0.0), 1.0).map(Object::new);
/// let scene = Scene::new(vec![ball(0.0)?, ball(5.0)?, ball(10.0)?])?;
/// let coloring = Coloring::new(ColorBy::Values([2.5, 0.0, 10.0].into()));
/// let (map, scene) = (coloring.map, scene.with_coloring(Some(coloring))?);
/// let hit = shoot(&scene, DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
/// let color = Shader::named("unlit")?.on(&scene).shade(hit.t, DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z, &hit);
/// assert_eq!(color, map.color(0.25));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Coloring {
    /// The source of the numbers.
    pub by: ColorBy,
    /// The colour map.
    pub map: ColorMap,
    /// The numbers of the first and the last colour. If it is left open, those are the least and
    /// the largest of all objects but hidden ones, in the picture or not.
    pub range: Option<[f64; 2]>,
    /// The colour of numbers below a given range. If it is left open, the first one of the map.
    pub below: Option<Color>,
    /// The colour of numbers above a given range. If it is left open, the last one of the map.
    pub above: Option<Color>,
    /// The colour where there is no number, or NaN. If it is left open, the surface's own.
    pub missing: Option<Color>,
}

impl Coloring {
    /// A colouring with the default map, over the range of all numbers.
    pub fn new(by: ColorBy) -> Self {
        Self { by, map: ColorMap::default(), range: None, below: None, above: None, missing: None }
    }
}

/// A [`Coloring`] of a scene, whose range is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Colored {
    coloring: Coloring,
    range: [f64; 2],
    /// The scene's up, of length one.
    up: DVec3,
}

impl Scene {
    /// The scene coloured by numbers, or in its own colours for `None`. Its fingerprint does not
    /// depend on it.
    ///
    /// A range that is left open is decided now: where objects are moved later, colours stay
    /// comparable.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an attribute that no mesh has, for values that are not as many as
    /// objects, where a range is left open and there is no number, and for a range whose numbers do
    /// not rise.
    pub fn with_coloring(self, coloring: Option<Coloring>) -> Result<Self> {
        let colored = coloring.map(|coloring| Colored::new(coloring, &self));
        Ok(Self { colored: colored.transpose()?.map(Arc::new), ..self })
    }

    /// The colouring by numbers, if there is one.
    pub fn colored(&self) -> Option<&Colored> {
        self.colored.as_deref()
    }
}

impl Colored {
    fn new(coloring: Coloring, scene: &Scene) -> Result<Self> {
        let found = coloring.by.extent(scene)?;
        let range = match (coloring.range, found) {
            (Some([low, high]), _) if low < high && (high - low).is_finite() => [low, high],
            (Some(range), _) => {
                let got = format!("{range:?}");
                return Err(Error::argument("range", "two numbers that rise", got));
            }
            (None, Some(found)) => found,
            (None, None) => {
                let expected = "given where there is no finite number";
                return Err(Error::argument("range", expected, coloring.by.text()));
            }
        };
        Ok(Self { up: unit(scene.up()), range, coloring })
    }

    /// The settings that it was made from.
    pub fn coloring(&self) -> &Coloring {
        &self.coloring
    }

    /// The numbers of the first and the last colour.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// The colour of a surface; `None` for its own.
    pub(super) fn color(&self, surface: &SurfaceInteraction<'_>) -> Option<Color> {
        let Coloring { map, range: given, below, above, missing, .. } = self.coloring;
        let number = self.coloring.by.number(surface, self.up);
        if number.is_nan() {
            return missing;
        }
        // Of all numbers that there are none is outside; some may seem so, by rounding.
        let own = |end: Option<Color>| end.filter(|_| given.is_some());
        let [low, high] = self.range;
        let mapped = || map.color(fraction(number, self.range));
        Some(if number < low {
            own(below).unwrap_or_else(mapped)
        } else if number > high {
            own(above).unwrap_or_else(mapped)
        } else {
            mapped()
        })
    }
}
