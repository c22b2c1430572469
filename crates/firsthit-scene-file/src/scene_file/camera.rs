//! Cameras of a scene file.

mod read;

use super::settings;
use super::table::{Form, Key, Pick, Record, Rule, Variant, keys, optional, required};
use crate::camera::distortion::{
    DoubleSphere, Equidistant, Equisolid, Eucm, Fov, KannalaBrandt, Mei, OpenCv, OpenCvFisheye,
    OrthographicFisheye, RadTanThinPrismFisheye, Stereographic, ThinPrismFisheye, Ucm,
};
use crate::camera::{
    Convention, CubeMap, Cylindrical, Equirectangular, FovAxis, Octahedral, PixelMatrix, THIN_LENS,
    VIEWPLANE,
};
use crate::geometry::{Domain, Settings};

pub(super) use read::{read, settle};

const PROJECTION: &str = "projection";

const VIEW: &[Key] = keys! {
    /// The camera's position. Default: where everything is seen and fills the picture.
    position: optional(Form::VECTOR),
    /// The direction it looks in, of any length.
    aim: optional(Form::DIRECTION),
    /// The point it looks at, instead of aim. Default: the middle of the scene.
    look_at: optional(Form::VECTOR),
    /// The direction upwards in the picture, of any length; need not be perpendicular to aim.
    /// Default: the scene's up.
    up: optional(Form::DIRECTION),
};

/// The row of a matrix.
const ROW: Form = Form::Array(&Form::NUMBER, 4, 4);

const POSE: &[Key] = keys! {
    /// The camera's pose, instead of position, aim, look_at and up: the rows of the matrix by which
    /// the convention says where the camera is.
    pose: optional(Form::Array(&ROW, 3, 4)),
};

const CONVENTION: &[Key] = keys! {
    /// The convention of pose, cx and cy: which way the camera's axes point, which way the pose
    /// goes, where the first pixel is.
    convention: optional(Form::OneOf(|| Convention::NAMES.to_vec())),
};

const NEEDED_CONVENTION: &[Key] = keys! {
    /// The convention of pose, cx and cy: which way the camera's axes point, which way the pose
    /// goes, where the first pixel is.
    convention: required(Form::OneOf(|| Convention::NAMES.to_vec())),
};

/// The rules for a pose and the keys that it replaces.
macro_rules! view_rules {
    ($($rule:expr),* $(,)?) => {
        &[
            Rule::NotBoth("aim", "look_at"),
            Rule::Needs("pose", "convention"),
            Rule::NotBoth("pose", "position"),
            Rule::NotBoth("pose", "aim"),
            Rule::NotBoth("pose", "up"),
            $($rule),*
        ]
    };
}

const PIXELS: &[Key] = keys! {
    /// Pixels across. Default: 1024.
    columns: optional(Form::Whole(1, MOST_PIXELS)),
    /// Pixels down. Default: 768, or as the viewplane's shape asks; of a panorama half the columns.
    rows: optional(Form::Whole(1, MOST_PIXELS)),
};

const RAY_START: &[Key] = keys! {
    /// The start of rays, and of t: at the position or on the viewplane. Default: eye.
    ray_start: optional(Form::OneOf(|| vec!["eye", "viewplane"])),
};

/// The longest side of a picture, in pixels.
const MOST_PIXELS: i64 = 1 << 28;

const COLUMNS: &[Key] = keys! {
    /// Pixels across.
    columns: required(Form::Whole(1, MOST_PIXELS)),
};

const BOTH_PIXELS: &[Key] = keys! {
    /// Pixels across.
    columns: required(Form::Whole(1, MOST_PIXELS)),
    /// Pixels down.
    rows: required(Form::Whole(1, MOST_PIXELS)),
};

/// The keys of settings, none of which has to be given.
macro_rules! optional_keys {
    ($settings:expr) => {
        const { &settings::optional_keys::<{ $settings.len() }>($settings) }
    };
}

/// The keys of a lens' own settings.
macro_rules! own {
    ($lens:ty) => {
        const { &settings::keys::<{ <$lens>::LIST.len() }>(<$lens>::LIST) }
    };
}

