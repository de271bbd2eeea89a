//! `granulens design`: propose a lens by ray tracing.

use std::io::IsTerminal as _;
use std::path::PathBuf;

use granulens::dem::Strike;
use granulens::design::{AnyDesign, Design};
use granulens::evaluate::{Ranked, proposal, rank, struck_force, validity};
use granulens::layout::{self, Bill};
use granulens::lens::{Family, Lens};
use granulens::material::{Material, library};
use granulens::score::Scores;
use granulens::target::Focus;
use granulens::units::Dimension::{Force, Length, Mass, Time};
use granulens::wave::Dimension;
use serde_json::json;

use super::console::{context, emit, emit_json, note};
use super::failure::Failure;
use super::folder::{write_file, write_json};
use super::{Common, propose};

/// Propose a lens from the design's target by ray tracing; milliseconds, nothing is simulated
///
/// The layout goes to stdout as CSV where that is no terminal, or to the file of --out.
#[derive(clap::Args)]
pub struct Propose {
    /// Design file, such as designs/quickstart.toml
    design: PathBuf,
    /// Write the whole piece to be built, both halves, in place of the simulated half
    #[arg(long)]
    full: bool,
    /// Rank all materials, of the library and of the design, in all families in place of proposing one lens: by rays and first arrivals,
    /// and the best of them by simulation
    #[arg(long, conflicts_with = "full")]
    rank: bool,
    /// How many of the best are simulated
    #[arg(long, value_name = "N", default_value_t = 6, requires = "rank", value_parser = clap::value_parser!(u16).range(0..=200))]
    simulate: u16,
}

impl Propose {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = match AnyDesign::read(&self.design)? {
            AnyDesign::Plane(design) => *design,
            AnyDesign::Space(_) if self.rank => return Err(super::space::refuse("--rank")),
            AnyDesign::Space(design) => return super::space::propose(common, &design, self.full),
        };
        if self.rank {
            return ranking(common, &design, usize::from(self.simulate));
        }
        design.notes.iter().filter(|note| note.starts_with("lens.material")).for_each(|text| note(common, text));
        let lens = propose(&design)?;
        let laid = lens.layout();
        let text = if self.full { layout::write_full(&laid) } else { layout::write(&laid) };
        if let Some(path) = &common.out {
            write_file(common, path, &text)?;
            note(common, &format!("layout: {}", path.display()));
        }
        if common.json {
            let proposal = proposal(&design, &lens);
            emit_json(&json!({ "format": granulens::outcome::FORMAT, "name": design.name, "proposal": proposal }));
        } else if common.out.is_none() {
            note(common, &words(&design, &lens));
            match std::io::stdout().is_terminal() {
                // A thousand lines would push the words out of sight.
                true => note(common, "the layout is not printed on a terminal: --out lens.csv keeps it"),
                false => emit(&text),
            }
        } else {
            emit(&words(&design, &lens));
        }
        Ok(())
    }
}

/// All materials in all families, best first.
fn ranking(common: &Common, design: &Design, simulate: usize) -> Result<(), Failure> {
    let ranked = rank(design, &all_materials(design), &Family::ALL, simulate, context())?;
    let value = json!({ "format": granulens::outcome::FORMAT, "name": design.name, "host": design.host.name, "ranking": ranked });
    write_json(common, &value)?;
    if common.json {
        emit_json(&value);
    } else {
        emit(&ranking_words(&ranked));
    }
    Ok(())
}

/// Materials of the library and of the design's own.
pub fn all_materials(design: &Design) -> Vec<Material> {
    library().into_iter().chain(design.own_materials.iter().cloned()).collect()
}

