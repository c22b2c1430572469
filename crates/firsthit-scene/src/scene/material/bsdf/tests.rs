//! The invariants of scattering: glTF's numbers, energy, and draws that agree with the density.

use std::f64::consts::PI;

use super::*;
use crate::sampling::Draws;
use crate::sampling::warp;

/// No metal, roughness 0.5, white.
fn plastic() -> Layers {
    Layers {
        base: Color::ONE,
        metallic: 0.0,
        roughness: 0.5,
        ior: 1.5,
        specular: 1.0,
        specular_color: Color::ONE,
        transmission: 0.0,
        absorption: None,
        coat: (0.0, 0.0, DVec3::Z),
        sheen: (Color::ZERO, 0.0),
    }
}

fn metal(roughness: f64) -> Layers {
    Layers { metallic: 1.0, roughness, ..plastic() }
}

fn glass(ior: f64, roughness: f64) -> Layers {
    Layers { transmission: 1.0, roughness, ior, absorption: Some(Color::ZERO), ..plastic() }
}

/// One of each kind that spreads light over many directions.
fn spread() -> Vec<(&'static str, Layers)> {
    let coat = (1.0, 0.5, unit(DVec3::new(0.1, 0.0, 1.0)));
    let base = Color::new(0.9, 0.5, 0.1);
    vec![
        ("plastic", plastic()),
        ("rough plastic", Layers { roughness: 1.0, base, ..plastic() }),
        ("metal", metal(0.4)),
        ("half a metal", Layers { metallic: 0.5, base, ..plastic() }),
        ("coated", Layers { base, coat, ..metal(0.8) }),
        ("cloth", Layers { sheen: (Color::splat(0.8), 0.5), ..plastic() }),
        ("diamond", Layers { ior: 2.4, specular_color: Color::new(1.0, 0.3, 0.2), ..plastic() }),
        ("rough window", Layers { transmission: 0.8, base, ..plastic() }),
        ("rough glass", glass(1.5, 0.5)),
        ("rough air in glass", glass(1.0 / 1.5, 0.5)),
    ]
}

fn at(degrees: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    DVec3::new(0.6 * sin, 0.8 * sin, cos)
}

fn seen(layers: &Layers, out: DVec3) -> Bsdf {
    let frame = Frame { normal: DVec3::Z, geometric: DVec3::Z, out };
    Bsdf::layered(frame, true, layers)
}

/// The mean over all directions of a function, times 4 pi.
fn over_all(count: u32, of: impl Fn(DVec3) -> Color) -> Color {
    let direction = |k| {
        let u = Draws::new(1, k).two();
        warp::cap(u, 2.0)
    };
    let sum: Color = (0..count).map(|k| of(direction(k))).sum();
    4.0 * PI * sum / f64::from(count)
}

/// The albedo in white light from all directions (a furnace test), by sampling.
fn furnace(bsdf: &Bsdf, count: u32) -> Color {
    let one = |k| {
        let drawn = bsdf.sample(Draws::new(7, k).three());
        drawn.map_or(Color::ZERO, |drawn| drawn.weight)
    };
    (0..count).map(one).sum::<Color>() / f64::from(count)
}

/// The albedo by a sum over directions, with more of them from the side and from where [`at`] is:
/// fibres are brightest there, and sampling finds it slowly.
fn summed(bsdf: &Bsdf) -> Color {
    const STEPS: u32 = 128;
    let (along, across) = (DVec3::new(0.6, 0.8, 0.0), DVec3::new(-0.8, 0.6, 0.0));
    let [x, y, z] = albedo::mean([STEPS, STEPS], |row, column| {
        let (sin, cos) = libm::sincos(PI * column * column);
        let height = row * row;
        let level = (1.0 - height * height).sqrt() * (cos * along + sin * across);
        let value = bsdf.value(level + height * DVec3::Z);
        (8.0 * row * column * value).to_array()
    });
    let branches = bsdf.branches().map(|branch| branch.weight);
    Color::new(x, y, z) + branches.sum::<Color>()
}

