//! A time counts only for right answers: every run is compared with Embree's and, in a sample, with
//! the judge's.

use firsthit::shoot::AllHits;
use firsthit::{Bounds, Hit, Hits, Object, Ray, Rays, Scene};
use rayon::prelude::*;

use crate::embree::{Answers, Gathered};
use crate::firsthit_side;
use crate::picture::Picture;

/// The result of a comparison: the rays compared, and those that differ.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Checked {
    /// Rays shown to the judge: the sample, and some of those where Embree answers otherwise.
    pub(crate) judged: usize,
    /// Rays whose answer is not the judge's, bit for bit.
    pub(crate) wrong: usize,
    /// Rays that hit for one side only.
    pub(crate) other_outcome: usize,
    /// Rays that hit different triangles.
    pub(crate) other_triangle: usize,
    /// The largest difference in `t`, as a share of it, where the triangles are equal.
    pub(crate) largest_difference: f64,
}

/// The most of the rays where Embree answers otherwise that go to the judge.
const DISPUTED: usize = 16;

/// The judge and its budget.
#[derive(Debug)]
pub(crate) struct Judge<'a> {
    scene: &'a Scene,
    /// Triangle tests for one sample.
    budget: u64,
    /// A box around each of many objects, wide enough for every rounding; empty for one object.
    boxes: Vec<Bounds>,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(scene: &'a Scene, budget: u64) -> Self {
        let around = |object: &Object| {
            let bounds = object.mesh().map_or_else(
                || object.bounds(),
                |mesh| mesh.bounds().transformed(object.transform().world_from_object()),
            );
            let margin = 1e-9 * bounds.low.abs().max(bounds.high.abs()).max_element();
            Bounds { low: bounds.low - margin, high: bounds.high + margin }
        };
        let objects = scene.objects();
        let boxes =
            if objects.len() > 1 { objects.iter().map(around).collect() } else { Vec::new() };
        Self { scene, budget, boxes }
    }

    /// The first hit by brute force.
    pub(crate) fn first_hit(&self, ray: &Ray) -> Hit {
        let Some((few, objects)) = self.few(ray) else {
            return firsthit_side::judge(self.scene, ray);
        };
        named(firsthit_side::judge(&few, ray), &objects)
    }

    /// All hits by brute force.
    fn all_hits_of(&self, ray: &Ray) -> Vec<Hit> {
        let hits = |hits: &Hits| (0..hits.len()).map(|k| hits.get(k)).collect::<Vec<_>>();
        let Some((few, objects)) = self.few(ray) else {
            return hits(&firsthit_side::judge_all(self.scene, ray));
        };
        let all = hits(&firsthit_side::judge_all(&few, ray));
        all.into_iter().map(|hit| named(hit, &objects)).collect()
    }

    /// The objects whose boxes a ray passes, with their numbers: brute force over all triangles of
    /// a forest takes too long.
    fn few(&self, ray: &Ray) -> Option<(Scene, Vec<usize>)> {
        if self.boxes.is_empty() {
            return None;
        }
        let is_near = |bounds: &Bounds| {
            let (a, b) = (bounds.low - ray.origin, bounds.high - ray.origin);
            let (a, b) = (a / ray.direction, b / ray.direction);
            a.min(b).max_element() <= a.max(b).min_element()
        };
        let near = |&k: &usize| is_near(&self.boxes[k]);
        let objects: Vec<usize> = (0..self.boxes.len()).filter(near).collect();
        let few = objects.iter().map(|&k| self.scene.objects()[k].clone());
        let few = self.scene.with_objects(few.collect());
        Some((few.expect("they were in a scene"), objects))
    }

    /// Compares first hits.
    pub(crate) fn first_hits(
        &self,
        hits: &Hits,
        rays: &(impl Rays + ?Sized),
        embree: Option<&Answers>,
    ) -> Checked {
        let mut checked = Checked::default();
        let mut disputed = Vec::new();
        for (index, answers) in
            embree.into_iter().flat_map(|a| (0..hits.len()).map(move |k| (k, a)))
        {
            let hit = hits.get(index);
            match answers.hit(index) {
                None if hit.is_miss() => {}
                Some((t, object, primitive))
                    if (hit.object, hit.primitive) == (object as i32, primitive as i32) =>
                {
                    let difference = (f64::from(t) - hit.t).abs() / hit.t;
                    checked.largest_difference = checked.largest_difference.max(difference);
                }
                answer => {
                    if answer.is_some() && !hit.is_miss() {
                        checked.other_triangle += 1;
                    } else {
                        checked.other_outcome += 1;
                    }
                    disputed.push(index);
                }
            }
        }
        let sample = self.sample(hits.len(), disputed);
        let differs = |&index: &usize| !equal(&self.first_hit(&rays.ray(index)), &hits.get(index));
        checked.judged = sample.len();
        checked.wrong = sample.par_iter().filter(|index| differs(index)).count();
        checked
    }

    /// Compares whether rays meet anything.
    pub(crate) fn any_hits(
        &self,
        found: &[bool],
        rays: &[Ray],
        embree: Option<&Answers>,
    ) -> Checked {
        let disputed: Vec<usize> = embree.map_or_else(Vec::new, |answers| {
            let differs = |&index: &usize| answers.is_occluded(index) != found[index];
            (0..found.len()).filter(differs).collect()
        });
        let other_outcome = disputed.len();
        let sample = self.sample(found.len(), disputed);
        let differs = |&&index: &&usize| self.first_hit(&rays[index]).is_miss() == found[index];
        Checked {
            judged: sample.len(),
            wrong: sample.par_iter().filter(differs).count(),
            other_outcome,
            ..Checked::default()
        }
    }

    /// Compares all hits. A ray has another outcome where it has more hits or fewer, and other
    /// triangles where one of them is another.
    pub(crate) fn all_hits(
        &self,
        all: &AllHits,
        rays: &[Ray],
        embree: Option<&Gathered>,
    ) -> Checked {
        let ends = |ray: usize| all.offsets[ray]..all.offsets[ray + 1];
        let mut checked = Checked::default();
        let mut disputed = Vec::new();
        let compared = embree
            .into_iter()
            .flat_map(|gathered| (0..rays.len()).map(move |ray| (ray, gathered.hits(ray))));
        for (ray, theirs) in compared {
            let is_other_number = theirs.len() != ends(ray).len();
            let mut pairs = ends(ray).map(|k| all.hits.get(k)).zip(theirs);
            let is_other = |(hit, (_, object, primitive)): (Hit, (f32, u32, u32))| {
                (hit.object, hit.primitive) != (object as i32, primitive as i32)
            };
            if is_other_number {
                checked.other_outcome += 1;
            } else if pairs.any(is_other) {
                checked.other_triangle += 1;
            } else {
                continue;
            }
            disputed.push(ray);
        }
        let sample = self.sample(rays.len(), disputed);
        let differs = |&&ray: &&usize| {
            let expected = self.all_hits_of(&rays[ray]);
            let hits = ends(ray).map(|k| all.hits.get(k));
            expected.len() != hits.len() || expected.iter().zip(hits).any(|(a, b)| !equal(a, &b))
        };
        checked.judged = sample.len();
        checked.wrong = sample.par_iter().filter(differs).count();
        checked
    }

    /// Compares colours, three for each pixel, with those of hits that the judge finds.
    pub(crate) fn colors(&self, colors: &[f32], picture: &Picture) -> Checked {
        let sample = self.sample(picture.pixels(), Vec::new());
        let bits = |color: &[f32]| color.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        let differs = |&&pixel: &&usize| {
            bits(&picture.judged(pixel, self)) != bits(&colors[3 * pixel..3 * pixel + 3])
        };
        Checked {
            judged: sample.len(),
            wrong: sample.par_iter().filter(differs).count(),
            ..Checked::default()
        }
    }

    /// Rays evenly over all, and the first disputed ones.
    fn sample(&self, rays: usize, mut disputed: Vec<usize>) -> Vec<usize> {
        // A ray passes few of many boxes.
        let share = if self.boxes.is_empty() { 1 } else { 100 };
        let count = share * self.budget / self.scene.triangles().max(1);
        let count = count.clamp(8, 4096) as usize;
        // An odd step, so that pixels of all columns come up.
        let step = (rays / count).max(1) | 1;
        disputed.truncate(DISPUTED);
        disputed.extend((step / 2..rays).step_by(step));
        disputed
    }
}

