//! Files to begin with: small, commented, and running as they are.

use super::FileKind;

/// A file to begin with.
#[derive(Clone, Copy, Debug)]
pub struct Starter {
    /// Its name.
    pub file: &'static str,
    /// What is in it.
    pub text: &'static str,
    /// What to do next.
    pub next: &'static str,
}

impl FileKind {
    /// The file to begin with.
    pub const fn starter(self) -> Starter {
        match self {
            Self::Design => Starter {
                file: "lens.toml",
                text: include_str!("starters/design.toml"),
                next: "granulens design lens.toml shows the proposal, granulens run lens.toml simulates it against its baselines",
            },
            Self::Rig => Starter {
                file: "rig.toml",
                text: include_str!("starters/rig.toml"),
                next: "granulens simulate rig.toml",
            },
            Self::Bed => {
                Starter { file: "bed.toml", text: include_str!("starters/bed.toml"), next: "granulens impact bed.toml" }
            }
            Self::Study => Starter {
                file: "study.toml",
                text: include_str!("starters/study.toml"),
                next: "granulens init design writes the lens.toml that it names, then granulens study run study.toml",
            },
            Self::Materials => Starter {
                file: "materials.toml",
                text: include_str!("starters/materials.toml"),
                next: "its sections go into a design or rig file, or stay here for --materials of speed, contact and surface",
            },
        }
    }
}
