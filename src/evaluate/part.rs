//! Which part of a crystal in space is simulated: the half x ≥ 0 that layouts hold or, where all of it is its own image in three planes at 60 degrees, a sixth.
//!
//! Scores, reports and searches know the half alone: what a sixth has felt is laid on all its images there.

use super::load::{Field, ImpactLoad, Imperfection};
use super::{EvaluateError, Plan};
use crate::Context;
use crate::dem::{ContactRecord, Face, Impact, Record, simulate};
use crate::design::SpaceDesign;
use crate::lattice::{Block, BlockSide, Layered, Outline, Sixth};
use crate::layout::Layout;
use crate::sample::Sample;

/// The parts of a crystal between planes of symmetry: any layout is simulated in its half, one with all symmetries of the crystal in a sixth.
pub(super) struct Parts {
    /// Or the whole, where the halves may differ.
    half: Field<3>,
    sixth: Option<(Field<3>, Sixth)>,
}

impl Parts {
    /// Under one load, which is straight and on all of layer 1, and so its own image; the whole alone where `whole` asks for it.
    pub fn new(design: &SpaceDesign, plan: &Plan, load: &ImpactLoad, whole: bool) -> Self {
        let half = Field::in_space(design, plan, load, whole);
        let sixth =
            design.lattice.sixth().filter(|_| !whole).map(|sixth| (of_sixth(&design.lattice, &half, &sixth), sixth));
        Self { half, sixth }
    }

    /// Whether a sixth says all of a layout of the half, built with an imperfection.
    pub fn is_sixth(&self, layout: &[u8], imperfection: &Imperfection) -> bool {
        self.sixth.as_ref().is_some_and(|(field, _)| field.stands_for(layout, imperfection))
    }

    /// The half or the sixth.
    pub fn field(&self, is_sixth: bool) -> &Field<3> {
        match &self.sixth {
            Some((field, _)) if is_sixth => field,
            _ => &self.half,
        }
    }

    /// Whether a sixth says all of a layout as it is drawn.
    fn is_drawn_in_sixth(&self, layout: &Layout<Block>) -> bool {
        self.is_sixth(&layout.materials, &Imperfection::default())
    }

    /// A layout with full records, those of the half.
    pub fn recorded(&self, layout: &Layout<Block>, context: &Context) -> Result<Record<3>, EvaluateError> {
        let is_sixth = self.is_drawn_in_sixth(layout);
        let field = self.field(is_sixth);
        let sample = field.sample(&layout.palette, &layout.materials, &Imperfection::default());
        let record = simulate(&sample, &field.impact, context)?;
        Ok(match &self.sixth {
            Some((field, sixth)) if is_sixth => on_half(field, sixth, record),
            _ => record,
        })
    }
}

/// What has to be simulated of a layout in space for its records, and under what.
pub fn part_in_space(design: &SpaceDesign, plan: &Plan, layout: &Layout<Block>) -> (Sample<3>, Impact) {
    let parts = Parts::new(design, plan, &ImpactLoad::from(design.impact), false);
    let field = parts.field(parts.is_drawn_in_sixth(layout));
    (field.sample(&layout.palette, &layout.materials, &Imperfection::default()), field.impact.clone())
}

/// Every contact of the half, where the records of a layout are those of a sixth: these name a contact once for all of its images.
pub(crate) fn contacts_of_half(
    (design, plan): (&SpaceDesign, &Plan),
    layout: &Layout<Block>,
    context: &Context,
) -> Result<Option<Vec<ContactRecord>>, EvaluateError> {
    let parts = Parts::new(design, plan, &ImpactLoad::from(design.impact), false);
    if !parts.is_drawn_in_sixth(layout) {
        return Ok(None);
    }
    Ok(Some(simulate(&layout.sample_in_space(), &parts.half.impact, context)?.contacts))
}

/// The part of the crystal, a half or a sixth, in which a layout in space is simulated.
pub fn simulated_fraction(layout: &Layout<Block>) -> f64 {
    let is_image = |sixth: Sixth| {
        sixth.images.iter().zip(&layout.materials).all(|((k, _), m)| *m == layout.materials[sixth.sites[*k]])
    };
    if layout.lattice.sixth().is_some_and(is_image) { 1.0 / 6.0 } else { 0.5 }
}

