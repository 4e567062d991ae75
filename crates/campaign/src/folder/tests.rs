//! Folders under every interruption, among every kind of thing that a user may have there.

use proptest::prelude::*;
use std::{
    collections::BTreeMap,
    fs,
    os::unix::fs::{PermissionsExt, symlink},
    path::Path,
};
use tempfile::TempDir;

use super::{Contents, Folder, FolderError, restore};

/// Stops the program at a step on the disk, as if it were killed there, or fails one step.
pub(super) mod fuse {
    use std::{
        cell::{Cell, RefCell},
        io,
        path::Path,
    };

    #[derive(Clone, Copy, PartialEq, Eq)]
    pub(crate) enum Fuse {
        Off,
        /// Nothing reaches the disk after so many steps.
        Kill(u64),
        /// One step fails after so many.
        Fail(u64),
    }

    thread_local! {
        static FUSE: Cell<Fuse> = const { Cell::new(Fuse::Off) };
        static STEPS: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
    }

    pub(crate) fn set(fuse: Fuse) {
        FUSE.set(fuse);
        STEPS.take();
    }

    /// The steps since it was set.
    pub(crate) fn steps() -> Vec<String> {
        STEPS.with_borrow(Clone::clone)
    }

    pub(crate) fn step(what: &str, path: &Path) -> io::Result<()> {
        STEPS.with_borrow_mut(|steps| steps.push(format!("{what} {}", path.display())));
        match FUSE.get() {
            Fuse::Off => Ok(()),
            Fuse::Kill(0) => Err(io::Error::other("killed")),
            Fuse::Kill(n) => {
                FUSE.set(Fuse::Kill(n - 1));
                Ok(())
            }
            Fuse::Fail(0) => {
                FUSE.set(Fuse::Off);
                Err(io::Error::other("failed"))
            }
            Fuse::Fail(n) => {
                FUSE.set(Fuse::Fail(n - 1));
                Ok(())
            }
        }
    }
}

use fuse::Fuse;

type Files = BTreeMap<&'static str, String>;

/// One study of several, which share some files and not others.
fn study(which: usize) -> Files {
    let all: [&[&str]; 3] = [
        &["mark.txt", "runs/a/runs.parquet", "figures/figure-1.svg", "summary.json"],
        &["mark.txt", "runs/a/runs.parquet", "runs/b/runs.parquet", "summary.json"],
        &["mark.txt", "figures/figure-1.svg", "figures/figure-2.svg"],
    ];
    all[which].iter().map(|name| (*name, format!("{name} of study {which}"))).collect()
}

fn contents(which: usize) -> Contents<'static> {
    let certain = ["mark.txt", "figures/"].map(str::to_owned);
    Contents::new("study", "mark.txt", certain, move |text, _| text == study(which)["mark.txt"])
}

fn publish(place: &Path, which: usize, force: bool) -> Result<(), FolderError> {
    let contents = contents(which);
    let mut folder = Folder::prepare(place, &contents, force)?;
    for (name, text) in study(which) {
        folder.write(name, &text)?;
    }
    folder.publish().map(drop)
}

/// Which study is in place, whole and with nothing of another; the user's files may be beside it.
fn whole(place: &Path) -> Option<usize> {
    let names: Vec<_> = (0..3).flat_map(|which| study(which).into_keys()).collect();
    (0..3).find(|which| {
        let study = study(*which);
        names.iter().all(|name| {
            let path = place.join(name);
            let file = path.symlink_metadata().is_ok_and(|found| found.is_file());
            let found = file.then(|| fs::read_to_string(path).unwrap());
            match study.get(name) {
                Some(text) => found.as_ref() == Some(text),
                None => found.is_none_or(|text| text.starts_with("mine")),
            }
        })
    })
}

/// Everything below a folder: kind, permissions and content, or where a link leads.
fn snapshot(folder: &Path) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            let metadata = fs::symlink_metadata(&path).unwrap();
            let said = if metadata.is_dir() {
                folders.push(path.clone());
                "folder".to_owned()
            } else if metadata.is_symlink() {
                format!("link to {}", fs::read_link(&path).unwrap().display())
            } else if metadata.is_file() {
                format!("{:o} {:?}", metadata.permissions().mode(), fs::read(&path).unwrap())
            } else {
                "special".to_owned()
            };
            let name = path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
            all.insert(name, said);
        }
    }
    all
}

