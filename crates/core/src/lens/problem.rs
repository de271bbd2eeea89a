//! What a lens is sought for, within which limits, and what rays make of one form of it.

use std::collections::BTreeMap;

use super::Stack;
use super::family::Place;
use super::form::{Form, Surrounds};
use super::fraction::{passing, without};
use super::parts::Strip;
use super::plano_convex::Shape;
use super::symmetry::Symmetry;
use super::{Family, LensRequest, Parameter};
use crate::lattice::HexagonalSheet;
use crate::target::{Region, Target};

/// A lens has to send this much more of the struck width through than straight rays, or it is no lens for the target:
/// ray angles are off by degrees in a crystal (Burgoyne 2016, fig. 5.14), which moves more than this share of the rays.
pub(super) const LEAST_GAIN: f64 = 0.01;

/// What a lens is sought for, and within which limits.
#[derive(Clone, Debug)]
pub(super) struct Problem<'a> {
    /// Whose sites it may take; a lens in space is laid on its sites by others.
    pub sheet: Option<&'a HexagonalSheet>,
    pub stack: Stack,
    pub family: Family,
    /// Of host and lens (m/s)
    pub speeds: [f64; 2],
    /// Of further materials (m/s)
    pub others: Vec<f64>,
    /// The strip that it may take (m): all of the half crystal, or what one of several foci is given
    pub window: [f64; 2],
    /// Where the lens's own axis lies (m)
    pub axis: f64,
    /// Values of the family's parameters (SI), in its order, and the places of those that are sought.
    pub values: Vec<f64>,
    pub open: Vec<usize>,
    /// Whether it is a sheet's or a body of revolution
    pub symmetry: Symmetry,
    /// Distances from the axis between which rays shall pass or, of a shield, shall not (m)
    pub region: [f64; 2],
    /// Depth at which they shall (m)
    pub depth: f64,
    /// The same as a row
    pub mid_row: f64,
    /// Number of rows of the region
    pub region_rows: u32,
    /// Last row that the lens may reach, in front of the focal region; 0 if there is none
    pub last_free_row: u32,
    pub rows: [u32; 2],
    pub max_angle: f64,
    pub apex_row: Option<u32>,
    pub back_row: Option<u32>,
    pub radius: Option<f64>,
}

/// A lens and the fraction that it sends through the region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub shape: Shape,
    pub fraction: f64,
}

impl<'a> Problem<'a> {
    /// One lens for the target's only focus or, of a shield, for its protected region.
    pub(super) fn new(
        stack: Stack,
        sheet: Option<&'a HexagonalSheet>,
        speeds: [f64; 2],
        request: &LensRequest,
        target: &Target,
    ) -> Self {
        let family = request.family;
        let region = if family.spares() { &target.protect } else { &target.foci[0].region };
        let axis = if family.row().is_central { 0.0 } else { aim(region, &stack) };
        let whole = [0.0, stack.half_width];
        Self::of((stack, sheet), speeds, request, target, region, whole, request.axis.unwrap_or(axis))
    }

    /// The part of a lens for one of several foci that is given a strip of the width.
    pub(super) fn part(
        sheet: &'a HexagonalSheet,
        speeds: [f64; 2],
        request: &LensRequest,
        target: &Target,
        strip: &Strip,
    ) -> Self {
        let region = &target.foci[strip.foci[0]].region;
        let stack = Stack::from(sheet);
        Self::of((stack, Some(sheet)), speeds, request, target, region, strip.window, aim(region, &stack))
    }

