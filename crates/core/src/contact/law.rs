//! The laws by name, one type that holds any of them, and how one is chosen once for a whole run.

use std::fmt;
use std::marker::PhantomData;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::parameters::{Asked, ForceOf, Listed, Parameters, ResponseOf};
use super::{
    Consistent, ElastoPlastic, ForceLaw, Hertz, HertzThesis, History, LaneLaw, LinearPlastic, Mdr, NormalLaw, Pair,
    Storakers, Thornton, Tsuji, WaltonBraun,
};
use crate::real::{Lanes, Number};

/// A name that is none of those known.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} \"{name}\"; known are {}", .known.join(", "))]
pub struct UnknownName {
    pub(super) what: &'static str,
    pub(super) name: String,
    pub(super) known: Vec<&'static str>,
}

macro_rules! named {
    ($type:ident, $what:literal, { $($variant:ident = $name:literal),* $(,)? }) => {
        impl $type {
            /// All of them, in the order in which they are listed to users.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The name used in files and on the command line.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }
        }
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }
        impl FromStr for $type {
            type Err = $crate::contact::UnknownName;
            fn from_str(name: &str) -> Result<Self, Self::Err> {
                let found = Self::ALL.iter().copied().find(|known| known.name() == name);
                found.ok_or_else(|| $crate::contact::UnknownName {
                    what: $what,
                    name: name.to_owned(),
                    known: Self::ALL.iter().map(|known| known.name()).collect(),
                })
            }
        }
    };
}
pub(super) use named;

