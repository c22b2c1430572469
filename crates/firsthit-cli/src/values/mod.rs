//! Parsers for values on the command line.

use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use firsthit::camera::{Focus, FovAxis, PixelMatrix, StandardView};
use firsthit::edge::{Dash, EdgeKind, EdgeKinds, Edges};
use firsthit::geometry::{COLOR_NAMES, ColorMap, Domain, Setting, Value, color_of};
use firsthit::image::Far;
use firsthit::lint::KINDS;
use firsthit::load::UNITS;
use firsthit::measure::FillRule;
use firsthit::scene::{Build, ColorBy};
use firsthit::scene_file::nearest_word;
use firsthit::shade::LightRig;
use firsthit::{Background, Color, DVec3, Error, Light, ToneMap};

/// A camera's target: a point, or the middle of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    Auto,
    Point(DVec3),
}

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

fn numbers<const N: usize>(text: &str, separator: char, form: &str) -> Result<[f64; N], String> {
    let parse = |part: &str| part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(separator).map(parse).collect();
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| format!("expected {form}"))
}

/// The name of a variant.
pub(crate) fn named<T>(names: &'static [&'static str]) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = Error> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).try_map(|name| name.to_lowercase().parse())
}

/// The name of a view.
pub(crate) fn view() -> impl TypedValueParser<Value = StandardView> {
    PossibleValuesParser::new(StandardView::NAMES).try_map(|name| name.parse())
}

/// The name of a tone map.
pub(crate) fn tone_map() -> impl TypedValueParser<Value = ToneMap> {
    PossibleValuesParser::new(ToneMap::NAMES).try_map(|name| name.parse())
}

/// The treatment of far distances.
pub(crate) fn far() -> impl TypedValueParser<Value = Far> {
    PossibleValuesParser::new(Far::NAMES).try_map(|name| name.parse())
}

/// A rule for what is inside.
pub(crate) fn fill_rule() -> impl TypedValueParser<Value = FillRule> {
    PossibleValuesParser::new(FillRule::NAMES).try_map(|name| name.parse())
}

/// Parses the axis of a field of view.
pub(crate) fn fov_axis() -> impl TypedValueParser<Value = FovAxis> {
    PossibleValuesParser::new(FovAxis::NAMES).try_map(|name| name.parse())
}

/// Parses the trade-off for building trees.
pub(crate) fn build() -> impl TypedValueParser<Value = Build> {
    PossibleValuesParser::new(Build::NAMES).try_map(|name| name.parse())
}

/// The name of a kind of finding.
pub(crate) fn lint_kind() -> PossibleValuesParser {
    PossibleValuesParser::new(KINDS.iter().map(|kind| kind.name))
}

/// The name of a unit of length, as metres.
pub(crate) fn unit() -> impl TypedValueParser<Value = f64> {
    let names = UNITS.iter().map(|&(name, _)| name);
    let metres = |name: String| {
        let unit = UNITS.iter().find(|&&(known, _)| known == name);
        unit.map(|&(_, metres)| metres).ok_or("no such unit")
    };
    PossibleValuesParser::new(names).try_map(metres)
}

/// A factor of lengths.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    let factor = text.parse::<f64>().ok();
    let factor = factor.filter(|&factor| factor > 0.0 && factor.is_finite());
    factor.ok_or_else(|| "expected a number above 0".to_owned())
}

/// Parses the source of colours by numbers.
pub(crate) fn color_by(text: &str) -> Result<ColorBy, String> {
    let expected = format!(
        "expected attribute:NAME for an attribute of the meshes, or {}",
        ColorBy::NAMES.join(", ")
    );
    text.parse().map_err(|_| expected)
}

/// The name of a colour map.
pub(crate) fn color_map() -> impl TypedValueParser<Value = ColorMap> {
    PossibleValuesParser::new(ColorMap::NAMES).try_map(|name| name.parse())
}

/// Two numbers that rise.
pub(crate) fn range(text: &str) -> Result<[f64; 2], String> {
    let form = "two finite numbers that rise, such as 0,100";
    let [low, high] = numbers::<2>(text, ',', form)?;
    if low < high {
        Ok([low, high])
    } else {
        Err(format!("expected {form}"))
    }
}

/// A number of bytes, such as `500M`.
pub(crate) fn memory(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let unit = text
        .chars()
        .next_back()
        .map(|unit| unit.to_ascii_uppercase());
    let shift = match unit {
        Some('K') => 10,
        Some('M') => 20,
        Some('G') => 30,
        Some('T') => 40,
        _ => 0,
    };
    let digits = if shift == 0 {
        text
    } else {
        &text[..text.len() - 1]
    };
    let bytes: Option<u64> = digits.trim().parse().ok();
    bytes
        .and_then(|number| number.checked_mul(1 << shift))
        .filter(|&bytes| bytes > 0)
        .ok_or_else(|| "expected a whole number of bytes, or of K, M, G or T, such as 500M".into())
}

