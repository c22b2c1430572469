//! Cameras, where their nodes are.

#![allow(
    clippy::large_types_passed_by_value,
    reason = "a view is handed on a few times for each camera"
)]

use super::super::fault::Checked;
use super::super::model::NamedCamera;
use super::super::report::Report;
use super::document::{CameraEntry, Document};
use super::index::Index;
use super::nodes::Placed;
use super::place::Entry;
use crate::camera::{Camera, Description, Lens, Opening, RayStart, View, Viewplane};
use crate::error::escape_controls;
use crate::geometry::{DVec3, unit};

/// The cameras of the scene, in the order of the document's list.
pub(super) fn all(
    document: &Document<'_>,
    placed: &[Placed<'_>],
    report: &mut Report,
) -> Checked<Vec<NamedCamera>> {
    let mut cameras = Vec::new();
    let mut used = vec![false; document.cameras.len()];
    for place in placed {
        let Some(Index(index)) = place.node.camera else {
            continue;
        };
        let Some(camera) = document.cameras.get(index) else {
            continue;
        };
        if let Some(used) = used.get_mut(index) {
            *used = true;
        }
        let view = posed(lens(camera, Entry::new("cameras", index))?, place);
        if Camera::new(view).is_err() {
            report.warn("camera", &place.entry().place(), || {
                "the camera is left out: its node flattens space or is infinitely far away"
                    .to_owned()
            });
            continue;
        }
        let own = camera.name.as_deref();
        let named = NamedCamera {
            name: place.name(own).unwrap_or_default(),
            own_name: own.map(escape_controls).unwrap_or_default(),
            view,
            has_size: false,
            description: Some(describe(view)),
        };
        cameras.push((index, named));
    }
    if let Some(index) = used.iter().position(|used| !used) {
        let place = Entry::new("cameras", index).place();
        report.warn("unused camera", &place, || {
            "the camera is left out: no node of the scene says where it is".to_owned()
        });
    }
    cameras.sort_by_key(|&(index, _)| index);
    Ok(cameras.into_iter().map(|(_, camera)| camera).collect())
}

/// The view in words: of a perspective camera the angle counts, and of parallel rays the viewplane.
fn describe(view: View) -> Description {
    let lens = view.lens.viewplane().copied().unwrap_or_default();
    let Viewplane { width, height, .. } = lens;
    // Without a number of pixels the picture has the viewplane's shape.
    let whole = Opening::Viewplane { width, height, focal_length: None };
    let described = Description { opening: Some(whole), ..Description::default() };
    let [rows, columns] = described.size();
    Description {
        opening: Some(if lens.parallel {
            whole
        } else {
            Opening::Fov(2.0 * libm::atan(height / 2.0).to_degrees())
        }),
        columns: Some(columns),
        rows: Some(rows),
        ..Description::of(&view)
    }
}

/// The view of a camera at the origin along -z.
fn lens(camera: &CameraEntry<'_>, entry: Entry) -> Checked<View> {
    let view = View::default();
    let from_eye = Viewplane { ray_start: RayStart::Eye, ..Viewplane::default() };
    let through = |viewplane| View { lens: Lens::Flat(viewplane), ..view };
    let positive = |value: &str, number: f64| {
        if number > 0.0 {
            Ok(number)
        } else {
            Err(entry.fault(value, format!("must be positive, got {number}")))
        }
    };
    match (&*camera.kind, &camera.perspective, &camera.orthographic) {
        ("perspective", Some(lens), _) => {
            let place = "perspective/yfov";
            let angle = positive(place, lens.yfov)?;
            if angle >= std::f64::consts::PI {
                return Err(entry.fault(place, format!("must be less than pi, got {angle}")));
            }
            let height = 2.0 * libm::tan(angle / 2.0);
            let aspect = match lens.aspect_ratio {
                Some(ratio) => positive("perspective/aspectRatio", ratio)?,
                None => view.columns as f64 / view.rows as f64,
            };
            Ok(through(Viewplane { height, width: height * aspect, ..from_eye }))
        }
        ("orthographic", _, Some(lens)) => Ok(through(Viewplane {
            // Some programs write them with a sign, which would only mirror the picture.
            width: 2.0 * positive("orthographic/xmag", lens.xmag.abs())?,
            height: 2.0 * positive("orthographic/ymag", lens.ymag.abs())?,
            parallel: true,
            ..from_eye
        })),
        (kind @ ("perspective" | "orthographic"), _, _) => {
            Err(entry.fault(kind, format!("a camera of type {kind} must have this")))
        }
        (kind, _, _) => {
            let kind = escape_controls(kind);
            let what = format!("must be perspective or orthographic, got '{kind}'");
            Err(entry.fault("type", what))
        }
    }
}

/// The view from where a node is; its scale does not count.
fn posed(view: View, place: &Placed<'_>) -> View {
    let map = place.world_from_node;
    View {
        position: map.translation,
        aim: unit(map.transform_vector3(DVec3::NEG_Z)),
        up: map.transform_vector3(DVec3::Y),
        ..view
    }
}
