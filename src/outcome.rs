//! One stored, serialisable result: what was asked, what was proposed, what every arrangement did, and how to repeat it.
//!
//! Everything in SI; energies of the simulated half, with weight 1/2 for spheres on mirror lines. Reports are drawn from
//! this alone.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

mod begun;
mod inside;
mod traced;

pub use begun::Begun;
pub use inside::{Inside, PartOfNetwork, Touch};
pub use traced::{Front, SpotDiagram, Traced, TracedDecay, TracedFocus, TracedRay, TracedSpot};

use crate::dem::Stop;
use crate::lattice::{Block, CrystalSite, Site};
use crate::layout::Bill;
use crate::lens::{Prescription, Symmetry};
pub use crate::score::Scores;
use crate::score::{Better, Measure, Spreads};
use crate::target::{Region, SpaceRegion, Target};

/// Format number of every JSON file of results.
pub const FORMAT: u32 = 1;

/// Version of granulens.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The commit that it was built from: of the working copy, or of the one that a published package was made from; `unknown` where there
/// is neither.
pub const COMMIT: &str = env!("GRANULENS_COMMIT");

/// With what, and how, numbers were made: part of every file of results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Method {
    /// Version of granulens.
    pub version: String,
    /// The commit that it was built from.
    #[serde(default = "unknown")]
    pub commit: String,
    /// Contact law; `several` where pairs have laws of their own.
    #[serde(default)]
    pub law: String,
    /// Set of fitted constants, where the law has one.
    #[serde(default)]
    pub constants: Option<String>,
    /// Integrator.
    #[serde(default)]
    pub integrator: String,
    /// Step (s).
    pub step_s: f64,
    /// Why this step.
    #[serde(default)]
    pub step_reason: String,
    /// Window (s).
    pub window_s: f64,
    /// Why this window.
    #[serde(default)]
    pub window_reason: String,
}

fn unknown() -> String {
    "unknown".to_owned()
}

impl Method {
    /// In a line, as every command that simulates prints it.
    pub fn words(&self) -> String {
        use crate::units::Dimension::Time;
        let constants = self.constants.as_ref().map_or(String::new(), |constants| format!(", constants {constants}"));
        format!(
            "law {}{constants}; {}, step {} ({}), window {} ({})",
            self.law,
            self.integrator,
            Time.show(self.step_s),
            self.step_reason,
            Time.show(self.window_s),
            self.window_reason
        )
    }
}

/// The result of `run` and `compare`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome<S = Site, R = Region, P = Proposal> {
    /// Format number of this structure.
    pub format: u32,
    /// What is needed to repeat the run.
    pub manifest: Manifest,
    /// The crystal's sites, in the order of all per-site lists.
    pub sites: Vec<S>,
    /// Sphere diameter (m).
    #[serde(rename = "diameter_m")]
    pub diameter: f64,
    /// Distance from the axis to the far mirror line (m).
    #[serde(rename = "half_width_m")]
    pub half_width: f64,
    /// Where energy is wanted and where it is not.
    pub target: Target<R>,
    /// Names of the materials that per-site lists count, the host first.
    pub materials: Vec<String>,
    /// What flat strips, random mixtures and the uniform crystal that Q refers to are made of: the design says it, whatever layout is
    /// judged. None where it does not.
    #[serde(default)]
    pub reference: Option<String>,
    /// Whether design and lens are those of Burgoyne (2016, section 5.3.3), of which published claims can be judged.
    #[serde(default)]
    pub is_published: bool,
    /// The forces (N) that the verdict is judged over.
    #[serde(default, rename = "forces_N")]
    pub forces: Vec<f64>,
    /// The speeds (m/s), where a projectile strikes.
    #[serde(default, rename = "speeds_m_s", skip_serializing_if = "Vec::is_empty")]
    pub speeds: Vec<f64>,
    /// The first arrangement against the best flat, uniform and random one.
    #[serde(default)]
    pub verdict: Vec<Verdict>,
    /// What ray tracing proposed, where the lens came from it.
    pub proposal: Option<P>,
    /// The lens first, then its baselines.
    pub arrangements: Vec<ArrangementOutcome>,
    /// What exchanging single spheres of the first does, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub swaps: Option<crate::evaluate::Swaps>,
    /// How F and P change with every sphere of the first, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivities: Option<Vec<crate::evaluate::Derivatives>>,
    /// What goes on inside the first, where that was looked at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inside: Option<Inside>,
    /// What a reader should know before trusting the numbers.
    pub warnings: Vec<String>,
}

