//! Which law holds at which contact: a table with one entry per kind of pair, for one design or for several side by side.

use std::marker::PhantomData;

use super::contacts::Laws;
use super::neighbour::Touching;
use crate::contact::{Asked, Constants, History, LaneLaw, NormalLaw, Pair};
use crate::material::Material;
use crate::real::Lanes;
use crate::sample::Sample;

/// The laws of the kinds of pairs that occur, found by materials and radii.
struct Kinds<'a, L, F> {
    constants: Constants,
    make: F,
    seen: Vec<[(&'a Material, f64); 2]>,
    laws: Vec<L>,
}

impl<'a, L, F: Fn(&Pair) -> L> Kinds<'a, L, F> {
    fn new(constants: Constants, make: F) -> Self {
        Self { constants, make, seen: Vec::new(), laws: Vec::new() }
    }

    /// The place of the law between two spheres of a sample.
    fn place<const D: usize>(&mut self, sample: &'a Sample<D>, [a, b]: [usize; 2]) -> usize {
        let end = |i: usize| {
            let sphere = &sample.spheres[i];
            (&sample.materials[sphere.material], sphere.radius)
        };
        let (first, second) = (end(a), end(b));
        let known = |kind: &[(&Material, f64); 2]| *kind == [first, second] || *kind == [second, first];
        self.seen.iter().position(known).unwrap_or_else(|| {
            self.seen.push([first, second]);
            let pair = Pair::new([first.0, second.0], [first.1, second.1], self.constants);
            self.laws.push((self.make)(&pair));
            self.laws.len() - 1
        })
    }
}

/// The spheres of every contact: pairs, then images with their sphere twice.
fn ends<const D: usize>(touching: &Touching<D>) -> impl Iterator<Item = [usize; 2]> + '_ {
    let pairs = touching.pairs.iter().map(|touch| touch.pair);
    pairs.chain(touching.images.iter().map(|touch| [touch.sphere; 2]))
}

/// One law per kind of pair, and for each contact its kind.
pub(super) struct LawTable<L> {
    kinds: Vec<L>,
    kind: Vec<u16>,
}

impl<L: NormalLaw + Copy + Sync> Laws<f64> for LawTable<L> {
    type One = L;
    #[inline(always)]
    fn force(&self, contact: usize, overlap: f64, closing_speed: f64, history: &History) -> f64 {
        self.of(contact).force(overlap, closing_speed, history)
    }
    #[inline(always)]
    fn respond(&self, contact: usize, overlap: f64, closing_speed: f64, history: &History) -> (f64, History) {
        self.of(contact).respond(overlap, closing_speed, history)
    }
    fn one(&self, contact: usize, _: usize) -> L {
        *self.of(contact)
    }
}

impl<L> LawTable<L> {
    /// The law of a contact.
    #[inline(always)]
    pub fn of(&self, contact: usize) -> &L {
        &self.kinds[usize::from(self.kind[contact])]
    }

    /// Makes a law for every kind of pair that touches.
    pub fn new<const D: usize>(
        sample: &Sample<D>,
        touching: &Touching<D>,
        constants: Constants,
        make: impl Fn(&Pair) -> L,
    ) -> Self {
        let mut kinds = Kinds::new(constants, make);
        let kind = ends(touching).map(|pair| kinds.place(sample, pair) as u16).collect();
        Self { kinds: kinds.laws, kind }
    }
}

/// Up to 16 kinds of pairs, and for each contact the kind that it is in each design.
pub(super) struct LaneTable<L, V> {
    kinds: Vec<L>,
    /// Parameter k of every kind.
    tables: Vec<[f64; 16]>,
    /// Kinds of contact c: from `c * LANES` on.
    kind: Vec<u8>,
    width: PhantomData<V>,
}

impl<L: LaneLaw, V: Lanes> Laws<V> for LaneTable<L, V> {
    type One = L;
    #[inline(always)]
    fn force(&self, contact: usize, overlap: V, closing_speed: V, history: &History<V>) -> V {
        let place = V::index(&self.kind[contact * V::LANES..(contact + 1) * V::LANES]);
        L::force_at(&Asked { tables: &self.tables, place, overlap, closing_speed, history })
    }
    #[inline(always)]
    fn respond(&self, contact: usize, overlap: V, closing_speed: V, history: &History<V>) -> (V, History<V>) {
        let place = V::index(&self.kind[contact * V::LANES..(contact + 1) * V::LANES]);
        L::respond_at(&Asked { tables: &self.tables, place, overlap, closing_speed, history })
    }
    fn one(&self, contact: usize, lane: usize) -> L {
        self.kinds[usize::from(self.kind[contact * V::LANES + lane])]
    }
}

impl<L: LaneLaw, V: Lanes> LaneTable<L, V> {
    /// Makes a law for every kind of pair that touches in any of the samples, one sample per lane; none if there are more
    /// than 16 kinds.
    pub fn new<const D: usize>(
        samples: &[&Sample<D>],
        touching: &Touching<D>,
        constants: Constants,
        make: impl Fn(&Pair) -> L,
    ) -> Option<Self> {
        let mut kinds = Kinds::new(constants, make);
        let mut kind = Vec::new();
        for pair in ends(touching) {
            for lane in 0..V::LANES {
                let sample = samples[lane.min(samples.len() - 1)];
                kind.push(u8::try_from(kinds.place(sample, pair)).ok().filter(|&place| place < 16)?);
            }
        }
        let mut tables = vec![[0.0; 16]; L::PARAMETERS];
        for (place, law) in kinds.laws.iter().enumerate() {
            for (table, parameter) in tables.iter_mut().zip(law.parameters()) {
                table[place] = parameter;
            }
        }
        Some(Self { kinds: kinds.laws, tables, kind, width: PhantomData })
    }
}
