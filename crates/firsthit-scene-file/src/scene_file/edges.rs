//! The lines along edges that a scene file asks for.

use super::section::Section;
use super::table::{Form, Key, Pick, Record, Rule, keys, optional, record};
use crate::edge::{Dash, EdgeKind, EdgeKinds, Edges};
use crate::geometry::Domain;
use crate::io::fault::Checked;

/// Settings that all lines have.
pub(super) const LINES: &[Key] = keys! {
    /// Line width in pixels; lines narrower than a pixel are fainter. Default: 1.
    width: optional(Form::Of(Domain::UpTo(Edges::WIDEST))),
    /// The angle between the normals of two adjacent faces above which their edge is a crease, in
    /// degrees. Default: 30.
    angle: optional(Form::Of(Domain::From(0.0, 180.0))),
    /// Line colour. Default: black.
    color: optional(Form::COLOR),
};

pub(super) static EDGES: Record = record! {
    "edges", "Lines along edges, over the colours.";
    Pick::Always => [LINES, keys! {
        /// The kinds of edges that are drawn. Default: ["silhouette", "crease", "boundary",
        /// "material"].
        kinds: optional(Form::Array(&Form::OneOf(|| EdgeKind::NAMES.to_vec()), 1, usize::MAX)),
        /// Whether occluded lines are drawn, dashed. Default: false.
        hidden: optional(Form::FLAG),
        /// The length of a dash in pixels, at least 0.1. Default: 6.
        dash: optional(Form::Of(Domain::From(Dash::SHORTEST, Edges::WIDEST))),
        /// The length of the gap after a dash in pixels, at least 0.1. Default: 4.
        gap: optional(Form::Of(Domain::From(Dash::SHORTEST, Edges::WIDEST))),
    }] [Rule::Needs("dash", "hidden"), Rule::Needs("gap", "hidden")];
};

/// The lines that a file asks for, if it does.
pub(super) fn read(scene: &Section<'_, '_>) -> Checked<Option<Edges>> {
    let Some(section) = scene.table("edges", &EDGES)? else {
        return Ok(None);
    };
    let usual = Edges::default();
    let names = section.items("kinds").filter_map(|item| item.as_str());
    let kinds =
        if section.has("kinds") { section.checked(EdgeKinds::named(names))? } else { usual.kinds };
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
