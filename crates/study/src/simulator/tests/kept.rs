//! What is kept of the runs of a function, and what it tells of another function.

use gyradius_campaign::{Cell, KeptRuns, KeptValues, RunInputs, SimulatorFunction};
use proptest::prelude::*;
use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use super::{
    BODY, HEAD, MODELS, files, folder,
    function::{COMMAND, FUNCTION, answer},
    quantity, scenario, uniform,
};
use crate::{Kept, Options, Rows, Shard, SimulatorReplay, SimulatorScenario, StudyError};

/// What stands in a kept column for a run, by its place among those that were kept.
fn cell(values: &KeptValues, place: usize) -> Cell<'_> {
    match values {
        KeptValues::Numbers(numbers) => Some(numbers[place]).filter(|x| !x.is_nan()).into(),
        KeptValues::Integers(integers) => integers[place].map_or(Cell::Null, Cell::Integer),
        KeptValues::Texts(texts) => {
            texts.texts().nth(place).unwrap().map_or(Cell::Null, Cell::from)
        }
        KeptValues::Flags(flags) => flags[place].map_or(Cell::Null, Cell::Flag),
    }
}

/// What a study kept, column by column, is what its tables have.
#[test]
fn kept_columns_are_those_of_the_tables() {
    let folder = folder();
    let text = uniform().replace(COMMAND, FUNCTION) + "\n[[bodies]]\nname = \"hub\"";
    let text = (text + &BODY.replace("DISPERSION", "") + MODELS)
        .replace("runs = 300", "vehicles = 60\nflights = 10");
    let given = scenario(&text, folder.path()).with_function(answer()).unwrap();
    for (place, (rows, columns)) in [
        (Rows::All, None),
        (Rows::Failed, None),
        (Rows::All, Some(vec!["y".to_owned()])),
        (Rows::None, None),
    ]
    .into_iter()
    .enumerate()
    {
        let out = folder.path().join(place.to_string());
        let options = Options::to(out.clone());
        let all =
            given.clone().study(&Options::to(folder.path().join("all")), &|_| {}, &|_| {}).unwrap();
        given
            .clone()
            .with_kept(&Kept::new(rows, columns.clone()))
            .study(&options, &|_| {}, &|_| {})
            .unwrap();
        for table in all.tables().unwrap() {
            let kept = KeptRuns::read(&out, table.model()).unwrap();
            let expected: Vec<_> = table
                .rows()
                .filter(|row| rows == Rows::All || rows == Rows::Failed && row.failure().is_some())
                .collect();
            assert_eq!((kept.model(), kept.len()), (table.model(), expected.len()));
            assert_eq!(kept.is_empty(), rows == Rows::None);
            let own = ["model", "run", "status", "status_kind", "vehicle", "flight"];
            let named = |name: &str| {
                columns.as_ref().is_none_or(|c| own.contains(&name) || c.contains(&name.to_owned()))
            };
            let there: Vec<_> =
                table.columns().iter().filter(|c| rows != Rows::None && named(c.name())).collect();
            assert_eq!(kept.columns().len(), there.len());
            for (column, own) in there.into_iter().zip(kept.columns()) {
                let said = (own.name(), own.unit(), own.meaning());
                assert_eq!(said, (column.name(), column.unit(), column.meaning()));
                for (place, row) in expected.iter().enumerate() {
                    let found = cell(own.values(), place);
                    assert_eq!(Some(found), row.cell(column.name()), "{}", column.name());
                }
            }
        }
    }
    assert!(KeptRuns::read(folder.path(), "proposed").is_err());
}

/// How another function answers.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// As the first one.
    Nothing,
    /// With another number.
    Number,
    /// With another reason where a run fails.
    Reason,
    /// With another number, and an address in memory that is another each time, in the reason where a run fails, which is of the same kind.
    Words,
    /// Where the first one fails, too.
    FailsNowhere,
    /// Never.
    FailsEverywhere,
}

impl Change {
    const ALL: [Self; 6] = [
        Self::Nothing,
        Self::Number,
        Self::Reason,
        Self::Words,
        Self::FailsNowhere,
        Self::FailsEverywhere,
    ];

