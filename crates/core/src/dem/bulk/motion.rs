//! How a row moves in one step, whose forces are complete: the corrector of this step, maxima and first arrivals, and the predictor of the next
//! ([`multistep`](crate::dem::step)).

use std::marker::PhantomData;

use super::section::{Arrivals, BLOCK, Placed, Section};
use super::sweep::Terms;
use crate::dem::record::ARRIVAL;
use crate::real::{Job, Lanes};

/// Moves a row.
pub struct Move<'a, V> {
    pub terms: &'a Terms,
    pub section: &'a mut Section,
    pub row: usize,
    pub width: PhantomData<V>,
}

impl<V: Lanes> Job for Move<'_, V> {
    type Output = f64;
    #[inline(always)]
    fn run(self) -> f64 {
        let Self { terms, section, row, .. } = self;
        let Placed { place, count, on_mirrors, struck, .. } = section.rows[row];
        for &(at, _, mobility) in &section.on_mirrors[on_mirrors[0] as usize..on_mirrors[1] as usize] {
            for (force, mobility) in section.force.iter_mut().zip(mobility) {
                force.get_mut()[at as usize] *= mobility;
            }
        }
        if terms.load_now != [0.0; 2] && !matches!(section.arrivals, Arrivals::None) {
            section.remember_speeds(terms, struck);
        }
        let loads = terms.load != [0.0; 2];
        if loads {
            section.work -= section.pushed(struck, terms.load);
        }
        let fastest = if section.past_fields == 9 {
            shift::<V, true>(terms, section, place, count)
        } else {
            shift::<V, false>(terms, section, place, count)
        };
        if loads {
            section.strike(terms, struck);
            section.work += section.pushed(struck, terms.load);
        }
        fastest
    }
}

impl Section {
    /// Σ load · displacement of struck spheres (J), by the part of them that is simulated.
    pub fn pushed(&self, struck: [u32; 2], load: [f64; 2]) -> f64 {
        let mut sum = 0.0;
        for &at in &self.struck[struck[0] as usize..struck[1] as usize] {
            let (weight, mobility) = (self.weight(at as usize), self.mobility(at as usize));
            for (axis, load) in [(2, load[0]), (0, load[1])] {
                if mobility[axis] != 0.0 && load != 0.0 {
                    sum += load * weight * self.x[axis].get()[at as usize];
                }
            }
        }
        sum
    }

    /// Keeps v² of struck spheres before this step, of which the prediction knows only the sum with what the load gives.
    fn remember_speeds(&mut self, terms: &Terms, struck: [u32; 2]) {
        for k in struck[0] as usize..struck[1] as usize {
            let [_, velocity] = self.state(terms, self.struck[k] as usize, terms.load_now);
            self.before[k] = velocity.iter().map(|v| v * v).sum();
        }
    }

    /// Displacement (m) and velocity (m/s) at the last accepted step, from what is predicted for the next under this load (N).
    pub fn state(&self, terms: &Terms, place: usize, load: [f64; 2]) -> [[f64; 3]; 2] {
        let (h, fields) = (terms.step, self.past_fields);
        let past = &self.past.get()[place / BLOCK * fields * BLOCK + place % BLOCK..];
        let [s1, s2] = terms.coefficients.displacement;
        let [b1, b2] = terms.coefficients.velocity;
        let inverse = terms.inverse_mass[usize::from(self.kinds[place])];
        let loads = [load[1], 0.0, load[0]];
        let mobility = if load == [0.0; 2] { [1.0; 3] } else { self.mobility(place) };
        let mut state = [[0.0; 3]; 2];
        for axis in 0..3 {
            let now = past[axis * BLOCK];
            let (mut first, mut second) = (0.0, 0.0);
            if fields == 9 {
                let (one, two) = (past[(3 + axis) * BLOCK], past[(6 + axis) * BLOCK]);
                first = now - one;
                second = first - (one - two);
            }
            let push = if mobility[axis] == 0.0 { 0.0 } else { loads[axis] * inverse };
            let velocity = self.predicted[axis].get()[place] - (h * now + (b1 * first + b2 * second)) - h * push;
            let ahead = velocity + (0.5 * h * now + (s1 * first + s2 * second)) + 0.5 * h * push;
            state[0][axis] = self.x[axis].get()[place] - h * ahead;
            state[1][axis] = velocity;
        }
        state
    }

    /// The load's exact motion in the next step.
    pub fn strike(&mut self, terms: &Terms, struck: [u32; 2]) {
        for k in struck[0]..struck[1] {
            let at = self.struck[k as usize] as usize;
            let inverse = terms.inverse_mass[usize::from(self.kinds[at])];
            let mobility = self.mobility(at);
            for (axis, load) in [(2, terms.load[0]), (0, terms.load[1])] {
                // What lies on a mirror does not move across it.
                if mobility[axis] == 0.0 || load == 0.0 {
                    continue;
                }
                let push = load * inverse;
                self.x[axis].get_mut()[at] += terms.step * (0.5 * terms.step) * push;
                self.predicted[axis].get_mut()[at] += terms.step * push;
            }
        }
    }
}

