//! The lines along edges that a scene file asks for.

use super::section::Section;
use super::table::{Form, Pick, Record, Rule, Variant, keys, optional};
use crate::edge::{Dash, EdgeKind, EdgeKinds, Edges};
use crate::io::fault::Checked;

pub(super) static EDGES: Record = Record {
    name: "edges",
    about: "Lines along edges, over the colours.",
    variants: &[Variant {
        pick: Pick::Always,
        keys: &[keys! {
            /// Line width in pixels; lines narrower than a pixel are fainter. Default: 1.
            width: optional(Form::UpTo(Edges::WIDEST)),
            /// The angle between the normals of two adjacent faces above which their edge is a crease, in degrees. Default: 30.
            angle: optional(Form::From(0.0, 180.0)),
            /// The kinds of edges that are drawn. Default: ["silhouette", "crease", "boundary", "material"].
            kinds: optional(Form::SomeOf(|| EdgeKind::NAMES.to_vec(), None)),
            /// Whether occluded lines are drawn, dashed. Default: false.
            hidden: optional(Form::Boolean),
            /// The length of a dash in pixels, at least 0.1. Default: 6.
            dash: optional(Form::From(Dash::SHORTEST, Edges::WIDEST)),
            /// The length of the gap after a dash in pixels, at least 0.1. Default: 4.
            gap: optional(Form::From(Dash::SHORTEST, Edges::WIDEST)),
            /// Line colour. Default: black.
            color: optional(Form::Color),
        }],
        rules: &[Rule::Needs("dash", "hidden"), Rule::Needs("gap", "hidden")],
    }],
};

/// The lines that a file asks for, if it does.
pub(super) fn read(scene: &Section<'_, '_>) -> Checked<Option<Edges>> {
    let Some(section) = scene.table("edges", &EDGES)? else {
        return Ok(None);
    };
    let usual = Edges::default();
    let names = section.items("kinds").filter_map(|item| item.as_str());
    let kinds = if section.has("kinds") {
        section.checked(EdgeKinds::named(names))?
    } else {
        usual.kinds
    };
    let Dash { on, off } = Dash::default();
    let dash = Dash {
        on: section.number("dash").unwrap_or(on),
        off: section.number("gap").unwrap_or(off),
    };
    let is_hidden = section.boolean("hidden").unwrap_or(false);
    Ok(Some(Edges {
        width: section.number("width").unwrap_or(usual.width),
        angle: section.number("angle").unwrap_or(usual.angle),
        kinds,
        hidden: is_hidden.then_some(dash),
        color: section.color("color").unwrap_or(usual.color),
    }))
}
