//! Samples over time, written as the run goes.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use super::RunError;
use super::events::{self, Events, State};
use super::frames::Frames;
use crate::dem::rig::{Body, EnergyLedger, Simulation, Touching, View};
use crate::setup::{Contacts, Intruder, Labels, PreparedRig, Quantity, RecordPlan, Region, spin_about_y};

/// Names of the axes in `D` dimensions.
pub(super) const fn axes<const D: usize>() -> &'static [&'static str] {
    match D {
        1 => &["z"],
        2 => &["x", "z"],
        _ => &["x", "y", "z"],
    }
}

/// Columns of `energies.csv`.
pub(super) const ENERGIES: &str =
    "time_s,work_in_J,kinetic_J,stored_J,tangential_stored_J,potential_J,dissipated_J,friction_J,absorbed_J,residual";

/// Those of `layers.csv`.
pub(super) fn layer_header(layers: u32) -> String {
    (1..=layers).fold("time_s".to_owned(), |text, layer| format!("{text},layer_{layer}_m_s"))
}

/// Those of `regions.csv`.
pub(super) fn region_header(regions: &[Region]) -> String {
    regions.iter().fold("time_s".to_owned(), |text, Region { name, .. }| {
        format!("{text},{name}_velocity_m_s,{name}_kinetic_J,{name}_dissipated_J")
    })
}

/// What stands in a line of `energies.csv` behind the time.
pub(super) fn energies(ledger: &EnergyLedger) -> [f64; 9] {
    [
        ledger.work_in,
        ledger.kinetic,
        ledger.stored,
        ledger.tangential_stored,
        ledger.potential,
        ledger.dissipated,
        ledger.friction,
        ledger.absorbed,
        ledger.residual().unwrap_or(0.0),
    ]
}

/// All files of one run that grow.
pub(super) struct Streams {
    energies: Stream,
    layers: Stream,
    flats: Option<Stream>,
    bars: Option<Stream>,
    spheres: Option<Stream>,
    contacts: Option<Stream>,
    regions: Option<Stream>,
    intruders: Option<Stream>,
    events: Option<Events>,
    frames: Option<Frames>,
    record: RecordPlan,
    /// Layer and column of each sphere of the crystal.
    places: Vec<[u32; 2]>,
    strikers: Vec<Intruder>,
    labels: Labels,
    /// Spheres in each layer.
    in_layer: Vec<f64>,
    row: String,
}

impl Streams {
    /// Creates the files, each with its header.
    pub fn begin<const D: usize>(folder: &Path, prepared: &PreparedRig<D>) -> Result<Self, RunError> {
        let mut streams = Self::open(folder, prepared, None, |name, header| Stream::create(folder.join(name), header))?;
        streams.flush()?;
        Ok(streams)
    }

    /// Opens the files where they were left, and cuts off what came later.
    pub fn restore<const D: usize>(
        folder: &Path,
        prepared: &PreparedRig<D>,
        lengths: &BTreeMap<String, u64>,
        events: Option<State>,
    ) -> Result<Self, RunError> {
        Self::open(folder, prepared, events, |name, _| {
            Stream::restore(folder.join(name), lengths.get(name).copied().unwrap_or(0))
        })
    }

