//! Models with given mean and covariance of the entries.

use gyradius_inertia::InertiaMatrix;
use nalgebra::SMatrix;

use crate::{DispersionModel, EntryMoments, ModelKind};

/// Why no model of a kind has given moments.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kind}: {problem}")]
pub struct MatchError {
    /// The kind of model.
    pub kind: ModelKind,
    /// What is wrong.
    pub problem: String,
}

/// A model made to have given moments, as far as its kind can.
#[derive(Clone, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct Matched {
    /// The model.
    #[getset(get = "pub")]
    model: DispersionModel,
    /// What of the moments it has, in words.
    #[getset(get_copy = "pub")]
    what: &'static str,
}

impl Matched {
    /// The model.
    #[must_use]
    pub fn into_model(self) -> DispersionModel {
        self.model
    }
}

impl DispersionModel {
    /// The model of a kind whose six entries have the given mean and covariance, as far as its kind can;
    /// [`Matched::what`] says how far.
    ///
    /// | kind | matched |
    /// |---|---|
    /// | `entrywise` | mean and six deviations; no correlation |
    /// | `correlated-entries` | mean and covariance |
    /// | `realizable-…` | as above *before* rejection, which moves both |
    /// | `log-cholesky` | mean and covariance; to first order where no such law is found |
    /// | `wishart` | mean, and E‖Σ − Σ̄‖² |
    /// | `basilisk` | the mean as its nominal matrix; variances summed over moments and over products |
    /// | `principal` | Gaussian roots and axes: mean, covariance of the principal moments, covariance of turns, the last two to first order |
    ///
    /// # Errors
    /// The mean belongs to no body where the kind needs one, or no law of the kind is this wide.
    ///
    /// ```
    /// use gyradius_dispersion::{DispersionModel, KnownMoments, ModelKind, Wishart};
    /// use gyradius_inertia::{Inertia, InertiaMatrix};
    ///
    /// let mean = InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0])?;
    /// let moments = Wishart::new(Inertia::try_from(mean)?, 0.05)?.entry_moments();
    /// for kind in ModelKind::ALL {
    ///     let matched = DispersionModel::matched(kind, &moments)?;
    ///     println!("{kind}: {}", matched.what());
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn matched(kind: ModelKind, moments: &EntryMoments) -> Result<Matched, MatchError> {
        let fail =
            |problem: &dyn std::fmt::Display| MatchError { kind, problem: format!("{problem}") };
        let [i11, i22, i33, i12, i13, i23] = moments.mean();
        let mean =
            InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23]).map_err(|e| fail(&e))?;
        let moments = EntryMoments::unchecked(moments.mean(), without_rounding(moments));
        let (model, what) = Self::of_kind(kind, mean, &moments).map_err(|e| fail(&e))?;
        Ok(Matched { model, what })
    }
}

