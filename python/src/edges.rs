//! Lines along edges, to the library and back.

use firsthit::edge::{Dash, EdgeKind, EdgeKinds, Edges};
use pyo3::prelude::*;

use crate::errors::Outcome;

/// Width, angle, the names of kinds, the lengths of dashes and gaps of what is hidden, and the
/// colour.
pub(crate) type EdgesOut = (f64, f64, Vec<&'static str>, Option<[f64; 2]>, [f64; 3]);

/// The edges on their way in.
#[derive(FromPyObject)]
pub(crate) struct EdgesIn(f64, f64, Vec<String>, Option<[f64; 2]>, [f64; 3]);

impl EdgesIn {
    pub(crate) fn edges(&self) -> firsthit::Result<Edges> {
        let Self(width, angle, kinds, hidden, color) = self;
        let edges = Edges {
            width: *width,
            angle: *angle,
            kinds: EdgeKinds::named(kinds.iter().map(|name| &**name))?,
            hidden: hidden.map(|[on, off]| Dash { on, off }),
            color: (*color).into(),
        };
        edges.check().map(|()| edges)
    }
}

pub(crate) fn edges_out(edges: &Edges) -> EdgesOut {
    let hidden = edges.hidden.map(|dash| [dash.on, dash.off]);
    let color = edges.color.to_array();
    (edges.width, edges.angle, edges.kinds.names(), hidden, color)
}

/// Every kind of edge, and the default lines; those of what is hidden have the lengths of dashes
/// and gaps then.
#[pyfunction]
pub(crate) fn edge_defaults() -> (Vec<&'static str>, EdgesOut) {
    let usual = Edges { hidden: Some(Dash::default()), ..Edges::default() };
    (EdgeKind::NAMES.to_vec(), edges_out(&usual))
}

/// Refuses lines that cannot be drawn.
#[pyfunction]
pub(crate) fn check_edges(edges: EdgesIn) -> Outcome<()> {
    edges.edges()?;
    Ok(())
}
