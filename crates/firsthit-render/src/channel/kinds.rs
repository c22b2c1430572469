//! The table of channels.

use std::borrow::Cow;

use super::asked::MATTE_RANKS;
use super::{ChannelKind, Make, Matte};
use crate::geometry::Hit;
use crate::image::{Display, Unit};
use crate::scene::{Catalog, Object, SurfaceInteraction};

/// The number of the ray that each hit belongs to, where a ray may have several. It is no channel of a picture, so not among
/// [`KINDS`]; [`AllHits::ray_numbers`](crate::shoot::AllHits::ray_numbers) has its data.
pub const RAY: &ChannelKind = &ChannelKind {
    name: Cow::Borrowed("ray"),
    about: "number of the ray, from 0",
    components: 1,
    display: Display::Identifier,
    unit: Unit::None,
    frame: None,
    make: Make::Elsewhere,
};

/// Whether a point is inside an object. It is no channel of hits, so not among [`KINDS`];
/// `inside` has its data.
pub const INSIDE: &ChannelKind = &ChannelKind {
    name: Cow::Borrowed("inside"),
    about: "whether the point is inside an object",
    components: 1,
    display: Display::Mask,
    unit: Unit::None,
    frame: None,
    make: Make::Elsewhere,
};

/// Whether two points see each other. It is no channel of hits, so not among [`KINDS`]; [`visible`](crate::shoot::visible())
/// has its data.
pub const VISIBLE: &ChannelKind = &ChannelKind {
    name: Cow::Borrowed("visible"),
    about: "whether the two points see each other",
    components: 1,
    display: Display::Mask,
    unit: Unit::None,
    frame: None,
    make: Make::Elsewhere,
};

/// The thickness of an object. It is no channel of hits, so not among [`KINDS`]; `thickness` has its data.
pub const THICKNESS: &ChannelKind = &ChannelKind {
    name: Cow::Borrowed("thickness"),
    about: "distance inwards to the other side; inf where there is none",
    components: 1,
    display: Display::Distance,
    unit: Unit::SceneLength,
    frame: None,
    make: Make::Elsewhere,
};

/// The distance to the nearest point. It is no channel of hits, so not among [`KINDS`];
/// `closest_points` has its data.
pub const DISTANCE: &ChannelKind = &ChannelKind {
    name: Cow::Borrowed("distance"),
    about: "how far away the nearest point is; inf if there is none",
    components: 1,
    display: Display::Distance,
    unit: Unit::SceneLength,
    frame: None,
    make: Make::Elsewhere,
};

/// The distance with a sign; `signed_distances` has its data.
pub const SIGNED_DISTANCE: &ChannelKind = &ChannelKind {
    name: Cow::Borrowed("distance"),
    about: "how far away the nearest point is, negative inside; inf if there is none",
    components: 1,
    display: Display::Distance,
    unit: Unit::SceneLength,
    frame: None,
    make: Make::Elsewhere,
};

/// The number of the point that each nearest point belongs to, where a point may have several.
pub const POINT: &ChannelKind = &ChannelKind {
    name: Cow::Borrowed("point"),
    about: "number of the point that was given, from 0",
    components: 1,
    display: Display::Identifier,
    unit: Unit::None,
    frame: None,
    make: Make::Elsewhere,
};

