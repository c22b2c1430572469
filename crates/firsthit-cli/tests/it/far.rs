//! Scenes far from the origin, as in coordinates of a country.

use crate::support::Lab;

/// A square of 20 m, where UTM has it.
const FAR: &str = "v 500000.125 4649776.25 100\nv 500020.125 4649776.25 100\nv 500020.125 4649796.25 100\n\
    v 500000.125 4649796.25 100\nf 1 2 3 4\n";

#[test]
fn places_are_told_to_a_millionth_of_the_scene() {
    let lab = Lab::new();
    lab.write("far.obj", FAR);
    let has = |arguments: &str, words: &str| {
        let outcome = lab.run(arguments);
        let said = format!("{}{}", outcome.text(), outcome.stderr);
        assert!(said.contains(words), "{arguments}: {said}");
    };
    has("info far.obj", "bounds     500000.125,4649776.25,100 to 500020.125,4649796.25,100");
    let ray = "probe far.obj --ray 500003.8765432,4649777.5,107,0,0,-1";
    has(ray, "ray        from 500003.87654,4649777.5,107 along 0,0,-1");
    has(ray, "position 500003.87654,4649777.5,100");
    has(
        "section far.obj --normal 1,0,0 --origin 500003.8765432,4649777.5,100",
        "through 500003.87654,4649777.5,100, normal 1,0,0",
    );
    has("lint far.obj", "500000.125,");
    lab.ok("render far.obj --size 8x6 --samples 1 --position 500003.875,4649777.5,107 --aim 0,0,-1 --up 0,1,0 -o a.npz");
    has("info a.npz", " 500003.875,4649777.5,107\n");
}

#[test]
fn a_quarter_of_a_metre_lost_in_float32_is_told() {
    let lab = Lab::new();
    lab.write("far.obj", FAR);
    let render =
        "render far.obj --size 8x6 --position 500010.3,4649786.3,120 --aim 0,0,-1 --up 0,1,0";
    let outcome =
        lab.ok(&format!("{render} --channels position -o a.exr -o a.npz -o a.ply -o a.pcd"));
    let warnings: Vec<&str> =
        outcome.stderr.lines().filter(|line| line.contains("warning")).collect();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("a.exr: position as float32 is off by up to 0."), "{warnings:?}");
    assert!(lab.ok("diff a.ply a.pcd").text().contains("position: equal\n"));
    let told = lab.ok("diff a.exr a.npz").text().to_owned();
    assert!(told.starts_with("position: equal as float32; largest difference 0."), "{told}");
    let off = warnings[0].split(' ').find_map(|word| word.trim_end_matches(';').parse().ok());
    let largest = told.split(' ').find_map(|word| word.parse().ok());
    let [off, largest]: [f64; 2] = [off, largest].map(Option::unwrap);
    assert!((off - largest).abs() < 1e-5 * off && off > 0.1, "{off} {largest}");
}

#[test]
fn one_hit_near_the_origin_is_well_told_by_float32() {
    let lab = Lab::with_square();
    let render = "render square.ply --size 1x1 --position 0.1,0.1,5 --aim 0,0,-1 --up 0,1,0";
    let outcome = lab.ok(&format!("{render} --channels position -o a.exr -o a.pcd"));
    assert!(!outcome.stderr.contains("warning"), "{}", outcome.stderr);
    assert!(String::from_utf8_lossy(&lab.read("a.pcd")).contains("\nSIZE 4 4 4\n"));
}

#[test]
fn one_hit_in_coordinates_of_a_country_keeps_its_digits() {
    let lab = Lab::new();
    let far = "[[objects]]\nshape = \"sphere\"\ncenter = [500000.3, 4500000.2, 300]\nradius = 1\n";
    lab.write("far.toml", far);
    let render =
        "render far.toml --size 1x1 --position 500000.3,4499990,300 --aim 0,1,0 --up 0,0,1";
    let outcome = lab.ok(&format!("{render} --channels position -o a.exr -o a.pcd"));
    assert!(
        outcome.stderr.contains("position as float32 is off by up to 0."),
        "{}",
        outcome.stderr
    );
    assert!(String::from_utf8_lossy(&lab.read("a.pcd")).contains("\nSIZE 8 8 8\n"));
}