    fn open<const D: usize>(
        folder: &Path,
        prepared: &PreparedRig<D>,
        state: Option<State>,
        mut stream: impl FnMut(&str, &str) -> Result<Stream, RunError>,
    ) -> Result<Self, RunError> {
        let (rig, record) = (&prepared.rig, &prepared.record);
        let along = |stem: &str, unit: &str| -> String {
            axes::<D>().iter().fold(String::new(), |text, axis| format!("{text},{stem}{axis}_{unit}"))
        };
        let layers = layer_header(prepared.layers);
        let flats = rig.flats.iter().fold("time_s".to_owned(), |text, flat| {
            let name = &flat.name;
            format!("{text},{name}_moved_m,{name}_velocity_m_s,{name}_force_N")
        });
        let bars = (1..=rig.bars.len())
            .fold("time_s".to_owned(), |text, k| format!("{text},bar_{k}_velocity_m_s,bar_{k}_force_N"));
        let quantities = record.quantities.iter().fold(String::new(), |text, quantity| {
            text + &match quantity {
                Quantity::Position => along("", "m"),
                Quantity::Displacement => along("u", "m"),
                Quantity::Velocity => along("v", "m_s"),
                Quantity::Spin => spin_header::<D>().to_owned(),
                Quantity::Force => along("F", "N"),
                Quantity::Maxima => ",max_speed_m_s,max_force_N".to_owned(),
                Quantity::Dissipated => ",dissipated_J".to_owned(),
            }
        });
        let regions = region_header(&record.regions);
        let intruders = prepared.intruders.iter().fold("time_s".to_owned(), |text, intruder| {
            let of = |stem: &str, unit: &str| along(&format!("{}_{stem}", intruder.name), unit);
            let angle = intruder.cluster.map_or(String::new(), |_| format!(",{}_angle_rad", intruder.name));
            format!("{text}{}{}{}{angle}", of("u", "m"), of("v", "m_s"), of("F", "N"))
        });
        let spheres = format!("time_s,sphere,layer,column{quantities}");
        let contacts = format!("time_s,{}", contact_header::<D>());
        let mut when = |wanted: bool, name: &str, header: &str| wanted.then(|| stream(name, header)).transpose();
        let flats = when(!rig.flats.is_empty(), "flats.csv", &flats)?;
        let bars = when(!rig.bars.is_empty(), "bars.csv", &bars)?;
        let spheres = when(!record.spheres.is_empty(), "spheres.csv", &spheres)?;
        let contacts = when(record.contacts != Contacts::None, "contacts.csv", &contacts)?;
        let regions = when(!record.regions.is_empty(), "regions.csv", &regions)?;
        let events = when(!record.events.is_empty(), events::FILE, events::HEADER)?;
        let intruders = when(!prepared.intruders.is_empty(), "intruders.csv", &intruders)?;
        let mut in_layer = vec![0.0; prepared.layers as usize];
        prepared.sites.iter().for_each(|site| in_layer[site.layer as usize - 1] += 1.0);
        Ok(Self {
            energies: stream("energies.csv", ENERGIES)?,
            layers: stream("layers.csv", &layers)?,
            flats,
            bars,
            spheres,
            contacts,
            regions,
            intruders,
            events: events.map(|stream| Events::new(prepared, stream, state)),
            frames: record.frames.then(|| Frames::of(prepared, folder)).transpose()?,
            record: record.clone(),
            places: prepared.sites.iter().map(|site| [site.layer, site.column]).collect(),
            in_layer,
            strikers: prepared.intruders.clone(),
            labels: prepared.labels(),
            row: String::new(),
        })
    }

