//! firsthit answers one question, billions of times: *what does this ray meet first?*
//!
//! ```text
//! camera --rays--> shoot --hits--> shade --colours--> image
//!                    ^
//!                  scene
//! ```
//!
//! Two lines make a picture of a file:
//!
//! ```no_run
//! use std::path::Path;
//!
//! use firsthit::load::LoadSettings;
//! use firsthit::{Render, Result, load};
//!
//! fn main() -> Result<()> {
//!     let scene = load(Path::new("part.stl"), &LoadSettings::default())?.into_scene()?;
//!     Render::new(&scene).samples(16).frame()?.save("part.png")
//! }
//! ```
//!
//! The loop over rays, without a picture:
//!
//! ```
//! use firsthit::{Camera, DVec3, Object, Result, Scene, Sphere, shoot};
//!
//! fn main() -> Result<()> {
//!     let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
//!     let camera = Camera::look_at(DVec3::new(0.0, -5.0, 2.0), DVec3::ZERO, DVec3::Z, 45.0, 3, 4)?;
//!     for row in 0..camera.rows() {
//!         for column in 0..camera.columns() {
//!             let ray = camera.ray(row, column);
//!             let hit = shoot(&scene, ray.origin, ray.direction);
//!             println!("{row} {column}: {} {}", hit.t, hit.object);
//!         }
//!     }
//!     Ok(())
//! }
//! ```
//!
//! # The loop
//!
//! 1. A [`Camera`] turns a pixel into a ray: a start `p` and a direction `u_r` of length one.
//! 2. [`shoot()`]`(scene, p, u_r)` finds the first [`Hit`] on it: the parameter `t`, and the object
//!    `o`; a ray that meets nothing has `t` = infinity.
//! 3. [`Shade::shade`]`(t, p, u_r, o)` gives the colour, for misses too.
//! 4. [`render()`] does this for all pixels, with all cores, and stores the colours and other
//!    channels in a [`Frame`](image::Frame); [`Render`] is the same with defaults.
//!
//! Each step can be replaced, and a caller may enter or leave at any arrow.
//! `examples/minimal.rs` is the loop by hand; `ARCHITECTURE.md` says where what is and why.
//!
//! # Poses over time
//!
//! A [`Trajectory`] interpolates the poses of a moving body. The pose of a body is that of a
//! camera, once it is said which axis looks forwards:
//!
//! ```
//! use std::path::Path;
//!
//! use firsthit::trajectory::{BodyAxes, Interpolation, read_csv};
//! use firsthit::{Camera, DVec3, View};
//!
//! let text = b"time,x,y,z,qx,qy,qz,qw\n0,0,0,1,0,0,0,1\n1,5,0,1,0,0,0,1\n";
//! let drive = read_csv(text, Path::new("drive.csv"))?.interpolated(Interpolation::Spline)?;
//! let pose = drive.at(0.2)?.camera(BodyAxes::ForwardsLeftUp);
//! let (aim, up) = (pose.rotation * DVec3::NEG_Z, pose.rotation * DVec3::Y);
//! let camera = Camera::new(View { position: pose.position, aim, up, ..View::default() })?;
//! assert_eq!(camera.position(), DVec3::new(1.0, 0.0, 1.0));
//! assert_eq!(camera.aim(), DVec3::X);
//! # Ok::<(), firsthit::Error>(())
//! ```
//!
//! # Features
//!
//! All are on by default, and none changes a result.
//!
//! | feature | adds |
//! |---|---|
//! | `io` | `fhs`, `gltf`, `obj`, `off`, `ply`, `stl` and `scene-file`, the formats that [`load()`] reads; each is a feature too |
//! | `image` | `exr`, `png`, `npy` (with NPZ) and `cloud` (PLY and PCD), the formats that [`image`] writes; each is a feature too |
//! | `load` | [`mod@load`] and [`world`] without a format; each format that is read enables it |
//! | `frame` | [`channel`], [`image`], [`render()`], [`Render`] and [`scan`] without a format; each of `image`'s formats enables it |
//!
//! `fhs` also writes, and enables `frame`. `scene-file` enables `frame` too, since scene files name
//! their outputs.
//!
//! With `default-features = false` the crate has cameras, shapes, scenes, trees, [`shoot()`] and
//! shaders, and depends on little more than the vector maths and the threads.
//!
//! # The symbols
//!
//! | symbol | in code | meaning |
//! |---|---|---|
//! | `x_c`, `u_c`, `v_up` | `position`, `aim`, `up` | where the camera is, where it looks, which way is up |
//! | `z_p`, `w`, `h` | `focal_length`, `width`, `height` | the viewplane's distance and size, in scene units |
//! | `N`, `M` | `columns`, `rows` | pixels across and down; row 0 is the top one |
//! | `u_x`, `u_y`, `u_z` | [`Camera::right`], [`Camera::upwards`], minus [`Camera::aim`] | the camera's frame, right-handed |
//! | `p`, `u_r` | [`Ray::origin`], [`Ray::direction`] | the ray `p + t * u_r`, `t > 0` |
//! | `t`, `o` | [`Hit::t`], [`Hit::object`] | the ray's parameter, and the object's identifier |

