//! Large crystals in space, followed by their rows ([`bulk`](crate::dem::bulk)): the same files as of other rigs but for the tables of contacts, which
//! would be longer than all else.
//!
//! Which rigs these are, [`impact_of`] says. Where such a crystal turns out to be none, because spheres meet that are no neighbours, the run is begun
//! anew as any other rig's.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read as _, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::checkpoint::is_of;
use super::course::{self, Advanced, Course};
use super::streams::{ENERGIES, Stream, append, energies, layer_header, region_header};
use super::summary::Reached;
use super::tables::{Peaks, write_peaks};
use super::{CHECKPOINT, Ending, Halved, Keeping, RunError, SUMMARY, Summary, begin, write};
use crate::Context;
use crate::dem::bulk::{Arrivals, Bulk, MANY, Recording};
use crate::dem::rig::{Arrival, Body, Curve, EnergyLedger, Law, LawBook, LoadKind, RigStop};
use crate::dem::{ForcePulse, Impact, InAny, MoveIn, Period, Spheres, Stop, sealed, unsealed};
use crate::real::Width;
use crate::setup::{Contacts, PreparedRig, Quantity};

/// First line of the checkpoint of such a run.
const OPENING: &[u8] = b"granulens large trial checkpoint 1\n";
/// Most steps between two looks at the clock.
const CHUNK: u64 = 16;

/// The impact on a prepared rig that is one large crystal in space: equal free spheres, one law without friction, no flats, walls, bars or gravity; one
/// square force along z from the start on, spheres that move along z, or both; samples of motion alone. None of all others.
pub fn impact_of(prepared: &PreparedRig<3>) -> Option<Impact> {
    let (rig, record) = (&prepared.rig, &prepared.record);
    let nothing_else = rig.clusters.is_empty()
        && rig.flats.is_empty()
        && rig.bars.is_empty()
        && rig.gravity == [0.0; 3]
        && rig.drag == 0.0
        && !rig.precompressed
        && !rig.held.iter().flatten().any(|&held| held)
        && !rig.has_friction()
        && !rig.velocity.iter().any(|&[x, y, _]| x != 0.0 || y != 0.0)
        && rig.overlap_limit.is_none()
        && prepared.intruders.is_empty();
    let spheres = &rig.sample.spheres;
    let arrivals = matches!(record.arrivals[..], [] | [Arrival::Speed(_)] | [Arrival::OwnMaximum(0.01)]);
    let motion_alone = arrivals
        && spheres.iter().all(|sphere| sphere.radius == spheres[0].radius)
        && record.contacts == Contacts::None
        && record.events.is_empty()
        && !record.frames
        && record
            .quantities
            .iter()
            .all(|q| matches!(q, Quantity::Position | Quantity::Displacement | Quantity::Velocity));
    let LawBook::Materials { law: Law::Named(law), constants, pairs, .. } = &rig.laws else { return None };
    if rig.sample.spheres.len() < MANY || !nothing_else || !motion_alone || !pairs.is_empty() {
        return None;
    }
    let (mut pulse, mut struck) = (ForcePulse { force: 0.0, duration: 0.0 }, Vec::new());
    match &rig.loads[..] {
        [] => {}
        [load] => {
            let Curve::Square { peak, start: 0.0, duration } = load.curve else { return None };
            if load.kind != LoadKind::Force || load.direction != [0.0, 0.0, 1.0] {
                return None;
            }
            pulse = ForcePulse { force: peak, duration };
            for body in &load.bodies {
                let Body::Sphere(sphere) = *body else { return None };
                struck.push(sphere);
            }
        }
        _ => return None,
    }
    let moving = rig.velocity.iter().enumerate().filter(|(_, v)| v[2] != 0.0).map(|(i, v)| (i, v[2])).collect();
    let period = |(axis, length): (usize, &Option<f64>)| length.map(|length| Period { axis, length });
    Some(Impact {
        mirrors: rig.mirrors.clone(),
        periods: rig.periods.iter().enumerate().filter_map(period).collect(),
        law: *law,
        constants: *constants,
        pulse,
        slope: 0.0,
        struck,
        faces: Vec::new(),
        moving,
        projectile: None,
        exit: Vec::new(),
        integrator: prepared.plan.integrator,
        step: prepared.plan.step,
        window: prepared.plan.window,
    })
}

