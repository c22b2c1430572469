//! A picture of a file in a few lines: `cargo run --release --example picture -- part.stl`.

use std::path::Path;

use firsthit::load::{LoadSettings, load};
use firsthit::{Render, Result};

fn main() -> Result<()> {
    let file = std::env::args().nth(1);
    let file = file.unwrap_or_else(|| "testdata/cube_binary.stl".to_owned());
    let scene = load(Path::new(&file), &LoadSettings::default())?.into_scene()?;
    println!("{scene:?}");
    let frame = Render::new(&scene).frame()?;
    frame.save("picture.png")
}