/// Two numbers.
pub(crate) fn pair(text: &str) -> Result<[f64; 2], String> {
    numbers::<2>(
        text,
        ',',
        "two finite numbers with a comma between them, such as 70,40",
    )
}

/// A whole number from 1 on.
pub(crate) fn count(text: &str) -> Result<usize, String> {
    let count = text.trim().parse().ok().filter(|&count: &usize| count > 0);
    count.ok_or_else(|| "expected a whole number from 1 on".into())
}

/// The elevations of lasers, in degrees.
#[derive(Debug, Clone)]
pub(crate) struct Elevations(pub(crate) Vec<f64>);

/// The lowest and the highest of some lasers at even angles, and how many there are.
pub(crate) fn elevations(text: &str) -> Result<Elevations, String> {
    /// A pattern has no more beams.
    const MOST: f64 = (1 << 26) as f64;
    let form =
        "LOW,HIGH,N: degrees that do not fall and a whole number of lasers, such as -15,15,16";
    let [low, high, lasers] = numbers::<3>(text, ',', form)?;
    if low > high || lasers.fract() != 0.0 || !(1.0..=MOST).contains(&lasers) {
        return Err(format!("expected {form}"));
    }
    #[expect(clippy::cast_possible_truncation, reason = "it is below 2^27")]
    let last = lasers as i32 - 1;
    let step = (high - low) / f64::from(last);
    let angles = (1..last).map(|k| low + f64::from(k) * step);
    let ends = (last > 0).then_some(high);
    Ok(Elevations(
        std::iter::once(low).chain(angles).chain(ends).collect(),
    ))
}

/// A standard deviation: a length, and a share of the range.
pub(crate) fn noise(text: &str) -> Result<[f64; 2], String> {
    let form = "one or two finite numbers with a comma between them, such as 0.02,0.001";
    let alone = numbers::<1>(text, ',', form).map(|[length]| [length, 0.0]);
    alone.or_else(|_| numbers::<2>(text, ',', form))
}

/// The class of the objects of a name.
pub(crate) fn class(text: &str) -> Result<(String, u8), String> {
    let parts = text.rsplit_once('=').filter(|(name, _)| !name.is_empty());
    let class = parts.and_then(|(name, class)| Some((name.to_owned(), class.parse().ok()?)));
    class.ok_or_else(|| "expected a name and a whole number from 0 to 255, such as ground=2".into())
}

pub(crate) fn vector(text: &str) -> Result<DVec3, String> {
    numbers::<3>(
        text,
        ',',
        "three finite numbers with commas between them, such as 1,-2.5,3",
    )
    .map(DVec3::from)
}

/// A ray: its origin and its direction.
pub(crate) fn ray(text: &str) -> Result<(DVec3, DVec3), String> {
    let form = "six finite numbers with commas between them, the origin and the direction, such as 0,0,10,0,0,-1";
    let [a, b, c, x, y, z] = numbers::<6>(text, ',', form)?;
    Ok((DVec3::new(a, b, c), DVec3::new(x, y, z)))
}

/// A pixel: its row and its column.
pub(crate) fn pixel(text: &str) -> Result<[usize; 2], String> {
    let parse = |part: &str| part.trim().parse::<usize>().ok();
    let both = text
        .split_once(',')
        .and_then(|(row, column)| Some([parse(row)?, parse(column)?]));
    both.ok_or_else(|| "expected a row and a column, whole numbers from 0, such as 360,640".into())
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
    let color = numbers::<3>(text, ',', form).map(Color::from)?;
    if color.min_element() < 0.0 {
        Err(format!("expected {form}, none of them negative"))
    } else {
        Ok(color)
    }
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
    let (horizon, zenith) = text
        .split_once(':')
        .ok_or_else(|| format!("expected {form}"))?;
    Ok(Sky {
        horizon: color(horizon)?,
        zenith: color(zenith)?,
    })
}

pub(crate) fn target(text: &str) -> Result<Target, String> {
    if text == "auto" {
        return Ok(Target::Auto);
    }
    vector(text)
        .map(Target::Point)
        .map_err(|form| format!("{form}, or auto"))
}

pub(crate) fn focus(text: &str) -> Result<Focus, String> {
    if let Ok(distance) = positive(text) {
        return Ok(Focus::Distance(distance));
    }
    let form = "a positive distance, or a point such as 1,2,3";
    let point = vector(text).map(Focus::At);
    point.map_err(|_| format!("expected {form}"))
}

