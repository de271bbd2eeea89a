//! How the list of contacts changes: who is near whom now, under which law, and what of the old list stays.

use super::Contacts;
use super::account::Account;
use super::faces::{Facing, NearFace, near_faces};
use super::sections::Sections;
use super::swept::Swept;
use super::{FaceKey, Kept};
use crate::dem::rig::Rig;
use crate::dem::rig::bodies::Bodies;
use crate::dem::rig::law::{End, LawMaker, reduced_mass};
use crate::dem::rig::pairs::{Finder, Near};
use crate::dem::share::{cut, parts, pieces, rows};

impl<const D: usize, L: Swept<D>> Contacts<D, L> {
    /// Looks anew who is near whom; memories go with their contact.
    pub fn renew(&mut self, rig: &Rig<D>, finder: &Finder<D>, bodies: &Bodies<D>, maker: &impl LawMaker<L>) {
        let near = finder.find(rig, &bodies.displacement);
        let faces = near_faces(rig, finder, bodies);
        self.replace(rig, near, faces, bodies, maker);
    }

    /// Puts another list in the place of the present one; memories go with their contact.
    pub fn replace(
        &mut self,
        rig: &Rig<D>,
        near: Vec<Near<D>>,
        faces: Vec<NearFace>,
        bodies: &Bodies<D>,
        maker: &impl LawMaker<L>,
    ) {
        let key = |face: &NearFace| -> FaceKey { (face.sphere, face.facing) };
        let old_pairs = self.near.len();
        let Heritage { mut from, mut gone } = Heritage::of(&self.near, &near, Near::key);
        let of_faces = Heritage::of(&self.faces, &faces, key);
        from.extend(of_faces.from.iter().map(|&f| if f == NEW { NEW } else { f + old_pairs as u32 }));
        gone.extend(of_faces.gone.iter().map(|f| old_pairs + f));

        for c in gone {
            self.drop_contact(c, bodies);
        }
        // One after the other, so that of one alone there are two.
        self.near = near;
        self.faces = faces;
        self.memory = inherited(&self.memory, &from);
        self.account.inherit(&from);
        if self.turning {
            self.stretch.iter_mut().for_each(|axis| *axis = inherited(axis, &from));
        }
        self.extra = inherited_rows(&self.extra, &from, if self.turning { self.more.count::<D>() } else { 0 });
        if !self.kept_pairs.is_empty() || !self.kept_faces.is_empty() {
            for c in (0..from.len()).filter(|&c| from[c] == NEW) {
                let kept = match self.near.get(c) {
                    Some(pair) => self.kept_pairs.remove(&pair.key()),
                    None => self.kept_faces.remove(&key(&self.faces[c - self.near.len()])),
                };
                if let Some(kept) = kept {
                    self.memory[c] = kept.memory;
                    let account = Account { work: kept.work, friction_work: kept.friction_work, ..Account::default() };
                    self.account.put(c, account);
                }
            }
        }
        self.bind(rig, maker);
        self.share = match rig.mirrors.is_empty() {
            true => Vec::new(),
            false => rows(self.near.len(), |c| share_in_mirrors(rig, &self.near[c])),
        };
        self.beside = L::beside(&self.near, &self.pair_laws, &self.pair_law[..self.near.len()], &self.ends);
        self.sections = Sections::of(&self.near, self.class.len());
    }

    /// Keeps what a contact remembers that is no longer near.
    fn drop_contact(&mut self, c: usize, bodies: &Bodies<D>) {
        let Account { work, friction_work, .. } = self.account.at(c);
        let memory = self.memory[c];
        if memory == L::Memory::default() && work == 0.0 && friction_work == 0.0 {
            return;
        }
        self.dropped.extend(self.strain(c));
        if L::NUMBERS == 0 {
            self.lost[0] += self.weight(c) * work;
            self.lost[1] += self.weight(c) * friction_work;
            for (sphere, part) in self.spheres(c) {
                let energy = part * self.weight(c) * (work + friction_work);
                self.lost_by_sphere[sphere] += energy / bodies.weight[sphere];
            }
            return;
        }
        let kept = Kept { memory, work, friction_work, weight: self.weight(c) };
        match self.near.get(c) {
            Some(pair) => {
                self.kept_pairs.insert(pair.key(), kept);
            }
            None => {
                let face = &self.faces[c - self.near.len()];
                self.kept_faces.insert((face.sphere, face.facing), kept);
            }
        }
    }

