//! `granulens check`: simulate a layout under a design's impact.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use granulens::dem::Stop;
use granulens::design::{AnyDesign, SpaceDesign, Threshold};
use granulens::evaluate::{
    Beside, Drawing, Evaluation, Forces, OverLawsError, Plan, Subject, beside_uniform, impact, method, parted, unnamed,
};
use granulens::gate::{Asked, Gate, GateError, Seen, Word, gate};
use granulens::material::Material;
use granulens::outcome::{self, Checked, FORMAT};
use granulens::report::strengths;
use granulens::score::{Measure, Scores};
use granulens::tolerance::{MOST_SAMPLES, Tolerances};
use granulens::units::Dimension::{self, Energy, Mass};

use super::compare::read_piece;
use super::console::{context, emit, emit_json, note};
use super::cost::{Part, arrangement, tell};
use super::failure::Failure;
use super::folder::{probe_all, write_file, write_json};
use super::over_laws::UnderLaws;
use super::{Band, Common, Motion};

/// Simulate a layout file, proposed or edited by hand, under a design's impact
///
/// With --out, the numbers are written as JSON too.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("gates").args(["gate", "strict"]).multiple(true))]
pub struct Check {
    /// Layout, CSV with the header row,column,x,z,diameter,material or, in space, layer,column,x,y,z,diameter,material
    layout: PathBuf,
    /// Design file: everything but the materials
    #[arg(long, value_name = "FILE")]
    design: PathBuf,
    #[command(flatten)]
    motion: Motion,
    #[command(flatten)]
    under: UnderLaws,
    #[command(flatten)]
    forces: Band,
    /// Write what each sphere felt as CSV
    #[arg(long, value_name = "FILE")]
    spheres: Option<PathBuf>,
    /// The gate before building: lines of pass, warn and fail, each with its number, its limit and why it matters
    #[arg(long)]
    gate: bool,
    /// Exit with 3 where a threshold of the design file is not met or another line of the gate fails; implies --gate
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    gated: Gated,
}

/// What the gate is asked besides.
#[derive(clap::Args)]
struct Gated {
    /// Inner width of the frame that there is; the gate tells whether the piece goes in
    #[arg(long, value_name = "LENGTH", requires = "gates", allow_hyphen_values = true, value_parser = super::length)]
    frame_width: Option<f64>,
    /// Depth of the frame that there is, from the centres of row 1 to the end wall
    #[arg(long, value_name = "LENGTH", requires = "gates", allow_hyphen_values = true, value_parser = super::length)]
    frame_depth: Option<f64>,
    /// The gate fails where a smaller share of pieces keeps the thresholds as built, such as "90 %"
    #[arg(long = "yield", value_name = "PERCENT", requires = "gates", value_parser = super::fraction)]
    least_yield: Option<f64>,
    /// What may turn out otherwise, for --yield; without it as for granulens tolerance
    #[arg(long, value_name = "FILE", requires = "least_yield")]
    tolerances: Option<PathBuf>,
    /// Pieces to make for --yield [default: 200]
    #[arg(long, value_name = "N", requires = "least_yield")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=u64::from(MOST_SAMPLES)))]
    samples: Option<u64>,
}

/// Where several forces are asked for and one of the runs has no score.
pub(super) const STOPPED_BESIDE: &str = "FAILED: a guard stopped a run under one of the forces";

/// Pieces by which the gate judges: a share near 92 % is then known to 4 %.
const PIECES: u64 = 200;

impl Gated {
    fn asked(&self, drawing: Drawing<'_>, common: &Common) -> Result<Asked, Failure> {
        let frame = [self.frame_width, self.frame_depth];
        let Some(least) = self.least_yield else { return Ok(Asked { frame, least_yield: None }) };
        let tolerances = match &self.tolerances {
            Some(path) => Tolerances::read(path, drawing)?,
            None => Tolerances::usual(),
        };
        let seed = common.seed.or(tolerances.seed).unwrap_or(1);
        Ok(Asked { frame, least_yield: Some((least, tolerances, self.samples.unwrap_or(PIECES), seed)) })
    }
}

