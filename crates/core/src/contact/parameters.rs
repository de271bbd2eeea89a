//! The numbers of a law by name, and how they are written for one pair, for several side by side, or with derivatives.
//!
//! A law is declared once, by [`law!`](super::law), as a struct with named fields over a number type `V`. From that follow its
//! form for `f64`, for registers and for dual numbers, and the tables from which lanes look up their own pair's numbers.

use std::marker::PhantomData;

use super::{ForceLaw, History};
use crate::real::{Lanes, Number};

/// Named numbers, which can be listed, and read again as numbers of another type.
pub trait Parameters: Copy {
    /// The same with numbers of another type.
    type In<V: Number>: Copy;
    /// How many numbers there are.
    const COUNT: usize;
    /// Appends the numbers in the order in which they are declared.
    fn list(&self, list: &mut Vec<f64>);
    /// Takes as many numbers, in the same order.
    fn read<S: Source>(source: &mut S) -> Self::In<S::Value>;
}

/// Where numbers are read from, one by one.
pub trait Source {
    /// Their type.
    type Value: Number;
    /// The next number.
    fn next(&mut self) -> Self::Value;
}

impl Parameters for f64 {
    type In<V: Number> = V;
    const COUNT: usize = 1;

    fn list(&self, list: &mut Vec<f64>) {
        list.push(*self);
    }
    #[inline(always)]
    fn read<S: Source>(source: &mut S) -> S::Value {
        source.next()
    }
}

impl<const N: usize> Parameters for [f64; N] {
    type In<V: Number> = [V; N];
    const COUNT: usize = N;

    fn list(&self, list: &mut Vec<f64>) {
        list.extend(self);
    }
    #[inline(always)]
    fn read<S: Source>(source: &mut S) -> [S::Value; N] {
        let mut all = [S::Value::splat(0.0); N];
        for one in &mut all {
            *one = source.next();
        }
        all
    }
}

/// Numbers from a list.
pub struct Listed<'a, V>(pub &'a [V]);

impl<V: Number> Source for Listed<'_, V> {
    type Value = V;
    fn next(&mut self) -> V {
        let (first, rest) = self.0.split_first().expect("a law's numbers are as many as it declares");
        self.0 = rest;
        *first
    }
}

/// Numbers from tables, one for each, at a place of each lane's own.
pub(super) struct Tables<'a, V: Lanes> {
    pub tables: &'a [[f64; 16]],
    pub place: V::Index,
    pub next: usize,
}

impl<V: Lanes> Source for Tables<'_, V> {
    type Value = V;
    #[inline(always)]
    fn next(&mut self) -> V {
        let value = V::lookup(&self.tables[self.next], self.place);
        self.next += 1;
        value
    }
}

/// Declares named numbers that are part of a law: a struct over `V`, `f64` by default.
macro_rules! parameters {
    ($(#[$doc:meta])* $vis:vis struct $name:ident {
        $($(#[$of_field:meta])* $field_vis:vis $field:ident: $kind:ty),* $(,)?
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $vis struct $name<V = f64> {
            $($(#[$of_field])* $field_vis $field: $kind),*
        }
        impl $crate::contact::Parameters for $name {
            type In<V: $crate::real::Number> = $name<V>;
            const COUNT: usize = {
                type V = f64;
                0 $(+ <$kind as $crate::contact::Parameters>::COUNT)*
            };
            fn list(&self, list: &mut Vec<f64>) {
                $($crate::contact::Parameters::list(&self.$field, list);)*
            }
            #[inline(always)]
            fn read<S: $crate::contact::Source>(source: &mut S) -> $name<S::Value> {
                type V = f64;
                $name { $($field: <$kind as $crate::contact::Parameters>::read(source)),* }
            }
        }
    };
}
pub(super) use parameters;

/// Declares a law: its numbers by name, as for [`parameters!`], looked up in lanes.
macro_rules! law {
    ($(#[$doc:meta])* $vis:vis struct $name:ident { $($fields:tt)* }) => {
        $crate::contact::parameters::parameters! { $(#[$doc])* $vis struct $name { $($fields)* } }
        impl $crate::contact::LaneLaw for $name {
            const PARAMETERS: usize = <Self as $crate::contact::Parameters>::COUNT;

            fn parameters(law: &$crate::contact::AnyLaw) -> Vec<f64> {
                law.list()
            }
            #[inline(always)]
            fn force_at<V: $crate::real::Lanes>(asked: &$crate::contact::Asked<'_, V>) -> V {
                asked.force::<Self>()
            }
            #[inline(always)]
            fn respond_at<V: $crate::real::Lanes>(
                asked: &$crate::contact::Asked<'_, V>,
            ) -> (V, $crate::contact::History<V>) {
                asked.respond::<Self>()
            }
        }
    };
}
pub(super) use law;

/// Contacts side by side, each in its state and under its own numbers of one law.
#[derive(Clone, Copy)]
pub struct Asked<'a, V: Lanes> {
    /// A table for each number of the law, with an entry for each kind of pair.
    pub tables: &'a [[f64; 16]],
    /// Which kind of pair each contact is.
    pub place: V::Index,
    /// δ (m)
    pub overlap: V,
    /// Positive while the spheres approach (m/s).
    pub closing_speed: V,
    /// As of the last accepted step.
    pub history: &'a History<V>,
}

impl<V: Lanes> Asked<'_, V> {
    #[inline(always)]
    fn law<L: Parameters>(&self) -> L::In<V> {
        L::read(&mut Tables::<V> { tables: self.tables, place: self.place, next: 0 })
    }

    /// The force under a law with these numbers.
    #[inline(always)]
    pub fn force<L: Parameters>(&self) -> V
    where
        L::In<V>: ForceLaw<V>,
    {
        self.law::<L>().force(self.overlap, self.closing_speed, self.history)
    }

    /// The force, and the history after an accepted step.
    #[inline(always)]
    pub fn respond<L: Parameters>(&self) -> (V, History<V>)
    where
        L::In<V>: ForceLaw<V>,
    {
        self.law::<L>().respond(self.overlap, self.closing_speed, self.history)
    }
}

/// [`Asked::force`] as a job of its own.
pub(super) struct ForceOf<'a, V: Lanes, L>(pub Asked<'a, V>, pub PhantomData<L>);

/// [`Asked::respond`] as a job of its own.
pub(super) struct ResponseOf<'a, V: Lanes, L>(pub Asked<'a, V>, pub PhantomData<L>);

impl<V: Lanes, L: Parameters> crate::real::Job for ForceOf<'_, V, L>
where
    L::In<V>: ForceLaw<V>,
{
    type Output = V;
    #[inline(always)]
    fn run(self) -> V {
        self.0.force::<L>()
    }
}

impl<V: Lanes, L: Parameters> crate::real::Job for ResponseOf<'_, V, L>
where
    L::In<V>: ForceLaw<V>,
{
    type Output = (V, History<V>);
    #[inline(always)]
    fn run(self) -> (V, History<V>) {
        self.0.respond::<L>()
    }
}
