//! Which lights count, and which shader takes them.

use crate::support::{ABOVE, Lab};

/// The colours that a picture has with some options.
fn colors(lab: &Lab, file: &str, options: &str) -> Vec<f64> {
    lab.ok(&format!(
        "render {file} {ABOVE} --no-ground --samples 1 --channels color -o a.npz {options}"
    ));
    lab.npz("a.npz").remove("color").unwrap().values
}

/// The program's messages about a picture.
fn said(lab: &Lab, file: &str, options: &str) -> String {
    let render = format!("render {file} {ABOVE} --no-ground --samples 1 {options}");
    lab.ok(&render).stderr
}

fn scene(lab: &Lab, name: &str, words: &str) {
    let object = "[[objects]]\nfile = \"square.ply\"\n";
    lab.write(name, format!("{words}\n{object}"));
}

/// The first of two sets counted, and lights beside a set were ignored.
#[test]
fn lights_that_would_be_ignored_are_refused() {
    let lab = Lab::new();
    lab.write("a.hdr", b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80");
    for (options, words) in [
        ("--light headlight --light sun", "--light takes one set of lights, not headlight and sun"),
        (
            "--light point:0,0,4 --light sun",
            "--light sun, a set of lights, and --light point, a light, exclude each other",
        ),
        (
            "--light sun --environment a.hdr",
            "--light sun, a set of lights, and --environment exclude each other",
        ),
    ] {
        lab.fails(&format!("render gone.ply {options}"), 2, words);
    }
}

/// The file's set of lights won.
#[test]
fn lights_of_the_command_line_replace_the_file_s_set() {
    let lab = Lab::with_square();
    scene(&lab, "a.toml", "[shading]\nlight = \"studio\"");
    let light = "--light point:0.5,0,4";
    let by_file = colors(&lab, "a.toml", "");
    assert_eq!(by_file, colors(&lab, "square.ply", "--light studio"));
    let own = colors(&lab, "a.toml", light);
    assert_ne!(own, by_file);
    assert_eq!(own, colors(&lab, "square.ply", light));
}

/// A spot that goes past the middle of the scene was infinitely bright.
#[test]
fn a_spot_is_as_bright_where_it_goes_as_a_point_would_be() {
    let lab = Lab::with_square();
    let spot = colors(&lab, "square.ply", "--light spot:0.5,0,3:0,0,-1:0.1499999:0.15");
    let point = colors(&lab, "square.ply", "--light point:0.5,0,3");
    let black = colors(&lab, "square.ply", "--light point:0.5,0,-3");
    let is_point = spot.iter().zip(&point).filter(|(a, b)| a == b).count();
    let is_black = spot.iter().zip(&black).filter(|(a, b)| a == b).count();
    let differs = point.iter().zip(&black).filter(|(a, b)| a != b).count();
    // Either, but not at the same pixels; beside the square both.
    assert!(spot.iter().all(|x| x.is_finite()));
    assert_eq!(is_point + is_black, 2 * spot.len() - differs);
    assert!(is_point > spot.len() - differs && is_black > spot.len() - differs);
}

#[test]
fn a_light_that_shines_away_from_the_whole_scene_is_told() {
    let lab = Lab::with_square();
    let words = "shines away from the whole scene";
    for (light, is_away) in [
        ("disc:0,0,3:0,0,1:1", true),
        ("disc:0,0,3:0,0,-1:1", false),
        // From the side it still reaches the far end.
        ("disc:0,0,3:1,0,0:1", false),
        ("rectangle:0,0,3:1,0,0:0,1,0", true),
        ("rectangle:0,0,3:0,1,0:1,0,0", false),
    ] {
        let said = said(&lab, "square.ply", &format!("--light {light}"));
        assert_eq!(said.contains(words), is_away, "{light}: {said}");
    }
    let unlit = said(&lab, "square.ply", "--light disc:0,0,3:0,0,1:1 --shader unlit");
    assert!(!unlit.contains(words), "{unlit}");
}

#[test]
fn a_background_behind_an_environment_that_is_seen_does_nothing() {
    let lab = Lab::with_square();
    lab.write("a.hdr", b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80");
    scene(&lab, "a.toml", "[environment]\ncolor = [0.5, 0.5, 0.5]");
    let given = "square.ply --environment a.hdr";
    for (file, options, words) in [
        (
            given,
            "--background red",
            Some(
                "--background does nothing without --environment-hidden: the environment is seen in its place\n",
            ),
        ),
        (given, "--sky red:blue", Some("--sky does nothing without --environment-hidden")),
        (given, "--background transparent", Some("is seen in its place, and there is no alpha\n")),
        (
            "a.toml",
            "--background red",
            Some("--background does nothing here: the file's environment is seen"),
        ),
        (given, "--background red --environment-hidden", None),
        (given, "", None),
    ] {
        let said = said(&lab, file, options);
        match words {
            Some(words) => assert!(said.contains(words), "{file} {options}: {said}"),
            None => assert!(!said.contains("does nothing"), "{file} {options}: {said}"),
        }
    }
}

/// The sky was seen, and the program said that it did nothing.
#[test]
fn an_environment_does_nothing_with_unlit_only_where_it_is_hidden() {
    let lab = Lab::with_square();
    lab.write("a.hdr", b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80");
    let unlit = "--shader unlit --environment a.hdr";
    let seen = said(&lab, "square.ply", unlit);
    assert!(!seen.contains("does nothing"), "{seen}");
    assert_eq!(colors(&lab, "square.ply", unlit)[0], 0.5);
    let hidden = said(&lab, "square.ply", &format!("{unlit} --environment-hidden"));
    let words = "warning: --environment does nothing with --shader unlit";
    assert!(hidden.contains(words), "{hidden}");
}

/// The sun of the file's sky stayed when the sky was replaced.
#[test]
fn an_environment_takes_the_sun_of_the_one_that_it_replaces_away() {
    let lab = Lab::with_square();
    lab.write("a.hdr", b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80");
    scene(&lab, "a.toml", "[environment]\ndaylight = { elevation = 60 }\nstrength = 0.5");
    let given = "--environment a.hdr";
    let replaced = colors(&lab, "a.toml", given);
    assert_ne!(replaced, colors(&lab, "a.toml", ""));
    assert_eq!(replaced, colors(&lab, "square.ply", given));
}

/// The shader became lambert.
#[test]
fn ambient_light_is_that_of_the_file_s_shader() {
    let lab = Lab::with_square();
    for shader in ["phong", "blinn-phong", "ghost", "whitted"] {
        let words = format!("[shading]\nshader = \"{shader}\"\nlight = \"headlight\"");
        scene(&lab, "a.toml", &words);
        scene(&lab, "b.toml", &format!("{words}\nambient = [0.5, 0.25, 0]"));
        let render = |file: &str, options: &str| {
            colors(&lab, file, options);
            lab.read("a.npz")
        };
        let given = render("a.toml", "--ambient 0.5,0.25,0");
        assert!(given == render("b.toml", ""), "{shader}");
        assert!(given != render("a.toml", ""), "{shader}");
    }
    scene(&lab, "a.toml", "[shading]\nshader = \"path\"");
    lab.fails(
        "render a.toml --ambient 0.1,0.1,0.1",
        2,
        "--ambient: the file's shader path has no ambient light; with --shader one of whitted, lambert, phong, blinn-phong, ghost has it",
    );
    scene(&lab, "a.toml", "");
    let plain = colors(&lab, "a.toml", "--ambient 0.5,0,0");
    let named = colors(&lab, "a.toml", "--ambient 0.5,0,0 --shader lambert");
    assert_eq!(plain, named);
}

/// It became `direct` with any setting.
#[test]
fn light_over_the_shoulder_goes_with_lambert() {
    let lab = Lab::with_square();
    let plain = colors(&lab, "square.ply", "--light shoulder");
    // Nothing throws a shadow here.
    assert_eq!(plain, colors(&lab, "square.ply", "--light shoulder --no-shadows"));
    lab.ok("render square.ply --size 8x8 --light shoulder --set ambient=0.1");
}

#[test]
fn a_shader_without_settings_says_so() {
    let lab = Lab::with_square();
    for (shader, words) in [
        ("unlit", "--set reach: the shader unlit has no settings"),
        ("ao", "--set roulette: the shader ao has the settings reach"),
    ] {
        let setting = words.split([' ', ':']).nth(1).unwrap();
        lab.fails(&format!("render square.ply --shader {shader} --set {setting}=1"), 2, words);
    }
}

/// The set that the help calls the default had no ground when it was asked for by name, and was
/// black in rooms.
#[test]
fn the_default_set_by_its_name_is_the_default() {
    let lab = Lab::with_square();
    for camera in [ABOVE, "--position 0.1,0.1,0 --aim 1,0,0 --size 24x12"] {
        let colors = |options: &str| {
            let render = "render square.ply --channels color --samples 4 -o a.npz";
            lab.ok(&format!("{render} {camera} {options}"));
            lab.npz("a.npz").remove("color").unwrap().values
        };
        assert_eq!(colors(""), colors("--light auto"));
    }
}

/// A warning tells what an environment does not light.
#[test]
fn an_environment_that_lights_nothing_is_told() {
    let lab = Lab::with_square();
    lab.write("a.hdr", b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80");
    let told = said(&lab, "square.ply", "--environment a.hdr --shader lambert");
    assert!(told.contains("--environment is a background alone with --shader lambert"), "{told}");
    assert_eq!(said(&lab, "square.ply", "--environment a.hdr --shader direct").lines().count(), 1);
}

#[test]
fn a_ground_that_is_seen_from_below_is_told() {
    let lab = Lab::with_square();
    for (height, is_unseen) in [(-5, true), (5, false)] {
        let camera = format!("--position 0,-3,{height} --look-at 0,0,0 --up 0,0,1 --size 8x6");
        let said = |options: &str| {
            let render = format!("render square.ply {camera} --samples 1 -o a.png {options}");
            lab.ok(&render).stderr
        };
        let words = "--ground does nothing here: the camera is below it";
        assert_eq!(said("--ground").contains(words), is_unseen, "{height}");
        assert!(!said("").contains(words), "{height}");
    }
}

/// The walls would keep all of it out.
#[test]
fn light_that_fills_shadows_does_so_in_a_closed_room() {
    let lab = Lab::new();
    let room = "[[objects]]\nshape = \"box\"\nlow = [-5, -5, -5]\nhigh = [5, 5, 5]\n";
    let ball = "[[objects]]\nshape = \"sphere\"\ncenter = [0, 0, -1]\nradius = 2\n";
    let light = "[[lights]]\nkind = \"point\"\nposition = [0, 0, 4]\nintensity = [9, 9, 9]\n";
    lab.write("room.toml", format!("{room}{ball}{light}"));
    let darkest = |options: &str| {
        let camera = "--position 0,-4.5,-4 --look-at 0,0,-5 --up 0,0,1 --size 16x12";
        lab.ok(&format!(
            "render room.toml {camera} --samples 4 --channels color -o a.npz {options}"
        ));
        let colors = lab.npz("a.npz").remove("color").unwrap().values;
        colors.into_iter().fold(f64::INFINITY, f64::min)
    };
    assert_eq!(darkest("--shader direct"), 0.0);
    assert!(darkest("") > 0.0);
}
