//! Uncertain rigid-body mass properties: every library of gyradius under one name, and the program `gyradius`.
//!
//! `cargo add gyradius --no-default-features` gives the libraries; the feature `program`, which is on by default, adds
//! [`run`], the command line. Each module below is a crate that can be had alone: `gyradius::inertia` is
//! `gyradius-inertia`. [`nalgebra`], [`rand`] and [`rand_distr`] are in the versions that the libraries take and give.
//!
//! Inertia is about the mass centre, in body axes, in kg·m²; products are tensor entries, I₁₂ = −∫ x₁x₂ dm.
//!
//! # The libraries
//! Inertias that some body has ([`inertia`]):
//! ```
//! use gyradius::inertia::{Inertia, InertiaMatrix};
//!
//! let matrix = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0])?;
//! assert!(Inertia::try_from(matrix)?.is_invertible());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! Random attitudes ([`attitude`]), with any generator of [`rand`]:
//! ```
//! use gyradius::{attitude::RadiallyConstrainedGaussian, campaign::Streams};
//! use gyradius::nalgebra::{Matrix4, UnitQuaternion};
//! use gyradius::rand_distr::Distribution;
//!
//! let spread = Matrix4::from_diagonal_element(1e-4);
//! let law = RadiallyConstrainedGaussian::new(UnitQuaternion::identity(), spread)?;
//! let axes = law.sample(&mut Streams::new(2003, "example", "axes").run(0));
//! assert!(axes.angle() < 0.2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! Random inertia ([`dispersion`]), every draw of which some body has:
//! ```
//! use gyradius::campaign::Streams;
//! use gyradius::dispersion::{FixedAttitude, PrincipalDispersion, ScalarLaw, ScalarRoots};
//! use gyradius::inertia::Inertia;
//! use gyradius::{nalgebra::UnitQuaternion, rand_distr::Distribution};
//!
//! let root = |mean, deviation| ScalarLaw::normal(mean, deviation); // √kg·m
//! let roots = ScalarRoots::new([root(31.6, 0.35)?, root(44.7, 0.32)?, root(54.8, 0.27)?])?;
//! let law = PrincipalDispersion::new(roots, FixedAttitude::new(UnitQuaternion::identity()));
//! let drawn: Inertia = law.sample(&mut Streams::new(2003, "example", "payload inertia").run(0));
//! assert!(drawn.as_inertia_matrix().is_realizable());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! The law of an inertia from samples or from plain statements ([`estimation`]):
//! ```
//! use gyradius::estimation::{Amount, MomentsStatement, Statements};
//! use gyradius::inertia::{Inertia, InertiaMatrix};
//!
//! let nominal = InertiaMatrix::from_entries([900.0, 1000.0, 1100.0], [0.0; 3])?;
//! let statements = Statements {
//!     moments: Some(MomentsStatement::new(Amount::Percent([2.0; 3]), 1.0)?),
//!     ..Statements::default()
//! };
//! let model = statements.model(&Inertia::try_from(nominal)?, None)?;
//! assert!((model.implied().deviations()[0] - 18.0).abs() < 0.2); // kg·m²
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! Two bodies pushed apart by springs ([`separation`]):
//! ```
//! use gyradius::inertia::InertiaMatrix;
//! use gyradius::nalgebra::Vector3;
//! use gyradius::separation::{Body, Separation, Settings, Spring};
//!
//! let inertia = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [0.0; 3])?;
//! let (payload, stage) = (Body::new(1e4, inertia)?, Body::new(4e3, inertia)?);
//! let spring = Spring::new(1e5, 0.1, Vector3::z() * -0.9, Vector3::z() * 0.9)?;
//! let separation = Separation::new(payload.at(Vector3::z()), stage.at(-Vector3::z()), &[spring])?;
//! let outcome = separation.run(&Settings::default())?;
//! // All of ½ k δ² = 500 J goes into the motion of 1/(1/10 t + 1/4 t).
//! assert!((outcome.relative_speed() - (2.0 * 500.0_f64 / 2857.142857).sqrt()).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! The smallest distance of two bodies in motion ([`clearance`]):
//! ```
//! use gyradius::clearance::{Clearance, ClearanceSettings, Coast, FreeBody, Outline, OutlineShape, RigidState};
//! use gyradius::nalgebra::{Matrix3, Vector3};
//!
//! let state = |z: f64, speed: f64| RigidState {
//!     position: Vector3::z() * z,
//!     velocity: Vector3::z() * speed,
//!     ..RigidState::default()
//! };
//! let body = |state| FreeBody::new(state, Matrix3::identity());
//! let (payload, stage) = (body(state(1.0, 0.3))?, body(state(-1.0, 0.0))?);
//! let ring = |z: f64| OutlineShape::ring(Vector3::z() * z, Vector3::z(), 0.5).map(Outline::from);
//! let clearance = Clearance::new(
//!     &ring(-0.9)?,
//!     &ring(0.9)?,
//!     &mut Coast::new(&payload, &stage, 0.0),
//!     0.0,
//!     60.0,
//!     &ClearanceSettings::default(),
//! )?;
//! assert!((clearance.closest().unwrap().distance_m() - 0.2).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! Summaries of samples with intervals ([`statistics`]):
//! ```
//! use gyradius::statistics::{Confidence, Moments};
//!
//! let moments = Moments::new(&[15.8, 16.0, 16.2, 15.6, 16.4])?;
//! println!("{:.2} {:.2}", moments.mean(), moments.mean_interval(Confidence::default()));
//! # Ok::<(), gyradius::statistics::StatisticsError>(())
//! ```
//! Inertias in robot and CAD files ([`formats`]):
//! ```
//! use gyradius::formats::{InertiaFile, Products, TOLERANCE, judge};
//!
//! let csv = "name,ixx,iyy,izz,ixy,ixz,iyz\nplate,1,1,3,0,0,0\n";
//! let file = InertiaFile::parse("plate.csv".as_ref(), csv.into(), Products::TensorEntries)?;
//! let plate = &file.bodies()[0];
//! let judgement = judge(plate.inertia()?, plate.mass_kg(), TOLERANCE);
//! assert!(!judgement.report().is_realizable()); // 3 > 1 + 1
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! Monte Carlo of any simulation, with streams that make every run repeatable ([`campaign`]):
//! ```
//! use gyradius::{campaign::Streams, rand::RngExt};
//!
//! let masses = Streams::new(2003, "proposed", "payload mass");
//! let mass: f64 = masses.run(1234).random();
//! assert_eq!(mass, Streams::new(2003, "proposed", "payload mass").run(1234).random::<f64>());
//! ```
//! Figures and pages ([`report`]):
//! ```
//! use gyradius::report::{HistogramGrid, Panel, Series};
//!
//! let series = vec![Series::new("measured", &[0.4, 0.6, 0.3, 0.5], 4)];
//! let panel = Panel { label: "wobble (deg)".to_owned(), series, nominal: Some(0.5) };
//! assert!(HistogramGrid::new("Wobble", &[Some(panel)], 1).svg().contains("<svg"));
//! ```
//! The separation study itself ([`study`]):
//! ```no_run
//! use gyradius::study::{Options, Scenario, Study};
//!
//! let scenario = Scenario::peck_2003()?.with_runs(500)?;
//! let study = Study::run(&scenario, &Options::default(), &|_done| {})?;
//! println!("{}", study.summary());
//! # Ok::<(), gyradius::study::StudyError>(())
//! ```

pub use gyradius_attitude as attitude;
pub use gyradius_campaign as campaign;
pub use gyradius_clearance as clearance;
pub use gyradius_dispersion as dispersion;
pub use gyradius_estimation as estimation;
pub use gyradius_formats as formats;
pub use gyradius_inertia as inertia;
pub use gyradius_report as report;
pub use gyradius_separation as separation;
pub use gyradius_statistics as statistics;
pub use gyradius_study as study;
pub use {nalgebra, rand, rand_distr};

#[cfg(feature = "program")]
mod program;
#[cfg(feature = "program")]
pub use program::{run, run_as};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
