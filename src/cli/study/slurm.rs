//! `granulens study slurm`: scripts that run a study as job arrays.

use std::fs;
use std::path::{Path, PathBuf};

use granulens::outcome::FORMAT;
use granulens::study::Study;
use serde_json::json;

use super::read;
use super::run::begin;
use crate::cli::console::{emit_json, note};
use crate::cli::failure::Failure;
use crate::cli::folder::write_file;
use crate::cli::{Band, Common};

#[derive(clap::Args)]
pub struct Slurm {
    /// Study file
    study: PathBuf,
    /// Tasks of the array; each evaluates one shard
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shards: u32,
    /// Cores of each task
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=1024))]
    cpus: u32,
    /// Wall time of each task, in minutes; a minute before its end a task stops by itself and keeps what it has
    #[arg(long, value_name = "MINUTES", default_value_t = 60, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    minutes: u32,
    /// Partition, where it is not the default one
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    #[command(flatten)]
    forces: Band,
}

/// What the scripts hold besides the options.
struct Places {
    program: String,
    study: String,
    folder: String,
    /// Options of the command line that make the study another one than its file alone.
    options: String,
}

impl Slurm {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let study = read(&self.study, &self.forces, common)?;
        let folder = begin(common, &study)?;
        let places = Places {
            program: plain(&std::env::current_exe().unwrap_or_else(|_| "granulens".into()))?,
            study: absolute(&self.study)?,
            folder: absolute(&folder)?,
            options: options(&study, common, &self.forces),
        };
        if let Some(partition) = &self.partition {
            plain(Path::new(partition))?;
        }
        let logs = folder.join("slurm");
        fs::create_dir_all(&logs).map_err(|error| Failure::input(format!("{}: {error}", logs.display())))?;
        let (array, drive) = (folder.join("array.sh"), folder.join("drive.sh"));
        write_file(common, &array, &self.array(&study, &places))?;
        write_file(common, &drive, &places.drive())?;
        for script in [&array, &drive] {
            executable(script)?;
        }
        if common.json {
            emit_json(&json!({ "format": FORMAT, "array": array, "drive": drive, "shards": self.shards }));
        }
        note(common, &format!("{}: runs the study to its end; {}: one round of it", drive.display(), array.display()));
        Ok(())
    }

    fn array(&self, study: &Study, places: &Places) -> String {
        let Self { shards, cpus, minutes, partition, .. } = self;
        let Places { program, study: file, folder, options } = places;
        let partition = partition.as_ref().map_or(String::new(), |name| format!("#SBATCH --partition={name}\n"));
        let name = study.design().name();
        format!(
            "#!/usr/bin/env bash\n\
             # One round of a study's layouts: each task evaluates its shard, and what is evaluated already is left out. To submit it\n\
             # again, whole or as sbatch --array=3,7, is to go on. The signal comes a minute before the wall time, and what is done is kept.\n\
             #SBATCH --job-name={name}\n\
             #SBATCH --array=1-{shards}\n\
             #SBATCH --cpus-per-task={cpus}\n\
             #SBATCH --time={minutes}\n\
             #SBATCH --signal=B:TERM@60\n\
             #SBATCH --output={folder}/slurm/%A-%a.log\n\
             {partition}\
             set -euo pipefail\n\
             exec \"${{GRANULENS:-{program}}}\" evaluate '{file}' --out '{folder}'{options} --quiet \\\n  \
             --shard \"$SLURM_ARRAY_TASK_ID/{shards}\" --threads \"${{SLURM_CPUS_PER_TASK:-{cpus}}}\"\n"
        )
    }
}

impl Places {
    fn drive(&self) -> String {
        let Self { program, study, folder, options } = self;
        format!(
            "#!/usr/bin/env bash\n\
             # Runs a study to its end, a job array for each round. It may be killed anywhere: to run it again is to go on, to the same bits.\n\
             # A task that ran out of time or lost its node leaves layouts without an answer, which the next round asks for again; a layout\n\
             # that a guard stops is an answer.\n\
             set -uo pipefail\n\
             granulens=${{GRANULENS:-{program}}}\n\
             answers() {{ cat '{folder}'/shards/*.jsonl 2>/dev/null | wc -l; }}\n\
             idle=0\n\
             while true; do\n  \
               \"$granulens\" study ask '{study}' --out '{folder}'{options}\n  \
               code=$?\n  \
               [ \"$code\" -eq 4 ] || exit \"$code\"\n  \
               before=$(answers)\n  \
               sbatch --wait '{folder}/array.sh' || printf 'drive: a task did not come to its end\\n' >&2\n  \
               if [ \"$(answers)\" -gt \"$before\" ]; then idle=0; else idle=$((idle + 1)); fi\n  \
               if [ \"$idle\" -eq 3 ]; then\n    \
                 printf 'drive: three rounds in a row brought nothing; what the tasks said is in %s\\n' '{folder}/slurm' >&2\n    \
                 exit 1\n  \
               fi\n\
             done\n"
        )
    }
}

/// Seed and forces, where the command line gives them.
fn options(study: &Study, common: &Common, forces: &Band) -> String {
    let mut options = common.seed.map_or(String::new(), |seed| format!(" --seed {seed}"));
    if forces.forces.is_some() {
        options.push_str(&format!(" --forces {} --band '{} %'", study.forces.count(), 100.0 * study.forces.band()));
    }
    options
}

/// A path that job scripts and shells take as it is.
fn plain(path: &Path) -> Result<String, Failure> {
    let text = path.to_str().unwrap_or_default();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+=@:,".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        return Ok(text.to_owned());
    }
    Err(Failure::input_with_help(
        format!("{}: holds characters that job scripts would read otherwise", path.display()),
        "Choose a name of letters, digits and ._-+=@:, without spaces.",
    ))
}

fn absolute(path: &Path) -> Result<String, Failure> {
    plain(&fs::canonicalize(path).map_err(|error| Failure::input(format!("{}: {error}", path.display())))?)
}

fn executable(path: &Path) -> Result<(), Failure> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let fail = |error: std::io::Error| Failure::input(format!("{}: {error}", path.display()));
        let mut permissions = fs::metadata(path).map_err(fail)?.permissions();
        permissions.set_mode(permissions.mode() | 0o111);
        fs::set_permissions(path, permissions).map_err(fail)?;
    }
    Ok(())
}
