//! The filters, which transform attributes after unpacking.

use super::super::problem::Problem;
use crate::error::escape_controls;
use crate::geometry::single;

/// Refuses a filter that is not known, or that does not go with the size of elements.
pub(super) fn check(filter: &str, stride: usize) -> Result<(), Problem> {
    let fits = match filter {
        "NONE" | "EXPONENTIAL" => true,
        "OCTAHEDRAL" | "COLOR" => stride == 4 || stride == 8,
        "QUATERNION" => stride == 8,
        _ => return Err(format!("filter '{}' is not known", escape_controls(filter)).into()),
    };
    if fits {
        Ok(())
    } else {
        Err(format!("filter {filter} does not go with a byteStride of {stride}").into())
    }
}

/// Applies a filter that was checked.
pub(super) fn apply(filter: &str, stride: usize, bytes: &mut [u8]) {
    match (filter, stride) {
        ("OCTAHEDRAL", 4) => each_byte(bytes, |v| octahedral(v.map(signed), 127.0)),
        ("OCTAHEDRAL", _) => each_short(bytes, |v| octahedral(v.map(signed_short), 32767.0)),
        ("QUATERNION", _) => each_short(bytes, |v| quaternion(v.map(signed_short))),
        ("COLOR", 4) => each_byte(bytes, |v| color(v.map(i32::from), v.map(signed), 255.0)),
        ("COLOR", _) => {
            each_short(bytes, |v| color(v.map(i32::from), v.map(signed_short), 65535.0));
        }
        ("EXPONENTIAL", _) => {
            for word in bytes.as_chunks_mut::<4>().0 {
                *word = exponential(i32::from_le_bytes(*word)).to_le_bytes();
            }
        }
        _ => {}
    }
}

fn signed(byte: u8) -> i32 {
    i8::from_le_bytes([byte]).into()
}

fn signed_short(short: u16) -> i32 {
    i16::from_le_bytes(short.to_le_bytes()).into()
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the low bits are meant"
)]
fn each_byte(bytes: &mut [u8], filter: impl Fn([u8; 4]) -> [i32; 4]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        *element = filter(*element).map(|value| value as u8);
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the low bits are meant"
)]
fn each_short(bytes: &mut [u8], filter: impl Fn([u16; 4]) -> [i32; 4]) {
    for [a, b, c, d, e, f, g, h] in bytes.as_chunks_mut::<8>().0 {
        let shorts = [[*a, *b], [*c, *d], [*e, *f], [*g, *h]].map(u16::from_le_bytes);
        let [p, q, r, s] = filter(shorts).map(|value| (value as u16).to_le_bytes());
        ([*a, *b], [*c, *d], [*e, *f], [*g, *h]) = (p, q, r, s);
    }
}

/// Rounds to the nearest whole number; NaN becomes zero.
#[expect(clippy::cast_possible_truncation, reason = "saturates")]
fn whole(value: f64) -> i32 {
    value.round() as i32
}

/// A direction from its place on an octahedron (Meyer et al., "On Floating-Point Normal Vectors",
/// 2010); the third number is what stands for one.
fn octahedral([x, y, one, fourth]: [i32; 4], largest: f64) -> [i32; 4] {
    let one = f64::from(one);
    let (x, y) = (f64::from(x) / one, f64::from(y) / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let scale = largest / (x * x + y * y + z * z).sqrt();
    [whole(x * scale), whole(y * scale), whole(z * scale), fourth]
}

/// A quaternion from its three smaller components; the fourth number is what stands for one, with
/// the place of the largest component in its lowest two bits.
fn quaternion([x, y, z, fourth]: [i32; 4]) -> [i32; 4] {
    let scale = std::f64::consts::FRAC_1_SQRT_2 / f64::from(fourth | 3);
    let small = [x, y, z].map(|value| scale * f64::from(value));
    let rest = 1.0 - small.iter().map(|value| value * value).sum::<f64>();
    let [x, y, z] = small.map(|value| whole(32767.0 * value));
    let largest = whole(32767.0 * rest.max(0.0).sqrt());
    match fourth & 3 {
        0 => [largest, x, y, z],
        1 => [z, largest, x, y],
        2 => [y, z, largest, x],
        _ => [x, y, z, largest],
    }
}

/// `2^e * m`, of an exponent of 8 bits and a mantissa of 24.
fn exponential(code: i32) -> f32 {
    let (exponent, mantissa) = (code >> 24, (code << 8) >> 8);
    single(f64::from(mantissa) * libm::exp2(f64::from(exponent)))
}

/// A colour from luma and chroma (`YCoCg`); the highest bit of alpha tells how many bits there are.
fn color(levels: [i32; 4], [_, orange, green, _]: [i32; 4], largest: f64) -> [i32; 4] {
    let [luma, _, _, alpha] = levels;
    let bits = 32 - alpha.leading_zeros();
    let ones = (1_i32 << bits.min(30)) - 1;
    let scale = largest / f64::from(ones);
    let alpha = alpha & (ones >> 1);
    let alpha = (alpha << 1) | (alpha & 1);
    let rgb = [luma + orange - green, luma + green, luma - orange - green];
    let [red, green, blue] = rgb.map(|level| whole(scale * f64::from(level)));
    [red, green, blue, whole(scale * f64::from(alpha))]
}
