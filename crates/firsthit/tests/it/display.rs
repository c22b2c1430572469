//! Display transforms of linear colours: exposure, tone maps, and where they are applied.

use std::io::Cursor;
use std::path::Path;

use firsthit::geometry::srgb_encode;
use firsthit::image::{
    Channel, Data, Display, FORMATS, Frame, Holds, Stored, WriteSettings, format_named, read_bytes,
};
use firsthit::{Color, DisplayTransform, Error, ToneMap};
use serde_json::Value;

/// A row of the oracle: a linear colour, stops, what Khronos PBR Neutral makes of it, and the bytes
/// with it and without.
type Row = ([f64; 3], f64, [f64; 3], [u8; 3], [u8; 3]);

/// Some rows of `../shared/light/public/09_display.json`: below and above the start of the
/// compression, and far above.
const ROWS: [Row; 5] = [
    ([0.18; 3], 0.0, [0.14; 3], [105; 3], [118; 3]),
    (
        [0.5, 0.25, 0.05],
        1.0,
        [0.869_090_909_090_909_1, 0.422_528_876_206_006_3, 0.065_279_249_898_084_02],
        [240, 174, 72],
        [255, 188, 89],
    ),
    (
        [4.0, 1.0, 0.2],
        0.0,
        [0.983_255_813_953_488_4, 0.468_299_173_594_918_74, 0.330_977_402_832_633_55],
        [253, 182, 156],
        [255, 255, 124],
    ),
    (
        [0.02, 0.05, 0.9],
        0.0,
        [0.007_558_611_607_061_345, 0.035_974_912_857_134_1, 0.841_103_448_275_862_1],
        [21, 53, 236],
        [39, 63, 243],
    ),
    ([100.0; 3], 1.0, [0.999_711_191_335_74; 3], [255; 3], [255; 3]),
];

fn display(exposure: f64, tone_map: ToneMap) -> DisplayTransform {
    DisplayTransform { exposure, tone_map }
}

/// A picture of one row of colours, or of premultiplied colours and alpha.
fn picture(colors: &[Vec<f64>]) -> Frame {
    let mut frame = Frame::new([1, colors.len()]);
    let data = Data::Float64(colors.concat());
    let channel = Channel::new("color", colors[0].len(), data, Display::Color);
    frame.push(channel).unwrap();
    frame
}

fn encode(format: &str, frame: &Frame, settings: WriteSettings) -> Vec<u8> {
    let mut bytes = Vec::new();
    let format = format_named(format).unwrap();
    (format.encode(frame, None, settings, &mut bytes, Path::new("-"))).unwrap();
    bytes
}

fn with(display: DisplayTransform) -> WriteSettings {
    WriteSettings { display, ..WriteSettings::default() }
}

/// The bytes of the pixels, as another reader sees them, and what the file says of its colours.
fn shown(frame: &Frame, display: DisplayTransform) -> (Vec<u8>, Stored) {
    let bytes = encode("png", frame, with(display));
    let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    let read = read_bytes(Path::new("a.png"), &bytes, 1 << 20).unwrap();
    let stored = read.metadata.unwrap().channels.remove(0).stored.unwrap();
    (pixels, stored)
}

fn check(rows: &[Row]) {
    for (linear, stops, neutral, neutral_bytes, bytes) in rows {
        let map = display(*stops, ToneMap::Neutral);
        let got = map.apply(Color::from(*linear));
        assert!(got.abs_diff_eq(Color::from(*neutral), 1e-6), "{linear:?} {got}");
        let frame = picture(&[linear.to_vec()]);
        assert_eq!(shown(&frame, map).0, neutral_bytes, "{linear:?}");
        let none = display(*stops, ToneMap::None);
        assert_eq!(shown(&frame, none).0, bytes, "{linear:?}");
    }
}

#[test]
fn khronos_neutral_is_the_published_formula() {
    check(&ROWS);
}

#[test]
#[ignore = "needs ../shared/light"]
fn khronos_neutral_agrees_with_the_oracle() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/light/public/09_display.json");
    let case: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let row = |row: &Value| -> Row {
        let three = |key: &str| serde_json::from_value(row[key].clone()).unwrap();
        let bytes = |key: &str| serde_json::from_value(row[key].clone()).unwrap();
        let stops = row["exposure"].as_f64().unwrap();
        let all = (three("linear"), stops, three("neutral"));
        (all.0, all.1, all.2, bytes("neutral_srgb8"), bytes("none_srgb8"))
    };
    let rows: Vec<Row> = case["table"].as_array().unwrap().iter().map(row).collect();
    assert!(rows.len() >= 10);
    check(&rows);
}

