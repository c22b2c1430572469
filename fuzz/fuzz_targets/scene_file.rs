//! Scene files, beside a mesh, `a.ply`, that they may name.
#![no_main]

use firsthit_fuzz::Folder;

const MESH: &[u8] =
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

thread_local!(static FOLDER: Folder = {
    let folder = Folder::default();
    folder.put("a.ply", MESH);
    folder
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| FOLDER.with(|folder| {
    folder.put("a.toml", bytes);
    folder.read("a.toml");
}));
