//! The rig file as written: which keys there are, nothing about their meaning.

use crate::document::{OwnMaterials, Section, Sections, Written, section};

/// Sections of which some have sections below them are spelled out; the others are declared by their keys.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RigFile {
    #[expect(dead_code, reason = "the format has been read before all else; here it only is a known key")]
    pub format: Written,
    #[expect(dead_code, reason = "as the format")]
    pub kind: Written,
    pub name: Written,
    pub crystal: Section<CrystalFile>,
    pub pattern: Sections<PatternFile>,
    pub edit: Sections<EditFile>,
    pub sides: Section<SidesFile>,
    pub flat: Sections<FlatFile>,
    pub bar: Sections<BarFile>,
    pub intruder: Sections<IntruderFile>,
    pub load: Sections<LoadFile>,
    pub moving: Sections<MovingFile>,
    pub law: Section<LawFile>,
    pub pair: Sections<PairFile>,
    pub friction: Section<FrictionFile>,
    pub gravity: Section<GravityFile>,
    pub preload: Section<PreloadFile>,
    pub run: Section<RunFile>,
    pub record: Section<RecordFile>,
    pub region: Sections<RegionFile>,
    pub materials: Section<OwnMaterials>,
}

section!(CrystalFile: Written { packing, diameter, layers, material, x, y, cells, hexagon, disk });
section!(PatternFile: Written {
    kind, materials, diameters, first, angle, widths, origin, apex, spheres, side, width, centre, fractions, seed, file,
    layers, columns, x, y, z
});
section!(EditFile: Written { material, diameter, remove, r#move, hold, layers, columns, x, y, z });
section!(SidesFile: Written { x, y, z });
section!(FlatFile: Written {
    name, at, point, normal, corners, hexagon, mass, velocity, hold,
    material, kind, table, stiffness, restitution, damping, pull, friction, friction_spring, friction_damping, rolling
});
section!(BarFile: Written { flat, impedance, material, diameter, pulse, peak, start, duration, file, layers, columns, x, y, z });
section!(LoadFile: Written {
    kind, pulse, peak, start, duration, file, direction, flat, layers, columns, x, y, z
});
section!(IntruderFile: Written {
    name, shape, material, diameter, half_width, half_height, shell, mass, body, turns, velocity, spin, gap, x, y
});
section!(MovingFile: Written { velocity, spin, layers, columns, x, y, z });
section!(LawFile: Written {
    kind, table, constants, stiffness, restitution, damping, pull,
    hardness, unlike_hardness, spring_back, spring_back_growth, hardening
});
section!(PairFile: Written {
    materials, kind, table, stiffness, restitution, damping, pull, friction, friction_spring, friction_damping, rolling
});
section!(FrictionFile: Written { coefficient, spring, damping, rolling });
section!(GravityFile: Written { acceleration });
section!(PreloadFile: Written { force, strain, tolerance });
// `squeezed` is as 0.1 and 0.2 wrote it.
section!(RunFile: Written { window, integrator, step, accuracy, drag, #[serde(alias = "squeezed")] precompressed, leave });
section!(RecordFile: Written {
    every, quantities, contacts, frames, events, events_of, arrivals, pictures, layers, columns, x, y, z
});
section!(RegionFile: Written { name, layers, columns, x, y, z });

/// How each key is written, for messages.
pub(crate) const EXAMPLES: &[&str] = &[
    "format = 1",
    "kind = \"rig\"",
    "name = \"drop-tower\"",
    "crystal.packing = \"hexagonal\"",
    "crystal.diameter = \"6.35 mm\"",
    "crystal.layers = 15",
    "crystal.material = \"brass-260\"",
    "crystal.x = [\"0 D\", \"17 D\"]",
    "crystal.y = [\"-10 D\", \"10 D\"]",
    "crystal.cells = [5]",
    "crystal.hexagon = 21",
    "crystal.disk = \"20 D\"",
    "pattern.kind = \"stripes\"",
    "pattern.materials = [\"brass-260\", \"440c\"]",
    "pattern.diameters = [\"6.35 mm\", \"4 mm\"]",
    "pattern.first = 11",
    "pattern.angle = \"60 deg\"",
    "pattern.widths = [\"3 D\", \"2 D\"]",
    "pattern.origin = [\"0 D\", \"8 D\"]",
    "pattern.apex = [\"0 D\", \"4 D\"]",
    "pattern.spheres = 10",
    "pattern.side = \"right\"",
    "pattern.width = \"1 D\"",
    "pattern.centre = [\"0 D\", \"0 D\"]",
    "pattern.fractions = [0.7, 0.3]",
    "pattern.seed = 1",
    "pattern.file = \"lens.csv\"",
    "edit.material = \"brass-260\"",
    "edit.diameter = \"6 mm\"",
    "edit.remove = true",
    "edit.move = [\"0 mm\", \"0.1 mm\"]",
    "edit.hold = [\"x\", \"z\"]",
    "sides.x = \"periodic\"",
    "sides.y = [\"mirror\", \"free\"]",
    "sides.z = [\"free\", \"wall\"]",
    "flat.name = \"impactor\"",
    "flat.at = \"front\"",
    "flat.point = [\"0 mm\", \"-3.175 mm\"]",
    "flat.normal = [0.0, 1.0]",
    "flat.corners = [[\"-10 mm\", \"-3.175 mm\"], [\"10 mm\", \"-3.175 mm\"]]",
    "flat.hexagon = \"12.7 mm\"",
    "flat.mass = \"2.3 kg\"",
    "flat.velocity = \"20 m/s\"",
    "flat.hold = [\"x\", \"y\"]",
    "flat.material = \"maraging-steel\"",
    "flat.kind = \"consistent\"",
    "flat.table = \"contact.csv\"",
    "flat.damping = \"1e4 1/s\"",
    "bar.flat = \"anvil\"",
    "bar.impedance = \"11000 kg/s\"",
    "bar.material = \"maraging-steel\"",
    "bar.diameter = \"19.05 mm\"",
    "load.kind = \"force\"",
    "load.direction = [0.0, 1.0]",
    "load.flat = \"impactor\"",
    "intruder.name = \"ball\"",
    "intruder.shape = \"ball\"",
    "intruder.material = \"440c\"",
    "intruder.diameter = \"25.4 mm\"",
    "intruder.half_width = \"4 D\"",
    "intruder.half_height = \"8 D\"",
    "intruder.shell = \"1 D\"",
    "intruder.mass = \"0.5 kg\"",
    "intruder.body = \"solid\"",
    "intruder.turns = true",
    "intruder.velocity = \"20 m/s\"",
    "intruder.spin = \"50 rad/s\"",
    "intruder.gap = \"1 mm\"",
    "intruder.x = \"0 D\"",
    "intruder.y = \"0 D\"",
    "moving.velocity = \"5 m/s\"",
    "moving.spin = \"50 rad/s\"",
    "law.kind = \"consistent\"",
    "law.table = \"contact.csv\"",
    "law.constants = \"code\"",
    "law.hardness = 2.8",
    "law.unlike_hardness = 1.2",
    "law.spring_back = 5",
    "law.spring_back_growth = 0",
    "law.hardening = 0.1",
    "pair.materials = [\"brass-260\", \"440c\"]",
    "pair.kind = \"hertz\"",
    "pair.table = \"contact.csv\"",
    "friction.coefficient = 0.2",
    "friction.spring = \"mindlin\"",
    "friction.damping = \"100 1/s\"",
    "gravity.acceleration = \"9.81 m/s2\"",
    "run.window = \"400 us\"",
    "run.step = \"1e-7 s\"",
    "run.accuracy = \"0.1 %\"",
    "run.drag = \"100 1/s\"",
    "preload.force = \"100 N\"",
    "preload.strain = \"0.1 %\"",
    "preload.tolerance = 1e-7",
    "run.precompressed = true",
    "run.integrator = \"adams\"",
    "run.leave = \"20 D\"",
    "record.every = \"1 us\"",
    "record.quantities = [\"displacement\", \"velocity\"]",
    "record.contacts = true",
    "record.frames = true",
    "record.events = [\"closes\", \"opens\", \"yields\"]",
    "record.events_of = \"all\"",
    "record.arrivals = [\"1 %\", \"191 um\"]",
    "record.pictures = [\"x-t\", \"energies\"]",
    "region.name = \"focus\"",
    "*.stiffness = \"1e6 N/m\"",
    "*.restitution = 0.5",
    "*.pull = false",
    "pair.friction = 0.2",
    "flat.friction = 0.2",
    "*.friction_spring = \"mindlin\"",
    "*.friction_damping = \"100 1/s\"",
    "*.rolling = 0.01",
    "law.damping = \"1e4 1/s\"",
    "pair.damping = \"1e4 1/s\"",
    // Keys that several sections share.
    "*.pulse = \"half-sine\"",
    "*.peak = \"26 kN\"",
    "*.start = \"0 us\"",
    "*.duration = \"20 us\"",
    "*.file = \"pulse.csv\"",
    "*.layers = [1, 1]",
    "*.columns = [3, 5]",
    "*.x = [\"0 D\", \"2.5 D\"]",
    "*.y = [\"0 D\", \"2.5 D\"]",
    "*.z = [\"0 D\", \"2.5 D\"]",
];

/// Where spheres are, as several sections write it.
#[derive(Clone, Copy)]
pub(super) struct PlaceKeys<'a> {
    pub layers: &'a Written,
    pub columns: &'a Written,
    pub x: &'a Written,
    pub y: &'a Written,
    pub z: &'a Written,
}

/// A quantity over time, as several sections write it.
#[derive(Clone, Copy)]
pub(super) struct PulseKeys<'a> {
    pub pulse: &'a Written,
    pub peak: &'a Written,
    pub start: &'a Written,
    pub duration: &'a Written,
    pub file: &'a Written,
}

/// Friction of one pair or flat, as several sections write it.
#[derive(Clone, Copy)]
pub(super) struct RubbingKeys<'a> {
    pub friction: &'a Written,
    pub friction_spring: &'a Written,
    pub friction_damping: &'a Written,
    pub rolling: &'a Written,
}

macro_rules! share {
    ($($file:ident),* have $method:ident: $keys:ident $list:tt) => { $( share!(@one $file $method $keys $list); )* };
    (@one $file:ident $method:ident $keys:ident { $($key:ident),* }) => {
        impl $file {
            pub fn $method(&self) -> $keys<'_> {
                $keys { $($key: &self.$key),* }
            }
        }
    };
}
share!(PairFile, FlatFile have rubbing: RubbingKeys { friction, friction_spring, friction_damping, rolling });
share!(PatternFile, EditFile, BarFile, LoadFile, MovingFile, RecordFile, RegionFile have place: PlaceKeys { layers, columns, x, y, z });
share!(BarFile, LoadFile have over_time: PulseKeys { pulse, peak, start, duration, file });

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::assert_examples;

    /// Messages rely on it.
    #[test]
    fn every_key_has_an_example_that_is_toml() {
        let sections = [
            ("crystal", CrystalFile::KEYS),
            ("pattern[1]", PatternFile::KEYS),
            ("edit[1]", EditFile::KEYS),
            ("sides", SidesFile::KEYS),
            ("flat[2]", FlatFile::KEYS),
            ("bar[1]", BarFile::KEYS),
            ("load[1]", LoadFile::KEYS),
            ("intruder[1]", IntruderFile::KEYS),
            ("moving[1]", MovingFile::KEYS),
            ("law", LawFile::KEYS),
            ("pair[1]", PairFile::KEYS),
            ("friction", FrictionFile::KEYS),
            ("gravity", GravityFile::KEYS),
            ("preload", PreloadFile::KEYS),
            ("run", RunFile::KEYS),
            ("record", RecordFile::KEYS),
            ("region[1]", RegionFile::KEYS),
        ];
        assert_examples(EXAMPLES, &sections);
    }
}
