//! Light, judged by closed forms: what rays see, to the digit where nothing is drawn, and on
//! average where something is.

mod emitters;
mod metamorphic;
mod oracles;
mod passage;
mod shadows;

use firsthit::shade::Samples;
use firsthit::shoot::{First, trace};
use firsthit::{Color, Material, Mesh, Object, Positions, Ray, Scene, Shade, Shader, Shading};

fn matte(color: f64) -> Material {
    Material::colored(Color::splat(color))
}

/// A level square in the middle, at that height, whose sides are twice as long as `half`. It faces
/// up.
fn quad(height: f64, half: f64) -> Object {
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
    let corners = corners.map(|[x, y]| [x, y, height]);
    let mesh = Mesh::new(Positions::compact(corners.to_vec()), vec![[0, 1, 2], [0, 2, 3]]);
    Object::new(std::sync::Arc::new(mesh.unwrap()))
}

/// A shader by its name, with some settings.
fn shader(name: &str, settings: &[(&str, f64)]) -> Shader {
    let mut shader = Shader::named(name).unwrap();
    for &(name, value) in settings {
        shader.set(name, firsthit::geometry::Value::Number(value)).unwrap();
    }
    shader
}

/// The mean of so many samples of what each ray sees, and its standard error.
fn seen(shading: &Shading<'_>, rays: &[Ray], samples: u32) -> Vec<(Color, Color)> {
    let hits = trace(shading.scene, rays, First, &()).unwrap();
    let hits: Vec<_> = (0..rays.len()).map(|k| hits.get(k)).collect();
    let pixels: Vec<u64> = (0..rays.len() as u64).collect();
    let mut sums = vec![(Color::ZERO, Color::ZERO); rays.len()];
    for sample in 0..samples {
        let batch = Samples { rays, hits: &hits, pixels: &pixels, sample, cull: None };
        let mut colors = vec![Color::ZERO; rays.len()];
        let mut coverage = vec![1.0; rays.len()];
        shading.shade_all(&batch, &mut colors, &mut coverage);
        for ((sum, squares), color) in sums.iter_mut().zip(colors) {
            *sum += color;
            *squares += color * color;
        }
    }
    let count = f64::from(samples);
    let of = |(sum, squares): (Color, Color)| {
        let mean = sum / count;
        let variance = (squares / count - mean * mean).max(Color::ZERO);
        (mean, (variance / count).map(f64::sqrt))
    };
    sums.into_iter().map(of).collect()
}

/// The means alone.
fn means(scene: &Scene, shader: Shader, rays: &[Ray], samples: u32) -> Vec<Color> {
    let shading = Shading { background: firsthit::Background::default(), ..shader.on(scene) };
    let seen = seen(&shading, rays, samples);
    seen.into_iter().map(|(mean, _)| mean).collect()
}
