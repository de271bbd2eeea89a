//! Where: what one wrong sphere costs at each site, which single one costs most, and which pair among the worst.
//!
//! A wrong sphere is of another of the layout's materials, that which costs most, on one side of the axis. Sites are first seen under the design's own
//! force; the worst are judged again over eight forces, since single scores scatter by a percent.

use serde::Serialize;

use super::workshop::{Made, Workshop, WorkshopError};
use crate::design::Design;
use crate::evaluate::{Drawing, Forces, ImpactLoad, Imperfection, LoadCase, Subject};
use crate::report::site_map;
use crate::score::geometric;
use crate::stats::Mean;
use crate::{Context, Progress};

/// The worst single sites, of which pairs are tried.
const WORST: usize = 40;
/// The worst pairs that are judged again.
const PAIRS: usize = 10;
/// Cases simulated between two looks at the progress.
const BLOCK: usize = 256;

/// One wrong sphere.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WrongSphere {
    /// Its row.
    pub row: u32,
    /// Its column in the half; where the halves are alike it stands there or at the image of it.
    pub column: u32,
    /// From the axis (m), negative left of it in a piece whose halves differ.
    #[serde(rename = "x_m")]
    pub x: f64,
    /// What is drawn.
    pub drawn: String,
    /// What stands there.
    pub wrong: String,
    /// C over that of the layout as drawn, less one.
    pub change: f64,
}

/// What wrong spheres cost.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sites {
    /// Twice the standard deviation of the change under one force.
    pub noise: f64,
    /// Site by site, under the design's own force.
    pub each: Vec<WrongSphere>,
    /// The worst single one, over eight forces; none where a layout has one material.
    pub worst: Option<WrongSphere>,
    /// The worst pair among the worst singles, over eight forces, and its change.
    pub worst_pair: Option<([WrongSphere; 2], f64)>,
}

/// A wrong sphere: its place, and how many letters further on.
type Wrong = (usize, u8);

/// The places at which a wrong sphere is tried: where the halves are drawn alike those of the other side, and on the axis the one that there
/// is; else all.
fn places(subject: Subject<'_>) -> Vec<usize> {
    let sites = subject.layout.lattice.sites();
    let image = |site: usize| sites.len() + site;
    let beside = |site: &usize| sites[*site].x > 0.0;
    match subject.left {
        None => (0..sites.len()).map(|site| if beside(&site) { image(site) } else { site }).collect(),
        Some(_) => (0..sites.len()).chain((0..sites.len()).filter(beside).map(image)).collect(),
    }
}

