//! Reports: pictures, tables and a page, drawn from one stored outcome alone; nothing here simulates.
//!
//! In: an [`Outcome`](crate::outcome::Outcome). Out: [`table`] for a terminal; [`files`], or [`write()`] into a directory:
//! `report.html` (everything on one page that needs no network), the pictures as SVG, the numbers as CSV and JSON, the
//! manifest, and the outcome itself. The same outcome gives the same bytes.
//!
//! - `svg`, `colour`, `digits`: a picture as text, colours for numbers, numbers for readers
//! - `crystal`: the crystal on paper; `drawing`, `maps`, `profiles`: the pictures
//! - `summary`: the comparison, random arrangements folded over seeds; `table`: it on a terminal
//! - `verdict`: what the first arrangement beats
//! - `claims`: what was published of the thesis's lens, measured on that lens and on no other
//! - `page`, `files`: what is written
//! - `contact_curve`: a contact law as a picture
//! - `look`: figures for papers; `paper`: pictures as PDF and PNG
//! - `space`: a crystal in space; `slices`: its sections and layers as pictures; `turned`: a view that can be turned
//! - `spots`: where rays pass the focal row
//! - `trace`: rays, wavefronts and first arrivals as a picture
//! - `transmission`: what small vibrations get through
//! - `sensitivity`: how scores change with every sphere, as maps and as a table
//! - `surface`: a design surface as a picture, `surface_page` as a page that answers the pointer; `labels`: places for its labels
//! - `histogram`: how a number is distributed; `site_map`: a number for every site
//! - `frame`: the frame of all other pages
//! - `chart`: lines over a quantity; `bed`: an impact on a granular bed; `ensemble`: many of them; `inside`: a force network, and how grains moved
//! - `study`: what a search came to; `compared`: several side by side
//! - `run`: one simulated rig, from the records in its folder

mod bed;
mod chart;
mod claims;
mod colour;
mod compared;
mod contact_curve;
mod crystal;
mod digits;
mod drawing;
mod ensemble;
mod files;
mod histogram;
mod inside;
mod labels;
mod look;
mod maps;
mod page;
mod frame;
mod paper;
mod profiles;
mod sensitivity;
mod site_map;
mod slices;
mod space;
mod spots;
mod study;
mod summary;
mod surface;
mod surface_page;
mod svg;
mod table;
mod trace;
mod transmission;
mod run;
mod turned;
mod verdict;

pub(crate) use chart::{COLOURS, Chart, Line};
pub(crate) use colour::material as material_colour;
pub use frame::Provenance;
pub(crate) use frame::{Figure, Frame, prose};
pub(crate) use histogram::{Bound, histogram};
pub(crate) use site_map::site_map;
pub(crate) use svg::escape;

pub use bed::{BedPictures, BedRecord, draw_bed};
pub use claims::{Claim, claims};
pub use colour::{Palette, scale_colours};
pub use compared::{ComparedStudy, compared_page};
pub use contact_curve::ContactCurve;
pub use ensemble::{draw_ensemble, ensemble_page};
pub use files::{ReportError, files, numbers, numbers_csv, outcome_json, pictures, spheres_csv, write, write_numbers};
pub use inside::{View, draw_motion, draw_network};
pub use look::Look;
pub use paper::{PaperError, pdf, png};
pub use run::{RunReportError, draw_run};
pub use sensitivity::sensitivity_csv;
pub use space::{draw_space, space_files};
pub use spots::spot_diagram;
pub use study::{StudyPage, study_page};
pub use surface::{surface, surface_csv};
pub use surface_page::{surface_data, surface_page};
pub use table::{solid_words, space_table, table};
pub use trace::trace;
pub use transmission::transmission;
pub use verdict::strengths;
