//! Makes a camera of the command line's words.

use std::path::Path;

use firsthit::camera::{
    Aim, Convention, Description, Lens, Opening, StandardView, orthonormalised, rounded_pose,
};
use firsthit::error::{escape_controls, escaped};
use firsthit::load;
use firsthit::sensor::camera_of;
use firsthit::world::{NamedCamera, World};
use firsthit::{Camera, DVec3, Projection, Scene};

use crate::args::CameraArgs;
use crate::console::{in_words, warn};
use crate::failure::Failure;
use crate::hints::{exact_triple, span, triple};
use crate::values::Target;

/// 16,384 squared: more is a slip of the finger more often than a picture.
const MOST_PIXELS: usize = 1 << 28;

/// Scenes that reach further have no place from which a camera sees them: squares are infinite there.
const FARTHEST: f64 = 1e150;

/// The camera of a picture, and what of it was guessed: in words, each with the option that says otherwise.
pub(crate) struct Chosen {
    pub(crate) camera: Camera,
    pub(crate) guessed: Vec<String>,
}

/// The camera that the arguments describe, in place of what the camera of the model's file, `base`, says; what both
/// leave open, the scene decides.
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
        None => check_size(
            &format!("{}: the camera's size", escaped(file)),
            described.size(),
        )?,
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
    Ok(Chosen {
        camera: described.camera(bounds, support, up)?,
        guessed: guessed(&described, is_guessed.then_some(up)),
    })
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
            guessed.push(format!(
                "from the middle (--position), view {front} (--view)"
            ));
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

/// The output that is named as the camera.
fn output(args: &CameraArgs) -> Option<&Path> {
    let path = Path::new(args.camera.as_deref()?);
    let is_output = firsthit::image::format_of(path).is_ok();
    (is_output && path.is_file()).then_some(path)
}

/// The camera that made the output that is named as the camera, if one is.
fn of_output(args: &CameraArgs) -> Result<Option<Camera>, Failure> {
    let Some(path) = output(args) else {
        return Ok(None);
    };
    let read = firsthit::image::read(path)?;
    firsthit::inputs::note(path);
    let record = read.metadata.and_then(|metadata| metadata.camera);
    let Some(record) = record else {
        return Err(Failure::bad_input(format!(
            "{}: the file does not say which camera made it",
            escaped(path)
        )));
    };
    Ok(Some(camera_of(&record)?))
}

/// The camera of an image of a reconstruction, if one is named.
fn of_colmap(args: &CameraArgs) -> Result<Option<Camera>, Failure> {
    let Some(folder) = &args.colmap else {
        return Ok(None);
    };
    let [cameras, images] = &load::colmap_files(folder)?;
    let reconstruction = load::read_colmap([cameras, images])?;
    let named = args.image.as_ref().map(|name| reconstruction.camera(name));
    if let Some(Some(camera)) = named {
        return Ok(Some(camera?));
    }
    let what = match &args.image {
        Some(name) => format!("--image '{}'", escape_controls(name)),
        None => "--colmap needs --image".to_owned(),
    };
    let names = reconstruction.names();
    let there = if names.len() == 0 {
        "no images".to_owned()
    } else {
        in_words(names.map(escape_controls))
    };
    let images = escaped(images);
    Err(Failure::usage(format!("{what}: {images} has {there}")))
}

/// The file's description of the camera that is asked for, or that it is to be looked through.
pub(crate) fn of_file(args: &CameraArgs, model: &World) -> Result<Description, Failure> {
    if args.colmap.is_some() || output(args).is_some() {
        return Ok(Description::default());
    }
    let camera = match &args.camera {
        Some(name) => Some(named(name, &model.cameras)?),
        None => model.cameras.first().filter(|_| model.has_view),
    };
    Ok(camera.map_or_else(Description::default, |camera| camera.described(args.size)))
}