/// A hit in a scene of some `objects`, in the scene that they are from.
fn named(mut hit: Hit, objects: &[usize]) -> Hit {
    if !hit.is_miss() {
        hit.object = objects[hit.object as usize] as i32;
    }
    hit
}

/// Equal to the last bit; misses have NaN for weights.
fn equal(a: &Hit, b: &Hit) -> bool {
    let bits = |hit: &Hit| [hit.t, hit.barycentric.x, hit.barycentric.y].map(f64::to_bits);
    (a.object, a.primitive) == (b.object, b.primitive) && (a.is_miss() || bits(a) == bits(b))
}

#[cfg(test)]
mod tests {
    use firsthit::{DVec3, Sphere};

    use super::*;

    fn scene() -> Scene {
        let sphere = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        Scene::new(vec![Object::new(sphere)]).unwrap()
    }

    fn rays() -> Vec<Ray> {
        let start = |k: u32| DVec3::new(f64::from(k) * 0.1, 0.0, 5.0);
        (0..20).map(|k| Ray::new(start(k), DVec3::NEG_Z)).collect()
    }

    #[test]
    fn a_hit_that_is_wrong_in_the_last_bit_is_found() {
        let (scene, rays) = (scene(), rays());
        let judge = Judge::new(&scene, 1000);
        let mut hits = Hits::default();
        firsthit_side::first_hits(&scene, rays.as_slice(), &mut hits);
        assert_eq!(judge.first_hits(&hits, rays.as_slice(), None).wrong, 0);
        hits.t[3] = hits.t[3].next_up();
        let checked = judge.first_hits(&hits, rays.as_slice(), None);
        assert_eq!((checked.wrong, checked.judged), (1, 20));
    }