fn ranking_words(ranked: &[Ranked]) -> String {
    let number = |value: Option<f64>, digits: usize| value.map_or("-".to_owned(), |value| format!("{value:.digits$}"));
    let share = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{:.1} %", 100.0 * value));
    let head =
        ["material", "family", "C", "G", "Q", "rays to focus", "past protected", "delay [us]", "ratio", "spheres"]
            .map(str::to_owned);
    let lines = ranked.iter().filter(|of| of.refused.is_none()).map(|of| {
        let score = |get: fn(&Scores) -> Option<f64>| number(of.scores.as_ref().and_then(get), 3);
        [
            of.material.clone(),
            of.family.clone(),
            of.stop.as_ref().map_or_else(|| score(|s| s.contrast), |_| "stopped".to_owned()),
            score(|s| s.focal_gain),
            score(|s| s.protection),
            share(of.fraction.map(|[with, _]| with)),
            share(of.protected.map(|[with, _]| with)),
            number(of.delay.map(|delay| 1e6 * delay), 2),
            number(of.speed_ratio, 2),
            of.spheres.map_or("-".to_owned(), |count| count.to_string()),
        ]
    });
    let table: Vec<[String; 10]> = std::iter::once(head).chain(lines).collect();
    let width = |k: usize| table.iter().map(|line| line[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..10).map(width).collect();
    let mut text = String::new();
    for line in &table {
        let cells = line.iter().zip(&widths).enumerate();
        let cells =
            cells.map(|(k, (cell, &width))| if k < 2 { format!("{cell:width$}") } else { format!("{cell:>width$}") });
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    let straight = ranked.iter().find_map(|of| of.fraction.zip(of.protected));
    if let Some(([_, focus], [_, protected])) = straight {
        text.push_str(&format!(
            "without a lens rays bring {} to the focus and {} past the protected region\n",
            percent(focus),
            percent(protected)
        ));
    }
    let refused: Vec<String> =
        ranked.iter().filter(|of| of.refused.is_some()).map(|of| format!("{} {}", of.material, of.family)).collect();
    if !refused.is_empty() {
        text.push_str(&format!("no lens: {}; why is in --json\n", refused.join(", ")));
    }
    text
}

/// What is proposed, for a person.
pub fn words(design: &Design, lens: &Lens) -> String {
    let [host, material] = [&lens.palette[0], &lens.palette[1]];
    let diameter = design.lattice.diameter();
    let in_diameters = |length: f64| format!("{:.2} D", length / diameter);
    let critical = granulens::wave::critical_angle([lens.host_speed, lens.lens_speed])
        .map_or_else(|| "none".to_owned(), |angle| format!("{:.1} deg", angle.to_degrees()));
    let crossing = |depth: Option<f64>| match depth {
        Some(z) => format!("crosses the axis at row {:.1}", z / design.lattice.row_spacing() + 1.0),
        None => "does not cross the axis".to_owned(),
    };
    let reach = match &design.target.foci[..] {
        [Focus { region, .. }] => {
            let [from, to] = region.x.map(|x| x / diameter);
            format!("the focus (row {}, x {from:.1} to {to:.1} D)", region.mid_row())
        }
        several => format!("one of the {} foci", several.len()),
    };
    let of = |material: &Material| format!("{}: {}", material.name, validity(design, material).words());
    let radius = match (lens.family.radius(), lens.prescription.radius) {
        (Some(name), Some(radius)) => format!(", {name} {} ({})", in_diameters(radius), Length.show(radius)),
        _ => String::new(),
    } + &lens.family.words(&lens.prescription.parameters, diameter);
    let layout = lens.layout();
    let [piece, half] =
        [layout.piece(|material| design.price(material)), layout.half(|material| design.price(material))];
    let counts = |bill: &Bill| {
        let named = lens.palette.iter().zip(&bill.counts);
        named.map(|(material, count)| format!("{count} {}", material.name)).collect::<Vec<_>>().join(", ")
    };
    let first = &lens.first_order;
    let focal = lens.prescription.focal_length.map_or("none".to_owned(), in_diameters);
    let arrival = first.arrival.map_or("never".to_owned(), |[a, b]| format!("{} to {}", Time.show(a), Time.show(b)));
    // Of several parts there is no innermost ray, nor one focal length.
    let crossings = match lens.foci.len() {
        1 => format!("; innermost ray {}, rim ray {}", crossing(lens.crossing[0]), crossing(lens.crossing[1])),
        _ => String::new(),
    };
    let whole = match lens.foci.len() {
        1 => format!(", axis at {}, focal length {focal}", in_diameters(lens.prescription.axis)),
        _ => format!(", {} parts", lens.parts.len()),
    };
    let force = struck_force(design, Dimension::Two, host, design.lattice.diameter());
    let mut words = format!(
        "speeds: {} {:.0} m/s, {} {:.0} m/s (bound, 2D), ratio {:.3}, critical angle {critical}\n\
         impact: {}{} per sphere, {} per contact; {}\n\
         lens: rows {} to {}, {}{radius}, steepest {:.1} deg, half aperture {}, thickness {}{whole}\n\
         piece: {}; both halves, {}\n\
         half: {} of the simulated half, {}\n\
         rays: {} of the struck width reach {reach}, {} without the lens; {} pass the protected \
         region, {} without; arrival {arrival}{crossings}",
        host.name,
        lens.host_speed,
        material.name,
        lens.lens_speed,
        lens.host_speed / lens.lens_speed,
        about(design.impact),
        Force.show(force),
        Force.show(granulens::wave::contact_force(force)),
        lens.palette.iter().map(of).collect::<Vec<_>>().join("; "),
        lens.prescription.apex_row,
        lens.prescription.back_row,
        lens.family.name(),
        lens.prescription.rim_angle.to_degrees(),
        in_diameters(lens.prescription.aperture),
        in_diameters(lens.prescription.thickness),
        counts(&piece),
        Mass.show(piece.amount.mass),
        counts(&half),
        Mass.show(half.amount.mass),
        percent(lens.fraction),
        percent(lens.fraction_without),
        percent(lens.protected[0]),
        percent(lens.protected[1]),
    );
    if lens.foci.len() > 1 {
        words.push_str(&words_of_parts(design, lens));
    }
    if let Some(cost) = piece.amount.cost {
        words.push_str(&format!("\ncost: {cost:.2} for all spheres of the piece, in the currency of [prices]"));
    }
    for warning in &lens.warnings {
        words.push_str(&format!("\nwarning: {warning}"));
    }
    words
}

/// Of a projectile what it is; the force is then that of its first wave in the host.
pub(super) fn about(strike: Strike) -> String {
    strike.projectile().map_or(String::new(), |_| format!("{strike}, about "))
}

fn percent(fraction: f64) -> String {
    format!("{:.1} %", 100.0 * fraction)
}

/// Each part of a lens for several foci, and what rays bring to each of these.
fn words_of_parts(design: &Design, lens: &Lens) -> String {
    let diameter = design.lattice.diameter();
    let in_diameters = |length: f64| format!("{:.2} D", length / diameter);
    let mut words = String::new();
    for part in &lens.parts {
        let foci: Vec<String> = part.foci.iter().map(|focus| (focus + 1).to_string()).collect();
        let radius = match (lens.family.radius(), part.prescription.radius) {
            (Some(name), Some(radius)) => format!(", {name} {}", in_diameters(radius)),
            _ => String::new(),
        } + &lens.family.words(&part.prescription.parameters, diameter);
        let focal =
            part.prescription.focal_length.map_or(String::new(), |f| format!(", focal length {}", in_diameters(f)));
        words.push_str(&format!(
            "\npart for focus {}: x {} to {}, rows {} to {}{radius}, axis at {}{focal}, steepest {:.1} deg; {} of its strip's \
             rays come to it, {} without",
            foci.join(" and "),
            in_diameters(part.window[0]),
            in_diameters(part.window[1]),
            part.prescription.apex_row,
            part.prescription.back_row,
            in_diameters(part.prescription.axis),
            part.prescription.rim_angle.to_degrees(),
            percent(part.fraction),
            percent(part.fraction_without),
        ));
    }
    for (k, (rays, Focus { region, share })) in lens.foci.iter().zip(&design.target.foci).enumerate() {
        let arrival = rays.arrival.map_or("never".to_owned(), |[a, b]| format!("{} to {}", Time.show(a), Time.show(b)));
        let gain = rays.gain.map_or("none".to_owned(), |gain| format!("{gain:.2}"));
        let [from, to] = region.x.map(in_diameters);
        words.push_str(&format!(
            "\nfocus {} (row {}, x {from} to {to}): asked {} of the blow, rays bring {} of the struck width, {} without the lens; \
             gain by rays {gain}, arrival {arrival}",
            k + 1,
            region.mid_row(),
            percent(*share),
            percent(rays.fraction),
            percent(rays.fraction_without),
        ));
    }
    words
}
