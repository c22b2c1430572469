//! Lines along edges.

use serde::{Deserialize, Serialize};

use super::super::number::{Number, Triple};
use crate::edge::{Dash, EdgeKinds, Edges};
use crate::error::Result;

/// Lines along edges.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EdgesRecord {
    width: Number,
    angle: Number,
    kinds: Vec<String>,
    /// The lengths of dashes and gaps.
    hidden: Option<[Number; 2]>,
    color: Triple,
}

impl EdgesRecord {
    pub(super) fn new(edges: &Edges) -> Self {
        let names = edges.kinds.names().into_iter();
        Self {
            width: Number(edges.width),
            angle: Number(edges.angle),
            kinds: names.map(str::to_owned).collect(),
            hidden: edges.hidden.map(|dash| [Number(dash.on), Number(dash.off)]),
            color: edges.color.into(),
        }
    }

    pub(super) fn edges(&self) -> Result<Edges> {
        let dash = |[Number(on), Number(off)]: [Number; 2]| Dash { on, off };
        let edges = Edges {
            width: self.width.0,
            angle: self.angle.0,
            kinds: EdgeKinds::named(self.kinds.iter().map(|name| &**name))?,
            hidden: self.hidden.map(dash),
            color: self.color.into(),
        };
        edges.check().map(|()| edges)
    }
}
