//! Which law holds between which bodies.

use std::sync::Arc;

use super::dashpot::{Ended, Loss, SpringDashpot};
use super::flat::FlatContact;
use crate::contact::{AnyLaw, Constants, ForceLaw as _, History, LawKind, NormalLaw, OVERLAP_LIMIT, Pair, Tabulated};
use crate::material::Material;

/// The laws of a rig.
#[derive(Clone, Debug)]
pub enum LawBook {
    /// Laws of spheres by their materials.
    Materials {
        /// Between all materials that `pairs` does not name.
        law: Law,
        /// Set of fitted constants of the elastic-plastic laws.
        constants: Constants,
        /// What is different between single pairs of materials. A flat counts as a sphere like the one it meets, unless it is of a
        /// material of its own.
        pairs: Vec<PairRule>,
        /// Friction at every other contact; where there is none at all, nothing turns.
        friction: Option<Friction>,
    },
    /// Linear spring and dashpot, F = k δ + γ m̄ v with closing speed v, which pulls as a contact ends (Kondic et al. 2012).
    Dashpot {
        /// k (N/m)
        stiffness: f64,
        /// Per material of the sample what the dashpot takes, and friction; between two materials those of the one with the
        /// higher index hold. All are rates, or none is.
        materials: Vec<(Loss, Option<Friction>)>,
        /// Whether the force is cut at zero, so that contacts never pull.
        cut: bool,
        /// Where the lever arms of friction end.
        arm: Arm,
    },
}

/// What holds between two materials in place of what holds everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct PairRule {
    /// By their indices in the sample.
    pub materials: [usize; 2],
    /// The law, if it is another.
    pub law: Option<Law>,
    /// Friction, if it is another.
    pub friction: Option<Friction>,
}

impl PairRule {
    /// Whether it is for these two, in either order.
    pub fn is_of(&self, [a, b]: [usize; 2]) -> bool {
        self.materials == [a, b] || self.materials == [b, a]
    }
}

/// The rule for two materials.
fn rule(pairs: &[PairRule], materials: [usize; 2]) -> Option<&PairRule> {
    pairs.iter().find(|rule| rule.is_of(materials))
}

/// Where the lever arms of contact forces end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Arm {
    /// In the contact, the middle of the overlap: a pair keeps its angular momentum. So it is by materials always.
    Contact,
    /// At the radius, as Kondic et al. 2012 have it: a pair gains angular momentum, F_t δ in the time.
    #[default]
    Radius,
}

/// A normal law by name or by table.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// One of the named laws.
    Named(LawKind),
    /// Force over overlap from a table.
    Tabulated(Arc<Tabulated>),
    /// A linear spring and a dashpot.
    SpringDashpot(SpringDashpot),
}

/// Friction at a contact: a tangential spring and a dashpot γ_t m̄ u beside it, at most μ |F_n| (Cundall and Strack 1979).
///
/// By materials the spring is incremental while its stiffness grows and falls with its stiffness while that falls, so that no path
/// of overlap and slip gives work; it is cut back to the cap by itself. Disks of [`LawBook::Dashpot`] in the plane follow Kondic et
/// al. (2012): k_t ξ + γ_t m̄ u is cut as a whole. Spin about the normal meets no friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// μ
    pub coefficient: f64,
    /// The tangential spring.
    pub spring: Spring,
    /// γ_t (1/s), per reduced mass.
    pub damping: f64,
    /// μ_r, resistance to rolling: a couple against the rotation of one body over the other, of at most μ_r R_r |F_n| with R_r = r* of two
    /// spheres and R on a flat (model C of Ai et al. 2011, without its dashpot). It comes of the tangential spring, on the way R_r θ that the
    /// contact rolls (k_r = k_t R_r², Wensrich and Katterfeld 2012), by the same rule. Not in [`LawBook::Dashpot`].
    pub rolling: f64,
}

/// The spring of static friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spring {
    /// None: kinetic friction, by damping and the cap alone; without damping there would be none, which is refused.
    None,
    /// k_t (N/m)
    Constant(f64),
    /// k_t = 8 G* √(r* δ), of two elastic spheres (Mindlin 1949), with 1/G* = 2(2−ν₁)(1+ν₁)/E₁ + 2(2−ν₂)(1+ν₂)/E₂. The contact sticks or
    /// slips as a whole.
    Mindlin,
    /// The same stiffness spread over the contact, whose rim slips while its middle sticks (Cattaneo 1938, Mindlin 1949): a row of springs
    /// side by side, each with the part of the normal force that Hertz's pressure gives it. By the method of dimensionality reduction (Popov and
    /// Heß 2015, chapter 5) that is the solution for equal elastic spheres on every path of normal and tangential force.
    CattaneoMindlin,
}

