//! Which sites of a study's crystal may change, which of them together, and how they lie to each other.

use super::StudyError;
use super::set::distances;
use super::source::Source;
use crate::design::DesignRef;
use crate::lattice::{Block, Layered};
use crate::lens::Symmetry;
use crate::search::{Adjacency, Space};

/// The keys that say it.
pub(super) struct Keys<'a> {
    pub rows: Option<[u32; 2]>,
    pub layers: Option<[u32; 2]>,
    pub x: Option<&'a [String; 2]>,
    pub r: Option<&'a [String; 2]>,
    pub symmetry: Option<&'a str>,
    pub free_scored: bool,
}

/// In one kind of design what rows are called, and where they are.
fn row(design: DesignRef<'_>) -> &'static str {
    match design {
        DesignRef::Plane(_) => "row",
        DesignRef::Space(_) => "layer",
    }
}

/// The row of every site, in space its layer.
pub(super) fn rows_of(design: DesignRef<'_>) -> Vec<u32> {
    match design {
        DesignRef::Plane(design) => design.lattice.sites().iter().map(|site| site.row).collect(),
        DesignRef::Space(design) => design.lattice.sites().iter().map(|site| site.layer).collect(),
    }
}

/// A site as people name it.
pub(super) fn named(design: DesignRef<'_>, index: usize) -> String {
    let [row, column] = match design {
        DesignRef::Plane(design) => {
            let site = &design.lattice.sites()[index];
            [site.row, site.column]
        }
        DesignRef::Space(design) => {
            let site = &design.lattice.sites()[index];
            [site.layer, site.column]
        }
    };
    format!("{} {row}, column {column}", self::row(design))
}

/// First and last row, in space layer, that are free, none of which is of a scored region unless the file wants it so. Whoever may change the
/// scored spheres can change what counts instead of what happens.
pub(super) fn rows(source: &Source<'_>, keys: &Keys<'_>, design: DesignRef<'_>) -> Result<[u32; 2], StudyError> {
    let (word, last_of_all, given, other) = match design {
        DesignRef::Plane(design) => ("rows", design.lattice.rows(), keys.rows, keys.layers.map(|_| "layers")),
        DesignRef::Space(design) => ("layers", design.lattice.layers(), keys.layers, keys.rows.map(|_| "rows")),
    };
    if let Some(other) = other {
        return Err(source.fail(other, format!("{other} is for the other kind of crystal; this design has {word}.")));
    }
    if let DesignRef::Plane(_) = design
        && let Some(key) = [("r", keys.r.is_some()), ("symmetry", keys.symmetry.is_some())]
            .into_iter()
            .find_map(|(key, given)| given.then_some(key))
    {
        return Err(source.fail(key, format!("{key} is for crystals in space; this design is a sheet.")));
    }
    let Some(rows @ [first, last]) = given else {
        return Err(source.missing(word, format!("{word} is missing: the first and the last of them that are free.")));
    };
    if first < 1 || first > last || last > last_of_all {
        let message =
            format!("{word} = [{first}, {last}] must be the first and the last of some of {word} 1 to {last_of_all}.");
        return Err(source.fail(word, message));
    }
    if let Some(scored) = scored_row(design, rows).filter(|_| !keys.free_scored) {
        let row = row(design);
        let message = format!(
            "{word} = [{first}, {last}] hold {row} {scored} of a scored region: a search then changes the spheres that are scored, and C and G rise for nothing. Leave these {word} out, or write free_scored_{word} = true."
        );
        return Err(source.fail(word, message));
    }
    Ok(rows)
}

fn scored_row(design: DesignRef<'_>, [first, last]: [u32; 2]) -> Option<u32> {
    let regions: Vec<[u32; 2]> = match design {
        DesignRef::Plane(design) => {
            let target = &design.target;
            target.foci.iter().map(|focus| focus.region.rows).chain([target.protect.rows]).collect()
        }
        DesignRef::Space(design) => {
            let (block, target) = (&design.lattice, &design.target);
            let solids = target.foci.iter().map(|focus| &focus.region).chain([&target.protect]);
            solids.map(|solid| solid.layers(block.layer_spacing(), block.layers())).collect()
        }
    };
    regions.into_iter().flat_map(|[from, to]| from..=to).find(|row| (first..=last).contains(row))
}

/// Sites that may change, those that change together in a list, in order of the first of each.
pub(super) fn groups(
    source: &Source<'_>,
    keys: &Keys<'_>,
    design: DesignRef<'_>,
    [first, last]: [u32; 2],
) -> Result<Vec<Vec<usize>>, StudyError> {
    let diameter = design.diameter();
    let range = |key: &str, written: Option<&[String; 2]>| match written {
        None => Ok([0.0, f64::INFINITY]),
        Some(written) => distances(key, written, diameter).map_err(|message| source.fail(key, message)),
    };
    let (x, r) = (range("x", keys.x)?, range("r", keys.r)?);
    let slack = 1e-9 * diameter;
    let within = |[from, to]: [f64; 2], at: f64| (from - slack..=to + slack).contains(&at);
    let rows = rows_of(design);
    let is_free = |&i: &usize| {
        (first..=last).contains(&rows[i])
            && match design {
                DesignRef::Plane(design) => within(x, design.lattice.sites()[i].x),
                DesignRef::Space(design) => {
                    let [a, b, _] = design.lattice.sites()[i].centre;
                    within(x, a) && within(r, a.hypot(b))
                }
            }
    };
    let free: Vec<usize> = (0..rows.len()).filter(is_free).collect();
    if free.is_empty() {
        let message = match design {
            DesignRef::Plane(design) => {
                let edge = design.lattice.half_width() / diameter;
                format!("x holds no sphere of these rows; distances from the axis run from \"0 D\" to \"{edge} D\".")
            }
            DesignRef::Space(design) => {
                let [x, y] = design.lattice.half_widths().map(|edge| (edge / diameter * 1e3).round() / 1e3);
                format!("x and r hold no sphere of these layers; the crystal ends at x = {x} D, r = {} D.", x.hypot(y))
            }
        };
        return Err(source.fail(if keys.r.is_some() { "r" } else { "x" }, message));
    }
    let Some(symmetry) = symmetry(source, keys)? else {
        return Ok(free.into_iter().map(|site| vec![site]).collect());
    };
    let DesignRef::Space(design) = design else { return Ok(Vec::new()) };
    let mut groups: Vec<((u32, i64), Vec<usize>)> = Vec::new();
    let mut place = std::collections::HashMap::new();
    for site in free {
        let alike = (rows[site], alike(&design.lattice, site, symmetry));
        let at = *place.entry(alike).or_insert_with(|| {
            groups.push((alike, Vec::new()));
            groups.len() - 1
        });
        groups[at].1.push(site);
    }
    Ok(groups.into_iter().map(|(_, sites)| sites).collect())
}

/// What spheres of a layer that are alike have in common: twelve times the squared distance from the axis, or twice that from the plane, in
/// diameters.
fn alike(block: &Block, site: usize, symmetry: Symmetry) -> i64 {
    let [x, y] = block.place(site);
    match symmetry {
        Symmetry::Axis => 3 * x * x + y * y,
        Symmetry::Plane => x,
    }
}

/// What changes together; none where every sphere does by itself.
fn symmetry(source: &Source<'_>, keys: &Keys<'_>) -> Result<Option<Symmetry>, StudyError> {
    match keys.symmetry {
        None => Ok(None),
        Some("axis") => Ok(Some(Symmetry::Axis)),
        Some("plane") => Ok(Some(Symmetry::Plane)),
        Some(other) => Err(source.fail(
            "symmetry",
            format!("symmetry = \"{other}\" must be \"axis\", all around the axis alike, or \"plane\", all along y."),
        )),
    }
}

/// What is searched: groups of sites as a [`Space`].
pub(super) fn space(design: DesignRef<'_>, groups: &[Vec<usize>], alphabet: u8) -> Space {
    let design = match design {
        DesignRef::Plane(design) => {
            let sites = design.lattice.sites();
            return Space::sheet(groups.iter().map(|group| [sites[group[0]].row, sites[group[0]].column]), alphabet);
        }
        DesignRef::Space(design) => design,
    };
    let block = &design.lattice;
    let steps = block.beside();
    let mut group_of = vec![None; steps.len()];
    for (k, group) in groups.iter().enumerate() {
        group.iter().for_each(|&site| group_of[site] = Some(k));
    }
    let to = |site: usize| steps[site].iter().map(|step| step.and_then(|to| group_of[to])).collect::<Vec<_>>();
    if groups.iter().all(|group| group.len() == 1) {
        let sites = groups.iter().map(|group| block.coordinates(group[0])).collect();
        let beside = groups.iter().map(|group| to(group[0])).collect();
        return Space { sites, alphabet, adjacency: Some(Adjacency { axis: block.cells()[1], beside }) };
    }
    // Around the axis or along y all is one: a place is a layer and a distance.
    let along = |group: &Vec<usize>| group.iter().any(|&site| block.place(site)[0] != block.place(group[0])[0]);
    let around = groups.iter().any(along);
    let place = |group: &Vec<usize>| {
        let [x, y] = block.place(group[0]);
        let diameters = if around { ((3 * x * x + y * y) as f64 / 12.0).sqrt() } else { 0.5 * x as f64 };
        [block.sites()[group[0]].layer, diameters.round() as u32, 0]
    };
    let beside = groups.iter().enumerate().map(|(k, group)| {
        let mut others: Vec<usize> = group.iter().flat_map(|&site| to(site)).flatten().filter(|&j| j != k).collect();
        others.sort_unstable();
        others.dedup();
        others.into_iter().map(Some).collect()
    });
    let (sites, beside) = (groups.iter().map(place).collect(), beside.collect());
    Space { sites, alphabet, adjacency: Some(Adjacency { axis: 0, beside }) }
}