/// Walls around a round or hexagonal crystal: its half's, or all. Each side of a hexagon touches the outermost spheres that lie towards it.
pub(super) fn walls(block: &Block, whole: bool) -> Vec<Face> {
    if block.sides() != [BlockSide::Wall; 2] {
        return Vec::new();
    }
    let radius = 0.5 * block.diameter();
    // The half's spheres and their images.
    let reach = |way: &dyn Fn([f64; 2]) -> f64| {
        let centres =
            block.sites().iter().flat_map(|site| [1.0, -1.0].map(|side| [side * site.centre[0], site.centre[1]]));
        centres.map(way).fold(0.0, f64::max) + radius
    };
    match block.outline() {
        Outline::All => Vec::new(),
        Outline::Disk(_) => vec![Face::Cylinder { radius: reach(&|[x, y]| x.hypot(y)) }],
        Outline::Hexagon(_) => {
            let (side, half) = (0.75_f64.sqrt(), 0.5);
            let beside = [[side, half], [side, -half]];
            let beyond = beside.map(|[x, y]| [-x, y]);
            let ways = [[0.0, 1.0], [0.0, -1.0]].into_iter().chain(beside).chain(beyond.into_iter().filter(|_| whole));
            let wall =
                |[a, b]: [f64; 2]| Face::Plane { normal: [-a, -b, 0.0], position: -reach(&|[x, y]| a * x + b * y) };
            ways.map(wall).collect()
        }
    }
}

/// The sixth of a half.
fn of_sixth(block: &Block, half: &Field<3>, sixth: &Sixth) -> Field<3> {
    let normal = Sixth::normal();
    let mut impact = half.impact.clone();
    // A wall on the other side of the plane is the image of one on this.
    impact.faces.retain(|face| match face {
        Face::Plane { normal: [a, b, _], .. } => *a < 1e-9 && a * normal[0] + b * normal[1] < 1e-9,
        Face::Cylinder { .. } => true,
    });
    impact.faces.insert(0, Face::Plane { normal, position: 0.0 });
    let within = |layer: u32| {
        let range = block.layer(layer);
        (0..sixth.sites.len()).filter(|&k| range.contains(&sixth.sites[k])).collect()
    };
    (impact.struck, impact.exit) = (within(1), within(block.layers()));
    let strike = impact.strike().of_part(1.0 / 3.0);
    Field {
        impact: impact.struck_by(strike),
        friction: None,
        spheres: sixth.sites.iter().map(|&i| half.spheres[i]).collect(),
        radii: half.radii.clone(),
        images: sixth.images.iter().map(|&(k, _)| [k, k]).collect(),
        share: 3.0,
    }
}