/// Prepared rigs, of which some are in space.
struct Prepared;

impl InAny for Prepared {
    type In<const D: usize> = PreparedRig<D>;
}

/// The crystal of such a rig, at its start.
fn crystal_of(prepared: &PreparedRig<3>) -> Option<Bulk> {
    let impact = impact_of(prepared)?;
    let arrivals = match prepared.record.arrivals[..] {
        [] => Arrivals::None,
        [Arrival::Speed(speed)] => Arrivals::Speed(speed),
        _ => Arrivals::OwnMaximum,
    };
    let recording = Recording { energies: true, arrivals };
    Bulk::new(&prepared.rig.sample, &impact, recording, Width::widest()).ok()
}

/// Whether a rig is followed by its rows.
pub fn is_large<const D: usize>(prepared: &PreparedRig<D>) -> bool
where
    Spheres: MoveIn<D>,
{
    Spheres::in_space::<Prepared>(prepared).is_some_and(|prepared| impact_of(prepared).is_some())
}

/// What stands before the state in a checkpoint.
#[derive(Serialize, Deserialize)]
struct Head {
    halved: Halved,
    text: u32,
    seeds: Vec<u64>,
    lengths: BTreeMap<String, u64>,
}

/// All files that grow.
struct Streams {
    energies: Stream,
    layers: Stream,
    spheres: Option<Stream>,
    regions: Option<Stream>,
    row: String,
}

impl Streams {
    fn open(
        prepared: &PreparedRig<3>,
        mut open: impl FnMut(&str, &str) -> Result<Stream, RunError>,
    ) -> Result<Self, RunError> {
        let quantities = prepared.record.quantities.iter().map(|quantity| match quantity {
            Quantity::Position => ",x_m,y_m,z_m",
            Quantity::Displacement => ",ux_m,uy_m,uz_m",
            _ => ",vx_m_s,vy_m_s,vz_m_s",
        });
        let spheres = format!("time_s,sphere,layer,column{}", quantities.collect::<String>());
        let mut when = |wanted: bool, name: &str, header: &str| wanted.then(|| open(name, header)).transpose();
        let spheres = when(!prepared.record.spheres.is_empty(), "spheres.csv", &spheres)?;
        let regions =
            when(!prepared.record.regions.is_empty(), "regions.csv", &region_header(&prepared.record.regions))?;
        let energies = open("energies.csv", ENERGIES)?;
        Ok(Self {
            energies,
            layers: open("layers.csv", &layer_header(prepared.layers))?,
            spheres,
            regions,
            row: String::new(),
        })
    }

    fn all(&mut self) -> impl Iterator<Item = (&'static str, &mut Stream)> {
        let some = [("spheres.csv", self.spheres.as_mut()), ("regions.csv", self.regions.as_mut())];
        let always = [("energies.csv", &mut self.energies), ("layers.csv", &mut self.layers)];
        always.into_iter().chain(some.into_iter().filter_map(|(name, stream)| Some((name, stream?))))
    }

