//! Which contacts there are: those at rest, and those between spheres that come near only later.
//!
//! Nothing here depends on laws or on how many designs stand side by side.

use super::boundary::{Carried, Period, Surface};
use super::neighbour::{SelfTouch, Touch, Touching};
use crate::sample::Sample;

/// The contacts of a packing: pairs, then images. They are in order of their spheres, and new ones are put in between, so that forces
/// are added in the same order whenever a contact has come up.
#[derive(Clone)]
pub(super) struct List<const D: usize> {
    pub pairs: Vec<Touch<D>>,
    pub images: Vec<SelfTouch<D>>,
    periods: Vec<Period>,
    /// The part of each that belongs to what is simulated: of pairs 1, or 1/2 where they lie in a mirror.
    pub weight: Vec<f64>,
    /// For each sphere the number of pairs whose first sphere comes before it.
    pub first_pair: Vec<usize>,
}

impl<const D: usize> List<D> {
    /// The contacts at rest.
    pub fn new(touching: Touching<D>, carried: &Carried<D>) -> Self {
        let Touching { pairs, images, periods } = touching;
        let mut list = Self { pairs, images, periods, weight: Vec::new(), first_pair: Vec::new() };
        list.describe(carried);
        list
    }

    fn describe(&mut self, carried: &Carried<D>) {
        self.weight.clear();
        self.weight.extend(self.pairs.iter().map(|touch| carried.weight_between(touch.pair)));
        let towards = |touch: &SelfTouch<D>| touch.surface.normal(&touch.centre);
        self.weight.extend(self.images.iter().map(|touch| carried.weight_of_image(touch.sphere, &towards(touch))));
        self.first_pair.clear();
        self.first_pair.push(0);
        for i in 0..carried.spheres() {
            let mut end = self.first_pair[i];
            while self.pairs.get(end).is_some_and(|touch| touch.pair[0] == i) {
                end += 1;
            }
            self.first_pair.push(end);
        }
    }

    /// Number of contacts.
    pub fn len(&self) -> usize {
        self.pairs.len() + self.images.len()
    }

    /// Takes up contacts between spheres that have come near each other, and of spheres with their image in a surface. For each
    /// contact, where it stood before.
    pub fn restore(
        &mut self,
        first: &Sample<D>,
        pairs: &[[usize; 2]],
        images: &[(usize, Surface)],
        surfaces: &[Surface],
        carried: &Carried<D>,
    ) -> Vec<Option<usize>> {
        let old = self.pairs.len();
        let mut all: Vec<_> = self.pairs.iter().copied().enumerate().map(|(c, touch)| (touch, Some(c))).collect();
        all.extend(pairs.iter().map(|&pair| (Touch::new(first, pair, &self.periods), None)));
        all.sort_by_key(|(touch, _)| touch.pair);
        let mut all_images: Vec<_> =
            self.images.iter().copied().enumerate().map(|(c, touch)| (touch, Some(old + c))).collect();
        all_images.extend(images.iter().map(|(sphere, surface)| (SelfTouch::new(first, *sphere, surface), None)));
        let place = |touch: &SelfTouch<D>| surfaces.iter().position(|surface| touch.surface == *surface);
        all_images.sort_by_key(|(touch, _)| (touch.sphere, place(touch)));

        let from = all.iter().map(|(_, from)| *from).chain(all_images.iter().map(|(_, from)| *from)).collect();
        self.pairs = all.into_iter().map(|(touch, _)| touch).collect();
        self.images = all_images.into_iter().map(|(touch, _)| touch).collect();
        self.describe(carried);
        from
    }

    /// The second spheres of the pairs whose first is sphere `i`, in order.
    pub fn partners(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        self.pairs[self.first_pair[i]..self.first_pair[i + 1]].iter().map(|touch| touch.pair[1])
    }

    /// Whether a sphere's image in a surface is one of the contacts.
    pub fn holds_image(&self, sphere: usize, surface: &Surface) -> bool {
        let from = self.images.partition_point(|touch| touch.sphere < sphere);
        self.images[from..].iter().take_while(|touch| touch.sphere == sphere).any(|touch| touch.surface == *surface)
    }

    /// The spheres of a contact; an image's sphere twice.
    pub fn spheres(&self, contact: usize) -> [usize; 2] {
        match self.pairs.get(contact) {
            Some(touch) => touch.pair,
            None => [self.images[contact - self.pairs.len()].sphere; 2],
        }
    }

    /// Whether a contact is one with an image in this surface.
    pub fn is_image_in(&self, contact: usize, surface: &Surface) -> bool {
        contact.checked_sub(self.pairs.len()).is_some_and(|image| self.images[image].surface == *surface)
    }

    /// The spheres of every contact.
    pub fn ends(&self) -> Vec<[usize; 2]> {
        (0..self.len()).map(|c| self.spheres(c)).collect()
    }
}
