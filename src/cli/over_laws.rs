//! `--laws` of `check` and `compare`: the same under other contact laws.

use granulens::contact::LawKind;
use granulens::design::{Design, DesignRef};
use granulens::evaluate::{Drawing, OverLaws, OverLawsError, Overrides, design_laws, over_laws};

use super::console::context;
use super::failure::Failure;

/// Under which laws besides.
#[derive(clap::Args)]
pub struct UnderLaws {
    /// Give C, G and Q under these laws too, and their range: all, or a list such as consistent,mdr-static
    #[arg(long, value_name = "all|LIST", value_delimiter = ',')]
    laws: Vec<String>,
}

impl UnderLaws {
    /// Whether any are asked for.
    pub fn is_asked(&self) -> bool {
        !self.laws.is_empty()
    }

    /// The laws asked for; none without the option.
    pub fn chosen<'a>(&self, design: impl Into<DesignRef<'a>>) -> Result<Vec<LawKind>, Failure> {
        if self.laws == ["all"] {
            return Ok(design_laws(design));
        }
        let mut chosen: Vec<LawKind> = Vec::new();
        for name in &self.laws {
            let law = name.parse().map_err(|error| Failure::input(format!("--laws: {error}")))?;
            if !chosen.contains(&law) {
                chosen.push(law);
            }
        }
        Ok(chosen)
    }

    /// The scores of a piece under these laws, where any are asked for.
    pub fn scores(&self, drawing: Drawing<'_>, overrides: Overrides) -> Result<Option<OverLaws>, Failure> {
        let laws = self.chosen(drawing.design())?;
        if laws.is_empty() {
            return Ok(None);
        }
        over_laws(drawing, &laws, overrides, context()).map(Some).map_err(|error| match (error, drawing) {
            (OverLawsError::Plan { law, error }, Drawing::Plane(design, _)) => {
                Failure::of_plan(&Design { law, ..design.clone() }, &overrides, &error)
            }
            (OverLawsError::Plan { law, error }, Drawing::Space(design, _)) => {
                Failure::of_plan(&Design { law, ..design.clone() }, &overrides, &error)
            }
            (OverLawsError::Evaluate(error), _) => error.into(),
        })
    }
}