    fn of(
        (stack, sheet): (Stack, Option<&'a HexagonalSheet>),
        speeds: [f64; 2],
        request: &LensRequest,
        target: &Target,
        region: &Region,
        window: [f64; 2],
        axis: f64,
    ) -> Self {
        let family = request.family;
        // No lens may lie in a focal region, nor a shield in the protected one.
        let first = region.rows[0].min(target.focal_rows()[0]);
        Self {
            sheet,
            stack,
            family,
            speeds,
            others: Vec::new(),
            window,
            axis,
            values: request.values(stack.diameter).unwrap_or_default(),
            open: request.open(),
            symmetry: Symmetry::Plane,
            region: region.x,
            depth: stack.depth(region.mid_row()),
            mid_row: region.mid_row(),
            region_rows: region.rows[1] - region.rows[0] + 1,
            last_free_row: first - 1,
            rows: request.rows,
            max_angle: request.max_interface_angle,
            apex_row: request.apex_row,
            back_row: request.back_row,
            radius: request.radius.filter(|_| family.radius().is_some()),
        }
    }

    /// Whether the fan for plano-convex lenses on the axis serves.
    pub(super) fn is_fast(&self) -> bool {
        self.sheet.is_some()
            && self.family.row().has_fan
            && self.axis == 0.0
            && self.window == [0.0, self.stack.half_width]
            && self.symmetry == Symmetry::Plane
    }

    /// Speeds (m/s) of host, lens and further materials.
    pub(super) fn palette_speeds(&self) -> Vec<f64> {
        self.speeds.iter().chain(&self.others).copied().collect()
    }

    pub(super) fn surrounds<'s>(&self, speeds: &'s [f64]) -> Surrounds<'s> {
        let end = self.stack.depth(f64::from(self.stack.rows));
        Surrounds { speeds, half_width: self.stack.half_width, end }
    }

    pub(super) fn place(&self, rows: [u32; 2]) -> Place<'_> {
        Place {
            depth: rows.map(|row| self.stack.depth(f64::from(row))),
            spacing: self.stack.spacing,
            window: self.window,
            axis: self.axis,
            focus: self.depth,
            speeds: self.mixed_speeds(),
            max_angle: self.max_angle,
            values: &self.values,
            others: self.others.len() as u32,
        }
    }

    /// Host and lens; of a mixture the slowest of all.
    fn mixed_speeds(&self) -> [f64; 2] {
        let slowest = self.others.iter().copied().fold(self.speeds[1], f64::min);
        if self.family.row().is_mixed { [self.speeds[0], slowest] } else { self.speeds }
    }

    /// The family's parameters by the names that results have.
    pub(super) fn parameters(&self) -> BTreeMap<String, f64> {
        self.family.parameters().iter().map(Parameter::key).zip(self.values.iter().copied()).collect()
    }

    /// The form between two rows; none if there is none within the limits.
    pub(super) fn form(&self, rows: [u32; 2], curvature: f64) -> Option<Form> {
        if rows[1] - rows[0] < self.family.least_span(&self.values) {
            return None;
        }
        self.family.form(&self.place(rows), curvature)
    }

    /// What part of the struck width, or of its strip, is served: passes the region or, of a shield, does not.
    pub(super) fn served(&self, rows: [u32; 2], curvature: f64, rays: usize) -> f64 {
        let Some(form) = self.form(rows, curvature) else { return 0.0 };
        let speeds = self.palette_speeds();
        let passing = passing(
            &*form.optics(self.surrounds(&speeds)),
            self.window,
            (self.depth, self.region),
            rays,
            self.symmetry,
        );
        if self.family.spares() { 1.0 - passing } else { passing }
    }

    /// Number of sites that a form covers; in space, where there are none yet, that that they are on average.
    pub(super) fn count(&self, shape: &Shape) -> usize {
        if let (true, Some(sheet)) = (self.is_fast(), self.sheet) {
            return shape.count(sheet);
        }
        let Some(form) = self.form([shape.apex_row, shape.back_row], 1.0 / shape.radius) else { return usize::MAX };
        let Stack { diameter, half_width, .. } = self.stack;
        let slack = 1e-9 * diameter;
        let Some(sheet) = self.sheet else {
            let extents = form.extents(2 + self.others.len(), half_width, self.symmetry);
            return (extents.iter().sum::<f64>() * self.symmetry.sites(diameter)).round() as usize;
        };
        let sites = (shape.apex_row..=shape.back_row)
            .flat_map(|row| (1..=sheet.columns(row)).filter_map(move |column| sheet.site(row, column)));
        sites.filter(|site| form.at([site.x, site.z], slack) != 0).count()
    }

    /// Fraction without a lens.
    pub(super) fn without(&self) -> f64 {
        let passing = without(&[self.region], self.window, self.symmetry);
        if self.family.spares() { 1.0 - passing } else { passing }
    }

    /// Whether a lens does more than none.
    pub(super) fn gains(&self, candidate: &Candidate) -> bool {
        candidate.fraction > self.without() + LEAST_GAIN
    }

    /// Whether a lens of these materials may serve at all: what gathers does so only if it is slower than its host.
    pub(super) fn may_gain(&self) -> bool {
        !self.family.row().gathers || self.speeds[1] < self.speeds[0]
    }

    /// Apex and back rows that may be tried.
    pub(super) fn row_ranges(&self) -> [[u32; 2]; 2] {
        let last = self.rows[1].min(self.last_free_row);
        let fixed_or = |fixed: Option<u32>, range| fixed.map_or(range, |row| [row, row]);
        [fixed_or(self.apex_row, [self.rows[0], last]), fixed_or(self.back_row, [self.rows[0], last])]
    }
}

/// Where a lens stands by itself, and a part of one aims: on a mirror line that the region touches, or in its middle.
pub(super) fn aim(region: &Region, stack: &Stack) -> f64 {
    let near = 0.75 * stack.diameter;
    match region.x {
        [low, _] if low <= near => 0.0,
        [_, high] if high >= stack.half_width - near => stack.half_width,
        [low, high] => 0.5 * (low + high),
    }
}
