//! Campaigns that are interrupted, extended, damaged and looked at again: always what one run of all would give.

use gyradius_campaign::{
    Blocks, Cell, Column, Contents, Counting, Doing, Failure, Folder, Identity, Kept, Kind, Look,
    MANIFEST, Manifest, Plan, Runs, SampleSummary, Shard, Shared, Simulation, Streams, Surveys,
    Table, TableError, begun, run, run_missing, threads,
};
use gyradius_statistics::Confidence;
use proptest::prelude::*;
use rand::RngExt;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    ops::Range,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, OnceLock,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use crate::scratch::scratch;

/// Numbers, texts and flags from a seed; it counts the runs that it does.
struct Cheap {
    streams: Streams,
    done: AtomicU64,
}

impl Cheap {
    fn new(seed: u64) -> Self {
        Self { streams: Streams::new(seed, "cheap", "all"), done: AtomicU64::new(0) }
    }
}

impl Simulation for Cheap {
    type Worker = ();

    fn columns(&self) -> Vec<Column> {
        vec![
            Column::number("x", "m", "A number."),
            Column::number("y", "s", "Another, of few values."),
            Column::new("note", Kind::Text, "A note.").with_kinds(),
            Column::new("flag", Kind::Flag, "A flag."),
        ]
    }

    fn worker(&self) {}

    fn run(&self, runs: Range<u64>, (): &mut (), rows: &mut Table) -> Result<(), TableError> {
        for run in runs {
            self.done.fetch_add(1, Ordering::Relaxed);
            let mut rng = self.streams.run(run);
            let (x, y): (f64, u8) = (rng.random(), rng.random_range(0..4));
            let failure = (y == 3).then(|| Failure::new("three", format!("three at {x}")));
            let y = if failure.is_some() { Cell::Null } else { Cell::Number(f64::from(y)) };
            let note = Cell::Note {
                kind: if x < 0.3 { "low" } else { "high" }.into(),
                text: x.to_string().into(),
            };
            rows.push(failure, [Cell::Number(x), y, note, Cell::Flag(x < 0.5)])?;
        }
        Ok(())
    }
}

/// A campaign of one model in a folder.
pub(crate) struct Campaign {
    pub(crate) place: PathBuf,
    pub(crate) seed: u64,
    pub(crate) block_runs: u64,
}

/// What came of a command.
pub(crate) struct Done {
    runs: Runs,
    /// Runs that were simulated.
    pub(crate) simulated: u64,
    damaged: Vec<String>,
}

impl Campaign {
    pub(crate) fn identity(&self) -> Identity {
        let fields = [("seed", self.seed), ("block_runs", self.block_runs)];
        Identity::new(fields.map(|(name, value)| (name.to_owned(), value.to_string())))
    }

