//! What a crystal may be made of: one material, a dimer of two, or engineered spheres.

use super::{Bound, Dimension, bound};
use crate::contact::{Constants, Pair};
use crate::material::{Material, aliases};

/// Which way a medium is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Spheres of one material.
    Uniform,
    /// Two materials in turn: sphere by sphere in a chain, row by row or layer by layer in a sheet or a close packing, so
    /// that every contact which the wave loads is a mixed one.
    Dimer,
    /// Spheres that touch as one material and weigh as something else: coated, or hollow.
    Engineered,
}

impl Kind {
    /// In one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Dimer => "dimer",
            Self::Engineered => "engineered",
        }
    }
}

/// A crystal's make, without its packing.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Full name, such as `stainless-440c + brass-260`.
    pub name: String,
    /// Short name for pictures, such as `440c+brass`.
    pub label: String,
    /// Which way it is made.
    pub kind: Kind,
    /// The materials of two neighbours, the same twice unless it is a dimer. An engineered sphere's has the contact values
    /// of its surface and its mean density.
    pub materials: [Material; 2],
    /// Thickness of an engineered sphere's shell over the sphere's radius.
    pub shell: Option<f64>,
}

/// An engineered sphere that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MediumError {
    /// A mean density that no share of core and shell has.
    #[error(
        "a core of {core} in a shell of {shell} cannot weigh {density} kg/m3: core and shell allow {low} to {high} kg/m3"
    )]
    Coated {
        /// The shell's material.
        shell: String,
        /// The core's material.
        core: String,
        /// The mean density asked for (kg/m³).
        density: f64,
        /// The lowest that can be had (kg/m³).
        low: f64,
        /// The highest that can be had (kg/m³).
        high: f64,
    },
    /// A hollow sphere that is not lighter than a solid one, or weighs nothing.
    #[error("a hollow sphere has a density factor between 0 and 1, not {0}")]
    Hollow(f64),
}

fn short(material: &Material) -> &str {
    aliases(&material.name).first().copied().unwrap_or(&material.name)
}

impl Medium {
    /// Spheres of one material.
    pub fn uniform(material: &Material) -> Self {
        Self {
            name: material.name.clone(),
            label: short(material).to_owned(),
            kind: Kind::Uniform,
            materials: [material.clone(), material.clone()],
            shell: None,
        }
    }

    /// Two materials in turn.
    pub fn dimer(a: &Material, b: &Material) -> Self {
        Self {
            name: format!("{} + {}", a.name, b.name),
            label: format!("{}+{}", short(a), short(b)),
            kind: Kind::Dimer,
            materials: [a.clone(), b.clone()],
            shell: None,
        }
    }

    /// Spheres with a core in a shell that touch as solid ones of the shell's material and have the mean `density` (kg/m³).
    ///
    ///   ρ = ρ_shell + (ρ_core − ρ_shell) (r_core/R)³
    ///
    /// The core's own density is the limit of a thin shell. See [`Medium::core_force`] for what a shell bears.
    ///
    /// # Errors
    /// A density that is not between those of core and shell.
    pub fn coated(shell: &Material, core: &Material, density: f64) -> Result<Self, MediumError> {
        let low = shell.density.min(core.density);
        let high = shell.density.max(core.density);
        let share = (density - shell.density) / (core.density - shell.density);
        if !(0.0..=1.0).contains(&share) {
            let (shell, core) = (shell.name.clone(), core.name.clone());
            return Err(MediumError::Coated { shell, core, density, low, high });
        }
        let factor = density / shell.density;
        Ok(Self {
            name: format!("{} core in {}, density x {factor:.3}", core.name, shell.name),
            label: format!("{} core in {}, ρ×{}", short(core), short(shell), brief(factor)),
            ..Self::weighing(shell, density, 1.0 - share.cbrt())
        })
    }

    /// Hollow spheres that touch as solid ones and have `factor` times their density.
    ///
    /// # Errors
    /// A factor that is not between 0 and 1.
    pub fn hollow(material: &Material, factor: f64) -> Result<Self, MediumError> {
        if !(factor > 0.0 && factor < 1.0) {
            return Err(MediumError::Hollow(factor));
        }
        Ok(Self {
            name: format!("hollow {}, density x {factor:.3}", material.name),
            label: format!("hollow {}, ρ×{}", short(material), brief(factor)),
            ..Self::weighing(material, factor * material.density, 1.0 - (1.0 - factor).cbrt())
        })
    }

    fn weighing(surface: &Material, density: f64, shell: f64) -> Self {
        let material = Material { density, ..surface.clone() };
        Self {
            name: String::new(),
            label: String::new(),
            kind: Kind::Engineered,
            materials: [material.clone(), material],
            shell: Some(shell),
        }
    }

    /// Every material by itself, then every two as a dimer.
    pub fn all(materials: &[Material]) -> Vec<Self> {
        let dimers =
            materials.iter().enumerate().flat_map(|(k, a)| materials[k + 1..].iter().map(move |b| Self::dimer(a, b)));
        materials.iter().map(Self::uniform).chain(dimers).collect()
    }

