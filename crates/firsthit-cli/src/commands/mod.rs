//! A file per command.

use crate::failure::Failure;

pub(crate) mod build;
mod cloud;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod diff;
pub(crate) mod in_python;
pub(crate) mod info;
mod info_environment;
mod info_las;
pub(crate) mod info_looks;
mod info_output;
mod info_solids;
pub(crate) mod inside;
pub(crate) mod lint;
mod list;
mod listing;
pub(crate) mod nearest;
pub(crate) mod probe;
pub(crate) mod render;
pub(crate) mod scan;
mod scanner;
pub(crate) mod schema;
pub(crate) mod section;
pub(crate) mod shoot;
mod shoot_stream;
mod shot;
mod sinks;
pub(crate) mod thickness;
pub(crate) mod view;
pub(crate) mod visible;

/// The ends of rays, by --t-min and --t-max.
fn ends(t_min: Option<f64>, t_max: Option<f64>) -> Result<(f64, f64), Failure> {
    let (t_min, t_max) = (t_min.unwrap_or(0.0), t_max.unwrap_or(f64::INFINITY));
    if t_min >= t_max {
        return Err(Failure::usage("--t-max must be above --t-min, which is 0 if not given"));
    }
    Ok((t_min, t_max))
}
