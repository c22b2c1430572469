//! OBJ files with a material library beside them, `a.mtl`: what follows a line `#mtl`.
#![no_main]

use firsthit_fuzz::Folder;

const MARK: &[u8] = b"\n#mtl\n";

thread_local!(static FOLDER: Folder = Folder::default());

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    match bytes.windows(MARK.len()).position(|window| window == MARK) {
        None => firsthit_fuzz::read("a.obj", bytes),
        Some(end) => FOLDER.with(|folder| {
            folder.put("a.obj", &bytes[..end]);
            folder.put("a.mtl", &bytes[end + MARK.len()..]);
            folder.read("a.obj");
        }),
    }
});
