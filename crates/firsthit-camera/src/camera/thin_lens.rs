//! Cameras with an aperture: a thin lens that is in focus at one distance.
//!
//! Every point of the lens is the eye of a pinhole camera whose viewplane is shifted so that what
//! is in focus stays where it is: a picture is the mean of those of many points (Potmesil and
//! Chakravarty, "A Lens and Aperture Camera Model for Synthetic Image Generation", SIGGRAPH 1981;
//! Haeberli and Akeley, "The Accumulation Buffer", SIGGRAPH 1990). So each sample is a grid of
//! rays. Of a lens with distortion it is that of the undistorted image: a ray goes to where its
//! pixel's, through the middle, is in focus.

use super::{Camera, Lens, Projection, View};
use crate::error::{Error, Result};
use crate::geometry::{DVec2, DVec3, Domain, Setting, Value, require, setting_list};

impl Camera {
    /// The camera with a thin lens: a disc around `position`, at right angles to the aim, of
    /// diameter `aperture`. Points at the distance `focus` along the aim are sharp. A point at
    /// another distance z becomes a disc, whose diameter on the viewplane is
    /// `aperture * |z - focus| / (z * focus) * focal_length`. Lengths are in scene units; an
    /// aperture of 0 is a pinhole.
    ///
    /// Only colours see it, and only with several samples: rays of a sample come from one point of
    /// the lens. The camera's own rays and all other channels are those of the pinhole at
    /// `position`.
    ///
    /// ```
    /// use firsthit::{Camera, DVec3, Object, Render, Scene, Sphere};
    ///
    /// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
    /// let camera = Camera::look_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, 45.0, 30, 40)?;
    /// let camera = camera.thin_lens(0.5, camera.depth(DVec3::NEG_Y))?;
    /// let frame = Render::new(&scene).camera(camera).samples(16).frame()?;
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an aperture that is negative or not finite, a `focus` that is not
    /// positive, and a camera that may have no aperture: one that is tilted, and all projections of
    /// which [`has_thin_lens`](super::Projection::has_thin_lens) is false.
    pub fn thin_lens(&self, aperture: f64, focus: f64) -> Result<Self> {
        let fine = focus > 0.0 && focus.is_finite();
        require("focus", "positive and finite", fine, focus)?;
        let mut lens = self.view.lens;
        let numbers = match &mut lens {
            Lens::Flat(lens) => [&mut lens.aperture, &mut lens.focus],
            Lens::OpenCv(lens) => [&mut lens.aperture, &mut lens.focus],
            Lens::Fov(lens) => [&mut lens.aperture, &mut lens.focus],
            _ => {
                let name = lens.projection().name();
                return Err(Error::argument("aperture", Projection::NO_THIN_LENS, name));
            }
        };
        let [own_aperture, own_focus] = numbers;
        (*own_aperture, *own_focus) = (aperture, focus);
        Self::from_view_exact(View { lens, ..self.view })
    }

    /// The depth of a point ahead of the camera: the component along the aim of (point -
    /// `position`), which [`thin_lens`](Self::thin_lens) takes to bring it into focus.
    pub fn depth(&self, point: DVec3) -> f64 {
        (point - self.pose.position).dot(self.pose.aim)
    }

    /// The pinhole camera at a point of the lens, in units of its radius: to the right and upwards.
    /// `None` where the camera is a pinhole's.
    pub fn through(&self, point: DVec2) -> Option<Self> {
        let aperture = self.view.lens.aperture();
        if aperture == 0.0 {
            return None;
        }
        let mut camera = *self;
        let point = 0.5 * aperture * point;
        let moved = point.x * self.pose.right + point.y * self.pose.upwards;
        camera.pose.position += moved;
        camera.view.position = camera.pose.position;
        camera.view.lens = match self.view.lens {
            Lens::Flat(lens) => Lens::Flat(lens.seen_from(point)),
            Lens::OpenCv(lens) => Lens::OpenCv(lens.seen_from(point)),
            Lens::Fov(lens) => Lens::Fov(lens.seen_from(point)),
            _ => return None,
        };
        Some(camera)
    }
}

impl Lens {
    /// The diameter of its aperture; 0 of a pinhole, and of all that have none.
    pub fn aperture(&self) -> f64 {
        self.thin_lens()[0]
    }

    /// The distance along the aim to the plane in focus; 0 by default.
    pub fn focus(&self) -> f64 {
        self.thin_lens()[1]
    }

    fn thin_lens(&self) -> [f64; 2] {
        match self {
            Self::Flat(lens) => [lens.aperture, lens.focus],
            Self::OpenCv(lens) => [lens.aperture, lens.focus],
            Self::Fov(lens) => [lens.aperture, lens.focus],
            _ => [0.0; 2],
        }
    }
}

impl Projection {
    /// The expectation for an aperture with projections that have no thin lens, for messages.
    pub const NO_THIN_LENS: &str =
        "left out: only perspective cameras, opencv and fov have a thin lens";

    /// Whether its cameras may have an aperture: all rays come through one point, less than a right
    /// angle off the aim.
    ///
    /// ```
    /// use firsthit::Projection;
    ///
    /// assert!(Projection::OpenCv.has_thin_lens());
    /// assert!(!Projection::OpenCvFisheye.has_thin_lens());
    /// ```
    pub fn has_thin_lens(self) -> bool {
        matches!(self, Self::Perspective | Self::OpenCv | Self::Fov)
    }
}

/// The numbers of a thin lens.
pub const THIN_LENS: &[Setting; 2] = setting_list! {
    /// The diameter of the lens: colours of several samples are sharp at focus, and blurred nearer
    /// and farther. Default: 0, a pinhole.
    aperture: Domain::NonNegative, default;
    /// The distance along the aim at which the picture is sharp.
    focus: Domain::NonNegative, default;
};

/// Refuses numbers that no thin lens has.
pub(super) fn check_thin_lens(aperture: f64, focus: f64) -> Result<()> {
    for (setting, number) in THIN_LENS.iter().zip([aperture, focus]) {
        setting.domain.checked(setting.name, Value::Number(number))?;
    }
    let expected = "a positive distance for a camera with an aperture";
    require("focus", expected, aperture == 0.0 || focus > 0.0, focus)
}
