//! Outputs read back: EXR, PNG, NPZ or NPY, told by their first bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let name = match bytes {
        [0x76, 0x2f, 0x31, 0x01, ..] => "a.exr",
        [0x89, b'P', ..] => "a.png",
        [b'P', b'K', ..] => "a.npz",
        _ => "a.npy",
    };
    firsthit_fuzz::read_output(name, bytes);
});
