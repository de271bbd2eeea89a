//! A run from start to end, of one design or of several side by side.
//!
//! What a contact's law costs is compiled for each law, in sweeps of their own ([`Laws`]); all else once for each width and dimension.

use super::batch::{Limit, PeakEnergies};
use super::body::Grains;
use super::boundary::{Face, Mirror, Surface};
use super::clock::{Clock, Phase, Phases};
use super::contacts::{Contacts, Laws, Sweep};
use super::guard::{Stop, Watch};
use super::impact::{Impact, steps_in};
use super::load::{Projectile, Strike};
use super::neighbour::{OverlapAtRest, Touching};
use super::plate::Plate;
use super::record::{Fastest, Observer};
use super::step::{Drive, Stepper};
use super::strangers::{Lapse, Strangers, VIGILANCE};
use crate::Context;
use crate::real::Lanes;
use crate::sample::Sample;

/// Steps between two looks at guards and the request to stop.
pub(super) const WATCH: u64 = 64;

/// What is asked of a run.
#[derive(Clone, Copy)]
pub struct Terms<'a> {
    pub impact: &'a Impact,
    /// One for each sample, all of one kind; the impact's own where there are none.
    pub strikes: &'a [Strike],
    pub limit: Option<&'a Limit>,
    /// Coulomb's coefficient, where there is friction.
    pub friction: Option<f64>,
    pub context: &'a Context,
    /// Whether it is measured what the parts of the run take.
    pub timed: bool,
    /// Dimensions for which the step's stability is judged.
    pub dimension: usize,
}

/// What is followed: as many samples as lanes, or fewer, with the same centres.
pub(super) struct Group<'a, const D: usize> {
    pub samples: &'a [&'a Sample<D>],
    pub terms: &'a Terms<'a>,
    pub touching: Touching<D>,
    strangers: Strangers<D>,
    /// One for all samples, or one for each.
    strikes: Vec<Strike>,
    /// All mirrors and faces, last that of what strikes, where it is a flat.
    surfaces: Vec<Surface>,
}

impl<'a, const D: usize> Group<'a, D> {
    /// Finds who touches.
    pub fn new(samples: &'a [&'a Sample<D>], terms: &'a Terms<'a>) -> Result<Self, OverlapAtRest> {
        let impact = terms.impact;
        let own = [impact.strike()];
        let strikes = if terms.strikes.is_empty() { &own } else { terms.strikes }.to_vec();
        let is_flat = strikes[0].projectile().is_some();
        assert!(
            strikes.iter().all(|strike| strike.is_like(&strikes[0])),
            "side by side pulses alone, or projectiles alone"
        );
        assert!(
            impact.faces.is_empty() || (D == 3 && impact.slope == 0.0 && impact.faces.iter().all(Face::is_along_last)),
            "faces are written for blows along z in space, with normals of unit length across it"
        );
        let mirrors = impact.mirrors.iter().copied().map(Surface::Mirror);
        let mut surfaces: Vec<Surface> = mirrors.chain(impact.faces.iter().copied().map(Surface::Face)).collect();
        if is_flat {
            let front = strikes[0].projectile().and_then(|flat| flat.front);
            let position = front.unwrap_or_else(|| first_top(samples, &impact.struck));
            surfaces.push(Surface::Mirror(Mirror { axis: D - 1, position, inward: 1.0 }));
        }
        let mut strangers = Strangers::new(samples, &surfaces, &impact.periods, is_flat);
        let touching = Touching::find(samples, (&surfaces, &impact.periods), &mut |i, j| strangers.tell(i, j))?;
        Ok(Self { samples, terms, touching, strangers, strikes, surfaces })
    }

    /// What strikes, where it is a flat.
    fn plate<V: Lanes>(&self, grains: &Grains<V, D>) -> Option<Plate<V>> {
        let flats: Vec<Projectile> = self.strikes.iter().filter_map(Strike::projectile).collect();
        let struck = self.terms.impact.struck.iter().map(|&i| grains.weight[i]).sum();
        let speeds: Vec<f64> = flats.iter().map(|flat| flat.speed).collect();
        let (Some(Surface::Mirror(face)), mass) = (self.surfaces.last(), flats.first()?.mass) else { return None };
        Some(Plate::new(*face, mass, &speeds, struck))
    }
}

/// Where a face touches the first of the struck spheres (m).
pub(super) fn first_top<const D: usize>(samples: &[&Sample<D>], struck: &[usize]) -> f64 {
    let spheres = samples.iter().flat_map(|sample| struck.iter().map(|&i| &sample.spheres[i]));
    let tops = spheres.filter(|sphere| sphere.radius > 0.0).map(|sphere| sphere.centre[D - 1] - sphere.radius);
    tops.fold(f64::INFINITY, f64::min)
}

/// A run that has ended.
pub(super) struct Run<'a, V, const D: usize, O> {
    pub grains: Grains<V, D>,
    pub contacts: Contacts<'a, V, D>,
    pub laws: Box<dyn Laws<V, D> + 'a>,
    pub stepper: Stepper<V, D>,
    pub observer: O,
    /// Work of the load (J).
    pub work: V,
    /// Why it ended early, of each design.
    pub stops: Vec<Option<Stop>>,
    fastest: Fastest<V>,
    /// What designs had felt that were stopped.
    ended: Vec<Option<Vec<f64>>>,
}

