//! Built scenes. Their checksums of the structure are made right first: no fuzzer would guess them.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut bytes = bytes.to_vec();
    firsthit_fuzz::mend_built_scene(&mut bytes);
    firsthit_fuzz::read("a.fhs", &bytes);
});