/// Corrector, maxima and the next predictor of a row. What was predicted says what the velocity was, which need not be kept.
#[inline(always)]
fn shift<V: Lanes, const PAST: bool>(terms: &Terms, section: &mut Section, place: usize, count: usize) -> f64 {
    let (h, half) = (V::splat(terms.step), V::splat(0.5 * terms.step));
    let [s1, s2] = terms.coefficients.displacement.map(V::splat);
    let [b1, b2] = terms.coefficients.velocity.map(V::splat);
    let [m2, m3] = terms.coefficients.corrector.map(V::splat);
    let zero = V::splat(0.0);
    let mut fastest = zero;
    let stride = if PAST { 9 } else { 3 };
    for at in (place..place + count.next_multiple_of(V::LANES)).step_by(V::LANES) {
        let inverse = V::lookup(&terms.inverse_mass, V::index(&section.kinds[at..]));
        let past = &mut section.past.get_mut()[at / BLOCK * stride * BLOCK + at % BLOCK..];
        let (mut now_squared, mut before_squared, mut force_squared) = (zero, zero, zero);
        for axis in 0..3 {
            let force = &mut section.force[axis].get_mut()[at..];
            let new = V::load(force) * inverse;
            zero.store(force);
            let now = V::load(&past[axis * BLOCK..]);
            let predicted = &mut section.predicted[axis].get_mut()[at..];
            let x = &mut section.x[axis].get_mut()[at..];
            let first = new - now;
            let (velocity, mean, ahead, change);
            if PAST {
                let (one, two) = (V::load(&past[(3 + axis) * BLOCK..]), V::load(&past[(6 + axis) * BLOCK..]));
                let (before, earlier) = (now - one, one - two);
                let (second, second_before) = (first - before, before - earlier);
                let third = second - second_before;
                velocity = V::load(predicted) - (h * now + (b1 * before + b2 * second_before));
                mean = half * (now + new) - (m2 * second + m3 * third);
                ahead = half * new + (s1 * first + s2 * second);
                change = h * new + (b1 * first + b2 * second);
                one.store(&mut past[(6 + axis) * BLOCK..]);
                now.store(&mut past[(3 + axis) * BLOCK..]);
            } else {
                velocity = V::load(predicted) - h * now;
                mean = half * (now + new);
                ahead = half * new;
                change = h * new;
            }
            new.store(&mut past[axis * BLOCK..]);
            let corrected = velocity + mean;
            now_squared = now_squared + corrected * corrected;
            before_squared = before_squared + velocity * velocity;
            force_squared = force_squared + new * new;
            (V::load(x) + h * (corrected + ahead)).store(x);
            (corrected + change).store(predicted);
        }
        fastest = now_squared.max(fastest);
        let top = &mut section.acceleration_squared.get_mut()[at..];
        force_squared.max(V::load(top)).store(top);
        let top = &mut section.speed_squared.get_mut()[at..];
        let greatest = V::load(top);
        let trackers = greatest.lt(now_squared);
        if V::any(trackers) {
            now_squared.max(greatest).store(top);
            let loaded = if terms.load_now == [0.0; 2] { &[][..] } else { &section.struck };
            section.arrivals.tracker(at, terms, [greatest, now_squared, before_squared], (loaded, &section.before));
        }
    }
    fastest.greatest()
}

impl Arrivals {
    /// Spheres from a place on have, some of them, greater v² than before: the greatest before, that now, and that of the step before.
    #[inline(always)]
    fn tracker<V: Lanes>(
        &mut self,
        at: usize,
        terms: &Terms,
        [greatest, now, before]: [V; 3],
        (struck, struck_before): (&[u32], &[f64]),
    ) {
        // What a load gives in this step is already in the velocity before it.
        let before = |lane: usize| {
            let struck = struck.binary_search(&((at + lane) as u32));
            struck.map_or(before.lane(lane), |struck| struck_before[struck]).sqrt()
        };
        match self {
            Self::None => {}
            Self::Speed(threshold, times) => {
                let squared = V::splat(*threshold * *threshold);
                if !V::any(V::and(greatest.lt(squared), squared.lt(now))) {
                    return;
                }
                for lane in 0..V::LANES {
                    let [greatest, now] = [greatest, now].map(|squared| squared.lane(lane).sqrt());
                    if greatest < *threshold && *threshold < now {
                        let before = before(lane);
                        let share = (*threshold - before) / (now - before);
                        times[at + lane] = terms.time - terms.step * (1.0 - share);
                    }
                }
            }
            Self::Own(trackers) => {
                for lane in 0..V::LANES {
                    let [greatest, now] = [greatest, now].map(|squared| squared.lane(lane));
                    if greatest < now {
                        let tracker = &mut trackers[at + lane];
                        tracker.previous = before(lane);
                        tracker.push(terms.steps, now.sqrt(), true, ARRIVAL * now.sqrt(), terms.grain);
                    }
                }
            }
        }
    }
}
