//! What the page says of requirements on quantities that runs may have no value of.

use crate::{Options, Scenario, Study};
use std::{collections::BTreeSet, fs};

/// Two bodies that part along one line, with requirements.
fn parting(requirements: &str) -> Scenario {
    let body = |name: &str, z: f64| {
        format!(
            "[{name}]\nmass_kg = 500.0\ninertia_kg_m2 = [[120.0, 0.0, 0.0], [0.0, 110.0, 0.0], [0.0, 0.0, 90.0]]\n\
             position_m = [0.0, 0.0, {z:?}]\n[{name}.dispersion]\nroot_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\naxes = \"fixed\"\n"
        )
    };
    let text = format!(
        "name = \"parting\"\nruns = 40\n{}{}\
         [[springs]]\nstiffness_n_per_m = 2e4\nstroke_m = 0.1\npayload_point_m = [0.0, 0.0, -0.9]\nstage_point_m = [0.0, 0.0, 0.9]\n\
         [[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n\
         [clearance]\ncoast_s = 10.0\npayload = [{{ hull_m = [[0.5, 0.5, -0.8], [-0.5, 0.5, -0.8], [0.0, -0.5, -0.8]] }}]\n\
         stage = [{{ ring = {{ centre_m = [0.0, 0.0, 0.9], axis = [0.0, 0.0, 1.0], radius_m = 0.6 }} }}]\n\
         {requirements}",
        body("payload", 1.0),
        body("stage", -1.0)
    );
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The page of a study in Markdown, and the figures of its first requirement.
fn pages(scenario: &Scenario) -> (String, [String; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    Study::run(scenario, &Options::to(out.clone()), &|_| {}).unwrap();
    let read = |name: &str| fs::read_to_string(out.join(name)).unwrap();
    let figures = ["distribution", "convergence"].map(|of| read(&format!("figures/{of}-1.svg")));
    (read("report.md"), figures)
}

/// What is said of the intervals and of the band is what is shown: of one look, or of as many as a rule took.
#[test]
fn figures_say_for_how_many_looks_they_hold() {
    let required = "[[requirements]]\nname = \"light\"\nquantity = \"payload_i11\"\nat_most = 130.0\nprobability = 0.5\nconfidence = 0.9\n";
    let until = "[until]\nrule = \"decided\"\nlook_every = 10\nmost_runs = 40\n";
    for (until, often) in [("", false), (until, true)] {
        let (page, [distribution, convergence]) = pages(&parting(&format!("{required}{until}")));
        let section = |heading: &str| {
            let (_, rest) = page.split_once(heading).unwrap_or_else(|| panic!("{page}"));
            rest.split("\n#").next().unwrap().to_owned()
        };
        let shares = section("### Convergence");
        assert_eq!(shares.contains("confidence sequence"), often, "{shares}");
        assert_eq!(shares.contains("(Clopper and Pearson"), !often, "{shares}");
        assert_eq!(convergence.contains("intervals that hold together"), often);
        let band = section("### Distributions");
        assert_eq!(band.contains("takes no account"), often, "{band}");
        assert_eq!(distribution.contains("if one looks once"), often);
    }
}

/// Requirements about any one model, and about all: in all figures of the study that have a legend, each model has one colour.
#[test]
fn models_have_one_colour_in_all_figures() {
    let base = Scenario::peck_2003().unwrap().with_runs(40).unwrap();
    let names: Vec<&str> = base.model_names().collect();
    let required = |about: Option<&&str>| {
        let model = about.map_or_else(String::new, |name| format!("model = {name:?}\n"));
        let name = about.unwrap_or(&"all");
        format!(
            "[[requirements]]\nname = {name:?}\nquantity = \"nutation_deg\"\nat_most = 5.0\nprobability = 0.5\nconfidence = 0.9\n{model}"
        )
    };
    let abouts = names.iter().rev().map(Some).chain([None]);
    let text = format!("{}\n{}", base.to_toml(), abouts.map(required).collect::<String>());
    let scenario = Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    Study::run(&scenario, &Options::to(out.clone()), &|_| {}).unwrap();
    let figures = fs::read_dir(out.join("figures")).unwrap();
    let figures: Vec<String> = figures
        .map(|file| file.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "svg"))
        .map(|path| fs::read_to_string(path).unwrap())
        .collect();
    let mut colours = BTreeSet::new();
    for name in &names {
        // The swatch of a legend stands before the name.
        let of = figures.iter().filter_map(|svg| {
            let (before, _) = svg.split_once(&format!(">{name}<"))?;
            let (_, swatch) = before.rsplit_once("<g transform")?;
            let (swatch, between) = swatch.split_once("</g>")?;
            let is_own = between.matches("<text").count() == 1;
            is_own.then(|| swatch.split_once("=\"#").unwrap().1[..6].to_owned())
        });
        let of: Vec<String> = of.collect();
        // Both figures of two requirements, and histograms.
        assert!(of.len() > 4 && of.iter().all(|colour| *colour == of[0]), "{name}: {of:?}");
        colours.insert(of[0].clone());
    }
    assert_eq!(colours.len(), names.len(), "{colours:?}");
}

/// The worst runs of vehicles are those of first flights, which is said, and not of plain runs or of flights that have nothing in common.
#[test]
fn the_worst_first_flights_are_told_to_be_those() {
    let required = "[[requirements]]\nname = \"light\"\nquantity = \"payload_i11\"\nat_most = 1.0\nprobability = 0.5\nconfidence = 0.9\n";
    let plain = parting(required).to_toml();
    let flights = plain.replace("runs = 40\n", "vehicles = 8\nflights = 5\n");
    let drawn = "root_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\n";
    for (text, of_first) in [
        (plain.clone(), false),
        (flights.clone(), false),
        (flights.replace(drawn, &format!("{drawn}inertia_drawn = \"vehicle\"\n")), true),
    ] {
        let (page, _) = pages(&Scenario::from_toml(&text).unwrap());
        assert!(page.contains("The worst runs"), "{page}");
        assert_eq!(
            page.contains("the worst of the first flights of the vehicles"),
            of_first,
            "{text}"
        );
    }
}

/// Bodies that never touch have no time of contact: no run failed, and none has a number.
#[test]
fn runs_without_a_value_are_told() {
    for (failed_runs, of, what) in [
        ("against", "40 of 40", "40 of 40 have no number: counted against it"),
        ("left-out", "0 of 0", "40 of 40 have no number: left out"),
    ] {
        let (page, _) = pages(&parting(&format!(
            "[[requirements]]\nname = \"no contact before\"\nquantity = \"recontact_s\"\nat_least = 10.0\nprobability = 0.5\n\
             confidence = 0.9\nfailed_runs = \"{failed_runs}\"\n"
        )));
        let row = page.lines().find(|line| line.starts_with("| **no contact before**"));
        let row = row.unwrap_or_else(|| panic!("{page}"));
        assert!(row.contains(of) && row.contains(what), "{row}");
        assert!(page.contains("if it has no value of the quantity"), "{page}");
    }
}
