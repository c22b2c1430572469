//! The table of channels.

use std::borrow::Cow;

use super::asked::MATTE_RANKS;
use super::{ChannelKind, Make, Matte};
use crate::geometry::Hit;
use crate::image::Display::{
    self, Color, Direction, Distance, Fraction, Identifier, Mask, Position, Quantity,
};
use crate::image::Unit;
use crate::scene::{Catalog, Object, SurfaceInteraction};

/// The number of the ray that each hit belongs to, where a ray may have several. It is no channel
/// of a picture, so not among [`KINDS`];
/// [`AllHits::ray_numbers`](crate::shoot::AllHits::ray_numbers) has its data.
pub const RAY: &ChannelKind = &elsewhere("ray", Identifier, "number of the ray, from 0");

/// Whether a point is inside an object. It is no channel of hits, so not among [`KINDS`];
/// `inside` has its data.
pub const INSIDE: &ChannelKind =
    &elsewhere("inside", Mask, "whether the point is inside an object");

/// Whether two points see each other. It is no channel of hits, so not among [`KINDS`];
/// [`visible`](crate::shoot::visible()) has its data.
pub const VISIBLE: &ChannelKind =
    &elsewhere("visible", Mask, "whether the two points see each other");

/// The thickness of an object. It is no channel of hits, so not among [`KINDS`]; `thickness` has
/// its data.
pub const THICKNESS: &ChannelKind = &elsewhere(
    "thickness",
    Distance,
    "distance inwards to the other side; inf where there is none",
);

/// The distance to the nearest point. It is no channel of hits, so not among [`KINDS`];
/// `closest_points` has its data.
pub const DISTANCE: &ChannelKind =
    &elsewhere("distance", Distance, "how far away the nearest point is; inf if there is none");

/// The distance with a sign; `signed_distances` has its data.
pub const SIGNED_DISTANCE: &ChannelKind = &elsewhere(
    "distance",
    Distance,
    "how far away the nearest point is, negative inside; inf if there is none",
);

/// The number of the point that each nearest point belongs to, where a point may have several.
pub const POINT: &ChannelKind =
    &elsewhere("point", Identifier, "number of the point that was given, from 0");

