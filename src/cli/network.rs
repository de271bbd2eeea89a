//! `granulens network`: forces between grains as a network, whoever recorded them.

use std::path::PathBuf;

use granulens::network::{
    ANGLE, Bar, Carrier, Chains, Fabric, Named, Part, StressMap, Topology, default_thresholds, read,
};
use granulens::report::{View, draw_network};
use serde_json::{Value, json};

use super::Common;
use super::console::{emit, emit_json, note, pretty};
use super::failure::Failure;
use super::folder::begin;

/// Topology and structure of a force network: components, loops, persistence, chains, fabric and stress
///
/// Reads contacts as CSV with the columns i,j,x_i,z_i,x_j,z_j,normal_N,tangential_N in any order and any units, or a dump local of
/// LAMMPS whose columns have these names (dump_modify colname) or are told by --columns. Places may be missing: fabric, stress and
/// chains then are. Above a threshold is what exceeds that many times the mean normal force.
///
/// A table threshold,components,loops,holes goes to stdout, or with --json all numbers; with --out everything goes to files in a
/// folder instead, with a picture of the network. loops are those of the graph, contacts - grains + components; holes those that are left where every three
/// grains that touch each other are filled; persistence0 and persistence1 (of the filled network) are lists of [birth, death] in
/// multiples of the mean, null for never.
#[derive(clap::Args)]
pub struct NetworkOf {
    /// Contacts: CSV, a dump local of LAMMPS, or a folder of frames as impact keeps them
    contacts: PathBuf,
    /// Period along x; of a dump that of its box unless given
    #[arg(long, value_name = "L", allow_hyphen_values = true)]
    period_x: Option<f64>,
    /// By normal forces, which is what is done without --tangential
    #[arg(long, conflicts_with = "tangential")]
    normal: bool,
    /// By tangential forces, in multiples of the mean normal one
    #[arg(long)]
    tangential: bool,
    /// What carries the force: contacts, each its own; or particles, each the sum of the sizes at its contacts
    #[arg(long, default_value = "contacts", value_name = "WHAT", value_parser = carrier)]
    on: Carrier,
    /// Thresholds in multiples of the mean, such as 0,0.5,1,2 [default: 0 to 5 by 0.05]
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true)]
    thresholds: Option<Vec<f64>>,
    /// Only grains whose centres lie at these heights or depths, such as 0,0.03
    #[arg(long, value_name = "FROM,TO", value_delimiter = ',', allow_hyphen_values = true)]
    z: Option<Vec<f64>>,
    /// Of several moments only this one, from 0
    #[arg(long, value_name = "N")]
    frame: Option<usize>,
    /// What other columns are, such as i=c_1[1],j=c_1[2],normal_N=c_2[1]
    #[arg(long, value_name = "NAME=COLUMN", value_delimiter = ',', value_parser = renaming)]
    columns: Vec<(String, String)>,
    /// Side of the cells of the coarse-grained stress; without it there is no map of it
    #[arg(long, value_name = "LENGTH")]
    cell: Option<f64>,
}

fn carrier(text: &str) -> Result<Carrier, String> {
    match text {
        "contacts" => Ok(Carrier::Contacts),
        "particles" => Ok(Carrier::Particles),
        _ => Err("it is contacts or particles".to_owned()),
    }
}

fn renaming(text: &str) -> Result<(String, String), String> {
    let (name, column) = text.split_once('=').ok_or("write NAME=COLUMN")?;
    Ok((name.trim().to_owned(), column.trim().to_owned()))
}

