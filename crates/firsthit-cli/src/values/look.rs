//! Parsers for colours and lights.

use firsthit::geometry::{COLOR_NAMES, Domain, Setting, Value, color_of};
use firsthit::scene_file::nearest_word;
use firsthit::shade::LightRig;
use firsthit::{Background, Color, Light};

use super::numbers;

/// A light as the command line has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LightArg {
    /// Lights that go with the camera.
    LightRig(LightRig),
    /// One light, whose brightness follows from the scene.
    Light(Light),
}

/// A sky from the horizon to the zenith.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sky {
    pub(crate) horizon: Color,
    pub(crate) zenith: Color,
}

/// Linear numbers, or sRGB in the ways of CSS.
pub(crate) fn color(text: &str) -> Result<Color, String> {
    if text.trim().eq_ignore_ascii_case(TRANSPARENT) {
        return Err("only a background can be transparent".into());
    }
    color_or(text, "")
}

/// A colour; `others` is what else the message of an error offers.
fn color_or(text: &str, others: &str) -> Result<Color, String> {
    let form = &format!(
        "linear red, green and blue, such as 0.2,0.3,0.5, or sRGB as '#rrggbb' or a CSS name such as steelblue{others}"
    );
    let text = text.trim();
    if let Some(color) = color_of(text) {
        return Ok(color);
    }
    let names = COLOR_NAMES.iter().map(|&(name, _)| name);
    if let Some(meant) = nearest_word(text, names) {
        return Err(format!("expected {form}; did you mean {meant}?"));
    }
    let color = numbers::<3>(text, ',', form, |_| true).map(Color::from)?;
    if color.min_element() < 0.0 {
        return Err(format!("expected {form}, none of them negative"));
    }
    Ok(color)
}

const TRANSPARENT: &str = "transparent";

/// A colour, or `transparent`.
pub(crate) fn background(text: &str) -> Result<Background, String> {
    if text.trim().eq_ignore_ascii_case(TRANSPARENT) {
        return Ok(Background::Transparent);
    }
    color_or(text, ", or transparent").map(Background::Uniform)
}

pub(crate) fn sky(text: &str) -> Result<Sky, String> {
    let form = "the colours of the horizon and the zenith, such as 0.8,0.85,0.9:0.1,0.3,0.6";
    let (horizon, zenith) = text.split_once(':').ok_or_else(|| format!("expected {form}"))?;
    Ok(Sky { horizon: color(horizon)?, zenith: color(zenith)? })
}

/// The name of a rig, or a light: its kind, and after a colon each its settings, but for its
/// colour.
pub(crate) fn light(text: &str) -> Result<LightArg, String> {
    if let Ok(rig) = text.parse() {
        return Ok(LightArg::LightRig(rig));
    }
    let (kind, values) = text.split_once(':').unwrap_or((text, ""));
    let Ok(mut light) = Light::named(kind) else {
        let rigs = LightRig::NAMES.join(", ");
        return Err(format!(
            "expected one of {rigs}; or a light, such as point:1,2,3, that is one of {}",
            Light::NAMES.join(", ")
        ));
    };
    let list = light.list().iter();
    let list: Vec<&Setting> = list.filter(|known| known.domain != Domain::Light).collect();
    let form = || {
        let of = |setting: &&Setting| match setting.domain {
            Domain::Position | Domain::Direction => ":X,Y,Z",
            _ => ":NUMBER",
        };
        let forms: String = list.iter().map(of).collect();
        let names: Vec<&str> = list.iter().map(|setting| setting.name).collect();
        format!("expected {kind}{forms}, these being {}", names.join(", "))
    };
    let given: Vec<&str> = values.split([':', '@']).collect();
    let needed = list.iter().filter(|setting| setting.is_required).count();
    if given.len() < needed || given.len() > list.len() {
        return Err(form());
    }
    for (setting, text) in list.iter().zip(given) {
        let value = setting.domain.parsed(text).ok_or_else(form)?;
        // The square of its distance must be a number.
        if let Value::Vector(vector) = value
            && vector.abs().max_element() > 1e150
        {
            return Err("expected a point no farther away than 1e150".into());
        }
        light.set(setting.name, value).map_err(|error| error.to_string())?;
    }
    light.check().map_err(|error| error.to_string())?;
    Ok(LightArg::Light(light))
}

#[cfg(test)]
mod tests {
    use firsthit::DVec3;
    use firsthit::scene::{DirectionalLight, PointLight};

    use super::*;

    #[test]
    fn colours_are_linear_numbers_levels_or_names() {
        assert_eq!(color("1,0.5,0"), Ok(Color::new(1.0, 0.5, 0.0)));
        assert_eq!(color("#ff0000"), Ok(Color::new(1.0, 0.0, 0.0)));
        assert_eq!(color("Blue"), Ok(Color::new(0.0, 0.0, 1.0)));
        assert!(color("stelblue").unwrap_err().ends_with("did you mean steelblue?"));
        assert_eq!(background("transparent"), Ok(Background::Transparent));
        for wrong in ["", "#ff00", "1,0", "nothing at all", "transparent", "-1,0,0"] {
            assert!(color(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn lights_name_their_kind() {
        let point = PointLight { position: DVec3::new(1.0, 2.0, -3.0), ..PointLight::default() };
        assert_eq!(light("point:1,2,-3"), Ok(LightArg::Light(point.into())));
        let sun = DirectionalLight {
            direction: DVec3::NEG_Z,
            angle_degrees: 0.5,
            ..DirectionalLight::default()
        };
        assert_eq!(light("directional:0,0,-1@0.5"), Ok(LightArg::Light(sun.into())));
        assert_eq!(light("overcast"), Ok(LightArg::LightRig(LightRig::Overcast)));
        assert!(light("sphere:0,0,5:2").is_ok());
        for wrong in ["directional:0,0,0", "sphere:1,2,3:-1", "point:1,2", "point", "lamp:1,2,3"] {
            assert!(light(wrong).is_err(), "{wrong}");
        }
        assert!(light("1,2,3").is_err());
    }
}