#![forbid(unsafe_code)]

pub mod example;

#[doc(inline)]
pub use firsthit_accel::{accel, shape};
#[doc(inline)]
pub use firsthit_camera::{camera, trajectory};
#[cfg(any(feature = "frame", feature = "load"))]
#[doc(inline)]
pub use firsthit_geometry::inputs;
#[doc(inline)]
pub use firsthit_geometry::{error, geometry, sampling, watch};
#[cfg(feature = "frame")]
#[doc(inline)]
pub use firsthit_image::image;
#[doc(inline)]
pub use firsthit_inspect::{explain, lint, section};
#[cfg(feature = "frame")]
#[doc(inline)]
pub use firsthit_render::{channel, render, scan, sensor};
#[doc(inline)]
pub use firsthit_scene::scene;
#[cfg(feature = "fhs")]
#[doc(inline)]
pub use firsthit_scene_file::fhs;
#[cfg(feature = "scene-file")]
#[doc(inline)]
pub use firsthit_scene_file::scene_file;
#[cfg(feature = "load")]
#[doc(inline)]
pub use firsthit_scene_file::{load, world};
#[doc(inline)]
pub use firsthit_shade::{edge, shade};
#[doc(inline)]
pub use firsthit_shoot::{measure, nearest, shoot};

#[doc(no_inline)]
pub use accel::InstructionSet;
#[doc(no_inline)]
pub use camera::{Camera, Lens, Projection, RayStart, View, Viewplane};
#[doc(no_inline)]
pub use error::{Error, Result};
#[doc(no_inline)]
pub use geometry::{
    Bounds, Color, Departure, DisplayTransform, Filtered, Hit, Ray, RayFilter, Rays, Side,
    SurfaceId, ToneMap, Transform,
};
pub use geometry::{DAffine3, DMat3, DQuat, DVec2, DVec3};
#[cfg(feature = "load")]
#[doc(no_inline)]
pub use load::load;
#[cfg(feature = "frame")]
#[doc(no_inline)]
pub use render::{Render, render};
#[doc(no_inline)]
pub use scene::{AlphaMode, Background, Light, Material, Object, Scene, Texture, TextureMap};
#[doc(no_inline)]
pub use shade::{Shade, Shader, Shading};
#[doc(no_inline)]
pub use shape::{Cone, Cuboid, Cylinder, Disc, Mesh, Plane, Positions, Shape, Sphere};
#[doc(no_inline)]
pub use shoot::{Hits, occluded, shoot};
#[doc(no_inline)]
pub use trajectory::{Pose, Trajectory};
