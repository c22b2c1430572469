//! Mistakes in scene files, hostile texts and limits.

use std::fs;

use firsthit::Error;
use firsthit::load::{LoadSettings, load};

use super::{model, read, refusal};

/// Texts, and how what is said of them begins.
const MISTAKES: &[(&str, &str)] = &[
    ("[camera]\npostion = [0, 0, 1]\n", "2:1: unknown key `postion`, did you mean `position`?"),
    (
        "[camera]\n  taregt = [0, 0, 1]\n",
        "2:3: unknown key `taregt`; projection = \"perspective\" takes position, aim, look_at, up, pose, convention, ray_start, columns, rows, fov, fov_axis, focal_length, width, height, fx, fy, cx, cy, skew, shift_x, shift_y, tilt_x, tilt_y, aperture, focus, projection",
    ),
    ("[camera]\ntarget = [0, 0, 1]\n", "2:1: unknown key `target`, did you mean `look_at`?"),
    ("[camrea]\nposition = [0, 0, 1]\n", "1:2: unknown key `camrea`, did you mean `camera`?"),
    (
        "[camera]\nposition = [0, 'a', 1]\n",
        "2:16: `position` must be three finite numbers, [x, y, z], got \"a\"",
    ),
    (
        "[camera]\nposition = [0, 1]\n",
        "2:12: `position` must be three finite numbers, [x, y, z], got [0, 1]",
    ),
    ("[camera]\nfov = 180\n", "2:7: `fov` must be a number between 0 and 180, got 180"),
    ("[camera]\nfov = nan\n", "2:7: `fov` must be a number between 0 and 180, got nan"),
    ("[camera]\nfov = 'wide'\n", "2:7: `fov` must be a number between 0 and 180, got \"wide\""),
    (
        "[camera]\ncolumns = 1.5\n",
        "2:11: `columns` must be a whole number from 1 to 268435456, got 1.5",
    ),
    (
        "[camera]\ncolumns = 99999999999999999999\n",
        "2:11: `columns` must be a whole number from 1 to 268435456, got 99999999999999999999",
    ),
    (
        "[camera]\nfov = 30\nwidth = 3\nheight = 2\nfocal_length = 1\n",
        "5:1: `fov` and `focal_length` exclude each other",
    ),
    ("[camera]\nlook_at = [1, 2, 3]\n", "2:1: `look_at` needs `position` beside it"),
    (
        "[camera]\nposition = [1, 2, 3]\nlook_at = [1, 2, 3]\n",
        "3:11: look_at must be another point than position, got [1, 2, 3]",
    ),
    (
        "[camera]\naim = [0, 0, -1]\nup = [0, 0, 3]\n",
        "3:6: up must be in another direction than aim, got [0, 0, 3] (aim is [0, 0, -1])",
    ),
    (
        "[camera]\nprojection = 'isometric'\n",
        "2:14: unknown projection \"isometric\"; there are \"perspective\", \"orthographic\"",
    ),
    (
        "[camera]\nprojection = 'orthografic'\nfov = 3\n",
        "2:14: unknown projection \"orthografic\", did you mean \"orthographic\"?",
    ),
    (
        "[camera]\nprojection = 'orthographic'\nfov = 3\n",
        "3:1: unknown key `fov`; projection = \"orthographic\" takes position, aim, look_at, up, pose, convention, ray_start, columns, rows, focal_length, width, height, shift_x, shift_y, projection",
    ),
    ("camera = 3\n", "1:10: `camera` must be a table, got 3"),
    ("[cameras]\nfront = 3\n", "2:1: `front` must be a table, got 3"),
    (
        "[objects]\nshape = 'box'\n",
        "1:1: `objects` must be an array of tables, [[objects]], got a table",
    ),
    ("[[objects]]\nshape = 'shpere'\n", "2:9: unknown shape \"shpere\", did you mean \"sphere\"?"),
    ("[[objects]]\nshape = 'ball'\n", "2:9: unknown shape \"ball\", did you mean \"sphere\"?"),
    (
        "[[objects]]\nsahpe = 'box'\n",
        "1:1: this object needs `shape` or `file`: unknown key `sahpe`, did you mean `shape`?",
    ),
    (
        "[[objects]]\nname = 'x'\n",
        "1:1: this object needs `shape` or `file`, shape being one of \"sphere\", \"plane\", \"disc\", \"box\", \"cylinder\", \"cone\", \"mesh\"",
    ),
    (
        "[[objects]]\nshape = 'sphere'\ncenter = [0, 0, 0]\n",
        "1:1: shape = \"sphere\" needs `radius`: a positive, finite number",
    ),
    (
        "[[objects]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = -1\n",
        "4:10: `radius` must be a positive, finite number, got -1",
    ),
    (
        "[[objects]]\nshape = 'box'\nlow = [0, 0, 0]\nhigh = [1, 1, 0]\n",
        "4:8: high must be above low along every axis, got [1, 1, 0] (low is [0, 0, 0])",
    ),
    (
        "[[objects]]\nshape = 'box'\nlow = [0, 0, 0]\nhigh = [1, 1, 1]\nscale = [1, 0, 1]\n",
        "5:9: `scale` must be a factor, or three of them, [x, y, z], none of them zero, got [1, 0, 1]",
    ),
    (
        "[[objects]]\nshape = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\nmatrix = [[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0]]\n",
        "5:10: `matrix` must make an affine map that can be undone, got an array of 3",
    ),
    (
        "[[objects]]\nshape = 'mesh'\nvertices = [[0, 0, 0]]\ntriangles = [[0, 0, 1]]\n",
        "4:13: triangles must be ",
    ),
    (
        "[[objects]]\nshape = 'mesh'\nvertices = [[0, 0, 0]]\ntriangles = [[0, 0, 0], [0, -1, 0]]\n",
        "4:25: `triangles` must be an array, each item an array of 3, each item a whole number from 0 to 4294967295, got [0, -1, 0]",
    ),
    ("[[objects]]\nshape = 'box'\nfile = 'a.obj'\n", "2:1: unknown key `shape`; "),
    ("[[lights]]\nkind = 'sun'\n", "2:8: unknown kind \"sun\", did you mean \"directional\"?"),
    (
        "[background]\ncolor = '#12345'\n",
        "2:9: `color` must be linear [red, green, blue], none of them negative, or sRGB as \"#rrggbb\" or by a CSS name, or \"transparent\", got \"#12345\"",
    ),
    (
        "[background]\ncolor = [0, -1, 0]\n",
        "2:13: `color` must be linear [red, green, blue], none of them negative, or sRGB as \"#rrggbb\" or by a CSS name, or \"transparent\", got -1",
    ),
    (
        "[background]\ncolor = [0, 1, 0]\n[sky]\nhorizon = [0, 0, 0]\nzenith = [0, 0, 0]\n",
        "3:2: `background` and `sky` exclude each other",
    ),
    (
        "[shading]\nshader = 'unlit'\nambient = [0, 0, 0]\n",
        "3:1: unknown key `ambient`; shader = \"unlit\" takes samples, light, ground, shader",
    ),
    (
        "[shading]\nlight = 'studio'\n[environment]\ncolor = 'white'\n",
        "2:9: light and [environment] exclude each other",
    ),
    ("[display]\ntone_map = 'agxx'\n", "2:12: unknown tone_map \"agxx\", did you mean \"agx\"?"),
    ("[display]\nexposure = inf\n", "2:12: `exposure` must be a finite number, got inf"),
    (
        "[[outputs]]\nfile = 'a.npz'\nchannels = ['color', 'nromal']\n",
        "3:22: unknown channels \"nromal\", did you mean \"normal\"?",
    ),
    ("version = 2\n", "1:11: `version` must be a whole number from 1 to 1, got 2"),
    ("x = 1\nx = 2\n", "2:1: this is not TOML: duplicate key"),
    ("[camera\n", "1:8: this is not TOML: "),
    ("a = \"\u{1}\"\n", "1:6: this is not TOML: "),
];

