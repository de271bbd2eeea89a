//! What only physics can tell of a design, as a complaint about its file.

use super::{Design, DesignError};
use crate::evaluate::PlanError;
use crate::lens::{self, Lens, LensError};

impl Design {
    /// The lens that the design asks for.
    ///
    /// # Errors
    /// No lens is asked for; none can be.
    pub fn propose(&self) -> Result<Lens, DesignError> {
        let request = self.lens.as_ref().ok_or_else(|| {
            let help = "Describe one, or compare a layout of your own: granulens compare DESIGN.toml LAYOUT.csv.";
            self.blame("lens", "[lens] is missing: nothing is asked for.".to_owned(), help.to_owned())
        })?;
        lens::propose(&self.lattice, &self.host, request, &self.target, self.constants)
            .map_err(|error| self.blame_lens(&error))
    }
}

impl<L, R> Design<L, R> {
    /// A lens that cannot be.
    pub fn blame_lens(&self, error: &LensError) -> DesignError {
        let (key, help) = match error {
            LensError::Rows { .. } => ("lens.rows", "Leave it out to have the rows up to the focal region."),
            LensError::FocusRows { .. } => ("target.focus.rows", "Choose rows of the crystal."),
            LensError::FocusWidth(_) => ("target.focus.x", "Give the nearer distance from the axis first."),
            LensError::Split { .. } => ("lens.family", "Choose another family, or leave one focal region."),
            LensError::PartsAxis(_) => ("lens.axis", "Leave it out: each part stands before its own region."),
            LensError::OffAxis => ("lens.axis", "Leave it out, and aim at a region on the axis."),
            LensError::Axis { .. } => ("lens.axis", "Leave it out to have it placed before the focal region."),
            LensError::Span { .. } => ("lens.rows", "Widen them, or ask for fewer stages."),
            LensError::Parameter { .. } => ("lens.parameters", "Change it, or leave it out."),
            LensError::MaxAngle(_) => ("lens.max_interface_angle", "Leave it out for 60 degrees."),
            LensError::ApexRow { .. } => ("lens.apex_row", "Leave it out to have it solved."),
            LensError::BackRow { .. } => ("lens.back_row", "Leave it out to have it solved."),
            LensError::RadiusSign(_) | LensError::Radius { .. } => ("lens.radius", "Leave it out to have it solved."),
            LensError::Unreachable(_) => ("lens", "Change what binds, or move or widen target.focus."),
        };
        let words = error.to_string();
        let words = words.trim_end_matches('.');
        // Most begin with the key's own name and its value.
        let message = match key.rsplit_once('.') {
            Some((section, name)) if words.starts_with(&format!("{name} = ")) => format!("{section}.{words}."),
            _ => format!("{key}: {words}."),
        };
        self.blame(key, message, help.to_owned())
    }

    /// A step or window of the file that cannot be.
    pub fn blame_plan(&self, error: &PlanError) -> DesignError {
        let name = match error {
            PlanError::Step { .. } => "step",
            PlanError::Window { .. } => "window",
        };
        self.blame(&format!("run.{name}"), format!("run.{error}."), error.help())
    }
}