    /// One sample of everything; what the energies are.
    fn sample(
        &mut self,
        prepared: &PreparedRig<3>,
        bulk: &Bulk,
        layer_sizes: &[f64],
    ) -> Result<EnergyLedger, RunError> {
        let (time, row) = (bulk.time(), &mut self.row);
        let ledger = ledger(bulk);
        self.energies.row(row, time, energies(&ledger))?;
        let velocities = bulk.velocities();
        let mut sums = vec![0.0; layer_sizes.len()];
        for (site, velocity) in prepared.sites.iter().zip(&velocities) {
            sums[site.layer as usize - 1] += velocity[2];
        }
        self.layers.row(row, time, sums.iter().zip(layer_sizes).map(|(sum, count)| sum / count.max(1.0)))?;
        if let Some(regions) = &mut self.regions {
            let (weights, dissipated) = (bulk.weights(), bulk.dissipated());
            let square = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>();
            let values = prepared.record.regions.iter().flat_map(|region| {
                let of = |value: &dyn Fn(usize) -> f64| region.spheres.iter().map(|&i| value(i)).sum::<f64>();
                [
                    of(&|i| velocities[i][2]) / region.spheres.len() as f64,
                    of(&|i| 0.5 * weights[i] * prepared.rig.mass[i] * square(velocities[i])),
                    of(&|i| weights[i] * dissipated[i]),
                ]
            });
            regions.row(row, time, values)?;
        }
        let Some(spheres) = &mut self.spheres else { return Ok(ledger) };
        for &i in &prepared.record.spheres {
            row.clear();
            let site = prepared.sites[i];
            let _ = write!(row, "{time:?},{},{},{}", i + 1, site.layer, site.column);
            let moved = bulk.displacement(i);
            for quantity in &prepared.record.quantities {
                match quantity {
                    Quantity::Position => {
                        let rest = prepared.rig.sample.spheres[i].centre;
                        append(row, (0..3).map(|k| rest[k] + moved[k]));
                    }
                    Quantity::Displacement => append(row, moved),
                    _ => append(row, velocities[i]),
                }
            }
            spheres.line(row)?;
        }
        Ok(ledger)
    }
}

/// Where the energy is, as of other rigs.
fn ledger(bulk: &Bulk) -> EnergyLedger {
    let ledger = bulk.ledger();
    EnergyLedger {
        work_in: ledger.work_in,
        kinetic: ledger.kinetic,
        stored: ledger.stored,
        dissipated: ledger.dissipated,
        held_back: bulk.held_back(),
        at_hand: ledger.work_in,
        ..EnergyLedger::default()
    }
}

fn keep(
    path: &Path,
    prepared: &PreparedRig<3>,
    bulk: &Bulk,
    halved: &Halved,
    streams: &mut Streams,
) -> Result<(), RunError> {
    streams.all().try_for_each(|(_, stream)| stream.flush())?;
    let lengths = streams.all().map(|(name, stream)| (name.to_owned(), stream.length)).collect();
    let (text, seeds) = (crc32fast::hash(prepared.text.as_bytes()), prepared.seeds.clone());
    let head = sealed(&Head { halved: halved.clone(), text, seeds, lengths });
    let attempt = || -> std::io::Result<()> {
        // Beside it first: the one before stays until this one is whole.
        let beside = path.with_extension("new");
        let mut file = BufWriter::with_capacity(1 << 20, File::create(&beside)?);
        file.write_all(OPENING)?;
        file.write_all(&(head.len() as u64).to_le_bytes())?;
        file.write_all(&head)?;
        bulk.save(&mut file)?;
        file.into_inner().map_err(|error| error.into_error())?.sync_all()?;
        std::fs::rename(&beside, path)
    };
    attempt().map_err(|error| RunError::File { path: path.to_owned(), error })
}

/// The beginning of a checkpoint of this machine, and where the state begins; none where it is another's.
fn head(path: &Path) -> Result<Option<(Head, BufReader<File>)>, RunError> {
    let at = |error| RunError::File { path: path.to_owned(), error };
    let Ok(file) = File::open(path) else { return Ok(None) };
    let mut file = BufReader::with_capacity(1 << 20, file);
    let mut opening = vec![0; OPENING.len()];
    if file.read_exact(&mut opening).is_err() || opening != OPENING {
        return Ok(None);
    }
    let mut length = [0; 8];
    file.read_exact(&mut length).map_err(at)?;
    let mut head = vec![0; u64::from_le_bytes(length).min(1 << 24) as usize];
    file.read_exact(&mut head).map_err(at)?;
    let damaged = || RunError::Checkpoint { path: path.to_owned(), reason: "the checkpoint is damaged".to_owned() };
    Ok(Some((unsealed(&head).ok_or_else(damaged)?, file)))
}

