//! The reasons why an object is or is not the first hit.

use crate::geometry::{Side, names};
use crate::shoot::Rejection;

/// Makes [`Reason`] and what depends on the list of reasons.
macro_rules! reasons {
    ($($(#[$doc:meta])* $kind:ident $name:literal $about:literal;)*) => {
        /// The reason why an object is or is not a ray's first hit. Those that say more about the
        /// ray come first.
        ///
        /// ```
        /// use firsthit::explain::Reason;
        ///
        /// assert_eq!(Reason::BoxMissed.name(), "box_missed");
        /// assert_eq!(Reason::BoxMissed.about(), "box missed");
        /// assert_eq!(Reason::ALL[0], Reason::Hit);
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Reason {
            $($(#[$doc])* $kind,)*
        }

        names! { Reason, "reason": $($name => $kind;)* }

        impl Reason {
            /// The meaning for the object, for people.
            pub fn about(self) -> &'static str {
                match self { $(Self::$kind => $about,)* }
            }
        }
    };
}

reasons! {
    /// The object is what the ray meets first.
    Hit "hit" "the hit";
    /// The ray meets it at the same `t`, but its identifier is higher.
    Tied "tied" "met at the same t, but with a higher identifier";
    /// The ray meets it behind the hit.
    BehindHit "behind_hit" "met behind the hit";
    /// The ray would meet its front, and passes through fronts.
    CulledFront "culled_front" "front side culled";
    /// The ray would meet its back, and passes through backs.
    CulledBack "culled_back" "back side culled";
    /// The ray would meet it where the alpha of its material cuts it out.
    CutOut "cut_out" "cut out by alpha where it would be met";
    /// The ray would meet it where it is told to skip the surface.
    Skipped "skipped" "skipped where it would be met";
    /// The ray starts on its surface and leaves it.
    Left "left" "left by the ray";
    /// The ray would meet it beyond its end, `t_max`.
    BeyondEnd "beyond_end" "met only beyond the ray's end";
    /// The ray would meet it behind its start, `t_min`.
    BehindStart "behind_start" "met only behind the ray's start";
    /// The ray meets the object's box but not its surface.
    SurfaceMissed "surface_missed" "box met, surface missed";
    /// The ray meets the object's box behind the hit, but not its surface.
    BoxBehindHit "box_behind_hit" "box behind the hit";
    /// The object's box is beyond the ray's end.
    BoxBeyondEnd "box_beyond_end" "box beyond the ray's end";
    /// The object's box is behind the ray's start.
    BoxBehindStart "box_behind_start" "box behind the ray's start";
    /// The line of the ray does not meet its box.
    BoxMissed "box_missed" "box missed";
    /// The object has no surface.
    Empty "empty" "no surface";
    /// The numbers of the object, or of the ray in its space, are too large for float64.
    OutOfRange "out_of_range" "numbers out of range";
    /// The ray is not valid.
    NoRay "no_ray" "the ray meets nothing";
    /// The masks of the object and the ray have no bit in common.
    Masked "masked" "left out by the masks";
    /// The object is not among those that were asked for: neither in
    /// [`among`](super::ExplainSettings::among) nor [`only`](crate::geometry::RayFilter::only).
    NotAmong "not_among" "not among the objects that were asked for";
    /// The object is hidden.
    Hidden "hidden" "hidden";
}

impl From<Rejection> for Reason {
    fn from(rejection: Rejection) -> Self {
        match rejection {
            Rejection::Left => Self::Left,
            Rejection::Skipped => Self::Skipped,
            Rejection::Culled(Side::Front) => Self::CulledFront,
            Rejection::Culled(Side::Back) => Self::CulledBack,
            Rejection::CutOut => Self::CutOut,
            Rejection::BeyondEnd => Self::BeyondEnd,
            Rejection::BehindStart => Self::BehindStart,
        }
    }
}