/// What the half feels, where a sixth has felt this. Contacts that are images of each other stay one, of the weight of all.
fn on_half(field: &Field<3>, sixth: &Sixth, record: Record<3>) -> Record<3> {
    fn laid<T: Copy>(sixth: &Sixth, values: &[T]) -> Vec<T> {
        sixth.images.iter().map(|&(k, _)| values[k]).collect()
    }
    let turned = |vectors: &[[f64; 3]]| -> Vec<[f64; 3]> {
        let turn = |(k, [to_x, to_y]): &(usize, [[f64; 2]; 2])| {
            let [x, y, z] = vectors[*k];
            [to_x[0] * x + to_x[1] * y, to_y[0] * x + to_y[1] * y, z]
        };
        sixth.images.iter().map(turn).collect()
    };
    let share = field.share;
    Record {
        max_kinetic: laid(sixth, &record.max_kinetic),
        max_net_force: laid(sixth, &record.max_net_force),
        max_contact_force: laid(sixth, &record.max_contact_force),
        arrival: laid(sixth, &record.arrival),
        dissipated: laid(sixth, &record.dissipated),
        contacts: record
            .contacts
            .into_iter()
            .map(|contact| ContactRecord {
                spheres: contact.spheres.map(|k| sixth.sites[k]),
                weight: share * contact.weight,
                ..contact
            })
            .collect(),
        ledger: record.ledger.times(share),
        exit_momentum: share * record.exit_momentum,
        exit_force: share * record.exit_force,
        projectile: record.projectile,
        displacement: turned(&record.displacement),
        velocity: turned(&record.velocity),
        steps: record.steps,
        stop: record.stop.map(|stop| field.named(stop)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::{Ledger, Stop, Strike};
    use crate::evaluate::{Evaluator, Forces, Overrides, SpaceComparison, compare_in_space, evaluate_in_space};

    const ROUND: &str = r#"format = 1
name = "small-round"
[crystal]
packing = "hcp"
diameter = "6.35 mm"
layers = 9
cells = [10, 6]
axis_layer = 2
outline = "round"
sides = "wall"
host = "stainless-440c"
law = "thesis"
[impact]
kind = "force-pulse"
force = "8 kN"
duration = "20 us"
[target]
focus = { layers = [7, 8], r = ["0 D", "1.1 D"] }
# No symmetry is asked of regions.
protect = { layers = [7, 8], x = ["2 D", "4 D"], y = ["-3 D", "1 D"] }
[lens]
family = "plano-convex"
material = "brass-260"
apex_layer = 2
back_layer = 5
radius = "5.5 D"
max_interface_angle = "75 deg"
[run]
window = "70 us"
"#;

    /// The designs: HCP and FCC, round and hexagonal, free and between walls, under a pulse and a projectile.
    fn designs() -> Vec<SpaceDesign> {
        let pulse = "kind = \"force-pulse\"\nforce = \"8 kN\"\nduration = \"20 us\"";
        let flat = "kind = \"projectile\"\nmass = \"300 g\"\nspeed = \"10 m/s\"";
        [
            ROUND.to_owned(),
            ROUND.replace("\"round\"", "\"hexagon\"").replace("\"hcp\"", "\"fcc-111\""),
            ROUND.replace("\"wall\"", "\"free\"").replace("\"hcp\"", "\"fcc-111\""),
            ROUND.replace("\"round\"", "\"hexagon\"").replace(pulse, flat),
        ]
        .map(|text| SpaceDesign::parse_in_space("round.toml", &text).unwrap())
        .to_vec()
    }

    fn close(a: f64, b: f64, floor: f64) -> bool {
        (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(floor)
    }

    /// Laid on the half, the record of a sixth is that of the half, every number of it, to rounding and its growth.
    #[test]
    fn a_sixth_says_all_that_the_half_does() {
        for design in designs() {
            let (body, materials) = design.propose_in_space().unwrap();
            assert!(body.apex_row == 2 && materials.iter().any(|&m| m != 0));
            let request = design.lens.as_ref().unwrap();
            let layout =
                Layout { lattice: design.lattice.clone(), palette: design.palette_of_lens(request), materials };
            let plan = Plan::in_space(&design, Overrides::default(), &layout.palette).unwrap();
            let parts = Parts::new(&design, &plan, &ImpactLoad::from(design.impact), false);
            let (context, drawn) = (Context::default(), Imperfection::default());
            assert!(parts.is_sixth(&layout.materials, &drawn) && simulated_fraction(&layout) < 0.2);
            let half = simulate(&layout.sample_in_space(), &parts.half.impact, &context).unwrap();
            let laid = parts.recorded(&layout, &context).unwrap();
            assert!(half.stop.is_none() && laid.stop.is_none(), "{:?}", laid.stop);
            let most = half.max_kinetic.iter().copied().fold(0.0, f64::max);
            let fastest = half.velocity.iter().flatten().fold(0.0, |most: f64, v| v.abs().max(most));
            let furthest = half.displacement.iter().flatten().fold(0.0, |most: f64, u| u.abs().max(most));
            for i in 0..layout.materials.len() {
                assert!(close(laid.max_kinetic[i], half.max_kinetic[i], 1e-3 * most), "{i}");
                assert!(close(laid.max_net_force[i], half.max_net_force[i], 1.0), "{i}");
                assert!(close(laid.max_contact_force[i], half.max_contact_force[i], 1.0), "{i}");
                assert!(close(laid.dissipated[i], half.dissipated[i], 1e-3 * most), "{i}");
                match (laid.arrival[i], half.arrival[i]) {
                    (Some(ours), Some(theirs)) => assert!((ours - theirs).abs() < 1e-12, "{i}"),
                    (ours, theirs) => assert_eq!(ours, theirs, "{i}"),
                }
                for k in 0..3 {
                    assert!(close(laid.velocity[i][k], half.velocity[i][k], fastest), "{i} {k}");
                    assert!(close(laid.displacement[i][k], half.displacement[i][k], furthest), "{i} {k}");
                }
            }
            let of = |record: &Record<3>| {
                let Ledger { work_in, kinetic, stored, dissipated, estimate } = record.ledger;
                let weight: f64 = record.contacts.iter().map(|contact| contact.weight).sum();
                let greatest = record.contacts.iter().map(|contact| contact.overlap_max).fold(0.0, f64::max);
                let [way, speed] = record.projectile.unwrap_or_default();
                [
                    [work_in, kinetic, stored, dissipated, estimate, weight],
                    [record.exit_momentum, record.exit_force, greatest, way, speed, record.steps as f64],
                ]
                .concat()
            };
            for (k, (ours, theirs)) in of(&laid).into_iter().zip(of(&half)).enumerate() {
                assert!(close(ours, theirs, 0.0), "{k}: {ours} {theirs}");
            }
        }
    }

    /// A layout is simulated in the same part, to the same bits, alone, in a comparison and by a search, whatever stands beside it; where one sphere breaks
    /// the symmetry it is the half.
    #[test]
    fn all_ways_simulate_a_layout_in_the_same_part() {
        let design = SpaceDesign { seeds: 1, ..designs().remove(0) };
        let (body, materials) = design.propose_in_space().unwrap();
        let request = design.lens.as_ref().unwrap();
        let context = Context::default();
        let comparison = SpaceComparison::of_lens(&design, (&body, request, materials), Overrides::default()).unwrap();
        let comparison = comparison.over(Forces::ONE);
        let plan = comparison.plan.clone();
        let outcome = compare_in_space(&comparison, &context).unwrap();
        let fraction = |kind: &str| {
            let all = outcome.arrangements.iter().filter(|a| a.kind.starts_with(kind));
            all.map(|a| a.simulated_fraction.unwrap()).collect::<Vec<_>>()
        };
        for kind in ["lens", "all-host", "all-lens", "strip", "flat-height"] {
            assert!(fraction(kind).iter().all(|&part| part == 1.0 / 6.0), "{kind}");
        }
        assert!(fraction("random").iter().all(|&part| part == 0.5) && !fraction("random").is_empty());

        let mut broken = comparison.subject.clone();
        let off_axis = broken.lattice.sites().iter().position(|site| site.layer == 4 && site.centre[0] > 1e-3).unwrap();
        broken.materials[off_axis] = 1 - broken.materials[off_axis];
        let layouts = [comparison.subject.clone(), broken.clone(), comparison.subject.clone(), broken];
        let alone =
            layouts.each_ref().map(|layout| evaluate_in_space(&design, layout, &plan, &context).unwrap().scores);
        let own: Vec<Strike> = vec![design.impact];
        let palette = comparison.subject.palette.clone();
        let evaluator = Evaluator::new(&design, &own, palette, Overrides::default(), &context).unwrap();
        let asked: Vec<Vec<u8>> = layouts.iter().map(|layout| layout.materials.clone()).collect();
        let found = evaluator.scores(&asked, &context).unwrap();
        for (k, layout) in layouts.iter().enumerate() {
            assert_eq!(simulated_fraction(layout), if k % 2 == 0 { 1.0 / 6.0 } else { 0.5 });
            let scores = &found[k][0].scores;
            assert_eq!(
                (alone[k].focal_mean, alone[k].protected_mean),
                (scores.focal_mean, scores.protected_mean),
                "layout {k}"
            );
        }
        let compared = &outcome.arrangements[0].scores;
        assert_eq!((compared.focal_mean, compared.protected_mean), (alone[0].focal_mean, alone[0].protected_mean));
        // A limit ends a sixth by the same sum.
        let most = vec![vec![0.5 * alone[0].protected_mean], vec![2.0 * alone[1].protected_mean]];
        let within = evaluator.scores_within(&asked[..2], &most, &context).unwrap();
        assert!(matches!(within[0][0].stop, Some(Stop::Beyond { .. })) && within[1][0].stop.is_none());
    }
}