#[test]
fn mistakes_are_told_with_their_place_and_the_right_word() {
    for &(text, said) in MISTAKES {
        let found = refusal(text);
        assert!(found.starts_with(&format!("scene.toml:{said}")), "{text}\n{found}\n{said}");
    }
}

#[test]
fn columns_count_characters_and_not_bytes() {
    assert_eq!(
        refusal("\u{feff}[[objects]]\n\"größe\" = 1\n").split_once(": ").map(|(place, _)| place),
        Some("scene.toml:1:1")
    );
    let said =
        refusal("[[objects]]\nshape = 'box'\nlow = [0,0,0] # ä\nname = 'äöü'\nhigh = ['ß', x]\n");
    assert!(said.starts_with("scene.toml:5:14: "), "{said}");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("scene.toml");
    fs::write(&path, b"a = 1\nb = \xff\n").expect("room for a file");
    let said = load(&path, &LoadSettings::default()).expect_err("no UTF-8").to_string();
    assert!(said.ends_with("scene.toml:2:5: the text is not UTF-8, which TOML must be"), "{said}");
}

fn many(part: &str, count: usize) -> String {
    part.repeat(count)
}

/// So many parts, each with its number in place of the #.
fn numbered(count: u32, part: &str) -> String {
    let parts: Vec<String> = (0..count).map(|k| part.replace('#', &k.to_string())).collect();
    parts.concat()
}

