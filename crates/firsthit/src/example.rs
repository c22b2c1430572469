//! The embedded example: a scene that shows every shape, and the camera that looks at it.

use std::sync::Arc;

use crate::camera::{Camera, View};
use crate::error::Result;
use crate::geometry::{Color, DAffine3, DQuat, DVec3, Transform};
use crate::scene::{Background, Light, Object, Scene};
use crate::shape::{Attribute, Cone, Cuboid, Cylinder, Disc, Mesh, Plane, Positions, Sphere};

/// The example's scene, in metres, z upwards: a knot on a pedestal with everything else around it.
///
/// # Errors
///
/// None that its constants could cause.
pub fn scene() -> Result<Scene> {
    let knot = Arc::new(knot(360, 36)?);
    let at = |x, y, z, scale: f64, turn: f64| {
        let turn = DQuat::from_axis_angle(DVec3::Z, turn);
        Transform::new(DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            turn,
            DVec3::new(x, y, z),
        ))
    };
    let mirrored = DAffine3::from_scale_rotation_translation(
        DVec3::new(-0.2, 0.2, 0.2),
        DQuat::from_axis_angle(DVec3::X, 1.2),
        DVec3::new(1.05, -1.6, 0.32),
    );
    let (sand, teal, coral) = (
        Color::new(0.62, 0.55, 0.45),
        Color::new(0.08, 0.38, 0.42),
        Color::new(0.75, 0.2, 0.12),
    );
    let (gold, cream, blue) = (
        Color::new(0.8, 0.5, 0.1),
        Color::new(0.75, 0.7, 0.6),
        Color::new(0.1, 0.2, 0.5),
    );
    let sun = DVec3::new(-0.35, 0.9, -0.2);
    let objects = vec![
        Object::new(Plane::new(DVec3::ZERO, DVec3::Z)?)
            .named("ground")
            .colored(sand),
        Object::new(Cylinder::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 0.6), 0.75)?)
            .named("pedestal")
            .colored(cream),
        Object::new(Arc::clone(&knot))
            .named("knot")
            .placed(at(0.0, 0.0, 1.42, 0.52, 0.4)?)
            .colored(Color::ONE),
        Object::new(Sphere::new(DVec3::new(-1.7, -0.5, 0.55), 0.55)?)
            .named("sphere")
            .colored(coral),
        Object::new(Cuboid::new(
            DVec3::new(-0.5, -0.5, 0.0),
            DVec3::new(0.5, 0.5, 1.0),
        )?)
        .named("box")
        .placed(at(1.75, 0.6, 0.0, 0.9, 0.5)?)
        .colored(teal),
        Object::new(Cone::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 1.1), 0.5, 0.0)?)
            .named("cone")
            .placed(at(-0.75, -1.6, 0.0, 0.75, 0.0)?)
            .colored(gold),
        Object::new(Cone::new(
            DVec3::ZERO,
            DVec3::new(0.0, 0.0, 0.5),
            0.45,
            0.25,
        )?)
        .named("cone without a tip")
        .placed(at(1.75, 0.6, 0.9, 0.8, 0.0)?)
        .colored(cream),
        Object::new(Disc::new(DVec3::new(-1.5, 2.4, 1.6), -sun, 1.25)?)
            .named("disc")
            .colored(blue),
        Object::new(knot)
            .named("mirrored knot")
            .placed(Transform::new(mirrored)?)
            .colored(Color::ONE),
    ];
    let sun = Light::Directional {
        direction: DVec3::new(0.55, 0.75, -0.9),
        color: Color::new(0.95, 0.88, 0.75),
    };
    Ok(Scene::new(objects)?.with_lights(vec![sun]))
}

/// The example's camera.
///
/// # Errors
///
/// [`Error::Argument`](crate::Error::Argument) for a picture without pixels.
pub fn camera(rows: usize, columns: usize) -> Result<Camera> {
    let (position, target) = (DVec3::new(1.1, -6.2, 2.6), DVec3::new(0.0, 0.0, 0.95));
    let view = View {
        position,
        up: DVec3::Z,
        rows,
        columns,
        ..View::default()
    };
    Camera::new(view.aimed_at(target).with_vertical_fov(34.0)?)
}

/// The example's sky.
pub fn background() -> Background {
    Background::Gradient {
        horizon: Color::new(0.72, 0.78, 0.82),
        zenith: Color::new(0.12, 0.28, 0.6),
        up: DVec3::Z,
    }
}

/// A tube around the trefoil knot, in the colours of the rainbow: `along` rings of `around` corners.
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
    let mut colors = Vec::new();
    for ring in 0..along {
        let forwards = line((ring + 1) % along) - line((ring + along - 1) % along);
        let across = forwards.cross(line(ring)).normalize();
        let upwards = across.cross(forwards).normalize();
        for corner in 0..around {
            let a = angle(corner, around);
            points.push(
                (line(ring) + 0.27 * (libm::cos(a) * across + libm::sin(a) * upwards)).to_array(),
            );
            colors.push(rainbow(angle(ring, along)));
        }
    }
    let corner = |ring: u32, corner: u32| (ring % along) * around + corner % around;
    let quad = |(r, c)| {
        [
            corner(r, c),
            corner(r + 1, c),
            corner(r + 1, c + 1),
            corner(r, c + 1),
        ]
    };
    let quads = (0..along)
        .flat_map(|r| (0..around).map(move |c| (r, c)))
        .map(quad);
    let triangles = quads
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Mesh::new(Positions::compact(points), triangles)?.with_colors(Attribute::per_vertex(colors))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "colours are stored as float32"
)]
fn rainbow(angle: f64) -> [f32; 3] {
    [0.0, 2.1, 4.2].map(|shift| (0.45 + 0.35 * libm::cos(angle + shift)) as f32)
}
