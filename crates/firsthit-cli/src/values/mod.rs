//! Parsers for values on the command line.

mod look;

use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use firsthit::camera::{Focus, PixelMatrix};
use firsthit::edge::{Dash, EdgeKind, EdgeKinds, Edges};
use firsthit::lint::KINDS;
use firsthit::load::UNITS;
use firsthit::scene::ColorBy;
use firsthit::{DVec3, Error};

pub(crate) use look::{LightArg, Sky, background, color, light, sky};

/// A camera's target: a point, or the middle of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    Auto,
    Point(DVec3),
}

/// The numbers of a text, if there are `N` finite ones that fit; `form` is what else is expected.
fn numbers<const N: usize>(
    text: &str,
    separator: char,
    form: &str,
    fits: impl FnOnce([f64; N]) -> bool,
) -> Result<[f64; N], String> {
    let parse = |part: &str| part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(separator).map(parse).collect();
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    let numbers = numbers.filter(|&numbers| fits(numbers));
    numbers.ok_or_else(|| format!("expected {form}"))
}

/// One number that fits.
fn number(text: &str, form: &str, fits: impl FnOnce(f64) -> bool) -> Result<f64, String> {
    numbers(text, ',', form, |[number]| fits(number)).map(|[number]| number)
}

/// Two whole numbers from `least` on.
fn whole_pair(text: &str, separator: char, least: usize) -> Option<[usize; 2]> {
    let (first, second) = text.split_once(separator)?;
    let parse = |part: &str| part.trim().parse().ok().filter(|&n| n >= least);
    Some([parse(first)?, parse(second)?])
}

/// The name of a variant.
pub(crate) fn named<T>(names: &'static [&'static str]) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = Error> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).try_map(|name| name.to_lowercase().parse())
}

/// The name of a kind of finding.
pub(crate) fn lint_kind() -> PossibleValuesParser {
    PossibleValuesParser::new(KINDS.iter().map(|kind| kind.name))
}

/// The name of a unit of length, as metres.
pub(crate) fn unit() -> impl TypedValueParser<Value = f64> {
    let names = UNITS.iter().map(|&(name, _)| name);
    PossibleValuesParser::new(names).try_map(|name| {
        let unit = UNITS.iter().find(|&&(known, _)| known == name);
        unit.map(|&(_, metres)| metres).ok_or("no such unit")
    })
}

/// A factor of lengths.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    number(text, "a number above 0", |factor| factor > 0.0)
}

/// The source of colours by numbers.
pub(crate) fn color_by(text: &str) -> Result<ColorBy, String> {
    text.parse().map_err(|_| {
        let words = ColorBy::NAMES.join(", ");
        format!("expected attribute:NAME for an attribute of the meshes, or {words}")
    })
}

/// Two numbers that rise.
pub(crate) fn range(text: &str) -> Result<[f64; 2], String> {
    let form = "two finite numbers that rise, such as 0,100";
    numbers(text, ',', form, |[low, high]| low < high)
}

/// A number of bytes, such as `500M`.
pub(crate) fn memory(text: &str) -> Result<u64, String> {
    let text = text.trim().to_ascii_uppercase();
    let unit = [("K", 10), ("M", 20), ("G", 30), ("T", 40)]
        .into_iter()
        .find_map(|(unit, shift)| Some((text.strip_suffix(unit)?, shift)));
    let (digits, shift) = unit.unwrap_or((&text, 0));
    let bytes: Option<u64> = digits.trim().parse().ok();
    bytes
        .and_then(|number| number.checked_mul(1 << shift))
        .filter(|&bytes| bytes > 0)
        .ok_or_else(|| "expected a whole number of bytes, or of K, M, G or T, such as 500M".into())
}

/// Two numbers.
pub(crate) fn pair(text: &str) -> Result<[f64; 2], String> {
    let form = "two finite numbers with a comma between them, such as 70,40";
    numbers(text, ',', form, |_| true)
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
    let [low, high, lasers] = numbers(text, ',', form, |[low, high, lasers]| {
        low <= high && lasers.fract() == 0.0 && (1.0..=MOST).contains(&lasers)
    })?;
    #[expect(clippy::cast_possible_truncation, reason = "it is below 2^27")]
    let last = lasers as i32 - 1;
    let step = (high - low) / f64::from(last);
    let angles = (1..last).map(|k| low + f64::from(k) * step);
    let ends = (last > 0).then_some(high);
    Ok(Elevations(std::iter::once(low).chain(angles).chain(ends).collect()))
}

/// A standard deviation: a length, and a share of the range.
pub(crate) fn noise(text: &str) -> Result<[f64; 2], String> {
    let form = "one or two finite numbers with a comma between them, such as 0.02,0.001";
    let alone = number(text, form, |_| true).map(|length| [length, 0.0]);
    alone.or_else(|_| numbers(text, ',', form, |_| true))
}

/// The class of the objects of a name.
pub(crate) fn class(text: &str) -> Result<(String, u8), String> {
    let parts = text.rsplit_once('=').filter(|(name, _)| !name.is_empty());
    let class = parts.and_then(|(name, class)| Some((name.to_owned(), class.parse().ok()?)));
    class.ok_or_else(|| "expected a name and a whole number from 0 to 255, such as ground=2".into())
}

/// Three coordinates.
pub(crate) fn vector(text: &str) -> Result<DVec3, String> {
    let form = "three finite numbers with commas between them, such as 1,-2.5,3";
    numbers::<3>(text, ',', form, |_| true).map(DVec3::from)
}

