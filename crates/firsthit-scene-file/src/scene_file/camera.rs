//! Cameras of a scene file.

use super::document::numbers as numbers_of;
use super::section::Section;
use super::settings;
use super::table::{Form, Key, Pick, Record, Rule, Variant, keys, optional, required};
use crate::camera::distortion::{
    DoubleSphere, Equidistant, Equisolid, Eucm, Fov, KannalaBrandt, Mei, OpenCv, OpenCvFisheye,
    OrthographicFisheye, RadTanThinPrismFisheye, Stereographic, ThinPrismFisheye, Ucm,
};
use crate::camera::{
    Aim, Convention, CubeMap, Cylindrical, Description, Equirectangular, Focus, FovAxis, Lens,
    Octahedral, Opening, PixelMatrix, Projection, RayStart, THIN_LENS, VIEWPLANE, orthonormalised,
    rounded_pose,
};
use crate::geometry::{Bounds, DVec3, Domain, Settings};
use crate::io::Report;
use crate::io::fault::Checked;
use crate::world::{NamedCamera, World};

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
    /// The matrix' second number in the first row; of a viewplane how far columns lean to the right for each unit upwards.
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
    /// Degrees along fov_axis, with square pixels; instead of focal_length, width and height. Default: 45.
    fov: optional(Form::Of(Domain::Between(0.0, 180.0))),
    /// From the picture's lower to its upper edge, from the left to the right one, or from corner to corner. Default: "vertical".
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
            [
                Rule::NotBoth("fov", "width"),
                Rule::Needs("fov_axis", "fov")
            ]
        )
    };
}

pub(super) static RIG_CAMERA: Record = Record {
    name: "rig_camera",
    about: "A camera on a rig.",
    variants: rig_cameras!(BOTH_PIXELS),
};

pub(super) static LINE_CAMERA: Record = Record {
    name: "line_camera",
    about: "A camera of one row on a rig.",
    variants: rig_cameras!(COLUMNS),
};

/// A camera with its name and the table that it stands in.
pub(super) struct Read<'v, 't> {
    name: String,
    section: Section<'v, 't>,
    description: Description,
}

/// The file's cameras, the one without a name first.
pub(super) fn read<'v, 't>(
    scene: &Section<'v, 't>,
    report: &mut Report,
) -> Checked<Vec<Read<'v, 't>>> {
    let unnamed = scene.table("camera", &CAMERA)?;
    let unnamed = unnamed.into_iter().map(|section| ("camera", section));
    let named = scene.named("cameras", &CAMERA)?;
    let cameras = unnamed.chain(named).map(|(name, section)| {
        Ok(Read {
            name: name.to_owned(),
            section,
            description: description(&section, report)?,
        })
    });
    cameras.collect()
}

fn description(section: &Section<'_, '_>, report: &mut Report) -> Checked<Description> {
    let projection: Projection = section.checked(section.tag().unwrap_or_default().parse())?;
    let along = section.vector("aim").map(Aim::Along);
    let at = section.vector("look_at").map(Aim::At);
    let convention = section.text("convention").map(str::parse).transpose();
    let convention: Option<Convention> = section.checked(convention)?;
    let ray_start = match section.text("ray_start") {
        Some("viewplane") => Some(RayStart::Viewplane),
        _ => projection.has_viewplane().then_some(RayStart::Eye),
    };
    let described = Description {
        position: section.vector("position"),
        aim: along.or(at),
        up: section.vector("up"),
        opening: opening(section, projection, convention)?,
        fov_axis: section.checked(section.text("fov_axis").map(str::parse).transpose())?,
        projection: Some(projection),
        ray_start,
        aperture: section.number("aperture"),
        focus: (section.number("focus").map(Focus::Distance))
            .or(section.vector("focus").map(Focus::At)),
        columns: section.whole("columns"),
        rows: section.whole("rows"),
    };
    let rows: Vec<_> = section.items("pose").filter_map(numbers_of::<4>).collect();
    let (&[x, y, z, ref last @ ..], Some(convention)) = (&*rows, convention) else {
        return Ok(described);
    };
    let mut pose = [x, y, z, *last.first().unwrap_or(&[0.0, 0.0, 0.0, 1.0])];
    if let Some((turned, off)) = orthonormalised(pose) {
        report.warn("rounded pose", &section.place("pose"), || rounded_pose(off));
        pose = turned;
    }
    let pose = section.checked(convention.pose(pose))?;
    Ok(Description {
        position: Some(pose.translation),
        aim: Some(Aim::Along(DVec3::ZERO - pose.matrix3.z_axis)),
        up: Some(pose.matrix3.y_axis),
        ..described
    })
}