/// How often the step of the run in a checkpoint of this machine was halved; none where it is another's, or none at all.
pub fn halved(path: &Path) -> Result<Option<Halved>, RunError> {
    Ok(head(path)?.map(|(head, _)| head.halved))
}

/// Takes up a run.
fn restore(
    folder: &Path,
    path: &Path,
    prepared: &PreparedRig<3>,
    bulk: &mut Bulk,
) -> Result<Option<Streams>, RunError> {
    let refused = |reason: &str| RunError::Checkpoint { path: path.to_owned(), reason: reason.to_owned() };
    let Some((head, mut file)) = head(path)? else { return Ok(None) };
    is_of(head.text, &head.seeds, prepared).map_err(|reason| refused(&reason))?;
    bulk.restore(&mut file).map_err(|error| refused(&error.to_string()))?;
    let open = |name: &str, _: &str| Stream::restore(folder.join(name), head.lengths.get(name).copied().unwrap_or(0));
    Streams::open(prepared, open).map(Some)
}

/// The guards of rigs on accuracy: contacts that are too stiff for the step, and energy that is left over.
fn inaccurate(prepared: &PreparedRig<3>, bulk: &Bulk, ledger: Option<&EnergyLedger>) -> Option<RigStop> {
    let time = bulk.time();
    if let (Some(resolution), Some(stiffest)) = (prepared.rig.resolution, bulk.stiffest()) {
        let limit = resolution * (stiffest.reduced_mass / stiffest.stiffness).sqrt();
        if prepared.plan.step > limit * (1.0 + 1e-9) {
            let (step, stiffness, bodies) =
                (prepared.plan.step, stiffest.stiffness, stiffest.spheres.map(Body::Sphere));
            return Some(RigStop::Coarse { step, limit, stiffness, bodies, time });
        }
    }
    let limit = prepared.rig.residual_limit;
    let residual = ledger?.residual().filter(|residual| residual.abs() > limit)?;
    Some(RigStop::Residual { residual, limit, time })
}

/// Runs a rig by its rows. None where it is none of these, or where spheres have met that are no neighbours.
pub fn run<const D: usize>(
    prepared: &PreparedRig<D>,
    folder: &Path,
    keeping: Keeping,
    halved: &Halved,
    context: &Context,
) -> Result<Option<(Summary, Ending)>, RunError>
where
    Spheres: MoveIn<D>,
{
    let Some(prepared) = Spheres::in_space::<Prepared>(prepared) else { return Ok(None) };
    let Some(mut bulk) = crystal_of(prepared) else { return Ok(None) };
    let path = folder.join(CHECKPOINT);
    let mut layer_sizes = vec![0.0; prepared.layers as usize];
    prepared.sites.iter().for_each(|site| layer_sizes[site.layer as usize - 1] += 1.0);
    let streams = if keeping.resume {
        match restore(folder, &path, prepared, &mut bulk)? {
            Some(streams) => streams,
            None => return Ok(None),
        }
    } else {
        begin(prepared, folder)?;
        let mut streams = Streams::open(prepared, |name, header| Stream::create(folder.join(name), header))?;
        streams.sample(prepared, &bulk, &layer_sizes)?;
        keep(&path, prepared, &bulk, halved, &mut streams)?;
        streams
    };
    let length = [prepared.plan.steps(), prepared.record.every, CHUNK];
    let mut course = ByRows { prepared, bulk, streams, layer_sizes, halved, path: path.clone(), sampled: None };
    let Some(ending) = course::follow(&mut course, length, keeping.every, context)? else {
        std::fs::remove_file(&path).map_err(|error| RunError::File { path, error })?;
        return Ok(None);
    };
    let ByRows { bulk, mut streams, .. } = course;
    streams.all().try_for_each(|(_, stream)| stream.flush())?;
    let speed = bulk.max_speed();
    let reached = Reached {
        time: bulk.time(),
        steps: bulk.steps(),
        ledger: ledger(&bulk),
        max_speed: speed.iter().copied().fold(0.0, f64::max),
    };
    if !matches!(ending, Ending::Interrupted { .. }) {
        let arrivals = if prepared.record.arrivals.is_empty() { Vec::new() } else { vec![bulk.arrivals()] };
        let peaks = Peaks { speed, force: bulk.max_net_force(), dissipated: bulk.dissipated(), arrivals };
        let weights = bulk.weights();
        write_peaks(folder, prepared, &peaks, &|i| weights[i])?;
    }
    let summary = Summary::of(prepared, &reached, &ending);
    write(&folder.join(SUMMARY), summary.json().as_bytes())?;
    Ok(Some((summary, ending)))
}