    /// What is to be written of so many runs; files that are in their places stay.
    pub(crate) fn contents<'a>(
        &self,
        runs: u64,
        in_place: &'a OnceLock<BTreeSet<String>>,
    ) -> Contents<'a> {
        let seed = self.seed.to_string();
        let same = move |there: &str, _| {
            let (there_seed, there) = there.split_once(' ').unwrap();
            there_seed == seed && there.parse::<u64>().unwrap() <= runs
        };
        let certain = ["mark", MANIFEST, "runs/"].map(str::to_owned);
        Contents::new("study", "mark", certain, same)
            .keeping(|name| in_place.get().is_some_and(|all| all.contains(name)))
            .trusting(|name| name.starts_with("runs/"))
    }

    /// A command that does a shard on so many threads, and is stopped after so many runs, if at all; how many runs it
    /// simulated.
    pub(crate) fn shard(
        &self,
        runs: u64,
        shard: Shard,
        number: usize,
        stop_after: Option<u64>,
    ) -> Result<u64, String> {
        let in_place = OnceLock::new();
        let contents = self.contents(runs, &in_place);
        let pool = threads(Some(number)).unwrap();
        let folder = Shared::open(&self.place, &contents).map_err(|e| e.to_string())?;
        let mark = format!("{} {runs}", self.seed);
        let blocks = folder.blocks((&self.identity(), &mark), runs, shard, &pool);
        let blocks = blocks.map_err(|e| e.to_string())?;
        let doing = Doing::Shard(shard);
        let (done, simulated) = self.simulate(&pool, &blocks, runs, doing, stop_after, None);
        done.map(|_| simulated)
    }

    /// Does what of a campaign is to be done, until so many runs were simulated, if at all; how many were.
    fn simulate(
        &self,
        pool: &rayon::ThreadPool,
        blocks: &Blocks,
        runs: u64,
        doing: Doing,
        stop_after: Option<u64>,
        look: Option<Look<'_>>,
    ) -> (Result<Vec<Runs>, String>, u64) {
        let stop = Arc::new(AtomicBool::new(stop_after == Some(0)));
        let plan = Plan { runs, block_runs: self.block_runs, doing, stop: Some(&stop) };
        let simulations = [("cheap", Cheap::new(self.seed))];
        let simulation = &simulations[0].1;
        let progress = |_| {
            let enough =
                stop_after.is_some_and(|most| simulation.done.load(Ordering::Relaxed) >= most);
            stop.fetch_or(enough, Ordering::Relaxed);
        };
        let done = pool.install(|| run_missing(&simulations, blocks, plan, &progress, look));
        (done.map_err(|e| e.to_string()), simulation.done.load(Ordering::Relaxed))
    }

    /// One command that is stopped after so many runs, if at all, and keeps all.
    pub(crate) fn command(
        &self,
        runs: u64,
        stop_after: Option<u64>,
        force: bool,
    ) -> Result<Done, String> {
        self.keeping(runs, stop_after, force, &Kept::default())
    }

    /// One command that is stopped after so many runs, if at all.
    pub(crate) fn keeping(
        &self,
        runs: u64,
        stop_after: Option<u64>,
        force: bool,
        kept: &Kept,
    ) -> Result<Done, String> {
        let text = format!("{} {runs}", self.seed);
        let in_place = OnceLock::<BTreeSet<String>>::new();
        let contents = self.contents(runs, &in_place);
        // Where it is to be stopped, one thread, which ends a block before the next: what is finished is certain.
        let pool = threads(Some(if stop_after.is_some() { 1 } else { 2 })).unwrap();
        let mut folder =
            Folder::prepare(&self.place, &contents, force).map_err(|e| e.to_string())?;
        let blocks = folder
            .blocks((&self.identity(), &text), runs, force, &pool)
            .map_err(|e| e.to_string())?;
        let all = if kept.is_all() { blocks.published() } else { BTreeSet::new() };
        in_place.set(all).unwrap();
        let damaged = blocks.damaged().to_vec();
        let seen = Mutex::new(BTreeMap::new());
        let look = |_, block: &Table| {
            let before = seen.lock().unwrap().insert(block.first(), block.len() as u64);
            assert_eq!(before, None, "a block is looked at once");
        };
        let (done, simulated) =
            self.simulate(&pool, &blocks, runs, Doing::All, stop_after, Some(&look));
        let done = done.inspect_err(|_| blocks.abandon())?;
        let ends = |end, (first, len): (&u64, &u64)| (*first == end).then_some(first + len);
        assert_eq!(seen.into_inner().unwrap().iter().try_fold(0, ends), Some(runs));
        let empty = [whole(self.seed, 0)];
        folder
            .adopt(&blocks, &empty, (kept, Counting::default()), &pool, None)
            .map_err(|e| e.to_string())?;
        folder.write("mark", &text).map_err(|e| e.to_string())?;
        folder.publish().map_err(|e| e.to_string())?;
        blocks.settle().map_err(|e| e.to_string())?;
        Ok(Done { runs: blocks.in_place(done[0].clone()), simulated, damaged })
    }

    /// Every block that there is, finished or not.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let mut files = Vec::new();
        for folder in ["runs/cheap", ".gyradius/campaign/cheap"] {
            for entry in fs::read_dir(self.place.join(folder)).into_iter().flatten() {
                files.push(entry.unwrap().path());
            }
        }
        files.sort();
        files
    }
}

pub(crate) fn whole(seed: u64, runs: u64) -> Table {
    run(&Cheap::new(seed), "cheap", runs, &threads(Some(1)).unwrap(), &|_| {}).unwrap()
}

/// That the folder holds what one command would have written, however it came about.
pub(crate) fn assert_whole(campaign: &Campaign, done: &Done, runs: u64) {
    let expected = whole(campaign.seed, runs);
    assert!(done.runs.table().unwrap().rows().eq(expected.rows()));
    let manifest = Manifest::read(&campaign.place).unwrap();
    let mut read = 0;
    let empty = expected.from_run(0);
    for row in expected.rows() {
        let block = manifest.find("cheap", row.run()).unwrap();
        if block.range().start == row.run() {
            let block = empty.read_parquet(&campaign.place.join(block.name())).unwrap();
            assert_eq!(block.first(), row.run());
            read += block.len() as u64;
        }
    }
    assert_eq!((read, manifest.find("cheap", runs)), (runs, None));
    assert!(!campaign.place.join(".gyradius/campaign").exists());
    // What is seen of the blocks is what is seen of all at once.
    let confidence = Confidence::default();
    let of = |runs: &Runs| Surveys::new(runs, confidence).unwrap();
    let (found, expected) = (of(&done.runs), of(&Runs::from(expected)));
    for column in ["x", "y"] {
        let summary = |s: &Surveys| SampleSummary::of(s.column(column).unwrap(), confidence);
        assert_eq!(summary(&found), summary(&expected));
    }
    assert_eq!(found.texts("note"), expected.texts("note"));
    assert_eq!((found.flags("flag"), found.runs()), (expected.flags("flag"), expected.runs()));
    assert_eq!(found.failures(), expected.failures());
}