/// `NAME=VALUE`.
pub(crate) fn setting(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=');
    let (name, value) = parts.ok_or("expected a name and a value, such as reach=2")?;
    Ok((name.trim().to_owned(), value.trim().to_owned()))
}

/// The name of a rig, or a light: its kind, and after a colon each its settings, but for its colour.
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
        light
            .set(setting.name, value)
            .map_err(|error| error.to_string())?;
    }
    light.check().map_err(|error| error.to_string())?;
    Ok(LightArg::Light(light))
}

/// `COLUMNSxROWS`, to rows and columns.
pub(crate) fn pixels(text: &str) -> Result<[usize; 2], String> {
    let parse = |part: &str| part.trim().parse::<usize>().ok().filter(|&n| n >= 1);
    let both = text
        .split_once('x')
        .and_then(|(columns, rows)| Some([parse(rows)?, parse(columns)?]));
    both.ok_or_else(|| "expected columns and rows, at least 1 of each, such as 720x480".into())
}

/// `WIDTHxHEIGHT` in scene units.
pub(crate) fn lengths(text: &str) -> Result<(f64, f64), String> {
    let form = "a width and a height, both positive, such as 36x24";
    let [width, height] = numbers::<2>(text, 'x', form)?;
    if width > 0.0 && height > 0.0 {
        Ok((width, height))
    } else {
        Err(format!("expected {form}"))
    }
}

pub(crate) fn finite(text: &str) -> Result<f64, String> {
    numbers::<1>(text, ',', "a finite number").map(|[number]| number)
}

pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let [number] = numbers::<1>(text, ',', "a positive number")?;
    if number > 0.0 {
        Ok(number)
    } else {
        Err("expected a positive number".into())
    }
}

/// The width of lines in pixels.
pub(crate) fn line_width(text: &str) -> Result<f64, String> {
    let form = "a number of pixels above 0, up to 1000";
    let [width] = numbers::<1>(text, ',', form)?;
    let fine = width > 0.0 && width <= Edges::WIDEST;
    fine.then_some(width)
        .ok_or_else(|| format!("expected {form}"))
}

/// An angle between two normals.
pub(crate) fn edge_angle(text: &str) -> Result<f64, String> {
    let form = "a number of degrees from 0 to 180";
    let [angle] = numbers::<1>(text, ',', form)?;
    let fine = (0.0..=180.0).contains(&angle);
    fine.then_some(angle)
        .ok_or_else(|| format!("expected {form}"))
}

/// Names of kinds of edges.
pub(crate) fn edge_kinds(text: &str) -> Result<EdgeKinds, String> {
    let known = || EdgeKind::NAMES.join(", ");
    text.parse()
        .map_err(|_| format!("expected some of {}, with commas between", known()))
}

/// The lengths of dashes and gaps.
pub(crate) fn dash(text: &str) -> Result<Dash, String> {
    let form = "two numbers of pixels, 0.1 at least, such as 6,4";
    let [on, off] = numbers::<2>(text, ',', form)?;
    let fine = on >= Dash::SHORTEST && off >= Dash::SHORTEST;
    fine.then_some(Dash { on, off })
        .ok_or_else(|| format!("expected {form}"))
}

/// A number from 0 to 1.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let form = "a number from 0 to 1";
    let [share] = numbers::<1>(text, ',', form)?;
    let fine = (0.0..=1.0).contains(&share);
    fine.then_some(share)
        .ok_or_else(|| format!("expected {form}"))
}

/// Zero or a positive number.
pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    let form = "zero or a positive number";
    let [number] = numbers::<1>(text, ',', form)?;
    if number >= 0.0 {
        Ok(number)
    } else {
        Err(format!("expected {form}"))
    }
}

/// A number; minus infinity is one here.
pub(crate) fn t_min(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    let start = number.filter(|&number| number < f64::INFINITY);
    start.ok_or_else(|| "expected a number, or -inf".into())
}

/// A number; infinity is one here.
pub(crate) fn t_max(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    let end = number.filter(|&number| number > f64::NEG_INFINITY);
    end.ok_or_else(|| "expected a number, or inf".into())
}

/// An intrinsic matrix by its numbers.
pub(crate) fn intrinsics(text: &str) -> Result<PixelMatrix, String> {
    let form =
        "fx,fy,cx,cy or fx,fy,cx,cy,skew, of which fx and fy are positive, such as 600,600,320,240";
    let numbers = match numbers::<4>(text, ',', form) {
        Ok([fx, fy, cx, cy]) => [fx, fy, cx, cy, 0.0],
        Err(_) => numbers::<5>(text, ',', form)?,
    };
    let [fx, fy, cx, cy, skew] = numbers;
    if fx > 0.0 && fy > 0.0 {
        Ok(PixelMatrix {
            fx,
            fy,
            cx,
            cy,
            skew,
        })
    } else {
        Err(format!("expected {form}"))
    }
}

