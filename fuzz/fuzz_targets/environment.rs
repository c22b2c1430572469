//! Environment maps: Radiance's or OpenEXR's, told by their first bytes.
#![no_main]

use firsthit_fuzz::Folder;

thread_local!(static FOLDER: Folder = {
    let folder = Folder::default();
    folder.put("a.toml", b"[environment]\nfile = \"a.hdr\"\nrotate = 30\n");
    folder
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    FOLDER.with(|folder| {
        folder.put("a.hdr", bytes);
        folder.read("a.toml");
    });
});
