//! The channels of each output file, settled before any work is done.

mod channels;
mod paths;
mod targets;
mod write;

pub(crate) use channels::{ChannelSource, has, kinds};
pub(crate) use paths::{check_files, check_orders, check_other, check_paths};
pub(crate) use targets::{Order, Target, check_all_go_somewhere, clouds, names, orders, targets};
pub(crate) use write::{as_json, say_legends, stream, write};
