//! Surfaces that shine, as lights.

use std::collections::HashSet;
use std::f64::consts::PI;

use super::light::{Light, LightSample, SphereLight, form_factor};
use super::{AlphaMode, MapRole, Material, Model, Object, Scene, SurfaceInteraction};
use crate::geometry::{Color, DVec2, DVec3, Hit, Ray, SurfaceId, is_light, luminance};
use crate::sampling::distribution::Distribution;
use crate::sampling::warp;
use crate::shape::{Mesh, Shape};

/// The surfaces of a scene that shine: triangles and spheres, drawn in proportion to their area and
/// luminance. They shine on both sides. Copies of others in the same place are left out: no ray
/// meets them.
#[derive(Debug, Clone)]
#[doc(hidden)]
pub struct Emitters {
    /// The drawn surfaces, in the order of objects and primitives.
    surfaces: Vec<SurfaceId>,
    /// The powers of the surfaces: area times luminance.
    powers: Option<Distribution>,
    total: f64,
    /// Whether surfaces that are not drawn shine too: rays have to find them.
    has_others: bool,
}

impl Emitters {
    /// Finds the emitters of a scene.
    pub(super) fn new(scene: &Scene) -> Self {
        let (mut surfaces, mut powers) = (Vec::new(), Vec::new());
        let mut has_others = false;
        // The places of triangles: of those in one place, a ray meets the first. A mesh with some
        // of its surface cut out has none.
        let mut places = HashSet::new();
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
                        let corners = corners(object, mesh, triangle);
                        if object.has_cutouts() || places.insert(place(corners)) {
                            push(primitive, area(corners));
                        }
                    }
                }
                // One in the place of another is a copy of it.
                Shape::Sphere(_) if scene.duplicates().contains(i32::cast_unsigned(number)) => {}
                Shape::Sphere(_) => match sphere(object) {
                    Some(SphereLight { radius, .. }) => {
                        push(0, 4.0 * PI * radius * radius);
                    }
                    None => has_others = true,
                },
                _ => has_others = true,
            }
        }
        let total = powers.iter().sum();
        Self { surfaces, powers: Distribution::new(powers), total, has_others }
    }

    /// Whether there are no surfaces to draw.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.powers.is_none()
    }

    /// Whether any surface shines.
    #[inline]
    pub fn has_any(&self) -> bool {
        self.has_others || !self.is_empty()
    }

    /// Whether surfaces shine that are not drawn.
    #[inline]
    pub fn has_others(&self) -> bool {
        self.has_others
    }

    /// Light that arrives at a point, from a surface and a point of it that three numbers from 0 to
    /// 1 stand for.
    pub fn sample(
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
            let sphere = sphere(object)?;
            if is_seen_in_part(object, &sphere, at) {
                let arriving = Light::from(sphere).sample(at, u)?;
                (arriving.towards, DVec2::ZERO, arriving.pdf?)
            } else {
                let normal = warp::cap(u, 2.0);
                let towards = sphere.center + sphere.radius * normal - at;
                let length = towards.length();
                let pdf = pdf_by_area(&sphere, length, towards.dot(normal) / length);
                (towards, DVec2::ZERO, pdf)
            }
        };
        if let Shape::Mesh(mesh) = object.shape()
            && object.is_cut_out(mesh, usize::try_from(surface.primitive).ok()?, barycentric)
        {
            return None;
        }
        let hit = Hit { t: 1.0, object: surface.object, primitive: surface.primitive, barycentric };
        let ray = Ray::new(at, towards);
        let met = scene.interaction(&ray, &hit)?;
        let pdf = share * pdf;
        let light = met.opacity() * met.emitted() / (PI * pdf);
        is_light(light)
            .then_some((LightSample { towards, distance: 1.0, light, pdf: Some(pdf) }, surface))
    }

    /// The radiance of a white matte surface at a point with a normal, lit by all emitters without
    /// occlusion: the irradiance divided by pi. `None` where that takes long: for many emitters,
    /// for those with a map, and for those that are not sampled.
    pub fn irradiance(&self, scene: &Scene, at: DVec3, normal: DVec3) -> Option<Color> {
        if self.has_others || self.surfaces.len() > MOST_SUMMED {
            return None;
        }
        let mut sum = Color::ZERO;
        for &SurfaceId { object, primitive } in &self.surfaces {
            let object = &scene.objects()[usize::try_from(object).ok()?];
            let material = object.material(primitive)?;
            let is_even = material.alpha_mode != AlphaMode::Blend
                && material.maps.get(MapRole::Emission).is_none()
                && matches!(material.model, Model::Matte(_))
                && !object.has_cutouts();
            if !is_even {
                return None;
            }
            let factor = if let Shape::Mesh(mesh) = object.shape() {
                let corners = corners(object, mesh, usize::try_from(primitive).ok()?);
                form_factor::of_triangle(corners.map(|corner| corner - at), normal)
            } else {
                let sphere = sphere(object).filter(|sphere| is_clear_of(sphere, at))?;
                let way = sphere.center - at;
                let sine = sphere.radius / way.length();
                let half = [sine, (1.0 - sine * sine).sqrt()];
                form_factor::of_disc(normal.dot(way) / way.length(), half)
            };
            sum += factor * material.emission;
        }
        Some(sum)
    }

    /// The probability density with which [`sample`](Self::sample) draws the direction of a ray
    /// that meets a surface, per steradian; 0 for a surface that is not drawn. The ray, of length
    /// one, started at `from` and has this length, whatever it went through on its way.
    pub fn pdf(&self, surface: &SurfaceInteraction<'_>, from: DVec3, length: f64) -> f64 {
        let (object, hit) = (surface.object(), surface.hit());
        let luminance = brightness(object, hit.primitive);
        let total = self.total;
        let key = |surface: &SurfaceId| (surface.object, surface.primitive);
        let found = self.surfaces.binary_search_by_key(&(hit.object, hit.primitive), key);
        if found.is_err() {
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
                let pdf = if is_seen_in_part(object, &light, from) {
                    let met = Light::from(light).intersect(from, direction);
                    met.map_or(0.0, |met| met.pdf)
                } else {
                    pdf_by_area(&light, length, direction.dot(surface.normal()))
                };
                let area = 4.0 * PI * light.radius * light.radius;
                luminance * area / total * pdf
            }
            _ => 0.0,
        }
    }
}

