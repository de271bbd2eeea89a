//! `granulens surface`: which speed which materials give, as a picture, as a table, and asked the other way round.

mod tables;

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use granulens::design::Shelf;
use granulens::material::{Material, MaterialError, library};
use granulens::report::{self, Look, Provenance};
use granulens::units::Dimension as Unit;
use granulens::wave::{self, Axis, Kind, Medium, Point, Setting, Surface as Grid, Value};

use super::console::{emit_json, note};
use super::failure::Failure;
use super::folder::{probe_all, write_file};
use super::picture::{KINDS, Paper, ends_in, write_picture};
use super::{Common, Crystal, command_line};
use tables::{grid_json, list};

const AXES: [&str; 7] = ["stiffness", "density", "yield-stress", "modulus", "radius", "amplitude", "dimension"];

/// Grid lines along each axis of a picture.
pub const GRID: [usize; 2] = [97, 73];

/// Draw the wave speed, or what goes with it, over design variables, or find the materials that give a speed
///
/// With --out FILE.svg, the surface is drawn with the materials, their dimers and engineered spheres on it, and the numbers
/// behind it go to FILE.csv; --out FILE.html makes it a page that shows the numbers under the pointer. Without, the media are
/// listed. What is found is listed lightest first or, with --sort price and prices in the file of --materials, cheapest
/// first.
#[derive(clap::Args)]
pub struct Surface {
    /// What is shown; ratios, impedances and angles are against --against
    #[arg(long, value_name = "VALUE", default_value = "speed")]
    #[arg(value_parser = PossibleValuesParser::new(Value::ALL.map(Value::name)))]
    value: String,
    /// Material that ratios and critical angles are against [default: that of --material]
    #[arg(long, value_name = "NAME")]
    against: Option<String>,
    /// What is along x [default: stiffness; of plastic-force and dissipation, which no stiffness fixes, yield-stress]
    #[arg(long, value_name = "AXIS", value_parser = axis_names())]
    x: Option<String>,
    /// What is along y [default: density; of plastic-force and dissipation modulus]
    #[arg(long, value_name = "AXIS", value_parser = axis_names())]
    y: Option<String>,
    /// Range of x, such as "10 MN/m..100 MN/m"; without, what the media span
    #[arg(long, value_name = "FROM..TO", allow_hyphen_values = true)]
    x_range: Option<String>,
    /// Range of y
    #[arg(long, value_name = "FROM..TO", allow_hyphen_values = true)]
    y_range: Option<String>,
    /// Material with the values of the variables not shown
    #[arg(long, value_name = "NAME", default_value = "440c")]
    material: String,
    /// Density, where not shown, in place of the material's
    #[arg(long, value_name = "DENSITY", allow_hyphen_values = true)]
    density: Option<String>,
    /// Yield stress, where not shown
    #[arg(long, value_name = "STRESS", allow_hyphen_values = true)]
    yield_stress: Option<String>,
    /// Young's modulus, where not shown
    #[arg(long, value_name = "MODULUS", allow_hyphen_values = true)]
    modulus: Option<String>,
    /// Stiffness of the plastic contact, such as "30 MN/m", in place of that of yield stress and modulus
    #[arg(long, value_name = "STIFFNESS", allow_hyphen_values = true)]
    stiffness: Option<String>,
    /// Contact force in F_p, from 0.35: speeds are then those to be expected, to 1 %, not the bound
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["ratios", "find_speed", "find_ratio"])]
    amplitude: Option<f64>,
    #[command(flatten)]
    crystal: Crystal,
    /// Coated spheres, such as al:5:wc: aluminium on tungsten carbide, five times the density of aluminium; "wc" in place of
    /// the 5 is the limit of a thin shell
    #[arg(long, value_name = "SHELL:FACTOR:CORE")]
    coated: Vec<String>,
    /// Hollow spheres, such as wc:0.2: tungsten carbide of a fifth of its density
    #[arg(long, value_name = "NAME:FACTOR")]
    hollow: Vec<String>,
    /// List every two materials side by side: speed ratio, critical angle, impedance ratio, F_p
    #[arg(long, conflicts_with_all = ["find_speed", "find_ratio"])]
    ratios: bool,
    /// File with own materials, [materials.NAME], and prices, [prices], alone or in a design, which are taken too
    #[arg(long, value_name = "FILE")]
    materials: Option<PathBuf>,
    /// In what order what is found is listed: by weight, or by the price of a sphere, which needs prices
    #[arg(long, value_name = "ORDER", default_value = "weight")]
    #[arg(value_parser = PossibleValuesParser::new(["weight", "price"]))]
    sort: String,
    /// List the media of this wave-speed bound, lightest first
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true, conflicts_with = "find_ratio")]
    find_speed: Option<String>,
    /// List the pairs of this speed ratio (faster over slower), lightest first
    #[arg(long, value_name = "RATIO", allow_hyphen_values = true)]
    find_ratio: Option<f64>,
    /// Pairs of dimers too
    #[arg(long)]
    dimers: bool,
    /// Draw and list no dimers
    #[arg(long, conflicts_with = "dimers")]
    no_dimers: bool,
    /// Draw and list these media alone, such as 440c,brass,440c+brass
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Name these media alone on the picture; the others are markers
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    label: Vec<String>,
    #[command(flatten)]
    paper: Paper,
    /// How far off a speed or ratio may be
    #[arg(long, value_name = "PERCENT", default_value = "2 %", allow_hyphen_values = true)]
    tolerance: String,
}