impl<V: Lanes, const D: usize, O> Run<'_, V, D, O> {
    pub fn peak_energies(&self, samples: &[&Sample<D>]) -> Vec<PeakEnergies> {
        let peaks = |lane: usize| PeakEnergies {
            max_kinetic: self.ended[lane].clone().unwrap_or_else(|| energies(samples[lane], &self.fastest, lane)),
            stop: self.stops[lane].clone(),
        };
        (0..samples.len()).map(peaks).collect()
    }

    pub fn phases(&self) -> Phases {
        self.stepper.clock.phases()
    }
}

/// Greatest kinetic energy of each sphere so far (J).
fn energies<V: Lanes, const D: usize>(sample: &Sample<D>, fastest: &Fastest<V>, lane: usize) -> Vec<f64> {
    let energy = |(i, fastest): (usize, &V)| 0.5 * sample.mass(i) * fastest.lane(lane);
    fastest.of_sphere.iter().enumerate().map(energy).collect()
}

/// Follows a group. None if there is no room for its laws, or, side by side, if spheres are so fast that the run is better made of each
/// design alone.
#[inline(always)]
pub(super) fn follow<'a, V: Lanes, const D: usize, O: Observer<V, D>>(
    group: &Group<'a, D>,
    laws: impl Fn() -> Option<Box<dyn Laws<V, D> + 'a>>,
    observer: impl Fn() -> O,
    accept: Sweep,
) -> Option<Run<'a, V, D, O>> {
    let (samples, impact) = (group.samples, group.terms.impact);
    let &Terms { limit, friction, context, timed, dimension, .. } = group.terms;
    let spheres = samples[0].spheres.len();
    let steps = steps_in(impact.window, impact.step);
    let mut clock = Clock::new(timed);
    let mut vigilances = VIGILANCE.into_iter();
    'attempts: loop {
        let vigilance = vigilances.next()?;
        let is_last = V::LANES == 1 && vigilances.len() == 0;
        let mut laws = laws()?;
        let mut grains = Grains::<V, D>::at_rest(samples, &group.surfaces);
        let (similar, accounts) = (impact.law.is_similar(), accept == Sweep::AcceptAndAccount);
        let touching = group.touching.clone();
        let mut contacts = Contacts::new(samples, touching, &grains, similar, accounts);
        if let Some(coefficient) = friction {
            contacts.rub(coefficient, &grains, impact.step);
        }
        // What moves at the start has been put in before it.
        let brought = |work: f64, &(i, speed): &(usize, f64)| {
            let weight = grains.weight[i];
            work + 0.5 * (weight * samples[0].mass(i)) * speed * speed
        };
        contacts.plate = group.plate(&grains);
        let strike = group.strikes[0].projectile();
        let flat = strike.map_or(0.0, |Projectile { mass, speed, .. }| 0.5 * mass * speed * speed);
        let work = impact.moving.iter().fold(flat, brought);
        let mut drive = Drive::new(&group.strikes, impact.slope, &impact.struck, work);
        let mut stepper = Stepper::new(impact.integrator, accept, impact.step, spheres);
        stepper.clock = clock;
        stepper.clock.lap(Phase::Preparing);
        grains.set_moving(&impact.moving);
        let mut strangers = group.strangers.clone();
        strangers.begin(&grains, contacts.plate.as_ref(), vigilance);
        let mut fastest = Fastest::new(spheres, strangers.size);
        let mut observer = observer();
        let mut watch = Watch::new(dimension);
        let mut stops: Vec<Option<Stop>> = vec![None; samples.len()];
        let mut goes_on = vec![true; samples.len()];
        // A design that has been stopped is carried along; what it felt until then is kept.
        let mut ended: Vec<Option<Vec<f64>>> = vec![None; samples.len()];
        while stepper.count < steps && goes_on.contains(&true) {
            let mut too_fast = false;
            let look = steps.min(stepper.count + WATCH);
            while stepper.count < look && !too_fast {
                stepper.advance(&mut grains, &mut contacts, &*laws, &mut drive);
                observer.accepted(stepper.count, &grains);
                fastest.accepted(stepper.count, &grains);
                match strangers.watch(&mut fastest.of_block, impact.step, &goes_on, &mut contacts, &mut *laws, &grains)
                {
                    Ok(()) => {}
                    Err(Lapse::TooFast) if is_last => too_fast = true,
                    Err(Lapse::TooFast) => {
                        clock = stepper.clock;
                        continue 'attempts;
                    }
                    Err(Lapse::NoRoom) => return None,
                }
                stepper.clock.lap(Phase::Watching);
            }
            let interrupted = context.stopped();
            let all_finite = watch.look(&grains, &contacts);
            for (lane, stop) in stops.iter_mut().enumerate().filter(|(_, stop)| stop.is_none()) {
                *stop = watch.judge(&stepper, &grains, &contacts, &*laws, all_finite, lane).err();
                if stop.is_none() && too_fast {
                    *stop = Some(Stop::Leap { step_s: impact.step });
                }
                if stop.is_none() && interrupted {
                    *stop = Some(Stop::Interrupted { time_s: stepper.time() });
                }
                if let Some(limit) = limit.filter(|_| stop.is_none() && stepper.count < steps) {
                    let energy = |i: usize| 0.5 * samples[lane].mass(i) * fastest.of_sphere[i].lane(lane);
                    if limit.spheres.iter().map(|&(i, weight)| weight * energy(i)).sum::<f64>() > limit.most[lane] {
                        *stop = Some(Stop::Beyond { time_s: stepper.time() });
                    }
                }
                goes_on[lane] = stop.is_none();
                ended[lane] = stop.as_ref().map(|_| energies(samples[lane], &fastest, lane));
            }
            stepper.clock.lap(Phase::Watching);
        }
        let work = drive.work;
        return Some(Run { grains, contacts, laws, stepper, observer, work, stops, fastest, ended });
    }
}
