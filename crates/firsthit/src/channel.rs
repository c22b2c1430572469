//! What can be asked about hits: the table of output channels.

use rayon::prelude::*;

use crate::sensor::Sensor;
use crate::error::{Error, Result};
use crate::geometry::{Color, DVec3, Hit, Ray, Rays};
use crate::image::{Channel, Data, Description, Picture, Unit};
use crate::memory::{filled, zeroed};
use crate::scene::Scene;
use crate::shade::Shade;
use crate::shoot::Hits;
use crate::watch::Watch;

/// Rays, what they met, and all that channels are made from.
#[derive(Clone, Copy)]
pub struct Shots<'a> {
    /// The scene that was shot at.
    pub scene: &'a Scene,
    /// The rays.
    pub rays: &'a dyn Rays,
    /// What they met.
    pub hits: &'a Hits,
    /// The camera that made the rays, if one did.
    pub camera: Option<&'a Camera>,
}

impl std::fmt::Debug for Shots<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shots")
            .field("rays", &self.rays.len())
            .field("camera", &self.camera)
            .finish_non_exhaustive()
    }
}

/// A kind of output: its name, what it says, and how it is made from hits.
#[derive(Debug)]
pub struct Kind {
    /// The channel's name, in files too.
    pub name: &'static str,
    /// One line for help texts: what it is, its unit, and its value for a miss.
    pub about: &'static str,
    /// Numbers for each ray.
    pub components: usize,
    /// How it becomes a picture.
    pub picture: Picture,
    /// What its numbers count.
    pub unit: Unit,
    /// What its numbers are relative to: `world`, `camera`, `ray`, `triangle` or `texture`.
    pub frame: Option<&'static str>,
    make: Make,
}

#[derive(Debug)]
enum Make {
    /// From a scene, a ray and its hit.
    Doubles(fn(&Scene, &Ray, &Hit, &mut [f64])),
    Integers(fn(&Scene, &Hit) -> i32),
    Flags(fn(&Scene, &Ray, &Hit) -> bool),
    /// From a camera, a row, a column and `t`.
    Distance(fn(&Camera, usize, usize, f64) -> f64),
    /// From a shader.
    Color,
}

/// Every channel. A new one is a new row.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "color",
        about: "linear red, green, blue (Rec. 709); the background for a miss",
        components: 3,
        picture: Picture::Color,
        unit: Unit::LinearColor,
        frame: None,
        make: Make::Color,
    },
    Kind {
        name: "t",
        about: "distance from the ray's start along the ray (in lengths of the direction); inf for a miss",
        components: 1,
        picture: Picture::Distance,
        unit: Unit::DirectionLength,
        frame: Some("ray"),
        make: Make::Doubles(|_, _, hit, out| out[0] = hit.t),
    },
    Kind {
        name: "range",
        about: "distance from the camera's position along the ray; inf for a miss",
        components: 1,
        picture: Picture::Distance,
        unit: Unit::SceneLength,
        frame: Some("camera"),
        make: Make::Distance(Camera::range),
    },
    Kind {
        name: "z",
        about: "distance from the camera's position along its aim; inf for a miss",
        components: 1,
        picture: Picture::Distance,
        unit: Unit::SceneLength,
        frame: Some("camera"),
        make: Make::Distance(Camera::z),
    },
    Kind {
        name: "object",
        about: "identifier of the object; -1 for a miss",
        components: 1,
        picture: Picture::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Integers(|_, hit| hit.object),
    },
    Kind {
        name: "primitive",
        about: "identifier of the object's part, such as the triangle; -1 for a miss",
        components: 1,
        picture: Picture::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Integers(|_, hit| hit.primitive),
    },
    Kind {
        name: "face",
        about: "identifier of the polygon that the triangle was part of; -1 for a miss",
        components: 1,
        picture: Picture::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Integers(Scene::face),
    },
    Kind {
        name: "normal",
        about: "geometric normal in the world, of length one, outwards; NaN for a miss",
        components: 3,
        picture: Picture::Direction,
        unit: Unit::None,
        frame: Some("world"),
        make: Make::Doubles(|scene, ray, hit, out| {
            out.copy_from_slice(&scene.normal(ray, hit).to_array());
        }),
    },
    Kind {
        name: "position",
        about: "where the hit is in the world; NaN for a miss",
        components: 3,
        picture: Picture::Position,
        unit: Unit::SceneLength,
        frame: Some("world"),
        make: Make::Doubles(|scene, ray, hit, out| {
            out.copy_from_slice(&scene.position(ray, hit).to_array());
        }),
    },
    Kind {
        name: "barycentric",
        about: "weights of the triangle's corners 0, 1, 2; NaN for a miss and for other shapes",
        components: 3,
        picture: Picture::Fraction,
        unit: Unit::None,
        frame: Some("triangle"),
        make: Make::Doubles(|_, _, hit, out| {
            let [b, c] = hit.barycentric.to_array();
            out.copy_from_slice(&[1.0 - b - c, b, c]);
        }),
    },
    Kind {
        name: "uv",
        about: "texture coordinates; NaN for a miss and where there are none",
        components: 2,
        picture: Picture::Fraction,
        unit: Unit::None,
        frame: Some("texture"),
        make: Make::Doubles(|scene, _, hit, out| out.copy_from_slice(&scene.uv(hit).to_array())),
    },
    Kind {
        name: "front",
        about: "whether the front of the surface was met; false for a miss",
        components: 1,
        picture: Picture::Mask,
        unit: Unit::None,
        frame: None,
        make: Make::Flags(|scene, ray, hit| scene.is_front(ray, scene.normal(ray, hit))),
    },
];

