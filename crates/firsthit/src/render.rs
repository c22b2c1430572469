//! The loop: camera, shoot, shade, image.

mod settings;

pub use settings::{Look, Render};

use rayon::prelude::*;

use crate::camera::{Aim, Camera, Description, StandardView};
use crate::channel::{Kind, SHADED, Shots, single_of};
use crate::error::{Error, Result};
use crate::geometry::{Color, DVec3, Ray};
use crate::image::{Data, Frame, Origin};
use crate::memory::filled;
use crate::sampling::offset;
use crate::scene::{Background, Light, Scene};
use crate::sensor::Sensor;
use crate::shade::Shade;
use crate::shoot::{First, Hits, trace};
use crate::watch::Watch;

/// A picture of `scene`: a frame with the `channels`, row 0 at the top.
///
/// With more than one of `samples`, a pixel's colour is the mean over that many points of it; all other
/// channels are those of the pixel's centre. The result does not depend on the number of threads.
///
/// ```
/// use firsthit::{Camera, DVec3, Object, Scene, Shader, Sphere, channel, render};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let camera = Camera::look_at(DVec3::new(0.0, -5.0, 2.0), DVec3::ZERO, DVec3::Z, 45.0, 30, 40)?;
/// let channels = [channel::kind("color")?, channel::kind("z")?];
/// let shade = Shader::named("normal")?.on(&scene);
/// let frame = render(&scene, &camera, &shade, &channels, 1, &())?;
/// assert!(frame.channel("z").is_some());
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`] for no samples, [`Error::Limit`] when the picture does not fit into memory,
/// [`Error::Interrupted`] when `watch` stops it.
pub fn render(
    scene: &Scene,
    camera: &Camera,
    shade: &dyn Shade,
    channels: &[&Kind],
    samples: u32,
    watch: &dyn Watch,
) -> Result<Frame> {
    check_samples(samples)?;
    let hits = trace(scene, camera, First, watch)?;
    develop(scene, camera, &hits, shade, channels, samples, watch)
}

/// The second half of [`render`], from the hits of the camera's rays on.
///
/// # Errors
///
/// Those of [`render`], and [`Error::Argument`] when there are not as many hits as pixels.
pub fn develop(
    scene: &Scene,
    camera: &Camera,
    hits: &Hits,
    shade: &dyn Shade,
    channels: &[&Kind],
    samples: u32,
    watch: &dyn Watch,
) -> Result<Frame> {
    check_samples(samples)?;
    if hits.len() != camera.pixels() {
        return Err(Error::argument("hits", "one for each pixel", hits.len()));
    }
    let shots = Shots {
        scene,
        rays: camera,
        hits,
        camera: Some(camera),
    };
    let mut frame = Frame::new([camera.rows(), camera.columns()]).from_origin(origin(
        scene,
        Some(camera),
        Some(samples),
    ));
    for kind in channels {
        frame.push(if kind.needs_shade() && samples > 1 {
            if shade.is_transparent() {
                let data = antialiased::<4>(scene, camera, shade, samples, watch)?;
                kind.transparent_channel(data)
            } else {
                kind.channel(antialiased::<3>(scene, camera, shade, samples, watch)?)
            }
        } else {
            kind.make(&shots, shade, watch)?
        })?;
    }
    Ok(frame)
}

fn check_samples(samples: u32) -> Result<()> {
    if samples == 0 {
        return Err(Error::argument("samples", "at least 1", samples));
    }
    Ok(())
}

/// How many rays [`develop`] reports to its watch in all. [`render`] reports `pixels` more, for the hits.
pub fn work(pixels: usize, channels: &[&Kind], samples: u32) -> u64 {
    let points = |kind: &&Kind| {
        if kind.needs_shade() {
            u64::from(samples)
        } else {
            1
        }
    };
    let each: u64 = channels.iter().map(points).sum();
    (pixels as u64).saturating_mul(each)
}

/// The colours, each the mean over `samples` points of its pixel. With `N` = 4 the last number is the coverage: the share of
/// the points that hit something.
fn antialiased<const N: usize>(
    scene: &Scene,
    camera: &Camera,
    shade: &dyn Shade,
    samples: u32,
    watch: &dyn Watch,
) -> Result<Data> {
    let mut colors = filled(camera.pixels().saturating_mul(N), 0.0_f32)?;
    // The pixels whose samples make one batch: neighbouring rays traverse the tree together.
    let pixels = (SHADED / samples as usize).max(1);
    colors
        .par_chunks_mut(N * pixels)
        .enumerate()
        .try_for_each(|(chunk, out)| {
            let first = chunk * pixels;
            let mut sums = vec![(Color::ZERO, 0.0); out.len() / N];
            let points = sums.len() * samples as usize;
            // In parts: of one pixel there may be any number of points.
            for start in (0..points).step_by(SHADED) {
                if watch.is_stopped() {
                    return Err(Error::Interrupted);
                }
                let part = start..points.min(start + SHADED);
                #[expect(clippy::cast_possible_truncation, reason = "less than samples")]
                let of_point =
                    |point: usize| (point / samples as usize, (point % samples as usize) as u32);
                let ray = |point: usize| {
                    let (pixel, k) = of_point(point);
                    sample_ray(camera, first + pixel, k, samples)
                };
                let rays: Vec<Ray> = part.clone().map(ray).collect();
                let hits = trace(scene, &rays, First, &())?;
                let mut seen = vec![Color::ZERO; rays.len()];
                shade.shade_all(&rays, &hits, &mut seen);
                for ((point, color), &t) in part.zip(seen).zip(&hits.t) {
                    let (sum, covered) = &mut sums[of_point(point).0];
                    *sum += color;
                    *covered += f64::from(u8::from(t < f64::INFINITY));
                }
                watch.advance(rays.len() as u64);
            }
            let count = f64::from(samples);
            for ((sum, covered), out) in sums.into_iter().zip(out.chunks_mut(N)) {
                out.copy_from_slice(&single_of::<N>(sum / count, covered / count));
            }
            Ok(())
        })?;
    Ok(Data::Float32(colors))
}

/// What outputs say about where they come from: the scene's fingerprint and the camera, if one made the
/// rays. `samples` are the points of a pixel that its colour is the mean of, if there are colours.
pub fn origin(scene: &Scene, camera: Option<&Camera>, samples: Option<u32>) -> Origin {
    Origin {
        scene: Some(scene.fingerprint().to_owned()),
        camera: camera.map(Sensor::record),
        samples,
    }
}

/// The ray through sample point `k` of `count` in a pixel, pixels counted row by row from the top. The only
/// point of a pixel is its centre.
pub fn sample_ray(camera: &Camera, pixel: usize, k: u32, count: u32) -> Ray {
    let within = offset(pixel as u64, k, count);
    camera.ray_within(pixel / camera.columns(), pixel % camera.columns(), within)
}

/// The default number of samples per pixel.
pub const SAMPLES: u32 = 4;

/// The default background of pictures.
pub const BACKGROUND: Background = Background::NEUTRAL;

/// The default camera: a perspective one, with a vertical field of view of 45 degrees, in which a standard view of `scene` fills
/// a picture of `rows` and `columns`, with `up` upwards. An empty or infinite scene counts as the box from -1 to 1.
///
/// ```
/// use firsthit::{DVec3, Object, Scene, Sphere, camera::StandardView, render::framing_camera};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let camera = framing_camera(&scene, DVec3::Z, StandardView::Front, [480, 640])?;
/// assert_eq!(camera.aim(), DVec3::Y);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`] for an `up` that is zero or not finite, for no rows or columns, and for a scene too far away to be framed.
pub fn framing_camera(
    scene: &Scene,
    up: DVec3,
    view: StandardView,
    [rows, columns]: [usize; 2],
) -> Result<Camera> {
    let description = Description {
        aim: Some(Aim::View(view)),
        rows: Some(rows),
        columns: Some(columns),
        ..Description::default()
    };
    description.camera(scene.bounds(), |direction| scene.support(direction), up)
}

/// The light of pictures that have none of their own: parallel, from behind the camera's left shoulder.
pub fn shoulder_light(camera: &Camera) -> Light {
    Light::Directional {
        direction: camera.aim() + 0.45 * camera.right() - 0.6 * camera.upwards(),
        color: Color::splat(0.95),
    }
}
