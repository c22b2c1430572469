//! glTF files: text or GLB, told by their first bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let is_binary = bytes.starts_with(b"glTF");
    firsthit_fuzz::read(if is_binary { "a.glb" } else { "a.gltf" }, bytes);
});
