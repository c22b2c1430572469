//! Pictures as textures: of PNG, JPEG, WebP, BMP, TIFF and GIF the bytes tell the format, all else
//! counts as TGA.
#![no_main]

use firsthit_fuzz::Folder;

thread_local!(static FOLDER: Folder = {
    let folder = Folder::default();
    folder.put("a.obj", b"mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    folder.put("a.mtl", b"newmtl m\nmap_Kd a.tga\n");
    folder
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    FOLDER.with(|folder| {
        folder.put("a.tga", bytes);
        folder.read("a.obj");
    });
});
