//! The native half of the Python package: conversion only, no mathematics. Its words are those of
//! the library; everything that a user sees is in `python/firsthit/`.

#![allow(clippy::needless_pass_by_value, reason = "arguments from Python arrive by value")]

mod arrays;
mod attributes;
mod camera;
mod colors;
mod edges;
mod environment;
mod errors;
mod explain;
mod filters;
mod frame;
mod lint;
mod load;
mod material;
mod measure;
mod nearest;
mod plan;
mod run;
mod scan;
mod scene;
mod section;
mod sensor;
mod sensor_rays;
mod shading;
mod shape;
mod shoot;
mod trajectory;
mod view;

use pyo3::prelude::*;

/// The native module `firsthit._firsthit`.
#[pymodule]
mod _firsthit {
    use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError, PyValueError};
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::attributes::{attribute, attribute_names};
    #[pymodule_export]
    use crate::camera::{Camera, check_pose, orthonormalised, rotation};
    #[pymodule_export]
    use crate::colors::color_names;
    #[pymodule_export]
    use crate::edges::{check_edges, edge_defaults};
    #[pymodule_export]
    use crate::environment::{EnvironmentMap, check_environment, environment_radiance, sun_of};
    #[pymodule_export]
    use crate::errors::escaped;
    #[pymodule_export]
    use crate::explain::{before_viewplane, explain};
    #[pymodule_export]
    use crate::filters::visible;
    #[pymodule_export]
    use crate::frame::{
        Accumulated, begin_run, check_samples, defaults, idle, idle_in_files, is_input, matte_id,
        metadata, note_input, origin, png, read, read_points, render, render_more, render_work,
        sampling, write, write_bytes,
    };
    #[pymodule_export]
    use crate::lint::{Lint, lint_kinds};
    #[pymodule_export]
    use crate::load::{Objects, load, open, save, units};
    #[pymodule_export]
    use crate::material::{Texels, check_material, meant_as_levels, named_color, srgb_levels};
    #[pymodule_export]
    use crate::measure::{inside, path_lengths, rules, thickness};
    #[pymodule_export]
    use crate::nearest::{closest_points, signed_distances};
    #[pymodule_export]
    use crate::plan::{place_in_plan, plan_file, read_plan};
    #[pymodule_export]
    use crate::run::all_threads;
    #[pymodule_export]
    use crate::scan::{
        ScanSettings, join_scans, read_scan, scan_columns, scan_extensions, scan_metadata,
        write_scan,
    };
    #[pymodule_export]
    use crate::scene::{Scene, check_transforms};
    #[pymodule_export]
    use crate::section::Section;
    #[pymodule_export]
    use crate::sensor::{Pattern, Sensor};
    #[pymodule_export]
    use crate::sensor_rays::{distances_of_pixels, rays_of_pixels, rays_of_rows};
    #[pymodule_export]
    use crate::shading::{check_light, check_shader, draws, resolve, shader_settings};
    #[pymodule_export]
    use crate::shape::{Mesh, Shape, polygons};
    #[pymodule_export]
    use crate::shoot::{channel, channel_names, count, occluded, shoot, shoot_all, shoot_camera};
    #[pymodule_export]
    use crate::trajectory::{Trajectory, axes_from};
    #[pymodule_export]
    use crate::view::{PageServer, Viewer};

    #[pymodule_init]
    #[expect(clippy::unnecessary_wraps, reason = "as PyO3 calls it")]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::run::silence_panics();
        Ok(())
    }

    /// The version of the library.
    #[pyfunction]
    fn version() -> &'static str {
        env!("CARGO_PKG_VERSION")
    }

    /// The instruction set that new scenes are traced with.
    #[pyfunction]
    fn instruction_set() -> crate::errors::Outcome<&'static str> {
        Ok(firsthit::InstructionSet::current()?.name())
    }

    /// The answer of the program's command info about a file, as JSON.
    #[pyfunction]
    fn info(py: Python<'_>, path: std::path::PathBuf) -> Result<String, PyErr> {
        let told = py.detach(|| firsthit_cli::info(&path));
        told.map_err(|(code, message)| match code {
            3 => crate::errors::of_file("FileFormatError", py, (&path, String::new()), message),
            5 => PyMemoryError::new_err(message),
            130 => PyKeyboardInterrupt::new_err(()),
            _ => PyValueError::new_err(message),
        })
    }

    /// Runs the command line program and returns its exit code.
    #[pyfunction]
    fn run_program(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
        py.detach(|| firsthit_cli::run(arguments))
    }
}
