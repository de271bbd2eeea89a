//! Spheres that do not touch at rest may meet all the same: who could have by now.
//!
//! Spheres stand in blocks, in their order. For every two blocks it is known how far their nearest spheres that are no contact yet
//! were apart when last looked at, and how far at most the fastest sphere of either has come since. As long as both ways together
//! are shorter than that gap no two of them have met, and nobody looks; pairs that have come near become contacts. So it is proven
//! that no contact is missed, at the cost of a handful of looks at most blocks. The same for blocks and mirrors, walls and faces, which
//! spheres reach at half the distance to their image.

use super::body::{Grains, square};
use super::boundary::{Mirror, Period, Surface};
use super::contacts::{Contacts, Laws, NoRoom};
use super::list::List;
use super::neighbour::widest;
use super::plate::Plate;
use crate::real::Lanes;
use crate::sample::Sample;

/// How far spheres are trusted to come in a step beyond what their speeds say.
#[derive(Clone, Copy)]
pub(super) struct Vigilance {
    /// Part of the greatest diameter.
    allowance: f64,
}

/// The first serves; if spheres were faster than expected the run is made again with the next.
pub(super) const VIGILANCE: [Vigilance; 3] =
    [Vigilance { allowance: 0.01 }, Vigilance { allowance: 0.1 }, Vigilance { allowance: 1.0 }];

/// Why a look ended.
pub(super) enum Lapse {
    /// Spheres were so fast that some may have met unseen.
    TooFast,
    /// See [`NoRoom`].
    NoRoom,
}

impl From<NoRoom> for Lapse {
    fn from(_: NoRoom) -> Self {
        Self::NoRoom
    }
}

/// Who is no contact yet, and when to look at whom.
#[derive(Clone)]
pub(super) struct Strangers<const D: usize> {
    /// Spheres of a block.
    pub size: usize,
    centres: Vec<[f64; D]>,
    /// The greatest of each sphere's radii (m).
    radius: Vec<f64>,
    /// The greatest of each block's radii (m).
    block_radius: Vec<f64>,
    surfaces: Vec<Surface>,
    periods: Vec<Period>,
    /// How far the fastest sphere of each block has come at most (m), and how far it may be at the next look.
    way: Vec<f64>,
    ahead: Vec<f64>,
    /// Its greatest speed between the last two looks (m/s).
    speed: Vec<f64>,
    /// The sum of two blocks' ways at which their nearest strangers may meet (m): a ≤ b at `a * blocks + b`.
    meet: Vec<f64>,
    /// The same for twice a block's way and its images: block times surfaces, and surface.
    meet_image: Vec<f64>,
    /// The same ways and speed of the last mirror, where it moves.
    moving: Option<Moving>,
    /// (m)
    allowance: f64,
}

/// A mirror that moves: how far it has come at most (m), may be at the next look, and its speed at the last (m/s).
#[derive(Clone, Copy, Default)]
struct Moving {
    way: f64,
    ahead: f64,
    speed: f64,
}

/// A quarter is added to what speeds at the accepted steps say of the way between them.
const BETWEEN: f64 = 1.25;

impl<const D: usize> Strangers<D> {
    /// For packings with the same centres. Strangers within two diameters are told by [`tell`](Self::tell); their contacts know the rest. The last
    /// mirror may move.
    pub fn new(samples: &[&Sample<D>], surfaces: &[Surface], periods: &[Period], last_moves: bool) -> Self {
        let count = samples[0].spheres.len();
        let size = count.isqrt().max(16);
        let blocks = count.div_ceil(size);
        let radius: Vec<f64> =
            (0..count).map(|i| samples.iter().map(|sample| sample.spheres[i].radius).fold(0.0, f64::max)).collect();
        let block_radius: Vec<f64> =
            radius.chunks(size).map(|block| block.iter().copied().fold(0.0, f64::max)).collect();
        let centres: Vec<[f64; D]> = samples[0].spheres.iter().map(|sphere| sphere.centre).collect();
        let bounds: Vec<[[f64; 2]; D]> = centres.chunks(size).map(bounds).collect();
        let widest = widest(samples);
        // Whoever is not told lies beyond two diameters.
        let mut meet = vec![f64::INFINITY; blocks * blocks];
        for a in 0..blocks {
            for b in a..blocks {
                meet[a * blocks + b] =
                    widest.max(apart(&bounds[a], &bounds[b], periods) - block_radius[a] - block_radius[b]);
            }
        }
        let mut meet_image = Vec::new();
        for block in 0..blocks {
            for surface in surfaces {
                let gap = |i: usize| 2.0 * (surface.distance(&centres[i]) - radius[i]);
                let strangers = (block * size..((block + 1) * size).min(count))
                    .filter(|&i| !surface.carries(&centres[i], radius[i]) && gap(i) > 0.01 * radius[i]);
                meet_image.push(strangers.map(gap).fold(f64::INFINITY, f64::min));
            }
        }
        Self {
            size,
            centres,
            radius,
            block_radius,
            surfaces: surfaces.to_vec(),
            periods: periods.to_vec(),
            way: vec![0.0; blocks],
            ahead: vec![0.0; blocks],
            speed: vec![0.0; blocks],
            meet,
            meet_image,
            moving: last_moves.then(Moving::default),
            allowance: 0.01 * widest,
        }
    }

