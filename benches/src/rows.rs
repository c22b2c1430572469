//! The rows of the table: which rays, and both sides' times for them.

mod rays;

use std::cell::RefCell;
use std::hint::black_box;
use std::sync::Mutex;

use firsthit::shoot::AllHits;
use firsthit::{Camera, Hits, Ray, Rays, Scene};
use rayon::ThreadPool;

use crate::check::Judge;
use crate::embree::{Answers, Columns, Door, FlushToZero, Gathered, Pixels, Source};
use crate::firsthit_side;
use crate::measure::{self, Timing};
use crate::picture::Picture;
use crate::report::Report;
use crate::row::{DOORS, Measured, Row};
use crate::scenes::{BenchScene, Look};
use crate::settings::Settings;
use crate::tinybvh;
use crate::tree::Trees;
use crate::visits::Tree;
use rays::Surface;

/// Measures all rows that were asked for.
pub(crate) fn measure(
    scene: &BenchScene,
    (trees, tinybvh): (&Trees<'_>, Option<&tinybvh::Tree<'_>>),
    settings: &Settings,
    pool: &ThreadPool,
    report: &mut Report<'_>,
) -> Result<(), String> {
    let run = Run {
        trees,
        judge: Judge::new(&trees.firsthit, settings.judge),
        rounds: settings.rounds,
        pool,
    };
    let tree = Tree::of(&trees.firsthit);
    let shots = Shots::new(&trees.firsthit, &scene.look, settings.side)?;
    for &row in settings.rows() {
        let shot = shots.of(row)?;
        let mut measured = match &shot {
            Shot::Pixels(camera) => run.first_hits(row, camera, &Pixels::new(camera)),
            Shot::Curved(camera) => {
                let rays: Vec<Ray> = (0..camera.len()).map(|k| Rays::ray(camera, k)).collect();
                run.first_hits(row, camera, &Columns::new(&rays))
            }
            Shot::First(rays) => run.first_hits(row, &**rays, &Columns::new(rays)),
            Shot::Any(rays) => run.any_hits(row, rays),
            Shot::All(rays) => run.all_hits(row, rays),
            Shot::Picture(picture) => run.picture(row, picture),
        };
        if let (Row::Bounce | Row::Random, Shot::First(rays)) = (row, &shot) {
            measured.visits = tree.as_ref().map(|tree| tree.count(rays));
        }
        measured.tinybvh = tinybvh.and_then(|tree| tree.beside(&trees.firsthit, &shot, run.rounds));
        report.row(&scene.name, measured);
    }
    Ok(())
}

/// The rays of one row.
pub(crate) enum Shot {
    /// A camera's: the first hit.
    Pixels(Camera),
    /// The rays of a camera that Embree cannot make.
    Curved(Camera),
    /// The first hit.
    First(Vec<Ray>),
    /// Any hit.
    Any(Vec<Ray>),
    /// All hits.
    All(Vec<Ray>),
    /// The colours.
    Picture(Box<Picture>),
}

impl Shot {
    /// The number of rays.
    pub(crate) fn count(&self) -> usize {
        match self {
            Self::Pixels(camera) | Self::Curved(camera) => camera.len(),
            Self::First(rays) | Self::Any(rays) | Self::All(rays) => rays.len(),
            Self::Picture(picture) => picture.count(),
        }
    }
}

/// The source of a scene's rays.
pub(crate) struct Shots<'a> {
    scene: &'a Scene,
    look: &'a Look,
    side: usize,
    camera: Camera,
    surface: Surface,
}

impl<'a> Shots<'a> {
    pub(crate) fn new(scene: &'a Scene, look: &'a Look, side: usize) -> Result<Self, String> {
        let camera = look.camera(false, side)?;
        Ok(Self { scene, look, side, surface: Surface::seen(scene, &camera), camera })
    }

    /// The rays of a row.
    pub(crate) fn of(&self, row: Row) -> Result<Shot, String> {
        let count = self.side * self.side;
        Ok(match row {
            Row::Primary => Shot::Pixels(self.camera),
            Row::Orthographic => Shot::Pixels(self.look.camera(true, self.side)?),
            Row::Distorted => Shot::Curved(self.look.distorted(self.side)?),
            Row::Fisheye => Shot::Curved(self.look.fisheye(self.side)?),
            Row::Array => Shot::First(rays::of_pixels(&self.camera)),
            Row::Shadow => Shot::Any(self.surface.to_light(self.look.light)),
            Row::Occlusion => Shot::Any(self.surface.around(self.look.reach, count)),
            Row::Bounce => Shot::First(self.surface.scattered()),
            Row::Random => Shot::First(rays::anywhere(self.scene.bounds(), count)),
            Row::AllHits => Shot::All(rays::anywhere(self.scene.bounds(), count)),
            Row::Antialiased => {
                Shot::Picture(Box::new(Picture::antialiased(self.scene, &self.camera)))
            }
            Row::Shaded => {
                let shadows = self.surface.to_light(self.look.light);
                let light = self.look.light;
                Shot::Picture(Box::new(Picture::shaded(self.scene, &self.camera, light, &shadows)))
            }
        })
    }
}

/// The context of all rows of a scene.
struct Run<'a> {
    trees: &'a Trees<'a>,
    judge: Judge<'a>,
    rounds: u32,
    pool: &'a ThreadPool,
}

/// A thread panicked.
const POISONED: &str = "no thread panics";

