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