impl NetworkOf {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let positive = |name: &str, value: Option<f64>| match value {
            Some(x) if !(x > 0.0 && x.is_finite()) => Err(Failure::input_with_help(
                format!("{name} = {x} must be positive"),
                "Give a length of the file's units.",
            )),
            _ => Ok(()),
        };
        positive("--period-x", self.period_x)?;
        positive("--cell", self.cell)?;
        if let Some(wrong) = self.thresholds.iter().flatten().find(|x| !(x.is_finite() && **x >= 0.0)) {
            return Err(Failure::input_with_help(
                format!("--thresholds: {wrong} is no threshold"),
                "They are multiples of the mean force, from 0 on.",
            ));
        }
        let layer = match self.z.as_deref() {
            None => None,
            Some(&[from, to]) if from < to => Some([from, to]),
            Some(_) => {
                return Err(Failure::input_with_help(
                    "--z: two numbers are expected, the smaller one first",
                    "Write --z 0,0.03, in the unit of the file's places.",
                ));
            }
        };
        let folder = common.out.as_deref().map(|place| begin(common, place)).transpose()?;
        let (mut measured, mut count, mut apart, mut idle) = (Vec::new(), 0, 0, 0);
        read(&self.contacts, &self.columns, self.period_x, layer, |moment| {
            count += 1;
            if self.frame.is_none_or(|frame| frame + 1 == count) {
                apart += moment.apart;
                match self.measure(common, count - 1, moment)? {
                    Some(one) => measured.push(one),
                    None => idle += 1,
                }
            }
            Ok::<(), Failure>(())
        })?;
        if measured.is_empty() && idle > 0 {
            return Err(Failure::input_with_help(
                format!(
                    "{}: no contact has a normal force, so that there is no mean to measure by",
                    self.contacts.display()
                ),
                "Give the normal forces in the column normal_N.",
            ));
        }
        if idle > 0 {
            let s = if idle == 1 { "" } else { "s" };
            note(common, &format!("{idle} moment{s} without forces left out"));
        }
        if measured.is_empty() {
            return Err(Failure::input_with_help(
                format!("--frame {}: {} has {count} moments", self.frame.unwrap_or(0), self.contacts.display()),
                "They are counted from 0.",
            ));
        }
        if apart > 0 {
            note(common, &format!("{apart} pairs without any force do not touch and are left out"));
        }
        let objects: Vec<Value> = measured.iter().map(|measured| measured.json(&self)).collect();
        let numbers = match <[Value; 1]>::try_from(objects) {
            Ok([one]) => one,
            Err(several) => json!({ "format": granulens::outcome::FORMAT, "frames": several }),
        };
        for measured in &measured {
            note(common, &measured.words());
        }
        let Some(folder) = folder else {
            if common.json {
                emit_json(&numbers);
            } else {
                emit(&measured.iter().map(Measured::counts).collect::<String>());
            }
            return Ok(());
        };
        let save = |name: &str, text: &str| folder.write(name, text.as_bytes());
        save("network.json", &pretty(&numbers))?;
        let single = measured.len() == 1;
        for measured in &measured {
            let k = measured.number;
            let named = |name: &str| if single { format!("{name}.csv") } else { format!("{name}-{k}.csv") };
            save(&named("network"), &measured.counts())?;
            save(&named("persistence"), &measured.bars())?;
            if let Some(chains) = measured.chain_table() {
                save(&named("chains"), &chains)?;
            }
            if let Some(picture) = &measured.picture {
                save(&named("network").replace(".csv", ".svg"), picture)?;
            }
            if let Some(map) = &measured.stress {
                save(&named("stress"), &stress(map))?;
            }
        }
        Ok(folder.finish()?)
    }

    /// All measures of the moment of this number; none where nothing is pressed, so that there is no mean to measure by.
    fn measure(&self, common: &Common, number: usize, named: Named) -> Result<Option<Measured>, Failure> {
        let Named { time, period, network, names, .. } = named;
        let part = if self.tangential { Part::Tangential } else { Part::Normal };
        let thresholds = self.thresholds.clone().unwrap_or_else(default_thresholds);
        let Some(topology) = Topology::new(&network, self.on, part, thresholds) else { return Ok(None) };
        let stress = self.cell.map(|size| {
            StressMap::new(&network, size, period).ok_or_else(|| {
                Failure::input_with_help(
                    format!("--cell: {} has no places (x_i,z_i,x_j,z_j)", self.contacts.display()),
                    "Leave it out: without places there is no stress.",
                )
            })
        });
        let chains = Chains::new(&network, ANGLE);
        let stem = self.contacts.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let title = time.map_or(stem.clone(), |time| format!("{stem} at {time}"));
        // Drawn only where it is written.
        let picture = match (&chains, common.out.is_some()) {
            (Some(chains), true) => {
                draw_network(&title, &network, network.mean(Carrier::Contacts), chains, View::PLAIN)
            }
            _ => None,
        };
        Ok(Some(Measured {
            number,
            time,
            names,
            grains: network.grains(),
            contacts: network.contacts().len(),
            topology,
            fabric: Fabric::new(&network),
            chains,
            stress: stress.transpose()?,
            picture,
        }))
    }
}

/// All measures of one moment.
struct Measured {
    /// Among the moments of the file, from 0.
    number: usize,
    time: Option<f64>,
    names: Vec<String>,
    grains: usize,
    contacts: usize,
    topology: Topology,
    fabric: Fabric,
    chains: Option<Chains>,
    stress: Option<StressMap>,
    picture: Option<String>,
}