fn axis_names() -> PossibleValuesParser {
    PossibleValuesParser::new(AXES)
}

/// The axis of that name, which the parser knows.
fn axis(name: &str) -> Axis {
    Axis::ALL.into_iter().find(|axis| axis.name() == name).unwrap_or(Axis::Density)
}

fn unit(axis: Axis) -> Option<Unit> {
    match axis {
        Axis::Stiffness => Some(Unit::Stiffness),
        Axis::Density => Some(Unit::Density),
        Axis::YieldStress | Axis::Modulus => Some(Unit::Pressure),
        Axis::Radius => Some(Unit::Length),
        Axis::Amplitude | Axis::Dimension => None,
    }
}

/// A positive quantity of an option.
fn quantity(option: &str, unit: Option<Unit>, text: &str) -> Result<f64, Failure> {
    let value = match unit {
        Some(unit) => unit.parse(text).map_err(|error| Failure::input(format!("--{option}: {error}")))?,
        None => text.trim().parse().map_err(|_| Failure::input(format!("--{option}: \"{text}\" is not a number")))?,
    };
    positive(option, value)
}

fn positive(option: &str, value: f64) -> Result<f64, Failure> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Failure::input(format!("--{option} must be positive and finite, not {value} (SI)")))
    }
}

/// The mean price of a medium's spheres; none of engineered ones, which nobody sells, and where a price is missing.
fn price(shelf: &Shelf, medium: &Medium) -> Option<f64> {
    let [a, b] = medium.materials.each_ref().map(|material| shelf.prices.get(&material.name));
    if medium.kind == Kind::Engineered { None } else { Some(0.5 * (a? + b?)) }
}

/// What has no price comes last, as it stood.
fn cheapest_first<T>(list: &mut [T], price: impl Fn(&T) -> Option<f64>) {
    list.sort_by(|a, b| price(a).unwrap_or(f64::INFINITY).total_cmp(&price(b).unwrap_or(f64::INFINITY)));
}

/// What repeats a surface.
fn provenance(setting: &Setting) -> Provenance {
    let mut provenance = Provenance::new(command_line(), String::new(), String::new())
        .with("granulens", format!("{}, commit {}", granulens::outcome::VERSION, granulens::outcome::COMMIT))
        .with("Fitted constants", setting.constants.name())
        .with("Diameter", Unit::Length.show(setting.diameter));
    if let Some(amplitude) = setting.amplitude {
        provenance = provenance.with("Force of a contact", format!("{amplitude} F_p"));
    }
    provenance
}