#[derive(Clone, Debug)]
enum Event {
    /// A command that is stopped after so many runs.
    Stopped(u64),
    /// A block is flipped in one byte, cut, or removed.
    Damaged(prop::sample::Index, prop::sample::Index, u8),
    /// More runs are asked for.
    Extended(u64),
    /// A command that does a shard, and is stopped after so many runs, if at all.
    Shard(Shard, usize, Option<u64>),
    /// A command that is not stopped.
    Finished,
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        (0..200_u64).prop_map(Event::Stopped),
        (any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..3_u8)
            .prop_map(|(file, byte, how)| Event::Damaged(file, byte, how)),
        (0..150_u64).prop_map(Event::Extended),
        (
            1..5_u32,
            any::<prop::sample::Index>(),
            1..4_usize,
            prop::option::weighted(0.3, 0..100_u64)
        )
            .prop_map(|(of, number, threads, stop)| {
                let shard = Shard::new(number.index(of as usize) as u32 + 1, of).unwrap();
                Event::Shard(shard, threads, stop)
            }),
        Just(Event::Finished),
    ]
}

fn damage(path: &Path, byte: &prop::sample::Index, how: u8) {
    let mut bytes = fs::read(path).unwrap();
    let at = byte.index(bytes.len());
    match how {
        0 => bytes[at] ^= 0x10,
        1 => bytes.truncate(at),
        _ => return fs::remove_file(path).unwrap(),
    }
    // A new file, for blocks may share their content with another name.
    fs::remove_file(path).unwrap();
    fs::write(path, bytes).unwrap();
}

/// The runs in a file.
fn range(path: &Path) -> Range<u64> {
    let (first, last) = path.file_stem().unwrap().to_str().unwrap().split_once('-').unwrap();
    first.parse().unwrap()..last.parse::<u64>().unwrap() + 1
}

/// How many there are.
fn size(path: &Path) -> u64 {
    range(path).end - range(path).start
}

/// Two processes do not do the same shard, nobody puts together what is being done, and a shard waits for no one who has
/// the folder alone.
#[test]
fn shards_are_held_by_one_process() {
    let scratch = scratch();
    let campaign = Campaign { place: scratch.path().join("here"), seed: 4, block_runs: 16 };
    let in_place = OnceLock::new();
    let contents = campaign.contents(100, &in_place);
    let pool = threads(Some(1)).unwrap();
    let shared = Shared::open(&campaign.place, &contents).unwrap();
    let open = |shard: &str| {
        shared.blocks((&campaign.identity(), "4 100"), 100, shard.parse().unwrap(), &pool)
    };
    let first = open("1/2").unwrap();
    let busy = "something else is being written there";
    assert!(open("1/2").unwrap_err().to_string().contains(busy));
    let second = open("2/2").unwrap();
    assert!(campaign.command(100, None, false).map(|_| ()).unwrap_err().contains(busy));
    drop((first, second));
    open("1/2").unwrap();
    drop(shared);
    assert_eq!(campaign.command(100, None, false).unwrap().simulated, 100);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Whatever happens between the first command and the last: what was finished and is sound is not done again, what is
    /// damaged is named and done again, and at the end there is what one command would have written.
    #[test]
    fn campaigns_go_on_after_anything(
        seed in 0..1000_u64,
        mut runs in 1..300_u64,
        block_runs in prop::sample::select(vec![1_u64, 16, 64, 128, 1024]),
        events in prop::collection::vec(event(), 0..7),
    ) {
        let block_runs = if runs > 100 { block_runs.max(16) } else { block_runs };
        let scratch = scratch();
        let campaign = Campaign { place: scratch.path().join("here"), seed, block_runs };
        // Runs in sound blocks, and what should be in the files that are not sound.
        let (mut finished, mut broken) = (0, BTreeMap::new());
        for event in events.into_iter().chain([Event::Finished]) {
            let stop = match event {
                Event::Extended(more) => {
                    runs += more;
                    continue;
                }
                Event::Damaged(file, byte, how) => {
                    let files = campaign.files();
                    if !files.is_empty() {
                        let path = &files[file.index(files.len())];
                        if path.exists() && !broken.contains_key(path) {
                            broken.insert(path.clone(), fs::read(path).unwrap());
                            finished -= size(path);
                            damage(path, &byte, how);
                        }
                    }
                    continue;
                }
                Event::Shard(shard, threads, stop) => {
                    match campaign.shard(runs, shard, threads, stop) {
                        Ok(simulated) => prop_assert!(simulated <= runs),
                        Err(error) => prop_assert!(stop.is_some() && error.contains("stopped"), "{}", error),
                    }
                    // It does again what is gone or not of its length, if that is its own.
                    broken.retain(|path, bytes| fs::read(path).ok().as_ref() != Some(bytes));
                    let sound = |path: &&PathBuf| !broken.contains_key(*path);
                    finished = campaign.files().iter().filter(sound).map(|path| size(path)).sum();
                    continue;
                }
                Event::Stopped(after) => Some(after),
                Event::Finished => None,
            };
            // A block is damaged if no sound file holds it.
            let name = |path: &PathBuf| path.file_name().unwrap().to_owned();
            let all = campaign.files();
            let sound: Vec<_> = all.iter().filter(|path| !broken.contains_key(*path)).map(|path| range(path)).collect();
            let lost = |path: &&PathBuf| !sound.iter().any(|runs| runs.contains(&range(path).start));
            let damaged: BTreeSet<_> = broken.keys().filter(lost).map(name).collect();
            match campaign.command(runs, stop, false) {
                Ok(done) => {
                    prop_assert_eq!(done.simulated, runs - finished);
                    let told = |said: &String| Path::new(said.split(' ').next().unwrap()).file_name().unwrap().to_owned();
                    prop_assert_eq!(done.damaged.iter().map(told).collect::<BTreeSet<_>>(), damaged);
                    assert_whole(&campaign, &done, runs);
                    broken.clear();
                }
                Err(error) => {
                    prop_assert!(stop.is_some() && error.contains("stopped"), "{}", error);
                }
            }
            // Only what is in its place is told of until it is done again.
            broken.retain(|path, bytes| {
                path.parent().unwrap().ends_with("runs/cheap") && fs::read(path).ok().as_ref() != Some(bytes)
            });
            let sound = |path: &&PathBuf| !broken.contains_key(*path);
            finished = campaign.files().iter().filter(sound).map(|path| size(path)).sum();
        }
        // Once more: nothing is left to do.
        let done = campaign.command(runs, None, false).unwrap();
        prop_assert_eq!(done.simulated, 0);
        assert_whole(&campaign, &done, runs);
    }
}

