//! The loop by hand: a camera makes a ray for each pixel, `shoot` finds what it meets first,
//! `shade` gives the colour. Prints the picture as text; `cargo run --release --example minimal`.

use firsthit::{
    Camera, Color, DVec3, Hit, Lens, Object, Plane, Result, Scene, Shade, Sphere, View, Viewplane,
    shoot,
};

fn main() -> Result<()> {
    let scene = Scene::new(vec![
        Object::new(Sphere::new(DVec3::new(0.0, 0.0, 1.0), 1.0)?).named("ball"),
        Object::new(Plane::new(DVec3::ZERO, DVec3::Z)?).named("ground"),
    ])?;
    let camera = Camera::new(View {
        position: DVec3::new(0.0, -6.0, 2.0),
        aim: DVec3::new(0.0, 1.0, -0.2),
        up: DVec3::Z,
        rows: 30,
        columns: 80,
        lens: Lens::Flat(Viewplane {
            focal_length: 1.0,
            width: 1.2,
            height: 0.9,
            ..Viewplane::default()
        }),
    })?;

    // Brighter where the surface faces a light, darker with the distance; misses get the
    // background.
    let shade = |t: f64, p: DVec3, u_r: DVec3, o: &Hit| {
        if t == f64::INFINITY {
            return Color::ZERO;
        }
        let ray = firsthit::Ray::new(p, u_r);
        let light = DVec3::new(-0.5, -0.5, 0.7);
        Color::splat(
            scene
                .interaction(&ray, o)
                .map_or(DVec3::NAN, |surface| surface.normal())
                .dot(light)
                .max(0.1)
                * libm::exp(-0.05 * t),
        )
    };

    for row in 0..camera.rows() {
        for column in 0..camera.columns() {
            let ray = camera.ray(row, column);
            let (p, u_r) = (ray.origin, ray.direction);
            let hit = shoot(&scene, p, u_r);
            let color = shade.shade(hit.t, p, u_r, &hit);
            print!("{}", glyph(color));
        }
        println!();
    }
    Ok(())
}

/// A character about as bright as a colour.
fn glyph(color: Color) -> char {
    const GLYPHS: [char; 10] = [' ', '.', ':', '-', '=', '+', '*', '#', '%', '@'];
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast of a float saturates"
    )]
    let brightness = (color.x * 10.0) as usize;
    GLYPHS[brightness.min(9)]
}