/// The kind of that name.
///
/// # Errors
///
/// [`Error::Argument`] for a name that no kind has.
pub fn kind(name: &str) -> Result<&'static Kind> {
    let names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
    KINDS.iter().find(|kind| kind.name == name).ok_or_else(|| {
        Error::argument(
            "channel",
            "a channel's name",
            format!("{name:?}; there are {}", names.join(", ")),
        )
    })
}

impl Kind {
    /// Whether it takes a camera: rays from elsewhere do not have it.
    pub fn needs_camera(&self) -> bool {
        matches!(self.make, Make::Distance(_))
    }

    /// Whether it takes a shader.
    pub fn needs_shade(&self) -> bool {
        matches!(self.make, Make::Color)
    }

    /// The channel, by all threads of the current rayon pool. `shade` is called for the `color` channel, and `watch`
    /// is told of every ray once.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] when it does not fit into memory, [`Error::Argument`] for a channel that needs a
    /// camera where there is none, [`Error::Interrupted`] when `watch` stops it.
    pub fn make(&self, shots: &Shots<'_>, shade: &dyn Shade, watch: &dyn Watch) -> Result<Channel> {
        let Shots {
            scene, rays, hits, ..
        } = *shots;
        let count = rays.len();
        let data = match self.make {
            Make::Doubles(value) => {
                let mut values = filled(count.saturating_mul(self.components), f64::NAN)?;
                each(&mut values, self.components, watch, |k, out| {
                    value(scene, &rays.ray(k), &hits.get(k), out);
                })?;
                Data::Float64(values)
            }
            Make::Integers(value) => {
                let mut values = filled(count, -1)?;
                each(&mut values, 1, watch, |k, out| {
                    out[0] = value(scene, &hits.get(k));
                })?;
                Data::Int32(values)
            }
            Make::Flags(value) => {
                let mut values = filled(count, false)?;
                each(&mut values, 1, watch, |k, out| {
                    out[0] = value(scene, &rays.ray(k), &hits.get(k));
                })?;
                Data::Bool(values)
            }
            Make::Distance(value) => {
                let camera = shots.camera.ok_or_else(|| {
                    Error::argument("channel", "one that rays without a camera have", self.name)
                })?;
                let columns = camera.columns();
                let mut values = filled(count, f64::INFINITY)?;
                each(&mut values, 1, watch, |k, out| {
                    out[0] = value(camera, k / columns, k % columns, hits.t[k]);
                })?;
                Data::Float64(values)
            }
            Make::Color if shade.is_transparent() => {
                return Ok(self.transparent_channel(colors::<4>(shots, shade, watch)?));
            }
            Make::Color => colors::<3>(shots, shade, watch)?,
        };
        Ok(self.channel(data))
    }

