//! Maps of what every sphere felt: greatest kinetic energy, dissipation, greatest force.

use super::colour::{Scale, round_up};
use super::crystal::{Crystal, Extent};
use super::summary::{CONTRAST, FOCAL, Line, PROTECTED};
use super::svg::{Anchor, Svg};
use crate::evaluate::Swaps;
use crate::outcome::{ArrangementOutcome, Outcome};

/// Lines between materials in a map, and rays: white within dark, to be seen on either end of the colours.
pub const SITES: [&str; 2] = [
    r##"stroke="#000" stroke-width="1.5" stroke-opacity="0.25""##,
    r##"stroke="#fff" stroke-width="0.7" stroke-opacity="0.75""##,
];
const RAYS: [&str; 2] = [
    r##"stroke="#000" stroke-width="2.4" stroke-opacity="0.3""##,
    r##"stroke="#fff" stroke-width="1" stroke-opacity="0.9""##,
];
/// Room for a colour bar with ticks and label (px).
pub const BAR: f64 = 96.0;
/// Room for row numbers and their label (px).
pub const ROWS: f64 = 46.0;

/// The finite value of a site in a list that may be short.
pub fn at(list: &[f64], index: usize) -> Option<f64> {
    list.get(index).copied().filter(|v| v.is_finite())
}

/// The finite value of a site, the mean of a sphere and its image where a list holds both, those of the sites' images behind those of the
/// `sites` sites.
pub fn mean_at(list: &[f64], index: usize, sites: usize) -> Option<f64> {
    let own = at(list, index)?;
    match at(list, sites + index) {
        Some(image) => Some(0.5 * (own + image)),
        None => Some(own),
    }
}

/// The row of each number of a list, of sites or of sites and then of their images.
fn row_of(outcome: &Outcome, index: usize) -> u32 {
    outcome.sites[index % outcome.sites.len()].row
}

/// The first row behind every sphere that is not of the host, in the outcome's first arrangement; row 1 where the lens
/// reaches the end of the crystal or there is none.
pub fn first_row_behind(outcome: &Outcome) -> u32 {
    let last = outcome.sites.iter().map(|s| s.row).max().unwrap_or(1);
    let lens = outcome.arrangements.first().map_or(&[][..], |lens| &lens.layout[..]);
    let back = (0..lens.len()).filter(|&k| lens[k] != 0).map(|k| row_of(outcome, k)).max().unwrap_or(0);
    if back + 5 > last { 1 } else { back + 1 }
}

/// The arrangements that maps and profiles show: one of each kind, of the random ones that with the first seed.
pub fn one_of_each_kind(outcome: &Outcome) -> Vec<&ArrangementOutcome> {
    let mut shown: Vec<&ArrangementOutcome> = Vec::new();
    for arrangement in &outcome.arrangements {
        if !shown.iter().any(|other| other.kind == arrangement.kind) {
            shown.push(arrangement);
        }
    }
    shown
}

/// The colour scale of all kinetic-energy maps: linear from zero, ending where all but one in a hundred values behind the
/// lens are below. In front of the lens energies are ten times larger and say little about focusing.
pub fn kinetic_scale(outcome: &Outcome) -> Scale {
    let behind = first_row_behind(outcome);
    let mut values: Vec<f64> = Vec::new();
    for arrangement in one_of_each_kind(outcome) {
        let list = &arrangement.record.max_kinetic;
        let places = (0..list.len()).filter(|&index| row_of(outcome, index) >= behind);
        values.extend(places.filter_map(|index| at(list, index)));
    }
    values.sort_by(f64::total_cmp);
    let high = values.get((values.len() * 99) / 100).copied().unwrap_or(0.0);
    // Rounded up to two digits, so that the bar ends near a number one can say.
    let step = round_up(high / 20.0);
    Scale::linear((high / step).ceil() * step)
}

