//! The sources of the numbers that surfaces are coloured by.

use std::str::FromStr;
use std::sync::Arc;

use super::SurfaceInteraction;
use crate::error::{Error, escape_controls};
use crate::geometry::DVec3;

/// The source of the numbers that surfaces are coloured by.
///
/// ```
/// use firsthit::scene::ColorBy;
///
/// assert_eq!("object".parse::<ColorBy>()?, ColorBy::Object);
/// assert_eq!("attribute:heat".parse::<ColorBy>()?, ColorBy::Attribute("heat".into()));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum ColorBy {
    /// An attribute of the meshes, by its name, as `channel::attribute` looks it up; of several
    /// numbers the length of their vector.
    Attribute(Arc<str>),
    /// A number for each object, in the order of their identifiers.
    Values(Arc<[f64]>),
    /// The object's identifier.
    Object,
    /// The polygon of the file; of shapes that are no mesh the primitive.
    Face,
    /// The height of a point above the origin, along the scene's up.
    Height,
    /// The angle between the ray and the geometric normal, in radians.
    Incidence,
}

impl ColorBy {
    /// The words that [`FromStr`] reads, beside `attribute:NAME`.
    pub const NAMES: [&'static str; 4] = ["object", "face", "height", "incidence"];

    /// The prefix before the name of an attribute.
    pub const ATTRIBUTE: &'static str = "attribute:";

    /// The text form; `values` for numbers that a program gave.
    pub fn text(&self) -> String {
        match self {
            Self::Attribute(name) => Self::ATTRIBUTE.to_owned() + &escape_controls(name),
            Self::Values(_) => "values".to_owned(),
            Self::Object => "object".to_owned(),
            Self::Face => "face".to_owned(),
            Self::Height => "height".to_owned(),
            Self::Incidence => "incidence".to_owned(),
        }
    }

    /// The number of a surface in a world with that direction upwards, which has length one; NaN
    /// where there is none.
    pub(super) fn number(&self, surface: &SurfaceInteraction<'_>, up: DVec3) -> f64 {
        match self {
            Self::Attribute(name) => attribute(surface, name),
            Self::Values(values) => usize::try_from(surface.hit().object)
                .ok()
                .and_then(|object| values.get(object).copied())
                .unwrap_or(f64::NAN),
            Self::Object => surface.hit().object.into(),
            Self::Face => surface.face().into(),
            Self::Height => surface.position().dot(up),
            Self::Incidence => surface.incidence(),
        }
    }
}

impl FromStr for ColorBy {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let attribute = text.strip_prefix(Self::ATTRIBUTE).filter(|name| !name.is_empty());
        Ok(match (text, attribute) {
            (_, Some(name)) => Self::Attribute(name.into()),
            ("object", _) => Self::Object,
            ("face", _) => Self::Face,
            ("height", _) => Self::Height,
            ("incidence", _) => Self::Incidence,
            _ => {
                let expected = "attribute:NAME, object, face, height or incidence";
                let got = escape_controls(text);
                return Err(Error::argument("by", expected, got));
            }
        })
    }
}

/// The most numbers of an attribute that count; further ones are left out.
pub(super) const MOST: usize = 16;

fn attribute(surface: &SurfaceInteraction<'_>, name: &str) -> f64 {
    let found = surface.mesh.and_then(|(mesh, triangle)| {
        let found = mesh.attribute(name, None)?;
        let mut numbers = [f64::NAN; MOST];
        let numbers = &mut numbers[..found.components().min(MOST)];
        found.look_up(triangle, surface.hit().barycentric, numbers);
        Some(magnitude(numbers))
    });
    found.unwrap_or(f64::NAN)
}

/// One number as it is, and of several the length of their vector.
pub(super) fn magnitude(numbers: &[f64]) -> f64 {
    match numbers {
        &[number] => number,
        _ => numbers.iter().map(|x| x * x).sum::<f64>().sqrt(),
    }
}
