//! The sections [law], [[pair]] and [friction].

use std::sync::Arc;

use super::file::{FlatFile, FrictionFile, LawFile, PairFile, RubbingKeys};
use super::pulse::{of_table, table};
use crate::contact::{Constants, LawKind, Tabulated};
use crate::dem::rig::{FlatContact, Friction, Law, LawBook, Loss, PairRule, Spring, SpringDashpot};
use crate::design::{NO_LAW, tuning};
use crate::document::{DocumentError, Entry, Scope, Section, Sections, Written, chosen};
use crate::material::Material;
use crate::units::Dimension;

/// The laws of a rig whose spheres are of the materials of `palette`, the first that of the crystal.
pub(super) fn laws(
    top: &Scope,
    (law, pairs, friction): (&Section<LawFile>, &Sections<PairFile>, &Section<FrictionFile>),
    palette: &[Material],
    own: &[Material],
    notes: &mut Vec<String>,
) -> Result<LawBook, DocumentError> {
    let mut given = false;
    let mut book = (Law::Named(LawKind::Thesis), Constants::default());
    if let Some((scope, file)) = top.section("law", law) {
        let spring = SpringKeys::of([&file.stiffness, &file.restitution, &file.damping, &file.pull]);
        if let Some(law) = one_law(&scope, &file.kind, &file.table, spring)? {
            book.0 = law;
            given = true;
        }
        if let Some(entry) = scope.optional("constants", &file.constants) {
            let known: Vec<_> = Constants::ALL.iter().map(|&set| (set.name(), set)).collect();
            book.1 = entry.choice("set of constants", &known)?;
        }
        let LawFile { hardness, unlike_hardness, spring_back, spring_back_growth, hardening, .. } = file;
        // A spring and dashpot has a restitution of its own.
        let restitution = if book.0 == Law::Named(LawKind::Tsuji) { &file.restitution } else { &NOT_WRITTEN };
        let written = [hardness, unlike_hardness, spring_back, spring_back_growth, restitution, hardening];
        book.1.tuning = tuning(&scope, written)?;
    }
    if !given {
        notes.push(format!("law.kind {NO_LAW}"));
    }
    let friction = top.section("friction", friction).map(|(scope, file)| read_friction(&scope, file)).transpose()?;
    let mut named: Vec<PairRule> = Vec::new();
    for (scope, file) in top.sections("pair", pairs) {
        let entry = scope.required("materials", &file.materials)?;
        let materials = entry
            .one_or_more()
            .iter()
            .map(|item| {
                let material = chosen(item, own)?;
                palette.iter().position(|known| known.name == material.name).ok_or_else(|| {
                    let known: Vec<&str> = palette.iter().map(|material| material.name.as_str()).collect();
                    item.fail("is no material of this rig", &format!("It is made of {}.", known.join(", ")))
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        let [a, b] = materials[..] else { return Err(entry.refuse("must be a list of two materials")) };
        let spring = SpringKeys::of([&file.stiffness, &file.restitution, &file.damping, &file.pull]);
        let law = one_law(&scope, &file.kind, &file.table, spring)?;
        let own_friction = rubbing(&scope, file.rubbing(), friction)?;
        if law.is_none() && own_friction.is_none() {
            return Err(scope.fail("has nothing of its own", "Give kind or table, friction or rolling."));
        }
        if law == Some(Law::Named(LawKind::Tsuji))
            && let Some(entry) = scope.optional("restitution", &file.restitution)
        {
            return Err(
                entry.fail("is that of all pairs under this law", "Write it in [law], beside kind = \"tsuji\".")
            );
        }
        if named.iter().any(|rule| rule.is_of([a, b])) {
            return Err(entry.fail("stands in a [[pair]] already", "Keep one for each two materials."));
        }
        named.push(PairRule { materials: [a, b], law, friction: own_friction });
    }
    Ok(LawBook::Materials { law: book.0, constants: book.1, pairs: named, friction })
}

/// A key that is not there.
static NOT_WRITTEN: Written = None;

/// The keys of a spring and dashpot.
#[derive(Clone, Copy)]
struct SpringKeys<'a> {
    stiffness: &'a Written,
    restitution: &'a Written,
    damping: &'a Written,
    pull: &'a Written,
}

impl<'a> SpringKeys<'a> {
    fn of([stiffness, restitution, damping, pull]: [&'a Written; 4]) -> Self {
        Self { stiffness, restitution, damping, pull }
    }

    fn all(self) -> [(&'static str, &'a Written); 4] {
        [
            ("stiffness", self.stiffness),
            ("restitution", self.restitution),
            ("damping", self.damping),
            ("pull", self.pull),
        ]
    }

    fn read(self, scope: &Scope) -> Result<SpringDashpot, DocumentError> {
        let stiffness = scope.required("stiffness", self.stiffness)?.positive(Dimension::Stiffness)?;
        let cut = match scope.optional("pull", self.pull) {
            Some(entry) => !entry.yes()?,
            None => true,
        };
        let loss = match (scope.optional("restitution", self.restitution), scope.optional("damping", self.damping)) {
            (Some(_), Some(entry)) => return Err(entry.fail("is given beside restitution", "Keep one of them.")),
            (Some(entry), None) => match entry.number()? {
                e if (0.05..=1.0).contains(&e) => Loss::with_restitution(e, cut),
                _ => return Err(entry.refuse("must lie from 0.05 to 1")),
            },
            (None, Some(entry)) => match entry.quantity(Dimension::Rate)? {
                rate if rate < 0.0 => return Err(entry.refuse("must not be negative")),
                rate => Loss::Rate(rate),
            },
            (None, None) => {
                let help = "Give restitution, from 0.05 to 1, or damping, like damping = \"1e4 1/s\".";
                return Err(scope.fail("says nothing of losses", help));
            }
        };
        Ok(SpringDashpot { stiffness, loss, cut })
    }
}

/// The name of the law whose keys are [`SpringKeys`].
const SPRING: &str = SpringDashpot::NAME;

fn one_law(scope: &Scope, kind: &Written, file: &Written, spring: SpringKeys) -> Result<Option<Law>, DocumentError> {
    let entry = scope.optional("kind", kind);
    let is_spring = |entry: &Entry| entry.text().is_ok_and(|text| text == SPRING);
    if !entry.as_ref().is_some_and(is_spring) {
        let is_tsuji = entry.as_ref().is_some_and(|entry| entry.text().is_ok_and(|text| text == LawKind::Tsuji.name()));
        for (name, written) in spring.all().into_iter().filter(|(name, _)| !(is_tsuji && *name == "restitution")) {
            if let Some(stray) = scope.optional(name, written) {
                let help = format!("Leave it out, or write kind = \"{SPRING}\".");
                return Err(stray.fail("has no meaning for this law", &help));
            }
        }
    }
    match (scope.optional("kind", kind), scope.optional("table", file)) {
        (Some(_), Some(entry)) => Err(entry.fail("is given beside kind", "Keep one of them.")),
        (Some(entry), None) => {
            let named = LawKind::ALL.iter().map(|&law| (law.name(), Some(law)));
            let known: Vec<_> = named.chain([(SPRING, None)]).collect();
            Ok(Some(match entry.choice("contact law", &known)? {
                Some(kind) => Law::Named(kind),
                None => Law::SpringDashpot(spring.read(scope)?),
            }))
        }
        (None, Some(entry)) => {
            let path = entry.path()?;
            let points = table(&path, ["overlap_m", "force_N"])?;
            let law = Tabulated::new(&points).map_err(|error| of_table(&path, &error.to_string()))?;
            Ok(Some(Law::Tabulated(Arc::new(law))))
        }
        (None, None) => Ok(None),
    }
}

/// As what spheres meet a flat.
pub(super) fn of_flat(
    scope: &Scope,
    file: &FlatFile,
    material: Option<usize>,
    laws: &LawBook,
) -> Result<FlatContact, DocumentError> {
    let spring = SpringKeys::of([&file.stiffness, &file.restitution, &file.damping, &file.pull]);
    let law = match (scope.optional("stiffness", &file.stiffness), scope.optional("kind", &file.kind)) {
        // A stiffness by itself says which law is meant.
        (Some(_), None) => Some(Law::SpringDashpot(spring.read(scope)?)),
        _ => one_law(scope, &file.kind, &file.table, spring)?,
    };
    let LawBook::Materials { friction, .. } = laws else { return Ok(FlatContact::default()) };
    Ok(FlatContact { material, law, friction: rubbing(scope, file.rubbing(), *friction)? })
}

/// Friction of one pair or flat, if anything of it is written; what is not is as everywhere else, or Mindlin's spring.
fn rubbing(scope: &Scope, keys: RubbingKeys, usual: Option<Friction>) -> Result<Option<Friction>, DocumentError> {
    let RubbingKeys { friction, friction_spring, friction_damping, rolling } = keys;
    if [friction, friction_spring, friction_damping, rolling].iter().all(|key| key.is_none()) {
        return Ok(None);
    }
    let usual = match (usual, scope.optional("friction", friction)) {
        (Some(usual), _) => usual,
        (None, Some(_)) => Friction::mindlin(0.0),
        (None, None) => {
            return Err(scope.fail("says how it rubs, but not how strongly", "Give friction, like friction = 0.2."));
        }
    };
    let names = ["friction", "friction_spring", "friction_damping", "rolling"];
    one_friction(scope, names, [friction, friction_spring, friction_damping, rolling], usual).map(Some)
}

fn read_friction(scope: &Scope, file: &FrictionFile) -> Result<Friction, DocumentError> {
    scope.required("coefficient", &file.coefficient)?;
    scope.required("spring", &file.spring)?;
    let FrictionFile { coefficient, spring, damping, rolling } = file;
    let names = ["coefficient", "spring", "damping", "rolling"];
    one_friction(scope, names, [coefficient, spring, damping, rolling], Friction::mindlin(0.0))
}

/// Friction with what is written under these names in place of what is usual.
fn one_friction<'a>(
    scope: &Scope<'a>,
    [coefficient, spring, damping, rolling]: [&'static str; 4],
    written: [&'a Written; 4],
    mut friction: Friction,
) -> Result<Friction, DocumentError> {
    for (name, written, place) in
        [(coefficient, written[0], &mut friction.coefficient), (rolling, written[3], &mut friction.rolling)]
    {
        if let Some(entry) = scope.optional(name, written) {
            *place = entry.number()?;
            if *place < 0.0 {
                return Err(entry.refuse("must not be negative"));
            }
        }
    }
    if let Some(entry) = scope.optional(damping, written[2]) {
        friction.damping = entry.quantity(Dimension::Rate)?;
        if friction.damping < 0.0 {
            return Err(entry.refuse("must not be negative"));
        }
    }
    if let Some(entry) = scope.optional(spring, written[1]) {
        friction.spring = match entry.text()? {
            "none" => Spring::None,
            "mindlin" => Spring::Mindlin,
            "cattaneo-mindlin" => Spring::CattaneoMindlin,
            _ => Spring::Constant(entry.positive(Dimension::Stiffness)?),
        };
    }
    if friction.does_nothing() {
        let help = format!("Write {spring} = \"mindlin\", or give {damping}, like {damping} = \"1e4 1/s\".");
        let what = if friction.rolling > 0.0 {
            "is none, so that nothing would resist rolling"
        } else {
            "is none and there is no damping, so that friction would do nothing"
        };
        return Err(match scope.optional(spring, written[1]) {
            Some(entry) => entry.fail(what, &help),
            None => scope.fail(&format!("has a spring that {what}"), &help),
        });
    }
    Ok(friction)
}
