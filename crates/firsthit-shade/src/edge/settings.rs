//! The kinds of edges that are drawn, and their lines.

use std::str::FromStr;

use crate::error::{Error, Result};
use crate::geometry::{Color, named, require};

named! {
    /// The kinds of edges.
    ///
    /// ```
    /// use firsthit::edge::EdgeKind;
    ///
    /// assert_eq!("crease".parse::<EdgeKind>()?, EdgeKind::Crease);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum EdgeKind, "edge kind":
    /// An edge at which a surface turns away from the eye: one of two adjacent faces is a front
    /// face, the other a back face.
    #[default]
    "silhouette" => Silhouette;
    /// An edge at which the angle between the geometric normals of two adjacent faces is large;
    /// shading normals do not matter.
    "crease" => Crease;
    /// An edge at which a surface ends: one of a single triangle, or of more than two.
    "boundary" => Boundary;
    /// The part of silhouettes and boundaries behind which there is another object, or nothing.
    "object" => Object;
    /// Between two materials of one object.
    "material" => Material;
    /// Between the polygons of the file, all of them.
    "wireframe" => Wireframe;
}

/// A set of kinds of edges.
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
    /// The empty set.
    pub const NONE: Self = Self(0);

    /// The set of the kinds in a list.
    pub const fn of(kinds: &[EdgeKind]) -> Self {
        let (mut bits, mut k) = (0, 0);
        while k < kinds.len() {
            bits |= 1 << kinds[k] as u8;
            k += 1;
        }
        Self(bits)
    }

    /// The set of the kinds with these names.
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

    /// Whether the set has a kind.
    pub const fn has(self, kind: EdgeKind) -> bool {
        self.0 >> kind as u8 & 1 == 1
    }

    /// The set with one more kind.
    pub const fn with(self, kind: EdgeKind) -> Self {
        Self(self.0 | 1 << kind as u8)
    }

    /// The intersection of two sets.
    pub const fn common(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Whether the set is empty.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The names of the kinds, in the order of [`EdgeKind`].
    pub fn names(self) -> Vec<&'static str> {
        let all = EdgeKind::ALL.iter().filter(|&&kind| self.has(kind));
        all.map(|kind| kind.name()).collect()
    }
}

/// Silhouettes, creases, boundaries and materials.
impl Default for EdgeKinds {
    fn default() -> Self {
        Self::of(&[EdgeKind::Silhouette, EdgeKind::Crease, EdgeKind::Boundary, EdgeKind::Material])
    }
}

/// Names, separated by commas.
impl FromStr for EdgeKinds {
    type Err = Error;

    fn from_str(names: &str) -> Result<Self> {
        Self::named(names.split(',').map(str::trim))
    }
}

/// A dash pattern along a line, in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dash {
    /// The length of a dash.
    pub on: f64,
    /// The length of the gap after it.
    pub off: f64,
}

impl Dash {
    /// The shortest dash or gap, in pixels. Shorter ones would look like a fainter line, and take
    /// longer to draw the shorter they are.
    pub const SHORTEST: f64 = 0.1;
}

impl Default for Dash {
    /// A dash of six pixels and a gap of four.
    fn default() -> Self {
        Self { on: 6.0, off: 4.0 }
    }
}

/// The lines of edges over a picture.
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
    /// Line width in pixels. Lines narrower than a pixel are fainter, for they cover that much less
    /// of it.
    pub width: f64,
    /// The angle between the normals of two adjacent faces above which their edge is a crease, in
    /// degrees.
    pub angle: f64,
    /// The kinds of edges that are drawn.
    pub kinds: EdgeKinds,
    /// Dash pattern for occluded lines; `None` omits them.
    pub hidden: Option<Dash>,
    /// Line colour, linear.
    pub color: Color,
}

impl Default for Edges {
    /// One pixel wide and black; creases above 30 degrees; no occluded lines.
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
    /// The largest width, in pixels.
    pub const WIDEST: f64 = 1000.0;

    /// Checks that the lines can be drawn.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a width that is not above 0 and up to [`Edges::WIDEST`], an angle
    /// that is not from 0 to 180 degrees, no kinds, a dash or gap that is shorter than
    /// [`Dash::SHORTEST`] or not finite, and a colour that is not finite.
    pub fn check(&self) -> Result<()> {
        let fine = self.width > 0.0 && self.width <= Self::WIDEST;
        require("edges", "a width above 0 and up to 1000 pixels", fine, self.width)?;
        let fine = (0.0..=180.0).contains(&self.angle);
        require("edge angle", "from 0 to 180 degrees", fine, self.angle)?;
        require("edge kinds", "at least one", !self.kinds.is_empty(), "none")?;
        if let Some(Dash { on, off }) = self.hidden {
            for length in [on, off] {
                let fine = length >= Dash::SHORTEST && length.is_finite();
                let expected = "finite dashes and gaps of at least 0.1 pixels";
                require("hidden edges", expected, fine, length)?;
            }
        }
        let fine = self.color.is_finite();
        require("edge color", "finite", fine, self.color)
    }
}