/// From 2^-20 to 2^20, in sixteenths of a stop.
fn greys() -> impl Iterator<Item = f64> {
    (-320..=320).map(|k| libm::exp2(f64::from(k) / 16.0))
}

#[test]
fn brighter_greys_are_never_shown_darker() {
    for &tone_map in ToneMap::ALL {
        let mut before = Color::ZERO;
        for grey in greys() {
            let now = tone_map.apply(Color::splat(grey));
            assert!(now.cmpge(before).all(), "{tone_map:?} {grey}: {now} {before}");
            before = now;
        }
        let white = srgb_encode(before.min_element()) * 255.0;
        assert!(white > 254.5, "{tone_map:?}: {white}");
    }
}

/// As docs/outputs.md says.
#[test]
fn white_stays_white_without_a_tone_map_and_leaves_room_with_one() {
    for (tone_map, byte) in ToneMap::ALL.iter().zip([255, 240, 202, 206]) {
        let (pixels, _) = shown(&picture(&[vec![1.0; 3]]), display(0.0, *tone_map));
        assert_eq!(pixels, [byte; 3], "{tone_map:?}");
    }
}

#[test]
fn black_is_black() {
    for &tone_map in ToneMap::ALL {
        assert!(tone_map.apply(Color::ZERO).max_element() < 1e-12, "{tone_map:?}");
    }
}

/// The sums of the rows of AgX's outset differ by 2.3e-4, and the power makes 2.2 times as much of
/// it: an eighth of a byte at most. Those of the ACES fit differ by 1e-5 in both matrices.
#[test]
fn grey_stays_grey() {
    for (tone_map, off) in [
        (ToneMap::None, 0.0),
        (ToneMap::Neutral, 1e-15),
        (ToneMap::Agx, 5.1e-4),
        (ToneMap::Aces, 2e-5),
    ] {
        for grey in greys() {
            let shown = tone_map.apply(Color::splat(grey));
            let spread = shown.max_element() - shown.min_element();
            assert!(spread <= off, "{tone_map:?} {grey}: {spread}");
        }
    }
}

#[test]
fn whatever_a_colour_holds_is_shown_from_0_to_1() {
    let extremes = [
        0.0,
        -0.0,
        -1.0,
        f64::NEG_INFINITY,
        f64::NAN,
        f64::MIN_POSITIVE,
        5e-324,
        0.5,
        1e300,
        f64::MAX,
        f64::INFINITY,
    ];
    for &tone_map in ToneMap::ALL {
        for exposure in [0.0, -2000.0, 2000.0, f64::MAX, f64::MIN] {
            for r in extremes {
                for g in extremes {
                    let shown = display(exposure, tone_map).apply(Color::new(r, g, 0.25));
                    let is_fine = |level: f64| (0.0..=1.0).contains(&level);
                    assert!(shown.to_array().into_iter().all(is_fine), "{tone_map:?} {r} {g}");
                }
            }
        }
    }
}

/// From the same formulas in NumPy, with the sigmoid solved for and the matrices applied there.
#[test]
fn agx_and_aces_agree_with_another_program() {
    for (tone_map, color, expected) in [
        (ToneMap::Agx, [0.18; 3], [0.217_584_14, 0.217_651_62, 0.217_655_81]),
        (ToneMap::Agx, [1.0, 0.0, 0.0], [0.719_938_64, 0.039_261_32, 0.039_327_55]),
        (ToneMap::Agx, [4.0, 1.0, 0.2], [0.929_598_14, 0.619_080_19, 0.349_203_98]),
        (ToneMap::Aces, [0.18; 3], [0.105_591_25, 0.105_591_25, 0.105_590_19]),
        (ToneMap::Aces, [1.0, 0.0, 0.0], [0.688_027_87, 0.0, 0.002_639_01]),
        (ToneMap::Aces, [4.0, 1.0, 0.2], [0.997_160_81, 0.663_380_65, 0.281_856_34]),
    ] {
        let shown = tone_map.apply(Color::from(color));
        assert!(shown.abs_diff_eq(Color::from(expected), 1e-8), "{tone_map:?} {shown}");
    }
}

