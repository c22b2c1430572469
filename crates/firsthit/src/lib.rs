//! firsthit answers one question, billions of times: *what does this ray meet first?*
//!
//! ```text
//! camera --rays--> shoot --hits--> shade --colours--> image
//!                    ^
//!                  scene
//! ```
//!
//! 1. A [`Camera`] turns a pixel into a ray: a start `p` and a direction `u_r` of length one.
//! 2. [`shoot()`]`(scene, p, u_r)` finds the first [`Hit`] on it: the parameter `t`, and the object `o`; a
//!    ray that meets nothing has `t` = infinity.
//! 3. [`Shade::shade`]`(t, p, u_r, o)` gives the colour, for misses too.
//! 4. [`render`](render::render) does this for all pixels, with all cores, and stores the colours and whatever else
//!    was asked for in a [`Frame`](image::Frame).
//!
//! Each step can be replaced, and a caller may enter or leave at any arrow.
//! `examples/minimal.rs` is the loop by hand; `ARCHITECTURE.md` says where what is and why.
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

pub mod accel;
pub mod camera;
pub mod channel;
pub mod error;
pub mod example;
pub mod geometry;
pub mod image;
pub mod io;
mod memory;
pub mod render;
mod sampling;
pub mod scene;
pub mod shade;
pub mod shape;
pub mod shoot;
mod simd;
pub mod watch;

pub use accel::InstructionSet;
pub use camera::{Camera, Projection, RayStart, View};
pub use error::{Error, Result};
pub use geometry::{
    Bounds, Color, DAffine3, DMat3, DQuat, DVec2, DVec3, Hit, Ray, Rays, Transform,
};
pub use render::render;
pub use scene::{AlphaMode, Background, Light, Material, Object, Scene, Texture, TextureMap};
pub use shade::{Shade, Shader, Shading};
pub use shape::{Cone, Cuboid, Cylinder, Disc, Mesh, Plane, Positions, Shape, Sphere};
pub use shoot::{Hits, occluded, shoot};
