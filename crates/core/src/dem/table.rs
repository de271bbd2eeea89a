//! Which law holds at which contact: a table with one entry per kind of pair, for one design or for several side by side.

use std::marker::PhantomData;

use super::contacts::{Laws, Pass, Respond};
use super::neighbour::Touching;
use super::size::reference_radius;
use crate::contact::{AnyLaw, Asked, Constants, ForceLaw, History, LaneLaw, LawKind, Pair};
use crate::material::Material;
use crate::real::Lanes;
use crate::sample::Sample;

/// The laws of the kinds of pairs that occur, found by materials and radii; a law that obeys similarity is made for spheres of the
/// samples' reference radius.
struct Kinds<'a> {
    law: LawKind,
    constants: Constants,
    /// Materials, and the radius for which their laws are made (m).
    classes: Vec<(&'a Material, f64)>,
    /// The class of every sphere of every sample.
    class: Vec<Vec<u16>>,
    seen: Vec<[u16; 2]>,
    laws: Vec<AnyLaw>,
}

impl<'a> Kinds<'a> {
    fn new<const D: usize>(samples: &[&'a Sample<D>], law: LawKind, constants: Constants) -> Self {
        let mut classes: Vec<(&'a Material, f64)> = Vec::new();
        let mut class = Vec::new();
        for sample in samples {
            let reference = reference_radius(sample);
            let (mut last, mut of_sample) = (None, Vec::with_capacity(sample.spheres.len()));
            for sphere in &sample.spheres {
                let radius = if law.is_similar() { reference } else { sphere.radius };
                // Spheres that follow each other are often alike, and materials take long to compare.
                let place = match last {
                    Some((material, of_last, class)) if (material, of_last) == (sphere.material, radius) => class,
                    _ => {
                        let one = (&sample.materials[sphere.material], radius);
                        classes.iter().position(|known| *known == one).unwrap_or_else(|| {
                            classes.push(one);
                            classes.len() - 1
                        }) as u16
                    }
                };
                last = Some((sphere.material, radius, place));
                of_sample.push(place);
            }
            class.push(of_sample);
        }
        Self { law, constants, classes, class, seen: Vec::new(), laws: Vec::new() }
    }

    /// The place of the law between two spheres of a sample.
    fn place(&mut self, sample: usize, [a, b]: [usize; 2]) -> usize {
        let of = &self.class[sample.min(self.class.len() - 1)];
        let pair = [of[a].min(of[b]), of[a].max(of[b])];
        self.seen.iter().position(|known| *known == pair).unwrap_or_else(|| {
            let [first, second] = pair.map(|class| self.classes[usize::from(class)]);
            let pair_constants = Pair::new([first.0, second.0], [first.1, second.1], self.constants);
            self.seen.push(pair);
            self.laws.push(AnyLaw::new(self.law, &pair_constants));
            self.laws.len() - 1
        })
    }
}

/// The spheres of every contact: pairs, then images with their sphere twice.
fn ends<const D: usize>(touching: &Touching<D>) -> Vec<[usize; 2]> {
    let pairs = touching.pairs.iter().map(|touch| touch.pair);
    pairs.chain(touching.images.iter().map(|touch| [touch.sphere; 2])).collect()
}

/// One law per kind of pair, and for each contact its kind.
pub(super) struct LawTable<'a> {
    kinds: Kinds<'a>,
    kind: Vec<u16>,
}

impl Respond<f64> for LawTable<'_> {
    #[inline(always)]
    fn force(&self, contact: usize, overlap: f64, closing_speed: f64, history: &History) -> f64 {
        self.of(contact).force(overlap, closing_speed, history)
    }
    #[inline(always)]
    fn respond(&self, contact: usize, overlap: f64, closing_speed: f64, history: &History) -> (f64, History) {
        self.of(contact).respond(overlap, closing_speed, history)
    }
}

impl<const D: usize> Laws<f64, D> for LawTable<'_> {
    fn sweep(&self, pass: Pass<'_, '_, f64, D>) {
        pass.under(self);
    }
    fn one(&self, contact: usize, _: usize) -> &AnyLaw {
        self.of(contact)
    }
    fn renumber(&mut self, from: &[Option<usize>], ends: &[[usize; 2]]) -> bool {
        let kinds = &mut self.kinds;
        let kind = |(from, ends): (&Option<usize>, &[usize; 2])| match from {
            Some(old) => self.kind[*old],
            None => kinds.place(0, *ends) as u16,
        };
        self.kind = from.iter().zip(ends).map(kind).collect();
        true
    }
}

