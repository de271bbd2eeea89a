//! Consecutive rows of a crystal with all that belongs to them, and the seams between such sections.
//!
//! Sections are cut by the crystal alone, whatever the number of threads, and so are the orders of all sums.

use super::rows::{ImageStrand, Neighbours, Offset, Strand};
use crate::dem::arrival::ArrivalTracker;
use crate::dem::sheet::numbers::Numbers;

/// Numbers that stand side by side in memory, whatever the width of the registers.
pub const BLOCK: usize = 8;

/// A row in its section.
#[derive(Clone, Debug)]
pub struct Placed {
    /// Index of its first sphere in the sample.
    pub first: usize,
    pub count: usize,
    /// Where its first sphere stands in the section's arrays: at the beginning of a block.
    pub place: usize,
    /// Where its contacts begin and end among the section's bundles.
    pub bundles: [u32; 2],
    /// The same of contacts with images, of spheres on mirrors, and of spheres that are struck.
    pub images: [u32; 2],
    pub on_mirrors: [u32; 2],
    pub struck: [u32; 2],
}

/// Contacts of two rows in memory: contact k is between places a + k and b + k.
#[derive(Clone, Copy, Debug)]
pub struct Bundle {
    pub a: u32,
    pub b: u32,
    pub rows: [u32; 2],
    pub count: u32,
    /// Block of the store at which they begin.
    pub slot: u32,
    pub offset: u32,
}

/// Contacts of a row with its images in memory.
#[derive(Clone, Copy, Debug)]
pub struct ImageBundle {
    pub place: u32,
    pub count: u32,
    pub slot: u32,
    pub axis: u32,
    pub inward: f64,
    pub gap: f64,
    /// The part of each sphere that belongs to the simulated half.
    pub part: f64,
}

/// What contacts remember, eight by eight: greatest overlap and force, what the law keeps besides, and where energies are accounted for,
/// overlap, force and work.
#[derive(Clone, Debug)]
pub struct Store {
    /// Numbers per contact.
    pub fields: usize,
    /// Whether the law keeps a number of its own, and whether energies are accounted for.
    pub has_own: bool,
    pub has_account: bool,
    pub numbers: Numbers,
    /// Kind of each pair.
    pub kinds: Vec<u8>,
}

impl Store {
    fn new(blocks: usize, keep: Keep) -> Self {
        let fields = 2 + usize::from(keep.own) + 3 * usize::from(keep.accounts);
        let numbers = Numbers::zero(blocks * fields * BLOCK);
        Self { fields, has_own: keep.own, has_account: keep.accounts, numbers, kinds: vec![0; blocks * BLOCK] }
    }

    /// Where the first number of a contact stands, with those of the seven beside it.
    #[inline(always)]
    pub fn at(&self, slot: u32, k: usize) -> usize {
        (slot as usize + k / BLOCK) * self.fields * BLOCK + k % BLOCK
    }

    /// Number `field` of a contact.
    pub fn get(&self, slot: u32, k: usize, field: usize) -> f64 {
        self.numbers.get()[self.at(slot, k) + field * BLOCK]
    }

    /// Where the account begins.
    pub fn account(&self) -> usize {
        self.fields - 3
    }
}

/// What is remembered besides motion and the greatest overlap and force of contacts.
#[derive(Clone, Copy, Debug)]
pub struct Keep {
    /// A number of the law's own.
    pub own: bool,
    /// Energies, contact by contact.
    pub accounts: bool,
    /// Accelerations one and two steps ago.
    pub past: bool,
}

/// First arrivals.
#[derive(Clone, Debug)]
pub enum Arrivals {
    /// Not recorded.
    None,
    /// When each sphere's speed first passed this one (m/s): s, NaN before.
    Speed(f64, Vec<f64>),
    /// Of each sphere's own greatest speed.
    Own(Vec<ArrivalTracker>),
}

