//! Cameras, to the record and back.

use serde::{Deserialize, Serialize};

use super::number::{Number, Triple};
use crate::camera::{
    Aim, Camera, Description, Focus, FovAxis, Lens, Opening, Projection, RayStart, StandardView,
    View,
};
use crate::error::{Result, escape_controls};
use crate::geometry::{require, require_finite};
use crate::world::NamedCamera;

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraRecord {
    name: String,
    own_name: String,
    position: Triple,
    aim: Triple,
    up: Triple,
    rows: usize,
    columns: usize,
    lens: LensRecord,
    has_size: bool,
    description: Option<DescriptionRecord>,
}

/// A lens by the name of its projection, and its numbers.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LensRecord {
    projection: String,
    /// The start of rays; `None` without a viewplane.
    ray_start: Option<String>,
    parameters: Vec<(String, Number)>,
}

impl LensRecord {
    fn new(lens: &Lens) -> Self {
        let parameters = lens.parameters().into_iter();
        Self {
            projection: lens.projection().name().to_owned(),
            ray_start: lens.viewplane().map(|viewplane| viewplane.ray_start.name().to_owned()),
            parameters: parameters.map(|(name, value)| (name.to_owned(), Number(value))).collect(),
        }
    }

    fn lens(&self) -> Result<Lens> {
        let parameters = self.parameters.iter();
        let parameters: Vec<(&str, f64)> =
            parameters.map(|(name, value)| (&**name, value.0)).collect();
        let mut lens = Lens::named(self.projection.parse()?, &parameters)?;
        if let (Lens::Flat(viewplane), Some(start)) = (&mut lens, &self.ray_start) {
            viewplane.ray_start = start.parse()?;
        }
        Ok(lens)
    }
}