/// Every channel. A new one is a new row.
#[rustfmt::skip]
pub const KINDS: &[ChannelKind] = &[
    row("color", 3, Color, Unit::LinearColor, "", Make::Color,
        "linear red, green, blue (Rec. 709); the background for a miss"),
    row("t", 1, Distance, Unit::DirectionLength, "ray", Make::T,
        "distance from the ray's start along the ray (in lengths of the direction); inf for a \
         miss"),
    row("range", 1, Distance, Unit::SceneLength, "camera", Make::Distance(0),
        "distance from the camera's position along the ray; inf for a miss"),
    row("z", 1, Distance, Unit::SceneLength, "camera", Make::Distance(1),
        "distance from the camera's position along its aim; inf for a miss"),
    row("object", 1, Identifier, Unit::None, "", Make::Identifier(|hit| hit.object),
        "identifier of the object; -1 for a miss"),
    row("primitive", 1, Identifier, Unit::None, "", Make::Identifier(|hit| hit.primitive),
        "identifier of the object's part, such as the triangle; -1 for a miss"),
    row("face", 1, Identifier, Unit::None, "", Make::Integer(face),
        "identifier of the polygon that the triangle was part of; -1 for a miss"),
    row("node", 1, Identifier, Unit::None, "",
        Make::Origin(|catalog, _, hit| of_object(hit, |object| catalog.node_of(object))),
        "identifier of the node that the object comes from; -1 for a miss and where there is none"),
    row("mesh", 1, Identifier, Unit::None, "",
        Make::Origin(|catalog, _, hit| of_object(hit, |object| catalog.mesh_of(object))),
        "identifier of the mesh that the object is, or is a part of; -1 for a miss and other \
         shapes"),
    row("material", 1, Identifier, Unit::None, "", Make::Origin(material),
        "identifier of the material; -1 for a miss and where there is none"),
    row("normal", 3, Direction, Unit::None, "world",
        Make::Doubles(|surface, out| out.copy_from_slice(&surface.normal().to_array())),
        "geometric normal in the world, of length one, outwards; NaN for a miss"),
    row("incidence", 1, Quantity, Unit::Radian, "",
        Make::Doubles(|surface, out| out[0] = surface.incidence()),
        "angle between the ray and the normal, 0 head on; NaN for a miss"),
    row("position", 3, Position, Unit::SceneLength, "world",
        Make::Doubles(|surface, out| out.copy_from_slice(&surface.position().to_array())),
        "where the hit is in the world; NaN for a miss"),
    row("barycentric", 3, Fraction, Unit::None, "triangle",
        Make::Doubles(|surface, out| {
            let [b, c] = surface.hit().barycentric.to_array();
            out.copy_from_slice(&[1.0 - b - c, b, c]);
        }),
        "weights of the triangle's corners 0, 1, 2; NaN for a miss and for other shapes"),
    row("uv", 2, Fraction, Unit::None, "texture",
        Make::Doubles(|surface, out| {
            if let Some(uv) = surface.uv() {
                out.copy_from_slice(&uv.to_array());
            }
        }),
        "texture coordinates; NaN for a miss and where there are none"),
    row("base_color", 3, Fraction, Unit::LinearColor, "",
        Make::Doubles(|surface, out| out.copy_from_slice(&surface.color().to_array())),
        "linear colour of the surface there, with its texture, without light; NaN for a miss"),
    row("front", 1, Mask, Unit::None, "", Make::Flag(is_front),
        "whether the front of the surface was met; false for a miss"),
    row("valid", 1, Mask, Unit::None, "", Make::Valid,
        "whether the pixel sees anything at all: false where a lens has no ray, as beyond a \
         fisheye's circle"),
    row("edge", 1, Fraction, Unit::None, "", Make::Edge,
        "how much of the pixel lines along edges cover, from 0 to 1"),
    row("alpha", 1, Fraction, Unit::None, "", Make::Alpha,
        "coverage, from 0 to 1: how much of the pixel is not the background; with a ground, its \
         shadow too"),
    row("ao", 1, Fraction, Unit::None, "", Make::Occlusion(f64::INFINITY),
        "ambient occlusion over all samples: how much of the sky the surface sees, from 0 to 1; \
         1 for a miss"),
    row("samples", 1, Quantity, Unit::None, "", Make::Samples,
        "how many samples the pixel's colour is the mean of"),
    row("crypto_object", 2 * MATTE_RANKS, Display::Matte, Unit::None, "",
        Make::Matte(Matte::Object),
        "Cryptomatte of objects by name: six pairs of identifier and coverage, over all \
         samples; 0 for a miss"),
    row("crypto_material", 2 * MATTE_RANKS, Display::Matte, Unit::None, "",
        Make::Matte(Matte::Material),
        "the same of materials by name; 0 for a miss and where there is no material"),
];

// Of any lifetime, as the methods are not.
fn face(surface: &SurfaceInteraction<'_>) -> i32 {
    surface.face()
}

fn is_front(surface: &SurfaceInteraction<'_>) -> bool {
    surface.is_front()
}

fn of_object(hit: &Hit, number: impl FnOnce(usize) -> i32) -> i32 {
    usize::try_from(hit.object).map_or(-1, number)
}

fn material(catalog: &Catalog, object: &Object, hit: &Hit) -> i32 {
    of_object(hit, |number| catalog.material_of(number, object, hit.primitive))
}

/// A row of the table: name, components, display, unit, frame if there is one, and what it is.
const fn row(
    name: &'static str,
    components: usize,
    display: Display,
    unit: Unit,
    frame: &'static str,
    make: Make,
    about: &'static str,
) -> ChannelKind {
    ChannelKind {
        name: Cow::Borrowed(name),
        about,
        components,
        display,
        unit,
        frame: if frame.is_empty() { None } else { Some(frame) },
        make,
    }
}

/// A channel of one number that other functions compute; distances are in scene units.
const fn elsewhere(name: &'static str, display: Display, about: &'static str) -> ChannelKind {
    let unit = match display {
        Distance => Unit::SceneLength,
        _ => Unit::None,
    };
    row(name, 1, display, unit, "", Make::Elsewhere, about)
}
