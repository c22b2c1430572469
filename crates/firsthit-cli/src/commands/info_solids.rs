//! Describes meshes as solids: whether they are closed, their area, their volume, their shells.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use firsthit::{Bounds, Mesh, Object, Result, Transform};
use serde_json::{Value, json};

use super::listing::listed;
use crate::console::counted;
use crate::hints::{number, span};

/// The solids of a scene's meshes, each computed once.
#[derive(Default)]
pub(super) struct Solids(HashMap<*const Mesh, Option<Rc<Solid>>>);

/// A mesh, or a shell of it, in its own space.
struct Solid {
    triangles: usize,
    is_closed: bool,
    area: f64,
    volume: Option<f64>,
    bounds: Bounds,
    shells: Vec<Self>,
}

impl Solids {
    /// `None` for what is no mesh, has no triangles, or takes more memory than there is.
    fn of(&mut self, object: &Object) -> Option<Rc<Solid>> {
        let mesh = object.mesh().filter(|mesh| !mesh.triangles().is_empty())?;
        let found = || Solid::of(mesh).ok().map(Rc::new);
        let known = self.0.entry(Arc::as_ptr(mesh)).or_insert_with(found);
        known.clone()
    }

    /// The members of an object's JSON about its solid. At most `room` shells are listed, which
    /// becomes less by them.
    pub(super) fn as_json(
        &mut self,
        object: &Object,
        room: &mut usize,
    ) -> Vec<(&'static str, Value)> {
        let Some(solid) = self.of(object) else {
            return Vec::new();
        };
        let transform = object.transform();
        let shells: Vec<Value> = (solid.shells.iter().take(*room))
            .map(|shell| {
                let Bounds { low, high } = shell.bounds_in(transform);
                json!({
                    "triangles": shell.triangles,
                    "bounds": [low.to_array(), high.to_array()],
                    "is_closed": shell.is_closed,
                    "area": shell.area_in(transform),
                    "volume": shell.volume_in(transform),
                })
            })
            .collect();
        *room -= shells.len();
        vec![
            ("is_closed", json!(solid.is_closed)),
            ("area", json!(solid.area_in(transform))),
            ("volume", json!(solid.volume_in(transform))),
            ("shells", json!(shells)),
            ("shell_count", json!(solid.shells.len().max(1))),
        ]
    }

    /// A line, and one for each shell if there are several. A lone triangle has none: it says all
    /// itself.
    pub(super) fn as_text(&mut self, object: &Object, most: usize, indent: &str) -> Vec<String> {
        let Some(solid) = self.of(object).filter(|solid| solid.triangles > 1) else {
            return Vec::new();
        };
        let transform = object.transform();
        let shells = solid.shells.iter().map(|shell| {
            let triangles = counted(shell.triangles as u64, "triangle");
            let (words, span) = (shell.words(transform), span(shell.bounds_in(transform)));
            format!("  shell  {triangles}, {words}, {span}")
        });
        let own = solid.words(transform);
        let count = match solid.shells.len() {
            0 => String::new(),
            count => format!(", {count} shells"),
        };
        let mut lines = vec![format!("{indent}{own}{count}")];
        lines.extend(listed(most, indent, shells));
        lines
    }
}

impl Solid {
    fn of(mesh: &Mesh) -> Result<Self> {
        let shells = match mesh.part_count()? {
            0 | 1 => Vec::new(),
            _ => mesh.split()?,
        };
        Ok(Self {
            triangles: mesh.triangles().len(),
            is_closed: mesh.is_closed()?,
            area: mesh.area(),
            volume: mesh.volume()?,
            bounds: mesh.bounds(),
            shells: shells.iter().map(Self::of).collect::<Result<_>>()?,
        })
    }

    fn words(&self, transform: &Transform) -> String {
        let is_closed = if self.is_closed { "closed" } else { "open" };
        let named = |name: &str, value: Option<f64>| {
            value.map_or_else(String::new, |value| format!(", {name} {}", number(value)))
        };
        let area = named("area", self.area_in(transform));
        format!("{is_closed}{area}{}", named("volume", self.volume_in(transform)))
    }

    fn bounds_in(&self, transform: &Transform) -> Bounds {
        if transform.is_identity() {
            return self.bounds;
        }
        Bounds::of(self.bounds.corners().map(|corner| transform.point_in_world(corner)))
    }

    /// The area in the world; `None` where the transform does not stretch equally in all
    /// directions.
    fn area_in(&self, transform: &Transform) -> Option<f64> {
        let m = transform.world_from_object().matrix3;
        let square = m.transpose() * m;
        let scale = square.x_axis.x;
        let off = square - firsthit::DMat3::from_diagonal(firsthit::DVec3::splat(scale));
        let is_similar = off.to_cols_array().iter().all(|x| x.abs() <= 1e-9 * scale);
        is_similar.then_some(scale * self.area)
    }

    fn volume_in(&self, transform: &Transform) -> Option<f64> {
        let scale = transform.world_from_object().matrix3.determinant().abs();
        self.volume.map(|volume| scale * volume)
    }
}
