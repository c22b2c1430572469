//! Cameras of a scene file.

use std::f64::consts::{FRAC_PI_2, PI};

use super::form::matrix;
use super::section::Section;
use super::table::{Form, Key, Pick, Record, Rule, Variant, keys, optional, required};
use crate::camera::{
    Aim, Convention, Description, Focus, Lens, Opening, PixelMatrix, Projection, RayStart,
    Viewplane, orthonormalised, rounded_pose,
};
use crate::geometry::{Bounds, DVec3};
use crate::io::Report;
use crate::io::fault::Checked;
use crate::world::{NamedCamera, World};

const PROJECTION: &str = "projection";

const VIEW: &[Key] = keys! {
    /// The camera's position. Default: where everything is seen and fills the picture.
    position: optional(Form::Vector),
    /// The direction it looks in, of any length.
    aim: optional(Form::Direction),
    /// The point it looks at, instead of aim. Default: the middle of the scene.
    look_at: optional(Form::Vector),
    /// The direction upwards in the picture, of any length; need not be perpendicular to aim.
    /// Default: the scene's up.
    up: optional(Form::Direction),
};

const POSE: &[Key] = keys! {
    /// The camera's pose, instead of position, aim, look_at and up: the rows of the matrix by which
    /// the convention says where the camera is.
    pose: optional(Form::Matrix),
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
            Rule::Needs("look_at", "position"),
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

const BOTH_PIXELS: &[Key] = keys! {
    /// Pixels across.
    columns: required(Form::Whole(1, MOST_PIXELS)),
    /// Pixels down.
    rows: required(Form::Whole(1, MOST_PIXELS)),
};

const PINHOLE: &[Key] = keys! {
    /// The focal length in columns: the intrinsic matrix, instead of fov, or of focal_length, width and height.
    fx: optional(Form::Positive),
    /// The focal length in rows.
    fy: optional(Form::Positive),
    /// The principal point's column, as the convention counts them.
    cx: optional(Form::Number),
    /// The principal point's row.
    cy: optional(Form::Number),
    /// The matrix' second number in the first row; of a viewplane how far columns lean to the right for each unit upwards.
    skew: optional(Form::Number),
};

const MATRIX: &[Key] = keys! {
    /// The focal length in columns.
    fx: required(Form::Positive),
    /// The focal length in rows.
    fy: required(Form::Positive),
    /// The principal point's column, as the convention counts them.
    cx: required(Form::Number),
    /// The principal point's row.
    cy: required(Form::Number),
    /// The matrix' second number in the first row. Default: 0.
    skew: optional(Form::Number),
};

const SHIFT: &[Key] = keys! {
    /// The distance from where the aim meets the viewplane to its middle, to the right. Default: 0.
    shift_x: optional(Form::Number),
    /// The distance from there to the middle upwards. Default: 0.
    shift_y: optional(Form::Number),
};

const TILT: &[Key] = keys! {
    /// Degrees by which the viewplane is turned about its vertical, its right edge nearer. Default: 0.
    tilt_x: optional(Form::Between(-90.0, 90.0)),
    /// Degrees by which it is turned about its horizontal, its upper edge nearer. Default: 0.
    tilt_y: optional(Form::Between(-90.0, 90.0)),
};

/// The fields of view of a panorama, the vertical one in this form.
macro_rules! panorama {
    ($form:expr) => {
        keys! {
            /// Degrees from the left edge to the right one. Default: 360.
            horizontal_fov: optional(Form::UpTo(360.0)),
            /// Degrees from the lower edge to the upper one. Default: 180, of a cylinder 90.
            vertical_fov: optional($form),
        }
    };
}

/// The field of view of a fisheye in this form.
macro_rules! fisheye {
    ($form:expr) => {
        keys! {
            /// Degrees of the circle that touches the picture's longer edges; beyond it nothing is seen. Default: 180.
            fov: optional($form),
        }
    };
}

const EQUIRECTANGULAR: &[Key] = panorama!(Form::UpTo(180.0));
const CYLINDRICAL: &[Key] = panorama!(Form::Between(0.0, 180.0));
const WHOLE_SPHERE: &[Key] = fisheye!(Form::UpTo(360.0));
const NEARLY_WHOLE_SPHERE: &[Key] = fisheye!(Form::Between(0.0, 360.0));
const HALF_SPHERE: &[Key] = fisheye!(Form::UpTo(180.0));

const OPENCV: &[Key] = keys! {
    /// Radial distortion.
    k1: optional(Form::Number),
    /// Radial distortion.
    k2: optional(Form::Number),
    /// Radial distortion.
    k3: optional(Form::Number),
    /// Radial distortion, in the divisor.
    k4: optional(Form::Number),
    /// Radial distortion, in the divisor.
    k5: optional(Form::Number),
    /// Radial distortion, in the divisor.
    k6: optional(Form::Number),
    /// Tangential distortion.
    p1: optional(Form::Number),
    /// Tangential distortion.
    p2: optional(Form::Number),
    /// Thin prism distortion.
    s1: optional(Form::Number),
    /// Thin prism distortion.
    s2: optional(Form::Number),
    /// Thin prism distortion.
    s3: optional(Form::Number),
    /// Thin prism distortion.
    s4: optional(Form::Number),
    /// The sensor's tilt about x, in radians.
    tau_x: optional(Form::Between(-FRAC_PI_2, FRAC_PI_2)),
    /// The sensor's tilt about y, in radians.
    tau_y: optional(Form::Between(-FRAC_PI_2, FRAC_PI_2)),
};

const ANGLE_POLYNOMIAL: &[Key] = keys! {
    /// A coefficient of the polynomial in the angle to the axis.
    k1: optional(Form::Number),
    /// The next.
    k2: optional(Form::Number),
    /// The next.
    k3: optional(Form::Number),
    /// The next.
    k4: optional(Form::Number),
    /// Degrees across the circle beyond which nothing is seen. Default: 360.
    fov: optional(Form::UpTo(360.0)),
};

const KANNALA_BRANDT: &[Key] = keys! {
    /// The slope of the radius on the axis. Default: 1.
    k1: optional(Form::Positive),
    /// A coefficient of the polynomial in the angle to the axis.
    k2: optional(Form::Number),
    /// The next.
    k3: optional(Form::Number),
    /// The next.
    k4: optional(Form::Number),
    /// The last.
    k5: optional(Form::Number),
};

const ALPHA: &[Key] = keys! {
    /// The weight from 0, a pinhole, to 1.
    alpha: optional(Form::From(0.0, 1.0)),
};

const BETA: &[Key] = keys! {
    /// Positive. Default: 1.
    beta: optional(Form::Positive),
};

/// The parameter xi in this form.
macro_rules! xi {
    ($form:expr) => {
        keys! {
            /// The distance between the spheres' centres, or of the point of view behind the sphere's. Default: 0.
            xi: optional($form),
        }
    };
}

const XI: &[Key] = xi!(Form::Above(-1.0));
const MEI_XI: &[Key] = xi!(Form::NonNegative);

const MEI: &[Key] = keys! {
    /// Radial distortion.
    k1: optional(Form::Number),
    /// Radial distortion.
    k2: optional(Form::Number),
    /// Tangential distortion.
    p1: optional(Form::Number),
    /// Tangential distortion.
    p2: optional(Form::Number),
};

const OMEGA: &[Key] = keys! {
    /// The field of view of an ideal fisheye, in radians. Default: 0, a pinhole.
    omega: optional(Form::Between(-PI, PI)),
};

const THIN_PRISM: &[Key] = keys! {
    /// Radial distortion, of the square of the angle to the axis.
    k1: optional(Form::Number),
    /// Radial distortion, of its fourth power.
    k2: optional(Form::Number),
    /// Tangential distortion.
    p1: optional(Form::Number),
    /// Tangential distortion.
    p2: optional(Form::Number),
    /// Radial distortion, of the sixth power.
    k3: optional(Form::Number),
    /// Radial distortion, of the eighth power.
    k4: optional(Form::Number),
    /// Thin prism distortion, across.
    sx1: optional(Form::Number),
    /// Thin prism distortion, down.
    sy1: optional(Form::Number),
};

const RAD_TAN_THIN_PRISM: &[Key] = keys! {
    /// A coefficient of the polynomial in the angle to the axis.
    k0: optional(Form::Number),
    /// The next.
    k1: optional(Form::Number),
    /// The next.
    k2: optional(Form::Number),
    /// The next.
    k3: optional(Form::Number),
    /// The next.
    k4: optional(Form::Number),
    /// The last.
    k5: optional(Form::Number),
    /// Tangential distortion.
    p0: optional(Form::Number),
    /// Tangential distortion.
    p1: optional(Form::Number),
    /// Thin prism distortion, across.
    s0: optional(Form::Number),
    /// Thin prism distortion, across.
    s1: optional(Form::Number),
    /// Thin prism distortion, down.
    s2: optional(Form::Number),
    /// Thin prism distortion, down.
    s3: optional(Form::Number),
};

/// A calibrated lens with its own keys and its own rules.
macro_rules! calibrated {
    ($name:literal, $($own:expr),*) => {
        calibrated!($name, $($own),*;)
    };
    ($name:literal, $($own:expr),*; $($rule:expr),*) => {
        Variant {
            pick: Pick::Tag(PROJECTION, $name),
            keys: &[VIEW, POSE, NEEDED_CONVENTION, BOTH_PIXELS, MATRIX, $($own),*],
            rules: view_rules![$($rule),*],
        }
    };
}

/// A lens that an angle or nothing is enough for.
macro_rules! uncalibrated {
    ($name:literal, $($own:expr),*) => {
        Variant {
            pick: Pick::Tag(PROJECTION, $name),
            keys: &[VIEW, POSE, CONVENTION, PIXELS, $($own),*],
            rules: view_rules![],
        }
    };
}

const FOV: &[Key] = keys! {
    /// Degrees from the picture's lower to its upper edge, with square pixels; instead of focal_length, width and height.
    /// Default: 45.
    fov: optional(Form::Between(0.0, 180.0)),
};

const VIEWPLANE: &[Key] = keys! {
    /// The distance from the camera to the viewplane.
    focal_length: optional(Form::Positive),
    /// The viewplane's width.
    width: optional(Form::Positive),
    /// The viewplane's height.
    height: optional(Form::Positive),
};

const THIN_LENS: &[Key] = keys! {
    /// The diameter of the lens: colours of several samples are sharp at focus, and blurred nearer and farther. Default: 0, a pinhole.
    aperture: optional(Form::NonNegative),
    /// The plane in focus: the distance along the aim, or a point at that distance.
    focus: optional(Form::Focus),
};

pub(super) static CAMERA: Record = Record {
    name: "camera",
    about: "A camera.",
    variants: &[
        Variant {
            pick: Pick::Default(PROJECTION, "perspective"),
            keys: &[
                VIEW, POSE, CONVENTION, RAY_START, PIXELS, FOV, VIEWPLANE, PINHOLE, SHIFT, TILT,
                THIN_LENS,
            ],
            rules: view_rules![
                Rule::NotBoth("fov", "focal_length"),
                Rule::NotBoth("fov", "width"),
                Rule::NotBoth("fov", "height"),
                Rule::NotBoth("fov", "fx"),
                Rule::NotBoth("focal_length", "fx"),
                Rule::Needs("focal_length", "width"),
                Rule::Needs("width", "height"),
                Rule::Needs("height", "focal_length"),
                Rule::Needs("fx", "fy"),
                Rule::Needs("fy", "cx"),
                Rule::Needs("cx", "cy"),
                Rule::Needs("cy", "fx"),
                Rule::Needs("fx", "convention"),
                Rule::Needs("fx", "columns"),
                Rule::Needs("fx", "rows"),
                Rule::NotBoth("fx", "shift_x"),
                Rule::NotBoth("fx", "shift_y"),
                Rule::NotBoth("fx", "tilt_x"),
                Rule::NotBoth("fx", "tilt_y"),
                Rule::Needs("shift_x", "width"),
                Rule::Needs("shift_y", "width"),
                Rule::Needs("tilt_x", "width"),
                Rule::Needs("tilt_y", "width"),
                Rule::Needs("focus", "aperture"),
                Rule::Needs("aperture", "focus"),
                Rule::NotBoth("aperture", "tilt_x"),
                Rule::NotBoth("aperture", "tilt_y"),
            ],
        },
        Variant {
            pick: Pick::Tag(PROJECTION, "orthographic"),
            keys: &[VIEW, POSE, CONVENTION, RAY_START, PIXELS, VIEWPLANE, SHIFT],
            rules: view_rules![
                Rule::Needs("focal_length", "width"),
                Rule::Needs("width", "height"),
                Rule::Needs("height", "width"),
                Rule::Needs("shift_x", "width"),
                Rule::Needs("shift_y", "width"),
            ],
        },
        uncalibrated!("equirectangular", EQUIRECTANGULAR),
        uncalibrated!("cylindrical", CYLINDRICAL),
        uncalibrated!("cube_map",),
        uncalibrated!("octahedral",),
        calibrated!("opencv", OPENCV, THIN_LENS;
            Rule::Needs("focus", "aperture"),
            Rule::Needs("aperture", "focus"),
            Rule::NotBoth("aperture", "tau_x"),
            Rule::NotBoth("aperture", "tau_y")
        ),
        calibrated!("opencv_fisheye", ANGLE_POLYNOMIAL),
        calibrated!("kannala_brandt", KANNALA_BRANDT),
        calibrated!("double_sphere", XI, ALPHA),
        calibrated!("eucm", ALPHA, BETA),
        calibrated!("ucm", ALPHA),
        calibrated!("mei", MEI_XI, MEI),
        calibrated!("fov", OMEGA, THIN_LENS;
            Rule::Needs("focus", "aperture"),
            Rule::Needs("aperture", "focus")
        ),
        calibrated!("thin_prism_fisheye", THIN_PRISM),
        calibrated!("rad_tan_thin_prism_fisheye", RAD_TAN_THIN_PRISM),
        uncalibrated!("equidistant", WHOLE_SPHERE),
        uncalibrated!("equisolid", WHOLE_SPHERE),
        uncalibrated!("stereographic", NEARLY_WHOLE_SPHERE),
        uncalibrated!("orthographic_fisheye", HALF_SPHERE),
    ],
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
    let has_viewplane = matches!(
        projection,
        Projection::Perspective | Projection::Orthographic
    );
    let ray_start = match section.text("ray_start") {
        Some("viewplane") => Some(RayStart::Viewplane),
        _ => has_viewplane.then_some(RayStart::Eye),
    };
    let described = Description {
        position: section.vector("position"),
        aim: along.or(at),
        up: section.vector("up"),
        opening: opening(section, projection, convention)?,
        projection: Some(projection),
        ray_start,
        aperture: section.number("aperture"),
        focus: (section.number("focus").map(Focus::Distance))
            .or(section.vector("focus").map(Focus::At)),
        columns: section.whole("columns"),
        rows: section.whole("rows"),
    };
    let (Some([x, y, z]), Some(convention)) = (section.raw("pose").and_then(matrix), convention)
    else {
        return Ok(described);
    };
    let mut pose = [x, y, z, [0.0, 0.0, 0.0, 1.0]];
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
#[expect(clippy::too_many_lines, reason = "a step for each way to say it")]
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
        let lens = if projection == Projection::Perspective {
            section.checked(Viewplane::from_pixel_matrix(&matrix, rows, columns).map(Lens::Flat))?
        } else {
            let known = section
                .checked(Lens::named(projection, &[]))?
                .parameters()
                .into_iter();
            let numbers = known.filter_map(|(name, _)| Some((name, section.number(name)?)));
            let mut numbers: Vec<(&str, f64)> = numbers.collect();
            numbers.extend([("cx", matrix.cx), ("cy", matrix.cy)]);
            numbers.extend(section.number("fov").map(|fov| ("fov", fov)));
            section.checked(Lens::named(projection, &numbers))?
        };
        let size = [rows, columns];
        return Ok(Some(Opening::Lens { lens, size }));
    }
    if let Some(fov) = section.number("fov") {
        return Ok(Some(Opening::Fov(fov)));
    }
    let (width, height) = (section.number("width"), section.number("height"));
    let focal_length = section.number("focal_length");
    let own = [
        "shift_x",
        "shift_y",
        "tilt_x",
        "tilt_y",
        "skew",
        "horizontal_fov",
        "vertical_fov",
    ];
    let own = own
        .into_iter()
        .filter_map(|name| Some((name, section.number(name)?)));
    let own: Vec<(&str, f64)> = own.collect();
    if !own.is_empty() {
        let lengths = [
            ("width", width),
            ("height", height),
            ("focal_length", focal_length),
        ];
        let lengths = lengths
            .into_iter()
            .filter_map(|(name, length)| Some((name, length?)));
        let numbers: Vec<(&str, f64)> = lengths.chain(own).collect();
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
        let (columns, rows) = whole.size();
        let size = [rows, columns];
        return Ok(Some(Opening::Lens { lens, size }));
    }
    Ok(width.zip(height).map(|(width, height)| Opening::Viewplane {
        width,
        height,
        focal_length,
    }))
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
