//! Makes a camera of the command line's words.

mod files;
mod lens;

use std::path::Path;

use firsthit::camera::{Aim, Convention, Description, Opening, StandardView};
use firsthit::error::escaped;
use firsthit::world::World;
use firsthit::{Camera, DVec3, Projection, Scene};

use crate::args::CameraArgs;
use crate::failure::Failure;
use crate::hints::{exact_triple, span, triple};
use crate::values::Target;
use files::{of_colmap, of_output};
use lens::{check_lens, opening, projection};

pub(crate) use files::{labelled, matrix_of_file, of_file};

/// 16,384 squared: more is a slip of the finger more often than a picture.
const MOST_PIXELS: usize = 1 << 28;

/// Scenes that reach further have no place from which a camera sees them: squares are infinite
/// there.
const FARTHEST: f64 = 1e150;

/// The camera of a picture, and what of it was guessed: in words, each with the option that says
/// otherwise.
pub(crate) struct Chosen {
    pub(crate) camera: Camera,
    pub(crate) guessed: Vec<String>,
}

/// The camera that the arguments describe, in place of what the camera of the model's file, `base`,
/// says; what both leave open, the scene decides.
pub(crate) fn camera(
    args: &CameraArgs,
    (file, base): (&Path, &Description),
    scene: &Scene,
    model: &World,
) -> Result<Chosen, Failure> {
    let bounds = scene.bounds();
    let known = match of_colmap(args)? {
        Some(camera) => Some(camera),
        None => of_output(args)?,
    };
    let base = &match known {
        Some(camera) if !overrides(args) => {
            check(args)?;
            return Ok(Chosen {
                camera: match args.size {
                    Some([rows, columns]) => camera.resize(rows, columns)?,
                    None => camera,
                },
                guessed: Vec::new(),
            });
        }
        Some(camera) => Description {
            columns: Some(camera.columns()),
            rows: Some(camera.rows()),
            ..Description::of(camera.view())
        },
        None => *base,
    };
    let described = described(args, base)?;
    match args.size {
        Some(size) => check_size("--size", size)?,
        None => check_size(&format!("{}: the camera's size", escaped(file)), described.size())?,
    }
    let reach = bounds.low.abs().max(bounds.high.abs()).max_element();
    if described.position.is_none() && !bounds.is_empty() && reach > FARTHEST {
        return Err(Failure::bad_input(format!(
            "{}: the scene reaches too far for a camera to be placed: {}; use --position",
            escaped(file),
            span(bounds)
        )));
    }
    let support = |direction| scene.support(direction);
    // With a position or an aim, up is the format's convention: it must not depend on the model.
    let up = if described.position.is_none() && !matches!(described.aim, Some(Aim::Along(_))) {
        model.up_in(scene)
    } else {
        model.up
    };
    let is_guessed = described.up.is_none() && model.up_is_guessed;
    let camera = described.camera(bounds, support, up);
    Ok(Chosen {
        camera: camera.map_err(|error| Failure::of_options(error, &given(args)))?,
        guessed: guessed(&described, is_guessed.then_some(up)),
    })
}

/// The settings that options give in place of a file.
fn given(args: &CameraArgs) -> Vec<&'static str> {
    let options = [
        ("fov", args.fov.is_some()),
        ("fov_axis", args.fov_axis.is_some()),
        ("ray_start", args.ray_start.is_some()),
        ("viewplane", args.viewplane.is_some()),
        ("aperture", args.aperture.is_some()),
        ("focus", args.focus.is_some()),
    ];
    options.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect()
}

/// The guesses about the camera.
fn guessed(described: &Description, up: Option<DVec3>) -> Vec<String> {
    let mut guessed = Vec::new();
    if let Some(up) = up {
        guessed.push(format!("up {} (--up)", axis(up)));
    }
    let is_panorama = described.projection.is_some_and(Projection::is_panorama);
    match (described.position, described.aim) {
        (None, Some(Aim::Along(_))) if is_panorama => {
            guessed.push("from the middle (--position)".into());
        }
        (None, None | Some(Aim::Centre)) if is_panorama => {
            let front = StandardView::Front.name();
            guessed.push(format!("from the middle (--position), view {front} (--view)"));
        }
        (None, Some(Aim::Along(_))) => guessed.push("all in the picture (--position)".into()),
        (None, None | Some(Aim::Centre)) => {
            guessed.push(format!("view {} (--view)", StandardView::default().name()));
        }
        (Some(_), None) => guessed.push("aim at the middle (--look-at)".into()),
        _ => {}
    }
    guessed
}