    /// The channel of colours before a transparent background: four components, of which the last is the coverage (alpha).
    pub fn transparent_channel(&self, data: Data) -> Channel {
        let mut channel = self.channel(data);
        channel.components = 4;
        channel.description.about = "linear red, green, blue (Rec. 709), premultiplied by coverage; coverage (alpha); 0 for a miss";
        channel
    }

    /// The channel of this kind with `data`, which [`Frame::push`](crate::image::Frame::push) checks.
    pub fn channel(&self, data: Data) -> Channel {
        Channel {
            name: self.name,
            components: self.components,
            data,
            picture: self.picture,
            description: Description {
                about: self.about,
                unit: self.unit,
                frame: self.frame,
            },
        }
    }
}

/// How many rays a thread takes at a time, for channels other than colours.
const MADE: usize = 1 << 12;

/// Fills `values`, `components` for each ray, with all threads of the current rayon pool; few rays by the calling thread alone.
fn each<T: Send>(
    values: &mut [T],
    components: usize,
    watch: &dyn Watch,
    fill: impl Fn(usize, &mut [T]) + Sync,
) -> Result<()> {
    let size = MADE * components;
    let chunk = |(chunk, values): (usize, &mut [T])| {
        if watch.is_stopped() {
            return Err(Error::Interrupted);
        }
        let rays = values.chunks_mut(components).enumerate();
        rays.for_each(|(k, out)| fill(chunk * MADE + k, out));
        watch.advance((values.len() / components) as u64);
        Ok(())
    };
    if values.len() <= size {
        values.chunks_mut(size).enumerate().try_for_each(chunk)
    } else {
        values.par_chunks_mut(size).enumerate().try_for_each(chunk)
    }
}

/// How many pixels are shaded at a time: many enough for their shadow rays to go together, few enough for slow shaders.
pub(crate) const SHADED: usize = 256;

/// `N` numbers for each ray: red, green, blue, and with `N` = 4 the coverage, 1 for a hit and 0 for a miss.
fn colors<const N: usize>(shots: &Shots<'_>, shade: &dyn Shade, watch: &dyn Watch) -> Result<Data> {
    let mut values = zeroed::<f32>(shots.rays.len().saturating_mul(N))?;
    values
        .par_chunks_mut(N * SHADED)
        .enumerate()
        .try_for_each(|(chunk, out)| {
            if watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            let (first, count) = (chunk * SHADED, out.len() / N);
            let mut rays = vec![Ray::new(DVec3::ZERO, DVec3::ZERO); count];
            shots.rays.read(first, &mut rays);
            let hits = shots.hits.part(first..first + count);
            let mut colors = vec![Color::ZERO; count];
            shade.shade_all(&rays, &hits, &mut colors);
            let numbers = colors.into_iter().zip(&hits.t);
            for ((color, &t), out) in numbers.zip(out.chunks_mut(N)) {
                let covered = f64::from(u8::from(t < f64::INFINITY));
                out.copy_from_slice(&single_of::<N>(color, covered));
            }
            watch.advance(count as u64);
            Ok(())
        })?;
    Ok(Data::Float32(values))
}

/// A colour as it is stored: three numbers, or four with the coverage.
#[expect(
    clippy::cast_possible_truncation,
    reason = "colours are stored as float32"
)]
pub(crate) fn single_of<const N: usize>(color: Color, covered: f64) -> [f32; N] {
    let all = [color.x, color.y, color.z, covered];
    std::array::from_fn(|k| all[k] as f32)
}