/// The covariance with what is rounding set to zero.
fn without_rounding(moments: &EntryMoments) -> SMatrix<f64, 6, 6> {
    let (c, rounding) = (moments.covariance(), moments.rounding());
    let varies = |e: usize| c[(e, e)] > rounding[e];
    SMatrix::from_fn(|e, f| if varies(e) && varies(f) { c[(e, f)] } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry_moments::tests::check_entries;
    use crate::second_moment_matrix::inertia_map;
    use crate::{AxesLaw, FixedAttitude, KnownMoments, PrincipalDispersion, RootLaw, ScalarRoots};
    use gyradius_attitude::{RadiallyConstrainedGaussian, UniformAttitude};
    use gyradius_inertia::{Inertia, RootSecondMoments};
    use nalgebra::{Matrix3, Matrix4, UnitQuaternion};
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    fn paper(spread: f64) -> PrincipalDispersion<ScalarRoots, RadiallyConstrainedGaussian> {
        let mean = InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.3, 0.2, -0.5]).unwrap();
        let mean = Inertia::try_from(mean).unwrap();
        let roots = mean.second_moments().roots();
        let variances = roots.values().map(|k| (0.5 * spread * k).powi(2));
        PrincipalDispersion::new(
            ScalarRoots::normal(roots, variances).unwrap(),
            RadiallyConstrainedGaussian::new(
                mean.principal_axes().attitude(),
                Matrix4::identity() * (0.25 * spread * spread),
            )
            .unwrap(),
        )
    }

    fn matched(kind: ModelKind, moments: &EntryMoments) -> DispersionModel {
        DispersionModel::matched(kind, moments).unwrap().into_model()
    }

    #[test]
    fn every_kind_has_what_it_says() {
        for spread in [0.01, 0.1, 0.2] {
            let target = paper(spread).entry_moments();
            let (mean, covariance) = (target.mean(), target.covariance());
            for kind in ModelKind::ALL {
                let model = matched(kind, &target);
                assert_eq!(model.kind(), kind);
                let Some(found) = model.entry_moments() else {
                    assert!(model.acceptance().unwrap() > 0.1);
                    continue;
                };
                let gap = (0..6).map(|e| (found.mean()[e] - mean[e]).abs()).fold(0.0, f64::max);
                let off = (found.covariance() - covariance).amax() / covariance.amax();
                let trace = |c: &SMatrix<f64, 6, 6>| c.diagonal().sum();
                let total = trace(found.covariance()) / trace(covariance) - 1.0;
                let (allowed_mean, allowed_off) = match kind {
                    ModelKind::CORRELATED_ENTRIES | ModelKind::LogCholesky => (1e-8, 1e-8),
                    ModelKind::Principal => (1e-3 * spread, 0.01),
                    // The trace of the covariance of all nine is that of six plus three more.
                    ModelKind::Wishart => (1e-12, 3.0),
                    ModelKind::ENTRYWISE => (1e-12, 1.0),
                    _ => (4.0 * spread * spread, 3.0),
                };
                assert!(gap <= allowed_mean, "{kind} {spread}: mean off by {gap:e}");
                assert!(off <= allowed_off, "{kind} {spread}: covariance off by {off:e}");
                if matches!(kind, ModelKind::ENTRYWISE | ModelKind::Basilisk) {
                    assert!(total.abs() < 1e-5, "{kind} {spread}: {total:e}");
                }
            }
        }
    }

    #[test]
    fn wishart_has_the_mean_square_of_the_second_moments() {
        let target = paper(0.1).entry_moments();
        let found = matched(ModelKind::Wishart, &target).entry_moments().unwrap();
        let map = inertia_map().try_inverse().unwrap();
        let square = |c: &SMatrix<f64, 6, 6>| {
            let c = map * c * map.transpose();
            c.diagonal().sum() + c.fixed_view::<3, 3>(3, 3).trace()
        };
        let (a, b) = (square(found.covariance()), square(target.covariance()));
        assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    }

    #[test]
    fn draws_have_the_moments_that_the_model_says() {
        let target = paper(0.1).entry_moments();
        for (i, kind) in ModelKind::ALL.into_iter().enumerate() {
            let model = matched(kind, &target);
            if let Some(moments) = model.entry_moments() {
                let seed = 150 + i as u64;
                check_entries::<InertiaMatrix>(kind.name(), &moments, &model, seed);
            }
            let mut rng = ChaCha8Rng::seed_from_u64(160);
            if kind.is_realizable_by_construction() {
                assert!((0..1000).all(|_| {
                    Distribution::<InertiaMatrix>::sample(&model, &mut rng).is_realizable()
                }));
            }
        }
    }

    #[test]
    fn nothing_varies_where_nothing_is_to() {
        let fixed = EntryMoments::new(paper(0.1).entry_moments().mean(), SMatrix::zeros()).unwrap();
        for kind in ModelKind::ALL {
            let found = matched(kind, &fixed);
            let mut rng = ChaCha8Rng::seed_from_u64(161);
            let draw: InertiaMatrix = found.sample(&mut rng);
            for (x, y) in draw.entries().iter().zip(fixed.mean()) {
                assert!((x - y).abs() < 1e-5, "{kind}: {x} {y}");
            }
        }
    }

    /// Bodies about any axes: with moments that are equal, alike or not.
    fn bodies() -> impl Strategy<Value = Inertia> {
        let alike =
            prop_oneof![Just(0.0), (-12.0..-1.0).prop_map(|x: f64| libm::exp10(x)), 0.05..0.9_f64];
        let size = (-2.0..3.0).prop_map(|x: f64| libm::exp10(x));
        (size, alike.clone(), alike, any::<bool>(), any::<u64>()).prop_map(
            |(size, one, two, turned, seed)| {
                let moments = [1.0, 1.0 - 0.5 * one, 1.0 - 0.4 * two].map(|x| x * size);
                let axes = if turned {
                    UniformAttitude
                        .sample(&mut ChaCha8Rng::seed_from_u64(seed))
                        .to_rotation_matrix()
                        .into_inner()
                } else {
                    Matrix3::identity()
                };
                let matrix = axes * Matrix3::from_diagonal(&moments.into()) * axes.transpose();
                Inertia::new((matrix + matrix.transpose()) * 0.5).unwrap()
            },
        )
    }

    fn roots_of(body: &Inertia, level: f64) -> ScalarRoots {
        let roots = body.second_moments().roots();
        ScalarRoots::normal(roots, roots.values().map(|k| (0.5 * level * k).powi(2))).unwrap()
    }

    proptest! {
        /// Deviations are those that are asked for, however small some of them are beside the others: products of bodies whose moments are alike
        /// hardly vary. A kind that cannot have them says so.
        #[test]
        fn small_deviations_are_no_rounding(body in bodies(), level in (-5.0..-1.0).prop_map(|x: f64| libm::exp10(x))) {
            let axes = RadiallyConstrainedGaussian::from_rotation_covariance(
                body.principal_axes().attitude(),
                Matrix3::from_diagonal_element(level * level),
                0.01,
            );
            let target = PrincipalDispersion::new(roots_of(&body, level), axes.unwrap()).entry_moments();
            let moments = body.principal_axes().moments();
            let [least, most] = [f64::min, f64::max].map(|of| moments.into_iter().fold(moments[0], of));
            for kind in ModelKind::ALL {
                let found = DispersionModel::matched(kind, &target);
                if kind == ModelKind::Principal {
                    // Axes that turn move no product of equal moments.
                    prop_assert!(found.is_err() || most - least > 1e-9 * most, "{:?}", moments);
                    continue;
                }
                let (what, model) = found.map(|found| (found.what(), found.into_model())).unwrap();
                let has_sums = kind == ModelKind::Basilisk;
                if !has_sums && (kind == ModelKind::Wishart || what.contains("first order")) {
                    continue;
                }
                let Some(own) = model.entry_moments() else { continue };
                let squares = |m: &EntryMoments| -> Vec<f64> {
                    let squares = m.deviations().map(|x| x * x);
                    if has_sums { squares.chunks(3).map(|part| part.iter().sum()).collect() } else { squares.to_vec() }
                };
                for (own, asked) in squares(&own).into_iter().zip(squares(&target)) {
                    prop_assert!((own / asked - 1.0).abs() < 1e-4, "{} {}: {:e} {:e}", kind, level, own, asked);
                }
            }
        }

        /// The small moment of a thin body has its deviation, however much larger those of the others are.
        #[test]
        fn thin_bodies_keep_their_small_moment(
            thin in prop::array::uniform2(-7.0..0.0_f64),
            (size, level) in ((-3.0..6.0_f64).prop_map(libm::exp10), (-6.0..-1.0_f64).prop_map(libm::exp10)),
            long in 0..3_usize,
            seed in any::<Option<u64>>(),
        ) {
            let mut k = [1.0, libm::exp10(thin[0]), libm::exp10(thin[1])].map(|x| (size * x).sqrt());
            k.rotate_right(long);
            let attitude = seed.map_or_else(UnitQuaternion::identity, |seed| {
                UniformAttitude.sample(&mut ChaCha8Rng::seed_from_u64(seed))
            });
            let roots = ScalarRoots::normal(RootSecondMoments::new(k).unwrap(), k.map(|k| (level * k).powi(2))).unwrap();
            let axes = AxesLaw::Fixed(FixedAttitude::new(attitude));
            let target = PrincipalDispersion::new(RootLaw::from(roots), axes).entry_moments();
            for kind in [ModelKind::ENTRYWISE, ModelKind::CORRELATED_ENTRIES] {
                let own = matched(kind, &target).entry_moments().unwrap();
                for (own, asked) in own.deviations().into_iter().zip(target.deviations()) {
                    prop_assert!((own - asked).abs() <= 1e-9 * asked, "{} {:e} {:e}", kind, own, asked);
                }
            }
        }

        /// About axes that are fixed, products in these axes are rounding, which no kind is asked for.
        #[test]
        fn what_does_not_vary_is_rounding(body in bodies(), level in (-9.0..-1.0).prop_map(|x: f64| libm::exp10(x))) {
            let axes = AxesLaw::Fixed(FixedAttitude::new(body.principal_axes().attitude()));
            let target = PrincipalDispersion::new(RootLaw::from(roots_of(&body, level)), axes).entry_moments();
            let moments = body.principal_axes().moments();
            let most = moments.into_iter().fold(0.0, f64::max);
            // Of moments that are alike nobody knows the axes.
            if (0..3).any(|i| (moments[i] - moments[(i + 1) % 3]).abs() <= 1e-4 * most) {
                return Ok(());
            }
            let own = matched(ModelKind::Principal, &target).entry_moments().unwrap();
            let gap = own.covariance() - target.covariance();
            // What is fixed turns by 3e-7 rad.
            prop_assert!(gap.amax() < 1e-3 * target.covariance().amax() + (1e-6 * most).powi(2), "{:e} {:?}", gap.amax(), moments);
        }
    }

    #[test]
    fn what_cannot_be_matched_is_said() {
        let target = paper(0.1).entry_moments();
        let wide = EntryMoments::new(target.mean(), target.covariance() * 1e6).unwrap();
        for kind in [ModelKind::Wishart, ModelKind::Principal] {
            let error = DispersionModel::matched(kind, &wide).unwrap_err();
            assert!(error.to_string().starts_with(kind.name()), "{error}");
        }
        let mut impossible = target.mean();
        impossible[0] = 50.0;
        let impossible = EntryMoments::new(impossible, *target.covariance()).unwrap();
        for kind in ModelKind::ALL {
            let needs_a_body = !matches!(
                kind,
                ModelKind::ENTRYWISE | ModelKind::CORRELATED_ENTRIES | ModelKind::Basilisk
            );
            assert_eq!(
                DispersionModel::matched(kind, &impossible).is_err(),
                needs_a_body,
                "{kind}"
            );
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn models_serialize_with_their_names() {
        let target = paper(0.1).entry_moments();
        for kind in ModelKind::ALL {
            let model = matched(kind, &target);
            let json = serde_json::to_string(&model).unwrap();
            assert!(json.contains(&format!(r#""model":"{kind}""#)), "{json}");
            let back: DispersionModel = serde_json::from_str(&json).unwrap();
            assert_eq!(serde_json::to_string(&back).unwrap().len(), json.len());
            let mut rngs = [1, 1].map(ChaCha8Rng::seed_from_u64);
            let a: InertiaMatrix = model.sample(&mut rngs[0]);
            let b: InertiaMatrix = back.sample(&mut rngs[1]);
            assert!((a.matrix() - b.matrix()).amax() < 1e-9, "{kind}");
        }
    }
}