/// A ray: its origin and its direction.
pub(crate) fn ray(text: &str) -> Result<(DVec3, DVec3), String> {
    let form = "six finite numbers with commas between them, the origin and the direction, such as 0,0,10,0,0,-1";
    let [a, b, c, x, y, z] = numbers(text, ',', form, |_| true)?;
    Ok((DVec3::new(a, b, c), DVec3::new(x, y, z)))
}

/// A pixel: its row and its column.
pub(crate) fn pixel(text: &str) -> Result<[usize; 2], String> {
    whole_pair(text, ',', 0)
        .ok_or_else(|| "expected a row and a column, whole numbers from 0, such as 360,640".into())
}

/// A point to look at, or the middle of the scene.
pub(crate) fn target(text: &str) -> Result<Target, String> {
    if text == "auto" {
        return Ok(Target::Auto);
    }
    let point = vector(text).map(Target::Point);
    point.map_err(|form| format!("{form}, or auto"))
}

/// A distance or a point that is sharp.
pub(crate) fn focus(text: &str) -> Result<Focus, String> {
    let point = || vector(text).map(Focus::At);
    let focus = positive(text).map(Focus::Distance).or_else(|_| point());
    focus.map_err(|_| "expected a positive distance, or a point such as 1,2,3".into())
}

/// `NAME=VALUE`.
pub(crate) fn setting(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=');
    let (name, value) = parts.ok_or("expected a name and a value, such as reach=2")?;
    Ok((name.trim().to_owned(), value.trim().to_owned()))
}

/// `COLUMNSxROWS`, to rows and columns.
pub(crate) fn pixels(text: &str) -> Result<[usize; 2], String> {
    let size = whole_pair(text, 'x', 1).map(|[columns, rows]| [rows, columns]);
    size.ok_or_else(|| "expected columns and rows, at least 1 of each, such as 720x480".into())
}

/// `WIDTHxHEIGHT` in scene units.
pub(crate) fn lengths(text: &str) -> Result<(f64, f64), String> {
    let form = "a width and a height, both positive, such as 36x24";
    let size = numbers(text, 'x', form, |[width, height]| width > 0.0 && height > 0.0);
    size.map(<(f64, f64)>::from)
}

/// A finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    number(text, "a finite number", |_| true)
}

/// A positive number.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    number(text, "a positive number", |number| number > 0.0)
}

/// The width of lines in pixels.
pub(crate) fn line_width(text: &str) -> Result<f64, String> {
    number(text, "a number of pixels above 0, up to 1000", |width| {
        width > 0.0 && width <= Edges::WIDEST
    })
}

/// An angle between two normals.
pub(crate) fn edge_angle(text: &str) -> Result<f64, String> {
    let range = 0.0..=180.0;
    number(text, "a number of degrees from 0 to 180", |angle| range.contains(&angle))
}

/// Names of kinds of edges.
pub(crate) fn edge_kinds(text: &str) -> Result<EdgeKinds, String> {
    let known = || EdgeKind::NAMES.join(", ");
    text.parse().map_err(|_| format!("expected some of {}, with commas between", known()))
}

/// The lengths of dashes and gaps.
pub(crate) fn dash(text: &str) -> Result<Dash, String> {
    let form = "two numbers of pixels, 0.1 at least, such as 6,4";
    let fits = |[on, off]: [f64; 2]| on.min(off) >= Dash::SHORTEST;
    numbers(text, ',', form, fits).map(|[on, off]| Dash { on, off })
}

/// A number from 0 to 1.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let range = 0.0..=1.0;
    number(text, "a number from 0 to 1", |share| range.contains(&share))
}

/// Zero or a positive number.
pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    number(text, "zero or a positive number", |number| number >= 0.0)
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
    let with_skew = match text.matches(',').count() {
        3 => &format!("{text},0"),
        _ => text,
    };
    let numbers = numbers(with_skew, ',', form, |[fx, fy, ..]: [f64; 5]| fx.min(fy) > 0.0);
    numbers.map(|[fx, fy, cx, cy, skew]| PixelMatrix { fx, fy, cx, cy, skew })
}

/// Numbers with names.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parameters(pub(crate) Vec<(String, f64)>);

/// Numbers with names, as `NAME=NUMBER`, with commas between.
pub(crate) fn parameters(text: &str) -> Result<Parameters, String> {
    let one = |part: &str| {
        let (name, value) = part.split_once('=')?;
        Some((name.trim().to_owned(), finite(value).ok()?))
    };
    let all: Option<Vec<(String, f64)>> = text.split(',').map(one).collect();
    all.map(Parameters).ok_or_else(|| "expected names and numbers, such as k1=-0.2,k2=0.05".into())
}

/// A field of view in degrees.
pub(crate) fn fov(text: &str) -> Result<f64, String> {
    number(text, "degrees above 0 and up to 360", |degrees| degrees > 0.0 && degrees <= 360.0)
}

#[cfg(test)]
mod tests {
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
        assert_eq!(given, Parameters(vec![("k1".into(), -0.2), ("k2".into(), 1e-3)]));
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
    fn sizes_are_columns_times_rows() {
        assert_eq!(pixels("720x480"), Ok([480, 720]));
        for bad in ["720", "0x1", "-1x5", "1x1.5", "axb"] {
            assert!(pixels(bad).is_err(), "{bad}");
        }
    }
}