impl LawBook {
    /// Whether a dashpot acts at any contact: its force begins and ends with a jump, which the trapezoids of the energy ledger
    /// resolve to some percent of what it takes.
    pub fn has_dashpots(&self) -> bool {
        let viscous = |law: &Law| matches!(law, Law::SpringDashpot(law) if law.loss != Loss::Rate(0.0));
        match self {
            Self::Materials { law, pairs, .. } => {
                viscous(law) || pairs.iter().filter_map(|rule| rule.law.as_ref()).any(viscous)
            }
            Self::Dashpot { .. } => true,
        }
    }

    /// Where the lever arms of friction end.
    pub fn arm(&self) -> Arm {
        match self {
            Self::Materials { .. } => Arm::Contact,
            Self::Dashpot { arm, .. } => *arm,
        }
    }

    /// The name of the law between two materials, by their indices.
    pub fn name_of(&self, [a, b]: [usize; 2]) -> &'static str {
        match self {
            Self::Dashpot { .. } => SpringDashpot::NAME,
            Self::Materials { law, pairs, .. } => match law_between(law, pairs, [a, b]) {
                Law::Named(kind) => kind.name(),
                Law::Tabulated(_) => "table",
                Law::SpringDashpot(_) => SpringDashpot::NAME,
            },
        }
    }

    /// Whether any contact has friction, so that spheres turn.
    pub fn has_friction(&self) -> bool {
        self.frictions().next().is_some()
    }

    /// Every kind of friction in it.
    pub(super) fn frictions(&self) -> impl Iterator<Item = &Friction> {
        let (one, of_pairs, many) = match self {
            Self::Materials { friction, pairs, .. } => (friction.as_ref(), pairs.as_slice(), &[][..]),
            Self::Dashpot { materials, .. } => (None, &[][..], materials.as_slice()),
        };
        let of_pairs = of_pairs.iter().filter_map(|rule| rule.friction.as_ref());
        one.into_iter().chain(of_pairs).chain(many.iter().filter_map(|(_, friction)| friction.as_ref()))
    }

    /// Switches friction off.
    pub(super) fn without_friction(&mut self) {
        match self {
            Self::Materials { friction, pairs, .. } => {
                *friction = None;
                pairs.iter_mut().for_each(|rule| rule.friction = None);
            }
            Self::Dashpot { materials, .. } => materials.iter_mut().for_each(|(_, friction)| *friction = None),
        }
    }

    /// One named law between all materials, with the code's constants and without friction.
    pub fn named(kind: LawKind) -> Self {
        Self::Materials { law: Law::Named(kind), constants: Constants::default(), pairs: Vec::new(), friction: None }
    }
}

/// The law between two materials, of a book's law and its rules for pairs.
pub(super) fn law_between<'a>(law: &'a Law, pairs: &'a [PairRule], materials: [usize; 2]) -> &'a Law {
    rule(pairs, materials).and_then(|rule| rule.law.as_ref()).unwrap_or(law)
}

/// A contact in the first state in which it is closed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Begun<M> {
    /// What acts over the step (N), and the force proper.
    pub acts: f64,
    pub force: f64,
    /// The force with which it began (N).
    pub onset: f64,
    pub memory: M,
}