/// Rows, spheres and the contacts between them.
#[derive(Clone, Debug)]
pub struct Section {
    pub rows: Vec<Placed>,
    /// Rows that the wave has reached; all others are at rest.
    pub active: Vec<bool>,
    pub any_active: bool,
    /// Displacement at the step to come (m), predicted velocity (m/s), sum of forces (N).
    pub x: [Numbers; 3],
    pub predicted: [Numbers; 3],
    pub force: [Numbers; 3],
    /// Acceleration by contacts (m/s²) now, one and two steps ago, eight by eight: three or nine numbers a sphere.
    pub past: Numbers,
    pub past_fields: usize,
    /// Material of each sphere, from 1; 0 where there is none.
    pub kinds: Vec<u8>,
    pub bundles: Vec<Bundle>,
    pub images: Vec<ImageBundle>,
    pub store: Store,
    /// Place, weight and mobility of spheres on mirrors.
    pub on_mirrors: Vec<(u32, f64, [f64; 3])>,
    /// Places of struck spheres.
    pub struck: Vec<u32>,
    /// Their v² before the step that is done (m²/s²).
    pub before: Vec<f64>,
    /// v² (m²/s²) and squared contact acceleration at their greatest.
    pub speed_squared: Numbers,
    pub acceleration_squared: Numbers,
    pub arrivals: Arrivals,
    /// Work of the load in the step to come (J).
    pub work: f64,
}

/// Contacts between a section and the next.
#[derive(Clone, Debug)]
pub struct Seam {
    pub bundles: Vec<Bundle>,
    pub store: Store,
    /// Place of the upper section from which on it is touched; the lower one is touched from its beginning.
    pub upper_from: usize,
    /// Sums of forces on both sides (N).
    pub on_upper: [Numbers; 3],
    pub on_lower: [Numbers; 3],
    /// Whether there are any.
    pub acts: bool,
    /// Rows that are touched in this step.
    pub woken: [Vec<u32>; 2],
}

/// A crystal in memory.
pub struct Cut {
    pub sections: Vec<Section>,
    pub seams: Vec<Seam>,
    /// Section and row in it of each row.
    pub home: Vec<[u32; 2]>,
}

/// Fewest spheres of a section, and how many sections there are at most.
pub const LEAST: usize = 8192;
const MOST_SECTIONS: usize = 32;

/// Cuts a crystal into sections so large that contacts reach into the next one at most. `material` tells that of each sphere from 1, `kind` the
/// kind of a pair.
pub fn cut(
    found: &Neighbours,
    least: usize,
    keep: Keep,
    material: &dyn Fn(usize) -> u8,
    struck: &[usize],
    arrivals: &Arrivals,
) -> Cut {
    let rows = &found.rows;
    let spheres = rows.last().map_or(0, |row| row.first + row.count);
    let reach = |strand: &Strand| {
        let [a, b] = [0, 1].map(|k| rows[strand.rows[k]].first + strand.from[k]);
        b + 1 - a
    };
    let least = found.contacts.iter().map(reach).fold(least.max(spheres.div_ceil(MOST_SECTIONS)), usize::max);
    // Which rows belong to which section; what is left over at the end goes to the last one.
    let mut starts = vec![0];
    for (index, row) in rows.iter().enumerate() {
        let begun = rows[*starts.last().unwrap_or(&0)].first;
        if row.first >= begun + least && spheres - row.first >= least {
            starts.push(index);
        }
    }
    starts.push(rows.len());
    let mut is_struck: Vec<usize> = struck.to_vec();
    is_struck.sort_unstable();
    is_struck.dedup();

    let mut home = vec![[0; 2]; rows.len()];
    let mut sections = Vec::new();
    for (section, ends) in starts.windows(2).enumerate() {
        for row in ends[0]..ends[1] {
            home[row] = [section as u32, (row - ends[0]) as u32];
        }
        sections.push(Section::new(found, ends[0]..ends[1], keep, material, &is_struck, arrivals));
    }
    let mut seams: Vec<Vec<Bundle>> = vec![Vec::new(); sections.len().saturating_sub(1)];
    let (mut slots, mut seam_slots) = (vec![0; sections.len()], vec![0; seams.len()]);
    for strand in &found.contacts {
        let [[section, row_a], [other, row_b]] = strand.rows.map(|row| home[row]);
        let [a, b] = [(section, row_a, 0), (other, row_b, 1)]
            .map(|(section, row, k)| (sections[section as usize].rows[row as usize].place + strand.from[k]) as u32);
        let inside = section == other;
        let slot = if inside { &mut slots[section as usize] } else { &mut seam_slots[section as usize] };
        let bundle = Bundle {
            a,
            b,
            rows: [row_a, row_b],
            count: strand.count as u32,
            slot: *slot,
            offset: strand.offset as u32,
        };
        *slot += strand.count.div_ceil(BLOCK) as u32;
        if inside {
            let section = &mut sections[section as usize];
            section.bundles.push(bundle);
            section.rows[row_a as usize].bundles[1] = section.bundles.len() as u32;
        } else {
            debug_assert_eq!(section + 1, other, "sections are larger than contacts reach");
            seams[section as usize].push(bundle);
        }
    }
    for strand in &found.images {
        let [section, row] = home[strand.row];
        sections[section as usize].add_image(row as usize, strand, &mut slots[section as usize]);
    }
    for (section, slots) in sections.iter_mut().zip(slots) {
        section.end(slots as usize, keep);
    }
    let seams = seams
        .into_iter()
        .zip(seam_slots)
        .zip(sections.windows(2))
        .map(|((bundles, slots), sides)| Seam::new(bundles, slots as usize, keep, [&sides[0], &sides[1]]));
    Cut { seams: seams.collect(), sections, home }
}