/// The result in space.
pub type SpaceOutcome = Outcome<SpaceSite, SpaceRegion, SpaceProposal>;

/// A site of a crystal in space.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpaceSite {
    /// Layer, from 1 (struck) on.
    pub layer: u32,
    /// Place within the layer of the half, from 1 on, in order of y, then x.
    pub column: u32,
    /// Distance from the plane of symmetry (m).
    pub x: f64,
    /// From the axis (m).
    pub y: f64,
    /// Depth below layer 1 (m).
    pub z: f64,
    /// Spheres of the whole crystal that stand for it.
    pub copies: u8,
}

impl SpaceSite {
    /// Those of a block's half, in its order.
    pub fn all(block: &Block) -> Vec<Self> {
        let site = |(site, &copies): (&CrystalSite<3>, &u8)| {
            let [x, y, z] = site.centre;
            Self { layer: site.layer, column: site.column, x, y, z, copies }
        };
        block.sites().iter().zip(block.copies()).map(site).collect()
    }
}

/// What ray tracing proposed in space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpaceProposal {
    /// Family of the lens.
    pub family: String,
    /// How it goes on out of its section.
    pub symmetry: Symmetry,
    /// Wave-speed bound of the host in a close packing (m/s).
    #[serde(rename = "host_speed_m_s")]
    pub host_speed: f64,
    /// Wave-speed bound of the lens material (m/s).
    #[serde(rename = "lens_speed_m_s")]
    pub lens_speed: f64,
    /// First layer.
    pub apex_layer: u32,
    /// Last layer.
    pub back_layer: u32,
    /// Radius of the curved face (m), or what the family has in its place.
    #[serde(rename = "radius_m")]
    pub radius: Option<f64>,
    /// The family's own parameters by name, lengths in m and with `_m` at the end.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, f64>,
    /// Greatest angle of a face against the layers (rad).
    #[serde(rename = "steepest_rad")]
    pub steepest: f64,
    /// Fraction of what is struck that rays send through the focal region at its mid depth.
    pub fraction: f64,
    /// The same fraction without a lens.
    pub fraction_without: f64,
    /// Fraction whose rays pass the protected region, with the lens and without.
    pub protected: [f64; 2],
    /// Names of the materials that `piece` counts: host, lens, then others.
    pub materials: Vec<String>,
    /// The whole crystal.
    pub piece: Bill,
    /// The faces of the section as polylines (m): distance from the axis, or from the plane of symmetry, and depth.
    #[serde(rename = "faces_m")]
    pub faces: Vec<Vec<[f64; 2]>>,
}

/// What is needed to repeat a run, and when and with what it was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Format number of this structure.
    pub format: u32,
    /// Name of the design.
    pub name: String,
    /// With what, and how.
    #[serde(flatten)]
    pub method: Method,
    /// The design file as it was read.
    pub design_file: String,
    /// Its text.
    pub design: String,
    /// The command that gives the same numbers, where one was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// What strikes the crystal, in words: `26 kN for 20 us on every sphere of row 1`.
    pub impact: String,
    /// First random seed and number of seeds.
    pub seeds: [u64; 2],
    /// Threads used; results do not depend on it.
    pub threads: usize,
    /// When the run began, seconds since 1970.
    pub started_unix_s: u64,
    /// Wall time of the simulations (s).
    pub seconds: f64,
}

