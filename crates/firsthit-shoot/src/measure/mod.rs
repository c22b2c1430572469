//! Solids: which points are inside objects, how much of rays is, and how thick they are.
//!
//! The inside is decided in one place for all of them; the caller chooses a [`FillRule`].

mod paths;
mod thickness;

pub use paths::{path_lengths, path_lengths_with};
pub use thickness::{Towards, thickness, thickness_along, thickness_with};

pub use crate::solid::{
    Containment, FillRule, Grouping, Rule, innermost, inside, inside_with, rules, rules_with,
    winding_number,
};
