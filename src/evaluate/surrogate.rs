//! What can be guessed of a layout before anything is simulated: how much later the wave comes down on the focus than beside
//! it, by the speeds that the bound gives.

use super::traced::eikonal;
use crate::design::Design;
use crate::layout::Layout;
use crate::wave::site_speeds;

/// A surrogate without a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrivalSurrogate {
    /// Straight down, through what stands there: microseconds.
    Bound,
    /// First arrivals along the fastest paths: milliseconds.
    Eikonal,
}

impl ArrivalSurrogate {
    /// Both, the cheaper first.
    pub const ALL: [Self; 2] = [Self::Bound, Self::Eikonal];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bound => "bound",
            Self::Eikonal => "eikonal",
        }
    }

    /// By how much (s) the wave comes later above the focal region than above the protected one, in the last row before both;
    /// of several foci the mean by their shares. A
    /// lens that gathers holds the wave back on its axis, so that the front behind it is hollow.
    pub fn delay(self, design: &Design, layout: &Layout) -> f64 {
        let (lattice, target) = (&layout.lattice, &design.target);
        let row = target.focal_rows()[0].min(target.protect.rows[0]).saturating_sub(1).max(1);
        let sites = lattice.sites();
        let times: Vec<f64> = match self {
            Self::Eikonal => eikonal(design, layout, None).at_sites(),
            Self::Bound => straight_down(layout, &site_speeds(layout, design.constants, None)),
        };
        let mean = |x: [f64; 2]| {
            let slack = 1e-9 * lattice.diameter();
            let within = |i: &usize| sites[*i].row == row && (x[0] - slack..=x[1] + slack).contains(&sites[*i].x);
            let of: Vec<f64> = (0..sites.len()).filter(within).map(|i| times[i]).collect();
            of.iter().sum::<f64>() / of.len().max(1) as f64
        };
        let focal: f64 = target.foci.iter().map(|focus| focus.share * mean(focus.region.x)).sum();
        focal - mean(target.protect.x)
    }
}

/// For each site the time (s) along the straight line down to it, through each row at the mean slowness of the one or two
/// spheres that stand there.
fn straight_down(layout: &Layout, speeds: &[f64]) -> Vec<f64> {
    let lattice = &layout.lattice;
    let sites = lattice.sites();
    let reach = 0.5 * lattice.diameter() * (1.0 + 1e-9);
    let down_to = |x: f64, row: u32| -> f64 {
        let mut slowness = vec![(0.0, 0.0); row as usize];
        for (site, speed) in sites.iter().zip(speeds) {
            if site.row <= row && (site.x - x).abs() <= reach {
                let (sum, count) = &mut slowness[site.row as usize - 1];
                *sum += 1.0 / speed;
                *count += 1.0;
            }
        }
        lattice.row_spacing() * slowness.iter().skip(1).map(|(sum, count)| sum / count).sum::<f64>()
    };
    sites.iter().map(|site| down_to(site.x, site.row)).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// In one material all comes at once; behind the design's lens the axis is late, straight down by about the lens's
    /// thickness there over the difference of speeds; and detours only ever shorten the time.
    #[test]
    fn a_gathering_lens_holds_the_wave_back_on_its_axis() {
        let design = Design::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("designs/quickstart.toml")).unwrap();
        let request = design.lens.clone().unwrap();
        let lens =
            crate::lens::propose(&design.lattice, &design.host, &request, &design.target, design.constants).unwrap();
        let layout = lens.layout();
        let host = Layout { materials: vec![0; layout.materials.len()], ..layout.clone() };
        for surrogate in ArrivalSurrogate::ALL {
            assert!(surrogate.delay(&design, &host).abs() < 1e-12, "{}", surrogate.name());
            assert!(surrogate.delay(&design, &layout) > 1e-6, "{}", surrogate.name());
        }
        let speeds = site_speeds(&layout, design.constants, None);
        let (straight, first) = (straight_down(&layout, &speeds), eikonal(&design, &layout, None).at_sites());
        // The mesh of first arrivals takes speeds between sites as it finds them: two percent.
        assert!(first.iter().zip(&straight).all(|(first, straight)| *first <= 1.02 * straight + 1e-7));
    }
}
