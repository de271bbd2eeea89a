//! Every physical claim against a closed form, an independent solution, a conservation law or a published figure.
//!
//! `tests/data/` holds solutions computed by an implementation written separately from this one; each file explains
//! itself in its header.

mod amplitude;
mod chain;
mod claims;
mod collision;
mod consistent;
mod contact_law;
mod energy;
mod faces;
mod laws;
mod lens;
mod problem;
mod projectile;
mod reference;
mod rubbing;
mod sheets;
mod space;
mod surface;
mod symmetry;
mod wave;