/// Simulates a wrong sphere at every site.
///
/// # Errors
/// See [`WorkshopError`].
pub fn sites(workshop: &Workshop, context: &Context) -> Result<Sites, WorkshopError> {
    let Drawing::Plane(design, subject) = workshop.drawing() else {
        return Err(WorkshopError::Sheets("what one wrong sphere costs at each site"));
    };
    let (layout, drawn_on) = (subject.layout, subject.drawn());
    let lattice_sites = layout.lattice.sites();
    let alphabet = workshop.drawing().letters();
    let count = layout.materials.len();
    let places = places(subject);
    let case = |wrong: &[Wrong], force: f64| LoadCase {
        halves_differ: subject.left.is_some(),
        load: ImpactLoad::from(design.impact.with_strength(force)),
        imperfection: Imperfection { alphabet: alphabet.clone(), wrong: wrong.to_vec(), ..Imperfection::default() },
    };
    let contrast = |made: &Made| if made.stop.is_some() { Some(0.0) } else { made.scores.contrast };
    let run = |cases: Vec<LoadCase>| -> Result<Vec<f64>, WorkshopError> {
        let mut found = Vec::with_capacity(cases.len());
        for block in cases.chunks(BLOCK) {
            found.extend(workshop.cases(block, context)?.iter().map(|made| contrast(made).unwrap_or(0.0)));
            context.tell(Progress::Finished { count: block.len() as u64, name: "" });
        }
        Ok(found)
    };
    let forces = Forces::USUAL.about(design.impact.strength());
    let over_forces = |wrongs: &[Vec<Wrong>]| -> Result<Vec<f64>, WorkshopError> {
        let cases = wrongs.iter().flat_map(|wrong| forces.iter().map(|&force| case(wrong, force))).collect();
        Ok(run(cases)?.chunks(forces.len()).map(geometric).collect())
    };

    let drawn = run(vec![case(&[], design.impact.strength())])?[0];
    let under_forces = run(forces.iter().map(|&force| case(&[], force)).collect())?;
    let drawn_mean = geometric(&under_forces);
    // The difference of two scores under one force each scatters by √2 of one.
    let noise = 2.0 * 2.0_f64.sqrt() * Mean::of(&under_forces).deviation.unwrap_or(0.0) / drawn_mean;
    let shifts = 1..alphabet.len().max(1) as u8;
    let singles: Vec<Wrong> =
        places.iter().flat_map(|&place| shifts.clone().map(move |shift| (place, shift))).collect();
    let found = run(singles.iter().map(|&single| case(&[single], design.impact.strength())).collect())?;
    // Of each place the material that costs most.
    let mut worst_of: Vec<(Wrong, f64)> = Vec::with_capacity(places.len());
    for (&single, &contrast) in singles.iter().zip(&found) {
        match worst_of.last_mut() {
            Some((known, least)) if known.0 == single.0 => {
                if contrast < *least {
                    (*known, *least) = (single, contrast);
                }
            }
            _ => worst_of.push((single, contrast)),
        }
    }
    let told = |(place, shift): Wrong, change: f64| {
        let at = &lattice_sites[place % count];
        let there = drawn_on[place % drawn_on.len()];
        let letter = alphabet.iter().position(|&letter| letter == there).unwrap_or(0);
        let wrong = alphabet[(letter + usize::from(shift)) % alphabet.len()];
        let name = |letter: u8| layout.palette[usize::from(letter)].name.clone();
        WrongSphere {
            row: at.row,
            column: at.column,
            x: if subject.left.is_some() && place >= count { -at.x } else { at.x },
            drawn: name(there),
            wrong: name(wrong),
            change,
        }
    };
    let each = worst_of.iter().map(|&(single, contrast)| told(single, contrast / drawn - 1.0)).collect();
    let mut order = worst_of;
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    order.truncate(WORST);
    let judged = over_forces(&order.iter().map(|&(single, _)| vec![single]).collect::<Vec<_>>())?;
    let worst = order.iter().zip(&judged).min_by(|a, b| a.1.total_cmp(b.1));
    let worst = worst.map(|(&(single, _), contrast)| told(single, contrast / drawn_mean - 1.0));
    let pairs: Vec<Vec<Wrong>> = (0..order.len())
        .flat_map(|a| (a + 1..order.len()).map(move |b| [a, b]))
        .map(|pair| pair.map(|k| order[k].0).to_vec())
        .collect();
    let found = run(pairs.iter().map(|pair| case(pair, design.impact.strength())).collect())?;
    let mut best: Vec<usize> = (0..pairs.len()).collect();
    best.sort_by(|&a, &b| found[a].total_cmp(&found[b]));
    let again: Vec<Vec<Wrong>> = best.into_iter().take(PAIRS).map(|k| pairs[k].clone()).collect();
    let judged = over_forces(&again)?;
    let worst_pair = again.iter().zip(&judged).min_by(|a, b| a.1.total_cmp(b.1)).map(|(pair, contrast)| {
        let change = contrast / drawn_mean - 1.0;
        ([told(pair[0], change), told(pair[1], change)], change)
    });
    Ok(Sites { noise, each, worst, worst_pair })
}

/// How many runs that takes.
pub fn sites_runs(workshop: &Workshop) -> usize {
    let Drawing::Plane(_, subject) = workshop.drawing() else { return 0 };
    let others = workshop.drawing().letters().len().saturating_sub(1);
    if others == 0 { 9 } else { 9 + others * places(subject).len() + 8 * (WORST + PAIRS) + WORST * (WORST - 1) / 2 }
}

impl Sites {
    /// As CSV; SI.
    pub fn csv(&self) -> String {
        let mut text = "row,column,x_m,drawn,wrong,contrast_change\n".to_owned();
        for WrongSphere { row, column, x, drawn, wrong, change } in &self.each {
            text += &format!("{row},{column},{x},{drawn},{wrong},{change}\n");
        }
        text
    }

    /// A map of the piece: what one wrong sphere changes in C at each site, in percent.
    pub fn map(&self, design: &Design, subject: Subject<'_>) -> String {
        let mut values = vec![f64::NAN; subject.drawn().len()];
        for (place, sphere) in places(subject).into_iter().zip(&self.each) {
            let place = place % values.len();
            values[place] = 100.0 * sphere.change;
        }
        let within = (&subject.layout.lattice, &design.target);
        site_map("What one wrong sphere does to C", "change of C (%)", within, &subject.drawn(), &values)
    }

    /// In words.
    pub fn words(&self) -> String {
        let one = |sphere: &WrongSphere| {
            format!("{} in place of {} in row {}, column {}", sphere.wrong, sphere.drawn, sphere.row, sphere.column)
        };
        let mut text = String::new();
        if let Some(worst) = &self.worst {
            text +=
                &format!("worst single wrong sphere: {}: C {:+.1} % over 8 forces\n", one(worst), 100.0 * worst.change);
        }
        if let Some((pair, change)) = &self.worst_pair {
            let [a, b] = pair;
            text += &format!("worst pair: {}, and {}: C {:+.1} %\n", one(a), one(b), 100.0 * change);
        }
        let lost = self.each.iter().filter(|sphere| sphere.change < -self.noise).count();
        text + &format!(
            "at {lost} of {} sites one wrong sphere costs more than the scatter of single runs, {:.1} % of C\n",
            self.each.len(),
            100.0 * self.noise
        )
    }
}