/// Every channel. A new one is a new row.
pub const KINDS: &[ChannelKind] = &[
    ChannelKind {
        name: Cow::Borrowed("color"),
        about: "linear red, green, blue (Rec. 709); the background for a miss",
        components: 3,
        display: Display::Color,
        unit: Unit::LinearColor,
        frame: None,
        make: Make::Color,
    },
    ChannelKind {
        name: Cow::Borrowed("t"),
        about: "distance from the ray's start along the ray (in lengths of the direction); inf for a miss",
        components: 1,
        display: Display::Distance,
        unit: Unit::DirectionLength,
        frame: Some("ray"),
        make: Make::T,
    },
    ChannelKind {
        name: Cow::Borrowed("range"),
        about: "distance from the camera's position along the ray; inf for a miss",
        components: 1,
        display: Display::Distance,
        unit: Unit::SceneLength,
        frame: Some("camera"),
        make: Make::Distance(0),
    },
    ChannelKind {
        name: Cow::Borrowed("z"),
        about: "distance from the camera's position along its aim; inf for a miss",
        components: 1,
        display: Display::Distance,
        unit: Unit::SceneLength,
        frame: Some("camera"),
        make: Make::Distance(1),
    },
    ChannelKind {
        name: Cow::Borrowed("object"),
        about: "identifier of the object; -1 for a miss",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Identifier(|hit| hit.object),
    },
    ChannelKind {
        name: Cow::Borrowed("primitive"),
        about: "identifier of the object's part, such as the triangle; -1 for a miss",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Identifier(|hit| hit.primitive),
    },
    ChannelKind {
        name: Cow::Borrowed("face"),
        about: "identifier of the polygon that the triangle was part of; -1 for a miss",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Integer(face),
    },
    ChannelKind {
        name: Cow::Borrowed("node"),
        about: "identifier of the node that the object comes from; -1 for a miss and where there is none",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Origin(|catalog, _, hit| of_object(hit, |object| catalog.node_of(object))),
    },
    ChannelKind {
        name: Cow::Borrowed("mesh"),
        about: "identifier of the mesh that the object is, or is a part of; -1 for a miss and other shapes",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Origin(|catalog, _, hit| of_object(hit, |object| catalog.mesh_of(object))),
    },
    ChannelKind {
        name: Cow::Borrowed("material"),
        about: "identifier of the material; -1 for a miss and where there is none",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Origin(material),
    },
    ChannelKind {
        name: Cow::Borrowed("normal"),
        about: "geometric normal in the world, of length one, outwards; NaN for a miss",
        components: 3,
        display: Display::Direction,
        unit: Unit::None,
        frame: Some("world"),
        make: Make::Doubles(|surface, out| {
            out.copy_from_slice(&surface.normal().to_array());
        }),
    },
    ChannelKind {
        name: Cow::Borrowed("incidence"),
        about: "angle between the ray and the normal, 0 head on; NaN for a miss",
        components: 1,
        display: Display::Quantity,
        unit: Unit::Radian,
        frame: None,
        make: Make::Doubles(|surface, out| out[0] = surface.incidence()),
    },
    ChannelKind {
        name: Cow::Borrowed("position"),
        about: "where the hit is in the world; NaN for a miss",
        components: 3,
        display: Display::Position,
        unit: Unit::SceneLength,
        frame: Some("world"),
        make: Make::Doubles(|surface, out| {
            out.copy_from_slice(&surface.position().to_array());
        }),
    },
    ChannelKind {
        name: Cow::Borrowed("barycentric"),
        about: "weights of the triangle's corners 0, 1, 2; NaN for a miss and for other shapes",
        components: 3,
        display: Display::Fraction,
        unit: Unit::None,
        frame: Some("triangle"),
        make: Make::Doubles(|surface, out| {
            let [b, c] = surface.hit().barycentric.to_array();
            out.copy_from_slice(&[1.0 - b - c, b, c]);
        }),
    },
    ChannelKind {
        name: Cow::Borrowed("uv"),
        about: "texture coordinates; NaN for a miss and where there are none",
        components: 2,
        display: Display::Fraction,
        unit: Unit::None,
        frame: Some("texture"),
        make: Make::Doubles(|surface, out| {
            if let Some(uv) = surface.uv() {
                out.copy_from_slice(&uv.to_array());
            }
        }),
    },
    ChannelKind {
        name: Cow::Borrowed("base_color"),
        about: "linear colour of the surface there, with its texture, without light; NaN for a miss",
        components: 3,
        display: Display::Fraction,
        unit: Unit::LinearColor,
        frame: None,
        make: Make::Doubles(|surface, out| {
            out.copy_from_slice(&surface.color().to_array());
        }),
    },
    ChannelKind {
        name: Cow::Borrowed("front"),
        about: "whether the front of the surface was met; false for a miss",
        components: 1,
        display: Display::Mask,
        unit: Unit::None,
        frame: None,
        make: Make::Flag(is_front),
    },
    ChannelKind {
        name: Cow::Borrowed("valid"),
        about: "whether the pixel sees anything at all: false where a lens has no ray, as beyond a fisheye's circle",
        components: 1,
        display: Display::Mask,
        unit: Unit::None,
        frame: None,
        make: Make::Valid,
    },
    ChannelKind {
        name: Cow::Borrowed("edge"),
        about: "how much of the pixel lines along edges cover, from 0 to 1",
        components: 1,
        display: Display::Fraction,
        unit: Unit::None,
        frame: None,
        make: Make::Edge,
    },
    ChannelKind {
        name: Cow::Borrowed("alpha"),
        about: "coverage, from 0 to 1: how much of the pixel is not the background; with a ground, its shadow too",
        components: 1,
        display: Display::Fraction,
        unit: Unit::None,
        frame: None,
        make: Make::Alpha,
    },
    ChannelKind {
        name: Cow::Borrowed("ao"),
        about: "ambient occlusion over all samples: how much of the sky the surface sees, from 0 to 1; 1 for a miss",
        components: 1,
        display: Display::Fraction,
        unit: Unit::None,
        frame: None,
        make: Make::Occlusion(f64::INFINITY),
    },
    ChannelKind {
        name: Cow::Borrowed("samples"),
        about: "how many samples the pixel's colour is the mean of",
        components: 1,
        display: Display::Quantity,
        unit: Unit::None,
        frame: None,
        make: Make::Samples,
    },
    ChannelKind {
        name: Cow::Borrowed("crypto_object"),
        about: "Cryptomatte of objects by name: six pairs of identifier and coverage, over all samples; 0 for a miss",
        components: 2 * MATTE_RANKS,
        display: Display::Matte,
        unit: Unit::None,
        frame: None,
        make: Make::Matte(Matte::Object),
    },
    ChannelKind {
        name: Cow::Borrowed("crypto_material"),
        about: "the same of materials by name; 0 for a miss and where there is no material",
        components: 2 * MATTE_RANKS,
        display: Display::Matte,
        unit: Unit::None,
        frame: None,
        make: Make::Matte(Matte::Material),
    },
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
    of_object(hit, |number| {
        catalog.material_of(number, object, hit.primitive)
    })
}
