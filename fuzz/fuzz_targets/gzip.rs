//! Files packed by gzip.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| firsthit_fuzz::read("a.stl.gz", bytes));