/// A normal law as the rig evaluates it, with what a contact under it remembers.
pub(super) trait ContactLaw: Clone + Send + Sync + 'static {
    /// What a contact remembers.
    type Memory: Copy + Default + PartialEq + Send + Sync + 'static;
    /// How many numbers that is.
    const NUMBERS: usize;
    /// Whether friction in the plane is that of Kondic et al., a constant spring and a dashpot under one cap.
    const GRIPS: bool;
    /// Force (N) between bodies of reduced mass m̄ (kg), and the memory after an accepted step.
    fn respond(&self, overlap: f64, closing_speed: f64, reduced: f64, memory: &Self::Memory) -> (f64, Self::Memory);
    /// As `respond` in the first state in which the contact is closed, a step (s) after one in which it was open. The force
    /// acts over a whole step: where it begins with a jump it is weighed by the part of the step in which it acts.
    fn begin(
        &self,
        overlap: f64,
        closing_speed: f64,
        reduced: f64,
        memory: &Self::Memory,
        _step: f64,
    ) -> Begun<Self::Memory> {
        let (force, memory) = self.respond(overlap, closing_speed, reduced, memory);
        Begun { acts: force, force, onset: 0.0, memory }
    }
    /// How a contact ends that has just opened, whose surfaces are a gap (m) apart and which had this overlap (m) and force (N) a step ago,
    /// where its force ends with a jump.
    fn end(&self, before: [f64; 2], gap: f64, closing_speed: f64, reduced: f64, memory: &Self::Memory) -> Ended;
    /// dF/dδ (N/m) as the contact begins to open, from two differences whose errors of first order cancel: to 1e-8 of it.
    fn stiffness(&self, overlap: f64, reduced: f64, memory: &Self::Memory) -> f64 {
        let opened = |part: f64| self.respond(overlap * (1.0 - part), -f64::MIN_POSITIVE, reduced, memory).0;
        let fall = |part: f64| (opened(0.0) - opened(part)) / (part * overlap);
        if overlap > 0.0 { 2.0 * fall(0.5e-4) - fall(1e-4) } else { 0.0 }
    }
    /// Energy (J) that the contact would give back.
    fn stored(&self, overlap: f64, memory: &Self::Memory) -> f64;
    /// Whether the contact is yielding, with the memory after the step.
    fn yields(&self, overlap: f64, closing_speed: f64, memory: &Self::Memory) -> bool;
    /// Greatest overlap (m) and force (N) so far, where they are remembered.
    fn greatest(memory: &Self::Memory) -> Option<[f64; 2]>;
    /// The greatest stiffness (N/m) after having carried `force_max` (N).
    fn stiffness_max(&self, force_max: f64) -> f64;
    /// The greatest overlap (m) for which the law is known.
    fn range(&self) -> f64;
    /// See [`NormalLaw::overlap_limit`].
    fn overlap_limit(&self) -> f64 {
        OVERLAP_LIMIT
    }
    /// The memory as numbers.
    fn numbers(memory: &Self::Memory) -> Vec<f64>;
    /// The memory from its numbers.
    fn from_numbers(numbers: &[f64]) -> Self::Memory;
}

/// A law of [`Law`], for two given spheres.
#[derive(Clone, Debug)]
pub(super) enum SolidLaw {
    Named(AnyLaw),
    Tabulated(Arc<Tabulated>),
    SpringDashpot(SpringDashpot),
}

/// δ_max, F_max and what a law remembers besides, as [`History`] has them, in a row that registers take at once.
pub(super) type Remembered = [f64; 3];

fn history(&[overlap_max, force_max, own]: &Remembered) -> History {
    History { overlap_max, force_max, own }
}

fn remembered(History { overlap_max, force_max, own }: History) -> Remembered {
    [overlap_max, force_max, own]
}

impl ContactLaw for SolidLaw {
    type Memory = Remembered;
    const NUMBERS: usize = 3;
    const GRIPS: bool = false;

