//! The word that was probably meant.

use strsim::damerau_levenshtein;

/// Longer words are no slip of the finger, and comparing them would take long.
const LONGEST: usize = 40;

/// The word among `known` that `word` is a misspelling of, in any case: by the distance of Damerau
/// and Levenshtein, one slip in every third letter at most.
///
/// ```
/// use firsthit::scene_file::nearest_word;
/// assert_eq!(nearest_word("Normals", ["color", "normal"]), Some("normal"));
/// assert_eq!(nearest_word("x", ["color", "normal"]), None);
/// ```
pub fn nearest_word<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() > LONGEST {
        return None;
    }
    let plain = word.to_ascii_lowercase();
    let distance = |other: &str| damerau_levenshtein(&plain, other);
    // At most a third of the characters, so that most of the word remains.
    let is_near = |other: &&str| distance(other) <= (other.len().max(plain.len()) / 3).min(3);
    let near = known.into_iter().filter(is_near);
    near.min_by_key(|other| distance(other))
}

/// The word among `known` that `word` is a misspelling of, or another word for.
pub(super) fn suggestion(word: &str, known: &[&'static str]) -> Option<&'static str> {
    let plain = word.to_ascii_lowercase().replace('-', "_");
    let synonym = || {
        let ours = OTHER_WORDS.iter().filter(|(theirs, _)| *theirs == plain);
        ours.map(|&(_, ours)| ours).find(|ours| known.contains(ours))
    };
    nearest_word(&plain, known.iter().copied()).or_else(synonym)
}

/// Words that people use, and ours for the same thing.
const OTHER_WORDS: &[(&str, &str)] = &[
    ("target", "look_at"),
    ("eye", "position"),
    ("origin", "position"),
    ("location", "position"),
    ("direction", "aim"),
    ("forward", "aim"),
    ("field_of_view", "fov"),
    ("size", "columns"),
    ("resolution", "columns"),
    ("viewplane", "width"),
    ("path", "file"),
    ("mesh", "file"),
    ("type", "shape"),
    ("type", "kind"),
    ("kind", "shape"),
    ("offset", "translate"),
    ("position", "translate"),
    ("orientation", "rotate"),
    ("transform", "matrix"),
    ("material", "color"),
    ("faces", "triangles"),
    ("indices", "triangles"),
    ("angle", "degrees"),
    ("name", "file"),
    ("output", "outputs"),
    ("light", "lights"),
    ("object", "objects"),
    ("depth", "z"),
    ("cube", "box"),
    ("ball", "sphere"),
    ("sun", "directional"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_finger_are_understood() {
        let known = ["position", "aim", "up", "look_at", "focal_length", "columns"];
        for (word, meant) in [
            ("postion", Some("position")),
            ("Position", Some("position")),
            ("look-at", Some("look_at")),
            ("lookat", Some("look_at")),
            ("target", Some("look_at")),
            ("focallength", Some("focal_length")),
            ("cloumns", Some("columns")),
            ("aims", Some("aim")),
            ("xyz", None),
            ("", None),
        ] {
            assert_eq!(suggestion(word, &known), meant, "{word}");
        }
        assert_eq!(suggestion(&"position".repeat(100_000), &known), None);
    }
}