impl Section {
    fn new(
        found: &Neighbours,
        rows: std::ops::Range<usize>,
        keep: Keep,
        material: &dyn Fn(usize) -> u8,
        struck: &[usize],
        arrivals: &Arrivals,
    ) -> Self {
        let (mut placed, mut kinds, mut on_mirrors, mut of_struck) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut mirrors = found.on_mirrors[found.on_mirrors.partition_point(|sphere| sphere.row < rows.start)..].iter();
        let mut next = mirrors.next();
        for index in rows {
            let row = found.rows[index];
            let place = kinds.len();
            kinds.extend((row.first..row.first + row.count).map(material));
            kinds.resize(kinds.len().next_multiple_of(BLOCK), 0);
            let mut ends = Placed {
                first: row.first,
                count: row.count,
                place,
                bundles: [0; 2],
                images: [0; 2],
                on_mirrors: [on_mirrors.len() as u32; 2],
                struck: [of_struck.len() as u32; 2],
            };
            while let Some(sphere) = next.filter(|sphere| sphere.row == index) {
                on_mirrors.push(((place + sphere.at) as u32, sphere.weight, sphere.mobility));
                next = mirrors.next();
            }
            let from = struck.partition_point(|&sphere| sphere < row.first);
            let hit = struck[from..].iter().take_while(|&&sphere| sphere < row.first + row.count);
            of_struck.extend(hit.map(|sphere| (place + sphere - row.first) as u32));
            (ends.on_mirrors[1], ends.struck[1]) = (on_mirrors.len() as u32, of_struck.len() as u32);
            placed.push(ends);
        }
        // A register may look beyond the last row.
        let places = kinds.len();
        let zero = || Numbers::zero(places + BLOCK);
        let past_fields = if keep.past { 9 } else { 3 };
        let arrivals = match arrivals {
            Arrivals::None => Arrivals::None,
            Arrivals::Speed(speed, _) => Arrivals::Speed(*speed, vec![f64::NAN; places]),
            Arrivals::Own(_) => Arrivals::Own(vec![ArrivalTracker::default(); places]),
        };
        Self {
            active: vec![false; placed.len()],
            any_active: false,
            rows: placed,
            x: [zero(), zero(), zero()],
            predicted: [zero(), zero(), zero()],
            force: [zero(), zero(), zero()],
            past: Numbers::zero(past_fields * places),
            past_fields,
            kinds,
            bundles: Vec::new(),
            images: Vec::new(),
            store: Store::new(0, keep),
            on_mirrors,
            before: vec![0.0; of_struck.len()],
            struck: of_struck,
            speed_squared: Numbers::zero(places),
            acceleration_squared: Numbers::zero(places),
            arrivals,
            work: 0.0,
        }
    }

