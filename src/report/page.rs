//! The page: everything of an outcome in one HTML file that needs no network.

use minijinja::syntax::SyntaxConfig;
use minijinja::{AutoEscape, Environment, Value, context};

use super::claims::claims;
use super::digits::{NONE, short, significant};
use super::files::ReportError;
use super::maps::{first_row_behind, kinetic_scale};
use super::profiles::rows;
use super::summary::{
    AGAINST, CONTRAST, Column, DISSIPATED, EQ_5_6, FAR_FORCE, FAR_MOMENTUM, FOCAL, GAIN, Line, PIECE, PROTECTED,
    PROTECTION, RESIDUAL, definitions, lines, worst_residual,
};
use super::{maps, profiles, sensitivity, verdict};
use crate::evaluate::Derivatives;
use crate::layout::Bill;
use crate::lens::Family;
use crate::outcome::{Manifest, Outcome, PartOfNetwork, Proposal, Verdict};
use crate::score::Measure;
use crate::target::{Focus, Region};
use crate::units::Dimension;

/// Columns of the comparison.
const COLUMNS: [&Column; 12] = [
    &PIECE,
    &FOCAL,
    &PROTECTED,
    &CONTRAST,
    &GAIN,
    &PROTECTION,
    &AGAINST,
    &DISSIPATED,
    &EQ_5_6,
    &FAR_MOMENTUM,
    &FAR_FORCE,
    &RESIDUAL,
];

/// The figures that stand above the tables.
const LEAD: [&str; 3] = ["kinetic-lens.svg", "layout.svg", "profiles.svg"];

