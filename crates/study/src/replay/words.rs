//! A run on a page.

use gyradius_clearance::ShapeClearance;
use gyradius_separation::Separation;
use std::fmt::{self, Display, Formatter};

use gyradius_report::{optional, significant};

use super::Replay;
use crate::{
    body::{Body, Entry},
    column::{CLEARANCE_NOTE, REALIZABLE, RECOMPRESSED},
    drawn,
    loads::Short,
    quantity::Quantity,
};

/// Pairs of shapes that are told of.
const MOST_PAIRS: usize = 24;

/// How near two shapes come, and when.
fn approach(shapes: &ShapeClearance) -> String {
    let said = match (shapes.closest(), shapes.contact_s()) {
        (_, Some(time)) => format!("touch at {} s", significant(time, 6)),
        (Some(a), None) => {
            format!("{} m at {} s", significant(a.distance_m(), 6), significant(a.time_s(), 6))
        }
        (None, None) => return "mated, and do not part".to_owned(),
    };
    match shapes.counts_from_s().filter(|_| shapes.is_mated()) {
        Some(time) => format!("{said}, mated until {} s", significant(time, 6)),
        None => said,
    }
}

/// When outlines touch again, or until when they do not.
fn recontact(found: Option<f64>, given_up: bool, until: Option<f64>, coast: f64) -> String {
    match (found, given_up, until) {
        (Some(time), ..) => format!("at {time:.9} s"),
        (None, true, _) => {
            "none found, and it is not known, for the search was given up".to_owned()
        }
        (None, false, Some(until)) => format!("none up to {until} s, and it is not known after"),
        (None, false, None) => format!("none up to {coast} s after the last release"),
    }
}

impl Display for Replay {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (scenario, row) = (&self.scenario, self.row());
        let flight = scenario.fleet().map(|fleet| format!(" {}", fleet.told(row.run())));
        writeln!(
            f,
            "{}, model {}, run {} of {}{}, seed {}",
            scenario.name(),
            self.model,
            row.run(),
            scenario.runs(),
            flight.unwrap_or_default(),
            scenario.seed()
        )?;
        writeln!(f, "status: {}", row.status())?;
        writeln!(f, "{}", self.table)?;
        write!(f, "\ninertia (kg·m²)")?;
        for entry in Entry::ALL {
            write!(f, "{:>11}", Quantity::entry(Body::Payload, entry).label())?;
        }
        for body in Body::BOTH {
            write!(f, "\n  {:13}", body.name())?;
            for entry in Entry::ALL {
                write!(f, "{:>11}", optional(Quantity::entry(body, entry).in_row(&row), 5))?;
            }
        }
        writeln!(f)?;
        if row.flag(REALIZABLE) == Some(false) {
            writeln!(f, "  no distribution of mass has such inertia")?;
        }
        self.drawn(f)?;
        if row.failure().is_some() {
            return match (&self.case.separation, self.history.moments.last()) {
                (Err(_), _) => writeln!(f, "\nit never began"),
                (Ok(_), None) => writeln!(f, "\nit fails in its first step, and is not followed"),
                (Ok(_), Some(last)) => writeln!(
                    f,
                    "\nfollowed to {} s, springs released by then: {}",
                    significant(last.now.time_s(), 5),
                    self.history.releases.len()
                ),
            };
        }

