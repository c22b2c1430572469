//! Reads the cameras of a scene file.

use super::CAMERA;
use crate::camera::{
    Aim, Convention, Description, Focus, Lens, Opening, PixelMatrix, Projection, RayStart,
    orthonormalised, rounded_pose,
};
use crate::geometry::{Bounds, DVec3};
use crate::io::Report;
use crate::io::fault::Checked;
use crate::scene_file::document::numbers as numbers_of;
use crate::scene_file::section::Section;
use crate::world::{NamedCamera, World};

/// A camera with its name and the table that it stands in.
pub(in crate::scene_file) struct Read<'v, 't> {
    name: String,
    section: Section<'v, 't>,
    description: Description,
}

/// The file's cameras, the one without a name first.
pub(in crate::scene_file) fn read<'v, 't>(
    scene: &Section<'v, 't>,
    report: &mut Report,
) -> Checked<Vec<Read<'v, 't>>> {
    let unnamed = scene.table("camera", &CAMERA)?;
    let unnamed = unnamed.into_iter().map(|section| ("camera", section));
    let named = scene.named("cameras", &CAMERA)?;
    let cameras = unnamed.chain(named).map(|(name, section)| {
        Ok(Read { name: name.to_owned(), section, description: description(&section, report)? })
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

/// The numbers of an intrinsic matrix.
const MATRIX: [&str; 5] = ["fx", "fy", "cx", "cy", "skew"];

/// The field of view of a camera.
fn opening(
    section: &Section<'_, '_>,
    projection: Projection,
    convention: Option<Convention>,
) -> Checked<Option<Opening>> {
    let size = [section.whole("rows"), section.whole("columns")];
    let [fx, fy, cx, cy, skew] = MATRIX.map(|name| section.number(name).unwrap_or(0.0));
    let matrix = PixelMatrix { fx, fy, cx, cy, skew };
    if let (true, Some(convention), [Some(rows), Some(columns)]) =
        (section.has("fx"), convention, size)
    {
        let matrix = convention.pixel_matrix(matrix);
        let size = [rows, columns];
        let mut others = numbers(section, projection);
        others.retain(|(name, _)| !MATRIX.contains(name));
        let lens = section.checked(matrix.lens(projection, &others, size))?;
        return Ok(Some(Opening::Lens { lens, size }));
    }
    if let Some(fov) = section.number("fov") {
        return Ok(Some(Opening::Fov(fov)));
    }
    let focal_length = section.number("focal_length");
    let sides = section.number("width").zip(section.number("height"));
    let viewplane = sides.map(|(width, height)| Opening::Viewplane { width, height, focal_length });
    let numbers = numbers(section, projection);
    if numbers.iter().all(|(name, _)| LENGTHS.contains(name)) {
        return Ok(viewplane);
    }
    let lens = section.checked(Lens::named(projection, &numbers))?;
    let [rows, columns] = size;
    let whole = Description {
        opening: viewplane,
        projection: Some(projection),
        columns,
        rows,
        ..Description::default()
    };
    let size = whole.size();
    Ok(Some(Opening::Lens { lens, size }))
}

/// The numbers of a viewplane of a size.
const LENGTHS: [&str; 3] = ["focal_length", "width", "height"];

/// The numbers of a lens that its table gives, without those of a thin one.
fn numbers(section: &Section<'_, '_>, projection: Projection) -> Vec<(&'static str, f64)> {
    let all = projection.settings().into_iter().map(|setting| setting.name);
    let all = all.filter(|name| !matches!(*name, "aperture" | "focus"));
    all.filter_map(|name| Some((name, section.number(name)?))).collect()
}

/// The cameras with what they leave open decided by the objects.
pub(in crate::scene_file) fn settle(
    cameras: Vec<Read<'_, '_>>,
    world: &World,
) -> Checked<Vec<NamedCamera>> {
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
            has_size: is_sized || !matches!(description.opening, None | Some(Opening::Fov(_))),
            description: Some(description),
        })
    };
    cameras.into_iter().map(settle).collect()
}