/// A camera as a scene file describes it, in part.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct DescriptionRecord {
    position: Option<Triple>,
    aim: Option<AimRecord>,
    up: Option<Triple>,
    opening: Option<OpeningRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fov_axis: Option<String>,
    projection: Option<String>,
    ray_start: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    aperture: Option<Number>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    focus: Option<FocusRecord>,
    columns: Option<usize>,
    rows: Option<usize>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum FocusRecord {
    Distance(Number),
    At(Triple),
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum AimRecord {
    Along(Triple),
    At(Triple),
    Centre,
    View(String),
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum OpeningRecord {
    Fov(Number),
    /// The width, height and distance of a viewplane.
    Viewplane(Number, Number, Option<Number>),
    /// A lens with the rows and columns that it is for.
    Lens(LensRecord, [usize; 2]),
}

impl CameraRecord {
    pub(super) fn new(camera: &NamedCamera) -> Self {
        let View { position, aim, up, rows, columns, lens } = camera.view;
        Self {
            name: camera.name.clone(),
            own_name: camera.own_name.clone(),
            position: position.into(),
            aim: aim.into(),
            up: up.into(),
            rows,
            columns,
            lens: LensRecord::new(&lens),
            has_size: camera.has_size,
            description: camera.description.as_ref().map(DescriptionRecord::new),
        }
    }

    /// The camera, whatever its numbers.
    pub(super) fn camera(&self) -> Result<NamedCamera> {
        let view = View {
            position: self.position.into(),
            aim: self.aim.into(),
            up: self.up.into(),
            rows: self.rows,
            columns: self.columns,
            lens: self.lens.lens()?,
        };
        let description = self.description.as_ref();
        Ok(NamedCamera {
            name: escape_controls(&self.name),
            own_name: escape_controls(&self.own_name),
            view,
            has_size: self.has_size,
            description: description.map(DescriptionRecord::description).transpose()?,
        })
    }
}

impl DescriptionRecord {
    fn new(described: &Description) -> Self {
        let Description {
            position,
            aim,
            up,
            opening,
            fov_axis,
            projection,
            ray_start,
            aperture,
            focus,
            columns,
            rows,
        } = *described;
        Self {
            position: position.map(Triple::from),
            aim: aim.map(|aim| match aim {
                Aim::Along(direction) => AimRecord::Along(direction.into()),
                Aim::At(point) => AimRecord::At(point.into()),
                Aim::Centre => AimRecord::Centre,
                Aim::View(view) => AimRecord::View(view.name().to_owned()),
            }),
            up: up.map(Triple::from),
            opening: opening.map(|opening| match opening {
                Opening::Fov(degrees) => OpeningRecord::Fov(Number(degrees)),
                Opening::Viewplane { width, height, focal_length } => {
                    let focal_length = focal_length.map(Number);
                    OpeningRecord::Viewplane(Number(width), Number(height), focal_length)
                }
                Opening::Lens { lens, size } => OpeningRecord::Lens(LensRecord::new(&lens), size),
            }),
            fov_axis: fov_axis.map(|axis| axis.name().to_owned()),
            projection: projection.map(|projection| projection.name().to_owned()),
            ray_start: ray_start.map(|start| start.name().to_owned()),
            aperture: aperture.map(Number),
            focus: focus.map(|focus| match focus {
                Focus::Distance(distance) => FocusRecord::Distance(Number(distance)),
                Focus::At(point) => FocusRecord::At(point.into()),
            }),
            columns,
            rows,
        }
    }

    fn description(&self) -> Result<Description> {
        let aim = self.aim.as_ref().map(|aim| {
            Ok(match aim {
                AimRecord::Along(direction) => Aim::Along((*direction).into()),
                AimRecord::At(point) => Aim::At((*point).into()),
                AimRecord::Centre => Aim::Centre,
                AimRecord::View(name) => Aim::View(name.parse::<StandardView>()?),
            })
        });
        let opening = self.opening.as_ref().map(|opening| {
            Ok(match opening {
                OpeningRecord::Fov(Number(degrees)) => Opening::Fov(*degrees),
                OpeningRecord::Viewplane(Number(width), Number(height), focal_length) => {
                    Opening::Viewplane {
                        width: *width,
                        height: *height,
                        focal_length: focal_length.as_ref().map(|Number(length)| *length),
                    }
                }
                OpeningRecord::Lens(lens, size) => {
                    Opening::Lens { lens: lens.lens()?, size: *size }
                }
            })
        });
        let focus = self.focus.as_ref().map(|focus| match focus {
            FocusRecord::Distance(Number(distance)) => Focus::Distance(*distance),
            FocusRecord::At(point) => Focus::At((*point).into()),
        });
        let fov_axis = self.fov_axis.as_deref().map(str::parse::<FovAxis>);
        let projection = self.projection.as_deref().map(str::parse::<Projection>);
        let ray_start = self.ray_start.as_deref().map(str::parse::<RayStart>);
        Ok(Description {
            position: self.position.map(Into::into),
            aim: aim.transpose()?,
            up: self.up.map(Into::into),
            opening: opening.transpose()?,
            fov_axis: fov_axis.transpose()?,
            projection: projection.transpose()?,
            ray_start: ray_start.transpose()?,
            aperture: self.aperture.as_ref().map(|Number(aperture)| *aperture),
            focus,
            columns: self.columns,
            rows: self.rows,
        })
    }
}

/// Refuses cameras that nothing can be seen through, here where the file is known. Of a description
/// only the numbers are asked: what it leaves open need not suit this scene.
pub(super) fn check_cameras(cameras: &[NamedCamera]) -> Result<()> {
    for camera in cameras {
        Camera::new(camera.view)?;
        let described = camera.described(None);
        let [rows, columns] = described.size();
        for (name, pixels) in [
            ("columns", camera.view.columns),
            ("rows", camera.view.rows),
            ("columns", columns),
            ("rows", rows),
        ] {
            let is_possible = (1..=1 << 28).contains(&pixels);
            require(name, "from 1 to 2^28", is_possible, pixels)?;
        }
        check_description(&described)?;
    }
    Ok(())
}

fn check_description(described: &Description) -> Result<()> {
    let towards = described.aim.and_then(|aim| match aim {
        Aim::Along(vector) | Aim::At(vector) => Some(vector),
        _ => None,
    });
    let (distance, at) = match described.focus {
        Some(Focus::Distance(distance)) => (Some(distance), None),
        Some(Focus::At(point)) => (None, Some(point)),
        None => (None, None),
    };
    let vectors = [described.position, described.up, towards, at];
    for vector in vectors.into_iter().flatten() {
        require_finite("a camera's description", vector)?;
    }
    let lengths = match described.opening {
        Some(Opening::Fov(degrees)) => {
            let is_possible = degrees > 0.0 && degrees <= 360.0;
            require("fov", "above 0 and up to 360", is_possible, degrees)?;
            [None; 3]
        }
        Some(Opening::Viewplane { width, height, focal_length }) => {
            [Some(width), Some(height), focal_length]
        }
        _ => [None; 3],
    };
    for length in lengths.into_iter().chain([distance]).flatten() {
        let is_possible = length > 0.0 && length.is_finite();
        let name = "a length of a camera's description";
        require(name, "positive and finite", is_possible, length)?;
    }
    let aperture = described.aperture.unwrap_or(0.0);
    let is_possible = aperture >= 0.0 && aperture.is_finite();
    require("aperture", "zero or positive, and finite", is_possible, aperture)
}