        let loads: Vec<_> = self.case.separation.iter().flat_map(Separation::loads).collect();
        let mut kinds: Vec<_> = loads.iter().map(|(id, _)| id.kind.plural()).collect();
        kinds.dedup();
        write!(f, "\n{}", kinds.join(", "))?;
        for (id, load) in loads {
            let start = load.start_s().filter(|start| *start > 0.0);
            let number = Short(id);
            match Quantity::Release(id).in_row(&row) {
                None if load.can_push() => {
                    write!(
                        f,
                        "\n  {number} comes to its release length before it starts, and never pushes"
                    )?;
                }
                None => write!(f, "\n  {number} never pushes")?,
                Some(_) => {
                    if let Some(start) = start {
                        write!(f, "\n  {number} starts at {start:.9} s")?;
                    }
                }
            }
        }
        for (load, time) in &self.history.releases {
            write!(f, "\n  {} lets go at {time:.9} s", Short(*load))?;
        }
        for load in row.text(RECOMPRESSED).into_iter().flat_map(str::split_whitespace) {
            write!(f, "\n  {load} is pressed again later, and stays lost")?;
        }
        writeln!(f)?;
        let value = |quantity: Quantity| optional(quantity.in_row(&row), 6);
        let three = |of: [Quantity; 3]| of.map(value).join(", ");
        let mut line = |what: &str, value: String, unit: &str| {
            let unit = if value == "–" { "" } else { unit };
            write!(f, "\n  {what:42}{value}{unit}")
        };
        let nutation = |now: Quantity, least, greatest| match now.in_row(&row) {
            Some(_) => format!("{}° in [{}°, {}°]", value(now), value(least), value(greatest)),
            // The payload does not turn.
            None => value(now),
        };
        line("relative speed", value(Quantity::RelativeSpeed), " m/s")?;
        line("relative velocity, inertial axes", three(Quantity::RELATIVE_VELOCITY), " m/s")?;
        line("angle to the intended direction", value(Quantity::DirectionError), "°")?;
        line("tip-off of the payload, body axes", three(Quantity::PAYLOAD_TIP_OFF), " deg/s")?;
        line("tip-off of the stage, body axes", three(Quantity::STAGE_TIP_OFF), " deg/s")?;
        let rate = Quantity::SpinRate.in_row(&row).map(f64::to_degrees);
        line("spin rate of the payload", optional(rate, 6), " deg/s")?;
        line("wobble", value(Quantity::Wobble), "°")?;
        let (now, least) = (Quantity::Nutation, Quantity::NutationLeast);
        line("nutation, and its bounds", nutation(now, least, Quantity::NutationGreatest), "")?;
        if Quantity::NutationBefore.in_row(&row).is_some() {
            let (now, least) = (Quantity::NutationBefore, Quantity::NutationLeastBefore);
            let greatest = Quantity::NutationGreatestBefore;
            line("the same at the start", nutation(now, least, greatest), "")?;
        }
        line("cone", value(Quantity::Cone), "°")?;
        line("angular momentum, inertial axes", three(Quantity::MOMENTUM), " kg·m²/s")?;
        line("angle to its intended direction", value(Quantity::MomentumError), "°")?;
        line("inertia ratio", value(Quantity::InertiaRatio), "")?;
        if let (None, Some(note)) = (&self.clearance, row.text(CLEARANCE_NOTE)) {
            line("clearance", note.to_string(), "")?;
        }
        if let (Some(outlines), Some(clearance)) = (self.scenario.outlines(), &self.clearance) {
            let [payload, stage] = outlines.shapes();
            let shapes = |s: &ShapeClearance| {
                let (i, j) = (s.payload_shape(), s.stage_shape());
                let (a, b) = (payload[i].name(), stage[j].name());
                format!("payload {} ({a}) and stage {} ({b})", i + 1, j + 1)
            };
            let nearest = match clearance.closest_shapes() {
                Some(s) => format!("{}, {}", approach(s), shapes(s)),
                None => "none".to_owned(),
            };
            line("clearance", nearest, "")?;
            if let Some(note) = row.text(CLEARANCE_NOTE) {
                line("", note.to_string(), "")?;
            }
            if clearance.shapes().len() > 1 {
                for s in clearance.shapes().iter().take(MOST_PAIRS) {
                    line(&format!("  {}", shapes(s)), approach(s), "")?;
                }
            }
            let found = Quantity::RecontactTime.in_row(&row);
            let until = clearance.undecided_from_s();
            let touch = recontact(found, self.given_up, until, outlines.coast_s());
            line("recontact", touch, "")?;
        }
        line("energy of the springs", value(Quantity::SpringEnergy), " J")?;
        let both = |a, b| format!("{} and {}", value(a), value(b));
        let (translation, rotation) = (Quantity::PayloadTranslation, Quantity::PayloadRotation);
        line("  payload: translation and rotation", both(translation, rotation), " J")?;
        let (translation, rotation) = (Quantity::StageTranslation, Quantity::StageRotation);
        line("  stage: translation and rotation", both(translation, rotation), " J")?;
        writeln!(f)
    }
}

