//! Lines in space, cut into short pieces of the picture.
//!
//! A line is halved until a piece is half a pixel long at most, or out of the picture. So pieces
//! depend on the line and the camera alone, and their middles are at shares of the line that
//! float64 holds exactly. Where the picture of a line is torn, as at the edge of a panorama, the
//! pieces beside the tear end within 2^-40 of the line.
//!
//! Where straight lines are bent in the picture, or lines are bent themselves, a part may enter the
//! picture though both its ends are outside, or not seen at all. So only parts that span a small
//! angle at the eye are given up: halves alone would miss the middle of a line that is long
//! compared with its distance.

use super::eye::{Eye, View};
use crate::geometry::{DVec2, DVec3, unit};

/// The greatest length of a piece, in pixels.
const LONGEST: f64 = 0.5;

/// The most halvings of a line, one half after the other.
const MOST_HALVES: u32 = 40;

/// The number of halvings of a line that is not straight in space in any case: it may turn back.
const BENT_HALVES: u32 = 5;

/// The cosine of the angle at the eye above which a part is halved in any case: some 2.6 degrees.
/// Over them an arc rises a seventieth of a degree above its chord.
const NARROW: f64 = 0.999;

/// Coordinates in the picture are clamped to this, in pixels, so that a box around two of them
/// stays finite. An infinite box would never be found to be beside the picture.
const FARTHEST: f64 = 1e18;

/// A piece of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// The ends in the picture.
    pub(super) ends: [DVec2; 2],
    /// The share of the line at which its middle is.
    pub(super) middle: f64,
}

/// A part of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

impl Window {
    /// Whether it overlaps the box around two points, wider by `margin`.
    pub(super) fn holds(&self, [a, b]: [DVec2; 2], margin: f64) -> bool {
        let (low, high) = (a.min(b) - margin, a.max(b) + margin);
        high.cmpge(self.low).all() && low.cmple(self.high).all()
    }
}

/// Cuts a line.
pub(super) struct Cutter<'a, F> {
    pub(super) view: &'a View<'a>,
    /// The part of the picture that needs pieces.
    pub(super) window: Window,
    /// The point of the world at a share of the line.
    pub(super) at: F,
    /// Whether the line is straight in the world.
    pub(super) is_straight: bool,
}

/// A place of a line.
#[derive(Clone, Copy)]
struct Place {
    share: f64,
    /// The point in the world.
    point: DVec3,
    /// The point in the picture, where it is seen.
    pixel: Option<DVec2>,
}

