//! In how many runs the payload leaves the wrong way, however the stack stands when the clamp opens.

use gyradius_campaign::Table;
use gyradius_separation::{BodyParameter, Stack, StackParameter};
use nalgebra::Vector3;

use crate::{
    body::Body,
    drawn,
    quantity::Quantity,
    scenario::{Scenario, Target},
};

/// In how many runs of a table the payload leaves by more than 90° away from where it is to go. The intended direction is that of the
/// undispersed scenario; where attitudes are dispersed, it is turned with the stage, for a stack that is turned as a whole parts as before.
pub(crate) fn backwards(scenario: &Scenario, table: &Table) -> u64 {
    let Some(intended) = scenario.separation_direction() else { return 0 };
    let numbers = |quantity: Quantity| table.numbers(&quantity.column());
    let [Some(x), Some(y), Some(z)] = Quantity::RELATIVE_VELOCITY.map(numbers) else { return 0 };
    // None in runs in which the bodies do not part, whose velocity is rounding.
    let Some(parted) = numbers(Quantity::DirectionError) else { return 0 };
    let all = scenario.dispersions().all().iter();
    let turns = all.filter(|dispersed| turns_stage(dispersed.target));
    let turns = turns.map(|dispersed| Some((dispersed.target, table.numbers(&dispersed.column)?)));
    let Some(turns) = turns.collect::<Option<Vec<_>>>() else { return 0 };
    let nominal = scenario.stage().moving().state().attitude;
    // In the axes of the stage.
    let intended = nominal.inverse() * intended.into_inner();
    let mut stack = Stack::from(scenario.separation());
    let undispersed = stack.attitude(Body::Stage) * intended;
    let mut is_backwards = |place: usize| {
        parted.get(place)?;
        let velocity = Vector3::new(x.get(place)?, y.get(place)?, z.get(place)?);
        for (target, numbers) in &turns {
            drawn::put(&mut stack, *target, numbers.get(place)?);
        }
        // The attitude of most scenarios is the same in all runs.
        let intended =
            if turns.is_empty() { undispersed } else { stack.attitude(Body::Stage) * intended };
        Some(velocity.dot(&intended) < 0.0)
    };
    (0..table.len()).filter(|place| is_backwards(*place) == Some(true)).count() as u64
}

/// Whether it is a component of what turns the stage, alone or with the payload.
fn turns_stage(target: Target) -> bool {
    match target {
        Target::Body(body, parameter, _) => {
            body == Body::Stage && parameter == BodyParameter::Attitude
        }
        Target::Stack(parameter, _) => parameter == StackParameter::Attitude,
        Target::Load(..) | Target::Late(..) | Target::Fails(_) => false,
    }
}

#[cfg(test)]
mod tests;