/// The first numbers of `../shared/light/public/06_gltf_brdf.json`, each twice the value.
#[test]
fn values_are_those_of_the_appendix_of_gltf() {
    let light = DVec3::new(0.423_999_152_002_544, 0.317_999_364_001_908, 0.847_998_304_005_088);
    let red = Color::new(0.8, 0.3, 0.1);
    let aside =
        DVec3::new(-0.620_173_672_946_042_2, -0.248_069_469_178_416_9, 0.744_208_407_535_250_6);
    let grazing = DVec3::new(0.961_523_947_640_823_3, 0.0, 0.274_721_127_897_378_1);
    for (layers, out, expected) in [
        (
            Layers { base: red, ..plastic() },
            DVec3::Z,
            [1.371_978_343_646_354_8, 0.557_900_042_938_383],
        ),
        (
            Layers { base: red, roughness: 0.15, ..plastic() },
            aside,
            [1.347_810_766_713_569_3, 0.533_974_645_744_835],
        ),
        (
            Layers { base: Color::new(1.0, 0.78, 0.34), ..metal(0.3) },
            aside,
            [8.837_280_953_916_412, 6.893_657_693_501_81],
        ),
        (Layers { base: Color::splat(0.9), ..metal(1.0) }, grazing, [0.679_777_229_889_730_8; 2]),
        (
            Layers { base: Color::splat(0.5), metallic: 0.5, roughness: 0.6, ..plastic() },
            aside,
            [1.496_437_927_855_149_4; 2],
        ),
    ] {
        let value = 2.0 * seen(&layers, out).value(light);
        assert!((value.x - expected[0]).abs() < 1e-9 * expected[0], "{value} {expected:?}");
        assert!((value.y - expected[1]).abs() < 1e-9 * expected[1], "{value} {expected:?}");
    }
}

#[test]
fn what_is_drawn_is_what_is_there() {
    const COUNT: u32 = 1 << 13;
    for (name, layers) in spread() {
        for degrees in [0.0, 50.0, 80.0] {
            let bsdf = seen(&layers, at(degrees));
            let there = over_all(COUNT, |towards| bsdf.value(towards)) / PI;
            let drawn = furnace(&bsdf, COUNT);
            // Directions over the whole sphere find a lobe of roughness 0.4 with a percent of them.
            let close = 0.02 * there.max_element();
            assert!(
                (there - drawn).abs().max_element() < close,
                "{name} {degrees}: {there} {drawn}"
            );
        }
    }
}

/// The reference: the share of draws in each octant of directions is the integral of the pdf over
/// it.
#[test]
fn directions_are_drawn_as_often_as_their_pdf_says() {
    const COUNT: u32 = 1 << 14;
    let octant = |v: DVec3| {
        (usize::from(v.x > 0.0)) + 2 * usize::from(v.y > 0.0) + 4 * usize::from(v.z > 0.0)
    };
    let mut all = spread();
    all.push(("matte", plastic()));
    for (name, layers) in all {
        for degrees in [0.0, 50.0, 80.0] {
            let bsdf = match name {
                "matte" => Bsdf::matte(unit(DVec3::new(0.3, -0.2, 1.0)), Color::ONE),
                _ => seen(&layers, at(degrees)),
            };
            let mut drawn = [0.0; 8];
            for k in 0..COUNT {
                if let Some(sample) = bsdf.sample(Draws::new(3, k).three()) {
                    drawn[octant(sample.towards)] += 1.0 / f64::from(COUNT);
                    let known = sample.pdf.expect("nothing here is smooth");
                    let pdf = bsdf.pdf(sample.towards);
                    assert!((pdf - known).abs() <= 1e-6 * known, "{name} {pdf} {known}");
                }
            }
            for (which, drawn) in drawn.into_iter().enumerate() {
                let here = |towards| {
                    if octant(towards) == which { bsdf.pdf(towards) } else { 0.0 }
                };
                let pdf = over_all(COUNT, |towards| Color::splat(here(towards))).x;
                assert!((pdf - drawn).abs() < 0.02, "{name} {degrees} {which}: {pdf} {drawn}");
            }
            assert!(drawn.iter().sum::<f64>() > 0.5, "{name} {degrees}");
        }
    }
}