    fn respond(&self, overlap: f64, closing_speed: f64, reduced: f64, memory: &Remembered) -> (f64, Remembered) {
        let memory = &history(memory);
        let (force, after) = match self {
            Self::SpringDashpot(law) => law.of(reduced).respond(overlap, closing_speed, memory),
            Self::Named(law) => law.respond(overlap, closing_speed, memory),
            Self::Tabulated(law) => law.respond(overlap, closing_speed, memory),
        };
        (force, remembered(after))
    }
    fn begin(
        &self,
        overlap: f64,
        closing_speed: f64,
        reduced: f64,
        memory: &Remembered,
        step: f64,
    ) -> Begun<Remembered> {
        if let Self::SpringDashpot(law) = self {
            let (acts, force, onset) = law.begin(overlap, closing_speed, reduced, step);
            let memory = remembered(history(memory).advanced(overlap, force.max(onset)));
            return Begun { acts, force, onset, memory };
        }
        let (force, memory) = self.respond(overlap, closing_speed, reduced, memory);
        Begun { acts: force, force, onset: 0.0, memory }
    }
    fn end(&self, before: [f64; 2], gap: f64, closing_speed: f64, reduced: f64, _: &Remembered) -> Ended {
        if let Self::SpringDashpot(law) = self {
            return law.end(before, gap, closing_speed, reduced);
        }
        // Laws of metals end as they do in crystals (`dem::contacts`), so that a lens moves alike as a rig.
        Ended::default()
    }
    fn stored(&self, overlap: f64, memory: &Remembered) -> f64 {
        let memory = &history(memory);
        match self {
            Self::SpringDashpot(law) => law.of(0.0).stored(overlap, memory),
            Self::Named(law) => law.stored(overlap, memory),
            Self::Tabulated(law) => law.stored(overlap, memory),
        }
    }
    fn yields(&self, overlap: f64, closing_speed: f64, memory: &Remembered) -> bool {
        match self {
            Self::Named(law) => law.yields(overlap, closing_speed, &history(memory)),
            Self::Tabulated(_) | Self::SpringDashpot(_) => false,
        }
    }
    fn greatest(&[overlap_max, force_max, _]: &Remembered) -> Option<[f64; 2]> {
        Some([overlap_max, force_max])
    }
    fn stiffness_max(&self, force_max: f64) -> f64 {
        match self {
            Self::SpringDashpot(law) => law.stiffness,
            Self::Named(law) => law.stiffness_max(force_max),
            Self::Tabulated(law) => law.stiffness_max(force_max),
        }
    }
    fn range(&self) -> f64 {
        match self {
            Self::Named(_) | Self::SpringDashpot(_) => f64::INFINITY,
            Self::Tabulated(law) => law.range(),
        }
    }
    fn overlap_limit(&self) -> f64 {
        match self {
            Self::Named(law) => law.overlap_limit(),
            Self::Tabulated(_) | Self::SpringDashpot(_) => OVERLAP_LIMIT,
        }
    }
    fn numbers(memory: &Remembered) -> Vec<f64> {
        memory.to_vec()
    }
    fn from_numbers(numbers: &[f64]) -> Remembered {
        [numbers[0], numbers[1], numbers[2]]
    }
}

/// Without memory, for beds.
impl ContactLaw for SpringDashpot {
    type Memory = ();
    const NUMBERS: usize = 0;
    const GRIPS: bool = true;

    #[inline(always)]
    fn respond(&self, overlap: f64, closing_speed: f64, reduced: f64, (): &()) -> (f64, ()) {
        (self.push(overlap, closing_speed, self.damping(reduced)), ())
    }
    #[inline(always)]
    fn begin(&self, overlap: f64, closing_speed: f64, reduced: f64, (): &(), step: f64) -> Begun<()> {
        if !self.loss.is_exact() {
            let force = self.push(overlap, closing_speed, self.damping(reduced));
            return Begun { acts: force, force, onset: 0.0, memory: () };
        }
        let (acts, force, onset) = self.begin(overlap, closing_speed, reduced, step);
        Begun { acts, force, onset, memory: () }
    }
    #[inline(always)]
    fn end(&self, before: [f64; 2], gap: f64, closing_speed: f64, reduced: f64, (): &()) -> Ended {
        if self.loss.is_exact() { self.end(before, gap, closing_speed, reduced) } else { Ended::default() }
    }
    fn stored(&self, overlap: f64, (): &()) -> f64 {
        0.5 * self.stiffness * overlap * overlap
    }
    fn yields(&self, _: f64, _: f64, (): &()) -> bool {
        false
    }
    fn greatest((): &()) -> Option<[f64; 2]> {
        None
    }
    fn stiffness_max(&self, _: f64) -> f64 {
        self.stiffness
    }
    fn range(&self) -> f64 {
        f64::INFINITY
    }
    fn numbers((): &()) -> Vec<f64> {
        Vec::new()
    }
    fn from_numbers(_: &[f64]) {}
}

/// Normal law and friction of one kind of contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairLaw<L> {
    pub normal: L,
    pub slip: Slip,
}

/// Friction with the constants of a pair worked in. All zero without friction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slip {
    /// μ
    pub coefficient: f64,
    /// k_t (N/m), constant part
    pub stiffness: f64,
    /// k_t over √δ (N/m^1.5), Mindlin's part
    pub mindlin: f64,
    /// γ_t (1/s), per reduced mass
    pub rate: f64,
    /// Whether Mindlin's part is spread over the contact.
    pub spread: bool,
    /// μ_r, and r* (m)
    pub rolling: f64,
    pub rolling_radius: f64,
}

/// One end of a contact, as far as laws ask for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct End {
    pub material: usize,
    pub radius: f64,
    /// Infinite for what cannot move.
    pub mass: f64,
}

