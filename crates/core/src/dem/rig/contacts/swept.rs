//! How pairs under a law are swept over: several side by side where the law and the dimension have that, else one at a time.

use super::lanes::Lines;
use super::solids::{self, Looked};
use super::{Contacts, Predicted, Sums};
use crate::dem::rig::bodies::Bodies;
use crate::dem::rig::dashpot::SpringDashpot;
use crate::dem::rig::law::{ContactLaw, End, PairLaw, SolidLaw};
use crate::dem::rig::pairs::Near;

/// A law in `D` dimensions.
pub trait Swept<const D: usize>: ContactLaw {
    /// What a list of pairs has besides, for those that are taken side by side.
    type Beside: Default + Send + Sync;
    /// That of a list of such spheres in which each pair has the law in its place.
    fn beside(_near: &[Near<D>], _pair_laws: &[PairLaw<Self>], _pair_law: &[u32], _ends: &[End]) -> Self::Beside {
        Self::Beside::default()
    }
    /// Adds up the forces of all pairs, and the torques of those that are `TURNING`; memories advance by one step.
    fn sweep<const TURNING: bool>(
        contacts: &mut Contacts<D, Self>,
        bodies: &Bodies<D>,
        predicted: Predicted<'_, D>,
        sums: &mut Sums<D>,
    ) {
        contacts.sweep_any::<TURNING>(bodies, predicted, sums);
    }
}

impl<const D: usize> Swept<D> for SolidLaw {
    /// The numbers of their laws, if all pairs have one law.
    type Beside = Option<Looked>;

    fn beside(near: &[Near<D>], pair_laws: &[PairLaw<Self>], pair_law: &[u32], ends: &[End]) -> Option<Looked> {
        Looked::of(pair_laws, pair_law, near, ends)
    }
    fn sweep<const TURNING: bool>(
        contacts: &mut Contacts<D, Self>,
        bodies: &Bodies<D>,
        predicted: Predicted<'_, D>,
        sums: &mut Sums<D>,
    ) {
        if contacts.beside.is_none() || contacts.radius.is_empty() {
            contacts.sweep_any::<TURNING>(bodies, predicted, sums);
        } else if TURNING {
            contacts.sweep_solids::<{ solids::TURNING }>(bodies, predicted, sums);
        } else {
            contacts.sweep_solids::<{ solids::STRAIGHT }>(bodies, predicted, sums);
        }
    }
}

impl Swept<1> for SpringDashpot {
    type Beside = ();
}

impl Swept<2> for SpringDashpot {
    /// The pairs as parallel arrays.
    type Beside = Lines;

    fn beside(near: &[Near<2>], _: &[PairLaw<Self>], _: &[u32], ends: &[End]) -> Lines {
        Lines::of(near, ends)
    }
    fn sweep<const TURNING: bool>(
        contacts: &mut Contacts<2, Self>,
        bodies: &Bodies<2>,
        predicted: Predicted<'_, 2>,
        sums: &mut Sums<2>,
    ) {
        if contacts.share.is_empty() && contacts.radius.is_empty() {
            contacts.sweep_disks::<TURNING>(bodies, predicted, sums);
        } else {
            contacts.sweep_any::<TURNING>(bodies, predicted, sums);
        }
    }
}

impl Swept<3> for SpringDashpot {
    type Beside = ();
}