/// The field of view of a camera.
fn opening(
    section: &Section<'_, '_>,
    projection: Projection,
    convention: Option<Convention>,
) -> Checked<Option<Opening>> {
    let size = [section.whole("rows"), section.whole("columns")];
    let given = |name: &str| section.number(name).unwrap_or(0.0);
    let matrix = PixelMatrix {
        fx: given("fx"),
        fy: given("fy"),
        cx: given("cx"),
        cy: given("cy"),
        skew: given("skew"),
    };
    if let (true, Some(convention), [Some(rows), Some(columns)]) =
        (section.has("fx"), convention, size)
    {
        let matrix = convention.pixel_matrix(matrix);
        let size = [rows, columns];
        let mut others = numbers(section, projection);
        others.retain(|(name, _)| !["fx", "fy", "cx", "cy", "skew"].contains(name));
        let lens = section.checked(matrix.lens(projection, &others, size))?;
        return Ok(Some(Opening::Lens { lens, size }));
    }
    if let Some(fov) = section.number("fov") {
        return Ok(Some(Opening::Fov(fov)));
    }
    let (width, height) = (section.number("width"), section.number("height"));
    let focal_length = section.number("focal_length");
    let lengths = ["focal_length", "width", "height"];
    let numbers = numbers(section, projection);
    if numbers.iter().any(|(name, _)| !lengths.contains(name)) {
        let lens = section.checked(Lens::named(projection, &numbers))?;
        let whole = Description {
            opening: width.zip(height).map(|(width, height)| Opening::Viewplane {
                width,
                height,
                focal_length,
            }),
            projection: Some(projection),
            columns: size[1],
            rows: size[0],
            ..Description::default()
        };
        let size = whole.size();
        return Ok(Some(Opening::Lens { lens, size }));
    }
    Ok(width.zip(height).map(|(width, height)| Opening::Viewplane {
        width,
        height,
        focal_length,
    }))
}

/// The numbers of a lens that its table gives, without those of a thin one.
fn numbers(section: &Section<'_, '_>, projection: Projection) -> Vec<(&'static str, f64)> {
    let all = projection
        .settings()
        .into_iter()
        .map(|setting| setting.name);
    let all = all.filter(|name| !matches!(*name, "aperture" | "focus"));
    all.filter_map(|name| Some((name, section.number(name)?)))
        .collect()
}

/// The cameras with what they leave open decided by the objects.
pub(super) fn settle(cameras: Vec<Read<'_, '_>>, world: &World) -> Checked<Vec<NamedCamera>> {
    if cameras.is_empty() {
        return Ok(Vec::new());
    }
    let bounds = world.objects.iter().map(crate::scene::Object::bounds);
    let finite = bounds.filter(Bounds::is_finite);
    let bounds = finite.fold(Bounds::EMPTY, Bounds::union);
    let settle = |camera: Read<'_, '_>| {
        let (section, description) = (camera.section, camera.description);
        let support = |direction| crate::scene::support(&world.objects, direction);
        let settled = section.checked(description.camera(bounds, support, world.up))?;
        let is_sized = description.columns.is_some() || description.rows.is_some();
        Ok(NamedCamera {
            name: camera.name,
            own_name: String::new(),
            view: *settled.view(),
            has_size: is_sized
                || matches!(
                    description.opening,
                    Some(Opening::Viewplane { .. } | Opening::Lens { .. })
                ),
            description: Some(description),
        })
    };
    cameras.into_iter().map(settle).collect()
}
