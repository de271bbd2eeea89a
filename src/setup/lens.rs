//! A lens design as a rig: the proposed lens under its impact.

use super::{NO_CHANCE, PreparedRig, Region, RunPlan, Setup, SphereSite, record};
use crate::dem::Mirror;
use crate::dem::rig::{Body, Friction, Law, LawBook, Rig};
use crate::design::Design;
use crate::document::DocumentError;
use crate::evaluate::{Overrides, Plan, PlanError};
use crate::layout::Layout;
use crate::lens::{LensError, propose};
use crate::target;

/// A file that cannot be set up.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// What is wrong with the file.
    #[error(transparent)]
    File(#[from] DocumentError),
    /// The lens of a design cannot be.
    #[error("{}: {error}", .design.path.display())]
    Lens {
        /// The design.
        design: Box<Design>,
        /// Why.
        error: Box<LensError>,
    },
    /// The step or window of a design cannot be.
    #[error("{}: {error}", .design.path.display())]
    Plan {
        /// The design.
        design: Box<Design>,
        /// Why.
        error: PlanError,
    },
}

impl SetupError {
    /// What to try, where the file tells.
    pub fn help(&self) -> Option<&str> {
        match self {
            Self::File(error) => Some(&error.help),
            Self::Lens { .. } | Self::Plan { .. } => None,
        }
    }
}

/// A design without a lens is set up as its host alone. Nothing in it is drawn by chance; a seed is not passed over in silence.
pub(super) fn setup(design: &Design, first_seed: Option<u64>) -> Result<Setup, SetupError> {
    let lattice = &design.lattice;
    let layout = match &design.lens {
        Some(request) => {
            let lens = propose(lattice, &design.host, request, &design.target, design.constants);
            let lens =
                lens.map_err(|error| SetupError::Lens { design: Box::new(design.clone()), error: Box::new(error) })?;
            lens.layout()
        }
        None => Layout::new(lattice.clone(), vec![design.host.clone()], |_| 0),
    };
    of_layout(design, &layout, first_seed)
}

/// Any layout of a design under its impact.
pub(super) fn of_layout(design: &Design, layout: &Layout, first_seed: Option<u64>) -> Result<Setup, SetupError> {
    let lattice = &design.lattice;
    let verlet = Overrides { integrator: Some(crate::dem::Integrator::Verlet), ..Overrides::default() };
    let plan = Plan::new(design, verlet, &layout.palette)
        .map_err(|error| SetupError::Plan { design: Box::new(design.clone()), error })?;
    let mut rig = Rig::new(layout.sample(), laws(design));
    rig.mirrors = vec![
        Mirror { axis: 0, position: 0.0, inward: 1.0 },
        Mirror { axis: 0, position: lattice.half_width(), inward: -1.0 },
    ];
    let sites = lattice.sites();
    let struck = (0..sites.len()).filter(|&i| sites[i].row == 1).map(Body::Sphere).collect();
    // A rig's flats are whole, whatever its mirrors leave of them; here it is half of one.
    let halves = 2.0_f64.powi(rig.mirrors.len() as i32) * 0.5;
    rig.strike(design.impact.of_part(halves), struck, -0.5 * lattice.row_diameter(1));
    let mut warnings = plan.warnings;
    if design.integrator == crate::dem::Integrator::Rk4 {
        warnings.push("a design is simulated as a rig by verlet; its run.integrator is not used here".to_owned());
    }
    if first_seed.is_some() {
        warnings.push(NO_CHANCE.to_owned());
    }
    let plan = RunPlan {
        integrator: crate::dem::Integrator::Verlet,
        step: plan.step,
        step_reason: plan.step_reason,
        window: plan.window,
        window_reason: plan.window_reason,
        warnings,
    };
    let mut record = record::default::<2>(plan.steps(), sites.len(), 0);
    record.regions = regions(design);
    Ok(Setup::Two(PreparedRig {
        name: design.name.clone(),
        path: design.path.clone(),
        text: design.text.clone(),
        rig,
        intruders: Vec::new(),
        sites: sites.iter().map(|site| SphereSite { layer: site.row, column: site.column }).collect(),
        layers: lattice.rows(),
        diameter: lattice.diameter(),
        preload: None,
        seeds: Vec::new(),
        plan,
        record,
    }))
}

/// The focal regions and the protected one.
fn regions(design: &Design) -> Vec<Region> {
    let (sites, diameter, target) = (design.lattice.sites(), design.lattice.diameter(), &design.target);
    let of = |name: String, region: &target::Region| {
        let spheres = (0..sites.len()).filter(|&i| region.contains(&sites[i], diameter)).collect();
        Region { name, spheres }
    };
    let name = |k: usize| if target.foci.len() == 1 { "focus".to_owned() } else { format!("focus-{}", k + 1) };
    let foci = target.foci.iter().enumerate().map(|(k, focus)| of(name(k), &focus.region));
    foci.chain([of("protected".to_owned(), &target.protect)]).collect()
}

fn laws(design: &Design) -> LawBook {
    let friction = design.friction.map(Friction::mindlin);
    LawBook::Materials { law: Law::Named(design.law), constants: design.constants, pairs: Vec::new(), friction }
}
