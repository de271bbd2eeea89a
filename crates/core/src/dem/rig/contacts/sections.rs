//! Near pairs in sections, which threads share out.
//!
//! A section has the pairs of which one of some successive spheres is the first end, and those spheres. It gives them their
//! forces itself; what its pairs do to spheres of later sections it lays by, to be added when all have done their part, in order.
//! Which sections there are depends on the pairs alone, so that sums are the same for any number of threads.

use super::account::AccountRows;
use super::sweep::{Excess, Sums};
use crate::dem::rig::pairs::Near;
use crate::dem::rig::spins::Spins;
use crate::dem::share::{cut, each_of};

/// So many pairs are worth a section of their own.
const GRAIN: usize = 25_000;
/// More sections than this only lay by more.
const MOST: usize = 32;

/// What a pair does to its second end, where that lies in a later section.
#[derive(Clone, Copy, Debug)]
pub struct Spill<const D: usize> {
    pub sphere: u32,
    /// (N)
    pub force: [f64; D],
    /// Couple per lever arm (N).
    pub twist: [f64; 3],
}

/// Where a section's pairs and spheres end.
#[derive(Clone, Copy, Debug)]
struct Section {
    pairs: usize,
    spheres: usize,
}

/// The sections of a list of near pairs.
pub struct Sections<const D: usize> {
    sections: Vec<Section>,
    /// What each has laid by.
    spills: Vec<Vec<Spill<D>>>,
    excesses: Vec<Vec<Excess<D>>>,
}

/// One section at work: rows of its pairs from `first` on, of its spheres from `first_sphere` on.
pub struct Piece<'a, const D: usize, M> {
    pub first: usize,
    pub first_sphere: usize,
    pub memory: &'a mut [M],
    pub account: AccountRows<'a>,
    pub stretch: [&'a mut [f64]; D],
    /// Of each pair as many numbers as its friction remembers besides.
    pub extra: &'a mut [f64],
    pub force: &'a mut [[f64; D]],
    /// Numbers of a [`Spins`]: couples per lever arm while pairs are at work, torques in the end.
    pub twist: &'a mut [f64],
    /// Radii (m) of its spheres.
    pub lever: &'a [f64],
    pub spill: &'a mut Vec<Spill<D>>,
    pub excess: &'a mut Vec<Excess<D>>,
}

impl<const D: usize> Sections<D> {
    /// Of pairs in order of their first ends.
    pub fn of(near: &[Near<D>], spheres: usize) -> Self {
        // A power of two, so that two, four or eight threads have equal shares.
        Self::so_many(near, spheres, 1 << (near.len() / GRAIN).clamp(1, MOST).ilog2())
    }

    /// Of these pairs so many, about equally large.
    pub fn so_many(near: &[Near<D>], spheres: usize, count: usize) -> Self {
        let sections: Vec<Section> = (1..=count)
            .map(|k| {
                let sphere = near.get(k * near.len() / count).map_or(spheres, |pair| pair.ends[0] as usize);
                Section { pairs: near.partition_point(|pair| (pair.ends[0] as usize) < sphere), spheres: sphere }
            })
            .collect();
        let count = sections.len();
        Self { sections, spills: vec![Vec::new(); count], excesses: vec![Vec::new(); count] }
    }

    /// Lets every section do its part, from zero on. `work` adds up the forces on its spheres, where these turn their torques too, and
    /// lays by what others are to have. `lever` has the radii (m) of all spheres.
    pub fn run<M: Send>(
        &mut self,
        mut memory: &mut [M],
        mut account: AccountRows<'_>,
        (stretch, mut extra): (&mut [Vec<f64>; D], &mut [f64]),
        (lever, turning): (&[f64], bool),
        sums: &mut Sums<D>,
        work: impl Fn(Piece<'_, D, M>) + Sync,
    ) {
        let work = |piece: Piece<'_, D, M>| {
            piece.force.fill([0.0; D]);
            if turning {
                piece.twist.fill(0.0);
            }
            work(piece);
        };
        let pairs = self.sections.last().map_or(0, |section| section.pairs);
        let each = extra.len() / pairs.max(1);
        let mut stretch = stretch.each_mut().map(|axis| axis.as_mut_slice());
        let (mut force, mut twist) = (&mut sums.force[..], sums.torque.numbers_mut());
        let (mut first, mut first_sphere) = (0, 0);
        sums.excess.clear();
        let laid_by = self.spills.iter_mut().zip(&mut self.excesses);
        let pieces = self.sections.iter().zip(laid_by).map(|(section, (spill, excess))| {
            spill.clear();
            excess.clear();
            let (pairs, spheres) = (section.pairs - first, section.spheres - first_sphere);
            let piece = Piece {
                first,
                first_sphere,
                memory: cut(&mut memory, pairs),
                account: account.cut(pairs),
                stretch: stretch.each_mut().map(|axis| cut(axis, if turning { pairs } else { 0 })),
                extra: cut(&mut extra, pairs * each),
                force: cut(&mut force, spheres),
                twist: cut(&mut twist, spheres * Spins::<D>::AXES),
                lever: &lever[first_sphere..section.spheres],
                spill,
                excess,
            };
            (first, first_sphere) = (section.pairs, section.spheres);
            piece
        });
        if self.sections.len() == 1 {
            pieces.for_each(work);
            sums.excess.append(&mut self.excesses[0]);
            return;
        }
        each_of(pieces.collect(), work);
        self.excesses.iter_mut().for_each(|excess| sums.excess.append(excess));
        for Spill { sphere, force, twist } in self.spills.iter().flatten() {
            let i = *sphere as usize;
            for k in 0..D {
                sums.force[i][k] += force[k];
            }
            if turning {
                sums.torque.add(i, lever[i], twist);
            }
        }
    }
}