pub(super) fn reduced_mass([a, b]: [End; 2]) -> f64 {
    match (a.mass.is_finite(), b.mass.is_finite()) {
        (true, true) => a.mass * b.mass / (a.mass + b.mass),
        (true, false) => a.mass,
        _ => b.mass,
    }
}

/// Makes bonds from a law book.
pub(super) trait LawMaker<L>: Send + Sync {
    /// Whether laws depend on the spheres' sizes, not on their materials alone.
    const BY_SIZE: bool;
    /// Between two ends, of which the second may be a flat with rules of its own.
    fn pair_law(&self, ends: [End; 2], flat: Option<&FlatContact>) -> PairLaw<L>;
}

/// Laws by materials; see [`LawBook::Materials`].
pub(super) struct ByMaterial {
    pub law: Law,
    pub constants: Constants,
    pub pairs: Vec<PairRule>,
    pub friction: Option<Friction>,
    pub materials: Vec<Material>,
}

impl LawMaker<SolidLaw> for ByMaterial {
    const BY_SIZE: bool = true;

    fn pair_law(&self, ends: [End; 2], flat: Option<&FlatContact>) -> PairLaw<SolidLaw> {
        let [a, b] = ends;
        let materials = [&self.materials[a.material], &self.materials[b.material]];
        let pair = Pair::new(materials, [a.radius, b.radius], self.constants);
        let both = [a.material, b.material];
        let between = law_between(&self.law, &self.pairs, both);
        let normal = match flat.and_then(|flat| flat.law.as_ref()).unwrap_or(between) {
            Law::Named(kind) => SolidLaw::Named(AnyLaw::new(*kind, &pair)),
            Law::Tabulated(table) => SolidLaw::Tabulated(Arc::clone(table)),
            Law::SpringDashpot(law) => SolidLaw::SpringDashpot(*law),
        };
        let between = rule(&self.pairs, both).and_then(|rule| rule.friction).or(self.friction);
        let slip = flat.and_then(|flat| flat.friction).or(between).map_or(Slip::default(), |friction| {
            let compliance = |m: &Material| 2.0 * (2.0 - m.poisson_ratio) * (1.0 + m.poisson_ratio) / m.youngs_modulus;
            let shear = 1.0 / (compliance(materials[0]) + compliance(materials[1]));
            Slip { rolling_radius: pair.radius, ..friction.slip(8.0 * shear * pair.radius.sqrt()) }
        });
        PairLaw { normal, slip }
    }
}

/// Springs and dashpots; see [`LawBook::Dashpot`].
pub(super) struct ByDashpot {
    pub stiffness: f64,
    pub materials: Vec<(Loss, Option<Friction>)>,
    pub cut: bool,
}

impl LawMaker<SpringDashpot> for ByDashpot {
    const BY_SIZE: bool = false;

    fn pair_law(&self, ends: [End; 2], _: Option<&FlatContact>) -> PairLaw<SpringDashpot> {
        let (loss, friction) = self.materials[ends[0].material.max(ends[1].material)];
        let normal = SpringDashpot { stiffness: self.stiffness, loss, cut: self.cut };
        PairLaw { normal, slip: friction.map_or(Slip::default(), |friction| friction.slip(0.0)) }
    }
}

impl Friction {
    /// Coulomb's friction with the tangential spring of elastic spheres, undamped.
    pub fn mindlin(coefficient: f64) -> Self {
        Self { coefficient, spring: Spring::Mindlin, damping: 0.0, rolling: 0.0 }
    }

    /// Whether it is asked for and has neither a spring nor damping, so that no force would ever come of it; or resists rolling without a
    /// spring.
    pub fn does_nothing(&self) -> bool {
        let slides = self.coefficient > 0.0 && self.damping == 0.0;
        self.spring == Spring::None && (slides || self.rolling > 0.0)
    }

    fn slip(&self, mindlin: f64) -> Slip {
        Slip {
            coefficient: self.coefficient,
            stiffness: if let Spring::Constant(stiffness) = self.spring { stiffness } else { 0.0 },
            mindlin: if matches!(self.spring, Spring::Mindlin | Spring::CattaneoMindlin) { mindlin } else { 0.0 },
            rate: self.damping,
            spread: self.spring == Spring::CattaneoMindlin,
            rolling: self.rolling,
            rolling_radius: 0.0,
        }
    }
}