/// Greatest kinetic energy of every sphere, one map per kind of arrangement, all on one colour scale.
pub fn kinetic(outcome: &Outcome) -> String {
    const ROOM: [f64; 2] = [128.0, 420.0];
    const TOP: f64 = 52.0;
    const BELOW: f64 = 46.0;
    const PER_LINE: usize = 7;
    let shown = one_of_each_kind(outcome);
    let scale = kinetic_scale(outcome);
    // The half says all, but of a piece whose halves differ.
    let halves_differ = shown.iter().any(|a| a.layout.len() > outcome.sites.len());
    let (extent, room) = if halves_differ { (Extent::Both, [2.0 * ROOM[0], ROOM[1]]) } else { (Extent::Half, ROOM) };
    let per_line = if halves_differ { PER_LINE / 2 } else { PER_LINE };
    let [width, height] = Crystal::new(outcome, extent, [0.0, 0.0], room).size();
    // Names and numbers need more than a very narrow crystal.
    let (column, inset) = (width.max(112.0) + 12.0, (112.0 - width).max(0.0) / 2.0);
    let line = TOP + height + BELOW;
    let lines = shown.len().div_ceil(per_line).max(1);
    let full = ROWS + column * shown.len().clamp(1, per_line) as f64 + BAR;
    let title = format!("{}: greatest kinetic energy of every sphere, by arrangement", outcome.manifest.name);
    let mut svg = Svg::new(full, line * lines as f64, &title);
    for (k, arrangement) in shown.iter().enumerate() {
        let corner = [ROWS + column * (k % per_line) as f64 + inset, TOP + line * (k / per_line) as f64];
        let crystal = Crystal::new(outcome, extent, corner, room);
        let middle = corner[0] + width / 2.0;
        svg.text([middle, corner[1] - 24.0], 13.0, Anchor::Middle, r#"font-weight="bold""#, &arrangement.kind);
        if let Some(seed) = arrangement.seed {
            svg.text([middle, corner[1] - 9.0], 11.0, Anchor::Middle, "", &format!("seed {seed}"));
        }
        let list = &arrangement.record.max_kinetic[..];
        crystal.map(&mut svg, &scale, list.len(), |index| at(list, index));
        for line in SITES {
            crystal.boundaries(&mut svg, &arrangement.layout, line);
        }
        crystal.regions(&mut svg, 1.4);
        if k % per_line == 0 {
            crystal.row_numbers(&mut svg, 11.0);
            svg.text_upwards([14.0, corner[1] + height / 2.0], 12.0, "", "row");
        }
        let line = Line { name: &arrangement.name, members: vec![arrangement] };
        let energies = format!("F {}, P {} J", line.show(&FOCAL), line.show(&PROTECTED));
        svg.text([middle, corner[1] + height + 17.0], 11.0, Anchor::Middle, "", &energies);
        let contrast = format!("F/P {}", line.show(&CONTRAST));
        svg.text([middle, corner[1] + height + 33.0], 11.0, Anchor::Middle, "", &contrast);
    }
    let lists = shown.iter().map(|a| &a.record.max_kinetic[..]);
    let right = full - BAR + 16.0;
    scale.bar(&mut svg, [right, TOP], height, "greatest kinetic energy (J)", 1.0, [above(&scale, lists), false]);
    svg.finish()
}

/// The first arrangement's greatest kinetic energies, both halves: as they are, with the rays that proposed it, and over the mean of their
/// row, which takes the decay with depth away and tells the regions apart.
pub fn kinetic_lens(outcome: &Outcome, lens: &ArrangementOutcome) -> String {
    let list = &lens.record.max_kinetic[..];
    let absolute = kinetic_scale(outcome);
    let share = over_row_mean(outcome, list);
    let (low, high) = (-1.0, 1.5);
    let beyond = |limit: f64, above: bool| {
        let mut shares = (0..list.len()).filter_map(&share);
        shares.any(|value| if above { value > limit } else { value < limit })
    };
    let title = format!("{}: greatest kinetic energy of every sphere and rays", outcome.manifest.name);
    let first = Panel {
        heading: &lens.name,
        scale: absolute,
        label: "greatest kinetic energy (J)",
        unit: 1.0,
        arrangement: lens,
        with_rays: true,
    };
    let second = Panel {
        heading: "over the mean of its row",
        scale: Scale::diverging(low, high),
        label: "over the mean of its row, less 1",
        unit: 1.0,
        arrangement: lens,
        with_rays: false,
    };
    let ends = [above(&absolute, [list]), false];
    let shares = [beyond(high, true), beyond(low, false)];
    let shown: [(Panel, Values, [bool; 2]); 2] =
        [(first, Box::new(|index| at(list, index)), ends), (second, Box::new(&share), shares)];
    panels(outcome, &title, [420.0, 640.0], shown)
}

/// The value of a site over the mean of its row, less 1; none in a row that the wave has not reached.
fn over_row_mean<'a>(outcome: &'a Outcome, list: &'a [f64]) -> impl Fn(usize) -> Option<f64> + 'a {
    let rows = outcome.sites.iter().map(|s| s.row).max().unwrap_or(0) as usize;
    let (mut sums, mut weights) = (vec![0.0; rows + 1], vec![0.0; rows + 1]);
    for index in 0..list.len().max(outcome.sites.len()) {
        let site = &outcome.sites[index % outcome.sites.len()];
        // Spheres on a mirror line stand for half a one.
        let slack = 1e-9 * outcome.diameter;
        let on_line = site.x < slack || site.x > outcome.half_width - slack;
        let weight = if on_line { 0.5 } else { 1.0 };
        sums[site.row as usize] += weight * at(list, index).unwrap_or(0.0);
        weights[site.row as usize] += weight;
    }
    let most = list.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
    move |index| {
        let row = row_of(outcome, index) as usize;
        let mean = sums[row] / weights[row];
        at(list, index).filter(|_| mean > 1e-6 * most).map(|value| value / mean - 1.0)
    }
}

/// Energy dissipated per sphere, in the lens and, where there is one, in the crystal without a lens; logarithmic.
pub fn dissipation(outcome: &Outcome, lens: &ArrangementOutcome) -> String {
    let host = outcome.arrangements.iter().find(|a| a.kind == "all-host" && a.name != lens.name);
    let shown: Vec<_> = std::iter::once(lens).chain(host).collect();
    let scale = Scale::logarithmic(shown.iter().flat_map(|a| &a.record.dissipated).copied());
    let title = format!("{}: energy dissipated at every sphere", outcome.manifest.name);
    let all = shown.iter().map(|a| {
        let list = &a.record.dissipated[..];
        let label = "dissipated energy per sphere (mJ)";
        let panel = Panel { heading: a.name.as_str(), scale, label, unit: 1e-3, arrangement: a, with_rays: false };
        (panel, Box::new(move |index| at(list, index)) as Values, [false, below(&scale, list)])
    });
    panels(outcome, &title, [392.0, 620.0], all)
}

/// Greatest net force on every sphere of the lens: as it is (logarithmic), and over the greatest of its row, which takes
/// the decay with depth away and leaves the focusing.
pub fn forces(outcome: &Outcome, lens: &ArrangementOutcome) -> String {
    let list = &lens.record.max_net_force[..];
    let high = list.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
    let absolute = Scale::logarithmic(list.iter().copied());
    let rows = outcome.sites.iter().map(|s| s.row).max().unwrap_or(0) as usize;
    let mut greatest = vec![0.0_f64; rows + 1];
    for index in 0..list.len() {
        let row = row_of(outcome, index) as usize;
        greatest[row] = greatest[row].max(at(list, index).unwrap_or(0.0));
    }
    let share = move |index: usize| {
        let greatest = greatest[row_of(outcome, index) as usize];
        // A row that the wave has not reached has nothing to be a share of.
        at(list, index).filter(|_| greatest > 1e-6 * high).map(|force| force / greatest)
    };
    let title = format!("{}: greatest net force on every sphere", outcome.manifest.name);
    let first = Panel {
        heading: "as it is",
        scale: absolute,
        label: "greatest net force (kN)",
        unit: 1e3,
        arrangement: lens,
        with_rays: false,
    };
    let second = Panel {
        heading: "over the greatest of its row",
        scale: Scale::linear(1.0),
        label: "share of the row's greatest net force",
        unit: 1.0,
        arrangement: lens,
        with_rays: false,
    };
    let shown: [(Panel, Values, [bool; 2]); 2] = [
        (first, Box::new(|index| at(list, index)), [false, below(&absolute, list)]),
        (second, Box::new(share), [false, false]),
    ];
    panels(outcome, &title, [392.0, 620.0], shown)
}

/// What the best exchange of each sphere does to C, both signs equally strong.
pub fn swaps(outcome: &Outcome, lens: &ArrangementOutcome, swaps: &Swaps) -> String {
    let changes: Vec<f64> = swaps.each.iter().map(|swap| swap.change.unwrap_or(f64::NAN)).collect();
    let most = changes.iter().copied().filter(|c| c.is_finite()).fold(1e-9_f64, |most, c| most.max(c.abs()));
    let title = format!("{}: what exchanging a sphere does to C", outcome.manifest.name);
    let panel = Panel {
        heading: "one sphere exchanged, in both halves",
        scale: Scale::diverging(-most, most),
        label: "change of C (%)",
        unit: 0.01,
        arrangement: lens,
        with_rays: false,
    };
    panels(outcome, &title, [560.0, 760.0], [(panel, Box::new(|index| at(&changes, index)) as Values, [false, false])])
}

/// Whether a value in the lists lies above the scale.
fn above<'a>(scale: &Scale, lists: impl IntoIterator<Item = &'a [f64]>) -> bool {
    lists.into_iter().flatten().any(|&v| v > scale.high())
}