impl Replay {
    /// What else was drawn, beside its nominal value, and how far it is from the mean of its law in
    /// standard deviations.
    fn drawn(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let dispersed = self.scenario.dispersions().all();
        if dispersed.is_empty() {
            return Ok(());
        }
        let width = dispersed.iter().map(|d| d.column.len()).max().unwrap_or(0);
        let [value, nominal, sigmas] = ["drawn", "nominal", "σ from mean"];
        writeln!(f, "\nalso dispersed{:1$}{value:>14}{nominal:>14}{sigmas:>14}", "", width - 12)?;
        let in_time: Vec<usize> = drawn::in_time(&self.scenario, &self.case.drawn).collect();
        for (place, (d, value)) in dispersed.iter().zip(&self.case.drawn).enumerate() {
            let sigmas = (value - d.law.mean()) / d.law.deviation();
            // Nothing of what happens or not, nor of a start that is not late.
            let is_told = !in_time.contains(&place) && d.law.as_bernoulli().is_none();
            let tells = sigmas.is_finite() && is_told;
            let sigmas = if tells { format!("{sigmas:.2}") } else { "–".to_owned() };
            let (value, nominal) = (significant(*value, 7), significant(d.nominal, 7));
            writeln!(f, "  {:width$}{value:>14}{nominal:>14}{sigmas:>14}", d.column)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::recontact;
    use crate::{Replay, Scenario};

    /// That there is no contact is said only as far as the search has gone.
    #[test]
    fn no_contact_is_told_of_what_was_not_searched() {
        for found in [None, Some(0.25)] {
            for given_up in [false, true] {
                for until in [None, Some(7.5)] {
                    let told = recontact(found, given_up, until, 60.0);
                    assert_eq!(told.starts_with("at 0.25"), found.is_some(), "{told}");
                    let is_sure = found.is_none() && !given_up;
                    assert_eq!(told.starts_with("none up to"), is_sure, "{told}");
                    let end = if until.is_some() { "7.5" } else { "60" };
                    assert_eq!(told.contains(end), is_sure, "{told}");
                }
            }
        }
    }

    /// Angles that a payload without spin does not have are left out with their units, whatever else the page tells.
    #[test]
    fn what_there_is_not_has_no_unit() {
        for spin in [0.0, 1e-3, 2.0] {
            let body = |name: &str, place: f64, spin: f64| {
                format!(
                    "[{name}]\nmass_kg = 100.0\ninertia_kg_m2 = [[10.0, 0, 0], [0, 11.0, 0], [0, 0, 12.0]]\n\
                     position_m = [0, 0, {place:?}]\nangular_velocity_rad_per_s = [0, 0.1, {spin:?}]\n\
                     [{name}.dispersion]\nroot_second_moment_variance_kg_m2 = [0.0, 0, 0]\naxes = \"fixed\"\n"
                )
                .replace("[0, 0.1, 0.0]", "[0, 0, 0]")
            };
            let text = format!(
                "name = \"straight\"\nruns = 1\n{}{}[[springs]]\nstiffness_n_per_m = 1000.0\nstroke_m = 0.1\n\
                 payload_point_m = [0, 0, -0.95]\nstage_point_m = [0, 0, 0.95]\n\
                 [[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n",
                body("payload", 1.0, spin),
                body("stage", -1.0, 0.0)
            );
            let replay = Replay::new(&Scenario::from_toml(&text).unwrap(), None, 0, 1.0).unwrap();
            let page = replay.to_string();
            assert!(!page.contains("–°") && !page.contains("[–"), "{page}");
            let told =
                page.lines().find(|line| line.trim_start().starts_with("nutation, and its bounds"));
            assert_eq!(told.unwrap().ends_with(" –"), spin == 0.0, "{page}");
        }
    }

    /// Of every number that has a spread the distance from its mean is told, also where it is just the nominal value, but for what happens
    /// or not, and for the start of a spring that is not late.
    #[test]
    fn distances_from_the_mean_are_told() {
        // Zero is a change of the stroke and of the mass by nothing.
        let samples = "{ law = \"samples\", samples = [0.0, 0.01, 0.02] }";
        let body = |name: &str, place: f64| {
            format!(
                "[{name}]\nmass_kg = 100.0\ninertia_kg_m2 = [[10.0, 0, 0], [0, 11.0, 0], [0, 0, 12.0]]\nposition_m = [0, 0, {place:?}]\n\
                 [{name}.dispersion]\nroot_second_moment_variance_kg_m2 = [0.0, 0, 0]\naxes = \"fixed\"\nmass_kg = {samples}\n"
            )
        };
        let text = format!(
            "name = \"samples\"\nruns = 40\n{}{}[[springs]]\nstiffness_n_per_m = 1000.0\nstroke_m = 0.1\n\
             payload_point_m = [0, 0, -0.95]\nstage_point_m = [0, 0, 0.95]\n[springs.dispersion]\nstroke_m = {samples}\n\
             start_s = {{ law = \"samples\", samples = [0.0, 0.01] }}\nlate_probability = 0.5\nfailure_probability = 0.3\n\
             [[springs]]\nstiffness_n_per_m = 1000.0\nstroke_m = 0.1\npayload_point_m = [0, 0, -0.95]\nstage_point_m = [0, 0, 0.95]\n\
             [[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n",
            body("payload", 1.0),
            body("stage", -1.0)
        );
        let scenario = Scenario::from_toml(&text).unwrap();
        let mut nominal = [0, 0];
        for run in 0..40 {
            let replay = Replay::new(&scenario, None, run, 1.0).unwrap();
            let page = replay.to_string();
            let drawn = |column: &str| {
                let line = page.lines().find(|line| line.trim_start().starts_with(column)).unwrap();
                let mut words = line.split_whitespace().skip(1);
                let [value, nominal, sigmas] = [(); 3].map(|()| words.next().unwrap().to_owned());
                (value == nominal, value == "0", sigmas)
            };
            for column in ["payload_mass_kg", "stage_mass_kg", "spring_1_stroke_m"] {
                let (is_nominal, _, sigmas) = drawn(column);
                let known: f64 = sigmas.parse().unwrap_or_else(|_| panic!("{page}"));
                // (0, 0.01, 0.02) have the mean 0.01, and a standard deviation of √(2/3) × 0.01.
                assert_eq!((known + 1.5_f64.sqrt()).abs() < 0.006, is_nominal, "{page}");
                nominal[0] += usize::from(is_nominal);
            }
            let (_, in_time, _) = drawn("spring_1_late");
            let (is_nominal, _, sigmas) = drawn("spring_1_start_s");
            assert_eq!(sigmas.parse::<f64>().is_err(), in_time, "{page}");
            nominal[1] += usize::from(is_nominal && !in_time);
            for event in ["spring_1_late", "spring_1_failure"] {
                assert_eq!(drawn(event).2, "–", "{page}");
            }
        }
        assert!(nominal.iter().all(|count| *count > 4), "{nominal:?}");
    }
}
