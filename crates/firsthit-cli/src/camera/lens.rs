//! The lens that the arguments describe.

use firsthit::Projection;
use firsthit::camera::{Description, Lens, Opening};

use crate::args::CameraArgs;
use crate::failure::Failure;

/// Refuses a lens of which half is missing.
pub(super) fn check_lens(described: &Description) -> Result<(), Failure> {
    let own = match described.opening {
        Some(Opening::Lens { lens, .. }) => lens.aperture(),
        _ => 0.0,
    };
    let aperture = described.aperture.unwrap_or(own);
    match described.focus {
        None if aperture > own => Err(Failure::usage(format!(
            "--aperture {aperture} needs --focus, a distance or a point"
        ))),
        Some(_) if described.aperture.is_none() && own == 0.0 => {
            Err(Failure::usage("--focus needs --aperture, the lens' diameter"))
        }
        _ => Ok(()),
    }
}

/// The lens of an intrinsic matrix or of numbers by name, if there are any.
fn lens(args: &CameraArgs, projection: Projection) -> Result<Option<Opening>, Failure> {
    let named = args.parameters.as_ref().map_or(&[][..], |named| &named.0);
    let named = named.iter().map(|(name, value)| (&**name, *value));
    let mut numbers: Vec<(&str, f64)> = named.collect();
    let described = Description {
        opening: args.viewplane.map(|(width, height)| Opening::Viewplane {
            width,
            height,
            focal_length: args.focal_length,
        }),
        projection: Some(projection),
        rows: args.size.map(|[rows, _]| rows),
        columns: args.size.map(|[_, columns]| columns),
        ..Description::default()
    };
    let size = described.size();
    if let Some(matrix) = args.intrinsics {
        let matrix = args.convention.unwrap_or_default().pixel_matrix(matrix);
        if projection == Projection::Perspective && !numbers.is_empty() {
            return Err(Failure::usage(
                "--parameters: a perspective camera with --intrinsics has no others; for distortion use --projection opencv",
            ));
        }
        let lens = matrix.lens(projection, &numbers, size)?;
        return Ok(Some(Opening::Lens { lens, size }));
    }
    if numbers.is_empty() {
        return Ok(None);
    }
    if let Some((width, height)) = args.viewplane {
        numbers.extend([("width", width), ("height", height)]);
        numbers.extend(args.focal_length.map(|length| ("focal_length", length)));
    }
    let lens = Lens::named(projection, &numbers)?;
    Ok(Some(Opening::Lens { lens, size }))
}

/// The projection that the arguments name.
pub(super) fn projection(args: &CameraArgs) -> Option<Projection> {
    let parallel = args.orthographic.then_some(Projection::Orthographic);
    parallel.or(args.projection)
}

/// The field of view: the viewplane's own size, or an angle.
pub(super) fn opening(args: &CameraArgs, base: &Description) -> Result<Option<Opening>, Failure> {
    let projection = projection(args).or(base.projection);
    if let Some(lens) = lens(args, projection.unwrap_or_default())? {
        return Ok(Some(lens));
    }
    if !projection.unwrap_or_default().has_viewplane() {
        if args.viewplane.is_some() {
            return Err(Failure::usage(
                "--viewplane is for perspective and orthographic cameras; the others have none",
            ));
        }
        let own = base.opening.filter(|_| projection == base.projection);
        return Ok(args.fov.map(Opening::Fov).or(own));
    }
    let is_parallel = projection == Some(Projection::Orthographic);
    let of_file = match base.opening {
        Some(Opening::Viewplane { focal_length, .. }) => focal_length,
        _ => None,
    };
    if let Some((width, height)) = args.viewplane {
        let focal_length = args.focal_length.or(of_file);
        if focal_length.is_none() && !is_parallel {
            return Err(Failure::usage(
                "--viewplane needs --focal-length (or --orthographic), or use --fov",
            ));
        }
        return Ok(Some(Opening::Viewplane { width, height, focal_length }));
    }
    match (args.fov, base.opening) {
        (Some(_), _) if is_parallel => Err(Failure::usage(
            "--fov is for perspective cameras, and the file's is orthographic; use --viewplane",
        )),
        (Some(fov), _) if fov >= 180.0 => Err(Failure::usage(format!(
            "--fov {fov}: of a perspective camera expected degrees between 0 and 180"
        ))),
        (Some(fov), _) => Ok(Some(Opening::Fov(fov))),
        // Of an angle parallel rays know nothing.
        (None, Some(Opening::Fov(_))) if is_parallel => Ok(None),
        // Another projection than the file's has another lens.
        (None, Some(Opening::Lens { .. })) if projection != base.projection => Ok(None),
        (None, lens) => Ok(lens),
    }
}
