//! Rigs: loads, flats, bars, sides, contacts that come and go, friction, restart and guards, each against a closed form, a
//! symmetric or periodic equivalent, a conservation law, or a solution computed independently.

mod bed;
mod contacts;
mod crystal;
mod flats;
mod friction;
mod guards;
mod loads;
#[path = "../physics/reference.rs"]
mod reference;
mod restart;
mod rolling;
mod schemes;
mod rigs;
