//! Which law holds at which contact: a table with one entry per kind of pair, for one design or for several side by side.

use std::marker::PhantomData;

use super::contacts::Laws;
use super::neighbour::Touching;
use super::size::reference_radius;
use crate::contact::{Asked, Constants, History, LaneLaw, NormalLaw, Pair};
use crate::material::Material;
use crate::real::Lanes;
use crate::sample::Sample;

/// The laws of the kinds of pairs that occur, found by materials and radii; a law that obeys similarity is made for spheres of the
/// samples' reference radius.
struct Kinds<'a, L> {
    constants: Constants,
    make: Box<dyn Fn(&Pair) -> L + Sync + 'a>,
    /// Materials, and the radius for which their laws are made (m).
    classes: Vec<(&'a Material, f64)>,
    /// The class of every sphere of every sample.
    class: Vec<Vec<u16>>,
    seen: Vec<[u16; 2]>,
    laws: Vec<L>,
}

impl<'a, L: NormalLaw> Kinds<'a, L> {
    fn new<const D: usize>(
        samples: &[&'a Sample<D>],
        constants: Constants,
        make: impl Fn(&Pair) -> L + Sync + 'a,
    ) -> Self {
        let mut classes: Vec<(&'a Material, f64)> = Vec::new();
        let class = samples.iter().map(|sample| {
            let reference = reference_radius(sample);
            let mut last = None;
            let of_sphere = sample.spheres.iter().map(|sphere| {
                let radius = if L::is_similar() { reference } else { sphere.radius };
                // Spheres that follow each other are often alike, and materials take long to compare.
                if let Some((material, of_last, class)) = last
                    && (material, of_last) == (sphere.material, radius)
                {
                    return class;
                }
                let one = (&sample.materials[sphere.material], radius);
                let class = classes.iter().position(|known| *known == one).unwrap_or_else(|| {
                    classes.push(one);
                    classes.len() - 1
                }) as u16;
                last = Some((sphere.material, radius, class));
                class
            });
            of_sphere.collect()
        });
        let class = class.collect();
        Self { constants, make: Box::new(make), classes, class, seen: Vec::new(), laws: Vec::new() }
    }

    /// The place of the law between two spheres of a sample.
    fn place(&mut self, sample: usize, [a, b]: [usize; 2]) -> usize {
        let of = &self.class[sample.min(self.class.len() - 1)];
        let pair = [of[a].min(of[b]), of[a].max(of[b])];
        self.seen.iter().position(|known| *known == pair).unwrap_or_else(|| {
            let [first, second] = pair.map(|class| self.classes[usize::from(class)]);
            let pair_constants = Pair::new([first.0, second.0], [first.1, second.1], self.constants);
            self.seen.push(pair);
            self.laws.push((self.make)(&pair_constants));
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
pub(super) struct LawTable<'a, L> {
    kinds: Kinds<'a, L>,
    kind: Vec<u16>,
}

impl<L: NormalLaw + Copy + Sync> Laws<f64> for LawTable<'_, L> {
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

impl<'a, L: NormalLaw> LawTable<'a, L> {
    /// The law of a contact.
    #[inline(always)]
    fn of(&self, contact: usize) -> &L {
        &self.kinds.laws[usize::from(self.kind[contact])]
    }

    /// Makes a law for every kind of pair that touches.
    pub fn new<const D: usize>(
        sample: &'a Sample<D>,
        touching: &Touching<D>,
        constants: Constants,
        make: impl Fn(&Pair) -> L + Sync + 'a,
    ) -> Self {
        let mut kinds = Kinds::new(&[sample], constants, make);
        let kind = ends(touching).map(|pair| kinds.place(0, pair) as u16).collect();
        Self { kinds, kind }
    }
}

/// Up to 16 kinds of pairs, and for each contact the kind that it is in each design.
pub(super) struct LaneTable<'a, L, V> {
    kinds: Kinds<'a, L>,
    /// Parameter k of every kind.
    tables: Vec<[f64; 16]>,
    /// Kinds of contact c: from `c * LANES` on.
    kind: Vec<u8>,
    width: PhantomData<V>,
}

impl<L: LaneLaw, V: Lanes> Laws<V> for LaneTable<'_, L, V> {
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
        self.kinds.laws[usize::from(self.kind[contact * V::LANES + lane])]
    }
    fn renumber(&mut self, from: &[Option<usize>], ends: &[[usize; 2]]) -> bool {
        let old = std::mem::take(&mut self.kind);
        for (from, ends) in from.iter().zip(ends) {
            match from {
                Some(from) => self.kind.extend(&old[from * V::LANES..(from + 1) * V::LANES]),
                None if !self.add(*ends) => return false,
                None => {}
            }
        }
        self.fill();
        true
    }
}

impl<'a, L: LaneLaw, V: Lanes> LaneTable<'a, L, V> {
    /// Makes a law for every kind of pair that touches in any of the samples, one sample per lane; none if there are more
    /// than 16 kinds.
    pub fn new<const D: usize>(
        samples: &[&'a Sample<D>],
        touching: &Touching<D>,
        constants: Constants,
        make: impl Fn(&Pair) -> L + Sync + 'a,
    ) -> Option<Self> {
        let kinds = Kinds::new(samples, constants, make);
        let tables = vec![[0.0; 16]; L::PARAMETERS];
        let mut table = Self { kinds, tables, kind: Vec::new(), width: PhantomData };
        for pair in ends(touching) {
            if !table.add(pair) {
                return None;
            }
        }
        table.fill();
        Some(table)
    }

    /// Adds a contact; false if there are more than 16 kinds then.
    fn add(&mut self, ends: [usize; 2]) -> bool {
        self.kind.extend((0..V::LANES).map(|lane| self.kinds.place(lane, ends).min(16) as u8));
        self.kinds.laws.len() <= 16
    }

    fn fill(&mut self) {
        for (place, law) in self.kinds.laws.iter().enumerate() {
            for (table, parameter) in self.tables.iter_mut().zip(law.parameters()) {
                table[place] = parameter;
            }
        }
    }
}