fn hostile_texts() -> Vec<(&'static str, String)> {
    let mut texts = vec![
        ("nested arrays", format!("a = {}", many("[", 200_000))),
        ("nested and closed", format!("a = {}{}", many("[", 200_000), many("]", 200_000))),
        ("nested tables", format!("a = {}", many("{a=", 100_000))),
        ("a dotted key", format!("{}a = 1", many("a.", 200_000))),
        ("a dotted table", format!("[{}a]", many("a.", 200_000))),
        ("a long number", format!("version = {}", many("9", 1_000_000))),
        ("a long fraction", format!("version = 1.{}", many("9", 1_000_000))),
        ("a large exponent", "[camera]\nfov = 1e999999999999".to_owned()),
        ("a long key", format!("{} = 1", many("k", 1_000_000))),
        ("a long text", format!("[camera]\nprojection = '{}'", many("k", 1_000_000))),
    ];
    texts.extend([
        ("many keys", numbered(200_000, "k# = 1\n")),
        ("many tables", numbered(100_000, "[t#]\n")),
        ("implicit tables first", numbered(50_000, "[t#.a]\n") + &numbered(50_000, "[t#]\n")),
        ("many errors", many("= = =\n", 100_000)),
        ("quotes", many("\"\"\"", 100_001)),
        ("a wide array", format!("[camera]\nposition = [{}]", many("1,", 1_000_000))),
    ]);
    texts
}

#[test]
fn hostile_texts_end_soon_and_in_an_error() {
    let start = std::time::Instant::now();
    for (what, text) in hostile_texts() {
        let said = refusal(&text);
        assert!(said.len() < 500, "{what}: {said}");
    }
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

#[test]
fn a_hundred_thousand_objects_take_moments() {
    let ball = "[[objects]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\n";
    let start = std::time::Instant::now();
    assert_eq!(model(&ball.repeat(100_000)).world.objects.len(), 100_000);
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

/// A name of 300 kB for each of a file's 10,000 objects: 3 GB.
#[test]
fn a_name_that_many_objects_share_counts_for_each() {
    let many = (0..10_000).fold(String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n"), |text, k| {
        text + &format!("o o{k}\nf 1 2 3\n")
    });
    let name = "x".repeat(300_000);
    let text = format!("[[objects]]\nfile = 'a.obj'\nname = '{name}'\n");
    let error = read(&text, &[("a.obj", &many)]).expect_err("too large");
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
}

#[test]
fn limits_are_limits_and_not_aborts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("scene.toml");
    fs::write(&path, "# comment\n".repeat(1000)).expect("room for a file");
    let settings = LoadSettings { max_memory: 100_000, ..LoadSettings::default() };
    let error = load(&path, &settings).expect_err("too large");
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    // 1,500 objects, 1,000 times.
    let many = (0..1500).fold(String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n"), |text, k| {
        text + &format!("o o{k}\nf 1 2 3\n")
    });
    let many_times = "[[objects]]\nfile = 'a.obj'\n".repeat(1000);
    let error = read(&many_times, &[("a.obj", &many)]).expect_err("too large");
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    fs::write(folder.path().join("a.obj"), &many).expect("room for a file");
    fs::write(&path, &many_times).expect("room for a file");
    let settings = LoadSettings { max_memory: 1 << 38, ..LoadSettings::default() };
    let error = load(&path, &settings).expect_err("too many");
    assert!(matches!(error, Error::Limit { .. }), "{error}");
}
