//! Which shard of a study a process does: as its command says, or as a scheduler that numbers processes says in their
//! environment.

use gyradius_study::{Shard, ShardError};
use std::{env, ffi::OsString, str::FromStr};

/// What stands for the number of a shard that the scheduler gives.
const AUTO: &str = "auto";

/// A shard as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AskedShard {
    /// This one: `2/8`.
    This(Shard),
    /// The one of so many whose number the scheduler says: `auto/8`.
    Numbered { of: u32 },
}

/// A scheduler that numbers the processes of a job, and the variables by which it tells them.
struct Scheduler {
    name: &'static str,
    /// The number of a process.
    number: &'static str,
    first: First,
    count: Count,
}

/// The number of the first process.
enum First {
    Zero,
    One,
    /// Zero if this variable is zero, and one otherwise: a job may be submitted for some of its processes alone.
    ZeroIf(&'static str),
}

/// How many processes there are.
enum Count {
    Untold,
    /// As many as this variable says.
    Is(&'static str),
    /// At least as many as this variable says: a job may be submitted for some of its processes alone.
    AtLeast(&'static str),
}

/// The schedulers that are known.
const SCHEDULERS: [Scheduler; 5] = [
    Scheduler {
        name: "Slurm",
        number: "SLURM_ARRAY_TASK_ID",
        first: First::ZeroIf("SLURM_ARRAY_TASK_MIN"),
        count: Count::AtLeast("SLURM_ARRAY_TASK_COUNT"),
    },
    Scheduler {
        name: "Kubernetes",
        number: "JOB_COMPLETION_INDEX",
        first: First::Zero,
        count: Count::Untold,
    },
    Scheduler { name: "HyperQueue", number: "HQ_TASK_ID", first: First::One, count: Count::Untold },
    Scheduler {
        name: "Open MPI",
        number: "OMPI_COMM_WORLD_RANK",
        first: First::Zero,
        count: Count::Is("OMPI_COMM_WORLD_SIZE"),
    },
    Scheduler {
        name: "MPICH and Intel MPI",
        number: "PMI_RANK",
        first: First::Zero,
        count: Count::Is("PMI_SIZE"),
    },
];

/// The value of a variable, if there is one.
type Lookup<'a> = &'a dyn Fn(&str) -> Option<OsString>;

impl AskedShard {
    /// The shard, by the environment of the program.
    pub(crate) fn find(self) -> Result<Shard, SchedulerError> {
        self.find_in(&|name| env::var_os(name))
    }

    fn find_in(self, lookup: Lookup<'_>) -> Result<Shard, SchedulerError> {
        let of = match self {
            Self::This(shard) => return Ok(shard),
            Self::Numbered { of } => of,
        };
        let found: Vec<&Scheduler> =
            SCHEDULERS.iter().filter(|scheduler| lookup(scheduler.number).is_some()).collect();
        match found[..] {
            [scheduler] => scheduler.shard(of, lookup),
            [] => Err(SchedulerError::None { of }),
            _ => Err(SchedulerError::Several { of, found: list(found.into_iter()) }),
        }
    }
}

impl Scheduler {
    fn shard(&self, of: u32, lookup: Lookup<'_>) -> Result<Shard, SchedulerError> {
        let first = match self.first {
            First::Zero => 0,
            First::One => 1,
            First::ZeroIf(variable) => u32::from(value(variable, lookup)? != Some(0)),
        };
        let count = match self.count {
            Count::Untold => None,
            Count::Is(variable) | Count::AtLeast(variable) => {
                value(variable, lookup)?.map(|count| (variable, count))
            }
        };
        if let Some((variable, count)) = count {
            let fits = match self.count {
                Count::AtLeast(_) => count <= of,
                Count::Is(_) | Count::Untold => count == of,
            };
            if !fits {
                return Err(SchedulerError::Count { variable, count, of });
            }
        }
        let outside = |value: u32| SchedulerError::Outside {
            variable: self.number,
            value,
            first,
            last: first.saturating_add(of - 1),
            of,
        };
        // It is there, or this scheduler would not have been found.
        let at = value(self.number, lookup)?.ok_or(SchedulerError::None { of })?;
        let number = at.checked_sub(first).and_then(|at| at.checked_add(1));
        number.and_then(|number| Shard::new(number, of).ok()).ok_or_else(|| outside(at))
    }
}

/// A whole number in a variable, if that is there.
fn value(variable: &'static str, lookup: Lookup<'_>) -> Result<Option<u32>, SchedulerError> {
    let Some(text) = lookup(variable) else { return Ok(None) };
    let text = text.to_string_lossy();
    let whole = text.parse().ok().filter(|_| text.bytes().all(|byte| byte.is_ascii_digit()));
    let refused = || SchedulerError::NoNumber { variable, text: text.clone().into_owned() };
    whole.map(Some).ok_or_else(refused)
}

/// The variables of some schedulers, and whose they are.
fn list<'a>(schedulers: impl Iterator<Item = &'a Scheduler>) -> String {
    let each = schedulers.map(|scheduler| format!("{} ({})", scheduler.number, scheduler.name));
    each.collect::<Vec<_>>().join(", ")
}

impl FromStr for AskedShard {
    type Err = AskedShardError;

