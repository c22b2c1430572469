//! Pictures for a page.

use std::io::Write;
use std::sync::Arc;

use firsthit::channel::{self, ChannelKind};
use firsthit::edge::Edges;
use firsthit::geometry::{Value, rotation};
use firsthit::image::{self, Channel, Data, Frame, WriteSettings};
use firsthit::render::Picture;
use firsthit::scene::{Colored, Daylight, DirectionalLight, Environment, EnvironmentKind, Light};
use firsthit::sensor::Sensor;
use firsthit::shade::{Appearance, LightRig, SAMPLES, Shade, Shader};
use firsthit::shoot::Cpu;
use firsthit::watch::Watch;
use firsthit::{Camera, Color, DVec3, Error, Result, Scene};
use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::cap::CappedShade;
use crate::cut::{CutCamera, CutPlane};
use crate::look::{EnvironmentChoice, EnvironmentRequest, FrameRequest};
use crate::viewer::{ProgressiveState, Viewer, color_of};

/// The state of a picture of more pixels is not kept: each takes some forty bytes.
const MOST_KEPT: usize = 1 << 22;

/// The diameter of the sun that a page moves, in degrees.
const SUN: f64 = 2.0;

/// The default elevation and azimuth of daylight's sun, in degrees.
const SUN_ELEVATION: f64 = 40.0;
const SUN_AZIMUTH: f64 = -60.0;

/// The radiance of a white surface that faces it: with the light that fills its shadows, no more
/// than white.
const SUNLIGHT: f64 = 0.75;

/// A picture that a page paints.
#[derive(Debug, Clone, PartialEq)]
pub struct Painted {
    /// Pixels down and across.
    pub shape: [usize; 2],
    /// The number of samples of a pixel.
    pub samples: u32,
    /// The samples of the same picture when it is lit and the request leaves their number open.
    pub full_samples: u32,
    /// The numbers of the first and the last colour, where surfaces are coloured by numbers.
    pub range: Option<[f64; 2]>,
    /// The pixels.
    pub pixels: Pixels,
}

/// The pixels of a picture, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Pixels {
    /// Colours, as a PNG.
    Png(Vec<u8>),
    /// The numbers of a channel, to be coloured by the page.
    Values {
        /// The numbers of a pixel.
        components: usize,
        /// `float32` or `int32`.
        dtype: &'static str,
        /// The numbers, little endian, as a zlib stream.
        bytes: Vec<u8>,
    },
}

impl Viewer {
    /// A picture that a page asks for, until the watch stops it. Lit colours are those that
    /// `firsthit render` makes of the same camera, to the byte. Where the last picture was the same
    /// with fewer samples, only the others are made; one that was interrupted begins anew.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a look that makes no sense, [`Error::Limit`] where memory does not
    /// suffice, and [`Error::Interrupted`].
    pub fn frame(&self, look: &FrameRequest, watch: &dyn Watch) -> Result<Painted> {
        if look.samples == Some(0) {
            return Err(Error::argument("samples", "at least 1", 0));
        }
        let camera = look.camera.camera()?;
        let kind = channel::kind(&look.channel)?;
        let scene = self.lit(look)?;
        let resolved = self.appearance_of(look)?.resolve(&scene, Some(&camera))?;
        let shading = resolved.shading(Cpu::shared());
        let range = resolved.scene.colored().map(Colored::range);
        let plane = look.part.cut.as_ref().map(CutPlane::new).transpose()?;
        let cut = plane.map(|plane| CutCamera { camera: &camera, plane });
        let sensor: &dyn Sensor = match &cut {
            Some(cut) => cut,
            None => &camera,
        };
        let face = look.cut_color.map(|color| color_of("cut_color", color));
        let face = face.transpose()?;
        let capped = plane.map(|plane| CappedShade::new(&shading, &resolved.scene, (plane, face)));
        let shade: &dyn Shade = match &capped {
            Some(capped) => capped,
            None => &shading,
        };
        let kinds: [&ChannelKind; 1] = [kind];
        let picture = Picture {
            samples: resolved.samples,
            edges: self.edges_of(look)?,
            ..Picture::new(&resolved.scene, sensor, shade, &kinds)
        };
        let frame = if kind.is_color() && look.is_lit {
            self.continued(&picture, look, watch)?
        } else {
            picture.render(watch)?
        };
        if let Some(capped) = &capped {
            capped.check()?;
        }
        let pixels = if kind.is_color() {
            let mut bytes = Vec::new();
            let png = image::format_named("png")?;
            let settings = WriteSettings { display: self.display, ..WriteSettings::default() };
            png.encode(&frame, None, settings, &mut bytes, "memory".as_ref())?;
            Pixels::Png(bytes)
        } else {
            values(&frame.channels()[0])?
        };
        Ok(Painted {
            shape: [look.camera.rows, look.camera.columns],
            samples: if kind.is_color() { resolved.samples } else { 1 },
            full_samples: self.full_samples(look, &scene, &camera)?,
            range: range.filter(|_| kind.is_color()),
            pixels,
        })
    }