impl Surface {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let shelf = self.materials.as_ref().map(Shelf::read).transpose()?.unwrap_or_default();
        let setting = self.setting(&shelf)?;
        let media = self.media(&shelf)?;
        if self.sort == "price" && shelf.prices.is_empty() {
            return Err(Failure::input_with_help(
                "--sort price: there are no prices",
                "Name a design file with a section [prices], such as brass-260 = 0.35 for one sphere, by --materials.",
            ));
        }
        if self.ratios || self.find_ratio.is_some() {
            return self.pairs(common, &media, &setting, &shelf);
        }
        if let Some(wanted) = &self.find_speed {
            let speed = quantity("find-speed", Some(Unit::Speed), wanted)?;
            let tolerance = quantity("tolerance", Some(Unit::Fraction), &self.tolerance)?;
            let found = wave::find_speed(&media, speed, tolerance, setting.dimension, setting.constants);
            let mut found: Vec<Medium> = found.into_iter().map(|k| media[k].clone()).collect();
            if self.sort == "price" {
                cheapest_first(&mut found, |medium| price(&shelf, medium));
            }
            if found.is_empty() {
                note(common, &format!("no medium gives {wanted} within {}; widen --tolerance", self.tolerance));
            }
            return list(common, &found, &setting, &shelf);
        }
        let Some(out) = &common.out else {
            list(common, &media, &setting, &shelf)?;
            note(common, "draw the surface with --out FILE.svg");
            return Ok(());
        };
        if !(ends_in(out, "html") || KINDS.iter().any(|kind| ends_in(out, kind))) {
            return Err(Failure::input_with_help(
                format!("--out {}: the surface is drawn as SVG, PDF or PNG, or as a page", out.display()),
                "Let the name end in .svg, .pdf, .png or .html; the numbers go to a .csv beside it.",
            ));
        }
        let look = Look { labelled: self.labelled(&media)?, ..self.paper.look() };
        let table = out.with_extension("csv");
        probe_all(common, &[Some(out), Some(&table)])?;
        let (grid, points) = self.grid(&media, &setting)?;
        match ends_in(out, "html") {
            true => write_file(common, out, &report::surface_page(&grid, &points, provenance(&setting)))?,
            false => write_picture(common, out, &report::surface(&grid, &points, &look))?,
        }
        write_file(common, &table, &report::surface_csv(&grid, &points))?;
        if common.json {
            emit_json(&grid_json(&grid, &points));
        }
        note(common, &format!("surface: {}, numbers: {}", out.display(), table.display()));
        Ok(())
    }

    fn value(&self) -> Value {
        Value::ALL.into_iter().find(|value| value.name() == self.value).unwrap_or_default()
    }

    /// What is along x and y. Beside an axis that is given stands that of the value's own which goes with it.
    fn axes(&self) -> [Axis; 2] {
        let own = self.value().axes();
        let beside = |given: Axis, usual: Axis| {
            let other = if own[0] == usual { own[1] } else { own[0] };
            let follows = |a: Axis, b: Axis| a == Axis::Stiffness && matches!(b, Axis::YieldStress | Axis::Modulus);
            if usual == given || follows(usual, given) || follows(given, usual) { other } else { usual }
        };
        match [&self.x, &self.y].map(|name| name.as_deref().map(axis)) {
            [Some(x), Some(y)] => [x, y],
            [Some(x), None] => [x, beside(x, own[1])],
            [None, Some(y)] => [beside(y, own[0]), y],
            [None, None] => own,
        }
    }

    /// The variables that are not shown.
    fn setting(&self, shelf: &Shelf) -> Result<Setting, Failure> {
        let mut material = shelf.find(&self.material)?;
        let axes = self.axes();
        let given = |option: &str, axis: Axis, text: &Option<String>| {
            if text.is_some() && axes.contains(&axis) {
                return Err(Failure::input(format!("--{option} is given, and is an axis too: leave one of them out")));
            }
            text.as_ref().map(|text| quantity(option, unit(axis), text)).transpose()
        };
        let density = given("density", Axis::Density, &self.density)?;
        let yield_stress = given("yield-stress", Axis::YieldStress, &self.yield_stress)?;
        let modulus = given("modulus", Axis::Modulus, &self.modulus)?;
        let stiffness = given("stiffness", Axis::Stiffness, &self.stiffness)?;
        material.density = density.unwrap_or(material.density);
        material.yield_stress = yield_stress.unwrap_or(material.yield_stress);
        material.youngs_modulus = modulus.unwrap_or(material.youngs_modulus);
        if yield_stress.is_some() || modulus.is_some() {
            let shown = |axis: Axis| axes.contains(&axis);
            if stiffness.is_some() || shown(Axis::Stiffness) {
                return Err(Failure::input_with_help(
                    "the stiffness follows from yield stress and modulus, so they cannot be given beside it",
                    "Leave out --stiffness or the axis, or --yield-stress and --modulus.",
                ));
            }
            if !shown(Axis::YieldStress) && !shown(Axis::Modulus) {
                material.check().map_err(|error: MaterialError| Failure::input(error.to_string()))?;
            }
        }
        if let Some(amplitude) = self.amplitude
            && !(amplitude >= wave::AMPLITUDES[0] && amplitude.is_finite())
        {
            return Err(Failure::input_with_help(
                format!(
                    "--amplitude {amplitude}: below {} F_p contacts stay mostly elastic and the bound does not apply",
                    wave::AMPLITUDES[0]
                ),
                "Give the contact force as a multiple of F_p, from 0.35.",
            ));
        }
        let value = self.value();
        let against = self.against.as_deref().unwrap_or(&self.material);
        Ok(Setting {
            value,
            against: Some(Medium::uniform(&shelf.find(against)?)),
            material,
            stiffness,
            dimension: self.crystal.dimension(),
            amplitude: self.amplitude,
            diameter: self.crystal.diameter,
            constants: self.crystal.constants,
        })
    }

    /// The library's materials and dimers, and the engineered spheres asked for: without any, the published ones.
    fn media(&self, shelf: &Shelf) -> Result<Vec<Medium>, Failure> {
        let materials: Vec<Material> = library().into_iter().chain(shelf.own.iter().cloned()).collect();
        let mut media = Medium::all(&materials);
        if self.coated.is_empty() && self.hollow.is_empty() {
            media.extend(Medium::published_engineered(&materials));
        }
        if self.no_dimers {
            media.retain(|medium| medium.kind != Kind::Dimer);
        }
        let only = self.names("only", &self.only, &media)?;
        if !only.is_empty() {
            media.retain(|medium| only.contains(&medium.label));
        }
        for text in &self.coated {
            let parts: Vec<&str> = text.split(':').map(str::trim).collect();
            let [shell, density, core] = parts[..] else {
                return Err(Failure::input(format!(
                    "--coated \"{text}\": expected SHELL:FACTOR:CORE, such as al:5:wc"
                )));
            };
            let (shell, core): (Material, Material) = (shelf.find(shell)?, shelf.find(core)?);
            let density = match density.parse::<f64>() {
                Ok(factor) => factor * shell.density,
                Err(_) => {
                    shelf
                        .find(density)
                        .map_err(|_| {
                            Failure::input(format!(
                                "--coated \"{text}\": \"{density}\" is neither a factor nor a material"
                            ))
                        })?
                        .density
                }
            };
            let medium = Medium::coated(&shell, &core, density);
            media.push(medium.map_err(|error| Failure::input(format!("--coated \"{text}\": {error}")))?);
        }
        for text in &self.hollow {
            let fail = || Failure::input(format!("--hollow \"{text}\": expected NAME:FACTOR, such as wc:0.2"));
            let (name, factor) = text.split_once(':').ok_or_else(fail)?;
            let factor: f64 = factor.trim().parse().map_err(|_| fail())?;
            let medium = Medium::hollow(&shelf.find(name.trim())?, factor);
            media.push(medium.map_err(|error| Failure::input(format!("--hollow \"{text}\": {error}")))?);
        }
        Ok(media)
    }

    /// The media whose names are written; all where none are asked for.
    fn labelled(&self, media: &[Medium]) -> Result<Option<Vec<String>>, Failure> {
        let names = self.names("label", &self.label, media)?;
        Ok(Some(names).filter(|names| !names.is_empty()))
    }

    /// Names of media as labels have them: `440c`, `440c+brass` in either order, or a material by any of its names.
    fn names(&self, option: &str, given: &[String], media: &[Medium]) -> Result<Vec<String>, Failure> {
        let shelf = self.materials.as_ref().map(Shelf::read).transpose()?.unwrap_or_default();
        let known = |name: &String| {
            let turned = name.split_once('+').map(|(a, b)| format!("{b}+{a}"));
            let alone = shelf.find(name).ok().map(|material| Medium::uniform(&material).label);
            let found = media.iter().find(|medium| {
                [Some(name), turned.as_ref(), alone.as_ref()].into_iter().flatten().any(|name| *name == medium.label)
            });
            found.map(|medium| medium.label.clone()).ok_or_else(|| {
                let known: Vec<&str> = media.iter().map(|medium| medium.label.as_str()).collect();
                Failure::input_with_help(
                    format!("--{option} {name}: no medium of this name is there"),
                    format!("There are {}.", known.join(", ")),
                )
            })
        };
        given.iter().map(known).collect()
    }

    fn grid(&self, media: &[Medium], setting: &Setting) -> Result<(Grid, Vec<Point>), Failure> {
        let axes = self.axes();
        let points = wave::points(media, axes, setting);
        let range = |k: usize, option: &str, text: &Option<String>| -> Result<[f64; 2], Failure> {
            if let Some(text) = text {
                let (from, to) = text.split_once("..").ok_or_else(|| {
                    Failure::input(format!("--{option} \"{text}\": expected FROM..TO, each with its unit"))
                })?;
                return Ok([quantity(option, unit(axes[k]), from)?, quantity(option, unit(axes[k]), to)?]);
            }
            match axes[k] {
                Axis::Amplitude => return Ok(wave::AMPLITUDES),
                // From an eighth to eight times the diameter.
                Axis::Radius => return Ok([setting.diameter / 16.0, 4.0 * setting.diameter]),
                _ => {}
            }
            // A margin in which labels find room.
            let places = points.iter().map(|point| point.place[k]);
            let [low, high] = places.fold([f64::INFINITY, 0.0], |[l, h], p| [f64::min(l, p), f64::max(h, p)]);
            Ok([low / 1.25, high * 1.25])
        };
        let ranges = [range(0, "x-range", &self.x_range)?, range(1, "y-range", &self.y_range)?];
        let grid = Grid::new(axes, ranges, GRID, setting).map_err(|error| Failure::input(error.to_string()))?;
        if grid.range().is_none() {
            return Err(Failure::input_with_help(
                "nothing can be said anywhere on this surface",
                "The yield stress must be below a tenth of the modulus, where the contact law's fit ends.",
            ));
        }
        Ok((grid, points))
    }

    fn pairs(&self, common: &Common, media: &[Medium], setting: &Setting, shelf: &Shelf) -> Result<(), Failure> {
        let asked = !self.coated.is_empty() || !self.hollow.is_empty();
        let chosen: Vec<Medium> = media
            .iter()
            .filter(|medium| match medium.kind {
                Kind::Uniform => true,
                Kind::Dimer => self.dimers,
                Kind::Engineered => asked,
            })
            .cloned()
            .collect();
        let mut pairs = wave::interfaces(&chosen, setting.dimension, setting.diameter, setting.constants);
        if let Some(ratio) = self.find_ratio {
            if !(ratio >= 1.0 && ratio.is_finite()) {
                return Err(Failure::input(format!(
                    "--find-ratio {ratio}: the faster over the slower speed is at least 1"
                )));
            }
            let tolerance = quantity("tolerance", Some(Unit::Fraction), &self.tolerance)?;
            pairs = wave::find_ratio(pairs, ratio, tolerance);
            if pairs.is_empty() {
                note(common, &format!("no pair has a ratio of {ratio} within {}; widen --tolerance", self.tolerance));
            }
        }
        if self.sort == "price" {
            let of_pair = |pair: &wave::Interface| {
                let [a, b] = pair.media.map(|k| price(shelf, &chosen[k]));
                Some(0.5 * (a? + b?))
            };
            cheapest_first(&mut pairs, of_pair);
        }
        tables::pairs(common, &chosen, &pairs, setting)
    }
}