impl<'a> LawTable<'a> {
    /// The law of a contact.
    #[inline(always)]
    fn of(&self, contact: usize) -> &AnyLaw {
        &self.kinds.laws[usize::from(self.kind[contact])]
    }

    /// Makes a law for every kind of pair that touches.
    pub fn new<const D: usize>(
        sample: &'a Sample<D>,
        touching: &Touching<D>,
        law: LawKind,
        constants: Constants,
    ) -> Self {
        let mut kinds = Kinds::new(&[sample], law, constants);
        let kind = ends(touching).into_iter().map(|pair| kinds.place(0, pair) as u16).collect();
        Self { kinds, kind }
    }
}

/// Up to 16 kinds of pairs, and for each contact the kind that it is in each design. What it holds does not depend on how it is read.
struct Looked<'a> {
    kinds: Kinds<'a>,
    lanes: usize,
    /// The numbers of a law that tables hold.
    parameters: fn(&AnyLaw) -> Vec<f64>,
    /// Parameter k of every kind.
    tables: Vec<[f64; 16]>,
    /// Kinds of contact c: from `c * lanes` on.
    kind: Vec<u8>,
}

impl Looked<'_> {
    /// Adds contacts, each one that was in the table, or new between two spheres; false if there are more than 16 kinds then.
    fn add(&mut self, from: impl Fn(usize) -> Option<usize>, old: &[u8], ends: &[[usize; 2]]) -> bool {
        for (c, &ends) in ends.iter().enumerate() {
            if let Some(from) = from(c) {
                self.kind.extend(&old[from * self.lanes..(from + 1) * self.lanes]);
                continue;
            }
            for lane in 0..self.lanes {
                self.kind.push(self.kinds.place(lane, ends).min(16) as u8);
            }
            if self.kinds.laws.len() > 16 {
                return false;
            }
        }
        for (place, law) in self.kinds.laws.iter().enumerate() {
            for (table, parameter) in self.tables.iter_mut().zip((self.parameters)(law)) {
                table[place] = parameter;
            }
        }
        true
    }

    fn renumber(&mut self, from: &[Option<usize>], ends: &[[usize; 2]]) -> bool {
        let old = std::mem::take(&mut self.kind);
        self.add(|c| from[c], &old, ends)
    }
}

/// A table of laws of one type, read in lanes.
pub(super) struct LaneTable<'a, L, V> {
    looked: Looked<'a>,
    read_as: PhantomData<(L, V)>,
}

impl<L: LaneLaw, V: Lanes> Respond<V> for LaneTable<'_, L, V> {
    #[inline(always)]
    fn force(&self, contact: usize, overlap: V, closing_speed: V, history: &History<V>) -> V {
        let place = V::index(&self.looked.kind[contact * V::LANES..(contact + 1) * V::LANES]);
        L::force_at(&Asked { tables: &self.looked.tables, place, overlap, closing_speed, history })
    }
    #[inline(always)]
    fn respond(&self, contact: usize, overlap: V, closing_speed: V, history: &History<V>) -> (V, History<V>) {
        let place = V::index(&self.looked.kind[contact * V::LANES..(contact + 1) * V::LANES]);
        L::respond_at(&Asked { tables: &self.looked.tables, place, overlap, closing_speed, history })
    }
}

impl<L: LaneLaw, V: Lanes, const D: usize> Laws<V, D> for LaneTable<'_, L, V> {
    fn sweep(&self, pass: Pass<'_, '_, V, D>) {
        if const { L::HAS_OWN_LOOPS || V::IS_SINGLE } {
            pass.quickly_under(self);
        } else {
            pass.under(self);
        }
    }
    fn one(&self, contact: usize, lane: usize) -> &AnyLaw {
        &self.looked.kinds.laws[usize::from(self.looked.kind[contact * V::LANES + lane])]
    }
    fn renumber(&mut self, from: &[Option<usize>], ends: &[[usize; 2]]) -> bool {
        self.looked.renumber(from, ends)
    }
}

impl<'a, L: LaneLaw, V: Lanes> LaneTable<'a, L, V> {
    /// Makes a law for every kind of pair that touches in any of the samples, one sample per lane; none if there are more
    /// than 16 kinds.
    pub fn new<const D: usize>(
        samples: &[&'a Sample<D>],
        touching: &Touching<D>,
        law: LawKind,
        constants: Constants,
    ) -> Option<Self> {
        let (kinds, tables) = (Kinds::new(samples, law, constants), vec![[0.0; 16]; L::PARAMETERS]);
        let mut looked = Looked { kinds, lanes: V::LANES, parameters: L::parameters, tables, kind: Vec::new() };
        looked.add(|_| None, &[], &ends(touching)).then_some(Self { looked, read_as: PhantomData })
    }
}