/// A direction, an axis by its name.
pub(crate) fn axis(direction: DVec3) -> String {
    let axes = [(DVec3::X, "+x"), (DVec3::Y, "+y"), (DVec3::Z, "+z")];
    let named = axes.into_iter().find(|&(axis, _)| axis == direction);
    named.map_or_else(|| triple(direction), |(_, name)| name.to_owned())
}

/// Whether any option says something else than a camera that is known in full.
fn overrides(args: &CameraArgs) -> bool {
    let of_known = CameraArgs {
        camera: args.camera.clone(),
        colmap: args.colmap.clone(),
        image: args.image.clone(),
        size: args.size,
        convention: args.convention,
        ..CameraArgs::default()
    };
    *args != of_known
}

/// Refuses what no camera can be, whatever the file says, before any work is done.
pub(crate) fn check(args: &CameraArgs) -> Result<(), Failure> {
    args.size.map_or(Ok(()), |size| check_size("--size", size))
}

/// Refuses what no picture is that large; `what` says who asks for it.
pub(crate) fn check_size(what: &str, [rows, columns]: [usize; 2]) -> Result<(), Failure> {
    if rows.saturating_mul(columns) > MOST_PIXELS {
        return Err(Failure::limit(format!(
            "{what}: {columns}x{rows} is over the limit of {MOST_PIXELS} pixels"
        )));
    }
    Ok(())
}

/// The description with each word of the arguments in place of the file's.
fn described(args: &CameraArgs, base: &Description) -> Result<Description, Failure> {
    let from_anywhere = Description { position: None, up: None, ..*base };
    // A view replaces the position and the up of the file's camera.
    let base = args.view.map_or(base, |_| &from_anywhere);
    let aim = match (args.view, args.aim, args.look_at) {
        (Some(view), ..) => Some(Aim::View(view)),
        (_, Some(aim), _) => Some(Aim::Along(aim)),
        (_, _, Some(Target::Point(target))) => Some(Aim::At(target)),
        (_, _, Some(Target::Auto)) => Some(Aim::Centre),
        _ => base.aim,
    };
    let projection = projection(args).or(base.projection);
    let has_viewplane = projection.unwrap_or_default().has_viewplane();
    let has_lens = projection.unwrap_or_default().has_thin_lens();
    let opening = opening(args, base)?;
    let is_perspective = projection.unwrap_or_default() == Projection::Perspective;
    let has_fov = is_perspective && matches!(opening, None | Some(Opening::Fov(_)));
    let described = Description {
        position: args.position.or(base.position),
        aim,
        up: args.up.or(base.up),
        opening,
        fov_axis: args.fov_axis.or(base.fov_axis.filter(|_| has_fov)),
        projection,
        ray_start: args.ray_start.or(base.ray_start.filter(|_| has_viewplane)),
        aperture: args.aperture.or(base.aperture.filter(|_| has_lens)),
        focus: args.focus.or(base.focus.filter(|_| has_lens)),
        rows: args.size.map_or(base.rows, |[rows, _]| Some(rows)),
        columns: args.size.map_or(base.columns, |[_, columns]| Some(columns)),
    };
    let described = match &args.pose {
        Some(path) => posed(&described, path, args.convention.unwrap_or_default())?,
        None => described,
    };
    check_aim(&described)?;
    check_lens(&described)?;
    Ok(described)
}

/// The description with the pose of a file.
fn posed(
    described: &Description,
    path: &Path,
    convention: Convention,
) -> Result<Description, Failure> {
    let pose = convention.pose(matrix_of_file(path)?);
    let pose = pose.map_err(|error| Failure::from(error).in_file(path))?;
    Ok(Description {
        position: Some(pose.translation),
        aim: Some(Aim::Along(DVec3::ZERO - pose.matrix3.z_axis)),
        up: Some(pose.matrix3.y_axis),
        ..*described
    })
}

/// Refuses a point to look at that gives no direction.
fn check_aim(described: &Description) -> Result<(), Failure> {
    match (described.aim, described.position) {
        (Some(Aim::At(target)), None) => Err(Failure::usage(format!(
            "--look-at {} needs --position; or use --look-at auto",
            exact_triple(target)
        ))),
        (Some(Aim::At(target)), Some(position)) if target == position => {
            Err(Failure::usage(format!(
                "--look-at must be another point than --position, got {}",
                exact_triple(target)
            )))
        }
        _ => Ok(()),
    }
}