/// Blocks of another seed or another size are not gone on with, finished or not, unless that is asked for; fewer runs
/// take none away.
#[test]
fn another_campaign_is_refused() {
    let scratch = scratch();
    let place = scratch.path().join("here");
    let campaign = |seed, block_runs| Campaign { place: place.clone(), seed, block_runs };
    let message = |c: &Campaign, runs| c.command(runs, None, false).map(|_| ()).unwrap_err();
    assert!(campaign(1, 64).command(300, Some(100), false).is_err());
    let kept = campaign(1, 64).files();
    assert!(!kept.is_empty());
    for (other, runs, said) in [
        (campaign(2, 64), 300, "seed is 1 there and 2 here"),
        (campaign(1, 16), 300, "block_runs is 64 there and 16 here"),
        (campaign(1, 64), 10, "and 10 here"),
    ] {
        let refused = message(&other, runs);
        assert!(refused.contains(said), "{refused}");
        assert_eq!(
            begun(&place).unwrap().as_deref(),
            Some("1 300"),
            "whoever goes on, goes on with what was begun"
        );
        assert_eq!(campaign(1, 64).files(), kept);
    }
    // A file of the user's in the folder of blocks is none, and stays.
    let mine = place.join(".gyradius/campaign/cheap/mine.txt");
    fs::write(&mine, "mine").unwrap();
    let done = campaign(2, 16).command(40, None, true).unwrap();
    assert_eq!(done.simulated, 40);
    assert_eq!(fs::read_to_string(&mine).unwrap(), "mine");
    assert_eq!(campaign(2, 16).command(50, None, false).unwrap().simulated, 10);
    // Fewer, by force: only what does not go beyond.
    let done = campaign(2, 16).command(41, None, true).unwrap();
    assert_eq!(done.simulated, 1);
    assert!(done.runs.table().unwrap().rows().eq(whole(2, 41).rows()));
}

/// Finished runs that are dropped by force are gone for good, also if that command is stopped itself.
#[test]
fn what_is_dropped_by_force_does_not_come_back() {
    let scratch = scratch();
    let campaign = Campaign { place: scratch.path().join("here"), seed: 3, block_runs: 16 };
    assert!(campaign.command(300, Some(200), false).is_err());
    assert!(campaign.files().len() > 1);
    assert!(campaign.command(20, None, false).map(|_| ()).unwrap_err().contains("and 20 here"));
    assert!(campaign.command(20, Some(0), true).is_err());
    assert!(campaign.files().len() <= 2, "{:?}", campaign.files());
    let done = campaign.command(20, None, false).unwrap();
    assert!(done.damaged.is_empty() && done.simulated <= 20, "{:?}", done.damaged);
    assert_whole(&campaign, &done, 20);
}