/// A crystal on its way.
struct ByRows<'a> {
    prepared: &'a PreparedRig<3>,
    bulk: Bulk,
    streams: Streams,
    layer_sizes: Vec<f64>,
    halved: &'a Halved,
    path: PathBuf,
    /// Where the energy was at the sample that has just been taken.
    sampled: Option<EnergyLedger>,
}

impl Course for ByRows<'_> {
    fn steps(&self) -> u64 {
        self.bulk.steps()
    }

    fn advance(&mut self, steps: u64, context: &Context) -> Result<Advanced, RunError> {
        self.sampled = None;
        Ok(match self.bulk.advance(steps, context) {
            Ok(()) => Advanced::All,
            Err(Stop::Interrupted { time_s }) => Advanced::Interrupted(time_s),
            Err(Stop::Met { .. } | Stop::Leap { .. }) => Advanced::Unfit,
            Err(stop) => Advanced::Stopped(as_of_rigs(&stop, self.bulk.time())),
        })
    }

    fn sample(&mut self) -> Result<(), RunError> {
        self.sampled = Some(self.streams.sample(self.prepared, &self.bulk, &self.layer_sizes)?);
        Ok(())
    }

    fn keep(&mut self) -> Result<(), RunError> {
        keep(&self.path, self.prepared, &self.bulk, self.halved, &mut self.streams)
    }

    fn guarded(&mut self) -> Option<RigStop> {
        inaccurate(self.prepared, &self.bulk, self.sampled.as_ref())
    }
}

/// A guard as other rigs have it.
fn as_of_rigs(stop: &Stop, now: f64) -> RigStop {
    let bodies = |spheres: [usize; 2]| spheres.map(|sphere| Body::Sphere(sphere - 1));
    match *stop {
        Stop::NotFinite { sphere, time_s } => RigStop::NotFinite { body: Body::Sphere(sphere - 1), time: time_s },
        Stop::Overlap { spheres, overlap_ratio, limit, time_s } => {
            RigStop::Overlap { bodies: bodies(spheres), ratio: overlap_ratio, limit, time: time_s }
        }
        Stop::Step { step_s, limit_s, stiffness, spheres, time_s } => {
            RigStop::Step { step: step_s, limit: limit_s, stiffness, bodies: bodies(spheres), time: time_s }
        }
        Stop::Residual { residual } => RigStop::Residual { residual, limit: crate::dem::RESIDUAL_LIMIT, time: now },
        // Those are not told as guards.
        Stop::Leap { .. } | Stop::Interrupted { .. } | Stop::Beyond { .. } | Stop::Met { .. } => {
            RigStop::Interrupted { time: now }
        }
    }
}
