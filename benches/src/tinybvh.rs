//! tinybvh's `BVH8_CPU`, opened at run time as `benches/tinybvh.cpp` is compiled: arrays of rays at
//! scenes of one mesh, one by one.
#![expect(unsafe_code, reason = "tinybvh is a C++ library; every block says what it rests on")]

use std::cell::RefCell;
use std::ffi::c_void;
use std::hint::black_box;
use std::path::Path;

use firsthit::{Hits, Ray, Scene};

use crate::firsthit_side;
use crate::measure;
use crate::rows::Shot;

type Build = unsafe extern "C" fn(*const [f32; 4], u32) -> *mut c_void;
type Free = unsafe extern "C" fn(*mut c_void);
type FirstHits = unsafe extern "C" fn(*const c_void, *const Line, usize, *mut f32, *mut u32);
type AnyHits = unsafe extern "C" fn(*const c_void, *const Line, usize, *mut u32);

/// tinybvh's code.
#[derive(Debug)]
pub(crate) struct Library {
    build: Build,
    free: Free,
    first_hits: FirstHits,
    any_hits: AnyHits,
    _opened: libloading::Library,
}

impl Library {
    /// Opens the shared library at `path`.
    pub(crate) fn open(path: &Path) -> Result<Self, String> {
        let said = |error: libloading::Error| format!("{}: {error}", path.display());
        // SAFETY: the caller names what benches/tinybvh.cpp was compiled to: it has no initialisers
        // of its own, and its functions have these types. They are kept beside the library.
        unsafe {
            let library = libloading::Library::new(path).map_err(said)?;
            Ok(Self {
                build: *library.get::<Build>(b"tinybvh_build").map_err(said)?,
                free: *library.get::<Free>(b"tinybvh_free").map_err(said)?,
                first_hits: *library.get(b"tinybvh_first_hits").map_err(said)?,
                any_hits: *library.get(b"tinybvh_any_hits").map_err(said)?,
                _opened: library,
            })
        }
    }
}

/// A ray as the library takes it.
#[repr(C)]
struct Line([f32; 7]);

impl Line {
    fn of(ray: &Ray) -> Self {
        /// The far value, tinybvh's `BVH_FAR`.
        const FAR: f64 = 1e30;
        let [a, b, c] = ray.origin.to_array();
        let [x, y, z] = ray.direction.to_array();
        Self([a, b, c, x, y, z, ray.t_max.min(FAR)].map(|x| x as f32))
    }
}

/// A tree over one mesh.
#[derive(Debug)]
pub(crate) struct Tree<'a> {
    library: &'a Library,
    handle: *mut c_void,
    /// Read by the tree.
    _corners: Vec<[f32; 4]>,
}

/// A row's time beside firsthit's in the same turns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Beside {
    pub(crate) nanoseconds: f64,
    /// The time divided by firsthit's.
    pub(crate) ratio: f64,
    /// Rays with another outcome or another triangle.
    pub(crate) other: usize,
}

impl<'a> Tree<'a> {
    /// The tree of a scene of one mesh that is not moved.
    pub(crate) fn new(library: &'a Library, scene: &Scene) -> Option<Self> {
        let [object] = scene.objects() else {
            return None;
        };
        let mesh = object.mesh().filter(|_| object.transform().is_identity())?;
        let corner = |&vertex: &u32| {
            let [x, y, z] = mesh.positions().get(vertex).to_array();
            [x as f32, y as f32, z as f32, 0.0]
        };
        let corners: Vec<_> = mesh.triangles().iter().flatten().map(corner).collect();
        // SAFETY: there are three corners for each triangle, and they live as long as the tree.
        let handle = unsafe { (library.build)(corners.as_ptr(), corners.len() as u32 / 3) };
        Some(Self { library, handle, _corners: corners })
    }

    /// The rays of a row, where they are an array and one hit is asked for.
    pub(crate) fn beside(&self, scene: &Scene, shot: &Shot, rounds: u32) -> Option<Beside> {
        let (rays, is_first) = match shot {
            Shot::First(rays) => (rays, true),
            Shot::Any(rays) => (rays, false),
            _ => return None,
        };
        let lines: Vec<Line> = rays.iter().map(Line::of).collect();
        let answers = RefCell::new((vec![0.0_f32; rays.len()], vec![0_u32; rays.len()]));
        let mut theirs = || {
            let (t, numbers) = &mut *answers.borrow_mut();
            let (tree, count) = (self.handle.cast_const(), lines.len());
            // SAFETY: the tree is alive, and there are `count` lines and as many answers of each
            // kind.
            unsafe {
                if is_first {
                    let (t, numbers) = (t.as_mut_ptr(), numbers.as_mut_ptr());
                    (self.library.first_hits)(tree, lines.as_ptr(), count, t, numbers);
                } else {
                    (self.library.any_hits)(tree, lines.as_ptr(), count, numbers.as_mut_ptr());
                }
            }
        };
        let (mut hits, mut found) = (Hits::default(), Vec::new());
        let mut ours = || {
            if is_first {
                firsthit_side::first_hits(scene, &**rays, &mut hits);
            } else {
                found = black_box(firsthit_side::any_hits(scene, rays));
            }
        };
        let times = measure::in_turns(rounds, rays.len(), &mut [&mut ours, &mut theirs]);
        let (t, numbers) = &*answers.borrow();
        let is_other = |&k: &usize| {
            if !is_first {
                return (numbers[k] == 1) != found[k];
            }
            let hit = hits.get(k);
            let is_miss = t[k] >= lines[k].0[6];
            is_miss != hit.is_miss() || (!is_miss && numbers[k] as i32 != hit.primitive)
        };
        Some(Beside {
            nanoseconds: times[1].min,
            ratio: times[1].min / times[0].min,
            other: (0..rays.len()).filter(is_other).count(),
        })
    }
}

impl Drop for Tree<'_> {
    fn drop(&mut self) {
        // SAFETY: the tree is alive, and nothing else holds it.
        unsafe { (self.library.free)(self.handle) }
    }
}
