//! Cameras of a scene file.

use super::section::Section;
use super::table::{Form, Key, Pick, Record, Rule, Variant, keys, optional};
use crate::camera::{Aim, Description, Opening, Projection, RayStart};
use crate::geometry::Bounds;
use crate::io::fault::Checked;
use crate::world::{NamedCamera, World};

const PROJECTION: &str = "projection";

const VIEW: &[Key] = keys! {
    /// Where the camera is. Default: where everything is seen and fills the picture.
    position: optional(Form::Vector),
    /// The direction it looks in, of any length.
    aim: optional(Form::Direction),
    /// The point it looks at, instead of aim. Default: the middle of the scene.
    look_at: optional(Form::Vector),
    /// Which way is up in the picture, of any length; need not be perpendicular to aim. Default: the scene's up.
    up: optional(Form::Direction),
};

const PIXELS: &[Key] = keys! {
    /// Pixels across. Default: 1024.
    columns: optional(Form::Whole(1, MOST_PIXELS)),
    /// Pixels down. Default: 768, or as the viewplane's shape asks; of a panorama half the columns.
    rows: optional(Form::Whole(1, MOST_PIXELS)),
};

const RAY_START: &[Key] = keys! {
    /// Where rays start, and t counts from: at the position or on the viewplane. Default: eye.
    ray_start: optional(Form::OneOf(|| vec!["eye", "viewplane"])),
};

/// Neither side of a picture is longer.
const MOST_PIXELS: i64 = 1 << 28;

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

pub(super) static CAMERA: Record = Record {
    name: "camera",
    about: "A camera.",
    variants: &[
        Variant {
            pick: Pick::Default(PROJECTION, "perspective"),
            keys: &[VIEW, RAY_START, PIXELS, FOV, VIEWPLANE],
            rules: &[
                Rule::NotBoth("aim", "look_at"),
                Rule::NotBoth("fov", "focal_length"),
                Rule::NotBoth("fov", "width"),
                Rule::NotBoth("fov", "height"),
                Rule::Needs("focal_length", "width"),
                Rule::Needs("width", "height"),
                Rule::Needs("height", "focal_length"),
                Rule::Needs("look_at", "position"),
            ],
        },
        Variant {
            pick: Pick::Tag(PROJECTION, "orthographic"),
            keys: &[VIEW, RAY_START, PIXELS, VIEWPLANE],
            rules: &[
                Rule::NotBoth("aim", "look_at"),
                Rule::Needs("focal_length", "width"),
                Rule::Needs("width", "height"),
                Rule::Needs("height", "width"),
                Rule::Needs("look_at", "position"),
            ],
        },
        Variant {
            pick: Pick::Tag(PROJECTION, "equirectangular"),
            keys: &[VIEW, PIXELS],
            rules: &[
                Rule::NotBoth("aim", "look_at"),
                Rule::Needs("look_at", "position"),
            ],
        },
    ],
};

/// A camera with its name and the table that it stands in.
pub(super) struct Read<'v, 't> {
    name: String,
    section: Section<'v, 't>,
    description: Description,
}

/// The file's cameras, the one without a name first.
pub(super) fn read<'v, 't>(scene: &Section<'v, 't>) -> Checked<Vec<Read<'v, 't>>> {
    let unnamed = scene.table("camera", &CAMERA)?;
    let unnamed = unnamed.into_iter().map(|section| ("camera", section));
    let named = scene.named("cameras", &CAMERA)?;
    let cameras = unnamed.chain(named).map(|(name, section)| {
        Ok(Read {
            name: name.to_owned(),
            section,
            description: description(&section)?,
        })
    });
    cameras.collect()
}

fn description(section: &Section<'_, '_>) -> Checked<Description> {
    let projection: Projection = section.checked(section.tag().unwrap_or_default().parse())?;
    let along = section.vector("aim").map(Aim::Along);
    let at = section.vector("look_at").map(Aim::At);
    let fov = section.number("fov").map(Opening::Fov);
    let viewplane = || {
        Some(Opening::Viewplane {
            width: section.number("width")?,
            height: section.number("height")?,
            focal_length: section.number("focal_length"),
        })
    };
    let has_viewplane = projection != Projection::Equirectangular;
    let ray_start = match section.text("ray_start") {
        Some("viewplane") => Some(RayStart::Viewplane),
        _ => has_viewplane.then_some(RayStart::Eye),
    };
    Ok(Description {
        position: section.vector("position"),
        aim: along.or(at),
        up: section.vector("up"),
        opening: fov.or_else(viewplane),
        projection: Some(projection),
        ray_start,
        columns: section.whole("columns"),
        rows: section.whole("rows"),
    })
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
            has_size: is_sized || matches!(description.opening, Some(Opening::Viewplane { .. })),
            description: Some(description),
        })
    };
    cameras.into_iter().map(settle).collect()
}