/// The coat has a normal of its own: where the base's normal map turns away from the light, the
/// coat reflects it all the same.
#[test]
fn a_coat_is_not_turned_by_the_normal_of_its_base() {
    let (sin, cos) = libm::sincos(60.0_f64.to_radians());
    let (out_sin, out_cos) = libm::sincos(40.0_f64.to_radians());
    let frame = Frame {
        normal: DVec3::new(sin, 0.0, cos),
        geometric: DVec3::Z,
        out: DVec3::new(out_sin, 0.0, out_cos),
    };
    let expected = 0.04 + 0.96 * libm::pow(1.0 - out_cos, 5.0);
    let smooth = Layers { coat: (1.0, 0.0, DVec3::Z), ..plastic() };
    let branches: Vec<_> = Bsdf::layered(frame, true, &smooth).branches().collect();
    assert_eq!(branches.len(), 1);
    assert!((branches[0].towards - DVec3::new(-out_sin, 0.0, out_cos)).length() < 1e-12);
    assert!((branches[0].weight - Color::splat(expected)).length() < 1e-12);
    // Nearly as much by a coat that is a little rough, of a black base.
    let rough =
        Layers { coat: (1.0, 0.2, DVec3::Z), base: Color::ZERO, specular: 0.0, ..plastic() };
    let got = furnace(&Bsdf::layered(frame, true, &rough), 1 << 12).x;
    assert!((got / expected - 1.0).abs() < 0.05, "{got} {expected}");
}

/// Every kind, smooth and rough, seen from ahead and up to a tenth of a degree from the side.
#[test]
fn no_surface_gives_more_than_it_gets_seen_from_any_side() {
    let cloth = |roughness| Layers { sheen: (Color::ONE, roughness), ..plastic() };
    let coated = |roughness, coat| Layers { coat: (1.0, coat, DVec3::Z), roughness, ..plastic() };
    for roughness in [0.0, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0] {
        let rough = |layers| Layers { roughness, ..layers };
        let window = Layers { transmission: 0.7, ..rough(plastic()) };
        let diamond = Layers { ior: 2.4, ..rough(plastic()) };
        let pearl = Layers {
            ior: 2.4,
            specular: 0.5,
            specular_color: Color::new(1.0, 0.7, 0.4),
            ..rough(plastic())
        };
        let half = Layers { metallic: 0.5, ..rough(plastic()) };
        for (name, layers) in [
            ("plastic", rough(plastic())),
            ("diamond", diamond),
            ("pearl", pearl),
            ("metal", metal(roughness)),
            ("half a metal", half),
            ("window", window),
            ("glass", glass(1.5, roughness)),
            ("cloth", cloth(roughness)),
            ("polished cloth", Layers { roughness: 0.0, ..cloth(roughness) }),
            ("smooth coat", coated(roughness, 0.0)),
            ("rough coat", coated(0.5, roughness)),
        ] {
            for degrees in [0.0, 30.0, 60.0, 75.0, 80.0, 85.0, 88.0, 89.0, 89.5, 89.9] {
                let bsdf = seen(&layers, at(degrees));
                let albedo = if layers.sheen.0 == Color::ZERO {
                    furnace(&bsdf, 1 << 12)
                } else {
                    summed(&bsdf)
                };
                let albedo = albedo.max_element();
                assert!(albedo < 1.002, "{name} {roughness} {degrees}: {albedo}");
            }
        }
    }
}

/// The specular lobe leaves the rest to the diffuse base: only interreflection between microfacets
/// and light that may not return are lost.
#[test]
fn white_plastic_stays_white_seen_from_the_side() {
    for (degrees, least) in [(0.0, 0.95), (60.0, 0.95), (80.0, 0.98), (89.0, 0.98)] {
        for roughness in [0.0, 0.2, 0.5] {
            let layers = Layers { roughness, ..plastic() };
            let albedo = furnace(&seen(&layers, at(degrees)), 1 << 12).x;
            assert!(albedo > least, "{degrees} {roughness}: {albedo}");
        }
    }
}

/// Single scattering loses the light that microfacets send to each other: the specification has it
/// so.
#[test]
fn a_white_metal_loses_as_much_as_single_scattering_does() {
    let cosine: f64 = 0.95;
    let out = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    for (roughness, expected) in [(0.2, 0.9982), (0.6, 0.8196), (1.0, 0.3168)] {
        let albedo = furnace(&seen(&metal(roughness), out), 1 << 13);
        assert!((albedo.x - expected).abs() < 1e-3, "{roughness}: {albedo}");
    }
    assert_eq!(furnace(&seen(&metal(0.0), out), 16), Color::ONE);
}