impl Run<'_> {
    /// `rays` for firsthit and `source` for Embree are the same ones.
    fn first_hits(&self, row: Row, rays: &(impl Rays + ?Sized), source: &impl Source) -> Measured {
        let scene = &self.trees.firsthit;
        let hits = Mutex::new(Hits::default());
        let shoot = || firsthit_side::first_hits(scene, rays, &mut hits.lock().expect(POISONED));
        let mut ours = &shoot;
        let theirs = |(robust, door): (bool, Door), answers: &mut Answers| {
            if let Some(trees) = &self.trees.embree {
                trees.of(robust).first_hits(source, door, answers);
            }
        };
        let mut answers = Answers::new(source.len());
        let times = self.in_turns(source.len(), &mut ours, &theirs, &mut answers);
        shoot();
        // Embree's answers at its most careful.
        theirs((true, Door::Single), &mut answers);
        let answers = self.trees.embree.is_some().then_some(&answers);
        let judge = &self.judge;
        let check = || judge.first_hits(&hits.lock().expect(POISONED), rays, answers);
        Measured {
            row,
            rays: source.len(),
            visits: None,
            tinybvh: None,
            firsthit: times[0],
            embree: times[1..].to_vec(),
            checked: self.pool.install(check),
            speedup: measure::speedup(self.rounds, self.pool, &shoot),
        }
    }

    fn any_hits(&self, row: Row, rays: &[Ray]) -> Measured {
        let scene = &self.trees.firsthit;
        let source = &Columns::new(rays);
        let mut ours = || drop(black_box(firsthit_side::any_hits(scene, rays)));
        let theirs = |(robust, door): (bool, Door), answers: &mut Answers| {
            if let Some(trees) = &self.trees.embree {
                trees.of(robust).any_hits(source, door, answers);
            }
        };
        let mut answers = Answers::new(rays.len());
        let times = self.in_turns(rays.len(), &mut ours, &theirs, &mut answers);
        let found = firsthit_side::any_hits(scene, rays);
        theirs((true, Door::Single), &mut answers);
        let answers = self.trees.embree.is_some().then_some(&answers);
        let judge = &self.judge;
        let check = || judge.any_hits(&found, rays, answers);
        Measured {
            row,
            rays: rays.len(),
            visits: None,
            tinybvh: None,
            firsthit: times[0],
            embree: times[1..].to_vec(),
            checked: self.pool.install(check),
            speedup: measure::speedup(self.rounds, self.pool, &|| {
                drop(black_box(firsthit_side::any_hits(scene, rays)));
            }),
        }
    }

    fn all_hits(&self, row: Row, rays: &[Ray]) -> Measured {
        let scene = &self.trees.firsthit;
        let source = &Columns::new(rays);
        let all = Mutex::new(AllHits::default());
        let shoot = || firsthit_side::all_hits(scene, rays, &mut all.lock().expect(POISONED));
        let theirs = |(robust, door): (bool, Door), gathered: &mut Gathered| {
            if let Some(trees) = &self.trees.embree {
                trees.gathering(robust).all_hits(source, door, gathered);
            }
        };
        let mut gathered = Gathered::default();
        let mut ours = &shoot;
        let times = self.in_turns(rays.len(), &mut ours, &theirs, &mut gathered);
        shoot();
        theirs((true, Door::Single), &mut gathered);
        let gathered = self.trees.embree.is_some().then_some(&gathered);
        let judge = &self.judge;
        let check = || judge.all_hits(&all.lock().expect(POISONED), rays, gathered);
        Measured {
            row,
            rays: rays.len(),
            visits: None,
            tinybvh: None,
            firsthit: times[0],
            embree: times[1..].to_vec(),
            checked: self.pool.install(check),
            speedup: measure::speedup(self.rounds, self.pool, &shoot),
        }
    }

    /// A whole picture by firsthit, and its rays by Embree.
    fn picture(&self, row: Row, picture: &Picture) -> Measured {
        let render = || drop(black_box(picture.render()));
        let theirs = |(robust, door): (bool, Door), answers: &mut Answers| {
            if let Some(trees) = &self.trees.embree {
                picture.trace(trees.of(robust), door, answers);
            }
        };
        let count = picture.count();
        let mut answers = Answers::new(count);
        let mut ours = render;
        let times = self.in_turns(count, &mut ours, &theirs, &mut answers);
        let judge = &self.judge;
        let check = || judge.colors(&picture.render(), picture);
        Measured {
            row,
            rays: count,
            visits: None,
            tinybvh: None,
            firsthit: times[0],
            embree: times[1..].to_vec(),
            checked: self.pool.install(check),
            speedup: measure::speedup(self.rounds, self.pool, &render),
        }
    }

    /// firsthit's time, then Embree's through each of [`DOORS`].
    fn in_turns<A>(
        &self,
        rays: usize,
        ours: &mut dyn FnMut(),
        theirs: &dyn Fn((bool, Door), &mut A),
        answers: &mut A,
    ) -> Vec<Timing> {
        // All doors write into the same planes, as a program would.
        let answers = RefCell::new(answers);
        let mut doors: Vec<_> = DOORS
            .into_iter()
            .map(|door| {
                let answers = &answers;
                move || {
                    let _flush = FlushToZero::on();
                    theirs(door, &mut answers.borrow_mut());
                }
            })
            .collect();
        if self.trees.embree.is_none() {
            doors.clear();
        }
        let mut contestants: Vec<&mut dyn FnMut()> = vec![ours];
        for door in &mut doors {
            contestants.push(door);
        }
        measure::in_turns(self.rounds, rays, &mut contestants)
    }
}