    /// See [`Painted::full_samples`].
    fn full_samples(&self, look: &FrameRequest, scene: &Scene, camera: &Camera) -> Result<u32> {
        let full = FrameRequest { is_lit: true, samples: None, ..look.clone() };
        let resolved = self.appearance_of(&full)?.resolve(scene, Some(camera))?;
        Ok(resolved.samples)
    }

    /// Makes a picture's samples one after the other, from where the last one ended if that is the
    /// same.
    fn continued(
        &self,
        picture: &Picture<'_>,
        look: &FrameRequest,
        watch: &dyn Watch,
    ) -> Result<Frame> {
        let asked = FrameRequest { samples: None, ..look.clone() };
        let mut progressive = match self.take_begun(&asked, picture.samples) {
            Some(begun) => picture.resume(&begun.state)?,
            None => picture.start()?,
        };
        while progressive.samples() < picture.samples {
            progressive.add_sample(watch)?;
        }
        let pixels = look.camera.rows.saturating_mul(look.camera.columns);
        if pixels <= MOST_KEPT {
            self.keep_begun(ProgressiveState {
                request: asked,
                samples: progressive.samples(),
                state: progressive.state()?,
            });
        }
        progressive.frame()
    }

    /// The lines along edges that are asked for.
    fn edges_of(&self, look: &FrameRequest) -> Result<Option<Edges>> {
        let usual = self.edges.unwrap_or_default();
        let edges = match look.edges {
            Some(0.0) => None,
            Some(width) => Some(Edges { width, ..usual }),
            None => self.edges,
        };
        // They are found on whole surfaces.
        if look.part.cut.is_some() && look.edges.is_some() && edges.is_some() {
            return Err(Error::argument("edges", "0 with a cut", "both"));
        }
        Ok(edges.filter(|_| look.is_lit && look.part.cut.is_none()))
    }

    /// The part of the scene that is asked for, in the light that is.
    fn lit(&self, look: &FrameRequest) -> Result<Arc<Scene>> {
        let scene = self.scene_of(&look.part, &look.colors)?;
        let asked = look.sun.is_some() || look.environment.is_some();
        if !asked || !look.is_lit {
            return Ok(scene);
        }
        let sun = look.sun.map(|sun| direction("sun", sun)).transpose()?;
        let environment = match &look.environment {
            Some(request) => self.environment(request, scene.up(), sun)?,
            None => None,
        };
        let day = environment.as_ref().and_then(Environment::sun);
        let scene = scene.try_clone()?.with_environment(environment.map(Arc::new));
        let lights = match (day, sun) {
            (Some(sun), _) => vec![sun],
            (None, Some(direction)) => vec![Light::Directional(DirectionalLight {
                direction,
                color: Color::splat(SUNLIGHT),
                angle_degrees: SUN,
            })],
            (None, None) => return Ok(Arc::new(scene)),
        };
        Ok(Arc::new(scene.with_lights(lights)))
    }

