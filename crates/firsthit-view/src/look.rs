//! The requests of a page.

use firsthit::{Camera, DVec2, DVec3, Error, Lens, RayStart, Result, View, Viewplane};
use serde::{Deserialize, Serialize};

/// The most pixels along an edge of a frame.
const MOST: usize = 8192;

/// A picture that a page asks for.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameRequest {
    /// The camera.
    pub camera: FlatCamera,
    /// The channel that is shown, by its name, `color` among them.
    #[serde(default = "color")]
    pub channel: String,
    /// The points of a pixel whose mean is its colour; by default as many as `firsthit render`
    /// takes.
    pub samples: Option<u32>,
    /// Whether colours are those of `firsthit render`, with shadows; else they are lit from the
    /// camera, without.
    #[serde(default)]
    pub is_lit: bool,
    /// A set of lights by name, in place of the lights that the scene has.
    pub light: Option<String>,
    /// The direction of a sun's light, in place of all other lights and of the environment; of any
    /// length but zero. With the environment `daylight` it is that sky's sun.
    pub sun: Option<[f64; 3]>,
    /// Light from all around in place of what the scene has.
    pub environment: Option<EnvironmentRequest>,
    /// Objects in colours of their own, by their identifiers; the colours are linear.
    #[serde(default)]
    pub colors: Vec<(usize, [f64; 3])>,
    /// Whether there is a ground; by default where `firsthit render` has one.
    pub ground: Option<bool>,
    /// The width in pixels of lines along edges; 0 for none. By default those that
    /// `firsthit render` draws.
    pub edges: Option<f64>,
    /// The colour of the faces that a plane cuts, which is linear; by default each has its
    /// object's.
    pub cut_color: Option<[f64; 3]>,
    /// The part of the scene that is seen.
    #[serde(default)]
    pub part: Visibility,
}

impl FrameRequest {
    /// The colours that a camera sees of the scene as it is, lit from the camera.
    pub fn new(camera: FlatCamera) -> Self {
        Self {
            camera,
            channel: color(),
            samples: None,
            is_lit: false,
            light: None,
            sun: None,
            environment: None,
            colors: Vec::new(),
            ground: None,
            edges: None,
            cut_color: None,
            part: Visibility::default(),
        }
    }
}

/// Light from all around, as a page asks for it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentRequest {
    /// The environment to show.
    pub choice: EnvironmentChoice,
    /// The factor on its radiance.
    #[serde(default = "one")]
    pub strength: f64,
    /// The degrees by which a map is turned about the scene's up, counter-clockwise seen from
    /// above.
    #[serde(default)]
    pub turn: f64,
}

/// The choice of an environment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EnvironmentChoice {
    /// The scene's own environment.
    Own,
    /// No environment.
    None,
    /// The sky of a clear day, with its sun where the request has one, else 40 degrees above the
    /// horizon.
    Daylight,
}

fn one() -> f64 {
    1.0
}

/// The part of a scene that is seen.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Visibility {
    /// The objects that are not there, by their identifiers; by default those that the scene hides.
    pub hidden: Option<Vec<usize>>,
    /// The only objects that are there, in place of `hidden`.
    pub only: Option<Vec<usize>>,
    /// A plane: what is in front of it is not seen, though it casts its shadow.
    pub cut: Option<Cut>,
}

/// A plane through the scene.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cut {
    /// The direction towards the part that is not seen; of any length but zero.
    pub normal: [f64; 3],
    /// The plane's points have this scalar product with the normal.
    pub offset: f64,
}

fn color() -> String {
    "color".to_owned()
}

/// The projection of a camera of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Projection {
    /// Rays start at the eye and spread.
    Perspective,
    /// Parallel.
    Orthographic,
}

/// The start of rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RaysStart {
    /// Rays start at the camera's position.
    #[default]
    Eye,
    /// Rays start on the viewplane.
    Viewplane,
}

/// A camera of the page: one of a flat viewplane around the aim.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FlatCamera {
    /// The position in the world.
    pub position: [f64; 3],
    /// The aim; of any length but zero.
    pub aim: [f64; 3],
    /// The direction upwards; of any length but zero, and not along the aim.
    pub up: [f64; 3],
    /// The projection.
    pub projection: Projection,
    /// The start of rays, with `t` 0.
    #[serde(default)]
    pub ray_start: RaysStart,
    /// The distance of the viewplane.
    pub focal_length: f64,
    /// The viewplane's width.
    pub width: f64,
    /// The viewplane's height.
    pub height: f64,
    /// Pixels down.
    pub rows: usize,
    /// Pixels across.
    pub columns: usize,
}

impl Default for FlatCamera {
    /// The camera at the origin, looking along -z with y up.
    fn default() -> Self {
        Self {
            position: [0.0; 3],
            aim: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            projection: Projection::Perspective,
            ray_start: RaysStart::Eye,
            focal_length: 1.0,
            width: 4.0 / 3.0,
            height: 1.0,
            rows: 480,
            columns: 640,
        }
    }
}

impl FlatCamera {
    /// The description of a camera with a flat viewplane around its aim and no aperture; `None` for
    /// others.
    pub fn of(camera: &Camera) -> Option<Self> {
        let view = camera.view();
        let Lens::Flat(plane) = view.lens else {
            return None;
        };
        let is_plain = plane.shift == DVec2::ZERO && plane.tilt == DVec2::ZERO && plane.skew == 0.0;
        (is_plain && plane.aperture == 0.0).then(|| Self {
            position: view.position.to_array(),
            aim: view.aim.to_array(),
            up: view.up.to_array(),
            projection: if plane.parallel {
                Projection::Orthographic
            } else {
                Projection::Perspective
            },
            ray_start: match plane.ray_start {
                RayStart::Eye => RaysStart::Eye,
                RayStart::Viewplane => RaysStart::Viewplane,
            },
            focal_length: plane.focal_length,
            width: plane.width,
            height: plane.height,
            rows: view.rows,
            columns: view.columns,
        })
    }

    /// The camera that it stands for.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for numbers that are no camera, and for more than 8192 pixels along an
    /// edge.
    pub fn camera(&self) -> Result<Camera> {
        for (name, pixels) in [("rows", self.rows), ("columns", self.columns)] {
            if !(1..=MOST).contains(&pixels) {
                return Err(Error::argument(name, "from 1 to 8192", pixels));
            }
        }
        let plane = Viewplane {
            focal_length: self.focal_length,
            width: self.width,
            height: self.height,
            parallel: self.projection == Projection::Orthographic,
            ray_start: match self.ray_start {
                RaysStart::Eye => RayStart::Eye,
                RaysStart::Viewplane => RayStart::Viewplane,
            },
            ..Viewplane::default()
        };
        Camera::new(View {
            position: DVec3::from(self.position),
            aim: DVec3::from(self.aim),
            up: DVec3::from(self.up),
            rows: self.rows,
            columns: self.columns,
            lens: Lens::Flat(plane),
        })
    }
}