/// Numbers with names.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parameters(pub(crate) Vec<(String, f64)>);

/// Numbers with names, as `NAME=NUMBER`, with commas between.
pub(crate) fn parameters(text: &str) -> Result<Parameters, String> {
    let one = |part: &str| {
        let (name, value) = part.split_once('=')?;
        let value: f64 = value.trim().parse().ok()?;
        value.is_finite().then(|| (name.trim().to_owned(), value))
    };
    let all: Option<Vec<(String, f64)>> = text.split(',').map(one).collect();
    all.map(Parameters)
        .ok_or_else(|| "expected names and numbers, such as k1=-0.2,k2=0.05".into())
}

pub(crate) fn fov(text: &str) -> Result<f64, String> {
    let form = "degrees above 0 and up to 360";
    let [degrees] = numbers::<1>(text, ',', form)?;
    if degrees > 0.0 && degrees <= 360.0 {
        Ok(degrees)
    } else {
        Err(format!("expected {form}"))
    }
}

#[cfg(test)]
mod tests {
    use firsthit::scene::{DirectionalLight, PointLight};

    use super::*;

    #[test]
    fn matrices_have_four_or_five_numbers() {
        let matrix = intrinsics("600, 610,320,240").unwrap();
        assert_eq!(
            (matrix.fx, matrix.fy, matrix.cx, matrix.cy, matrix.skew),
            (600.0, 610.0, 320.0, 240.0, 0.0)
        );
        assert_eq!(intrinsics("600,610,320,240,2").unwrap().skew, 2.0);
        for bad in ["", "1,2,3", "0,1,2,3", "1,-1,2,3", "1,2,3,4,5,6"] {
            assert!(intrinsics(bad).is_err(), "{bad}");
        }
        let given = parameters("k1=-0.2, k2=1e-3").unwrap();
        assert_eq!(
            given,
            Parameters(vec![("k1".into(), -0.2), ("k2".into(), 1e-3)])
        );
        for bad in ["", "k1", "k1=", "k1=x", "k1=nan", "k1=1,"] {
            assert!(parameters(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn vectors_may_be_negative_and_must_be_whole() {
        assert_eq!(vector("-1, 2.5,3e2"), Ok(DVec3::new(-1.0, 2.5, 300.0)));
        for bad in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,nan", "inf,0,0"] {
            assert!(vector(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn colours_are_linear_numbers_levels_or_names() {
        assert_eq!(color("1,0.5,0"), Ok(Color::new(1.0, 0.5, 0.0)));
        assert_eq!(color("#ff0000"), Ok(Color::new(1.0, 0.0, 0.0)));
        assert_eq!(color("Blue"), Ok(Color::new(0.0, 0.0, 1.0)));
        assert!(
            color("stelblue")
                .unwrap_err()
                .ends_with("did you mean steelblue?")
        );
        assert_eq!(background("transparent"), Ok(Background::Transparent));
        for wrong in [
            "",
            "#ff00",
            "1,0",
            "nothing at all",
            "transparent",
            "-1,0,0",
        ] {
            assert!(color(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_are_columns_times_rows() {
        assert_eq!(pixels("720x480"), Ok([480, 720]));
        for bad in ["720", "0x1", "-1x5", "1x1.5", "axb"] {
            assert!(pixels(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn lights_name_their_kind() {
        let point = PointLight {
            position: DVec3::new(1.0, 2.0, -3.0),
            ..PointLight::default()
        };
        assert_eq!(light("point:1,2,-3"), Ok(LightArg::Light(point.into())));
        let sun = DirectionalLight {
            direction: DVec3::NEG_Z,
            angle_degrees: 0.5,
            ..DirectionalLight::default()
        };
        assert_eq!(
            light("directional:0,0,-1@0.5"),
            Ok(LightArg::Light(sun.into()))
        );
        assert_eq!(
            light("overcast"),
            Ok(LightArg::LightRig(LightRig::Overcast))
        );
        assert!(light("sphere:0,0,5:2").is_ok());
        for wrong in [
            "directional:0,0,0",
            "sphere:1,2,3:-1",
            "point:1,2",
            "point",
            "lamp:1,2,3",
        ] {
            assert!(light(wrong).is_err(), "{wrong}");
        }
        assert!(light("1,2,3").is_err());
    }
}