/// Something of the user's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Thing {
    File,
    ReadOnly,
    Folder,
    FileLink,
    FolderLink,
    DeadLink,
    Pipe,
}

const THINGS: [Thing; 7] = [
    Thing::File,
    Thing::ReadOnly,
    Thing::Folder,
    Thing::FileLink,
    Thing::FolderLink,
    Thing::DeadLink,
    Thing::Pipe,
];

/// Names of this program, of programs like it, and of none.
const NAMES: [&str; 22] = [
    ".lock",
    ".draft-1",
    ".draft-1/new/runs/a/runs.parquet",
    ".gyradius",
    ".gyradius/lock",
    ".gyradius/journal",
    ".gyradius/study.json",
    ".gyradius/draft",
    ".gyradius/draft/mark.txt",
    ".gyradius/aside/mark.txt",
    ".gyradius/notes.txt",
    "figures",
    "figures/figure-1.svg",
    "figures/figure-mine.svg",
    "mark.txt",
    "runs",
    "runs/a",
    "runs/a/notes.txt",
    "runs/b/runs.parquet",
    "runs/mine/empty",
    "summary.json",
    "thesis.tex",
];

/// Puts it there; where that cannot be, nothing.
fn put(root: &Path, elsewhere: &Path, name: &str, thing: Thing) {
    let path = root.join(name);
    if fs::create_dir_all(path.parent().unwrap()).is_err() || path.symlink_metadata().is_ok() {
        return;
    }
    match thing {
        Thing::File => fs::write(&path, format!("mine: {name}")).unwrap(),
        Thing::ReadOnly => {
            fs::write(&path, "mine, not to be written").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(0o400)).unwrap();
        }
        Thing::Folder => fs::create_dir(&path).unwrap(),
        Thing::FileLink => symlink(elsewhere.join("letter.txt"), &path).unwrap(),
        Thing::FolderLink => symlink(elsewhere, &path).unwrap(),
        Thing::DeadLink => symlink(elsewhere.join("nowhere"), &path).unwrap(),
        Thing::Pipe => {
            assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        }
    }
}

/// A folder in a scratch folder, and beside it one that links lead to.
struct Scene(TempDir);

impl Scene {
    fn new() -> Self {
        // In memory where there is such a folder: hundreds of these are made.
        let scratch = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap();
        fs::create_dir(scratch.path().join("elsewhere")).unwrap();
        fs::write(scratch.path().join("elsewhere/letter.txt"), "dear").unwrap();
        fs::write(scratch.path().join("elsewhere/mark.txt"), "dear").unwrap();
        fs::create_dir(scratch.path().join("out")).unwrap();
        Self(scratch)
    }

    fn out(&self) -> std::path::PathBuf {
        self.0.path().join("out")
    }

    fn put(&self, things: &[(usize, usize)]) {
        for (name, thing) in things {
            let elsewhere = self.0.path().join("elsewhere");
            put(&self.out(), &elsewhere, NAMES[*name], THINGS[*thing]);
        }
    }

    fn snapshot(&self) -> BTreeMap<String, String> {
        snapshot(self.0.path())
    }
}

/// That all of the user's is there as it was.
fn untouched(before: &BTreeMap<String, String>, scene: &Scene, said: &str) {
    let after = scene.snapshot();
    for (name, what) in before {
        assert_eq!(after.get(name), Some(what), "{name} {said}\n{before:#?}\n{after:#?}");
    }
}

fn things() -> impl Strategy<Value = Vec<(usize, usize)>> {
    prop::collection::vec((0..NAMES.len(), 0..THINGS.len()), 0..6)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever a user has in a folder, forced studies leave it alone, wherever they are killed.
    #[test]
    fn what_is_the_users_is_untouched(
        before in things(),
        between in things(),
        kill in 0..120_u64,
        again in 0..120_u64,
    ) {
        fuse::set(Fuse::Off);
        let scene = Scene::new();
        scene.put(&before);
        let mine = scene.snapshot();
        let out = scene.out();
        let first = publish(&out, 0, true);
        untouched(&mine, &scene, &format!("after a study: {first:?}"));
        if let Ok(()) = first {
            prop_assert_eq!(whole(&out), Some(0));
        } else {
            // Refused, it leaves no trace.
            prop_assert_eq!(&scene.snapshot(), &mine, "{:?}", first);
        }
        let written = scene.snapshot();
        scene.put(&between);
        let mut mine = scene.snapshot();
        mine.retain(|name, what| written.get(name) != Some(what) || before_has(&mine_of(&before), name));
        fuse::set(Fuse::Kill(kill));
        let second = publish(&out, 1, true);
        fuse::set(Fuse::Kill(again));
        let third = publish(&out, 2, true);
        fuse::set(Fuse::Off);
        untouched(&mine, &scene, &format!("after kills: {second:?} {third:?}"));
        let read = restore(&out);
        untouched(&mine, &scene, &format!("after a reader: {read:?}"));
        if first.is_ok() && read.is_ok() {
            prop_assert!(whole(&out).is_some(), "{second:?} {third:?}");
        }
        let last = publish(&out, 0, true);
        untouched(&mine, &scene, &format!("after all: {last:?}"));
        if last.is_ok() {
            prop_assert_eq!(whole(&out), Some(0));
        }
    }
}