impl Check {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = match AnyDesign::read(&self.design)? {
            AnyDesign::Plane(design) => *design,
            AnyDesign::Space(design) => return self.in_space(common, &design),
        };
        if self.gate || self.strict {
            super::asks_equal_spheres(&design, "the gate of check")?;
        }
        let read = read_piece(common, &design, &self.layout)?;
        let (layout, subject) = (&read.layout, Subject::from(&read));
        let drawing = Drawing::Plane(&design, subject);
        let overrides = self.motion.overrides(common);
        let plan = Plan::new(&design, overrides, &layout.palette)
            .map_err(|error| Failure::of_plan(&design, &overrides, &error))?;
        if common.dry_run {
            // Both halves are twice the spheres.
            let halves = if subject.left.is_some() { 2.0 } else { 1.0 };
            let seconds = halves * arrangement(&layout.sample(), &impact(&design, &plan))?;
            let runs = 2 + u64::from(design.reference().is_some());
            let what = "the layout and the uniform crystals of G and Q, with full records";
            let mut parts = vec![Part::new(what, runs, Some(seconds * runs as f64))];
            let forces = self.forces.or(Forces::ONE)?.count() as u64;
            if forces > 1 {
                let each = if design.friction.is_some() { seconds } else { seconds / 5.0 };
                let more = runs * forces;
                parts.push(Part::new(format!("the same under {forces} forces"), more, Some(each * more as f64)));
            }
            if self.gate || self.strict {
                // Baselines and laws with full records; eight forces at two steps and two windows in lanes.
                let each = seconds / 5.0;
                parts.push(Part::new("the gate: baselines and laws", 33, Some(33.0 * seconds)));
                parts.push(Part::new("the gate: step, window, forces", 240, Some(1.5 * 240.0 * each)));
                let pieces = self.gated.least_yield.map_or(0, |_| self.gated.samples.unwrap_or(PIECES));
                if pieces > 0 {
                    parts.push(Part::new("the gate: pieces as built", pieces, Some(3.0 * each * pieces as f64)));
                }
            }
            return tell(common, &parts);
        }
        self.under.chosen(&design)?;
        let gated = self.gated.asked(drawing, common)?;
        probe_all(common, &[self.spheres.as_ref(), common.out.as_ref()])?;
        let begun = Instant::now();
        let beside = beside_uniform(&design, subject, &plan, self.forces.or(Forces::ONE)?, context())?;
        let seconds = begun.elapsed().as_secs_f64();
        let gate = match beside.evaluation.record.stop {
            None if self.gate || self.strict => {
                let over_forces = beside.over_forces.as_ref().map(|(scores, _)| scores);
                Some(gate(drawing, &plan, Seen::of(&beside.evaluation, over_forces), &gated, context())?)
            }
            _ => None,
        };
        let Beside { evaluation, reference, stopped, forces, over_forces } = beside;
        let mut warnings = evaluation.warnings("this layout");
        let Evaluation { scores, record, .. } = evaluation;
        if over_forces.is_none() && !forces.is_empty() {
            warnings.push(STOPPED_BESIDE.to_owned());
        }
        let mut stop = record.stop.clone();
        for (name, uniform) in stopped {
            match uniform {
                interrupted @ Stop::Interrupted { .. } => stop = stop.or(Some(interrupted)),
                // Ratios to it would mean nothing; a threshold on one is not met.
                uniform => warnings.push(format!("FAILED: {name}: {uniform}")),
            }
        }
        if let (None, Some(material)) = (design.reference(), &reference) {
            warnings.push(unnamed(material));
        }
        if let Some(path) = &self.spheres {
            write_file(common, path, &spheres(subject, &record))?;
        }
        let laws = match &stop {
            None => self.under.scores(drawing, overrides)?,
            Some(_) => None,
        };
        let (mean, spreads) = over_forces.unwrap_or_default();
        // Where several forces are asked for, their score is what a threshold is about.
        let judged = if forces.is_empty() { &scores } else { &mean };
        let price = |material: &Material| design.price(material);
        let (forces, speeds) = parted(design.impact, forces);
        let checked = Checked {
            format: FORMAT,
            design: design.name.clone(),
            layout: self.layout.display().to_string(),
            thresholds: design.thresholds.iter().map(|threshold| asked(threshold, judged)).collect(),
            scores,
            over_forces: spreads,
            forces,
            speeds,
            materials: layout.palette.iter().map(|material| material.name.clone()).collect(),
            reference,
            piece: subject.piece(price),
            half: subject.left.is_none().then(|| layout.half(price)),
            method: method(&design, &plan),
            simulated_fraction: None,
            steps: record.steps,
            seconds,
            warnings: plan.warnings.iter().cloned().chain(warnings).collect(),
            laws,
            gate,
            stop,
        };
        write_json(common, &checked)?;
        if common.json {
            emit_json(&checked);
        } else {
            emit(&words(&checked));
            checked.laws.iter().for_each(|laws| emit(&laws.table()));
            checked.gate.iter().for_each(|gate| emit(&gate.words()));
            checked.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
        }
        self.ended(common, checked)
    }
}

