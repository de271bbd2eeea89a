//! The numbers that contact laws leave to their user, on the command line.

use granulens::contact::Tuning;

use super::failure::Failure;

/// What laws leave open, where it is not as usual.
#[derive(clap::Args)]
pub struct Tuned {
    /// thornton: contact pressure that yields over the yield stress, from 1.6 to 3; usually 2.8
    #[arg(long, value_name = "H")]
    hardness: Option<f64>,
    /// Factor on the yield stress of contacts between unlike materials, from 1 to 1.9; usually 1
    #[arg(long, value_name = "FACTOR")]
    unlike_hardness: Option<f64>,
    /// walton-braun: stiffness on the way back over that of loading; usually 5
    #[arg(long, value_name = "RATIO")]
    spring_back: Option<f64>,
    /// walton-braun: by how much the stiffness on the way back grows with the force, in 1/m; usually 0
    #[arg(long, value_name = "S")]
    spring_back_growth: Option<f64>,
    /// tsuji: coefficient of restitution; usually 0.9
    #[arg(long, value_name = "E")]
    restitution: Option<f64>,
    /// storakers: exponent of stress over strain; usually 0.1
    #[arg(long, value_name = "M")]
    hardening: Option<f64>,
}

impl Tuned {
    /// The numbers, checked.
    pub fn tuning(&self) -> Result<Tuning, Failure> {
        let usual = Tuning::default();
        let tuning = Tuning {
            hardness: self.hardness.unwrap_or(usual.hardness),
            unlike_hardness: self.unlike_hardness.unwrap_or(usual.unlike_hardness),
            spring_back: self.spring_back.unwrap_or(usual.spring_back),
            spring_back_growth: self.spring_back_growth.unwrap_or(usual.spring_back_growth),
            restitution: self.restitution.unwrap_or(usual.restitution),
            hardening: self.hardening.unwrap_or(usual.hardening),
        };
        tuning.check().map_err(|error| Failure::input(format!("--{}", error.to_string().replace('_', "-"))))?;
        Ok(tuning)
    }
}