impl Measured {
    fn json(&self, options: &NetworkOf) -> Value {
        let Self { topology, fabric, chains, stress, .. } = self;
        let bars = |bars: &[Bar]| bars.iter().map(|bar| json!([bar.birth, bar.death])).collect::<Vec<Value>>();
        let names = |grains: &[u32]| grains.iter().map(|&i| label(&self.names[i as usize])).collect::<Vec<Value>>();
        json!({
            "format": granulens::outcome::FORMAT,
            "frame": self.number,
            "time": self.time,
            "on": match options.on { Carrier::Contacts => "contacts", Carrier::Particles => "particles" },
            "force": if options.tangential { "tangential" } else { "normal" },
            "grains": self.grains,
            "contacts": self.contacts,
            "mean_force": topology.mean_force,
            "thresholds": topology.thresholds,
            "components": topology.components,
            "loops": topology.loops,
            "holes": topology.holes,
            "persistence0": bars(&topology.persistence0),
            "persistence1": bars(&topology.persistence1),
            "total_persistence0": Topology::total_persistence(&topology.persistence0),
            "total_persistence1": Topology::total_persistence(&topology.persistence1),
            "coordination": fabric.coordination,
            "rattlers": fabric.rattlers.len(),
            "coordination_without_rattlers": fabric.coordination_without_rattlers,
            "fabric": fabric.tensor,
            "virial": fabric.virial,
            "chains": chains.as_ref().map(|chains| chains.chains.iter().map(|chain| names(chain)).collect::<Vec<_>>()),
            "loaded_grains": chains.as_ref().map(|chains| chains.loaded),
            "stress": stress.as_ref().map(|map| json!({
                "cell": map.cell,
                "cells": map.cells.iter().map(|cell| json!({ "centre": cell.centre, "stress": cell.stress })).collect::<Vec<_>>(),
            })),
        })
    }

    fn words(&self) -> String {
        let Self { topology, fabric, chains, .. } = self;
        let time = self.time.map_or(String::new(), |time| format!("at {time}: "));
        let chains = chains.as_ref().map_or(String::new(), |chains| {
            let longest = chains.chains.first().map_or(0, Vec::len);
            format!("; {} force chains, the longest of {longest}", chains.chains.len())
        });
        format!(
            "{time}{} grains, {} contacts, mean force {:.6e}; coordination {:.3}, {} rattlers{chains}; total persistence {:.3} of \
             components, {:.3} of loops",
            self.grains,
            self.contacts,
            topology.mean_force,
            fabric.coordination,
            fabric.rattlers.len(),
            Topology::total_persistence(&topology.persistence0),
            Topology::total_persistence(&topology.persistence1),
        )
    }

    fn counts(&self) -> String {
        let Topology { thresholds, components, loops, holes, .. } = &self.topology;
        let mut text = "threshold,components,loops,holes\n".to_owned();
        for k in 0..thresholds.len() {
            text += &format!("{},{},{},{}\n", thresholds[k], components[k], loops[k], holes[k]);
        }
        text
    }

    fn bars(&self) -> String {
        let mut text = "dimension,birth,death\n".to_owned();
        for (dimension, bars) in [&self.topology.persistence0, &self.topology.persistence1].into_iter().enumerate() {
            for Bar { birth, death } in bars {
                let death = death.map_or(String::new(), |death| death.to_string());
                text += &format!("{dimension},{birth},{death}\n");
            }
        }
        text
    }

    /// A line per grain of a chain.
    fn chain_table(&self) -> Option<String> {
        let mut text = "chain,place,grain\n".to_owned();
        for (k, chain) in self.chains.as_ref()?.chains.iter().enumerate() {
            for (place, &grain) in chain.iter().enumerate() {
                text += &format!("{},{},{}\n", k + 1, place + 1, self.names[grain as usize]);
            }
        }
        Some(text)
    }
}

fn stress(map: &StressMap) -> String {
    let mut text = "x,z,width,height,s_xx,s_xz,s_zx,s_zz\n".to_owned();
    for cell in &map.cells {
        let [[xx, xz], [zx, zz]] = cell.stress;
        let ([x, z], [width, height]) = (cell.centre, map.cell);
        text += &format!("{x},{z},{width},{height},{xx},{xz},{zx},{zz}\n");
    }
    text
}

/// A grain's name: a number where it is one.
fn label(name: &str) -> Value {
    name.parse::<i64>().map_or_else(|_| json!(name), |number| json!(number))
}