    /// Writes one sample of everything.
    pub fn sample<const D: usize>(&mut self, simulation: &Simulation<D>) -> Result<(), RunError> {
        let (view, rig, time) = (simulation.view(), simulation.rig(), simulation.time());
        let row = &mut self.row;
        self.energies.row(row, time, energies(&simulation.ledger()))?;

        let mut sums = vec![0.0; self.in_layer.len()];
        for (i, [layer, _]) in self.places.iter().enumerate() {
            sums[*layer as usize - 1] += view.velocity(i)[D - 1];
        }
        // A layer of vacancies only has no velocity.
        let means = sums.iter().zip(&self.in_layer).map(|(sum, count)| sum / count.max(1.0));
        self.layers.row(row, time, means)?;

        if let Some(flats) = &mut self.flats {
            let values = rig.flats.iter().enumerate().flat_map(|(k, flat)| {
                let state = view.flat(k);
                let along = |v: &[f64; D]| (0..D).map(|k| v[k] * flat.normal[k]).sum::<f64>();
                // What presses on the flat counts as positive.
                [along(&state.moved), along(&state.velocity), -along(&state.force)]
            });
            flats.row(row, time, values)?;
        }
        if let Some(intruders) = &mut self.intruders {
            let values = self.strikers.iter().flat_map(|intruder| state_of(intruder, &view));
            intruders.row(row, time, values)?;
        }
        if let Some(bars) = &mut self.bars {
            let values = rig.bars.iter().flat_map(|bar| {
                let velocity = match bar.body {
                    Body::Sphere(i) => view.velocity(i)[bar.axis],
                    Body::Flat(k) => view.flat(k).velocity[bar.axis],
                };
                let incident = bar.incident.as_ref().map_or(0.0, |curve| curve.value(time));
                [velocity, 2.0 * incident - bar.impedance * velocity]
            });
            bars.row(row, time, values)?;
        }
        let asked = |quantity| self.spheres.is_some() && self.record.quantities.contains(&quantity);
        let maxima = match asked(Quantity::Maxima) {
            true => [simulation.greatest_speed(), simulation.greatest_force()],
            false => [const { Vec::new() }; 2],
        };
        let dissipated = match asked(Quantity::Dissipated) || self.regions.is_some() {
            true => simulation.dissipated(),
            false => Vec::new(),
        };
        if let Some(regions) = &mut self.regions {
            let values = self.record.regions.iter().flat_map(|region| {
                let of = |value: &dyn Fn(usize) -> f64| region.spheres.iter().map(|&i| value(i)).sum::<f64>();
                let square = |v: [f64; D]| v.iter().map(|v| v * v).sum::<f64>();
                [
                    of(&|i| view.velocity(i)[D - 1]) / region.spheres.len() as f64,
                    of(&|i| 0.5 * view.simulated_fraction(i) * rig.mass[i] * square(view.velocity(i))),
                    of(&|i| view.simulated_fraction(i) * dissipated[i]),
                ]
            });
            regions.row(row, time, values)?;
        }
        if let Some(spheres) = &mut self.spheres {
            for &i in &self.record.spheres {
                row.clear();
                let [layer, column] = self.places[i];
                let _ = write!(row, "{time:?},{},{layer},{column}", i + 1);
                for quantity in &self.record.quantities {
                    match quantity {
                        Quantity::Position => append(row, view.position(i)),
                        Quantity::Displacement => append(row, view.displacement(i)),
                        Quantity::Velocity => append(row, view.velocity(i)),
                        Quantity::Spin => append(row, spin_of::<D>(view.spin(i))),
                        Quantity::Force => append(row, view.whole_force(i)),
                        Quantity::Maxima => append(row, [maxima[0][i], maxima[1][i]]),
                        Quantity::Dissipated => append(row, [dissipated[i]]),
                    }
                }
                spheres.line(row)?;
            }
        }
        if let Some(contacts) = &mut self.contacts {
            let all = self.record.contacts == Contacts::All;
            let chosen = |body: &Body| match body {
                Body::Sphere(i) => self.record.spheres.binary_search(i).is_ok(),
                Body::Flat(_) => false,
            };
            for touching in view.contacts().filter(|touching| all || touching.bodies.iter().any(chosen)) {
                row.clear();
                let _ = write!(row, "{time:?},");
                contact_row(row, &self.labels, &touching);
                contacts.line(row)?;
            }
        }
        match &mut self.frames {
            Some(frames) => frames.keep(simulation),
            None => Ok(()),
        }
    }

    /// Takes note of how things stand at the start.
    pub fn begin_events<const D: usize>(&mut self, view: &View<'_, D>) {
        if let Some(events) = &mut self.events {
            events.begin(view);
        }
    }

    /// What is looked at after every step, if anything is.
    pub fn events(&mut self) -> Option<&mut Events> {
        self.events.as_mut()
    }

    fn all(&mut self) -> impl Iterator<Item = &mut Stream> {
        let some = [
            &mut self.flats,
            &mut self.bars,
            &mut self.spheres,
            &mut self.contacts,
            &mut self.regions,
            &mut self.intruders,
        ];
        let events = self.events.as_mut().map(|events| &mut events.stream);
        [&mut self.energies, &mut self.layers].into_iter().chain(some.into_iter().flatten()).chain(events)
    }

    /// Hands everything to the disk.
    pub fn flush(&mut self) -> Result<(), RunError> {
        self.all().try_for_each(Stream::flush)?;
        self.frames.as_mut().map_or(Ok(()), Frames::flush)
    }

    /// How long each file is, in bytes, by name.
    pub fn lengths(&mut self) -> BTreeMap<String, u64> {
        let name = |path: &Path| path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
        self.all().map(|stream| (name(&stream.path), stream.length)).collect()
    }
}

