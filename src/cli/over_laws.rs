//! `--laws` of `check` and `compare`: the same under other contact laws.

use granulens::contact::LawKind;
use granulens::design::Design;
use granulens::evaluate::{OverLaws, OverLawsError, Overrides, Subject, design_laws, over_laws};

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
    pub fn chosen(&self, design: &Design) -> Result<Vec<LawKind>, Failure> {
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
    pub fn scores(
        &self,
        design: &Design,
        subject: Subject<'_>,
        overrides: Overrides,
    ) -> Result<Option<OverLaws>, Failure> {
        let laws = self.chosen(design)?;
        if laws.is_empty() {
            return Ok(None);
        }
        over_laws(design, subject, &laws, overrides, context()).map(Some).map_err(|error| match error {
            OverLawsError::Plan { law, error } => {
                Failure::of_plan(&Design { law, ..design.clone() }, &overrides, &error)
            }
            OverLawsError::Evaluate(error) => error.into(),
        })
    }
}
