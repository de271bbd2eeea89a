//! What is wanted, and where: the focal and the protected region, and the time window in which the impact is judged.

use serde::{Deserialize, Serialize};

use crate::lattice::{HexagonalSheet, Site};

/// A rectangle of the crystal: whole rows between two distances from the axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// First and last row, both included, from 1.
    pub rows: [u32; 2],
    /// Least and greatest distance from the axis (m), both included.
    pub x: [f64; 2],
}

impl Region {
    /// Whether a site lies in the region; its edges count as inside to one part in 10⁹ of the diameter.
    pub fn contains(&self, site: &Site, diameter: f64) -> bool {
        let slack = 1e-9 * diameter;
        (self.rows[0]..=self.rows[1]).contains(&site.row) && site.x >= self.x[0] - slack && site.x <= self.x[1] + slack
    }

    /// Indices of the sites inside, in the lattice's order.
    pub fn sites(&self, lattice: &HexagonalSheet) -> Vec<usize> {
        let sites = lattice.sites();
        (0..sites.len()).filter(|&i| self.contains(&sites[i], lattice.diameter())).collect()
    }

    /// The row midway between first and last; a half where their number is even.
    pub fn mid_row(&self) -> f64 {
        f64::from(self.rows[0] + self.rows[1]) / 2.0
    }
}

/// A region where energy is wanted, and how much of the blow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Focus {
    /// Where.
    #[serde(flatten)]
    pub region: Region,
    /// Its part of the blow; those of all foci sum to 1.
    #[serde(default = "whole", skip_serializing_if = "is_whole")]
    pub share: f64,
}

fn whole() -> f64 {
    1.0
}

fn is_whole(share: &f64) -> bool {
    *share == 1.0
}

/// Where energy is wanted and where it is not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// The focal regions, one or several, in the order of the design file. In JSON a single one is no list.
    #[serde(rename = "focus", with = "one_or_several")]
    pub foci: Vec<Focus>,
    /// The protected region.
    pub protect: Region,
}

impl Target {
    /// With one focal region.
    pub fn one(focus: Region, protect: Region) -> Self {
        Self { foci: vec![Focus { region: focus, share: 1.0 }], protect }
    }

    /// Indices of the sites of all focal regions, each once, in the lattice's order: F is the mean over these.
    pub fn focal_sites(&self, lattice: &HexagonalSheet) -> Vec<usize> {
        let (sites, diameter) = (lattice.sites(), lattice.diameter());
        (0..sites.len()).filter(|&i| self.wants(&sites[i], diameter)).collect()
    }

    /// Whether energy is wanted at a site.
    pub fn wants(&self, site: &Site, diameter: f64) -> bool {
        self.foci.iter().any(|focus| focus.region.contains(site, diameter))
    }

    /// First and last row of any focal region.
    pub fn focal_rows(&self) -> [u32; 2] {
        let rows = self.foci.iter().map(|focus| focus.region.rows);
        rows.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or_default()
    }

    /// The focal regions with their names, `focal`, or `focal 1` and so on where there are several.
    pub fn named_foci(&self) -> Vec<(&Region, String)> {
        let name = |k: usize| if self.foci.len() > 1 { format!("focal {}", k + 1) } else { "focal".to_owned() };
        self.foci.iter().enumerate().map(|(k, focus)| (&focus.region, name(k))).collect()
    }

    /// The initial-wave window in seconds, one for all arrangements of a design file:
    ///
    ///   T = (depth of the regions' far edge + 10 rows) / V + 120 µs
    ///
    /// with `slowest_speed` V (m/s), the wave-speed bound of the slowest material present. It ends the run; maxima are
    /// taken over 0..T and energies are those at T. The first term is the passage of the first front, the second leaves
    /// room for the bound not being reached and for the pulse's own length.
    pub fn window(&self, lattice: &HexagonalSheet, slowest_speed: f64) -> f64 {
        let far = self.focal_rows()[1].max(self.protect.rows[1]);
        lattice.depth(f64::from(far + 10)) / slowest_speed + 120e-6
    }
}

/// One region as it is, several as a list.
mod one_or_several {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Focus;

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Foci {
        One(Focus),
        Several(Vec<Focus>),
    }

    pub fn serialize<S: Serializer>(foci: &[Focus], serializer: S) -> Result<S::Ok, S::Error> {
        match foci {
            [one] => one.serialize(serializer),
            several => several.serialize(serializer),
        }
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Focus>, D::Error> {
        Ok(match Foci::deserialize(deserializer)? {
            Foci::One(one) => vec![one],
            Foci::Several(several) => several,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stored results of one focus read as before, and several come back as they went.
    #[test]
    fn one_focus_is_stored_without_a_list() {
        let region = |first: u32, x: f64| Region { rows: [first, first + 2], x: [x, x + 1.0] };
        let one = Target::one(region(3, 0.0), region(9, 4.0));
        let text = serde_json::to_string(&one).unwrap();
        assert_eq!(text, r#"{"focus":{"rows":[3,5],"x":[0.0,1.0]},"protect":{"rows":[9,11],"x":[4.0,5.0]}}"#);
        let focus = |region, share| Focus { region, share };
        let several =
            Target { foci: vec![focus(region(3, 0.0), 0.25), focus(region(5, 2.0), 0.75)], protect: region(9, 4.0) };
        for target in [one, several] {
            let text = serde_json::to_string(&target).unwrap();
            assert_eq!(serde_json::from_str::<Target>(&text).unwrap(), target);
        }
    }

    /// Foci may overlap; a site in both counts once.
    #[test]
    fn sites_of_overlapping_foci_count_once() {
        let lattice = HexagonalSheet::new(1.0, 12, 6.0).unwrap();
        let region = |rows, x| Focus { region: Region { rows, x }, share: 0.5 };
        let target = Target {
            foci: vec![region([3, 5], [0.0, 2.0]), region([4, 6], [1.0, 3.0])],
            protect: Region { rows: [9, 9], x: [0.0, 1.0] },
        };
        let each: Vec<usize> = target.foci.iter().flat_map(|focus| focus.region.sites(&lattice)).collect();
        let mut union = each.clone();
        union.sort_unstable();
        union.dedup();
        assert!(union.len() < each.len());
        assert_eq!(target.focal_sites(&lattice), union);
        assert_eq!(target.focal_rows(), [3, 6]);
    }
}