/// Columns of a spin. A sheet lies in x and z: it turns about y, counted as the same sphere in space would be, and in the plane from x
/// towards z, which is the other way round (z × x = y).
const fn spin_header<const D: usize>() -> &'static str {
    if D == 2 { ",wx_rad_s,wy_rad_s,wxz_rad_s" } else { ",wx_rad_s,wy_rad_s,wz_rad_s" }
}

fn spin_of<const D: usize>(spin: [f64; 3]) -> [f64; 3] {
    if D == 2 { [0.0, spin_about_y(spin[2]), spin[2]] } else { spin }
}

/// Columns of a table of contacts.
pub(super) fn contact_header<const D: usize>() -> String {
    let normal = axes::<D>().iter().fold(String::new(), |text, axis| format!("{text},n{axis}"));
    format!("a,b{normal},overlap_m,closing_m_s,force_N,tangential_N,overlap_max_m,force_max_N,stored_J,dissipated_J")
}

/// How far an intruder has moved, its velocity, the force of the spheres on the whole of it, and by how much it has turned;
/// a ball's turning is not followed.
fn state_of<const D: usize>(intruder: &Intruder, view: &View<'_, D>) -> Vec<f64> {
    let ball = intruder.members.start;
    let (moved, velocity, force, angle) = match intruder.cluster {
        Some(cluster) => {
            let state = view.cluster(cluster);
            (state.moved, state.velocity, state.force, Some(spin_about_y(state.angle)))
        }
        None => (view.displacement(ball), view.velocity(ball), view.whole_force(ball), None),
    };
    moved.into_iter().chain(velocity).chain(force).chain(angle).collect()
}

/// One contact, by the labels of its bodies.
pub(super) fn contact_row<const D: usize>(row: &mut String, labels: &Labels, touching: &Touching<D>) {
    let [a, b] = touching.bodies.map(|body| labels.of(body));
    let _ = write!(row, "{a},{b}");
    append(row, touching.normal);
    append(
        row,
        [
            touching.overlap,
            touching.closing_speed,
            touching.force,
            touching.tangential,
            touching.overlap_max,
            touching.force_max,
            touching.stored,
            touching.dissipated,
        ],
    );
}

/// Numbers behind commas, as short as they can be read back exactly.
pub(super) fn append(row: &mut String, values: impl IntoIterator<Item = f64>) {
    for value in values {
        let _ = write!(row, ",{value:?}");
    }
}

/// One file that grows.
pub(super) struct Stream {
    path: PathBuf,
    file: BufWriter<File>,
    pub length: u64,
}

impl Stream {
    pub fn create(path: PathBuf, header: &str) -> Result<Self, RunError> {
        let file = File::create(&path).map_err(|error| RunError::File { path: path.clone(), error })?;
        let mut stream = Self { path, file: BufWriter::new(file), length: 0 };
        stream.line(header)?;
        Ok(stream)
    }

    pub fn restore(path: PathBuf, length: u64) -> Result<Self, RunError> {
        let attempt = || -> io::Result<File> {
            let mut file = OpenOptions::new().write(true).open(&path)?;
            if file.metadata()?.len() < length {
                return Err(io::Error::other("is shorter than when the checkpoint was written"));
            }
            file.set_len(length)?;
            io::Seek::seek(&mut file, io::SeekFrom::Start(length))?;
            Ok(file)
        };
        match attempt() {
            Ok(file) => Ok(Self { path, file: BufWriter::new(file), length }),
            Err(error) => Err(RunError::File { path, error }),
        }
    }

    pub fn line(&mut self, text: &str) -> Result<(), RunError> {
        let written = self.file.write_all(text.as_bytes()).and_then(|()| self.file.write_all(b"\n"));
        self.length += text.len() as u64 + 1;
        written.map_err(|error| RunError::File { path: self.path.clone(), error })
    }

    /// A time and values.
    pub fn row(&mut self, row: &mut String, time: f64, values: impl IntoIterator<Item = f64>) -> Result<(), RunError> {
        row.clear();
        let _ = write!(row, "{time:?}");
        append(row, values);
        self.line(row)
    }

    pub fn flush(&mut self) -> Result<(), RunError> {
        let flushed = self.file.flush().and_then(|()| self.file.get_ref().sync_data());
        flushed.map_err(|error| RunError::File { path: self.path.clone(), error })
    }
}