    #[test]
    fn of_many_objects_the_judge_asks_those_that_the_ray_passes_and_says_the_same() {
        let ball = |k: i32| Sphere::new(DVec3::new(0.4 * f64::from(k), 0.0, 0.0), 0.7).unwrap();
        let scene = Scene::new((-4..4).map(|k| Object::new(ball(k))).collect()).unwrap();
        let judge = Judge::new(&scene, 1000);
        assert_eq!(judge.few(&rays()[0]).unwrap().1, [3, 4, 5]);
        for ray in rays() {
            let expected = firsthit_side::judge(&scene, &ray);
            assert!(equal(&judge.first_hit(&ray), &expected), "{ray:?}");
            let all = firsthit_side::judge_all(&scene, &ray);
            let found = judge.all_hits_of(&ray);
            assert_eq!(found.len(), all.len());
            assert!(found.iter().enumerate().all(|(k, hit)| equal(hit, &all.get(k))));
        }
    }

    #[test]
    fn a_wrong_shadow_is_found() {
        let (scene, rays) = (scene(), rays());
        let judge = Judge::new(&scene, 1000);
        let mut found = firsthit_side::any_hits(&scene, &rays);
        assert_eq!(judge.any_hits(&found, &rays, None).wrong, 0);
        found[19] = !found[19];
        assert_eq!(judge.any_hits(&found, &rays, None).wrong, 1);
    }

    #[test]
    fn a_crossing_that_is_missing_is_found() {
        let (scene, rays) = (scene(), rays());
        let judge = Judge::new(&scene, 1000);
        let mut all = AllHits::default();
        firsthit_side::all_hits(&scene, &rays, &mut all);
        assert_eq!(judge.all_hits(&all, &rays, None).wrong, 0);
        all.offsets[3] -= 1;
        // It is now the next ray's.
        assert_eq!(judge.all_hits(&all, &rays, None).wrong, 2);
    }
}