impl<F: Fn(f64) -> DVec3> Cutter<'_, F> {
    /// The pieces, in order.
    pub(super) fn pieces(&self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        self.cut([self.place(0.0), self.place(1.0)], 0, &mut pieces);
        pieces
    }

    fn place(&self, share: f64) -> Place {
        let point = (self.at)(share);
        let far = DVec2::splat(FARTHEST);
        let pixel = self.view.pixel(point);
        Place { share, point, pixel: pixel.map(|pixel| pixel.clamp(-far, far)) }
    }

    /// Whether two places are far apart as seen from the eye.
    fn is_wide(&self, [from, to]: [&Place; 2]) -> bool {
        let Eye::At(eye) = self.view.eye else {
            return false;
        };
        // A NaN, as at the eye itself, is not wide.
        unit(from.point - eye).dot(unit(to.point - eye)) < NARROW
    }

    fn cut(&self, [from, to]: [Place; 2], halves: u32, pieces: &mut Vec<Piece>) {
        let is_flat = self.is_straight && self.view.is_flat();
        let has_turned = self.is_straight || halves >= BENT_HALVES;
        let is_settled = is_flat || has_turned && !self.is_wide([&from, &to]);
        let middle = 0.5 * (from.share + to.share);
        match (from.pixel, to.pixel) {
            (Some(a), Some(b)) => {
                let length = a.distance(b);
                // Two directions near each other have nothing but directions near them between
                // them.
                if length <= LONGEST && (self.is_straight || is_settled) {
                    if self.window.holds([a, b], 0.0) {
                        let ends = [a, b];
                        pieces.push(Piece { ends, middle });
                    }
                    return;
                }
                let bulge = if is_flat { 0.0 } else { length };
                if is_settled && !self.window.holds([a, b], bulge) {
                    return;
                }
            }
            (None, None) if is_settled => return,
            _ => {}
        }
        if halves < MOST_HALVES {
            let middle = self.place(middle);
            self.cut([from, middle], halves + 1, pieces);
            self.cut([middle, to], halves + 1, pieces);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::f64::consts::TAU;

    use super::*;
    use crate::camera::{Camera, Equirectangular, Lens, RayStart, View as CameraView, Viewplane};

    fn pieces(camera: &Camera, [from, to]: [DVec3; 2]) -> Vec<Piece> {
        let cutter = Cutter {
            view: &View::new(camera),
            window: Window {
                low: DVec2::ZERO,
                high: DVec2::new(camera.columns() as f64, camera.rows() as f64),
            },
            at: |share| from + share * (to - from),
            is_straight: true,
        };
        cutter.pieces()
    }

    fn check_joined(pieces: &[Piece], gaps: usize) {
        let joints = pieces.windows(2).map(|two| two[0].ends[1].distance(two[1].ends[0]));
        assert_eq!(joints.filter(|&gap| gap > 1e-3).count(), gaps);
        assert!(pieces.iter().all(|piece| piece.ends[0].distance(piece.ends[1]) <= 0.5));
    }

    /// The line comes from behind the camera, past it, and goes far out of the picture.
    #[test]
    fn a_line_past_the_camera_is_cut_at_the_picture() {
        let on_viewplane = Camera::new(CameraView::default()).unwrap();
        let at_eye = on_viewplane.starting_at(RayStart::Eye);
        // It comes in from the right; or where the viewplane is, at a distance of 1.
        for (camera, start) in [(at_eye, 640.0), (on_viewplane, 320.0 + 480.0 * 0.1)] {
            let line = [DVec3::new(0.1, 0.0, 3.0), DVec3::new(0.1, 0.0, -50.0)];
            let pieces = pieces(&camera, line);
            check_joined(&pieces, 0);
            assert!(pieces.len() < 2000, "{}", pieces.len());
            let (first, last) = (pieces[0].ends[0], pieces[pieces.len() - 1].ends[1]);
            assert!((first.x - start).abs() <= 0.5 && (first.y - 240.0).abs() < 1e-9);
            assert!((last.x - (320.0 + 480.0 * 0.1 / 50.0)).abs() < 1e-9);
        }
    }

    /// Numbers that no camera has, as a file may give them: a circle is cut a few thousand times.
    #[test]
    fn extreme_cameras_end_too() {
        let sizes = [1e-300, 1e-30, 1e-9, 1e-3, 1.0, 1e3, 1e9, 1e30, 1e300];
        let mut worst = 0;
        for far in [0.0, 1e-9, 0.5, 1.0, 3.0, 1e3, 1e9, 1e30] {
            for focal_length in sizes {
                for width in sizes {
                    for (parallel, ray_start) in [
                        (false, RayStart::Eye),
                        (false, RayStart::Viewplane),
                        (true, RayStart::Eye),
                        (true, RayStart::Viewplane),
                    ] {
                        let lens = Lens::Flat(Viewplane {
                            focal_length,
                            width,
                            height: width,
                            parallel,
                            ray_start,
                            ..Viewplane::default()
                        });
                        let view = CameraView {
                            position: DVec3::new(0.0, 0.1 * far, far),
                            lens,
                            ..CameraView::default()
                        };
                        let Ok(camera) = Camera::new(view) else {
                            continue;
                        };
                        let asked = Cell::new(0_u32);
                        let cutter = Cutter {
                            view: &View::new(&camera),
                            window: Window { low: DVec2::ZERO, high: DVec2::new(640.0, 480.0) },
                            at: |share: f64| {
                                asked.set(asked.get() + 1);
                                assert!(
                                    asked.get() < 1_000_000,
                                    "{far} {focal_length} {width} {parallel} {ray_start:?}"
                                );
                                let (sine, cosine) = libm::sincos(share * TAU);
                                DVec3::new(cosine, sine, 0.3 * cosine)
                            },
                            is_straight: false,
                        };
                        cutter.pieces();
                        worst = worst.max(asked.get());
                    }
                }
            }
        }
        assert!(worst < 20_000, "{worst}");
    }

    #[test]
    fn a_line_across_the_seam_of_a_panorama_is_torn_there() {
        let lens = Lens::Equirectangular(Equirectangular::default());
        let view = CameraView { lens, rows: 180, columns: 360, ..CameraView::default() };
        let camera = Camera::new(view).unwrap();
        let line = [DVec3::new(-1.0, 0.2, 2.0), DVec3::new(1.0, 0.2, 2.0)];
        let pieces = pieces(&camera, line);
        check_joined(&pieces, 1);
        let total: f64 = pieces.iter().map(|piece| piece.ends[0].distance(piece.ends[1])).sum();
        // 2 atan(1 / 2) across; and it is a bit higher in the middle.
        let across = 2.0 * libm::atan(0.5).to_degrees();
        assert!(total > across && total < across + 1.0, "{total} {across}");
    }
}
