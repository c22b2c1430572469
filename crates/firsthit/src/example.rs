//! The embedded example: a scene that shows every shape, and the camera that looks at it.

use std::sync::Arc;

use crate::camera::{Camera, FovAxis, Lens, RayStart, View, Viewplane};
use crate::error::Result;
use crate::geometry::{Color, DAffine3, DQuat, DVec3, Transform, single};
use crate::scene::{Background, DirectionalLight, Object, Scene};
use crate::shape::{
    Attribute, Cone, Cuboid, Cylinder, Disc, Mesh, Plane, Positions, Shape, Sphere,
};

/// The example's scene, in metres, z upwards: a knot on a pedestal with every other shape around
/// it.
///
/// # Errors
///
/// None that its constants could cause.
pub fn scene() -> Result<Scene> {
    let knot = Arc::new(knot(360, 36)?);
    let mut objects = Vec::from(stage()?);
    objects.extend(solids()?);
    let upright =
        placed(DVec3::splat(0.62), DQuat::from_rotation_z(0.5), DVec3::new(0.0, 0.0, 1.08))?;
    // The same triangles again: the colours run the other way round.
    let mirrored = placed(
        DVec3::new(-0.24, 0.24, 0.24),
        DQuat::from_rotation_x(1.25),
        DVec3::new(1.2, -1.45, 0.36),
    )?;
    objects.extend([
        object("knot", Arc::clone(&knot), Color::ONE).placed(upright),
        object("mirrored knot", knot, Color::ONE).placed(mirrored),
    ]);
    let sun = DirectionalLight {
        direction: DVec3::new(0.6, 0.75, -0.8),
        color: Color::new(0.95, 0.86, 0.7),
        angle_degrees: 0.0,
    };
    Ok(Scene::new(objects)?.with_lights(vec![sun.into()]))
}

/// The ground, the pedestal and the disc behind it.
fn stage() -> Result<[Object; 3]> {
    let ground = Plane::new(DVec3::ZERO, DVec3::Z)?;
    let pedestal = Cylinder::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 0.6), 0.95)?;
    let disc = Disc::new(DVec3::new(-0.75, 2.6, 1.45), DVec3::new(0.15, -1.0, 0.0), 1.45)?;
    Ok([
        object("ground", ground, Color::new(0.5, 0.47, 0.42)),
        object("pedestal", pedestal, Color::new(0.7, 0.66, 0.58)),
        object("disc", disc, Color::new(0.85, 0.28, 0.1)),
    ])
}

/// The shapes that stand around: three spheres, a box, a cone, and one without a tip.
fn solids() -> Result<Vec<Object>> {
    let ball = |x, y, radius, color| {
        let sphere = Sphere::new(DVec3::new(x, y, radius), radius)?;
        Ok(object("sphere", sphere, color))
    };
    let cuboid = Cuboid::new(DVec3::new(-0.5, -0.5, 0.0), DVec3::new(0.5, 0.5, 1.0))?;
    let turned =
        placed(DVec3::splat(0.95), DQuat::from_rotation_z(0.5), DVec3::new(2.05, 0.7, 0.0))?;
    let cone = Cone::new(DVec3::new(-1.0, -1.5, 0.0), DVec3::new(-1.0, -1.5, 0.95), 0.38, 0.0)?;
    let cut = Cone::new(DVec3::new(2.05, 0.7, 0.95), DVec3::new(2.05, 0.7, 1.4), 0.38, 0.22)?;
    Ok(vec![
        ball(-2.0, -0.35, 0.6, Color::new(0.1, 0.35, 0.6))?,
        ball(-1.75, -1.35, 0.22, Color::new(0.75, 0.72, 0.65))?,
        ball(-0.1, -1.8, 0.16, Color::new(0.7, 0.12, 0.12))?,
        object("box", cuboid, Color::new(0.07, 0.42, 0.4)).placed(turned),
        object("cone", cone, Color::new(0.85, 0.55, 0.08)),
        object("cone without a tip", cut, Color::new(0.75, 0.7, 0.6)),
    ])
}

fn object(name: &str, shape: impl Into<Shape>, color: Color) -> Object {
    Object::new(shape).named(name).colored(color)
}

fn placed(scale: DVec3, turn: DQuat, offset: DVec3) -> Result<Transform> {
    Transform::new(DAffine3::from_scale_rotation_translation(scale, turn, offset))
}

/// The example's camera.
///
/// # Errors
///
/// [`Error::Argument`](crate::error::Error::Argument) for a picture without pixels.
pub fn camera(rows: usize, columns: usize) -> Result<Camera> {
    let (position, target) = (DVec3::new(0.7, -6.4, 1.75), DVec3::new(0.05, 0.0, 1.0));
    let lens = Lens::Flat(Viewplane {
        ray_start: RayStart::Viewplane,
        ..Viewplane::with_fov(32.0, FovAxis::Vertical, rows, columns)?
    });
    let view = View { position, up: DVec3::Z, rows, columns, lens, ..View::default() };
    Camera::new(view.aimed_at(target))
}

/// The example's sky.
pub fn background() -> Background {
    let (horizon, zenith) = (Color::new(0.85, 0.8, 0.72), Color::new(0.02, 0.1, 0.45));
    Background::Gradient { horizon, zenith, up: DVec3::Z }
}

/// A tube around the trefoil knot, in the colours of the rainbow: `along` rings of `around`
/// corners.
fn knot(along: u32, around: u32) -> Result<Mesh> {
    let angle = |k: u32, count: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
    let line = |k: u32| {
        let a = angle(k, along);
        let radius = 1.0 + 0.45 * libm::cos(3.0 * a);
        DVec3::new(
            radius * libm::cos(2.0 * a),
            radius * libm::sin(2.0 * a),
            0.5 * libm::sin(3.0 * a),
        )
    };
    let mut points = Vec::new();
    let (mut normals, mut colors) = (Vec::new(), Vec::new());
    for ring in 0..along {
        let forwards = line((ring + 1) % along) - line((ring + along - 1) % along);
        let across = forwards.cross(line(ring)).normalize();
        let upwards = across.cross(forwards).normalize();
        for corner in 0..around {
            let a = angle(corner, around);
            let outwards = libm::cos(a) * across + libm::sin(a) * upwards;
            points.push((line(ring) + 0.27 * outwards).to_array());
            normals.push(outwards.as_vec3().to_array());
            colors.push(rainbow(angle(ring, along)));
        }
    }
    let corner = |ring: u32, corner: u32| (ring % along) * around + corner % around;
    let quad = |(r, c)| [corner(r, c), corner(r + 1, c), corner(r + 1, c + 1), corner(r, c + 1)];
    let quads = (0..along).flat_map(|r| (0..around).map(move |c| (r, c))).map(quad);
    let triangles = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(Positions::compact(points), triangles)?
        .with_normals(Attribute::per_vertex(normals))?
        .with_colors(Attribute::per_vertex(colors))
}

fn rainbow(angle: f64) -> [f32; 3] {
    [0.0, 2.1, 4.2].map(|shift| single(0.45 + 0.35 * libm::cos(angle + shift)))
}