/// The list of laws. A line: what users read about it, its variant and name, its type, and how it is made for a pair.
macro_rules! laws {
    ($($(#[$doc:meta])* $kind:ident = $name:literal: $type:ident, $make:expr;)*) => {
        /// A contact law by name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum LawKind {
            $($(#[$doc])* $kind),*
        }

        named!(LawKind, "contact law", { $($kind = $name),* });

        impl LawKind {
            /// Whether contacts yield under it.
            pub fn is_plastic(self) -> bool {
                match self { $(Self::$kind => <$type as NormalLaw>::is_plastic()),* }
            }

            /// What its contacts remember besides their greatest overlap and force, by name and unit.
            pub fn own_memory(self) -> Option<&'static str> {
                match self { $(Self::$kind => <$type as NormalLaw>::own_memory()),* }
            }
        }

        /// Any of the laws, for one pair of spheres.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(missing_docs, reason = "each is the law of that name, see `LawKind`")]
        pub enum AnyLaw<V = f64> {
            $($kind($type<V>)),*
        }

        /// How many numbers the laws have at most.
        const MOST: usize = {
            let mut most = 0;
            $(if <$type as Parameters>::COUNT > most { most = <$type as Parameters>::COUNT; })*
            most
        };

        impl AnyLaw {
            /// The law `kind` between the spheres of `pair`.
            pub fn new(kind: LawKind, pair: &Pair) -> Self {
                match kind {
                    $(LawKind::$kind => {
                        let make: fn(&Pair) -> $type = $make;
                        Self::$kind(make(pair))
                    })*
                }
            }

            /// Its name.
            pub fn kind(&self) -> LawKind {
                match self { $(Self::$kind(_) => LawKind::$kind),* }
            }

            /// Its numbers.
            pub fn list(&self) -> Vec<f64> {
                let mut list = Vec::new();
                match self { $(Self::$kind(law) => law.list(&mut list)),* }
                list
            }

            /// The same law with numbers from elsewhere, as many as `list` gives.
            pub fn with<V: Number>(&self, numbers: &[V]) -> AnyLaw<V> {
                let source = &mut Listed(numbers);
                match self { $(Self::$kind(_) => AnyLaw::$kind(<$type as Parameters>::read(source))),* }
            }

            /// What a contact remembers of which only its greatest overlap (m), and the force (N) it carried there, are known.
            pub fn recalled(&self, overlap_max: f64, force_max: f64) -> History {
                match self { $(Self::$kind(law) => law.recalled(overlap_max, force_max)),* }
            }
        }

        impl<V: Number> ForceLaw<V> for AnyLaw<V> {
            fn force(&self, overlap: V, closing_speed: V, history: &History<V>) -> V {
                match self { $(Self::$kind(law) => law.force(overlap, closing_speed, history)),* }
            }
            fn respond(&self, overlap: V, closing_speed: V, history: &History<V>) -> (V, History<V>) {
                match self { $(Self::$kind(law) => law.respond(overlap, closing_speed, history)),* }
            }
        }

        impl NormalLaw for AnyLaw {
            fn stored(&self, overlap: f64, history: &History) -> f64 {
                match self { $(Self::$kind(law) => law.stored(overlap, history)),* }
            }
            fn stiffness_max(&self, force_max: f64) -> f64 {
                match self { $(Self::$kind(law) => law.stiffness_max(force_max)),* }
            }
            fn overlap_limit(&self) -> f64 {
                match self { $(Self::$kind(law) => law.overlap_limit()),* }
            }
            fn yield_onset(&self, closing_speed: f64) -> f64 {
                match self { $(Self::$kind(law) => law.yield_onset(closing_speed)),* }
            }
        }

        /// Which law it is stands before its numbers. Each is compiled out of line, once for each width, so that a run's loop is not
        /// compiled anew for every law.
        impl LaneLaw for AnyLaw {
            const PARAMETERS: usize = 1 + MOST;
            const HAS_OWN_LOOPS: bool = false;

            fn parameters(law: &AnyLaw) -> Vec<f64> {
                let mut list = vec![f64::from(law.kind() as u8)];
                list.extend(law.list());
                list.resize(Self::PARAMETERS, 0.0);
                list
            }
            #[inline(always)]
            fn force_at<V: Lanes>(asked: &Asked<'_, V>) -> V {
                let (kind, asked) = which(asked);
                match kind { $(LawKind::$kind => V::outlined(ForceOf::<V, $type>(asked, PhantomData))),* }
            }
            #[inline(always)]
            fn respond_at<V: Lanes>(asked: &Asked<'_, V>) -> (V, History<V>) {
                let (kind, asked) = which(asked);
                match kind { $(LawKind::$kind => V::outlined(ResponseOf::<V, $type>(asked, PhantomData))),* }
            }
        }
    };
}

/// The law whose number stands in the first table, and its own tables.
#[inline(always)]
fn which<'a, V: Lanes>(asked: &Asked<'a, V>) -> (LawKind, Asked<'a, V>) {
    let kind = LawKind::ALL[asked.tables[0][0] as usize];
    (kind, Asked { tables: &asked.tables[1..], ..*asked })
}

laws! {
    /// The published elastic-plastic law with rate (Burgoyne 2016, appendix A.2.1).
    Thesis = "thesis": ElastoPlastic, |pair| ElastoPlastic::new(pair, true);
    /// The same with the rate off.
    ThesisStatic = "thesis-static": ElastoPlastic, |pair| ElastoPlastic::new(pair, false);
    /// The energy-consistent variant of `Thesis`, with rate.
    Consistent = "consistent": Consistent, |pair| Consistent::new(pair, true);
    /// The same with the rate off.
    ConsistentStatic = "consistent-static": Consistent, |pair| Consistent::new(pair, false);
    /// The mechanically derived law of Zunker and Kamrin (2024) as a pair law, with rate.
    Mdr = "mdr": Mdr, |pair| Mdr::new(pair, true);
    /// The same with the rate off, as published.
    MdrStatic = "mdr-static": Mdr, |pair| Mdr::new(pair, false);
    /// Hertz with a limit to the pressure (Thornton 1997).
    Thornton = "thornton": Thornton, Thornton::new;
    /// Straight lines, steeper on the way back (Walton and Braun 1986; Luding 2008).
    WaltonBraun = "walton-braun": WaltonBraun, WaltonBraun::new;
    /// Hertz with a dashpot of constant restitution (Tsuji and others 1992).
    Tsuji = "tsuji": Tsuji, Tsuji::new;
    /// Plastic contact with strain hardening (Storåkers and others 1997).
    Storakers = "storakers": Storakers, Storakers::new;
    /// Hertz, without memory.
    Hertz = "hertz": Hertz, Hertz::new;
    /// Hertz as appendix A.2.1 has it with plasticity off: clipped by history.
    HertzThesis = "hertz-thesis": HertzThesis, HertzThesis::new;
    /// Loading at the fully plastic stiffness from the start, with rate; unloading as `Thesis` (Burgoyne 2016, eq. 4.2).
    Linear = "linear": LinearPlastic, |pair| LinearPlastic::new(pair, true);
    /// The same with the rate off.
    LinearStatic = "linear-static": LinearPlastic, |pair| LinearPlastic::new(pair, false);
}

/// Something to be done under a law that is known by name only until then.
pub trait WithLaw<T> {
    /// Does it with laws of this type.
    fn with<L: LaneLaw>(self) -> T;
}

impl LawKind {
    /// Chooses the law, once for all that follows. The two that lenses are designed with, and Hertz, with which other
    /// programs are compared, have loops of their own; the others share one.
    pub fn choose<T>(self, then: impl WithLaw<T>) -> T {
        match self {
            Self::Thesis | Self::ThesisStatic => then.with::<ElastoPlastic>(),
            Self::Consistent | Self::ConsistentStatic => then.with::<Consistent>(),
            Self::Hertz => then.with::<Hertz>(),
            _ => then.with::<AnyLaw>(),
        }
    }

    /// Whether contacts of unequal size are followed as images of each other: F(δ, v; r*, S) = ρ² F(δ/ρ, v S₀/S; r*/ρ, S₀) with
    /// S = r₁ + r₂. So it is where a law knows no length but r*, and no speed but a rate of strain v/S. Of the laws of which that
    /// is not made use, one is made for each size.
    pub const fn is_similar(self) -> bool {
        matches!(self, Self::Thesis | Self::ThesisStatic | Self::Consistent | Self::ConsistentStatic | Self::Hertz)
    }
}

impl LawKind {
    /// Whether the force of a contact that begins to part is held to the greatest of the accepted steps before, as the published laws have
    /// it: what it reaches then depends on how near to its greatest overlap the last of these steps comes.
    pub const fn turns_late(self) -> bool {
        matches!(self, Self::HertzThesis) || self.makes_energy()
    }

    /// Whether a cycle of such a contact can give back more than it took: the published plastic laws, in gentle contacts.
    pub const fn makes_energy(self) -> bool {
        matches!(self, Self::Thesis | Self::ThesisStatic | Self::Linear | Self::LinearStatic)
    }
}

impl AnyLaw {
    /// Whether the contact is yielding in this state, `history` being that after the step: it is loaded as never before, and
    /// beyond its onset of yield.
    pub fn yields(&self, overlap: f64, closing_speed: f64, history: &History) -> bool {
        let onset = self.yield_onset(closing_speed);
        closing_speed >= 0.0 && overlap >= history.overlap_max && overlap > onset
    }
}