/// The intrinsic matrix' keys.
const MATRIX: &[Key] = own!(PixelMatrix);
/// The intrinsic matrix in place of `fov`, or of `focal_length`, `width` and `height`.
const PINHOLE: &[Key] = optional_keys!(PixelMatrix::LIST.split_at(4).0);

const SKEW: &[Key] = keys! {
    /// The matrix' second number in the first row; of a viewplane how far columns lean to the right
    /// for each unit upwards.
    skew: optional(Form::NUMBER),
};

/// A calibrated lens; with rules it may have an aperture.
macro_rules! calibrated {
    ($common:tt $name:literal, $lens:ty) => {
        calibrated!(@ $common $name, [own!($lens)], [])
    };
    ($common:tt $name:literal, $lens:ty; $($rule:expr),*) => {
        calibrated!(@ $common $name, [own!($lens), APERTURE, FOCUS], [
            Rule::Needs("focus", "aperture"),
            Rule::Needs("aperture", "focus")
            $(, $rule)*
        ])
    };
    (@ [[$($key:expr),*] $($of_view:expr),*] $name:literal, [$($own:expr),*], [$($rule:expr),*]) => {
        Variant {
            pick: Pick::Tag(PROJECTION, $name),
            keys: &[VIEW, POSE, NEEDED_CONVENTION, $($key,)* MATRIX, $($own),*],
            rules: view_rules![$($of_view,)* $($rule),*],
        }
    };
}

/// A lens that an angle or nothing is enough for.
macro_rules! uncalibrated {
    ([[$($key:expr),*] $($of_view:expr),*] $name:literal, $lens:ty) => {
        Variant {
            pick: Pick::Tag(PROJECTION, $name),
            keys: &[VIEW, POSE, CONVENTION, $($key,)* optional_keys!(<$lens>::LIST)],
            rules: view_rules![$($of_view),*],
        }
    };
}

const FOV: &[Key] = keys! {
    /// Degrees along fov_axis, with square pixels; instead of focal_length, width and height.
    /// Default: 45.
    fov: optional(Form::Of(Domain::Between(0.0, 180.0))),
    /// From the picture's lower to its upper edge, from the left to the right one, or from corner
    /// to corner. Default: "vertical".
    fov_axis: optional(Form::OneOf(|| FovAxis::NAMES.to_vec())),
};

const LENGTHS: &[Key] = optional_keys!(VIEWPLANE.split_at(3).0);
const SHIFT: &[Key] = optional_keys!(VIEWPLANE.split_at(3).1.split_at(2).0);
const TILT: &[Key] = optional_keys!(VIEWPLANE.split_at(5).1.split_at(2).0);
const APERTURE: &[Key] = optional_keys!(THIN_LENS.split_at(1).0);

const FOCUS: &[Key] = keys! {
    /// The plane in focus: the distance along the aim, or a point at that distance.
    focus: optional(Form::Either(&Form::POSITIVE, &Form::VECTOR)),
};

