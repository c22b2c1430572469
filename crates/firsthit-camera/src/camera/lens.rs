//! Lenses: the rays of a camera; a file per lens.

use super::aim_at::FovAxis;
use super::calibrated::{Calibrated, within};
use super::central::Central;
use super::cube_map::CubeMap;
use super::cylindrical::Cylindrical;
use super::distortion::{
    DoubleSphere, Equidistant, Equisolid, Eucm, Fov, KannalaBrandt, Mei, OpenCv, OpenCvFisheye,
    OrthographicFisheye, RadTanThinPrismFisheye, Stereographic, ThinPrismFisheye, Ucm,
};
use super::equirectangular::Equirectangular;
use super::octahedral::Octahedral;
use super::parameters::{self, Parameters};
use super::pose::Pose;
use super::viewplane::Viewplane;
use crate::error::{Error, Result};
use crate::geometry::{DVec2, DVec3, PixelGrid, Ray, Setting, named};
use crate::simd::InstructionSet;

/// The contract of every lens, for a camera of a pose and with `size` rows and columns of pixels.
pub(super) trait Model {
    /// Checks how its numbers, each in its domain, go together, and computes what depends on them
    /// alone.
    fn prepare(&mut self, size: [usize; 2]) -> Result<()>;
    /// The ray through a point of a pixel, its direction of length one; NaN where nothing is seen.
    /// `offset` runs from 0 to 1 rightwards and upwards.
    fn ray(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2], offset: DVec2) -> Ray;
    /// The directions of those of pixels of one row from one on, axis by axis: what
    /// [`ray`](Self::ray) gives, sooner than one by one.
    fn directions(
        &self,
        _set: InstructionSet,
        pose: &Pose,
        size: [usize; 2],
        [row, first]: [usize; 2],
        offset: DVec2,
        [x, y, z]: [&mut [f64]; 3],
    ) {
        for (column, ((x, y), z)) in (first..).zip(x.iter_mut().zip(y).zip(z)) {
            let direction = self.ray(pose, size, [row, column], offset).direction;
            (*x, *y, *z) = direction.into();
        }
    }
    /// The point of the picture at which a point is seen: columns from the left edge and rows from
    /// the upper one. The point counts from the camera, x to the right, y down, z ahead.
    fn project(&self, size: [usize; 2], point: DVec3) -> Option<DVec2>;
    /// The conversion from the `t` of the ray through a pixel's centre to the other two distances.
    fn reach(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2]) -> Reach;
    /// The grid of the rays through that point of all pixels, if they all go through a flat
    /// viewplane.
    fn grid(&self, _: &Pose, _size: [usize; 2], _offset: DVec2) -> Option<PixelGrid> {
        None
    }
}

/// The conversion from a ray's `t` to the other two distances: `range = t + offset`,
/// `z = range * cosine`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reach {
    pub(super) offset: f64,
    pub(super) cosine: f64,
}

