//! How good the trees over meshes are to be.

use crate::geometry::named;

named! {
    /// How the trees over meshes are built: what building takes, against what each ray takes after. No answer depends on it.
    ///
    /// ```
    /// use firsthit::scene::{Build, BuildSettings};
    /// use firsthit::{Object, Scene, Sphere, DVec3};
    ///
    /// let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0)?);
    /// let settings = BuildSettings { build: "fast".parse::<Build>()?, ..BuildSettings::default() };
    /// assert_eq!(Scene::build(vec![ball], settings)?.objects().len(), 1);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum Build, "build":
    /// `Fast` where few rays will be shot for each triangle, `Best` where many will, or nobody knows how many.
    #[default]
    "auto" => Auto;
    /// In a third of the time or less. A ray may meet twice as many boxes, or three times.
    "fast" => Fast;
    /// The tree that rays go through in the least time.
    "best" => Best;
}

/// How the trees of a scene are built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BuildSettings {
    /// How good they are to be.
    pub build: Build,
    /// About how many rays will be shot, where that is known: pixels times samples, and those from there to lights.
    pub rays: Option<u64>,
}

/// With fewer rays than this for each triangle [`Build::Auto`] builds fast. The full build takes about 200 ns more for a triangle;
/// a ray takes 20 to 100 ns more after the fast one.
const RAYS_PER_TRIANGLE: u64 = 2;

impl BuildSettings {
    /// Whether trees over so many triangles together are to be built fast.
    pub(super) fn is_fast(self, triangles: usize) -> bool {
        match self.build {
            Build::Fast => true,
            Build::Best => false,
            Build::Auto => {
                let most = (triangles as u64).saturating_mul(RAYS_PER_TRIANGLE);
                self.rays.is_some_and(|rays| rays < most)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_rays_are_worth_a_fast_build_and_many_a_good_one() {
        let auto = |rays| BuildSettings {
            build: Build::Auto,
            rays,
        };
        assert!(auto(Some(1 << 20)).is_fast(4_000_000));
        assert!(!auto(Some(1 << 20)).is_fast(70_000));
        assert!(!auto(None).is_fast(4_000_000));
        let asked = |build| BuildSettings {
            build,
            ..auto(Some(1))
        };
        assert!(asked(Build::Fast).is_fast(1) && !asked(Build::Best).is_fast(4_000_000));
    }
}
