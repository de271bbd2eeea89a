//! One lens for several foci: the struck width is cut into strips, one for each focus, and each strip takes a part of its own.

use super::first_order::Prescription;
use super::problem::aim;
use crate::lattice::HexagonalSheet;
use crate::target::Focus;

/// A strip of the struck width, and the foci that its part is for: several only where they are the same region.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Strip {
    /// Indices into the target's foci.
    pub foci: Vec<usize>,
    /// From where to where (m).
    pub window: [f64; 2],
}

/// The part of a lens on its strip, with its data of first order.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The foci that it is made for, as indices into those of the target.
    pub foci: Vec<usize>,
    /// The strip of the struck width that it takes (m).
    pub window: [f64; 2],
    /// Where it lies and how it is shaped.
    pub prescription: Prescription,
    /// Fraction of its own strip's rays that come to its focus.
    pub fraction: f64,
    /// The same without a lens.
    pub fraction_without: f64,
}

/// What rays bring to one focus.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusRays {
    /// Fraction of the whole struck width that passes it at its mid depth, wherever it comes from.
    pub fraction: f64,
    /// The same without a lens.
    pub fraction_without: f64,
    /// Earliest and latest time (s) at which rays come to its middle row within it.
    pub arrival: Option<[f64; 2]>,
    /// How many times more rays pass it than without a lens, less what faces reflect; see [`FirstOrder`](super::FirstOrder).
    pub gain: Option<f64>,
}

/// Cuts the struck width into strips in proportion to the foci's shares.
///
/// Of all orders of the strips the one is taken in which the way from a strip's farther end to where its part aims is least
/// slanted, in the strip where it is most; of equal ones that of the foci themselves. Neighbours for the same region are one.
pub(super) fn split(foci: &[Focus], lattice: &HexagonalSheet) -> Vec<Strip> {
    let width = lattice.half_width();
    let strips = |order: &[usize]| -> Vec<Strip> {
        let mut from = 0.0;
        let last = order.len() - 1;
        let cut = |(k, &focus): (usize, &usize)| {
            let to = if k == last { width } else { from + foci[focus].share * width };
            Strip { foci: vec![focus], window: [std::mem::replace(&mut from, to), to] }
        };
        order.iter().enumerate().map(cut).collect()
    };
    let slant = |strip: &Strip| {
        let region = &foci[strip.foci[0]].region;
        let aim = aim(region, &lattice.into());
        let across = strip.window.map(|x| (x - aim).abs());
        across[0].max(across[1]) / lattice.depth(region.mid_row()).max(lattice.row_spacing())
    };
    let worst = |order: &[usize]| strips(order).iter().map(slant).fold(0.0, f64::max);
    let mut best: (Vec<usize>, f64) = ((0..foci.len()).collect(), f64::INFINITY);
    best.1 = worst(&best.0);
    for order in orders(foci.len()) {
        let slant = worst(&order);
        // Equal but for round-off is equal.
        if slant < best.1 * (1.0 - 1e-9) {
            best = (order, slant);
        }
    }
    let mut joined: Vec<Strip> = Vec::new();
    for strip in strips(&best.0) {
        match joined.last_mut() {
            Some(before) if foci[before.foci[0]].region == foci[strip.foci[0]].region => {
                before.foci.extend(strip.foci);
                before.window[1] = strip.window[1];
            }
            _ => joined.push(strip),
        }
    }
    joined
}

/// All orders of so many things, the given one first.
fn orders(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let shorter = orders(count - 1);
    (0..count)
        .rev()
        .flat_map(|place| {
            shorter.iter().map(move |order| {
                let mut order = order.clone();
                order.insert(place, count - 1);
                order
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target::Region;

    fn foci(of: &[([u32; 2], [f64; 2], f64)]) -> Vec<Focus> {
        of.iter().map(|&(rows, x, share)| Focus { region: Region { rows, x }, share }).collect()
    }

    #[test]
    fn orders_are_all_permutations() {
        let all = orders(4);
        assert_eq!((all.len(), &all[0]), (24, &vec![0, 1, 2, 3]));
        assert!(all.iter().all(|order| (0..4).all(|k| order.contains(&k))));
        assert!((1..24).all(|k| !all[..k].contains(&all[k])));
    }

    /// Widths are as the shares; who stands farther out gets the outer strip, however the file orders them; of two at one place
    /// the shallow one gets the strip beside it; equal ones are one.
    #[test]
    fn strips_go_to_the_foci_they_stand_before() {
        let lattice = HexagonalSheet::new(1.0, 50, 16.0).unwrap();
        let near = ([20, 22], [0.0, 2.0], 0.25);
        let far = ([30, 32], [13.0, 16.0], 0.75);
        let expected = [([0.0, 4.0], near), ([4.0, 16.0], far)];
        for given in [[near, far], [far, near]] {
            let strips = split(&foci(&given), &lattice);
            for (strip, (window, focus)) in strips.iter().zip(expected) {
                assert_eq!((strip.window, given[strip.foci[0]]), (window, focus));
            }
        }
        let (shallow, deep) = (([12, 14], [0.0, 2.0], 0.5), ([36, 38], [0.0, 2.0], 0.5));
        for given in [[shallow, deep], [deep, shallow]] {
            let strips = split(&foci(&given), &lattice);
            assert_eq!((given[strips[0].foci[0]], strips[0].window), (shallow, [0.0, 8.0]));
        }
        let strips = split(&foci(&[near, near]), &lattice);
        assert_eq!(strips, [Strip { foci: vec![0, 1], window: [0.0, 16.0] }]);
    }
}