/// What ray tracing proposed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Proposal {
    /// Wave-speed bound of the host (m/s).
    #[serde(rename = "host_speed_m_s")]
    pub host_speed: f64,
    /// Wave-speed bound of the lens material (m/s).
    #[serde(rename = "lens_speed_m_s")]
    pub lens_speed: f64,
    /// Host over lens.
    pub speed_ratio: f64,
    /// Critical angle of total reflection where the wave passes from the slower to the faster material (rad).
    #[serde(rename = "critical_angle_rad")]
    pub critical_angle: Option<f64>,
    /// Force on a contact of the struck row over F_p of the host.
    pub amplitude_host: f64,
    /// The same over F_p of the lens material.
    pub amplitude_lens: f64,
    /// Whether the impact is strong enough for the bound, in words.
    pub validity: String,
    /// Family of the lens.
    pub family: String,
    /// Where the lens lies and how it is shaped.
    #[serde(flatten)]
    pub prescription: Prescription,
    /// Fraction of the struck width that rays send through the focal region at its mid depth.
    pub fraction: f64,
    /// The same fraction without a lens.
    pub fraction_without: f64,
    /// Depths (m) at which the innermost and the outermost ray cross the axis, where they do.
    #[serde(rename = "crossing_m")]
    pub crossing: [Option<f64>; 2],
    /// Fraction of the struck width whose rays pass the protected region, with the lens and without.
    pub protected: [f64; 2],
    /// Names of the materials that `piece` and `half` count: host, lens, then others.
    #[serde(default)]
    pub materials: Vec<String>,
    /// The piece to be built, both halves.
    #[serde(default)]
    pub piece: Bill,
    /// The simulated half.
    #[serde(default)]
    pub half: Bill,
    /// Earliest and latest time (s) at which rays come to the middle row of the focal region within it.
    #[serde(rename = "arrival_s")]
    pub arrival: Option<[f64; 2]>,
    /// How many times more rays pass the focal region, less what faces reflect; none for a region of no width.
    pub predicted_gain: Option<f64>,
    /// The parts of a lens for several focal regions, in order across the crystal; empty with a single one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartProposal>,
    /// What rays bring to each of several focal regions, in the order of the target; empty with a single one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub foci: Vec<FocusProposal>,
    /// Spot diagrams, one for each focal region, where a report is to draw them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spots: Vec<SpotDiagram>,
    /// What to know before trusting the rays.
    pub warnings: Vec<String>,
    /// The faces as polylines (x, z) (m), x >= 0.
    #[serde(rename = "faces_m")]
    pub faces: Vec<Vec<[f64; 2]>>,
    /// A few rays as polylines (x, z) (m), to be drawn; they run to the end of the crystal.
    #[serde(rename = "rays_m")]
    pub rays: Vec<Vec<[f64; 2]>>,
}

/// A part of a lens that is split among several focal regions: data of first order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartProposal {
    /// The focal regions that it is for, counted from 1: several only where they are the same.
    pub foci: Vec<usize>,
    /// The strip of the struck width that it takes (m).
    #[serde(rename = "window_m")]
    pub window: [f64; 2],
    /// Where it lies and how it is shaped.
    #[serde(flatten)]
    pub prescription: Prescription,
    /// Fraction of its strip's rays that come to its focus, and the same without a lens.
    pub fraction: [f64; 2],
}

/// What rays bring to one of several focal regions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FocusProposal {
    /// Its share of the blow, as asked for.
    pub share: f64,
    /// Fraction of the struck width that passes it at its mid depth, and the same without a lens.
    pub fraction: [f64; 2],
    /// Earliest and latest time (s) at which rays come to its middle row within it.
    #[serde(rename = "arrival_s")]
    pub arrival: Option<[f64; 2]>,
    /// How many times more rays pass it than without a lens, less what faces reflect.
    pub predicted_gain: Option<f64>,
}

/// What one arrangement did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArrangementOutcome {
    /// Short unique name: `lens`, `flat-height`, `random-behind-3`.
    pub name: String,
    /// The name without the seed.
    pub kind: String,
    /// Random seed, where there is one.
    pub seed: Option<u64>,
    /// The numbers, at the design's own force.
    pub scores: Scores,
    /// C, G, Q, F and P over the forces of the verdict, and how they scatter.
    #[serde(default)]
    pub over_forces: Option<Spreads>,
    /// How it was simulated, where that is not as the manifest says: integrator and step (s) of a run that had to find its contacts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulated: Option<(String, f64)>,
    /// In space the part of the crystal that was simulated: 1/2, or 1/6 where layout and crystal have three planes of symmetry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulated_fraction: Option<f64>,
    /// For each site an index into the outcome's materials; of a piece whose halves differ then for each site's image.
    pub layout: Vec<u8>,
    /// What each sphere felt, in the order of `layout`.
    pub record: SphereRecord,
    /// Why the run is not to be trusted, if so: which guard stopped it.
    pub stop: Option<Stop>,
}