impl Check {
    /// In space no frame holds the piece.
    fn in_space(self, common: &Common, design: &SpaceDesign) -> Result<(), Failure> {
        let strange = [
            (self.gated.frame_width.or(self.gated.frame_depth).is_some(), "the frame of the gate"),
            (common.dry_run, "--dry-run of check"),
        ];
        if let Some((_, what)) = strange.into_iter().find(|(given, _)| *given) {
            return Err(super::space::refuse(what));
        }
        let layout = super::space::read(design, &self.layout)?;
        self.under.chosen(design)?;
        let gated = match self.gate || self.strict {
            true => Some(self.gated.asked(Drawing::Space(design, &layout), common)?),
            false => None,
        };
        let asked = super::space::Asked {
            forces: self.forces.or(Forces::ONE)?,
            spheres: self.spheres.as_ref(),
            gate: gated.as_ref(),
            under: &self.under,
        };
        let overrides = self.motion.overrides(common);
        let checked = super::space::check(common, design, (&self.layout, &layout), overrides, &asked)?;
        if common.json {
            emit_json(&checked);
        } else {
            emit(&words(&checked));
            checked.laws.iter().for_each(|laws| emit(&laws.table()));
            checked.gate.iter().for_each(|gate| emit(&gate.words()));
            checked.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
        }
        self.ended(common, checked)
    }

    /// How the command ends.
    fn ended(&self, common: &Common, checked: Checked) -> Result<(), Failure> {
        let missed: Vec<String> = checked.thresholds.iter().filter(|asked| !asked.met).map(told).collect();
        match &checked.stop {
            Some(stop @ Stop::Interrupted { .. }) => {
                Err(Failure::Interrupted(format!("{stop}; shown is what was computed")))
            }
            Some(stop) => Err(Failure::Guard(vec![stop.to_string()])),
            None if !self.strict => Ok(()),
            None => {
                if checked.thresholds.is_empty() && checked.gate.is_some() {
                    let file = self.design.display();
                    note(common, &format!("{file} sets no [thresholds]; --strict asks for the gate alone"));
                }
                match checked.gate.filter(|gate| gate.word == Word::Fail) {
                    Some(gate) => Err(failed(missed, &gate)),
                    None if !missed.is_empty() => Err(Failure::Threshold(missed)),
                    None => Ok(()),
                }
            }
        }
    }
}

/// Thresholds that are missed and other lines of the gate that fail.
fn failed(missed: Vec<String>, gate: &Gate) -> Failure {
    let others: Vec<String> = gate.failed().into_iter().filter(|line| !line.starts_with("threshold ")).collect();
    if others.is_empty() { Failure::Threshold(missed) } else { Failure::Gate { missed, failed: others } }
}

impl From<GateError> for Failure {
    fn from(error: GateError) -> Self {
        match error {
            GateError::Evaluator(error) => error.into(),
            GateError::Workshop(error) => error.into(),
            GateError::Laws(OverLawsError::Evaluate(error)) => error.into(),
            GateError::Laws(error @ OverLawsError::Plan { .. }) => Self::input(error.to_string()),
        }
    }
}

/// What a threshold asks, and whether it is so.
pub fn asked(threshold: &Threshold, scores: &Scores) -> outcome::Asked {
    let value = scores.get(threshold.measure).filter(|value| value.is_finite());
    outcome::Asked {
        measure: threshold.measure.name().to_owned(),
        min: threshold.min,
        max: threshold.max,
        value,
        met: value.is_some_and(|value| threshold.admits(value)),
    }
}

/// A threshold in words.
fn told(asked: &outcome::Asked) -> String {
    let dimension = Measure::find(&asked.measure).and_then(|measure| measure.unit().dimension());
    let show = |value: f64, digits: usize| match dimension {
        Some(dimension) => dimension.show(value),
        None if value.fract() == 0.0 => format!("{value}"),
        // A miss by little is still seen to be one.
        None => format!("{value:.digits$}").trim_end_matches('0').to_owned(),
    };
    let bound = |word: &str, limit: Option<f64>| limit.map(|limit| format!("{word} {}", show(limit, 6)));
    let wanted: Vec<_> = [bound("at least", asked.min), bound("at most", asked.max)].into_iter().flatten().collect();
    let (name, wanted) = (&asked.measure, wanted.join(" and "));
    match asked.value {
        Some(value) => format!("{name} = {}, wanted {wanted}", show(value, 6)),
        None => format!("{name} has no value here: its denominator is zero or its baseline is missing"),
    }
}

