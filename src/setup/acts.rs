//! What holds and what strikes the crystal: the sections [sides], [[flat]], [[bar]], [[load]], [[moving]] and [gravity].

use super::file::{BarFile, FlatFile, LoadFile, MovingFile, SidesFile};
use super::laws::of_flat;
use super::place::{along_wave, axes, direction, named_axes, no_axis, selection, spin, vector};
use super::pulse::{path, pulse};
use crate::dem::Mirror;
use crate::dem::rig::{Bar, Body, Face, Flat, Load, LoadKind, Rig};
use crate::document::{DocumentError, Entry, Scope, Written, chosen};
use crate::lattice::Crystal;
use crate::material::Material;
use crate::pattern::Selection;
use crate::units::Dimension;

/// A rig in the making, with the site of each sphere of its crystal; intruders come behind them.
pub(super) struct Stage<'a, const D: usize> {
    pub rig: Rig<D>,
    pub crystal: &'a Crystal<D>,
    pub sites: Vec<usize>,
}

impl<const D: usize> Stage<'_, D> {
    /// The spheres that a selection means.
    pub fn spheres(&self, selection: &Selection<D>) -> Vec<usize> {
        let site = |i: usize| &self.crystal.sites()[self.sites[i]];
        let meant = |&i: &usize| selection.holds(self.sites[i], site(i), &site(i).centre);
        (0..self.sites.len()).filter(meant).collect()
    }

    /// Lowest and highest centre of the crystal along an axis, and lowest and highest point of a sphere of it (m).
    pub fn extent(&self, axis: usize) -> [f64; 4] {
        let mut extent = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for sphere in &self.rig.sample.spheres[..self.sites.len()] {
            let (x, r) = (sphere.centre[axis], sphere.radius);
            extent = [extent[0].min(x), extent[1].max(x), extent[2].min(x - r), extent[3].max(x + r)];
        }
        extent
    }

    pub fn sides(&mut self, scope: &Scope, file: &SidesFile) -> Result<(), DocumentError> {
        for (name, written) in [("x", &file.x), ("y", &file.y), ("z", &file.z)] {
            let Some(entry) = scope.optional(name, written) else { continue };
            let Some(axis) = axes::<D>().iter().position(|axis| *axis == name) else {
                return Err(no_axis::<D>(&entry));
            };
            let known = [("free", Ends::Free), ("wall", Ends::Wall), ("fixed", Ends::Fixed), ("mirror", Ends::Mirror)];
            if !entry.is_list() {
                let known: Vec<(&str, Ends)> = known.into_iter().chain([("periodic", Ends::Periodic)]).collect();
                match entry.choice("kind of sides", &known)? {
                    Ends::Periodic => self.repeat(&entry, axis)?,
                    both => {
                        self.end(axis, both, false);
                        self.end(axis, both, true);
                    }
                }
                continue;
            }
            let [low, high] = entry.pair()?;
            self.end(axis, low.choice("kind of side", &known)?, false);
            self.end(axis, high.choice("kind of side", &known)?, true);
        }
        Ok(())
    }

    fn repeat(&mut self, entry: &Entry, axis: usize) -> Result<(), DocumentError> {
        let (layers, cell) = (self.crystal.layers(), self.crystal.cell());
        let period = if axis == D - 1 {
            (layers % cell.layers() == 0).then(|| f64::from(layers) * self.crystal.layer_spacing())
        } else {
            self.crystal.periods()[axis]
        };
        self.rig.periods[axis] = Some(period.ok_or_else(|| {
            let help = if axis == D - 1 {
                format!("Choose a number of layers that {} divides.", cell.layers())
            } else {
                "Give the width as crystal.cells, so that the crystal goes on like itself.".to_owned()
            };
            entry.fail("needs a crystal that repeats itself along this axis", &help)
        })?);
        Ok(())
    }

    fn end(&mut self, axis: usize, ends: Ends, high: bool) {
        let [first, last, lowest, highest] = self.extent(axis);
        let inward = if high { -1.0 } else { 1.0 };
        match ends {
            Ends::Free | Ends::Periodic => {}
            Ends::Mirror => {
                self.rig.mirrors.push(Mirror { axis, position: if high { last } else { first }, inward });
            }
            Ends::Wall => {
                let (mut point, mut normal) = ([0.0; D], [0.0; D]);
                point[axis] = if high { highest } else { lowest };
                normal[axis] = inward;
                let name = format!("{}-{}", axes::<D>()[axis], if high { "high" } else { "low" });
                self.rig.flats.push(Flat::wall(name, point, normal));
            }
            Ends::Fixed => {
                // Rows that are shifted by half a diameter end with the others.
                let reach = 0.5 * self.crystal.diameter() * (1.0 + 1e-9);
                for (sphere, held) in self.rig.sample.spheres.iter().zip(&mut self.rig.held) {
                    let x = sphere.centre[axis];
                    if if high { last - x <= reach } else { x - first <= reach } {
                        *held = [true; D];
                    }
                }
            }
        }
    }

    /// A flat; `material` is the place of its own in the sample's list, if it has one.
    pub fn flat(&mut self, scope: &Scope, file: &FlatFile, material: Option<usize>) -> Result<(), DocumentError> {
        let name = match scope.optional("name", &file.name) {
            Some(entry) => match entry.text()? {
                name if !crate::document::is_plain_name(name) => {
                    return Err(entry.refuse("must be 1 to 100 letters (a to z), digits, - and _"));
                }
                name if self.rig.flats.iter().any(|flat| flat.name == name) => {
                    return Err(entry.fail("is the name of another flat or wall", "Choose another name."));
                }
                name => name.to_owned(),
            },
            None => format!("flat-{}", self.rig.flats.len() + 1),
        };
        let [.., lowest, highest] = self.extent(D - 1);
        let (mut point, mut normal) = ([0.0; D], [0.0; D]);
        match scope.optional("at", &file.at) {
            Some(entry) => {
                let front = entry.choice("end of the crystal", &[("front", true), ("back", false)])?;
                for (name, written) in [("point", &file.point), ("normal", &file.normal)] {
                    if let Some(entry) = scope.optional(name, written) {
                        return Err(entry.fail("is given beside at", "Keep at, or point and normal."));
                    }
                }
                (point[D - 1], normal[D - 1]) = if front { (lowest, 1.0) } else { (highest, -1.0) };
            }
            None => {
                let diameter = self.crystal.diameter();
                point = vector(&scope.required("point", &file.point)?, |item| item.length(diameter))?;
                normal = direction(&scope.required("normal", &file.normal)?)?;
            }
        }
        let face = self.face(scope, file, &point, &normal)?;
        let mass = match scope.optional("mass", &file.mass) {
            Some(entry) if entry.text().is_ok_and(|text| text == "infinite") => f64::INFINITY,
            Some(entry) => entry.positive(Dimension::Mass)?,
            None => f64::INFINITY,
        };
        let velocity = match scope.optional("velocity", &file.velocity) {
            Some(entry) => along_wave(&entry, Dimension::Speed)?,
            None => [0.0; D],
        };
        let held = match scope.optional("hold", &file.hold) {
            Some(entry) => named_axes(&entry)?,
            // A free flat is guided along the wave; one of infinite mass stands, or moves as it does.
            None => std::array::from_fn(|k| velocity[k] == 0.0 && (mass.is_infinite() || k != D - 1)),
        };
        let contact = of_flat(scope, file, material, &self.rig.laws)?;
        self.rig.flats.push(Flat { name, point, normal, face, mass, velocity, held, contact });
        Ok(())
    }

    fn face(
        &self,
        scope: &Scope,
        file: &FlatFile,
        point: &[f64; D],
        normal: &[f64; D],
    ) -> Result<Face<D>, DocumentError> {
        let diameter = self.crystal.diameter();
        match (scope.optional("corners", &file.corners), scope.optional("hexagon", &file.hexagon)) {
            (Some(_), Some(entry)) => Err(entry.fail("is given beside corners", "Keep one of them.")),
            (Some(entry), None) => {
                let items = entry.one_or_more();
                if D == 1 || (D == 2 && items.len() != 2) || (D == 3 && items.len() < 3) {
                    let rule = "must have two corners in a sheet, three or more in space, none in a chain";
                    return Err(entry.refuse(rule));
                }
                let corners = items
                    .iter()
                    .map(|item| vector::<D>(item, |item| item.length(diameter)))
                    .collect::<Result<Vec<_>, _>>()?;
                let height = |c: &[f64; D]| (0..D).map(|k| (c[k] - point[k]) * normal[k]).sum::<f64>().abs();
                if corners.iter().any(|c| height(c) > 1e-6 * diameter) {
                    return Err(
                        entry.fail("has a corner off the plane", "Corners lie in the plane of point and normal.")
                    );
                }
                Ok(Face::Polygon(corners))
            }
            (None, Some(entry)) => {
                if D != 3 || normal[D - 1].abs() != 1.0 {
                    return Err(entry.refuse("needs a crystal in space and a normal along z"));
                }
                let side = entry.length(diameter)?;
                if side <= 0.0 {
                    return Err(entry.refuse("must be more than zero"));
                }
                // Corners along x, as those of a hexagonal crystal.
                let corner = |k: u32| {
                    let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
                    let mut corner = *point;
                    corner[0] += side * cos;
                    corner[1] += side * sin;
                    corner
                };
                Ok(Face::Polygon((0..6).map(corner).collect()))
            }
            (None, None) => Ok(Face::Plane),
        }
    }

    /// The bodies that a section acts on: a flat by name, or selected spheres.
    fn bodies(&self, scope: &Scope, flat: &Written, keys: super::file::PlaceKeys) -> Result<Vec<Body>, DocumentError> {
        let written = [keys.layers, keys.columns, keys.x, keys.y, keys.z].iter().any(|key| key.is_some());
        if let Some(entry) = scope.optional("flat", flat) {
            if written {
                return Err(entry.fail("is given beside places of spheres", "Act on a flat or on spheres."));
            }
            let names: Vec<(&str, usize)> = self.rig.flats.iter().map(|flat| flat.name.as_str()).zip(0..).collect();
            return Ok(vec![Body::Flat(entry.choice("flat", &names)?)]);
        }
        if !written {
            return Err(scope.fail("does not say on which bodies it acts", "Give flat, or layers, columns, x, y or z."));
        }
        let meant = selection(scope, keys, self.crystal.diameter(), self.crystal.layers())?;
        let spheres = self.spheres(&meant);
        if spheres.is_empty() {
            return Err(scope.fail("means no sphere", "Widen layers, columns or places."));
        }
        Ok(spheres.into_iter().map(Body::Sphere).collect())
    }

    pub fn bar(&mut self, scope: &Scope, file: &BarFile, own: &[Material]) -> Result<(), DocumentError> {
        let bodies = self.bodies(scope, &file.flat, file.place())?;
        let impedance = match scope.optional("impedance", &file.impedance) {
            Some(entry) => {
                for (name, written) in [("material", &file.material), ("diameter", &file.diameter)] {
                    if let Some(entry) = scope.optional(name, written) {
                        return Err(
                            entry.fail("is given beside impedance", "Keep impedance, or material and diameter.")
                        );
                    }
                }
                entry.positive(Dimension::Impedance)?
            }
            None => {
                // Z = ρ c A with c = √(E/ρ)
                let material = chosen(&scope.required("material", &file.material)?, own)?;
                let diameter = scope.required("diameter", &file.diameter)?.positive(Dimension::Length)?;
                let area = std::f64::consts::FRAC_PI_4 * diameter * diameter;
                area * (material.youngs_modulus * material.density).sqrt()
            }
        };
        let keys = file.over_time();
        let written = [keys.pulse, keys.peak, keys.start, keys.duration, keys.file].iter().any(|key| key.is_some());
        let incident = if written { Some(pulse(scope, keys, Dimension::Force, "force_N")?) } else { None };
        for body in bodies {
            self.rig.bars.push(Bar { body, axis: D - 1, impedance, incident: incident.clone() });
        }
        Ok(())
    }

    pub fn load(&mut self, scope: &Scope, file: &LoadFile) -> Result<(), DocumentError> {
        #[derive(Clone, Copy)]
        enum Prescribed {
            Force,
            Velocity,
            Displacement,
        }
        let known = [
            ("force", Prescribed::Force),
            ("velocity", Prescribed::Velocity),
            ("displacement", Prescribed::Displacement),
        ];
        let keys = file.over_time();
        let (kind, curve) = match scope.required("kind", &file.kind)?.choice("kind of load", &known)? {
            Prescribed::Force => (LoadKind::Force, pulse(scope, keys, Dimension::Force, "force_N")?),
            Prescribed::Velocity => (LoadKind::Velocity, pulse(scope, keys, Dimension::Speed, "velocity_m_s")?),
            Prescribed::Displacement => (LoadKind::Velocity, path(scope, keys)?),
        };
        let mut along = [0.0; D];
        along[D - 1] = 1.0;
        if let Some(entry) = scope.optional("direction", &file.direction) {
            along = direction(&entry)?;
        }
        let bodies = self.bodies(scope, &file.flat, file.place())?;
        self.rig.loads.push(Load { bodies, direction: along, kind, curve });
        Ok(())
    }

    pub fn moving(&mut self, scope: &Scope, file: &MovingFile) -> Result<(), DocumentError> {
        let velocity = scope.optional("velocity", &file.velocity);
        let spin = scope.optional("spin", &file.spin);
        if velocity.is_none() && spin.is_none() {
            return Err(scope.fail("sets nothing in motion", "Give velocity or spin."));
        }
        let velocity = velocity.map(|entry| along_wave::<D>(&entry, Dimension::Speed)).transpose()?;
        let turning = spin.map(|entry| self::spin::<D>(&entry)).transpose()?;
        for body in self.bodies(scope, &None, file.place())? {
            let Body::Sphere(i) = body else { continue };
            self.rig.velocity[i] = velocity.unwrap_or(self.rig.velocity[i]);
            self.rig.spin[i] = turning.unwrap_or(self.rig.spin[i]);
        }
        Ok(())
    }
}

/// What ends a crystal along an axis.
#[derive(Clone, Copy, PartialEq)]
enum Ends {
    Free,
    Wall,
    Fixed,
    Mirror,
    Periodic,
}
