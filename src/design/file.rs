//! The design file as written: which keys there are and where each value stands, nothing about their meaning.
//!
//! Every key is optional here and every value may be anything, so that what is missing or of the wrong type is reported
//! by the check, in the same words as everything else. Only unknown keys and values in the place of sections are found here.

use std::collections::BTreeMap;

use toml::Spanned;

use super::prices::PricesFile;
use super::threshold::THRESHOLDS;
use crate::document::{OneOrSeveral, OwnMaterials, Section, Written, joined, section};

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DesignFile {
    #[expect(dead_code, reason = "the format has been read before all else; here it only is a known key")]
    pub format: Written,
    pub name: Written,
    pub crystal: Section<CrystalFile>,
    pub impact: Section<ImpactFile>,
    pub target: Section<TargetFile>,
    pub lens: Section<LensFile>,
    pub run: Section<RunFile>,
    pub compare: Section<CompareFile>,
    pub thresholds: Section<ThresholdsFile>,
    pub materials: Section<OwnMaterials>,
    pub prices: Section<PricesFile>,
}

section!(CrystalFile: Written {
    packing, diameter, diameters, rows, half_width, layers, cells, axis_layer, outline, sides, host, law, constants, friction,
    hardness, unlike_hardness, spring_back, spring_back_growth, restitution, hardening
});
section!(ImpactFile: Written { kind, force, duration, mass, speed });

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TargetFile {
    pub focus: OneOrSeveral<FocusFile>,
    pub protect: Section<RegionFile>,
}

section!(FocusFile: Written { rows, layers, x, y, r, centre, radius, share });
section!(RegionFile: Written { rows, layers, x, y, r, centre, radius });
section!(LensFile: Written {
    family, material, others, apex_row, back_row, apex_layer, back_layer, radius, parameters, max_interface_angle, rows, layers, axis, stages, raster,
    seed, symmetry
});
section!(RunFile: Written { integrator, step, accuracy, window });
section!(CompareFile: Written { seeds, first_seed, material });
/// Bounds by the name of the measure, as written.
pub(crate) type ThresholdsFile = BTreeMap<Spanned<String>, Section<BoundsFile>>;
section!(BoundsFile: Written { min, max });

/// How each key is written, for messages.
pub(crate) const EXAMPLES: &[&str] = &joined::<{ OWN.len() + THRESHOLDS.len() }>(OWN, THRESHOLDS);

const OWN: &[&str] = &[
    "format = 1",
    "name = \"thesis-lens\"",
    "crystal.packing = \"hexagonal-2d\"",
    "crystal.diameter = \"6.35 mm\"",
    "crystal.diameters = [\"6.35 mm\", \"5.5 mm\"]",
    "crystal.rows = 50",
    "crystal.half_width = 16.5",
    "crystal.layers = 24",
    "crystal.cells = [14, 8]",
    "crystal.outline = \"round\"",
    "crystal.axis_layer = 4",
    "crystal.sides = \"mirror\"",
    "crystal.host = \"stainless-440c\"",
    "crystal.law = \"consistent\"",
    "crystal.constants = \"code\"",
    "crystal.friction = 0.2",
    "crystal.hardness = 2.8",
    "crystal.unlike_hardness = 1.2",
    "crystal.spring_back = 5",
    "crystal.spring_back_growth = 0",
    "crystal.restitution = 0.9",
    "crystal.hardening = 0.1",
    "impact.kind = \"force-pulse\"",
    "impact.force = \"26 kN\"",
    "impact.duration = \"20 us\"",
    "impact.mass = \"500 g\"",
    "impact.speed = \"20 m/s\"",
    "target.focus = { rows = [30, 34], x = [\"0 D\", \"2.5 D\"] }",
    "target.focus.rows = [30, 34]",
    "target.focus.x = [\"0 D\", \"2.5 D\"]",
    "target.focus.layers = [15, 17]",
    "target.focus.y = [\"-2 D\", \"2 D\"]",
    "target.focus.r = [\"0 D\", \"1.5 D\"]",
    "target.focus.centre = [\"0 D\", \"0 D\", \"12.25 D\"]",
    "target.focus.radius = \"1.5 D\"",
    "target.focus.share = 0.5",
    "target.protect = { rows = [30, 34], x = [\"12 D\", \"16.5 D\"] }",
    "target.protect.rows = [30, 34]",
    "target.protect.x = [\"12 D\", \"16.5 D\"]",
    "target.protect.layers = [15, 17]",
    "target.protect.y = [\"4 D\", \"6 D\"]",
    "target.protect.r = [\"5 D\", \"7 D\"]",
    "target.protect.centre = [\"6 D\", \"0 D\", \"12.25 D\"]",
    "target.protect.radius = \"1.5 D\"",
    "lens.family = \"plano-convex\"",
    "lens.material = \"brass-260\"",
    "lens.apex_row = 5",
    "lens.back_row = 16",
    "lens.apex_layer = 4",
    "lens.back_layer = 10",
    "lens.radius = \"19 D\"",
    "lens.max_interface_angle = \"60 deg\"",
    "lens.rows = [2, 29]",
    "lens.layers = [2, 14]",
    "lens.others = [\"aluminium-2017\"]",
    "lens.axis = \"8 D\"",
    "lens.stages = 2",
    "lens.parameters = { conic = -0.5, sag_4 = \"0.2 D\" }",
    "lens.raster = \"nearest\"",
    "lens.seed = 1",
    "lens.symmetry = \"plane\"",
    "run.integrator = \"verlet\"",
    "run.step = \"1e-7 s\"",
    "run.accuracy = \"0.1 %\"",
    "run.window = \"350 us\"",
    "compare.seeds = 5",
    "compare.first_seed = 1",
    "compare.material = \"brass-260\"",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{assert_examples, example};

    /// Messages rely on it.
    #[test]
    fn every_key_has_an_example_that_is_toml() {
        let sections = [
            ("crystal", CrystalFile::KEYS),
            ("impact", ImpactFile::KEYS),
            ("target", &["focus", "protect"]),
            ("target.focus", FocusFile::KEYS),
            ("target.protect", RegionFile::KEYS),
            ("lens", LensFile::KEYS),
            ("run", RunFile::KEYS),
            ("compare", CompareFile::KEYS),
            ("thresholds.residual", BoundsFile::KEYS),
        ];
        assert_examples(EXAMPLES, &sections);
        assert_eq!(example(EXAMPLES, "format").as_deref(), Some("format = 1"));
    }
}
