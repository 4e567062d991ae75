//! From plain statements to the table of a study: mass, mass centre and inertia scatter as stated, and
//! go together.

use gyradius_estimation::{Amount, CentreStatement, MassStatement, MomentsStatement, Statements};
use gyradius_inertia::{Inertia, InertiaMatrix};
use gyradius_statistics::Moments;
use gyradius_study::{Entry, Fragment, FragmentBody, Options, Quantity, Scenario, Study};

/// The paper's scenario, one model, with the fragment for its payload.
fn pasted(fragment: &Fragment) -> String {
    let text = Scenario::peck_2003().unwrap().to_toml();
    let models = text.find("[[models]]").unwrap();
    let second = models + 1 + text[models + 1..].find("[[models]]").unwrap();
    let text = text[..second].replace("comparisons = []\n", "");
    let payload = text.find("[payload]").unwrap();
    let stage = text.find("[stage]").unwrap();
    let state = "\nmass_kg = 1e4\nposition_m = [0.0, 0.0, 1.0]\n\n[payload.dispersion]";
    let fragment = fragment.to_string().replace("\n[payload.dispersion]", state);
    format!("{}{fragment}\n{}", &text[..payload], &text[stage..])
}

#[test]
fn a_study_has_what_was_stated() {
    let payload = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]).unwrap();
    let nominal = Inertia::try_from(payload).unwrap();
    for (moments, mass, follows) in [(10.0, 2.0, 1.0), (10.0, 8.0, 1.0), (2.0, 4.0, 0.5)] {
        let statements = Statements {
            moments: Some(MomentsStatement::new(Amount::Percent([moments; 3]), 1.0).unwrap()),
            mass: Some(MassStatement::percent(mass, 1.0).unwrap()),
            centre: Some(CentreStatement::new([0.01, 0.02, 0.03], 1.0, [0.0; 3]).unwrap()),
            ..Statements::default()
        };
        let model = statements.model(&nominal, Some(1e4)).unwrap();
        let stated_mass = model.mass().unwrap();
        assert!((stated_mass.inertia_follows() - follows).abs() < 1e-3);
        let fragment = Fragment::new(FragmentBody::Payload, &nominal, model.law_at_nominal_mass())
            .unwrap()
            .with_mass(100.0 * stated_mass.relative_deviation(), stated_mass.inertia_follows())
            .unwrap()
            .with_mass_centre(model.centre_deviations().unwrap())
            .unwrap();
        let scenario = Scenario::from_toml(&pasted(&fragment)).unwrap();
        // And the resolved scenario says the same.
        let scenario = Scenario::from_toml(&scenario.to_toml()).unwrap();
        let scratch = tempfile::tempdir().unwrap();
        let options = Options { out: Some(scratch.path().join("s")), ..Options::default() };
        let study = Study::run(&scenario.with_runs(4_000).unwrap(), &options, &|_| {}).unwrap();
        let tables = study.tables().unwrap();
        let table = &tables[0];
        let deviation = |values: &[f64]| Moments::new(values).unwrap().standard_deviation();
        let near = |found: f64, expected: f64| {
            // Four standard errors of a deviation of 4,000 runs.
            assert!((found / expected - 1.0).abs() < 4.0 / 8_000_f64.sqrt(), "{found} {expected}");
        };
        let masses = table.values("payload_mass_kg").unwrap();
        near(deviation(&masses), 100.0 * mass);
        for (i, expected) in [0.01, 0.02, 0.03].into_iter().enumerate() {
            let centre = table.values(&format!("payload_mass_centre_{}_m", i + 1)).unwrap();
            near(deviation(&centre), expected);
        }
        for (entry, nominal) in [(Entry::I11, 5e3), (Entry::I22, 4e3), (Entry::I33, 3e3)] {
            let values = Quantity::entry(FragmentBody::Payload, entry).in_table(table);
            near(deviation(&values), 0.01 * moments * nominal);
            let (a, b) = (Moments::new(&masses).unwrap(), Moments::new(&values).unwrap());
            let together: f64 = masses
                .iter()
                .zip(&values)
                .map(|(x, y)| (x - a.mean()) * (y - b.mean()))
                .sum::<f64>();
            let correlation =
                together / 3_999.0 / (a.standard_deviation() * b.standard_deviation());
            let expected = mass * follows / moments;
            assert!((correlation - expected).abs() < 4.0 / 4_000_f64.sqrt(), "{correlation}");
        }
    }
}