    /// The light from all around that is asked for.
    fn environment(
        &self,
        request: &EnvironmentRequest,
        up: DVec3,
        sun: Option<DVec3>,
    ) -> Result<Option<Environment>> {
        let EnvironmentRequest { choice, strength, turn } = *request;
        if !turn.is_finite() {
            return Err(Error::argument("turn", "a finite angle", turn));
        }
        let environment = match choice {
            EnvironmentChoice::None => return Ok(None),
            EnvironmentChoice::Own => {
                let Some(own) = self.scene().environment() else {
                    return Ok(None);
                };
                let mut own = own.clone();
                if let EnvironmentKind::Map { world_from_map, .. } = &mut own.kind {
                    *world_from_map = rotation(up, turn) * *world_from_map;
                }
                own.strength *= strength;
                own
            }
            EnvironmentChoice::Daylight => {
                let (haze, ground) = (Daylight::CLEAR, Daylight::GROUND);
                let daylight = match sun {
                    Some(direction) => Daylight::with_sun_towards(up, -direction, haze, ground)?,
                    None => Daylight::new(up, SUN_ELEVATION, SUN_AZIMUTH, haze, ground)?,
                };
                Environment { strength, ..Environment::new(EnvironmentKind::Daylight(daylight)) }
            }
        };
        environment.check()?;
        Ok(Some(environment))
    }

    /// The appearance of a picture: as `firsthit render` would make it, or lit from the camera and
    /// without shadows, which is soon done. So are the faces that a cut opens: in the shadow of
    /// what was cut away they would be black.
    fn appearance_of(&self, look: &FrameRequest) -> Result<Appearance> {
        let mut appearance = self.appearance.clone();
        let rig = look.light.as_deref().map(str::parse).transpose()?;
        appearance.samples = look.samples.or(appearance.samples);
        if look.is_lit && look.part.cut.is_none() {
            let choice = look.environment.map(|request| request.choice);
            if look.sun.is_some() || choice == Some(EnvironmentChoice::Daylight) {
                appearance.rig = None;
            } else {
                appearance.rig = rig.or(appearance.rig);
            }
            appearance.ground = look.ground.or(appearance.ground);
        } else {
            let mut shader = Shader::named("lambert")?;
            shader.set("shadows", Value::Flag(false))?;
            appearance.shader = Some(shader);
            appearance.rig = Some(LightRig::Headlight);
            appearance.ground = Some(false);
            let samples = look.samples.unwrap_or(SAMPLES);
            appearance.samples = Some(if look.is_lit { samples } else { 1 });
        }
        Ok(appearance)
    }
}

/// A direction that a page gives.
fn direction(name: &'static str, given: [f64; 3]) -> Result<DVec3> {
    let direction = DVec3::from(given);
    if !direction.is_finite() || direction == DVec3::ZERO {
        let expected = "a finite direction other than zero";
        return Err(Error::argument(name, expected, format!("{given:?}")));
    }
    Ok(direction)
}

/// The numbers of a channel: of float64 the nearest float32.
fn values(channel: &Channel) -> Result<Pixels> {
    let (dtype, plain): (_, Vec<u8>) = match &channel.data {
        Data::Float64(numbers) => {
            #[expect(clippy::cast_possible_truncation, reason = "a page shows colours of them")]
            let each = numbers.iter().map(|&x| x as f32);
            ("float32", each.flat_map(f32::to_le_bytes).collect())
        }
        Data::Float32(numbers) => {
            let each = numbers.iter().copied();
            ("float32", each.flat_map(f32::to_le_bytes).collect())
        }
        Data::Int32(numbers) => {
            let each = numbers.iter().copied();
            ("int32", each.flat_map(i32::to_le_bytes).collect())
        }
        Data::Bool(flags) => {
            let each = flags.iter().map(|&flag| i32::from(flag));
            ("int32", each.flat_map(i32::to_le_bytes).collect())
        }
    };
    // All at once: number by number the packer takes five times as long.
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
    let written = packed.write_all(&plain).and_then(|()| packed.finish());
    let bytes =
        written.map_err(|error| Error::argument("frame", "one that can be packed", error))?;
    Ok(Pixels::Values { components: channel.components, dtype, bytes })
}
