//! Whether the loads of a scenario push the bodies apart.

use gyradius_separation::Separation;
use nalgebra::{Unit, Vector3};

use super::{ScenarioError, load, unit};

/// A force that is more than 120° from a direction goes against it: cosines below this.
const AGAINST: f64 = -0.5;

/// That no load pushes the payload through the stage, as a wrong sign of a point makes it do.
///
/// Such a load pushes against the direction from the stage's mass centre to the payload's. A payload
/// that leaves through a stage around it may have all its loads push that way: then the scenario
/// states the `separation_direction`, and loads that go with it are right. There the wrong one is that which
/// goes against it. Without a statement the direction is that of all the loads together, so that the
/// resolved scenario, which states it, is judged the same.
pub(super) fn check(
    separation: &Separation,
    stated: Option<[f64; 3]>,
    together: Option<Unit<Vector3<f64>>>,
) -> Result<(), ScenarioError> {
    let between = separation.payload().state().position - separation.stage().state().position;
    let Some(away) = unit(between) else { return Ok(()) };
    let stated = stated.and_then(|direction| unit(direction.into()));
    let through = stated.or(together).filter(|direction| direction.dot(&away) < AGAINST);
    for (id, load) in separation.loads().filter(|(_, load)| load.can_push()) {
        let line = load.line(separation.payload().state(), separation.stage().state());
        let Some(push) = unit(line) else { continue };
        let against = |direction: &Unit<Vector3<f64>>| push.dot(direction) < AGAINST;
        let where_to = if against(&away) && stated.as_ref().is_none_or(against) {
            "through the stage, whose mass centre is on that side"
        } else if through.as_ref().is_some_and(against) {
            "against the separation_direction in which the payload leaves through the stage"
        } else {
            continue;
        };
        let point: [f64; 3] = load.points_m()[0].into();
        let entries: Vec<_> =
            push.iter().map(|x| format!("{}", (1e3 * x).round() / 1e3 + 0.0)).collect();
        let problem = format!(
            "{point:?}: the payload point lies behind the stage point, so that the {} pushes the \
             payload towards ({}) (inertial axes), {where_to}. Check the signs of payload_point_m and \
             stage_point_m, and position_m of the bodies; if the payload is to leave that way, state \
             separation_direction",
            id.kind,
            entries.join(", ")
        );
        let field = format!("{}.payload_point_m", load::key(id));
        return Err(ScenarioError::field(field, problem));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scenario;
    use nalgebra::UnitQuaternion;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, Uniform};

    /// A scenario with bodies, and points given from the mass centres in inertial axes, at random.
    struct Case {
        text: String,
        points: Vec<[Vector3<f64>; 2]>,
        positions: [Vector3<f64>; 2],
    }

    /// Springs that push the payload along `way` within 60° or so.
    fn case(random: &mut impl FnMut(f64) -> f64, way: f64) -> Case {
        let mut vector = |range: f64| Vector3::from_fn(|_, _| random(range));
        let axis = vector(1.0).normalize();
        let between = axis * (2.0 + random(1.5));
        let positions = [between * 0.4, between * -0.6];
        let mut vector = |range: f64| Vector3::from_fn(|_, _| random(range));
        let points = (0..3).map(|_| {
            let stage = vector(1.0);
            let aside = vector(1.0);
            let push = (axis * way + (aside - axis * axis.dot(&aside)) * 0.6).normalize() * 0.3;
            [stage + push, stage]
        });
        let points = points.collect();
        Case { text: Scenario::peck_2003().unwrap().to_toml(), points, positions }
    }

    impl Case {
        fn read(&self, direction: Option<Vector3<f64>>) -> Result<Scenario, ScenarioError> {
            let mut file: toml::Table = self.text.parse().unwrap();
            let list = |v: Vector3<f64>| toml::Value::from(v.iter().copied().collect::<Vec<_>>());
            file.remove("separation_direction");
            if let Some(direction) = direction {
                file.insert("separation_direction".into(), list(direction));
            }
            for (body, position) in ["payload", "stage"].into_iter().zip(self.positions) {
                let body = file[body].as_table_mut().unwrap();
                body.insert("position_m".into(), list(position));
            }
            let springs = file["springs"].as_array_mut().unwrap();
            springs.truncate(self.points.len());
            for (spring, [payload, stage]) in springs.iter_mut().zip(&self.points) {
                let spring = spring.as_table_mut().unwrap();
                spring.insert("payload_point_m".into(), list(payload - self.positions[0]));
                spring.insert("stage_point_m".into(), list(stage - self.positions[1]));
            }
            Scenario::from_toml(&toml::to_string(&file).unwrap())
        }
    }

    /// Any bodies anywhere: springs that push apart are taken, one that is turned round is named, and a
    /// payload that leaves through the stage is taken where its direction is stated.
    #[test]
    fn a_spring_the_wrong_way_round_is_named() {
        let mut generator = ChaCha8Rng::seed_from_u64(12);
        let uniform = Uniform::new(-1.0, 1.0).unwrap();
        let mut random = |range: f64| range * uniform.sample(&mut generator);
        for i in 0..200 {
            let mut good = case(&mut random, 1.0);
            let scenario = good.read(None).unwrap();
            // So is what it resolves to, directions spelled out.
            Scenario::from_toml(&scenario.to_toml()).unwrap();
            let wrong = i % 3;
            good.points[wrong].swap(0, 1);
            let error = good.read(None).unwrap_err().to_string();
            let name = format!("springs[{}].payload_point_m: ", wrong + 1);
            // Within 60° of straight back.
            assert!(error.starts_with(&name), "{error}");
            let away = good.positions[0] - good.positions[1];
            assert!(good.read(Some(away)).is_err());

            let mut through = case(&mut random, -1.0);
            assert!(through.read(None).is_err());
            let away = through.positions[1] - through.positions[0];
            let scenario = through.read(Some(away)).unwrap();
            Scenario::from_toml(&scenario.to_toml()).unwrap();
            // One of these that is turned round pushes along the line of the mass centres.
            through.points[wrong].swap(0, 1);
            let error = through.read(Some(away)).unwrap_err().to_string();
            assert!(error.starts_with(&name), "{error}");
        }
    }

    /// Springs in any directions: what is taken is taken again as it resolves, its direction stated.
    #[test]
    fn what_is_taken_resolves_to_what_is_taken() {
        let mut generator = ChaCha8Rng::seed_from_u64(21);
        let uniform = Uniform::new(-1.0, 1.0).unwrap();
        let mut random = |range: f64| range * uniform.sample(&mut generator);
        let mut taken = 0;
        for _ in 0..600 {
            let mut any = case(&mut random, 1.0);
            // Mostly across, where the sum may go anywhere.
            let away = (any.positions[0] - any.positions[1]).normalize();
            for [payload, stage] in &mut any.points {
                let aside = Vector3::from_fn(|_, _| random(1.0));
                let aside = (aside - away * away.dot(&aside)).normalize();
                *payload = *stage + (aside + away * random(0.9)).normalize() * (0.2 + random(0.1));
            }
            let Ok(scenario) = any.read(None) else { continue };
            taken += 1;
            Scenario::from_toml(&scenario.to_toml()).unwrap();
        }
        assert!(taken > 100, "{taken}");
    }

    /// Springs across, which push neither together nor apart, and pairs against each other are taken.
    #[test]
    fn springs_across_are_taken() {
        for angle in (0..360).step_by(5) {
            let turn =
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), f64::from(angle).to_radians());
            let side = turn * Vector3::x();
            let good = Case {
                text: Scenario::peck_2003().unwrap().to_toml(),
                points: vec![[side * 0.3, Vector3::zeros()], [side * -0.3, Vector3::zeros()]],
                positions: [Vector3::z(), -Vector3::z()],
            };
            let scenario = good.read(None).unwrap();
            Scenario::from_toml(&scenario.to_toml()).unwrap();
        }
    }
}
