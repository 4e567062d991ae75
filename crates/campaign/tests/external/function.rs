//! Functions in the place of a process: the same table, the same reasons.

use gyradius_campaign::{Outputs, RunInputs, Simulator, SimulatorFunction, threads};
use proptest::prelude::*;
use rayon::prelude::*;
use std::{
    cell::Cell,
    collections::BTreeSet,
    ops::Range,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
};

use super::{assert_rows, simulation, simulator, table};

type Mischief = fn(&mut Outputs) -> Result<(), String>;

/// What a function may do in the place of an answer, the same of a process, and the reason of both.
const MISCHIEF: [(Mischief, &str, &str); 7] = [
    (
        |y| {
            y.pop();
            Ok(())
        },
        r#"echo '{"outputs":{"y":1}}'; return"#,
        "an output is missing",
    ),
    (
        |y| {
            y.push(y[0].clone());
            Ok(())
        },
        r#"echo '{"outputs":{"y":1,"seed":2,"y":1}}'; return"#,
        "an output is repeated",
    ),
    (
        |y| {
            y[0].0 = "Y".into();
            Ok(())
        },
        r#"echo '{"outputs":{"Y":1,"seed":2}}'; return"#,
        "an output is not declared",
    ),
    (
        |y| {
            y[1].1 = f64::NAN;
            Ok(())
        },
        r#"echo '{"outputs":{"y":1,"seed":NaN}}'; return"#,
        "an output is not a finite number",
    ),
    (
        |y| {
            y[0].1 = f64::NEG_INFINITY;
            Ok(())
        },
        r#"echo '{"outputs":{"y":-1e999,"seed":1}}'; return"#,
        "an output is not a finite number",
    ),
    (
        |_| Err("diverged at -3.25e-7 s".into()),
        r#"echo '{"error":"diverged at -3.25e-7 s"}'; return"#,
        "simulator: diverged at # s",
    ),
    (|_| panic!("on purpose"), "", "the simulator panicked"),
];

/// Answers as the script does, and in its order or the other way around.
fn function(mischief: Mischief) -> SimulatorFunction {
    SimulatorFunction::new(move |run: &RunInputs<'_>| {
        let x = run.input("x").ok_or("no x")?;
        let mut outputs = vec![("y".to_owned(), x), ("seed".to_owned(), run.seed() as f64)];
        if run.input("mischief") == Some(1.0) {
            mischief(&mut outputs)?;
        }
        if run.run() % 2 == 1 {
            outputs.reverse();
        }
        Ok(outputs)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    /// Whatever a function does to some runs, on however many threads: they fail as those of a process do, in the same words, and the
    /// others have the same numbers, bit for bit.
    #[test]
    fn a_function_is_a_process(
        failed in prop::collection::btree_set(0_u64..40, 0..12),
        kind in 0..MISCHIEF.len(),
        on in 1_usize..4,
    ) {
        let (mischief, script, reason) = MISCHIEF[kind];
        let own = table(&Simulator::function(function(mischief)), &failed, 40, on);
        assert_rows(&own, &failed, reason, reason);
        if !script.is_empty() {
            let other = table(&simulator(script, false, 60.0), &failed, 40, on);
            for (own, other) in own.rows().zip(other.rows()) {
                // How a number that is none is written differs.
                if reason == "an output is not a finite number" && own.failure().is_some() {
                    prop_assert_eq!(own.failure().unwrap().kind(), other.failure().unwrap().kind());
                } else {
                    prop_assert_eq!(own, other);
                }
            }
        }
    }
}

proptest! {
    /// Whatever outputs a function returns with a text that says why the run failed: the run fails for that, and has those that are
    /// infinite, also where it is done alone.
    #[test]
    fn a_failed_run_has_what_is_infinite(
        answered in prop::collection::vec(
            (prop::sample::select(vec!["y", "seed", "other"]), prop::sample::select(vec![1.5, f64::NAN, f64::INFINITY, f64::NEG_INFINITY])),
            0..4,
        ),
    ) {
        let own = answered.clone();
        let partly = SimulatorFunction::partly(move |_: &RunInputs<'_>| {
            let outputs = own.iter().map(|(name, number)| ((*name).to_owned(), *number));
            (outputs.collect(), Some("diverged".to_owned()))
        });
        let simulator = Simulator::function(partly);
        let told = simulation(&simulator, BTreeSet::new(), 0).replay(0);
        let table = table(&simulator, &BTreeSet::new(), 2, 1);
        prop_assert_eq!(table.failures().count(), 2);
        prop_assert!(table.failures().all(|(_, failure)| failure.message().contains("diverged")));
        for (place, name) in ["y", "seed"].into_iter().enumerate() {
            let mut infinite = answered.iter().filter(|(other, x)| *other == name && x.is_infinite());
            let first = infinite.next().map(|(_, number)| *number);
            prop_assert_eq!(table.numbers(name).unwrap().get(0), first);
            prop_assert_eq!(told.infinite.get(place).copied().flatten(), first);
        }
        let answer = told.answer.unwrap();
        prop_assert!(answer.contains("\"error\":\"diverged\"") && answer.contains("outputs") != answered.is_empty(), "{}", answer);
    }
}

