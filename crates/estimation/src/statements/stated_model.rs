//! The model that statements make, and what they come to.

use gyradius_dispersion::{EntryMoments, RootMoments, following_factor};
use gyradius_inertia::Inertia;
use nalgebra::Vector3;

use super::{
    Stated, StatementError, StatementWarning,
    scatter::{Body, Law, Scatter, roots_of},
};

/// The model that statements make, and what they come to.
///
/// The inertia at the nominal mass has the law [`law_at_nominal_mass`](Self::law_at_nominal_mass); a
/// stated mass multiplies it by [`StatedMass::factor`]. [`law`](Self::law) is the law of the inertia alone, the
/// mass's part included.
#[derive(Clone, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct StatedModel {
    /// The nominal inertia.
    #[getset(get = "pub")]
    nominal: Inertia,
    scatter: Scatter,
    /// The law of the inertia at the nominal mass. Where no mass is stated it is that of
    /// [`law`](Self::law).
    #[getset(get = "pub")]
    law_at_nominal_mass: Law,
    /// The law of the inertia, with all that a stated mass does to it.
    #[getset(get = "pub")]
    law: Law,
    /// The mass, if it is stated.
    #[getset(get_copy = "pub")]
    mass: Option<StatedMass>,
    /// Standard deviations of the mass centre along body axes 1, 2, 3, m, if they are stated. The mass centre is
    /// independent of the inertia about it.
    #[getset(get_copy = "pub")]
    centre_deviations: Option<[f64; 3]>,
    /// Standard deviations of the roots of the second moments with all that a stated mass does to them, √kg·m. Their means are
    /// those of the nominal inertia.
    #[getset(get_copy = "pub")]
    root_deviations: [f64; 3],
    rotations: [f64; 3],
    /// Standard deviations of the six entries as stated, kg·m², in the order 11, 22, 33, 12, 13, 23.
    #[getset(get_copy = "pub")]
    stated: [Option<f64>; 6],
    /// Mean and covariance of the six entries under the law, by quadrature.
    #[getset(get = "pub")]
    implied: EntryMoments,
    warnings: Vec<StatementWarning>,
}

/// A normal mass, and how the inertia goes with it.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[getset(get_copy = "pub")]
pub struct StatedMass {
    /// The standard deviation of the mass over the nominal mass.
    relative_deviation: f64,
    /// The share α of the mass's relative change that the inertia takes, from 0 to 1: one, unless the moments are
    /// stated to vary by less than the mass makes them vary.
    inertia_follows: f64,
}

impl StatedMass {
    pub(super) fn new(relative_deviation: f64, inertia_follows: f64) -> Self {
        Self { relative_deviation, inertia_follows }
    }

    /// What the inertia is multiplied by where the mass is `ratio` times the nominal one:
    /// 1 + α(ratio − 1).
    #[must_use]
    pub fn factor(&self, ratio: f64) -> f64 {
        following_factor(ratio, self.inertia_follows)
    }

    /// The standard deviation of that factor.
    pub(super) fn factor_deviation(&self) -> f64 {
        self.inertia_follows * self.relative_deviation
    }
}

impl StatedModel {
    pub(super) fn new(
        nominal: &Inertia,
        body: &Body,
        stated: &Stated,
        mass: Option<StatedMass>,
        centre: Option<[f64; 3]>,
        scatter: Scatter,
    ) -> Result<Self, StatementError> {
        let at_nominal_mass = body.law(&scatter)?;
        let implied = body.moments(&scatter, &at_nominal_mass);
        let square = mass.map_or(0.0, |mass| mass.factor_deviation().powi(2));
        let (law, roots) = if square > 0.0 {
            // Of a product of independent factors.
            let k = at_nominal_mass.roots().second_moment_statistics();
            let mean = Vector3::from(k.mean());
            let moments = k.covariance() * (1.0 + square) + mean * mean.transpose() * square;
            let roots = roots_of(body.roots, &moments);
            (body.law(&Scatter { roots, ..scatter })?, roots)
        } else {
            (at_nominal_mass.clone(), scatter.roots)
        };
        Ok(Self {
            nominal: *nominal,
            scatter,
            law_at_nominal_mass: at_nominal_mass,
            law,
            mass,
            centre_deviations: centre,
            root_deviations: roots.diagonal().map(f64::sqrt).into(),
            rotations: scatter.rotation_variances(),
            stated: std::array::from_fn(|e| match e {
                0..3 => stated.moments.map(|m| m[e]),
                _ => stated.products.map(|p| p[e - 3]),
            }),
            implied: implied.times_factor(square),
            warnings: Vec::new(),
        })
    }

    pub(super) fn with_warnings(self, warnings: Vec<StatementWarning>) -> Self {
        Self { warnings, ..self }
    }

    /// The scatter of the inertia at the nominal mass.
    pub(super) fn scatter(&self) -> &Scatter {
        &self.scatter
    }

    /// Standard deviations of the rotations about principal axes 1, 2, 3, rad; infinite where nothing
    /// is known of one. The law of the axes holds none closer than 2e-6 rad.
    #[must_use]
    pub fn turns(&self) -> [f64; 3] {
        self.rotations.map(f64::sqrt)
    }

    /// Contradictions, and what has been left open.
    #[must_use]
    pub fn warnings(&self) -> &[StatementWarning] {
        &self.warnings
    }
}

gyradius_dispersion::written!(
    StatedMass,
    |mass| {
        relative_deviation: f64 = mass.relative_deviation,
        inertia_follows_mass: f64 = mass.inertia_follows,
    },
    {
        let is_share = (0.0..=1.0).contains(&inertia_follows_mass);
        crate::read::belong(is_share && relative_deviation >= 0.0, "stated mass")?;
        StatedMass::new(relative_deviation, inertia_follows_mass)
    }
);

gyradius_dispersion::written!(
    StatedModel,
    |model| {
        nominal_kg_m2: Inertia = model.nominal,
        scatter: Scatter = model.scatter,
        at_nominal_mass: Law = model.law_at_nominal_mass.clone(),
        law: Law = model.law.clone(),
        mass: Option<StatedMass> = model.mass,
        mass_centre_m: Option<[f64; 3]> = model.centre_deviations,
        root_deviation_sqrt_kg_m: [f64; 3] = model.root_deviations,
        #[serde(deserialize_with = "crate::read::or_infinite")]
        rotation_variance_rad2: [f64; 3] = model.rotations,
        stated_kg_m2: [Option<f64>; 6] = model.stated,
        implied: EntryMoments = model.implied,
        warnings: Vec<StatementWarning> = model.warnings.clone(),
    },
    {
        let deviations = root_deviation_sqrt_kg_m.iter().chain(&rotation_variance_rad2);
        let mut deviations = deviations.chain(mass_centre_m.iter().flatten());
        crate::read::belong(deviations.all(|deviation| *deviation >= 0.0), "stated model")?;
        StatedModel {
            nominal: nominal_kg_m2,
            scatter,
            law_at_nominal_mass: at_nominal_mass,
            law,
            mass,
            centre_deviations: mass_centre_m,
            root_deviations: root_deviation_sqrt_kg_m,
            rotations: rotation_variance_rad2,
            stated: stated_kg_m2,
            implied,
            warnings,
        }
    }
);
