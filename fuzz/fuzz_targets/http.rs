//! Requests to the viewer's server, one after the other, as a connection has them.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut rest = bytes;
    // It reads at most what is there, and each request takes some of it.
    let requests = firsthit_view::server::requests(&mut rest);
    assert!(requests <= bytes.len() / 16 + 1);
});