/// The most surfaces whose irradiance is summed up.
const MOST_SUMMED: usize = 64;

impl Object {
    /// Whether any of its materials shines.
    fn shines(&self) -> bool {
        let materials = self.materials().iter();
        materials.map(luminance_of).any(|luminance| luminance > 0.0)
    }
}

/// The luminance of a material, whatever its map. One that is shown as it is gives no light.
fn luminance_of(material: &Material) -> f64 {
    if material.unlit { 0.0 } else { luminance(material.emission) }
}

/// The luminance of a primitive's material, whatever its map.
fn brightness(object: &Object, primitive: i32) -> f64 {
    object.material(primitive).map_or(0.0, luminance_of)
}

/// Identifies the place of a triangle, whatever the order of its corners.
fn place(corners: [DVec3; 3]) -> [[u64; 3]; 3] {
    // Adding zero makes negative zeros positive.
    let mut place = corners.map(|corner| (corner + DVec3::ZERO).to_array().map(f64::to_bits));
    place.sort_unstable();
    place
}

/// Whether a point sees a part of a sphere alone, which is then drawn. From within, and through a
/// translucent one, it sees all of the sphere, which is drawn evenly by area.
fn is_seen_in_part(object: &Object, sphere: &SphereLight, at: DVec3) -> bool {
    let material = object.material(0);
    let is_translucent = material.is_some_and(|material| {
        let has_map =
            [MapRole::Color, MapRole::Alpha].map(|role| material.maps.get(role).is_some());
        let may_be_clear = material.alpha < 1.0 || has_map.contains(&true);
        material.alpha_mode == AlphaMode::Blend && may_be_clear
    });
    !is_translucent && is_clear_of(sphere, at)
}

/// Whether a point is outside of a sphere, and not on it by rounding.
fn is_clear_of(sphere: &SphereLight, at: DVec3) -> bool {
    (at - sphere.center).length() > (1.0 + 1e-9) * sphere.radius
}

/// The density of directions to points drawn evenly over a sphere's area, per steradian.
fn pdf_by_area(sphere: &SphereLight, length: f64, cosine: f64) -> f64 {
    length * length / (4.0 * PI * sphere.radius * sphere.radius * cosine.abs())
}

/// The corners of a triangle in the world.
fn corners(object: &Object, mesh: &Mesh, triangle: usize) -> [DVec3; 3] {
    let world_from_object = object.transform().world_from_object();
    mesh.corners(triangle).map(|corner| world_from_object.transform_point3(corner))
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
