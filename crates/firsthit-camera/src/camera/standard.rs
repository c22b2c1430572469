//! The standard views of a model: front, top, three-quarter, ...

use crate::geometry::{DVec3, named, unit};

named! {
    /// A standard view of a model, for any up direction.
    ///
    /// The front faces -y if z is up, as in CAD and 3D printing, and +z if y is up, as in glTF and
    /// OBJ; in both, x points to the right of the picture. Left and right are those of a viewer who
    /// faces the front.
    pub enum StandardView, "view":
    /// Three quarters: the front, the right side and the top at once.
    #[default]
    "iso" => Iso;
    /// The front.
    "front" => Front;
    /// The back.
    "back" => Back;
    /// The left side.
    "left" => Left;
    /// The right side.
    "right" => Right;
    /// The view from straight above, the front at the lower edge of the picture.
    "top" => Top;
    /// The view from straight below, the front at the upper edge of the picture.
    "bottom" => Bottom;
}

impl StandardView {
    /// The aim and the up of a camera with this view, both of length one, in a world in which `up`
    /// is up. In views from above and below, the camera's up is not the world's.
    ///
    /// A zero or non-finite `up` is returned as it is, for [`Camera::new`](super::Camera::new) to
    /// refuse.
    ///
    /// ```
    /// use firsthit::{DVec3, camera::StandardView};
    ///
    /// let (aim, up) = StandardView::Front.aim_and_up(DVec3::Z);
    /// assert_eq!((aim, up), (DVec3::Y, DVec3::Z));
    /// let (aim, up) = StandardView::Top.aim_and_up(DVec3::Y);
    /// assert_eq!((aim, up), (DVec3::NEG_Y, DVec3::NEG_Z));
    /// ```
    pub fn aim_and_up(self, up: DVec3) -> (DVec3, DVec3) {
        let above = unit(up);
        if above.is_nan() {
            // The camera refuses it, by its name.
            return (DVec3::NEG_Z, up);
        }
        let front = if above.y.abs() < 0.9 { DVec3::NEG_Y } else { DVec3::Z };
        let front = unit(front.reject_from_normalized(above));
        let right = above.cross(front);
        match self {
            // From equal angles the far corner of a box would hide behind the near one.
            Self::Iso => (-unit(front + 0.6 * right + 0.55 * above), above),
            Self::Front => (-front, above),
            Self::Back => (front, above),
            Self::Left => (right, above),
            Self::Right => (-right, above),
            Self::Top => (-above, -front),
            Self::Bottom => (above, front),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, View};

    #[test]
    fn every_view_is_upright_for_any_up() {
        let ups = [
            DVec3::Z,
            DVec3::Y,
            DVec3::X,
            DVec3::NEG_Z,
            DVec3::NEG_Y,
            DVec3::new(0.3, -2.0, 1.0),
            DVec3::splat(1e200),
        ];
        for up in ups {
            for &standard in StandardView::ALL {
                let (aim, picture_up) = standard.aim_and_up(up);
                let view = View { aim, up: picture_up, ..View::default() };
                let camera = Camera::new(view).unwrap();
                let above = camera.upwards().dot(unit(up));
                match standard {
                    StandardView::Top | StandardView::Bottom => assert!(above.abs() < 1e-15),
                    StandardView::Iso => assert!(above > 0.5 && camera.aim().dot(unit(up)) < -0.3),
                    _ => assert!((above - 1.0).abs() < 1e-15, "{standard:?} {up}"),
                }
            }
        }
    }

    #[test]
    fn left_is_opposite_to_right_and_so_are_the_others() {
        use StandardView::{Back, Bottom, Front, Left, Right, Top};
        for up in [DVec3::Z, DVec3::Y] {
            let aim = |view: StandardView| view.aim_and_up(up).0;
            for (one, other) in [(Front, Back), (Left, Right), (Top, Bottom)] {
                assert_eq!(aim(one), -aim(other));
            }
            // Seen from the front, x is to the right.
            assert_eq!(aim(Right), DVec3::NEG_X);
        }
    }

    #[test]
    fn names_are_what_is_parsed() {
        for &view in StandardView::ALL {
            assert_eq!(view.name().parse::<StandardView>().unwrap(), view);
        }
        let error = "side".parse::<StandardView>().unwrap_err();
        let message = "view must be one of iso, front, back, left, right, top, bottom, got 'side'";
        assert_eq!(error.to_string(), message);
    }
}