    fn bind<B: LawMaker<L>>(&mut self, rig: &Rig<D>, maker: &B) {
        let count = self.near.len() + self.faces.len();
        let (near, faces, ends, flat_factor) = (&self.near, &self.faces, &self.ends, &self.flat_factor);
        let own = |c: usize| match faces.get(c.wrapping_sub(near.len())).map(|face| face.facing) {
            Some(Facing::Flat(f)) => {
                Some((f, &rig.flats[f as usize].contact)).filter(|(_, contact)| !contact.is_usual())
            }
            _ => None,
        };
        let met = |c: usize| match near.get(c) {
            Some(pair) => (pair.ends.map(|i| ends[i as usize]), 1.0),
            None => {
                let face = &faces[c - near.len()];
                let end = ends[face.sphere as usize];
                // Where a flat stands for an equal sphere the closing speed counts double, and the mass that is slowed half.
                let (mass, counted) = match face.facing {
                    Facing::Flat(f) => (rig.flats[f as usize].mass, flat_factor[f as usize]),
                    Facing::Mirror(_) => (end.mass, 1.0),
                };
                let face = match own(c).and_then(|(_, contact)| contact.material) {
                    Some(material) => End { material, radius: f64::INFINITY, mass },
                    None => End { mass, ..end },
                };
                ([end, face], counted)
            }
        };
        self.reduced = rows(count, |c| {
            let (ends, counted) = met(c);
            reduced_mass(ends) / counted
        });
        let class = |i: u32| if B::BY_SIZE { self.class[i as usize] } else { ends[i as usize].material as u32 };
        let mut last = None;
        self.pair_law.clear();
        for c in 0..count {
            // A face counts as a sphere like the one that it meets, unless there is something of its own about it.
            let key = match (near.get(c), own(c)) {
                (Some(pair), _) => pair.ends.map(class),
                (None, Some((flat, _))) => [class(faces[c - near.len()].sphere), OF_FLAT | flat],
                (None, None) => [faces[c - near.len()].sphere; 2].map(class),
            };
            // Most contacts have the law of the one before.
            let place = match last {
                Some((known, place)) if known == key => place,
                _ => {
                    let next = self.pair_laws.len() as u32;
                    let place = *self.known_bonds.entry(key).or_insert(next);
                    if place == next {
                        self.pair_laws.push(maker.pair_law(met(c).0, own(c).map(|(_, contact)| contact)));
                    }
                    place
                }
            };
            last = Some((key, place));
            self.pair_law.push(place);
        }
    }
}

/// Where the entries of a new list stood in the old one, and what of the old one is gone.
struct Heritage {
    /// Places in the old list, or [`NEW`].
    from: Vec<u32>,
    gone: Vec<usize>,
}

/// In the key of a kind of contact: its second end is no kind of sphere but this flat.
const OF_FLAT: u32 = 1 << 31;

/// No place in an old list.
const NEW: u32 = u32::MAX;

