//! Shards that are done at the same time, of one campaign in one folder.

use gyradius_campaign::{Shard, Shared, threads};
use std::{
    fs,
    sync::{Barrier, OnceLock},
    thread,
    time::Duration,
};

use crate::blocks::{Campaign, assert_whole};
use crate::scratch::scratch;

/// Shards that are done at the same time, on any number of threads and in any numbers, leave the same files as one
/// command.
#[test]
fn shards_at_the_same_time_are_one_campaign() {
    let scratch = scratch();
    let campaign =
        |name: String| Campaign { place: scratch.path().join(name), seed: 9, block_runs: 16 };
    let runs = 1000;
    let alone = campaign("alone".to_owned());
    alone.command(runs, None, false).unwrap();
    let content = |campaign: &Campaign| -> Vec<Vec<u8>> {
        campaign.files().iter().map(|path| fs::read(path).unwrap()).collect()
    };
    for threads in [1, 2, 3, 8] {
        for of in [1, 4, 7] {
            let together = campaign(format!("{threads}-{of}"));
            let simulated: u64 = thread::scope(|scope| {
                let shards = (1..=of).map(|number| {
                    let (together, shard) = (&together, Shard::new(number, of).unwrap());
                    scope.spawn(move || together.shard(runs, shard, threads, None).unwrap())
                });
                let shards: Vec<_> = shards.collect();
                shards.into_iter().map(|shard| shard.join().unwrap()).sum()
            });
            assert_eq!(simulated, runs, "each run once");
            let done = together.command(runs, None, false).unwrap();
            assert_eq!(done.simulated, 0);
            assert_whole(&together, &done, runs);
            assert!(content(&together) == content(&alone), "{threads} threads, {of} shards");
        }
    }
}

/// Shards that all begin at once in a folder that is not there yet all get it.
#[test]
fn shards_that_begin_together_share_the_folder() {
    let scratch = scratch();
    for round in 0..200 {
        let place = scratch.path().join(round.to_string());
        let campaign = Campaign { place, seed: 9, block_runs: 16 };
        let begin = Barrier::new(24);
        // One after the other within about a millisecond, so that one begins while another ends its check.
        let open = &|number: u64| {
            let in_place = OnceLock::new();
            let contents = campaign.contents(100, &in_place);
            begin.wait();
            thread::sleep(Duration::from_micros(number * 7919 * (round + 1) % 400));
            Shared::open(&campaign.place, &contents).map(drop).map_err(|e| e.to_string())
        };
        thread::scope(|scope| {
            let opened: Vec<_> = (0..24).map(|number| scope.spawn(move || open(number))).collect();
            for shard in opened {
                assert_eq!(shard.join().unwrap(), Ok(()), "round {round}");
            }
        });
    }
}

/// Shards that leave without a finished block bind nobody to their campaign, whoever leaves last.
#[test]
fn shards_that_did_nothing_leave_no_campaign() {
    const SHARDS: u32 = 6;
    let scratch = scratch();
    let pool = threads(Some(1)).unwrap();
    for round in 0..50 {
        let place = scratch.path().join(round.to_string());
        let begin = Barrier::new(SHARDS as usize);
        let share = &|seed: u64, number: u32| {
            let campaign = Campaign { place: place.clone(), seed, block_runs: 16 };
            let in_place = OnceLock::new();
            let shared = Shared::open(&campaign.place, &campaign.contents(100, &in_place)).unwrap();
            let shard = Shard::new(number + 1, SHARDS).unwrap();
            let mark = format!("{seed} 100");
            let blocks = shared.blocks((&campaign.identity(), &mark), 100, shard, &pool);
            blocks.map(drop).map_err(|error| error.to_string())
        };
        thread::scope(|scope| {
            for number in 0..SHARDS {
                let begin = &begin;
                scope.spawn(move || {
                    begin.wait();
                    assert_eq!(share(0, number), Ok(()), "round {round}");
                });
            }
        });
        assert_eq!(share(1, 0), Ok(()), "round {round}");
        // Whoever made the folder may have left before.
        assert!(!place.join(".gyradius/campaign/identity.json").exists());
    }
}

/// Of shards of different campaigns that begin at the same moment in a new folder, those of one campaign go on, and all others are
/// refused.
#[test]
fn campaigns_that_begin_together_are_not_mixed() {
    const SHARDS: u32 = 8;
    let scratch = scratch();
    let pool = threads(Some(1)).unwrap();
    for round in 0..100 {
        let place = scratch.path().join(round.to_string());
        let begin = Barrier::new(SHARDS as usize);
        let open = &|number: u32| {
            let seed = u64::from(number % 2);
            let campaign = Campaign { place: place.clone(), seed, block_runs: 16 };
            let in_place = OnceLock::new();
            let contents = campaign.contents(100, &in_place);
            let shared = Shared::open(&campaign.place, &contents).unwrap();
            let shard = Shard::new(number + 1, SHARDS).unwrap();
            begin.wait();
            let blocks =
                shared.blocks((&campaign.identity(), &format!("{seed} 100")), 100, shard, &pool);
            blocks.map(|_| seed).map_err(|error| error.to_string())
        };
        let opened: Vec<_> = thread::scope(|scope| {
            let all: Vec<_> = (0..SHARDS).map(|n| scope.spawn(move || open(n))).collect();
            all.into_iter().map(|shard| shard.join().unwrap()).collect()
        });
        let seeds: Vec<u64> = opened.iter().flatten().copied().collect();
        let first = *seeds.first().expect("one of them begins");
        let alike = (0..SHARDS).filter(|n| u64::from(n % 2) == first).count();
        assert!(seeds.len() == alike && seeds.iter().all(|seed| *seed == first), "{opened:?}");
        for refused in opened.into_iter().filter_map(Result::err) {
            let expected = format!("seed is {first} there and {} here", 1 - first);
            assert!(refused.contains(&expected), "{refused}");
        }
    }
}