    /// Says of two spheres that they are near and yet no contact.
    pub fn tell(&mut self, i: usize, j: usize) {
        let distance = self.between(i, j).iter().map(|x| x.powi(2)).sum::<f64>().sqrt();
        let place = i / self.size * self.way.len() + j / self.size;
        self.meet[place] = self.meet[place].min(distance - self.radius[i] - self.radius[j]);
    }

    /// From the centre of one sphere to that of another, or its nearest image, at rest (m).
    #[inline(always)]
    fn between(&self, i: usize, j: usize) -> [f64; D] {
        Period::nearest(&self.periods, std::array::from_fn(|k| self.centres[j][k] - self.centres[i][k]))
    }

    /// Before a run: the speeds with which it starts.
    pub fn begin<V: Lanes>(&mut self, grains: &Grains<V, D>, plate: Option<&Plate<V>>, vigilance: Vigilance) {
        self.allowance *= vigilance.allowance / VIGILANCE[0].allowance;
        self.ahead.fill(self.allowance);
        if let (Some(moving), Some(plate)) = (&mut self.moving, plate) {
            moving.ahead = self.allowance;
            moving.speed = (0..V::LANES).map(|lane| plate.velocity.lane(lane).abs()).fold(0.0, f64::max);
        }
        for i in 0..grains.reached {
            let block = i / self.size;
            for lane in 0..V::LANES {
                self.speed[block] = self.speed[block].max(grains.speed_squared(i).lane(lane).sqrt());
            }
        }
    }

    /// After some time (s), with the greatest v² of each block in it, which are forgotten: looks at those who may have come near
    /// each other in any of the designs that go on, and takes up their contacts.
    #[inline(always)]
    pub fn watch<V: Lanes>(
        &mut self,
        fastest: &mut [V],
        time: f64,
        goes_on: &[bool],
        contacts: &mut Contacts<'_, V, D>,
        laws: &mut dyn Laws<V, D>,
        grains: &Grains<V, D>,
    ) -> Result<(), Lapse> {
        let blocks = self.way.len();
        let lanes = || (0..V::LANES).filter(|&lane| goes_on.get(lane) == Some(&true));
        let mut going = V::splat(0.0);
        lanes().for_each(|lane| going.set_lane(lane, 1.0));
        // Beyond these all are at rest.
        let reached = grains.reached.div_ceil(self.size);
        for (block, fastest) in fastest.iter_mut().enumerate().take(reached) {
            let speed = (*fastest * going).greatest().sqrt();
            let way = BETWEEN * time * speed.max(self.speed[block]);
            self.speed[block] = speed;
            self.way[block] += way;
            self.ahead[block] = self.way[block] + 2.0 * way + self.allowance;
            *fastest = V::splat(0.0);
        }
        let (mut pairs, mut images) = (Vec::new(), Vec::new());
        for a in 0..reached {
            let row = &self.meet[a * blocks..(a + 1) * blocks];
            // Mostly none is: without an early end the loop runs in vector registers.
            let mut any = false;
            for (meet, ahead) in row[a..].iter().zip(&self.ahead[a..]) {
                any |= *meet <= self.ahead[a] + ahead;
            }
            if !any {
                continue;
            }
            for b in a..blocks {
                let place = a * blocks + b;
                if self.meet[place] > self.ahead[a] + self.ahead[b] {
                    continue;
                }
                if self.meet[place] <= self.way[a] + self.way[b] {
                    return Err(Lapse::TooFast);
                }
                let near = 3.0 * (self.ahead[a] - self.way[a] + self.ahead[b] - self.way[b]);
                let clear = self.look([a, b], near, lanes(), &contacts.list, grains, &mut pairs);
                self.meet[place] = self.way[a] + self.way[b] + clear;
            }
        }
        if let (Some(moving), Some(plate)) = (&mut self.moving, &contacts.plate) {
            let speed = lanes().map(|lane| plate.velocity.lane(lane).abs()).fold(0.0, f64::max);
            let way = BETWEEN * time * speed.max(moving.speed);
            *moving = Moving { way: moving.way + way, ahead: moving.way + 3.0 * way + self.allowance, speed };
        }
        let surfaces = self.surfaces.len();
        for place in 0..self.meet_image.len() {
            let (block, surface) = (place / surfaces, &self.surfaces[place % surfaces]);
            let moving = self.moving.filter(|_| place % surfaces == surfaces - 1).unwrap_or_default();
            let (way, ahead) = (self.way[block] + moving.way, self.ahead[block] + moving.ahead);
            if self.meet_image[place] > 2.0 * ahead {
                continue;
            }
            if self.meet_image[place] <= 2.0 * way {
                return Err(Lapse::TooFast);
            }
            let near = 6.0 * (ahead - way);
            let plate = contacts.plate.as_ref().filter(|plate| *surface == Surface::Mirror(plate.mirror));
            let mut clear = f64::INFINITY;
            for i in self.block(block) {
                let centre = &self.centres[i];
                if surface.carries(centre, self.radius[i])
                    || self.radius[i] == 0.0
                    || contacts.list.holds_image(i, surface)
                {
                    continue;
                }
                let come = |lane| plate.map_or(0.0, |plate| plate.displacement.lane(lane));
                let distance = |lane| match surface {
                    Surface::Mirror(Mirror { axis, inward, .. }) => {
                        let moved = inward * (grains.displacement[i][*axis].lane(lane) - come(lane));
                        surface.distance(centre) - self.radius[i] + moved
                    }
                    Surface::Face(_) => {
                        let moved = &grains.displacement[i];
                        surface.distance(&std::array::from_fn::<f64, D, _>(|k| centre[k] + moved[k].lane(lane)))
                            - self.radius[i]
                    }
                };
                let gap = |lane| 2.0 * distance(lane);
                let gap = lanes().map(gap).fold(f64::INFINITY, f64::min);
                if gap < near {
                    images.push((i, *surface));
                } else {
                    clear = clear.min(gap);
                }
            }
            self.meet_image[place] = 2.0 * way + clear;
        }
        if pairs.is_empty() && images.is_empty() {
            return Ok(());
        }
        Ok(contacts.restore(&pairs, &images, &self.surfaces, grains, laws)?)
    }

