//! OFF files.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| firsthit_fuzz::read("a.off", bytes));