impl Heritage {
    /// Of lists in order of their keys, which are walked through side by side.
    fn of<T: Sync, K: Ord>(old: &[T], new: &[T], key: impl Fn(&T) -> K + Sync + Send) -> Self {
        // Each part of the new list has that of the old one up to where the next begins.
        let begin = |n: usize| if n == 0 { 0 } else { old.partition_point(|entry| key(entry) < key(&new[n])) };
        let walks = parts(new.len(), |range| {
            let mut walk = Self { from: Vec::with_capacity(range.len()), gone: Vec::new() };
            let (mut c, end) = (begin(range.start), if range.end == new.len() { old.len() } else { begin(range.end) });
            for entry in &new[range] {
                let entry = key(entry);
                while c < end && key(&old[c]) < entry {
                    walk.gone.push(c);
                    c += 1;
                }
                if c < end && key(&old[c]) == entry {
                    walk.from.push(c as u32);
                    c += 1;
                } else {
                    walk.from.push(NEW);
                }
            }
            walk.gone.extend(c..end);
            walk
        });
        let mut all = Self { from: Vec::with_capacity(new.len()), gone: Vec::new() };
        for walk in walks {
            all.from.extend(walk.from);
            all.gone.extend(walk.gone);
        }
        all
    }
}

/// The rows that stood in these places; of new ones nothing.
pub fn inherited<T: Copy + Default + Send + Sync>(old: &[T], from: &[u32]) -> Vec<T> {
    let mut new = vec![T::default(); from.len()];
    let mut left = &mut new[..];
    let take = |range: std::ops::Range<usize>| (cut(&mut left, range.len()), &from[range]);
    pieces(from.len(), take, |(new, from)| {
        for (new, &place) in new.iter_mut().zip(from).filter(|(_, place)| **place != NEW) {
            *new = old[place as usize];
        }
    });
    new
}

/// The same of rows of so many numbers each.
fn inherited_rows(old: &[f64], from: &[u32], count: usize) -> Vec<f64> {
    let mut rows = vec![0.0; from.len() * count];
    if count > 0 {
        for (row, &place) in rows.chunks_exact_mut(count).zip(from).filter(|(_, place)| **place != NEW) {
            row.copy_from_slice(&old[place as usize * count..][..count]);
        }
    }
    rows
}

/// 1/2 for a pair that lies in a mirror, on which both its spheres lie.
fn share_in_mirrors<const D: usize>(rig: &Rig<D>, pair: &Near<D>) -> f64 {
    let mut share = 1.0;
    for mirror in &rig.mirrors {
        let on = |i: u32| {
            let sphere = &rig.sample.spheres[i as usize];
            mirror.carries(&sphere.centre, sphere.radius)
        };
        if pair.ends.into_iter().all(on) {
            share *= 0.5;
        }
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What stays, what is new and what is gone, of lists so long that they are walked through in parts: as two sets say.
    #[test]
    fn what_stays_is_found_where_it_was() {
        let thinned = |of: std::ops::Range<u32>, part: u32| -> Vec<u32> {
            of.filter(|n| n.wrapping_mul(2_654_435_761) >> 16 & 7 != part).collect()
        };
        let cases = [
            (thinned(0..60_000, 1), thinned(0..60_000, 2)),
            (thinned(0..60_000, 1), thinned(20_000..90_000, 2)),
            (thinned(20_000..90_000, 1), thinned(0..60_000, 2)),
            // Gaps over whole parts.
            ([thinned(0..9000, 1), thinned(50_000..80_000, 1)].concat(), thinned(0..80_000, 2)),
            (thinned(0..80_000, 1), [thinned(0..9000, 2), thinned(50_000..80_000, 2)].concat()),
            (Vec::new(), thinned(0..60_000, 2)),
            (thinned(0..60_000, 1), Vec::new()),
            (thinned(0..90, 1), thinned(30..120, 2)),
        ];
        for (old, new) in cases {
            let heritage = Heritage::of(&old, &new, |&entry| entry);
            let place = |entry: &u32| old.binary_search(entry).map_or(NEW, |c| c as u32);
            assert_eq!(heritage.from, new.iter().map(place).collect::<Vec<_>>());
            let gone = (0..old.len()).filter(|&c| new.binary_search(&old[c]).is_err());
            assert_eq!(heritage.gone, gone.collect::<Vec<_>>());
        }
        assert_eq!(inherited(&[5, 6, 7], &[2, NEW, 0]), [7, 0, 5]);
    }
}
