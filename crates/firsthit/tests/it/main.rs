//! The library's integration tests, a module for each subject. They are one program, because each
//! further program would link the whole library again.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "a test may panic, and its numbers are small"
)]

mod architecture;
mod attributes;
mod camera;
mod closed;
mod coloring;
mod crossings;
mod crowds;
mod cryptomatte;
mod display;
mod edges;
mod environment;
mod exact;
mod explain;
mod fhs;
mod filters;
mod framing;
mod gltf;
mod hidden;
mod image;
mod io_cut;
mod io_formats;
mod io_hostile;
mod io_meanings;
mod io_off;
mod io_polygons;
mod io_regressions;
mod joined;
mod judge;
mod kernels;
mod lens_round_trips;
mod lenses;
mod light;
mod lint;
mod manifest;
mod measure;
mod names;
mod nearest;
mod newcomers;
mod open;
mod oracle;
mod outputs;
mod overlaps;
mod point_clouds;
mod precision;
mod progressive;
mod rays;
mod read_points;
mod render;
mod samples;
mod scene_changes;
mod scene_file;
mod section;
mod see_through;
mod sensors;
mod shading;
mod shading_rows;
mod solids;
mod steps;
mod support;
mod thin_lens;
