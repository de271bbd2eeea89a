//! With what, and how, impacts on beds are made.

use granulens::bed::{BedImpact, Damping};
use granulens::dem::Integrator;
use granulens::outcome::{COMMIT, VERSION};
use serde::Serialize;

/// As of other simulations, in the units of beds.
#[derive(Serialize)]
pub struct BedMethod {
    version: &'static str,
    commit: &'static str,
    law: &'static str,
    integrator: String,
    step_tau_c: f64,
    window_tau_c: f64,
}

impl BedMethod {
    pub fn of(impact: &BedImpact) -> Self {
        let law = match impact.grains.damping {
            Damping::Kondic => "spring-dashpot, damping kondic, with friction",
            Damping::Exact => "spring-dashpot, damping exact, with friction",
        };
        Self {
            version: VERSION,
            commit: COMMIT,
            law,
            integrator: Integrator::Verlet.to_string(),
            step_tau_c: impact.step,
            window_tau_c: impact.window,
        }
    }

    /// Version and commit of the program.
    pub fn build(&self) -> String {
        format!("{}, commit {}", self.version, self.commit)
    }

    /// In a line.
    pub fn words(&self) -> String {
        let Self { law, integrator, step_tau_c, window_tau_c, .. } = self;
        format!("law {law}; {integrator}, step {step_tau_c:.5} tau_c, window {window_tau_c} tau_c")
    }
}
