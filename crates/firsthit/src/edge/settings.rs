//! What is drawn, and how.

use std::str::FromStr;

use crate::error::{Error, Result};
use crate::geometry::{Color, named, require, require_positive};

named! {
    /// What makes a line of an edge.
    ///
    /// ```
    /// use firsthit::edge::EdgeKind;
    ///
    /// assert_eq!("crease".parse::<EdgeKind>()?, EdgeKind::Crease);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum EdgeKind, "edge kind":
    /// Where a surface turns away from the eye: one of two neighbours faces it, the other does not.
    #[default]
    "silhouette" => Silhouette;
    /// Where two neighbours meet at an angle of their own normals, whatever the shading normals say.
    "crease" => Crease;
    /// Where a surface ends: an edge with one triangle, or with more than two.
    "boundary" => Boundary;
    /// The part of silhouettes and boundaries behind which there is another object, or nothing.
    "object" => Object;
    /// Between two materials of one object.
    "material" => Material;
    /// Between all polygons of the file.
    "wireframe" => Wireframe;
}

/// A set of kinds.
///
/// ```
/// use firsthit::edge::{EdgeKind, EdgeKinds};
///
/// let kinds: EdgeKinds = "crease,object".parse()?;
/// assert_eq!(kinds, EdgeKinds::of(&[EdgeKind::Object, EdgeKind::Crease]));
/// assert!(kinds.has(EdgeKind::Object) && !kinds.has(EdgeKind::Silhouette));
/// assert_eq!(kinds.names(), ["crease", "object"]);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct EdgeKinds(u8);

impl EdgeKinds {
    /// None.
    pub const NONE: Self = Self(0);

    /// Those of a list.
    pub const fn of(kinds: &[EdgeKind]) -> Self {
        let (mut bits, mut k) = (0, 0);
        while k < kinds.len() {
            bits |= 1 << kinds[k] as u8;
            k += 1;
        }
        Self(bits)
    }

    /// Those of the names in a list.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an empty list, and for a name that no kind has.
    pub fn named<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Self> {
        let kinds = names.into_iter().map(EdgeKind::from_str);
        let kinds = Self::of(&kinds.collect::<Result<Vec<_>>>()?);
        require("edge kinds", "at least one", !kinds.is_empty(), "none")?;
        Ok(kinds)
    }

    /// Whether one of them is this.
    pub const fn has(self, kind: EdgeKind) -> bool {
        self.0 >> kind as u8 & 1 == 1
    }

    /// The same, and one more.
    pub const fn with(self, kind: EdgeKind) -> Self {
        Self(self.0 | 1 << kind as u8)
    }

    /// Those that both sets have.
    pub const fn common(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Whether there are none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Their names.
    pub fn names(self) -> Vec<&'static str> {
        let all = EdgeKind::ALL.iter().filter(|&&kind| self.has(kind));
        all.map(|kind| kind.name()).collect()
    }
}

/// Silhouettes, creases, boundaries and materials.
impl Default for EdgeKinds {
    fn default() -> Self {
        Self::of(&[
            EdgeKind::Silhouette,
            EdgeKind::Crease,
            EdgeKind::Boundary,
            EdgeKind::Material,
        ])
    }
}

/// The names, with commas between.
impl FromStr for EdgeKinds {
    type Err = Error;

    fn from_str(names: &str) -> Result<Self> {
        Self::named(names.split(',').map(str::trim))
    }
}

/// A pattern of dashes along a line, in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dash {
    /// How long a dash is.
    pub on: f64,
    /// How long the gap after it is.
    pub off: f64,
}

impl Default for Dash {
    /// Six pixels, and a gap of four.
    fn default() -> Self {
        Self { on: 6.0, off: 4.0 }
    }
}

/// The lines of edges, as they are drawn over a picture.
///
/// ```
/// use firsthit::edge::{Dash, Edges};
/// use firsthit::{DVec3, Object, Render, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let edges = Edges { width: 1.5, hidden: Some(Dash::default()), ..Edges::default() };
/// Render::new(&scene).size(30, 40).edges(edges).frame()?;
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edges {
    /// How wide a line is, in pixels. Below 1 lines are fainter, by the part of a pixel that they cover.
    pub width: f64,
    /// Neighbours whose normals are more than so many degrees apart meet in a crease.
    pub angle: f64,
    /// Which edges have lines.
    pub kinds: EdgeKinds,
    /// How lines are drawn that something hides; not at all for `None`.
    pub hidden: Option<Dash>,
    /// Their linear colour.
    pub color: Color,
}

impl Default for Edges {
    /// One pixel wide and black; creases from 30 degrees on; nothing of what is hidden.
    fn default() -> Self {
        Self {
            width: 1.0,
            angle: 30.0,
            kinds: EdgeKinds::default(),
            hidden: None,
            color: Color::ZERO,
        }
    }
}

impl Edges {
    /// The widest line.
    pub const WIDEST: f64 = 1000.0;

    /// Refuses what cannot be drawn.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a width that is not above 0 and up to [`Edges::WIDEST`], an angle that is not from 0 to 180 degrees, no
    /// kinds, dashes and gaps that are not positive, and a colour that is not finite.
    pub fn check(&self) -> Result<()> {
        let fine = self.width > 0.0 && self.width <= Self::WIDEST;
        require(
            "edges",
            "a width above 0 and up to 1000 pixels",
            fine,
            self.width,
        )?;
        let fine = (0.0..=180.0).contains(&self.angle);
        require("edge angle", "from 0 to 180 degrees", fine, self.angle)?;
        require("edge kinds", "at least one", !self.kinds.is_empty(), "none")?;
        if let Some(Dash { on, off }) = self.hidden {
            require_positive("hidden edges", on)?;
            require_positive("hidden edges", off)?;
        }
        let fine = self.color.is_finite();
        require("edge color", "finite", fine, self.color)
    }
}