    fn from_str(text: &str) -> Result<Self, AskedShardError> {
        let shard = match text.split_once('/') {
            Some((AUTO, of)) => format!("1/{of}").parse::<Shard>().ok().and_then(|_| {
                // The same digits, which were just read.
                of.parse().ok().map(|of| Self::Numbered { of })
            }),
            _ => return text.parse().map(Self::This).map_err(AskedShardError::NoShard),
        };
        shard.ok_or_else(|| AskedShardError::NoCount(text.to_owned()))
    }
}

/// A text that asks for no shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum AskedShardError {
    #[error("{0}, or in auto/8, where the scheduler says the number")]
    NoShard(ShardError),
    #[error(
        "{0:?} is no shard: auto/ must be followed by how many shards there are, at most a million, as in auto/8"
    )]
    NoCount(String),
}

/// A shard whose number cannot be found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum SchedulerError {
    #[error(
        "--shard auto/{of}: no scheduler says which shard this is: one of {} must be there; without a scheduler, --shard 1/{of} says it",
        list(SCHEDULERS.iter())
    )]
    None { of: u32 },
    #[error(
        "--shard auto/{of}: more than one scheduler says which shard this is: {found}; --shard 1/{of} says it without them"
    )]
    Several { of: u32, found: String },
    #[error("{variable} is {text:?}: it must be a whole number")]
    NoNumber { variable: &'static str, text: String },
    #[error(
        "{variable} is {value}: it must be between {first} and {last}, because --shard is auto/{of}"
    )]
    Outside { variable: &'static str, value: u32, first: u32, last: u32, of: u32 },
    #[error(
        "{variable} is {count}, and --shard is auto/{of}: there must be a process for each shard"
    )]
    Count { variable: &'static str, count: u32, of: u32 },
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    type Environment = BTreeMap<&'static str, String>;

    fn find(of: u32, environment: &Environment) -> Result<Shard, SchedulerError> {
        AskedShard::Numbered { of }.find_in(&|name| environment.get(name).map(OsString::from))
    }

    /// What each scheduler tells the process that is to do a shard, both from 1; written without the table.
    fn told(scheduler: usize, number: u32, of: u32) -> Environment {
        let (number, before, of) = (number.to_string(), (number - 1).to_string(), of.to_string());
        Environment::from_iter(match scheduler {
            0 => vec![
                ("SLURM_ARRAY_TASK_ID", number),
                ("SLURM_ARRAY_TASK_COUNT", of.clone()),
                ("SLURM_ARRAY_TASK_MIN", "1".to_owned()),
                ("SLURM_ARRAY_TASK_MAX", of),
            ],
            1 => vec![("JOB_COMPLETION_INDEX", before)],
            2 => vec![("HQ_TASK_ID", number)],
            3 => vec![("OMPI_COMM_WORLD_RANK", before), ("OMPI_COMM_WORLD_SIZE", of)],
            4 => vec![("PMI_RANK", before), ("PMI_SIZE", of)],
            other => panic!("there is no scheduler {other}"),
        })
    }

    /// Every subset of schedulers: one is believed, and none or several are refused by their names.
    #[test]
    fn exactly_one_scheduler_is_believed() {
        for subset in 0..1_usize << SCHEDULERS.len() {
            let present: Vec<usize> =
                (0..SCHEDULERS.len()).filter(|i| subset >> i & 1 == 1).collect();
            for (number, of) in [(1, 1), (1, 7), (4, 7), (7, 7), (1_000_000, 1_000_000)] {
                let environment = present.iter().flat_map(|i| told(*i, number, of)).collect();
                match (find(of, &environment), present.len()) {
                    (Ok(shard), 1) => assert_eq!(shard, Shard::new(number, of).unwrap()),
                    (Err(error), 0 | 2..) => {
                        let text = error.to_string();
                        for (i, scheduler) in SCHEDULERS.iter().enumerate() {
                            let is_named = text.contains(scheduler.number);
                            assert_eq!(is_named, present.is_empty() || present.contains(&i));
                        }
                    }
                    (other, _) => panic!("{environment:?}: {other:?}"),
                }
            }
        }
    }

    /// The processes of a job of any size do every shard once.
    #[test]
    fn processes_do_every_shard_once() {
        for scheduler in 0..SCHEDULERS.len() {
            for of in 1..30 {
                let shards = (1..=of).map(|number| find(of, &told(scheduler, number, of)).unwrap());
                assert!(shards.eq((1..=of).map(|number| Shard::new(number, of).unwrap())));
            }
        }
        // An array from 0, and part of one.
        for of in 1..30 {
            let from_zero = |at: u32| {
                let mut environment = told(0, at + 1, of);
                environment.insert("SLURM_ARRAY_TASK_ID", at.to_string());
                environment.insert("SLURM_ARRAY_TASK_MIN", "0".to_owned());
                find(of, &environment).unwrap()
            };
            assert!((0..of).map(from_zero).eq((1..=of).map(|n| Shard::new(n, of).unwrap())));
            let mut part = told(0, of, of);
            part.insert("SLURM_ARRAY_TASK_MIN", of.to_string());
            part.insert("SLURM_ARRAY_TASK_COUNT", "1".to_owned());
            assert_eq!(find(of, &part), Ok(Shard::new(of, of).unwrap()));
        }
    }

    /// Each variable that a scheduler sets, with what it cannot be.
    #[test]
    fn what_does_not_fit_is_refused_by_its_name() {
        for (place, scheduler) in SCHEDULERS.iter().enumerate() {
            let sound = told(place, 3, 8);
            for variable in sound.keys().filter(|name| **name != "SLURM_ARRAY_TASK_MAX") {
                for bad in ["", " 3", "+3", "-1", "3.0", "three", "4294967296", "undefined"] {
                    let mut environment = sound.clone();
                    environment.insert(variable, bad.to_owned());
                    let text = find(8, &environment).unwrap_err().to_string();
                    assert!(text.starts_with(&format!("{variable} is {bad:?}:")), "{text}");
                }
            }
            let number = scheduler.number;
            let first: u32 = sound[number].parse::<u32>().unwrap() - 2;
            for outside in [first.wrapping_sub(1), first + 8, u32::MAX] {
                let mut environment = sound.clone();
                environment.insert(number, outside.to_string());
                let text = find(8, &environment).unwrap_err().to_string();
                let expected = format!("{number} is {outside}: it must be between {first} and");
                assert!(text.starts_with(&expected), "{text}");
            }
            // A job with more processes than shards; with fewer, where that cannot be part of one.
            let count = sound.keys().find(|name| name.ends_with("COUNT") || name.ends_with("SIZE"));
            let whole = count.is_some_and(|name| name.ends_with("SIZE"));
            for of in [3, 7, 9] {
                let found = find(of, &sound);
                let refused = count.is_some() && (of < 8 || whole);
                assert_eq!(found.is_err(), refused, "{sound:?}");
                let text = found.map_or_else(|error| error.to_string(), |shard| shard.to_string());
                assert!(!refused || text.starts_with(&format!("{} is 8,", count.unwrap())));
            }
        }
    }

    #[test]
    fn shards_are_asked_for() {
        assert_eq!("2/8".parse(), Ok(AskedShard::This(Shard::new(2, 8).unwrap())));
        assert_eq!("auto/8".parse(), Ok(AskedShard::Numbered { of: 8 }));
        assert_eq!("auto/1000000".parse(), Ok(AskedShard::Numbered { of: 1_000_000 }));
        for text in [
            "",
            "auto",
            "auto/",
            "auto/0",
            "auto/+8",
            "auto/-8",
            "auto/1/8",
            "AUTO/8",
            "/auto",
            "8/auto",
            "auto/1000001",
            " auto/8",
            "0/8",
            "9/8",
        ] {
            let error = text.parse::<AskedShard>().unwrap_err().to_string();
            assert!(error.contains(&format!("{text:?} is no shard")) && error.contains("auto/8"));
        }
        // One that is named needs no scheduler, and believes none.
        let shard: AskedShard = "2/8".parse().unwrap();
        for environment in [Environment::new(), told(1, 5, 8)] {
            let found = shard.find_in(&|name| environment.get(name).map(OsString::from));
            assert_eq!(found, Ok(Shard::new(2, 8).unwrap()));
        }
    }
}