/// What each sphere felt, in the order of its arrangement's layout.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SphereRecord {
    /// Greatest kinetic energy (J).
    pub max_kinetic: Vec<f64>,
    /// Greatest net contact force (N).
    pub max_net_force: Vec<f64>,
    /// Greatest force on one of its contacts (N).
    pub max_contact_force: Vec<f64>,
    /// Time at which the speed first reached 1 % of its own maximum (s); none if the sphere never moved.
    pub arrival: Vec<Option<f64>>,
    /// Half of the loss of each of its contacts, those with mirror images included (J); of a sphere on a mirror line, the
    /// whole sphere's.
    pub dissipated: Vec<f64>,
}

/// The result of `check`: one layout by itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checked {
    /// Format number of this structure.
    pub format: u32,
    /// Name of the design.
    pub design: String,
    /// The layout file.
    pub layout: String,
    /// The numbers; energies at the end of the run.
    #[serde(flatten)]
    pub scores: Scores,
    /// What is not at the design's own force alone: the scores over several forces, and how they scatter.
    #[serde(flatten)]
    pub over_forces: Spreads,
    /// The forces (N) that these are over; empty where only the design's own was asked for.
    #[serde(default, rename = "forces_N", skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<f64>,
    /// The speeds (m/s), where a projectile strikes.
    #[serde(default, rename = "speeds_m_s", skip_serializing_if = "Vec::is_empty")]
    pub speeds: Vec<f64>,
    /// Names of the materials that `piece` and `half` count, the host first.
    pub materials: Vec<String>,
    /// What Q refers to: see [`Outcome::reference`].
    pub reference: Option<String>,
    /// The piece to be built, both halves.
    pub piece: Bill,
    /// The simulated half.
    pub half: Option<Bill>,
    /// With what, and how.
    #[serde(flatten)]
    pub method: Method,
    /// In space the part of the crystal that was simulated: 1/2, or 1/6 where layout and crystal have three planes of symmetry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulated_fraction: Option<f64>,
    /// Accepted steps.
    pub steps: u64,
    /// Wall time (s).
    pub seconds: f64,
    /// What the design's thresholds ask for, and whether it is so.
    #[serde(default)]
    pub thresholds: Vec<Asked>,
    /// What a reader should know before trusting the numbers.
    pub warnings: Vec<String>,
    /// The scores under other laws, where they were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laws: Option<crate::evaluate::OverLaws>,
    /// The gate before building, where it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gate: Option<crate::gate::Gate>,
    /// Which guard stopped the run, if one did.
    pub stop: Option<Stop>,
}

/// A threshold of the design file, as met or missed by a layout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// Name of the measure.
    pub measure: String,
    /// The least value that passes, in SI.
    pub min: Option<f64>,
    /// The greatest value that passes.
    pub max: Option<f64>,
    /// The value; none where it has none.
    pub value: Option<f64>,
    /// Whether it is met.
    pub met: bool,
}

/// The first arrangement against the best of a kind of arrangements, in one measure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Name of the measure.
    pub measure: String,
    /// `flat`, `uniform` or `random`.
    pub against: String,
    /// The best of these by name; of random ones the kind whose mean over seeds is best.
    pub arrangement: String,
    /// The score of the first arrangement, over the forces.
    pub value: f64,
    /// The score of the other, over the forces and, of random ones, the seeds.
    pub best: f64,
    /// Standard deviation of the difference over the forces, of random ones over the seeds too; none with one force.
    pub spread: Option<f64>,
    /// Which of the two is better.
    pub word: Word,
}

/// What a verdict comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Word {
    /// Better by more than two standard deviations.
    Better,
    /// Within two standard deviations.
    Equal,
    /// Worse by more than two standard deviations.
    Worse,
    /// Within 4 %, and one force does not say how much that is.
    Undecided,
}

/// The part by which scores under a single force have to differ to tell more than the force's chance: twice what scores of one layout
/// scatter by, and a little.
const DECIDED: f64 = 0.04;

impl Word {
    /// Of a score against another, with the standard deviation of their difference; none with one force.
    pub fn of(measure: Measure, value: f64, other: f64, spread: Option<f64>) -> Self {
        let (near, unclear) = match spread {
            Some(spread) => ((value - other).abs() <= 2.0 * spread, Self::Equal),
            None => ((value - other).abs() <= DECIDED * other.abs(), Self::Undecided),
        };
        match measure.better() {
            _ if near => unclear,
            Better::Smaller if value < other => Self::Better,
            Better::Greater if value > other => Self::Better,
            _ => Self::Worse,
        }
    }

    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Better => "better",
            Self::Equal => "equal",
            Self::Worse => "worse",
            Self::Undecided => "undecided",
        }
    }
}