/// A label and what it labels.
type Fact = (&'static str, String);

/// Fills the page in, with the pictures inlined.
///
/// # Errors
/// If the template does not fit its content.
pub fn page(outcome: &Outcome, pictures: &[(&'static str, String)]) -> Result<String, ReportError> {
    let all = lines(outcome);
    let random = outcome.arrangements.iter().filter(|a| a.seed.is_some());
    let single = random.map(|a| Line { name: &a.name, members: vec![a] });
    let manifest = &outcome.manifest;
    // The telling ones first, then the others.
    let (mut lead, mut further, mut within) = (Vec::new(), Vec::new(), Vec::new());
    for (file, svg) in pictures {
        let numbers = match *file {
            "layout.svg" | "spots.svg" => None,
            "swaps.svg" => Some("outcome.json"),
            "inside.svg" => Some("contacts.csv"),
            "sensitivity-focal.svg" | "sensitivity-protected.svg" => Some("sensitivity.csv"),
            _ => Some("spheres.csv"),
        };
        let figure = context! { file => *file, svg, caption => caption(outcome, file), numbers };
        match LEAD.iter().position(|name| name == file) {
            Some(place) => lead.push((place, figure)),
            None if *file == "inside.svg" => within.push(figure),
            None => further.push(figure),
        }
    }
    let claims = claims(outcome).into_iter().map(|c| {
        context! { claim => c.claim, source => c.source, measured => c.measured, holds => c.holds }
    });
    lead.sort_by_key(|(place, _)| *place);
    // Text, ready to be read; the template escapes it.
    let content = context! {
        name => &manifest.name,
        version => &manifest.method.version,
        commit => &manifest.method.commit,
        verdict => outcome.verdict.iter().map(judged).collect::<Vec<_>>(),
        verdict_over => verdict::over(outcome),
        definitions => definitions(&COLUMNS),
        reference => &outcome.reference,
        is_published => outcome.is_published,
        design_file => &manifest.design_file,
        design => &manifest.design,
        asked => asked(outcome),
        proposed => outcome.proposal.as_ref().map(|p| proposed(outcome, p)).unwrap_or_default(),
        validity => outcome.proposal.as_ref().map(|p| &p.validity),
        headings => COLUMNS.map(Column::heading).to_vec(),
        comparison => all.iter().map(compared).collect::<Vec<_>>(),
        foci => foci(outcome),
        by_focus => all.iter().map(by_focus).collect::<Vec<_>>(),
        seeds => single.map(|line| compared(&line)).collect::<Vec<_>>(),
        claims => claims.collect::<Value>(),
        look => crate::page::look(),
        lead => lead.into_iter().map(|(_, figure)| figure).collect::<Vec<_>>(),
        further,
        within,
        parts => outcome.inside.as_ref().map(|inside| inside.parts.iter().map(part).collect::<Vec<_>>()),
        ledger => all.iter().map(ledger).collect::<Vec<_>>(),
        worst_residual => worst_residual(outcome).map_or(NONE.to_owned(), |r| significant(r, 2)),
        warnings => outcome.warnings.clone(),
        command => manifest.command.clone().unwrap_or_else(|| format!("granulens run {}", manifest.design_file)),
        repeat => repeat(manifest),
    };
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let syntax = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?;
    environment.set_syntax(syntax);
    Ok(environment.render_named_str("page.html", include_str!("page.html"), content)?)
}

/// A line of the verdict.
fn judged(of: &Verdict) -> Vec<String> {
    vec![
        format!("{}, {}", verdict::symbol(of), of.measure),
        significant(of.value, 3),
        of.word.name().to_owned(),
        format!("{}: {}", of.against, of.arrangement),
        significant(of.best, 3),
        of.spread.map_or(NONE.to_owned(), |spread| significant(spread, 2)),
    ]
}

fn compared(line: &Line) -> Vec<String> {
    let name = match line.members.len() {
        1 => line.name.to_owned(),
        seeds => format!("{} ({seeds} seeds)", line.name),
    };
    std::iter::once(name).chain(COLUMNS.iter().map(|column| line.show(column))).collect()
}

/// The columns of what came to each of several foci; none with a single one.
fn foci(outcome: &Outcome) -> Vec<String> {
    let foci = &outcome.target.foci;
    if foci.len() < 2 {
        return Vec::new();
    }
    let of = |(k, focus): (usize, &Focus)| {
        let rays = outcome.proposal.as_ref().and_then(|proposal| proposal.foci.get(k));
        let rays = rays.map_or(String::new(), |rays| {
            format!(
                ", {} % of the rays ({} % straight on)",
                significant(100.0 * rays.fraction[0], 3),
                significant(100.0 * rays.fraction[1], 3)
            )
        });
        format!("F of focus {} [J] (wanted {} %{rays})", k + 1, significant(100.0 * focus.share, 3))
    };
    foci.iter().enumerate().map(of).chain(["balance".to_owned()]).collect()
}

/// F of each focus in an arrangement, with its part of their sum, and how evenly they are served.
fn by_focus(line: &Line) -> Vec<String> {
    let members = line.members.len() as f64;
    let foci = line.members.iter().map(|member| member.scores.foci.len()).min().unwrap_or(0);
    let mean = |k: usize| line.members.iter().map(|member| member.scores.foci[k]).sum::<f64>() / members;
    let all: f64 = (0..foci).map(mean).sum();
    let cell = |k: usize| format!("{} ({} %)", significant(mean(k), 3), significant(100.0 * mean(k) / all, 3));
    let balance = line.members.iter().filter_map(|member| member.scores.balance).sum::<f64>() / members;
    [line.name.to_owned()].into_iter().chain((0..foci).map(cell)).chain([significant(balance, 2)]).collect()
}

/// Where the work of the load went, with its share.
fn ledger(line: &Line) -> Vec<String> {
    let mean = |measure: Measure| line.spread(measure).map_or(f64::NAN, |spread| spread.mean);
    let work = mean(Measure::WorkIn);
    let shared = |value: f64| {
        if work > 0.0 {
            format!("{} ({} %)", significant(value, 4), significant(100.0 * value / work, 3))
        } else {
            significant(value, 4)
        }
    };
    vec![
        line.name.to_owned(),
        significant(work, 5),
        shared(mean(Measure::Dissipated)),
        shared(mean(Measure::Kinetic)),
        shared(mean(Measure::Stored)),
        line.show(&RESIDUAL),
    ]
}

/// Measures of a part of the force network.
fn part(part: &PartOfNetwork) -> Vec<String> {
    vec![
        format!("{}, rows {} to {}", part.name, part.rows[0], part.rows[1]),
        part.touching.to_string(),
        format!("{:.2}", part.coordination),
        significant(part.mean_force, 3),
        significant(part.greatest, 3),
        part.components.to_string(),
        part.loops.to_string(),
        significant(part.persistence_of_loops, 3),
        format!("{:.0} %", 100.0 * part.in_chains),
        part.along_over_across.map_or(NONE.to_owned(), |ratio| significant(ratio, 3)),
    ]
}

fn pair(label: &'static str, value: impl Into<String>) -> Fact {
    (label, value.into())
}

fn asked(outcome: &Outcome) -> Vec<Fact> {
    let region = |region: &Region| {
        let sites = outcome.sites.iter().filter(|site| region.contains(site, outcome.diameter)).count();
        let [from, to] = region.x.map(|x| short(x / outcome.diameter));
        format!("rows {} to {}, x from {from} D to {to} D: {sites} spheres", region.rows[0], region.rows[1])
    };
    let rows = outcome.sites.iter().map(|s| s.row).max().unwrap_or(0);
    let half_width = short(outcome.half_width / outcome.diameter);
    let materials: Vec<String> =
        outcome.materials.iter().enumerate().map(|(k, name)| format!("{name}{}", role(outcome, k))).collect();
    let foci = match &outcome.target.foci[..] {
        [one] => vec![pair("Focal region", region(&one.region))],
        several => {
            let word = |(k, focus): (usize, &Focus)| {
                let share = significant(100.0 * focus.share, 3);
                format!("{}: {}, for {share} % of the blow", k + 1, region(&focus.region))
            };
            vec![pair("Focal regions", several.iter().enumerate().map(word).collect::<Vec<_>>().join("; "))]
        }
    };
    let head = [pair("Impact", &outcome.manifest.impact)].into_iter().chain(foci);
    head.chain([
        pair("Protected region", region(&outcome.target.protect)),
        pair("Materials", materials.join(", ")),
        pair(
            "Flat strips, mixtures and the crystal of Q",
            outcome.reference.clone().unwrap_or_else(|| "none: there is but one material".to_owned()),
        ),
        pair(
            "Crystal",
            format!(
                "{} of {} spheres in the simulated half, D = {}, {rows} rows, half width {half_width} D, mirrored about the axis and at its rim",
                sheet_words(outcome),
                outcome.sites.len(),
                Dimension::Length.show(outcome.diameter)
            ),
        ),
    ])
    .collect()
}

/// What sheet it is.
fn sheet_words(outcome: &Outcome) -> String {
    let first: Vec<_> = outcome.sites.iter().filter(|site| site.column == 1).take(2).collect();
    let packing = if first.iter().all(|site| site.x == 0.0) { "square" } else { "hexagonal" };
    let rows: Vec<f64> = outcome.sites.iter().filter(|site| site.column == 1).map(|site| site.z).collect();
    let apart = |two: &[f64]| two[1] - two[0];
    let alike = rows.windows(2).all(|two| (apart(two) / apart(&rows[..2]) - 1.0).abs() < 1e-6);
    format!("{packing} sheet{}", if alike { "" } else { " of rows of several sizes" })
}

fn proposed(outcome: &Outcome, proposal: &Proposal) -> Vec<Fact> {
    let speed = |v: f64| format!("{} m/s", significant(v, 4));
    let degrees = |angle: f64| format!("{:.1}°", angle.to_degrees());
    let diameters = |x: f64| format!("{} ({} D)", millimetres(x), significant(x / outcome.diameter, 3));
    let crossing = |z: Option<f64>| z.map_or("does not cross it".to_owned(), millimetres);
    let percent = |f: f64| format!("{} %", significant(100.0 * f, 3));
    let own = Family::find(&proposal.family)
        .map_or(String::new(), |family| family.words(&proposal.prescription.parameters, outcome.diameter));
    let own = own.strip_prefix(", ").map(|words| pair("What else the family has", words));
    let first = vec![
        pair("Wave-speed bound, host", speed(proposal.host_speed)),
        pair("Wave-speed bound, lens", speed(proposal.lens_speed)),
        pair("Speed ratio", significant(proposal.speed_ratio, 3)),
        pair("Critical angle, lens to host", proposal.critical_angle.map_or("none".to_owned(), degrees)),
        pair(
            "Contact force of row 1 over F_p",
            format!(
                "{} (host), {} (lens)",
                significant(proposal.amplitude_host, 3),
                significant(proposal.amplitude_lens, 3)
            ),
        ),
        pair("Family", &proposal.family),
        pair(
            "Rows of the lens",
            format!("first {}, last {}", proposal.prescription.apex_row, proposal.prescription.back_row),
        ),
        pair(
            Family::find(&proposal.family).map_or("Radius", Family::radius_heading),
            proposal.prescription.radius.map_or("none".to_owned(), diameters),
        ),
    ];
    let others = vec![
        pair("Its axis", diameters(proposal.prescription.axis)),
        pair("Half aperture", diameters(proposal.prescription.aperture)),
        pair("Thickness", diameters(proposal.prescription.thickness)),
        pair("Steepest angle of a face", degrees(proposal.prescription.rim_angle)),
        pair("Focal length of innermost rays", proposal.prescription.focal_length.map_or("none".to_owned(), diameters)),
        pair("The piece to be built", bill(proposal, &proposal.piece)),
        pair("The simulated half", bill(proposal, &proposal.half)),
        pair(
            match outcome.target.foci.len() {
                1 => "Struck width whose rays reach the focal region",
                _ => "Struck width whose rays reach one of the focal regions",
            },
            format!("{} with the lens, {} straight on", percent(proposal.fraction), percent(proposal.fraction_without)),
        ),
        pair(
            "Struck width whose rays pass the protected region",
            format!("{} with the lens, {} straight on", percent(proposal.protected[0]), percent(proposal.protected[1])),
        ),
        pair(
            "Rays arrive in the focal region",
            proposal.arrival.map_or("never".to_owned(), |[first, last]| {
                format!("{} to {}", Dimension::Time.show(first), Dimension::Time.show(last))
            }),
        ),
        pair(
            "Depth at which rays cross the axis",
            format!("innermost {}, outermost {}", crossing(proposal.crossing[0]), crossing(proposal.crossing[1])),
        ),
    ];
    first.into_iter().chain(own).chain(others).collect()
}

/// Spheres of each material, mass and price.
fn bill(proposal: &Proposal, bill: &Bill) -> String {
    let counts: Vec<String> =
        proposal.materials.iter().zip(&bill.counts).map(|(name, count)| format!("{count} {name}")).collect();
    let cost = bill
        .amount
        .cost
        .map_or(String::new(), |cost| format!(", cost {} in the currency of [prices]", significant(cost, 4)));
    format!("{}; {}{cost}", counts.join(", "), Dimension::Mass.show(bill.amount.mass))
}

/// What a material is in this outcome.
pub(super) fn role(outcome: &Outcome, index: usize) -> &'static str {
    let is_lens = outcome.proposal.as_ref().and_then(|p| p.materials.get(1)) == outcome.materials.get(index);
    match index {
        0 => " (host)",
        _ if is_lens => " (lens)",
        _ => "",
    }
}

fn millimetres(length: f64) -> String {
    format!("{} mm", significant(length * 1e3, 4))
}

fn caption(outcome: &Outcome, file: &str) -> String {
    let several = outcome.target.foci.len() > 1;
    let regions = match several {
        false => "The focal region is outlined solid, the protected one dashed; faint lines part the materials.",
        true => "The focal regions are outlined solid, the protected one dashed; faint lines part the materials.",
    };
    let beyond = format!(
        "The scale ends where 99 % of the values from row {} on, behind the lens, are below, at {} J; spheres above it take the top colour.",
        first_row_behind(outcome),
        significant(kinetic_scale(outcome).high(), 2)
    );
    let shown: Vec<String> = (0..outcome.target.foci.len())
        .map(|focus| {
            let [before, at, behind] = rows(outcome, focus);
            format!(
                "{before}, {at} and {behind}{}",
                if several { format!(" (focus {})", focus + 1) } else { String::new() }
            )
        })
        .collect();
    let shown = shown.join("; ");
    let rays_shown = if outcome.proposal.is_some() { "; white: rays" } else { "" };
    let peaks = peaks(outcome);
    let rays = if outcome.proposal.is_some() {
        " Blue: the ideal faces that the spheres approximate; red: rays refracted at them by Snell's law with the wave-speed bounds."
    } else {
        ""
    };
    let first = outcome.arrangements.first().map_or("the piece", |first| first.name.as_str());
    let halves_differ = outcome.arrangements.iter().any(|a| a.layout.len() > outcome.sites.len());
    let half = if halves_differ { "both halves" } else { "the simulated half only (axis at the left)" };
    let means = if halves_differ {
        " Of the piece, whose halves differ, each value is the mean of a sphere and its image."
    } else {
        ""
    };
    match file {
        "layout.svg" => format!("The piece as it would be built, both halves, spheres in true proportion.{rays}"),
        "spots.svg" => "Spot diagram: where the rays pass the middle row of the focal region, or of each by the rays that are meant for it (across), by where they start (upwards); ticks below are the same places on one line. Rays of a perfect lens stand on one vertical line; a bend is spherical aberration, a jump a step between zones or parts. Rays know nothing of wavelength and decay.".to_owned(),
        "kinetic-lens.svg" => format!(
            "Greatest kinetic energy of each sphere of the first arrangement during the window, both halves. Left: as it is{rays_shown}. Right: over the mean of its row, less 1, which takes the decay with depth away: red where there is more than in a plane wave of the same energy, blue where there is less. {peaks} {beyond} {regions}"
        ),
        "kinetic.svg" => format!(
            "The same for {first} and one arrangement of each kind it is compared with (of random ones the first seed), {half}, all on one colour scale. {beyond} {regions}"
        ),
        "profiles.svg" => format!(
            "Greatest kinetic energy across rows {shown}, from the axis to the rim. {peaks}{means} Each panel row has its own energy scale."
        ),
        "swaps.svg" => {
            let noise = outcome.swaps.as_ref().map_or(0.0, |swaps| 100.0 * swaps.noise);
            format!(
                "What it does to C to exchange a sphere, in both halves alike, for that other material of the layout which is best there, under the design's own force: red where C \
                 gains, blue where it loses. Changes below {noise:.1} % are within what a change of the force by 1 % does."
            )
        }
        "sensitivity-focal.svg" | "sensitivity-protected.svg" => {
            let own = sensitivity::MAPS.into_iter().find(|(_, own, _)| *own == file);
            let of = |measure| outcome.sensitivities.iter().flatten().find(|of| of.measure == measure);
            let trust = own.and_then(|(measure, ..)| of(measure)).map_or_else(String::new, Derivatives::trust);
            let names = own.map_or("", |(.., names)| names);
            let secant_alone = if file == "sensitivity-protected.svg" {
                " Where derivative and secant differ, believe the secant: the region is lit by what has gone to and fro, and a derivative holds over a change too small for any workshop."
            } else {
                " G is F over that of a crystal that stays as it is, so that both change alike."
            };
            format!(
                "How {names} change where one sphere has more of a quantity, its image in the other half alike (the simulated half only, axis at the left): in per cent, for one per cent \
                 of the quantity; red where {names} grow, blue where they fall, white at zero. Derivatives by the adjoint of the run, and beside that by density the secant over a change of 1 %: \
                 {trust}. Dots mark spheres at which both differ, so that the derivative is right and useless.{secant_alone} Scales end where 99 % of the values are below, the first two at \
                 that of the secants."
            )
        }
        "inside.svg" => "Left: contacts between spheres when the focal region has most kinetic energy, as broad as the root of their force and coloured by it, force chains pale blue \
             below; red lines part the materials. Right: D²_min from rest to the end, what no affine map of a neighbourhood of 2.5 D explains: how far spheres have slid past each other, \
             logarithmic; its numbers are in damage.csv."
            .to_owned(),
        "dissipation.svg" => "Energy dissipated at each sphere: half of the loss of each of its contacts. The scale is logarithmic; spheres below it, among them those that lost nothing, take the bottom colour.".to_owned(),
        "forces.svg" => format!("Greatest net contact force on each sphere of {first}. Left: as it is, logarithmic. Right: over the greatest of its row, which takes the decay with depth away. Rows that the wave did not reach in the window are white on the right and take the bottom colour on the left."),
        _ => String::new(),
    }
}

/// Where the first arrangement's energy is greatest in the middle row of each focal region.
fn peaks(outcome: &Outcome) -> String {
    let Some(first) = outcome.arrangements.first() else { return String::new() };
    let of = |(k, focus): (usize, &Focus)| {
        let row = rows(outcome, k)[1];
        let sites = profiles::sites_of(outcome, row).into_iter();
        let values = sites.filter_map(|i| {
            Some((outcome.sites[i], maps::mean_at(&first.record.max_kinetic, i, outcome.sites.len())?))
        });
        let (site, peak) = values.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, peak)| *peak > 0.0)?;
        let inside = if focus.region.contains(&site, outcome.diameter) { "in" } else { "outside" };
        Some(format!(
            "In row {row} the greatest value of {}, {} J, is at x = {} D, {inside} the focal region.",
            first.name,
            significant(peak, 3),
            short(site.x / outcome.diameter)
        ))
    };
    outcome.target.foci.iter().enumerate().filter_map(of).collect::<Vec<_>>().join(" ")
}