    /// A function with this change, which counts its calls.
    fn function(self, calls: &Arc<AtomicU64>) -> SimulatorFunction {
        let (first, calls) = (answer(), Arc::clone(calls));
        SimulatorFunction::new(move |run: &RunInputs<'_>| {
            let call = calls.fetch_add(1, Ordering::Relaxed);
            let x = run.input("x").ok_or("no x")?;
            let y = |y: f64| Ok(vec![("y".to_owned(), y)]);
            match (self, first.run(run)) {
                (Self::Number, Ok(_)) => y(x.next_up()),
                (Self::Reason, Err(_)) => Err("beyond the table".to_owned()),
                (Self::Words, Err(_)) => Err(format!("too large: {:#x}", 0xab_cdef * (call + 1))),
                (Self::FailsNowhere, Err(_)) => y(x),
                (Self::FailsEverywhere, Ok(_)) => Err("not at all".to_owned()),
                (_, answered) => answered,
            }
        })
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever was kept, of however many runs that fail: where the runs of another function are all otherwise in what was kept, it is
    /// refused, and where none is, the study is shown. Nothing is touched. A replay holds a run against what was kept of it.
    #[test]
    fn what_is_kept_tells_another_function(
        rows in prop::sample::select(Rows::ALL.to_vec()),
        columns in prop::option::of(prop::sample::subsequence(vec!["x", "y", "status", "status_kind"], 0..=4)),
        low in prop::sample::select(vec![0.1, 0.85, 0.9]),
        change in prop::sample::select(Change::ALL.to_vec()),
        vehicles in any::<bool>(),
        until in any::<bool>(),
        in_shards in any::<bool>(),
        threads in 1_usize..4,
    ) {
        let folder = folder();
        let law = format!("{{ law = \"uniform\", low = {low}, high = 0.95 }}");
        let mut text = (HEAD.to_owned() + &quantity("x", &law)).replace(COMMAND, FUNCTION);
        if vehicles {
            text = text.replace("runs = 300", "vehicles = 30\nflights = 10");
        }
        if until && !in_shards {
            text += "\n[until]\nrule = \"mean(x) within 0.5\"\n";
        }
        let columns = columns.map(|all| all.into_iter().map(str::to_owned).collect());
        let given = Kept::new(rows, columns);
        let waiting = scenario(&text, folder.path()).with_kept(&given);
        let calls = Arc::new(AtomicU64::new(0));
        let one = waiting.clone().with_function(answer()).unwrap();
        let other = waiting.with_function(change.function(&calls)).unwrap();
        let options = |name: &str| {
            Options { threads: Some(threads), ..Options::to(folder.path().join(name)) }
        };
        one.study(&options("one"), &|_| {}, &|_| {}).unwrap();
        let whole = |scenario: &SimulatorScenario, name: &str| {
            let scenario = scenario.clone().with_kept(&Kept::default());
            let study = scenario.study(&options(name), &|_| {}, &|_| {}).unwrap();
            study.tables().unwrap().remove(0)
        };
        let [before_all, now] = [(&one, "all"), (&other, "all of the other")].map(|(one, name)| whole(one, name));
        let (out, before) = (folder.path().join("one"), files(&folder.path().join("one")));

        let kept = KeptRuns::read(&out, "all").unwrap();
        let own: Vec<_> = kept.columns().iter().map(|column| (column.name(), column.values())).collect();
        let run = |place: usize| match own.iter().find(|(name, _)| *name == "run") {
            Some((_, KeptValues::Integers(runs))) => runs[place].unwrap() as u64,
            _ => panic!("no run"),
        };
        let is_other = |place: &usize| {
            let row = now.rows().nth(run(*place) as usize).unwrap();
            own.iter().any(|(name, values)| Some(cell(values, *place)) != row.cell(name))
        };
        // Of a reason the kind counts, for its words may be others each time.
        let is_otherwise = |place: &usize| {
            let row = now.rows().nth(run(*place) as usize).unwrap();
            let is = |(name, values): &(&str, &KeptValues)| Some(cell(values, *place)) == row.cell(name);
            let is_same_kind = own.iter().any(|own| own.0 == "status_kind" && is(own));
            own.iter().any(|own| !(is(own) || is_same_kind && own.0 == "status"))
        };
        let others = (0..kept.len()).filter(is_otherwise).count();
        calls.store(0, Ordering::Relaxed);
        let shown = if in_shards {
            let shard = Shard::new(1, 2).unwrap();
            crate::shards::run_shard(&other, &options("one"), shard, &|_| {}, &|_| {})
        } else {
            other.study(&options("one"), &|_| {}, &|_| {}).map(|_| ())
        };
        // Of a study of which all is kept, runs that failed can be done again in their places.
        let has_failed = |place| before_all.rows().nth(place).unwrap().failure().is_some();
        let is_whole = given.is_all();
        let is_told = (0..kept.len()).any(|place| !is_whole || !has_failed(place));
        if !is_told || others == 0 {
            prop_assert!(shown.is_ok(), "{shown:?}");
        } else if others == kept.len() {
            prop_assert!(matches!(shown, Err(StudyError::Changed { .. })), "{shown:?}");
        }
        // No more than one run is done again, and none if there is nothing to hold it against.
        prop_assert_eq!(calls.load(Ordering::Relaxed), u64::from(is_told));
        prop_assert_eq!(files(&out), before);

        let kept_all = kept.columns().len() == now.columns().len();
        for place in (0..kept.len()).step_by(37) {
            let mut replay = SimulatorReplay::new(&other, None, run(place)).unwrap();
            let held = replay.hold_against(&out);
            prop_assert_eq!(held.is_err(), is_other(&place), "{:?}", held);
            let said = replay.to_string();
            prop_assert_eq!(said.contains("the same, bit for bit, as in"), held.is_ok() && kept_all, "{}", said);
            let in_kept = said.contains("the same, bit for bit, in the columns that were kept, as in");
            prop_assert_eq!(in_kept, held.is_ok() && !kept_all, "{}", said);
        }
    }
}