/// Makes [`Lens`] and [`Projection`]: a lens is a file with a [`Central`], and a row.
macro_rules! lenses {
    ($($(#[$doc:meta])* $name:literal => $variant:ident($model:ty);)*) => {
        /// The lens of a camera, with its parameters.
        ///
        /// ```
        /// use firsthit::camera::Equirectangular;
        /// use firsthit::{Camera, DVec3, Lens, View};
        ///
        /// let lens = Lens::Equirectangular(Equirectangular::default());
        /// let panorama = Camera::new(View { rows: 180, columns: 360, lens, ..View::default() })?;
        /// // Half a degree right of the aim and above it.
        /// assert!(panorama.ray(89, 180).direction.abs_diff_eq(DVec3::NEG_Z, 0.02));
        /// # Ok::<(), firsthit::Error>(())
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Lens {
            /// A flat viewplane.
            Flat(Viewplane),
            $($(#[$doc])* $variant($model),)*
        }

        impl Lens {
            pub(super) fn model(&self) -> &dyn Model {
                match self {
                    Self::Flat(lens) => lens,
                    $(Self::$variant(lens) => lens,)*
                }
            }

            fn model_mut(&mut self) -> &mut dyn Model {
                match self {
                    Self::Flat(lens) => lens,
                    $(Self::$variant(lens) => lens,)*
                }
            }

            fn parameters_mut(&mut self) -> &mut dyn Parameters {
                match self {
                    Self::Flat(lens) => lens,
                    $(Self::$variant(lens) => lens,)*
                }
            }

            /// The projection: its name in files and on the command line.
            pub fn projection(&self) -> Projection {
                match self {
                    Self::Flat(viewplane) if viewplane.parallel => Projection::Orthographic,
                    Self::Flat(_) => Projection::Perspective,
                    $(Self::$variant(_) => Projection::$variant,)*
                }
            }

            /// The lens for a part of the picture, which begins at a row and a column.
            pub(super) fn cropped(&self, whole: [usize; 2], first: [usize; 2], size: [usize; 2]) -> Option<Self> {
                Some(match self {
                    Self::Flat(viewplane) => Self::Flat(viewplane.cropped(whole, first, size)),
                    $(Self::$variant(lens) => Self::$variant(lens.cropped(first)?),)*
                })
            }

            /// The lens for the same picture at `factors` times its rows and columns.
            pub(super) fn scaled(&self, factors: [f64; 2]) -> Self {
                match self {
                    Self::Flat(viewplane) => Self::Flat(*viewplane),
                    $(Self::$variant(lens) => Self::$variant(lens.scaled(factors)),)*
                }
            }
        }

        named! {
            /// The projections by name, as in files and on the command line.
            ///
            /// ```
            /// use firsthit::Projection;
            ///
            /// assert_eq!("orthographic".parse::<Projection>()?, Projection::Orthographic);
            /// assert_eq!(Projection::default().name(), "perspective");
            /// # Ok::<(), firsthit::Error>(())
            /// ```
            pub enum Projection, "projection":
            /// All rays pass through the camera's position and a flat viewplane.
            #[default]
            "perspective" => Perspective;
            /// All rays are parallel to the aim.
            "orthographic" => Orthographic;
            $($(#[$doc])* $name => $variant;)*
        }

        impl Projection {
            /// The numbers of its lenses: names, meanings and domains.
            ///
            /// ```
            /// let names = firsthit::Projection::Ucm.settings().into_iter().map(|setting| setting.name);
            /// assert_eq!(names.collect::<Vec<_>>(), ["fx", "fy", "cx", "cy", "skew", "alpha"]);
            /// ```
            pub fn settings(self) -> Vec<&'static Setting> {
                let mut all = Vec::new();
                self.lens().parameters_mut().each(&mut |setting, _| all.push(setting));
                all
            }

            /// A lens of this kind with its default numbers.
            fn lens(self) -> Lens {
                match self {
                    Self::Perspective => Lens::Flat(Viewplane::default()),
                    Self::Orthographic => Lens::Flat(Viewplane { parallel: true, ..Viewplane::default() }),
                    $(Self::$variant => Lens::$variant(Default::default()),)*
                }
            }
        }
    };
}

lenses! {
    /// A panorama: columns are degrees of longitude, rows degrees of latitude. All directions,
    /// unless the fields of view are smaller.
    "equirectangular" => Equirectangular(Equirectangular);
    /// A panorama: columns are degrees of longitude, rows are heights on a cylinder.
    "cylindrical" => Cylindrical(Cylindrical);
    /// All directions, on the faces of a cube.
    "cube_map" => CubeMap(CubeMap);
    /// All directions, on the faces of an octahedron, in one square.
    "octahedral" => Octahedral(Octahedral);
    /// A calibrated camera with OpenCV's distortion.
    "opencv" => OpenCv(Calibrated<OpenCv>);
    /// A calibrated fisheye with OpenCV's distortion.
    "opencv_fisheye" => OpenCvFisheye(Calibrated<OpenCvFisheye>);
    /// A calibrated fisheye with Kannala and Brandt's polynomial.
    "kannala_brandt" => KannalaBrandt(Calibrated<KannalaBrandt>);
    /// A calibrated fisheye: the double sphere model.
    "double_sphere" => DoubleSphere(Calibrated<DoubleSphere>);
    /// A calibrated fisheye or mirror: the enhanced unified camera model.
    "eucm" => Eucm(Calibrated<Eucm>);
    /// A calibrated fisheye or mirror: the unified camera model.
    "ucm" => Ucm(Calibrated<Ucm>);
    /// A calibrated fisheye or mirror: Mei's model, that of `cv2.omnidir`.
    "mei" => Mei(Calibrated<Mei>);
    /// A calibrated wide-angle camera: Devernay and Faugeras's field-of-view model, which is
    /// COLMAP's FOV.
    "fov" => Fov(Calibrated<Fov>);
    /// A calibrated fisheye with tangential and thin prism distortion, as COLMAP has it.
    "thin_prism_fisheye" => ThinPrismFisheye(Calibrated<ThinPrismFisheye>);
    /// A calibrated fisheye of Project Aria: a polynomial, then tangential and thin prism
    /// distortion.
    "rad_tan_thin_prism_fisheye" => RadTanThinPrismFisheye(Calibrated<RadTanThinPrismFisheye>);
    /// A fisheye: distances from the middle are angles.
    "equidistant" => Equidistant(Calibrated<Equidistant>);
    /// A fisheye: areas are solid angles.
    "equisolid" => Equisolid(Calibrated<Equisolid>);
    /// A fisheye: shapes are kept where they are small.
    "stereographic" => Stereographic(Calibrated<Stereographic>);
    /// A fisheye: distances from the middle are sines of angles.
    "orthographic_fisheye" => OrthographicFisheye(Calibrated<OrthographicFisheye>);
}

impl Lens {
    /// A lens by the name of its projection, and numbers by their names; those that are left out
    /// are what they are by default.
    ///
    /// ```
    /// use firsthit::{Lens, Projection};
    ///
    /// let numbers = [("fx", 400.0), ("fy", 400.0), ("cx", 320.0), ("cy", 240.0), ("k1", -0.02)];
    /// let lens = Lens::named(Projection::OpenCvFisheye, &numbers)?;
    /// assert_eq!(lens.parameters()[5], ("k1", -0.02));
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a name that no number of this
    /// projection has. The numbers are checked by [`Camera::new`](super::Camera::new).
    pub fn named(projection: Projection, parameters: &[(&str, f64)]) -> Result<Self> {
        let mut lens = projection.lens();
        parameters::set(lens.parameters_mut(), parameters)?;
        Ok(lens)
    }

    /// A fisheye whose field of view, as a circle around the middle of the picture, touches its
    /// longer edges; or a panorama of that many degrees across.
    ///
    /// ```
    /// use firsthit::{Lens, Projection};
    ///
    /// let lens = Lens::with_fov(Projection::Equidistant, 180.0, 480, 640)?;
    /// // 240 rows are a right angle.
    /// assert!((lens.parameters()[0].1 - 480.0 / std::f64::consts::PI).abs() < 1e-12);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a projection that has no such angle,
    /// and an angle that it does not reach.
    pub fn with_fov(projection: Projection, fov: f64, rows: usize, columns: usize) -> Result<Self> {
        let size = [rows, columns];
        Ok(match projection {
            Projection::Perspective => {
                Self::Flat(Viewplane::with_fov(fov, FovAxis::Vertical, rows, columns)?)
            }
            Projection::Equidistant => Self::Equidistant(within(Equidistant { fov }, size)?),
            Projection::Equisolid => Self::Equisolid(within(Equisolid { fov }, size)?),
            Projection::Stereographic => Self::Stereographic(within(Stereographic { fov }, size)?),
            Projection::OrthographicFisheye => {
                Self::OrthographicFisheye(within(OrthographicFisheye { fov }, size)?)
            }
            Projection::OpenCvFisheye => {
                let without_distortion = OpenCvFisheye { fov, ..OpenCvFisheye::default() };
                Self::OpenCvFisheye(within(without_distortion, size)?)
            }
            Projection::Equirectangular | Projection::Cylindrical => {
                Self::named(projection, &[("horizontal_fov", fov)])?
            }
            _ => {
                let expected = "left out: the projection's angle follows from its parameters";
                return Err(Error::argument("fov", expected, projection.name()));
            }
        })
    }

    /// Refuses numbers that make no lens, and computes what depends on them and the picture's size
    /// alone.
    pub(super) fn prepare(&mut self, size: [usize; 2]) -> Result<()> {
        parameters::check(self.parameters_mut())?;
        self.model_mut().prepare(size)
    }

    /// Whether it is a panorama, of the whole sphere or of a part of it. Cameras with one stand in
    /// the middle of a scene.
    pub fn is_panorama(&self) -> bool {
        self.projection().is_panorama()
    }

    /// The parameters by their names.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        let mut lens = *self;
        parameters::values(lens.parameters_mut())
    }

    /// The viewplane, if the lens has one.
    pub fn viewplane(&self) -> Option<&Viewplane> {
        match self {
            Self::Flat(viewplane) => Some(viewplane),
            _ => None,
        }
    }
}

impl Default for Lens {
    /// A perspective one, at a size of 4/3 by 1 and at distance one.
    fn default() -> Self {
        Self::Flat(Viewplane::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, View};

    /// A sample of the projection's own parameters.
    fn distortion(projection: Projection) -> &'static [(&'static str, f64)] {
        match projection {
            Projection::OpenCv => {
                &[("k1", -0.3), ("k2", 0.05), ("k5", 0.01), ("p1", 0.002), ("s1", 0.001)]
            }
            Projection::OpenCvFisheye => &[("k1", 0.05), ("k2", -0.03)],
            Projection::KannalaBrandt => &[("k1", 0.9), ("k2", 0.02)],
            Projection::DoubleSphere => &[("xi", -0.2), ("alpha", 0.6)],
            Projection::Eucm => &[("alpha", 0.6), ("beta", 1.1)],
            Projection::Ucm => &[("alpha", 0.6)],
            Projection::Mei => &[("xi", 1.3), ("k1", -0.1), ("p2", 0.01)],
            Projection::Fov => &[("omega", 0.9)],
            Projection::ThinPrismFisheye => &[("k1", -0.05), ("p1", 0.003), ("sx1", 0.004)],
            Projection::RadTanThinPrismFisheye => {
                &[("k0", -0.04), ("k3", 0.002), ("p0", 0.003), ("s0", -0.002), ("s3", 0.001)]
            }
            _ => &[],
        }
    }

    /// Every instruction set makes the rays that one by one are made, to the bit.
    #[test]
    fn directions_of_rows_are_those_one_by_one() {
        let matrix = [("fx", 30.0), ("fy", 29.0), ("cx", 33.3), ("cy", 21.1), ("skew", 0.3)];
        for &projection in Projection::ALL {
            let own = distortion(projection);
            let has_matrix = projection.lens().parameters().iter().any(|(name, _)| *name == "fx");
            let numbers = [if has_matrix { &matrix[..] } else { &[] }, own].concat();
            let view = View {
                aim: DVec3::new(0.3, -0.5, 0.8),
                rows: 48,
                columns: 64,
                lens: Lens::named(projection, &numbers).unwrap(),
                ..View::default()
            };
            let camera = Camera::new(view).unwrap();
            let offset = DVec2::new(0.3, 0.6);
            for set in InstructionSet::available() {
                let (mut seen, mut lanes) = (0, [[0.0; 61]; 3]);
                for row in 0..48 {
                    let [x, y, z] = &mut lanes;
                    let model = camera.lens().model();
                    let from = [row, 3];
                    model.directions(set, &camera.pose, [48, 64], from, offset, [x, y, z]);
                    for k in 0..61 {
                        let own = camera.ray_within(row, 3 + k, offset);
                        assert_eq!(
                            lanes.map(|axis| axis[k].to_bits()),
                            own.direction.to_array().map(f64::to_bits),
                            "{projection:?} {set:?}"
                        );
                        seen += usize::from(own.is_valid());
                    }
                }
                assert!(seen > 700, "{projection:?}: {seen}");
            }
        }
    }
}