pub fn below(scale: &Scale, list: &[f64]) -> bool {
    list.iter().any(|&v| v < scale.low())
}

pub(super) type Values<'a> = Box<dyn Fn(usize) -> Option<f64> + 'a>;

/// One large map.
pub(super) struct Panel<'a> {
    pub heading: &'a str,
    pub scale: Scale,
    pub label: &'a str,
    /// What one unit of the label is in SI.
    pub unit: f64,
    pub arrangement: &'a ArrangementOutcome,
    /// Whether the rays and faces that proposed it are drawn over it.
    pub with_rays: bool,
}

/// Large maps of both halves side by side, each with its colour bar.
fn panels<'a>(
    outcome: &'a Outcome,
    title: &str,
    room: [f64; 2],
    shown: impl IntoIterator<Item = (Panel<'a>, Values<'a>, [bool; 2])>,
) -> String {
    panels_of(outcome, title, (Extent::Both, room), shown, None)
}

/// Spheres that bear a mark, and what it says.
pub(super) struct Marks<'a> {
    pub on: &'a [bool],
    /// Line by line; the mark stands before the first.
    pub words: [&'a str; 2],
}

/// The same of the half or of both, with marks.
pub(super) fn panels_of<'a>(
    outcome: &'a Outcome,
    title: &str,
    (extent, room): (Extent, [f64; 2]),
    shown: impl IntoIterator<Item = (Panel<'a>, Values<'a>, [bool; 2])>,
    marks: Option<Marks<'a>>,
) -> String {
    const TOP: f64 = 36.0;
    let shown: Vec<_> = shown.into_iter().collect();
    let [width, height] = Crystal::new(outcome, extent, [0.0, 0.0], room).size();
    let column = ROWS + width + BAR;
    let below = if marks.is_some() { 56.0 } else { 20.0 };
    let mut svg = Svg::new(column * shown.len() as f64, TOP + height + below, title);
    for (k, (panel, value, beyond)) in shown.iter().enumerate() {
        let left = column * k as f64;
        let corner = [left + ROWS, TOP];
        let crystal = Crystal::new(outcome, extent, corner, room);
        svg.text([corner[0] + width / 2.0, 20.0], 14.0, Anchor::Middle, r#"font-weight="bold""#, panel.heading);
        crystal.map(&mut svg, &panel.scale, panel.arrangement.layout.len(), value);
        for line in SITES {
            crystal.boundaries(&mut svg, &panel.arrangement.layout, line);
        }
        if let (true, Some(proposal)) = (panel.with_rays, &outcome.proposal) {
            for line in RAYS {
                crystal.rays(&mut svg, proposal, line);
            }
            crystal.faces(&mut svg, proposal, r##"stroke="#111" stroke-width="2.5" stroke-linecap="round""##);
        }
        crystal.regions(&mut svg, 2.0);
        if k == 0 {
            crystal.name_regions(&mut svg, 12.0);
        }
        crystal.row_numbers(&mut svg, 11.0);
        svg.text_upwards([left + 14.0, TOP + height / 2.0], 12.0, "", "row");
        let bar = [corner[0] + width + 14.0, TOP + 12.0];
        panel.scale.bar(&mut svg, bar, height - 24.0, panel.label, panel.unit, *beyond);
        if let Some(Marks { on, .. }) = &marks {
            let places = (0..on.len()).filter(|&site| on[site]).flat_map(|site| crystal.places(site, on.len()));
            places.for_each(|place| mark(&mut svg, place, crystal.diameter()));
        }
    }
    if let Some(Marks { words, .. }) = marks {
        let line = TOP + height + 28.0;
        mark(&mut svg, [ROWS + 4.0, line - 4.0], 16.0);
        for (words, line) in words.into_iter().zip([line, line + 17.0]) {
            svg.text([ROWS + 14.0, line], 12.0, Anchor::Start, "", words);
        }
    }
    svg.finish()
}

/// A dot on a sphere, to be seen on every colour.
fn mark(svg: &mut Svg, place: [f64; 2], diameter: f64) {
    svg.circle(place, 0.17 * diameter, r##"fill="#111" stroke="#fff" stroke-width="0.6""##);
}