    fn add_image(&mut self, row: usize, strand: &ImageStrand, slots: &mut u32) {
        let placed = &mut self.rows[row];
        self.images.push(ImageBundle {
            place: (placed.place + strand.from) as u32,
            count: strand.count as u32,
            slot: *slots,
            axis: strand.axis as u32,
            inward: strand.inward,
            gap: strand.gap,
            part: strand.part,
        });
        *slots += strand.count.div_ceil(BLOCK) as u32;
        placed.images[1] = self.images.len() as u32;
    }

    /// All contacts are known: makes room for their memories and finds their kinds.
    fn end(&mut self, slots: usize, keep: Keep) {
        // Contacts come in order of their first row.
        let (mut bundles, mut images) = (0, 0);
        for row in &mut self.rows {
            row.bundles = [bundles, row.bundles[1].max(bundles)];
            row.images = [images, row.images[1].max(images)];
            (bundles, images) = (row.bundles[1], row.images[1]);
        }
        self.store = Store::new(slots, keep);
        for bundle in &self.bundles {
            self.store.set_kinds(bundle, &self.kinds, &self.kinds);
        }
        for bundle in &self.images {
            for k in 0..bundle.count as usize {
                let kind = self.kinds[bundle.place as usize + k];
                self.store.kinds[bundle.slot as usize * BLOCK + k] = pair_kind(kind, kind);
            }
        }
    }

    /// The part of a sphere that belongs to the simulated half.
    pub fn weight(&self, place: usize) -> f64 {
        let at = self.on_mirrors.binary_search_by_key(&(place as u32), |sphere| sphere.0);
        at.map_or(1.0, |at| self.on_mirrors[at].1)
    }

    /// 1/weight of a sphere, or 0 across a mirror that it lies on.
    pub fn mobility(&self, place: usize) -> [f64; 3] {
        let at = self.on_mirrors.binary_search_by_key(&(place as u32), |sphere| sphere.0);
        at.map_or([1.0; 3], |at| self.on_mirrors[at].2)
    }
}

fn pair_kind(a: u8, b: u8) -> u8 {
    if a * b == 0 { 0 } else { crate::dem::sheet::kinds::kind(a - 1, b - 1) }
}

impl Store {
    fn set_kinds(&mut self, bundle: &Bundle, of_a: &[u8], of_b: &[u8]) {
        for k in 0..bundle.count as usize {
            let kind = pair_kind(of_a[bundle.a as usize + k], of_b[bundle.b as usize + k]);
            self.kinds[bundle.slot as usize * BLOCK + k] = kind;
        }
    }
}

impl Seam {
    fn new(bundles: Vec<Bundle>, slots: usize, keep: Keep, [upper, lower]: [&Section; 2]) -> Self {
        let mut store = Store::new(slots, keep);
        for bundle in &bundles {
            store.set_kinds(bundle, &upper.kinds, &lower.kinds);
        }
        let first = bundles.iter().map(|bundle| upper.rows[bundle.rows[0] as usize].place).min();
        let upper_from = first.unwrap_or(upper.kinds.len());
        let end = |row: u32| lower.rows[row as usize].place + lower.rows[row as usize].count.next_multiple_of(BLOCK);
        let lower_to = bundles.iter().map(|bundle| end(bundle.rows[1])).max().unwrap_or(0);
        let zero = |length| std::array::from_fn(|_| Numbers::zero(length + BLOCK));
        Self {
            bundles,
            store,
            upper_from,
            on_upper: zero(upper.kinds.len() - upper_from),
            on_lower: zero(lower_to),
            acts: false,
            woken: [Vec::new(), Vec::new()],
        }
    }
}

/// Weight of a contact of a whole sphere with its image.
pub const IMAGE_WEIGHT: f64 = 0.5;

/// Offsets are read by their place.
pub fn offset_of<'a>(offsets: &'a [Offset], bundle: &Bundle) -> &'a Offset {
    &offsets[bundle.offset as usize]
}
