//! Facts about the scene for a page, before the first frame.

use firsthit::Color;
use firsthit::camera::StandardView;
use firsthit::channel;
use firsthit::geometry::ColorMap;
use firsthit::scene::Coloring;
use firsthit::shade::LightRig;
use serde_json::{Value, json};

use crate::viewer::Viewer;

/// The legend of a colouring without its range, which each frame tells.
fn legend(coloring: &Coloring) -> Value {
    let color = |color: Option<Color>| color.map(|color| color.to_array());
    json!({
        "by": coloring.by.text(),
        "map": coloring.map.name(),
        "below": color(coloring.below),
        "above": color(coloring.above),
    })
}

/// The channels that a page can show, in the order in which it lists them.
const SHOWN: [&str; 10] =
    ["color", "t", "range", "z", "object", "primitive", "normal", "position", "incidence", "front"];

/// The most objects that a page lists.
const MOST_LISTED: usize = 10_000;

impl Viewer {
    /// The title, the box and the objects of the scene, which way is up, the camera to begin with,
    /// and what can be asked for.
    pub fn info(&self) -> Value {
        let bounds = self.scene().bounds();
        let objects = self.scene().objects().iter().enumerate();
        let objects = objects.take(MOST_LISTED).map(|(number, object)| {
            json!({
                "object": number,
                "name": object.name(),
                "shape": object.shape().name(),
                "triangles": object.triangles(),
                "color": object.color().to_array(),
            })
        });
        let objects_hidden = self.scene().objects().iter().enumerate();
        let hidden =
            objects_hidden.filter_map(|(number, object)| object.is_hidden().then_some(number));
        let maps = ColorMap::ALL.iter().map(|map| {
            let levels: Vec<_> = (0..256).map(|step| json!(map.levels(step))).collect();
            (map.name().to_owned(), Value::Array(levels))
        });
        let up = self.scene().up();
        let views = StandardView::ALL.iter().map(|view| {
            let (aim, up) = view.aim_and_up(up);
            json!({"name": view.name(), "aim": aim.to_array(), "up": up.to_array()})
        });
        let channels = SHOWN.iter().filter_map(|name| channel::kind(name).ok());
        json!({
            "title": self.title,
            "warnings": self.warnings,
            "up": self.scene().up().to_array(),
            "bounds": if bounds.is_empty() || !bounds.is_finite() {
                Value::Null
            } else {
                json!([bounds.low.to_array(), bounds.high.to_array()])
            },
            "objects": objects.collect::<Vec<_>>(),
            "hidden": hidden.collect::<Vec<_>>(),
            "object_count": self.scene().objects().len(),
            "triangles": self.scene().triangles(),
            "camera": self.first_camera,
            "channels": channels.map(|kind| json!({"name": kind.name, "about": kind.about})).collect::<Vec<_>>(),
            "colors": self.appearance.coloring.as_ref().map(legend),
            "version": env!("CARGO_PKG_VERSION"),
            "maps": maps.collect::<serde_json::Map<_, _>>(),
            "lights": LightRig::NAMES,
            "views": views.collect::<Vec<_>>(),
            "environment": self.scene().environment().is_some(),
            "edges": self.edges.map(|edges| edges.width),
        })
    }
}