/// The cameras of a record: keys and rules of those that see all around, of those with a matrix in
/// pixels and of fisheyes; keys of pixels, and rules of perspective ones; further keys and rules of
/// orthographic ones.
macro_rules! cameras {
    ($open:tt, $sized:tt, $fisheye:tt, $pixels:expr, [$($flat:expr),*], [$($parallel:expr),*], [$($rule:expr),*]) => {
        &[
            Variant {
                pick: Pick::Default(PROJECTION, "perspective"),
                keys: &[
                    VIEW, POSE, CONVENTION, RAY_START, $pixels, FOV, LENGTHS, PINHOLE, SKEW, SHIFT,
                    TILT, APERTURE, FOCUS,
                ],
                rules: view_rules![
                    $($flat,)*
                    Rule::NotBoth("fov", "focal_length"),
                    Rule::NotBoth("fov", "width"),
                    Rule::NotBoth("fov", "height"),
                    Rule::NotBoth("fov", "fx"),
                    Rule::Needs("fov_axis", "fov"),
                    Rule::NotBoth("focal_length", "fx"),
                    Rule::Needs("focal_length", "width"),
                    Rule::Needs("width", "height"),
                    Rule::Needs("height", "focal_length"),
                    Rule::Needs("fx", "fy"),
                    Rule::Needs("fy", "cx"),
                    Rule::Needs("cx", "cy"),
                    Rule::Needs("cy", "fx"),
                    Rule::Needs("fx", "convention"),
                    Rule::NotBoth("fx", "shift_x"),
                    Rule::NotBoth("fx", "shift_y"),
                    Rule::NotBoth("fx", "tilt_x"),
                    Rule::NotBoth("fx", "tilt_y"),
                    Rule::Needs("focus", "aperture"),
                    Rule::Needs("aperture", "focus"),
                    Rule::NotBoth("aperture", "tilt_x"),
                    Rule::NotBoth("aperture", "tilt_y"),
                ],
            },
            Variant {
                pick: Pick::Tag(PROJECTION, "orthographic"),
                keys: &[VIEW, POSE, CONVENTION, RAY_START, $pixels, LENGTHS, SHIFT, $($parallel),*],
                rules: view_rules![
                    $($rule,)*
                    Rule::Needs("focal_length", "width"),
                    Rule::Needs("width", "height"),
                    Rule::Needs("height", "width"),
                ],
            },
            uncalibrated!($open "equirectangular", Equirectangular),
            uncalibrated!($open "cylindrical", Cylindrical),
            uncalibrated!($open "cube_map", CubeMap),
            uncalibrated!($open "octahedral", Octahedral),
            calibrated!($sized "opencv", OpenCv;
                Rule::NotBoth("aperture", "tau_x"),
                Rule::NotBoth("aperture", "tau_y")
            ),
            calibrated!($sized "opencv_fisheye", OpenCvFisheye),
            calibrated!($sized "kannala_brandt", KannalaBrandt),
            calibrated!($sized "double_sphere", DoubleSphere),
            calibrated!($sized "eucm", Eucm),
            calibrated!($sized "ucm", Ucm),
            calibrated!($sized "mei", Mei),
            calibrated!($sized "fov", Fov;),
            calibrated!($sized "thin_prism_fisheye", ThinPrismFisheye),
            calibrated!($sized "rad_tan_thin_prism_fisheye", RadTanThinPrismFisheye),
            uncalibrated!($fisheye "equidistant", Equidistant),
            uncalibrated!($fisheye "equisolid", Equisolid),
            uncalibrated!($fisheye "stereographic", Stereographic),
            uncalibrated!($fisheye "orthographic_fisheye", OrthographicFisheye),
        ]
    };
}

/// Without a place the scene fills the picture.
const LOOK: Rule = Rule::Needs("look_at", "position");

pub(super) static CAMERA: Record = Record {
    name: "camera",
    about: "A camera.",
    variants: cameras!(
        [[PIXELS] LOOK],
        [[BOTH_PIXELS] LOOK],
        [[PIXELS] LOOK],
        PIXELS,
        [
            LOOK,
            Rule::Needs("fx", "columns"),
            Rule::Needs("fx", "rows"),
            Rule::Needs("shift_x", "width"),
            Rule::Needs("shift_y", "width"),
            Rule::Needs("tilt_x", "width"),
            Rule::Needs("tilt_y", "width")
        ],
        [],
        [LOOK, Rule::Needs("shift_x", "width"), Rule::Needs("shift_y", "width")]
    ),
};

/// The cameras of a plan. Their rig has a place for them, and any of them may say where its rays
/// start.
macro_rules! rig_cameras {
    ($pixels:expr) => {
        cameras!(
            [[$pixels, RAY_START]],
            [[$pixels, RAY_START]],
            [[$pixels, RAY_START, PINHOLE, SKEW]],
            $pixels,
            [],
            [FOV, SKEW, TILT],
            [Rule::NotBoth("fov", "width"), Rule::Needs("fov_axis", "fov")]
        )
    };
}

pub(super) static RIG_CAMERA: Record =
    Record { name: "rig_camera", about: "A camera on a rig.", variants: rig_cameras!(BOTH_PIXELS) };

pub(super) static LINE_CAMERA: Record = Record {
    name: "line_camera",
    about: "A camera of one row on a rig.",
    variants: rig_cameras!(COLUMNS),
};