    fn block(&self, block: usize) -> std::ops::Range<usize> {
        block * self.size..((block + 1) * self.size).min(self.centres.len())
    }

    /// Square of the distance of two centres (m²). No closure: it would not be compiled for a register's instructions.
    #[inline(always)]
    fn squared<V: Lanes>(&self, [i, j]: [usize; 2], grains: &Grains<V, D>) -> V {
        let offset = self.between(i, j);
        let mut between = [V::splat(0.0); D];
        for k in 0..D {
            between[k] = V::splat(offset[k]) + (grains.displacement[j][k] - grains.displacement[i][k]);
        }
        square::<V, D>(&between)
    }

    /// Adds the strangers of two blocks whose surfaces are nearer than `near` (m), and gives the least gap of the others.
    #[inline(always)]
    fn look<V: Lanes>(
        &self,
        [a, b]: [usize; 2],
        near: f64,
        lanes: impl Iterator<Item = usize> + Clone,
        list: &List<D>,
        grains: &Grains<V, D>,
        pairs: &mut Vec<[usize; 2]>,
    ) -> f64 {
        let mut clear = f64::INFINITY;
        for i in self.block(a).filter(|&i| self.radius[i] > 0.0) {
            let others = self.block(b);
            let others = others.start.max(i + 1)..others.end;
            // Strangers are what lies between the partners.
            let partners = list.partners(i).filter(|j| others.contains(j)).chain([others.end]);
            let (mut least, mut from) = (V::splat(f64::INFINITY), others.start);
            for partner in partners {
                for j in from..partner {
                    // Empty sites lie there too, and then it is looked at more closely below.
                    least = self.squared([i, j], grains).min(least);
                }
                from = partner + 1;
            }
            let least = lanes.clone().map(|lane| least.lane(lane)).fold(f64::INFINITY, f64::min);
            let bound = least.sqrt() - self.radius[i] - self.block_radius[b];
            if bound >= near {
                clear = clear.min(bound);
                continue;
            }
            let mut partners = list.partners(i).filter(|j| others.contains(j)).peekable();
            for j in others.clone() {
                if partners.next_if_eq(&j).is_some() || self.radius[j] == 0.0 {
                    continue;
                }
                let squared = self.squared([i, j], grains);
                let least = lanes.clone().map(|lane| squared.lane(lane)).fold(f64::INFINITY, f64::min);
                let gap = least.sqrt() - self.radius[i] - self.radius[j];
                if gap < near {
                    pairs.push([i, j]);
                } else {
                    clear = clear.min(gap);
                }
            }
        }
        clear
    }
}

/// The smallest box around centres.
fn bounds<const D: usize>(centres: &[[f64; D]]) -> [[f64; 2]; D] {
    std::array::from_fn(|k| {
        let along = || centres.iter().map(|centre| centre[k]);
        [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
    })
}

/// Distance of two boxes (m), or of one and the nearest image of the other.
fn apart<const D: usize>(a: &[[f64; 2]; D], b: &[[f64; 2]; D], periods: &[Period]) -> f64 {
    let along = |k: usize| {
        let shifted = |by: f64| (b[k][0] + by - a[k][1]).max(a[k][0] - b[k][1] - by).max(0.0);
        match periods.iter().find(|period| period.axis == k) {
            Some(Period { length, .. }) => shifted(0.0).min(shifted(-length)).min(shifted(*length)),
            None => shifted(0.0),
        }
    };
    (0..D).map(|k| along(k).powi(2)).sum::<f64>().sqrt()
}