fn repeat(manifest: &Manifest) -> Vec<Fact> {
    let [first, count] = manifest.seeds;
    let seeds = match count {
        0 => "none".to_owned(),
        1 => format!("{first}"),
        _ => format!("{first} to {} ({count} of each random kind)", first.saturating_add(count - 1)),
    };
    let digest = crate::output::digest(manifest.design.as_bytes());
    vec![
        pair("Design file", format!("{}, CRC-32 {digest}", manifest.design_file)),
        pair("granulens", format!("{}, commit {}", manifest.method.version, manifest.method.commit)),
        pair("Step", format!("{}: {}", Dimension::Time.show(manifest.method.step_s), manifest.method.step_reason)),
        pair(
            "Window",
            format!("{}: {}", Dimension::Time.show(manifest.method.window_s), manifest.method.window_reason),
        ),
        pair("Integrator", &manifest.method.integrator),
        pair("Contact law", &manifest.method.law),
        pair("Fitted constants", manifest.method.constants.as_deref().unwrap_or("none")),
        pair("Random seeds", seeds),
        pair("Begun", date(manifest.started_unix_s)),
        pair(
            "Took",
            format!(
                "{} s on {} threads; the results do not depend on them",
                significant(manifest.seconds, 3),
                manifest.threads
            ),
        ),
    ]
}

/// Date and time of day in UTC. The date is by H. Hinnant's algorithm for the proleptic Gregorian calendar, with years that
/// begin in March so that the leap day comes last.
fn date(unix: u64) -> String {
    let (days, seconds) = (unix / 86_400 + 719_468, unix % 86_400);
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let (day, month) = (day - (153 * month + 2) / 5 + 1, if month < 10 { month + 3 } else { month - 9 });
    let year = era * 400 + year + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02} {:02}:{:02} UTC", seconds / 3_600, seconds / 60 % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date(0), "1970-01-01 00:00 UTC");
        assert_eq!(date(951_782_400), "2000-02-29 00:00 UTC");
        assert_eq!(date(1_767_225_599), "2025-12-31 23:59 UTC");
    }
}