/// The names that things were put under, with the folders above them.
fn mine_of(things: &[(usize, usize)]) -> Vec<&'static str> {
    things.iter().map(|(name, _)| NAMES[*name]).collect()
}

fn before_has(names: &[&str], found: &str) -> bool {
    let found = found.strip_prefix("out/").unwrap_or(found);
    names.iter().any(|name| *name == found || name.starts_with(&format!("{found}/")))
}

/// Three studies in turn: the second or the third is killed at every step, and so is the command after it.
/// Then any next command finds one whole study, or puts it there, and the user's files are as they were.
#[test]
fn one_whole_study_survives_every_kill() {
    let mine = [(13, 0), (17, 1), (19, 2), (0, 0), (2, 3)];
    for (from, to, other) in [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 0, 1)] {
        for kill in 0.. {
            fuse::set(Fuse::Off);
            let scene = Scene::new();
            let out = scene.out();
            scene.put(&mine);
            let before = scene.snapshot();
            publish(&out, from, true).unwrap();
            fuse::set(Fuse::Kill(kill));
            let done = publish(&out, to, true).is_ok();
            let said = format!("after study {to} over {from} was killed at step {kill}");
            // Killed again at any step of what mends it; each step comes to its turn.
            fuse::set(Fuse::Kill(kill * 7 % 31));
            let _ = restore(&out);
            fuse::set(Fuse::Off);
            match kill % 3 {
                0 => restore(&out).unwrap(),
                // Refused, but not before it has mended the folder.
                1 => assert!(publish(&out, other, false).is_err()),
                _ => publish(&out, to, true).unwrap(),
            }
            let found = whole(&out).unwrap_or_else(|| panic!("{said}: {:#?}", scene.snapshot()));
            assert!(found == from || found == to || from == to, "{said}: {found}");
            assert!(!done || found == to || from == to, "{said}: it was done");
            untouched(&before, &scene, &said);
            if kill % 3 == 0 {
                let hidden = snapshot(&out.join(".gyradius"));
                assert_eq!(hidden.keys().collect::<Vec<_>>(), ["lock", "study.json"], "{said}");
            }
            publish(&out, to, true).unwrap_or_else(|error| panic!("{said}: {error}"));
            assert_eq!(whole(&out), Some(to), "{said}");
            let hidden = snapshot(&out.join(".gyradius"));
            assert_eq!(hidden.keys().collect::<Vec<_>>(), ["lock", "study.json"], "{said}");
            if done {
                assert!(kill > 50, "only {kill} steps were tried");
                break;
            }
        }
    }
}

/// Where one step fails, as on a full disk, one whole study is in place at once.
#[test]
fn a_step_that_fails_costs_nothing() {
    for fail in 0.. {
        fuse::set(Fuse::Off);
        let scene = Scene::new();
        let out = scene.out();
        scene.put(&[(13, 0), (19, 2)]);
        let before = scene.snapshot();
        publish(&out, 0, true).unwrap();
        fuse::set(Fuse::Fail(fail));
        let done = publish(&out, 1, true).is_ok();
        let reached = fuse::steps().len() as u64 > fail;
        fuse::set(Fuse::Off);
        untouched(&before, &scene, &format!("after step {fail} failed"));
        let found = whole(&out);
        assert!(found == Some(1) || !done && found == Some(0), "{fail}: {done} {found:?}");
        publish(&out, 2, true).unwrap();
        assert_eq!(whole(&out), Some(2));
        if !reached {
            assert!(done && fail > 50, "{fail}");
            break;
        }
    }
}