#[test]
fn the_default_shows_colours_as_they_are() {
    let colors = [vec![0.0, 0.25, 1.0], vec![0.5, f64::NAN, f64::INFINITY]];
    let (pixels, stored) = shown(&picture(&colors), DisplayTransform::default());
    let bytes = |linear: &f64| format!("{:.0}", (srgb_encode(*linear) * 255.0).round());
    let expected: Vec<String> = colors.concat().iter().map(bytes).collect();
    let got: Vec<String> = pixels.iter().map(ToString::to_string).collect();
    assert_eq!(got, expected);
    assert_eq!((stored.exposure, stored.tone_map), (None, None));
}

#[test]
fn a_png_says_how_its_colours_are_shown() {
    let frame = picture(&[vec![0.1, 0.2, 0.3]]);
    let (_, stored) = shown(&frame, display(-1.5, ToneMap::Agx));
    assert_eq!((stored.exposure, stored.tone_map.as_deref()), (Some(-1.5), Some("agx")));
}

/// A colour behind glass of half a pixel is shown as the same colour in a whole one.
#[test]
fn transparent_pixels_are_shown_as_the_colours_that_alpha_is_divided_out_of() {
    let (color, alphas) = ([4.0, 1.0, 0.25], [1.0, 0.5, 0.125]);
    let whole = picture(&[color.to_vec()]);
    let premultiplied = alphas.map(|alpha| {
        let [r, g, b] = color.map(|level| level * alpha);
        vec![r, g, b, alpha]
    });
    let clear = vec![0.0; 4];
    let parts = picture(&[&premultiplied[..], &[clear]].concat());
    for &tone_map in ToneMap::ALL {
        let map = display(0.5, tone_map);
        let rgb = shown(&whole, map).0;
        let (pixels, _) = shown(&parts, map);
        let expected: Vec<[u8; 4]> = [255, 128, 32]
            .map(|alpha| [rgb[0], rgb[1], rgb[2], alpha])
            .into_iter()
            .chain([[0; 4]])
            .collect();
        assert_eq!(pixels, expected.concat(), "{tone_map:?}");
    }
}

#[test]
fn other_formats_and_other_channels_are_as_they_were() {
    let bright = with(display(3.0, ToneMap::Aces));
    let usual = WriteSettings::default();
    let mut frame = picture(&[vec![0.1, 2.0, 30.0], vec![0.5, 0.5, 0.5]]);
    let position = Data::Float64(vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    let position = Channel::new("position", 3, position, Display::Position);
    for format in FORMATS.iter().filter(|format| format.holds == Holds::AllChannels) {
        let same = encode(format.name, &frame, bright) == encode(format.name, &frame, usual);
        assert!(same, "{}", format.name);
    }
    let npy = |settings| encode("npy", &frame, settings);
    assert_eq!(npy(bright), npy(usual));
    frame.push(position).unwrap();
    for cloud in ["ply", "pcd"] {
        let same = encode(cloud, &frame, bright) == encode(cloud, &frame, usual);
        assert!(same, "{cloud}");
    }
    for (name, components, shown_as) in [
        ("t", 1, Display::Distance),
        ("normal", 3, Display::Direction),
        ("position", 3, Display::Position),
        ("base_color", 3, Display::Fraction),
        ("quality", 1, Display::Quantity),
    ] {
        let mut other = Frame::new([1, 2]);
        let data = Data::Float64((0..2 * components).map(|k| k as f64 / 6.0).collect());
        other.push(Channel::new(name, components, data, shown_as)).unwrap();
        assert_eq!(encode("png", &other, bright), encode("png", &other, usual), "{name}");
    }
}

#[test]
fn an_exposure_that_is_no_number_is_refused() {
    let frame = picture(&[vec![0.5; 3]]);
    let png = format_named("png").unwrap();
    for stops in [f64::NAN, f64::INFINITY] {
        let refused = png.check(&frame, None, with(display(stops, ToneMap::None)));
        assert!(matches!(refused, Err(Error::Argument { name: "exposure", .. })));
    }
}

#[test]
fn tone_maps_have_names() {
    assert_eq!(ToneMap::NAMES, ["none", "neutral", "agx", "aces"]);
    assert_eq!("agx".parse::<ToneMap>().unwrap(), ToneMap::Agx);
    let message = "filmic".parse::<ToneMap>().unwrap_err().to_string();
    assert_eq!(message, "tone_map must be one of none, neutral, agx, aces, got 'filmic'");
}