/// The camera of a name, or else of another name that it goes by, or else of a number.
fn named<'a>(name: &str, cameras: &'a [NamedCamera]) -> Result<&'a NamedCamera, Failure> {
    if name.is_empty() {
        return Err(Failure::usage(
            "--camera: the name is empty; use the number of a camera without a name",
        ));
    }
    let called = |of: &dyn Fn(&NamedCamera) -> bool| -> Vec<usize> {
        let all = cameras.iter().enumerate();
        all.filter(|(_, camera)| of(camera))
            .map(|(k, _)| k)
            .collect()
    };
    let mut found = called(&|camera| camera.name == name);
    if found.is_empty() {
        found = called(&|camera| camera.own_name == name);
    }
    if found.is_empty() {
        let number: Option<usize> = name.parse().ok();
        found.extend(number.filter(|&number| number < cameras.len()));
    }
    if let &[number] = &found[..] {
        return Ok(&cameras[number]);
    }
    let shown = escape_controls(name);
    Err(Failure::usage(match (cameras.len(), found.len()) {
        (0, _) => format!("--camera '{shown}': the file has no cameras"),
        (_, 0) => {
            let names = cameras
                .iter()
                .enumerate()
                .map(|(k, camera)| labelled(k, camera));
            let names = in_words(names);
            format!("--camera '{shown}': the file has {names}")
        }
        _ => format!(
            "--camera '{shown}': several cameras have this name, use a number: {}",
            in_words(found.iter().map(usize::to_string))
        ),
    }))
}

/// A camera by its number and name.
pub(crate) fn labelled(number: usize, camera: &NamedCamera) -> String {
    let NamedCamera { name, own_name, .. } = camera;
    match (name.is_empty(), own_name.is_empty() || own_name == name) {
        (true, _) => number.to_string(),
        (false, true) => format!("{number} {}", escape_controls(name)),
        (false, false) => {
            let (name, own_name) = (escape_controls(name), escape_controls(own_name));
            format!("{number} {name} (or {own_name})")
        }
    }
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
    let from_anywhere = Description {
        position: None,
        up: None,
        ..*base
    };
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

/// Refuses a lens of which half is missing.
fn check_lens(described: &Description) -> Result<(), Failure> {
    let own = match described.opening {
        Some(Opening::Lens { lens, .. }) => lens.aperture(),
        _ => 0.0,
    };
    let aperture = described.aperture.unwrap_or(own);
    match described.focus {
        None if aperture > own => Err(Failure::usage(format!(
            "--aperture {aperture} needs --focus, a distance or a point"
        ))),
        Some(_) if described.aperture.is_none() && own == 0.0 => Err(Failure::usage(
            "--focus needs --aperture, the lens' diameter",
        )),
        _ => Ok(()),
    }
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

/// The matrix of a pose in a text file; a rotation that is rounded becomes the nearest one.
pub(crate) fn matrix_of_file(path: &Path) -> Result<[[f64; 4]; 4], Failure> {
    /// A matrix takes less than this, in bytes.
    const LARGEST: u64 = 1 << 16;
    let wrong = |what: &str| Failure::bad_input(format!("{}: {what}", escaped(path)));
    let bytes = firsthit::image::read_regular(path, LARGEST)?;
    let text = String::from_utf8_lossy(&bytes);
    let words = text.split(|c: char| c.is_whitespace() || ",;[]".contains(c));
    let numbers = words.filter(|word| !word.is_empty()).map(str::parse::<f64>);
    let numbers: Option<Vec<f64>> = numbers.map(Result::ok).collect();
    let numbers = numbers.filter(|numbers| [12, 16].contains(&numbers.len()));
    let Some(mut numbers) = numbers else {
        return Err(wrong(
            "expected the 12 or 16 numbers of a 3 x 4 or 4 x 4 matrix, row by row",
        ));
    };
    if numbers.len() == 12 {
        numbers.extend([0.0, 0.0, 0.0, 1.0]);
    }
    let row = |k: usize| [0, 1, 2, 3].map(|column| numbers[4 * k + column]);
    let mut pose = [row(0), row(1), row(2), row(3)];
    if let Some((turned, off)) = orthonormalised(pose) {
        warn(&[format!("{}: {}", escaped(path), rounded_pose(off))]);
        pose = turned;
    }
    Ok(pose)
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
fn projection(args: &CameraArgs) -> Option<Projection> {
    let parallel = args.orthographic.then_some(Projection::Orthographic);
    parallel.or(args.projection)
}

/// The field of view: the viewplane's own size, or an angle.
fn opening(args: &CameraArgs, base: &Description) -> Result<Option<Opening>, Failure> {
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
        return Ok(Some(Opening::Viewplane {
            width,
            height,
            focal_length,
        }));
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
