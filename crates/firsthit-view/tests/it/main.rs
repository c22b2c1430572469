//! The viewer as pages meet it: what they ask of frames, and the server over real sockets.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on panics")]

mod frame;
mod server;