/// A measure as it is shown: over several forces with its spread.
fn shown(checked: &Checked, measure: Measure) -> String {
    let show = |value: f64| match measure.unit().dimension() {
        Some(dimension) => dimension.show(value),
        None => format!("{value:.4}"),
    };
    match (checked.over_forces.mean(measure), checked.over_forces.deviation(measure)) {
        (Some(mean), Some(deviation)) => match measure.unit().dimension() {
            Some(dimension) => within(dimension, mean, deviation),
            None => format!("{} ± {}", show(mean), show(deviation)),
        },
        _ => checked.scores.get(measure).map_or_else(|| "-".to_owned(), show),
    }
}

/// A mean and the deviation from it in one unit, to the deviation's second digit.
fn within(dimension: Dimension, mean: f64, deviation: f64) -> String {
    let shown = dimension.show(mean);
    let (number, unit) = shown.split_once(' ').unwrap_or((&shown, ""));
    // Units are powers of ten apart.
    let scale = number.parse::<f64>().ok().map_or(1.0, |number| 10f64.powf((mean / number).abs().log10().round()));
    let scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
    let digits = (1.0 - (deviation / scale).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{:.digits$} {unit} ± {:.digits$} {unit}", mean / scale, deviation / scale)
}

fn words(checked: &Checked) -> String {
    let scores = &checked.scores;
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:18} {value}");
    };
    let q = match &checked.reference {
        Some(material) => format!("{} (against {material} alone)", shown(checked, Measure::Protection)),
        None => "-".to_owned(),
    };
    line("focal mean F", shown(checked, Measure::FocalMean));
    if let Some(balance) = scores.balance {
        let each: Vec<String> = scores.foci.iter().map(|mean| Energy.show(*mean)).collect();
        line("by focus", format!("{}; balance {balance:.3}", each.join(", ")));
    }
    line("protected mean P", shown(checked, Measure::ProtectedMean));
    line("contrast F/P", shown(checked, Measure::Contrast));
    line("focal gain G", shown(checked, Measure::FocalGain));
    line("protection Q", q);
    if let Some((_, what)) = strengths(&checked.forces, &checked.speeds) {
        line("over", format!("{what}; ± of one of them"));
    }
    for measure in [Measure::WorkIn, Measure::Kinetic, Measure::Stored] {
        line(measure.symbol(), shown(checked, measure));
    }
    let estimate = scores.eq_5_6.map_or("-".to_owned(), |estimate| Energy.show(estimate));
    line("dissipated", format!("{} (eq. 5.6 estimates {estimate})", shown(checked, Measure::Dissipated)));
    line("residual", scores.residual.map_or("-".to_owned(), |residual| format!("{residual:.1e}")));
    let row = if checked.simulated_fraction.is_some() { "layer" } else { "row" };
    let [momentum, force] = [scores.far_momentum, scores.far_force].map(Option::unwrap_or_default);
    line("far end", format!("{momentum:.4} kg m/s, peak force {force:.0} N on the last {row}"));
    let counts: Vec<String> =
        checked.materials.iter().zip(&checked.piece.counts).map(|(name, count)| format!("{count} {name}")).collect();
    line("piece", format!("{}; {}", counts.join(", "), Mass.show(checked.piece.amount.mass)));
    for asked in &checked.thresholds {
        line(if asked.met { "threshold met" } else { "threshold MISSED" }, told(asked));
    }
    let _ = write!(text, "{}; {} steps in {:.2} s", checked.method.words(), checked.steps, checked.seconds);
    text
}

/// What each sphere felt, as CSV; SI. Of a piece of two halves all of its spheres, row by row from left to right.
fn spheres(subject: Subject<'_>, record: &granulens::dem::Record<2>) -> String {
    let layout = subject.layout;
    let mut text = String::from(
        "row,column,x,z,material,max_kinetic_J,max_net_force_N,max_contact_force_N,arrival_s,dissipated_J\n",
    );
    let places: Vec<(u32, u32, f64, f64, u8)> = match subject.left {
        None => {
            let sites = layout.lattice.sites();
            sites.iter().zip(&layout.materials).map(|(at, &m)| (at.row, at.column, at.x, at.z, m)).collect()
        }
        Some(_) => subject.spheres().iter().map(|at| (at.row, at.column, at.x, at.z, at.material)).collect(),
    };
    for (i, (row, column, x, z, material)) in places.into_iter().enumerate() {
        let material = &layout.palette[usize::from(material)].name;
        let arrival = record.arrival[i].map_or_else(String::new, |time| time.to_string());
        let _ = writeln!(
            text,
            "{row},{column},{x},{z},{material},{},{},{},{arrival},{}",
            record.max_kinetic[i], record.max_net_force[i], record.max_contact_force[i], record.dissipated[i],
        );
    }
    text
}
