//! From the command line's words to a camera.

use firsthit::{Bounds, Camera, DVec3, Projection, RayStart, View};

use crate::args::CameraArgs;
use crate::failure::Failure;
use crate::hints::triple;
use crate::values::Target;

const DEFAULT_SIZE: (usize, usize) = (1024, 768);
const DEFAULT_FOV: f64 = 45.0;
/// 16,384 squared: more is a slip of the finger more often than a picture.
const MOST_PIXELS: usize = 1 << 28;

/// The camera that the arguments describe; what they leave open, the scene decides.
pub(crate) fn camera(args: &CameraArgs, bounds: Bounds, file_up: DVec3) -> Result<Camera, Failure> {
    // With nothing to see, any place is as good.
    let nothing = bounds.is_empty() || !bounds.is_finite();
    let bounds = if nothing {
        Bounds {
            low: DVec3::NEG_ONE,
            high: DVec3::ONE,
        }
    } else {
        bounds
    };
    let up = args.up.unwrap_or(file_up);
    let view = lens(args, View { up, ..size(args)? })?;
    let camera = match args.position {
        Some(position) => {
            let view = aimed(args, View { position, ..view }, bounds)?;
            let view = upright(args, view);
            let open = view.projection == Projection::Orthographic && args.viewplane.is_none();
            let view = if open { sized(view, bounds)? } else { view };
            Camera::new(view)?
        }
        None => framed(args, view, bounds)?,
    };
    let start = args.ray_start.map_or(view.ray_start, RayStart::from);
    Ok(camera.starting_at(start))
}

/// The picture's size, and no more of the view.
pub(crate) fn size(args: &CameraArgs) -> Result<View, Failure> {
    let (columns, rows) = match (args.size, args.viewplane) {
        (Some(size), _) => size,
        (None, Some((width, height))) => {
            let rows = (DEFAULT_SIZE.0 as f64 * height / width)
                .round()
                .clamp(1.0, 16_384.0);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped"
            )]
            (DEFAULT_SIZE.0, rows as usize)
        }
        (None, None) => DEFAULT_SIZE,
    };
    check_size((columns, rows))?;
    Ok(View {
        rows,
        columns,
        ..View::default()
    })
}

/// Refuses what no picture is that large.
pub(crate) fn check_size((columns, rows): (usize, usize)) -> Result<(), Failure> {
    if rows.saturating_mul(columns) > MOST_PIXELS {
        return Err(Failure::limit(format!(
            "--size: {columns}x{rows} is over the limit of {MOST_PIXELS} pixels"
        )));
    }
    Ok(())
}

/// The viewplane: by its own size, or by an angle.
fn lens(args: &CameraArgs, view: View) -> Result<View, Failure> {
    let projection = if args.orthographic {
        Projection::Orthographic
    } else {
        Projection::Perspective
    };
    let view = View { projection, ..view };
    let Some((width, height)) = args.viewplane else {
        let view = view.with_vertical_fov(args.fov.unwrap_or(DEFAULT_FOV))?;
        return Ok(View {
            ray_start: RayStart::Eye,
            ..view
        });
    };
    let view = View {
        width,
        height,
        ..view
    };
    match args.focal_length {
        Some(focal_length) => Ok(View {
            focal_length,
            ray_start: RayStart::Viewplane,
            ..view
        }),
        // Parallel rays are the same wherever the viewplane is.
        None if args.orthographic => Ok(View {
            focal_length: 1.0,
            ray_start: RayStart::Eye,
            ..view
        }),
        None => Err(Failure::usage(
            "--viewplane needs --focal-length (or --orthographic), or use --fov",
        )),
    }
}

/// The view from a position that is given.
fn aimed(args: &CameraArgs, view: View, bounds: Bounds) -> Result<View, Failure> {
    let target = match (args.aim, args.look_at) {
        (Some(aim), _) => return Ok(View { aim, ..view }),
        (None, Some(Target::Point(target))) => target,
        (None, Some(Target::Auto) | None) => bounds.centre(),
    };
    if target == view.position {
        return Err(Failure::usage(format!(
            "--look-at must be another point than --position, got {}",
            triple(target)
        )));
    }
    Ok(view.aimed_at(target))
}

/// The view with another way up where the format's custom says nothing: straight from above or below.
fn upright(args: &CameraArgs, view: View) -> View {
    let is_along = firsthit::geometry::unit(view.aim).cross(view.up).length() < 1e-9;
    if args.up.is_some() || !is_along {
        return view;
    }
    // What maps do: north is up, and x goes to the right.
    let up = if view.up.z == 0.0 {
        DVec3::NEG_Z
    } else {
        DVec3::Y
    };
    View { up, ..view }
}

/// The view from where everything is seen.
fn framed(args: &CameraArgs, view: View, bounds: Bounds) -> Result<Camera, Failure> {
    if let Some(Target::Point(target)) = args.look_at {
        return Err(Failure::usage(format!(
            "--look-at {} needs --position; or use --look-at auto",
            triple(target)
        )));
    }
    let aim = args.aim.unwrap_or_else(|| three_quarters(view.up));
    let view = upright(args, View { aim, ..view });
    let camera = Camera::framing(view, bounds)?;
    match args.viewplane {
        // A viewplane that was asked for stays as it was asked for.
        Some((width, height)) => Ok(Camera::new(View {
            width,
            height,
            ..*camera.view()
        })?),
        None => Ok(camera),
    }
}

/// The view with a viewplane for parallel rays that shows everything from where it is.
fn sized(view: View, bounds: Bounds) -> Result<View, Failure> {
    let View { width, height, .. } = *Camera::framing(view, bounds)?.view();
    Ok(View {
        width,
        height,
        ..view
    })
}

/// A view a little from the right and from above, on the front: with z up that faces -y, with y up +z.
fn three_quarters(up: DVec3) -> DVec3 {
    let up = firsthit::geometry::unit(up);
    if up.is_nan() {
        // The camera refuses it, by its name.
        return DVec3::NEG_Z;
    }
    let front = if up.y.abs() < 0.9 {
        DVec3::NEG_Y
    } else {
        DVec3::Z
    };
    let front = front.reject_from_normalized(up);
    let right = up.cross(front);
    -(front + 0.35 * right + 0.35 * up)
}