#[test]
fn light_may_go_either_way() {
    for (name, layers) in spread() {
        // The coat is reciprocal only where light and looks are equally steep (its extension takes
        // the cosine of one).
        if layers.coat.0 > 0.0 || layers.absorption.is_some() {
            continue;
        }
        for (a, b) in [
            (at(35.0), unit(DVec3::new(-0.5, 0.3, 0.4))),
            (at(35.0), unit(DVec3::new(-0.5, 0.3, -0.4))),
            (at(86.0), unit(DVec3::new(-0.5, 0.3, 0.4))),
            (at(86.0), unit(DVec3::new(0.5, -0.7, 0.03))),
        ] {
            // From below, the viewer sees the other side of the same wall.
            let side = b.z.signum();
            let there = seen(&layers, a).value(b) / b.z.abs();
            let turned = |v: DVec3| DVec3::new(v.x, v.y, side * v.z);
            let back = seen(&layers, turned(b)).value(turned(a)) / a.z;
            assert!((there - back).abs().max_element() < 1e-12, "{name}: {there} {back}");
        }
    }
}

/// Through a rough boundary both ways differ by the square of the indices.
#[test]
fn rough_refraction_may_go_either_way() {
    let (above, below) = (at(35.0), unit(DVec3::new(-0.3, -0.35, -0.8)));
    let frame = |normal: DVec3, out| Frame { normal, geometric: normal, out };
    let layers = glass(1.5, 0.5);
    let outside = Bsdf::layered(frame(DVec3::Z, above), true, &layers);
    let inside = Bsdf::layered(frame(DVec3::NEG_Z, below), false, &layers);
    let into = outside.value(below) / below.z.abs();
    let out = inside.value(above) / above.z;
    assert!(into.x > 0.01 && (into * 1.5 * 1.5 - out).abs().max_element() < 1e-12, "{into} {out}");
}

#[test]
fn glass_of_index_one_is_not_there() {
    for degrees in [0.0, 40.0, 89.0] {
        let out = at(degrees);
        let branches: Vec<_> = seen(&glass(1.0, 0.0), out).branches().collect();
        let expected = BsdfSample { towards: -out, weight: Color::ONE, pdf: None };
        assert_eq!(branches, [expected], "{degrees}");
    }
}

#[test]
fn glass_reflects_and_lets_through_by_fresnel_and_draws_so() {
    let out = at(75.0);
    let bsdf = seen(&glass(1.5, 0.0), out);
    let branches: Vec<_> = bsdf.branches().collect();
    let [mirrored, through] = &branches[..] else { panic!("{branches:?}") };
    assert!((mirrored.weight.x - 0.253_060_562_990_319_7).abs() < 1e-12);
    let passed = 1.0 - 0.253_060_562_990_319_7;
    assert!((through.weight.x * 1.5 * 1.5 - passed).abs() < 1e-12);
    assert!((mirrored.towards - DVec3::new(-out.x, -out.y, out.z)).length() < 1e-15);
    let drawn = |u| bsdf.sample([0.3, 0.6, u]).unwrap();
    assert_eq!(drawn(0.74).towards, through.towards);
    assert_eq!(drawn(0.75).towards, mirrored.towards);
    assert!((drawn(0.75).weight - Color::ONE).length() < 1e-12);
    assert!(bsdf.value(mirrored.towards) == Color::ZERO && bsdf.pdf(through.towards) == 0.0);
}

#[test]
fn inside_of_glass_light_is_absorbed_and_outside_it_is_not() {
    let absorption = Color::new(0.1, 0.2, 0.3);
    let layers = Layers { absorption: Some(absorption), ..glass(1.5, 0.0) };
    let frame = |out| Frame { normal: DVec3::Z, geometric: DVec3::Z, out };
    let entering = Bsdf::layered(frame(at(30.0)), true, &layers);
    assert_eq!(
        (entering.beyond(DVec3::NEG_Z), entering.beyond(DVec3::Z)),
        (Some(absorption), None)
    );
    let leaving = Bsdf { is_front: false, ..Bsdf::layered(frame(at(30.0)), false, &layers) };
    assert_eq!(leaving.behind(), Some(absorption));
    assert_eq!((leaving.beyond(DVec3::NEG_Z), entering.behind()), (Some(Color::ZERO), None));
    let window = Layers { absorption: None, ..layers };
    assert_eq!(seen(&window, at(30.0)).beyond(DVec3::NEG_Z), None);
}

#[test]
fn a_window_is_seen_straight_through_in_its_colour() {
    let base = Color::new(0.5, 1.0, 0.25);
    let layers = Layers { transmission: 1.0, roughness: 0.0, base, ..plastic() };
    let out = at(20.0);
    let through: Vec<_> = seen(&layers, out).branches().filter(|one| one.towards == -out).collect();
    let share = 1.0 - fresnel::schlick(Color::splat(0.04), out.z).x;
    assert!((through[0].weight - share * base).length() < 1e-12);
}
