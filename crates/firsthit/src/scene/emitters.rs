//! Surfaces that shine, as lights.

use super::light::{Light, LightSample, SphereLight};
use super::{Object, Scene, SurfaceInteraction};
use crate::geometry::{DVec2, DVec3, Hit, Ray, SurfaceId, luminance};
use crate::sampling::distribution::Distribution;
use crate::sampling::warp;
use crate::shape::{Mesh, Shape};

/// The surfaces of a scene that shine: triangles and spheres, drawn in proportion to their area and luminance. They shine on both
/// sides.
#[derive(Debug, Clone)]
pub(crate) struct Emitters {
    surfaces: Vec<SurfaceId>,
    /// Their powers: area times luminance.
    powers: Option<Distribution>,
    total: f64,
    /// Whether others shine too, which are not drawn: rays have to find them.
    has_others: bool,
}

impl Emitters {
    /// Those of a scene.
    pub(super) fn new(scene: &Scene) -> Self {
        let (mut surfaces, mut powers) = (Vec::new(), Vec::new());
        let mut has_others = false;
        for (object, number) in scene.objects().iter().zip(0..) {
            if object.is_hidden() || !object.shines() {
                continue;
            }
            let mut push = |primitive, area: f64| {
                let power = area * brightness(object, primitive);
                if power > 0.0 && power < f64::INFINITY {
                    let object = number;
                    surfaces.push(SurfaceId { object, primitive });
                    powers.push(power);
                } else if power == f64::INFINITY {
                    has_others = true;
                }
            };
            match object.shape() {
                Shape::Mesh(mesh) => {
                    for (triangle, primitive) in (0..mesh.triangles().len()).zip(0..) {
                        push(primitive, area(corners(object, mesh, triangle)));
                    }
                }
                Shape::Sphere(_) => match sphere(object) {
                    Some(SphereLight { radius, .. }) => {
                        push(0, 4.0 * std::f64::consts::PI * radius * radius);
                    }
                    None => has_others = true,
                },
                _ => has_others = true,
            }
        }
        let total = powers.iter().sum();
        Self {
            surfaces,
            powers: Distribution::new(powers),
            total,
            has_others,
        }
    }

    /// Whether there are any to draw.
    pub(crate) fn is_empty(&self) -> bool {
        self.powers.is_none()
    }

    /// Whether surfaces shine that are not drawn.
    pub(crate) fn has_others(&self) -> bool {
        self.has_others
    }

    /// Light that arrives at a point, from a surface and a point of it that three numbers from 0 to 1 stand for.
    pub(crate) fn sample(
        &self,
        scene: &Scene,
        at: DVec3,
        [pick, x, y]: [f64; 3],
    ) -> Option<(LightSample, SurfaceId)> {
        let powers = self.powers.as_ref()?;
        let index = powers.choose(pick).index;
        let (surface, share) = (self.surfaces[index], powers.share(index));
        let object = &scene.objects()[usize::try_from(surface.object).ok()?];
        let u = DVec2::new(x, y);
        let (towards, barycentric, pdf) = if let Shape::Mesh(mesh) = object.shape() {
            let triangle = usize::try_from(surface.primitive).ok()?;
            let [a, b, c] = corners(object, mesh, triangle);
            let weights = warp::triangle(u);
            let towards = a + (weights.x * (b - a) + weights.y * (c - a)) - at;
            let normal = (b - a).cross(c - a);
            let pdf = 1.0 / (0.5 * normal.length());
            let cosine = towards.dot(normal).abs() / (towards.length() * normal.length());
            (towards, weights, pdf * towards.length_squared() / cosine)
        } else {
            let arriving = Light::from(sphere(object)?).sample(at, u)?;
            (arriving.towards, DVec2::ZERO, arriving.pdf?)
        };
        if let Shape::Mesh(mesh) = object.shape()
            && object.is_cut_out(mesh, usize::try_from(surface.primitive).ok()?, barycentric)
        {
            return None;
        }
        let hit = Hit {
            t: 1.0,
            object: surface.object,
            primitive: surface.primitive,
            barycentric,
        };
        let ray = Ray::new(at, towards);
        let met = scene.interaction(&ray, &hit)?;
        let pdf = share * pdf;
        let light = met.opacity() * met.emitted() / (std::f64::consts::PI * pdf);
        // Written so that a NaN fails.
        (light.max_element() > 0.0 && light.is_finite()).then_some((
            LightSample {
                towards,
                distance: 1.0,
                light,
                pdf: Some(pdf),
            },
            surface,
        ))
    }

    /// How densely [`sample`](Self::sample) puts directions around that of a ray that meets a surface, per steradian; 0 for one that
    /// is not drawn. The ray, of length one, started at `from` and is so long, whatever it went through on its way.
    pub(crate) fn pdf(&self, surface: &SurfaceInteraction<'_>, from: DVec3, length: f64) -> f64 {
        let (object, hit) = (surface.object(), surface.hit());
        let luminance = brightness(object, hit.primitive);
        let total = self.total;
        if luminance <= 0.0 || self.is_empty() {
            return 0.0;
        }
        let direction = surface.ray().direction;
        match object.shape() {
            Shape::Mesh(_) => {
                let cosine = direction.dot(surface.normal()).abs();
                luminance / total * length * length / cosine
            }
            Shape::Sphere(_) => {
                let Some(light) = sphere(object) else {
                    return 0.0;
                };
                let area = 4.0 * std::f64::consts::PI * light.radius * light.radius;
                let met = Light::from(light).intersect(from, direction);
                met.map_or(0.0, |met| luminance * area / total * met.pdf)
            }
            _ => 0.0,
        }
    }
}

impl Object {
    /// Whether any of its materials shines.
    fn shines(&self) -> bool {
        let bright = |material: &super::Material| luminance(material.emission) > 0.0;
        self.materials().iter().any(bright)
    }
}

/// The luminance of a primitive's material, whatever its map.
fn brightness(object: &Object, primitive: i32) -> f64 {
    let material = object.material(primitive);
    material.map_or(0.0, |material| luminance(material.emission))
}

/// The corners of a triangle in the world.
fn corners(object: &Object, mesh: &Mesh, triangle: usize) -> [DVec3; 3] {
    let world_from_object = object.transform().world_from_object();
    mesh.corners(triangle)
        .map(|corner| world_from_object.transform_point3(corner))
}

fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// A sphere in the world; `None` for one that its transform makes an ellipsoid.
fn sphere(object: &Object) -> Option<SphereLight> {
    let Shape::Sphere(sphere) = object.shape() else {
        return None;
    };
    let world_from_object = object.transform().world_from_object();
    let axes = world_from_object.matrix3;
    let lengths = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length);
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis];
    let is_similar = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
    let skew = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs());
    let is_round = is_similar(lengths[0], lengths[1])
        && is_similar(lengths[1], lengths[2])
        && skew <= 1e-12 * lengths[0] * lengths[0];
    is_round.then(|| SphereLight {
        center: world_from_object.transform_point3(sphere.center()),
        radius: lengths[0] * sphere.radius(),
        ..SphereLight::default()
    })
}