/// A run alone is sent what a process is sent, and what it answers is told in the same form.
#[test]
fn a_run_alone_is_told() {
    let failed = BTreeSet::from([3]);
    let (own, other) =
        (Simulator::function(function(MISCHIEF[5].0)), simulator(MISCHIEF[5].1, false, 60.0));
    assert!(own.program().is_none() && own.check().is_ok());
    for run in [2, 3] {
        let [own, other] =
            [&own, &other].map(|simulator| simulation(simulator, failed.clone(), 2).replay(run));
        assert_eq!(own.request, other.request);
        assert!(
            own.request.is_some_and(|request| request.starts_with(&format!("{{\"run\":{run},")))
        );
        assert_eq!(own.inputs, other.inputs);
        assert_eq!(own.outputs, other.outputs);
        let answer: serde_json::Value = serde_json::from_str(&own.answer.unwrap()).unwrap();
        assert_eq!(answer["error"].is_string(), run == 3, "{answer}");
        assert_eq!(answer["outputs"]["y"].as_f64(), own.outputs.ok().map(|outputs| outputs[0]));
    }
}

/// A function that computes in parallel is not called again by its own thread before it has returned, and no more calls are under
/// way than there are threads.
#[test]
fn functions_that_compute_in_parallel_are_called_one_at_a_time() {
    thread_local! { static DEPTH: Cell<u32> = const { Cell::new(0) } }
    for number in [1, 2, 3] {
        let (under_way, most) = (Arc::new(AtomicU32::new(0)), Arc::new(AtomicU32::new(0)));
        let counted = Arc::clone(&most);
        let parallel = move |inputs: &RunInputs<'_>| {
            let depth = DEPTH.replace(DEPTH.get() + 1);
            counted.fetch_max(under_way.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            let (seed, pieces) = (inputs.seed(), 0..200_u64);
            // A pool of its own, as of a library, and the one that it is called in.
            let others = threads(Some(2)).unwrap();
            let sum = |pieces: Range<u64>| -> u64 {
                pieces
                    .into_par_iter()
                    .map(|i| (0..2000).fold(i ^ seed, |a, b| a.rotate_left(7) ^ b) & 1)
                    .sum()
            };
            let sums = [others.install(|| sum(pieces.clone())), sum(pieces)];
            under_way.fetch_sub(1, Ordering::SeqCst);
            DEPTH.set(depth);
            if depth > 0 || sums[0] != sums[1] {
                return Err(format!("called again, {depth} deep"));
            }
            Ok(vec![("y".to_owned(), 1.0), ("seed".to_owned(), 2.0)])
        };
        let function = Simulator::function(SimulatorFunction::new(parallel));
        let pool = threads(Some(number)).unwrap();
        let table = gyradius_campaign::run(
            &simulation(&function, BTreeSet::new(), 0),
            "any",
            300,
            &pool,
            &|_| {},
        )
        .unwrap();
        assert_eq!(table.len(), 300);
        assert_eq!(table.failures().count(), 0, "{:?}", table.failures().next());
        assert!(most.load(Ordering::SeqCst) <= number as u32);
    }
}
