//! Points of clouds, told by their first bytes. What LASzip packs stays out: its reader panics,
//! which is caught, but not here.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let is_packed =
        bytes.starts_with(b"LASF") && bytes.get(104).is_some_and(|format| format & 0x80 != 0);
    if !is_packed {
        firsthit_fuzz::read_points(bytes);
    }
});
