//! The program as its users have it: every test runs the binary.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on panics, in its helpers too")]

mod attributes;
mod built;
mod camera;
mod camera_files;
mod channels;
mod clouds;
mod colours;
mod edges;
mod environment;
mod far;
mod files;
mod gltf;
mod golden;
mod info;
mod inside;
mod interrupts;
mod issue;
mod json;
mod legend;
mod lights;
mod lines;
mod lint;
mod list;
mod nearest;
mod numbers;
mod outputs;
mod picking;
mod points;
mod probe;
mod progressive;
mod rays;
mod reading;
mod scan;
mod scene_file;
mod section;
mod shoot;
mod support;
mod usage;
mod view;
mod views;