/// What a study is made of is on the disk before the old one is moved, and in place, on the disk too,
/// before the journal says so.
#[test]
fn all_is_synced_before_it_is_relied_on() {
    let scene = Scene::new();
    let out = scene.out();
    publish(&out, 0, true).unwrap();
    fuse::set(Fuse::Off);
    publish(&out, 1, true).unwrap();
    let out = fs::canonicalize(out).unwrap();
    let steps = fuse::steps();
    let at = |step: &str| {
        let step = step.replace('@', &out.display().to_string());
        steps.iter().rposition(|s| *s == step).unwrap_or_else(|| panic!("{step}\n{steps:#?}"))
    };
    let appends: Vec<_> = (0..steps.len()).filter(|i| steps[*i].starts_with("append")).collect();
    let [.., replace, settled] = appends[..] else { panic!("{steps:#?}") };
    for name in study(1).into_keys() {
        assert!(at(&format!("create file @/.gyradius/draft/{name}")) < replace);
        assert!(at(&format!("sync @/.gyradius/draft/{name}")) < replace, "{name}");
        let moved = at(&format!("move @/{name}"));
        assert!(replace < moved && moved < settled, "{name}");
        let above = Path::new(name).parent().unwrap().to_string_lossy().into_owned();
        for folder in [format!("@/{above}"), "@".to_owned()] {
            let synced = at(format!("sync folder {folder}").trim_end_matches('/'));
            assert!(moved < synced && synced < settled, "{name}: {folder}");
        }
    }
    let record = at("move @/.gyradius/study.json");
    assert!(record < at("sync folder @/.gyradius") && record < settled);
    for folder in ["/runs", "/runs/b", "/.gyradius", ""] {
        assert!(at(&format!("sync folder @/.gyradius/draft{folder}")) < replace, "{folder}");
    }
    let last = at("remove @/.gyradius/journal");
    assert!(settled < last && last < at("sync folder @/.gyradius/"));
}

#[test]
fn one_at_a_time() {
    let scene = Scene::new();
    let out = scene.out().join("below");
    let contents = contents(0);
    let first = Folder::prepare(&out, &contents, false).unwrap();
    let message = publish(&out, 1, true).unwrap_err().to_string();
    assert!(message.contains("something else is being written there"), "{message}");
    restore(&out).unwrap();
    drop(first);
    assert!(!out.exists(), "dropped, it leaves no trace");
    publish(&out, 1, false).unwrap();
    assert_eq!(whole(&out), Some(1));
}

/// What the user has changed is the user's, and what is no file of this program stays.
#[test]
fn changed_files_are_not_replaced() {
    let scene = Scene::new();
    let out = scene.out();
    publish(&out, 0, true).unwrap();
    fs::write(out.join("summary.json"), "annotated").unwrap();
    let before = scene.snapshot();
    for which in 0..3 {
        let message = publish(&out, which, true).unwrap_err().to_string();
        assert!(message.contains("summary.json in it was changed after"), "{message}");
        assert_eq!(scene.snapshot(), before);
    }
    fs::remove_file(out.join("summary.json")).unwrap();
    publish(&out, 2, true).unwrap();
    assert_eq!(whole(&out), Some(2));
}

/// Names lead nowhere else, in records and journals too.
#[test]
fn names_stay_below_the_folder() {
    for bad in [
        "",
        "/etc/passwd",
        "../mark.txt",
        "runs/../../mark.txt",
        "./mark.txt",
        "runs//a",
        "runs/",
        ".gyradius/journal",
        ".gyradius/lock",
        ".gyradius",
        ".gyradius/draft/a.json",
        "a\\b",
        "c:d",
    ] {
        assert!(super::Name::new(bad).is_err(), "{bad}");
        let scene = Scene::new();
        let out = scene.out();
        publish(&out, 0, true).unwrap();
        let path = out.join(".gyradius/study.json");
        let record = fs::read_to_string(&path).unwrap();
        let bad = serde_json::to_string(bad).unwrap();
        fs::write(&path, record.replace("\"summary.json\"", &bad)).unwrap();
        let before = scene.snapshot();
        let message = publish(&out, 1, true).unwrap_err().to_string();
        assert!(message.contains(".gyradius/study.json in it is not as"), "{message}");
        assert_eq!(scene.snapshot(), before);
    }
}
