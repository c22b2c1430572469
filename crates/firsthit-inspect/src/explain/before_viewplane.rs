//! Objects between a camera's eye and its viewplane, where rays that start on the viewplane do not
//! meet them.

use std::collections::BTreeSet;

use crate::camera::{Camera, RayStart};
use crate::scene::Scene;
use crate::shoot::{Cpu, Engine};

/// Rays tried for each row and column, at most.
const PROBES: usize = 128;

/// Objects that a camera does not see because its rays start on the viewplane; see
/// [`before_viewplane`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct BeforeViewplane {
    /// The number of objects that a grid of rays from the eye meets first, before the viewplane.
    pub objects: usize,
    /// Whether the same rays meet nothing from the viewplane on.
    pub is_all: bool,
}

/// The objects that a camera passes by because they lie between its eye and its viewplane, where
/// its rays start. It is asked of a grid of at most 128 x 128 of its pixels, and of none where the
/// box around the scene is behind the viewplane.
///
/// ```
/// use firsthit::explain::before_viewplane;
/// use firsthit::{Camera, DVec3, Lens, Object, Scene, Sphere, View, Viewplane};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// // As of a lens of 1500 pixels whose viewplane is meant to be in units of the scene.
/// let viewplane = Viewplane { focal_length: 1500.0, width: 640.0, height: 480.0, ..Viewplane::default() };
/// let view = View { position: DVec3::new(0.0, 0.0, 5.0), lens: Lens::Flat(viewplane), ..View::default() };
/// let passed = before_viewplane(&scene, &Camera::new(view)?);
/// assert!(passed.objects == 1 && passed.is_all);
/// # Ok::<(), firsthit::Error>(())
/// ```
pub fn before_viewplane(scene: &Scene, camera: &Camera) -> BeforeViewplane {
    let nothing = BeforeViewplane::default();
    let Some(viewplane) = camera.lens().viewplane() else {
        return nothing;
    };
    if viewplane.ray_start == RayStart::Eye {
        return nothing;
    }
    let depths = (scene.bounds().corners()).map(|at| (at - camera.position()).dot(camera.aim()));
    let is_upright = viewplane.tilt.abs().max_element() == 0.0;
    // Written so that the NaN of a plane without an end is looked at.
    if is_upright && depths.iter().all(|&depth| depth > viewplane.focal_length) {
        return nothing;
    }
    let steps = |count: usize| (0..count).step_by(count.div_ceil(PROBES));
    let pixels = || {
        steps(camera.rows())
            .flat_map(|row| steps(camera.columns()).map(move |column| (row, column)))
    };
    let engine = Cpu::default();
    let from_eye = camera.starting_at(RayStart::Eye);
    let met = pixels().filter_map(|(row, column)| {
        // The range where t is zero is the way from the eye to the viewplane.
        let to_viewplane = camera.range(row, column, 0.0);
        let ray = from_eye.ray(row, column).up_to(to_viewplane);
        let hit = engine.first_hit(scene, &ray);
        (hit.object >= 0).then_some(hit.object)
    });
    let objects = met.collect::<BTreeSet<_>>().len();
    let is_seen = |(row, column)| engine.any_hit(scene, &camera.ray(row, column));
    BeforeViewplane { objects, is_all: objects > 0 && !pixels().any(is_seen) }
}