    /// The engineered spheres of Burgoyne 2016, section 4.3, of those that the materials allow: tungsten carbide coated
    /// with aluminium to five times the density of aluminium, and hollow tungsten carbide of a fifth of its density.
    pub fn published_engineered(materials: &[Material]) -> Vec<Self> {
        let named = |name: &str| materials.iter().find(|material| material.name == name);
        let (shell, core) = (named("aluminium-2017"), named("tungsten-carbide"));
        let coated = shell.zip(core).and_then(|(shell, core)| Self::coated(shell, core, 5.0 * shell.density).ok());
        coated.into_iter().chain(core.and_then(|core| Self::hollow(core, 0.2).ok())).collect()
    }

    /// Mean density of two neighbours (kg/m³).
    pub fn density(&self) -> f64 {
        0.5 * (self.materials[0].density + self.materials[1].density)
    }

    /// The contact of two neighbours of `diameter` (m).
    pub fn pair(&self, diameter: f64, constants: Constants) -> Pair {
        Pair::new([&self.materials[0], &self.materials[1]], [0.5 * diameter; 2], constants)
    }

    /// See [`bound`].
    pub fn bound(&self, dimension: Dimension, diameter: f64, constants: Constants) -> Bound {
        bound(dimension, [&self.materials[0], &self.materials[1]], diameter, constants)
    }

    /// Z = ρ V (kg/(m² s)), the impedance per area of solid. The packing fraction by which a crystal is lighter than the
    /// solid cancels between two crystals of one packing.
    pub fn impedance(&self, bound: &Bound) -> f64 {
        self.density() * bound.speed
    }

    /// The Young's modulus of the uniform medium with the same E*, at the mean Poisson's ratio of the two: E = 2 (1−ν²) E*.
    pub fn equivalent_modulus(&self) -> f64 {
        let ratio = 0.5 * (self.materials[0].poisson_ratio + self.materials[1].poisson_ratio);
        2.0 * (1.0 - ratio * ratio) * self.pair(1.0, Constants::default()).modulus
    }

    /// The contact force (N) at which plasticity reaches an engineered sphere's core; none for solid spheres.
    ///
    /// An estimate: the plastic zone is taken to be as deep as the contact is wide, π a² c₁ σ_y = F with a = the shell's
    /// thickness. Above it the sphere no longer touches as a solid one, and where it lies below F_p the bound never holds.
    pub fn core_force(&self, diameter: f64, constants: Constants) -> Option<f64> {
        let pair = self.pair(diameter, constants);
        let pressure = pair.regions(1.0).pressure_ratio * pair.yield_stress;
        self.shell.map(|shell| std::f64::consts::PI * (0.5 * diameter * shell).powi(2) * pressure)
    }
}

/// A factor to three digits without trailing zeros.
fn brief(factor: f64) -> String {
    format!("{}", (factor * 1e3).round() / 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{find, library};

    /// Weighed as core and shell, ρ = ρ_s + (ρ_c − ρ_s) s³.
    #[test]
    fn an_engineered_sphere_weighs_what_core_and_shell_weigh() {
        let [al, wc] = ["al", "wc"].map(|name| find(name, &[]).unwrap());
        let coated = Medium::coated(&al, &wc, 5.0 * al.density).unwrap();
        let core = (1.0 - coated.shell.unwrap()).powi(3);
        assert!((core * wc.density + (1.0 - core) * al.density - 5.0 * al.density).abs() < 1e-8);
        let hollow = Medium::hollow(&wc, 0.2).unwrap();
        assert!((1.0 - (1.0 - hollow.shell.unwrap()).powi(3) - 0.2).abs() < 1e-12);
        assert_eq!(Medium::coated(&al, &wc, wc.density).unwrap().shell, Some(0.0));
        let error = Medium::coated(&al, &wc, 6.0 * al.density).unwrap_err().to_string();
        assert!(error.contains("cannot weigh 16200 kg/m3") && error.contains("2700 to 15450"), "{error}");
        assert!(Medium::coated(&al, &al, 3000.0).is_err());
        for factor in [0.0, 1.0, -1.0, f64::NAN] {
            assert!(Medium::hollow(&wc, factor).is_err());
        }
    }

    /// The shells of both published engineered spheres are too thin for the bound, as estimated here.
    #[test]
    fn plasticity_reaches_the_core_of_the_published_engineered_spheres() {
        for medium in Medium::published_engineered(&library()) {
            let full = medium.bound(Dimension::One, 6.35e-3, Constants::Code).plastic_force;
            assert!(medium.core_force(6.35e-3, Constants::Code).unwrap() < full, "{}", medium.name);
        }
    }

    #[test]
    fn an_equal_pair_has_its_own_modulus() {
        for material in library() {
            let equivalent = Medium::uniform(&material).equivalent_modulus();
            assert!((equivalent / material.youngs_modulus - 1.0).abs() < 1e-12);
        }
    }
}
