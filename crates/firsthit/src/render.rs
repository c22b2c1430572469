//! The loop: camera, shoot, shade, image.

use rayon::prelude::*;

use crate::camera::Camera;
use crate::channel::{Kind, Shots, single};
use crate::error::{Error, Result};
use crate::geometry::{Color, DVec2};
use crate::image::{Channel, Data, Frame};
use crate::sampling::offset;
use crate::scene::Scene;
use crate::shade::Shade;
use crate::shoot::{Hits, filled, shoot, shoot_all};
use crate::watch::Watch;

/// A picture of `scene`: a frame with the `channels`, row 0 at the top.
///
/// With more than one of `samples`, a pixel's colour is the mean over that many points of it; all other
/// channels are those of the pixel's centre. The result does not depend on the number of threads.
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
    let hits = shoot_all(scene, camera, watch)?;
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
    if samples == 0 {
        return Err(Error::argument("samples", "at least 1", samples));
    }
    if hits.len() != camera.pixels() {
        return Err(Error::argument("hits", "one for each pixel", hits.len()));
    }
    let shots = Shots {
        scene,
        rays: camera,
        hits,
        camera: Some(camera),
    };
    let mut frame = Frame::new([camera.rows(), camera.columns()]);
    for kind in channels {
        frame.push(if kind.needs_shade() && samples > 1 {
            antialiased(scene, camera, shade, kind, samples, watch)?
        } else {
            kind.make(&shots, shade, watch)?
        })?;
    }
    Ok(frame)
}

/// The colours, each the mean over `samples` points of its pixel.
fn antialiased(
    scene: &Scene,
    camera: &Camera,
    shade: &dyn Shade,
    kind: &Kind,
    samples: u32,
    watch: &dyn Watch,
) -> Result<Channel> {
    let columns = camera.columns();
    let mut colors = filled(camera.pixels().saturating_mul(3), 0.0_f32)?;
    let see = |row: usize, column: usize, within: DVec2| {
        let ray = camera.ray_within(row, column, within);
        let hit = shoot(scene, ray.origin, ray.direction);
        shade.shade(hit.t, ray.origin, ray.direction, &hit)
    };
    colors
        .par_chunks_mut(3)
        .with_min_len(64)
        .enumerate()
        .try_for_each(|(pixel, out)| {
            if watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            let (row, column) = (pixel / columns, pixel % columns);
            let sum: Color = (0..samples)
                .map(|k| see(row, column, offset(pixel as u64, k, samples)))
                .sum();
            out.copy_from_slice(&single(sum / f64::from(samples)));
            watch.advance(u64::from(samples));
            Ok(())
        })?;
    let data = Data::Float32(colors);
    Ok(Channel {
        name: kind.name,
        components: kind.components,
        data,
        picture: kind.picture,
    })
}
