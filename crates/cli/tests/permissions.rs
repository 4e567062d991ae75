//! Files and folders that a user may not read or not write: they are named, with the reason, and nothing false is said of a study.

use std::{
    fs::{self, Permissions},
    os::unix::fs::PermissionsExt,
    process::Command,
};

use crate::scratch::{Scratch, done, text};

/// Somebody whom permissions bind, in a folder of which all may do everything.
struct User {
    scratch: Scratch,
    /// What runs a program as somebody else, where this one may do everything.
    as_another: &'static [&'static str],
}

impl User {
    /// None, and a line that says so, where nobody is found whom they bind.
    fn new() -> Option<Self> {
        let scratch = Scratch::new();
        let program = scratch.path("gyradius");
        fs::copy(env!("CARGO_BIN_EXE_gyradius"), &program).unwrap();
        fs::write(scratch.path("closed"), "").unwrap();
        let user = |as_another| Self { scratch, as_another };
        let mut user = user(&[]);
        for name in [".", "gyradius"] {
            user.allow(name, 0o777);
        }
        user.allow("closed", 0);
        let other = &["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"];
        for as_another in [&[][..], other] {
            user.as_another = as_another;
            let mut copy = user.command("cp", &["closed", "copy"]);
            let mut is_there = user.command("test", &["-x", "gyradius"]);
            let ends_well = |command: &mut Command| {
                command.output().is_ok_and(|output| output.status.success())
            };
            if !ends_well(&mut copy) && ends_well(&mut is_there) {
                return Some(user);
            }
        }
        eprintln!(
            "skipped: root may read everything, and there is no `setpriv` to be another user"
        );
        None
    }

    fn command(&self, program: &str, arguments: &[&str]) -> Command {
        let words = [self.as_another, &[program], arguments].concat();
        let mut command = Command::new(words[0]);
        command.args(&words[1..]).current_dir(self.scratch.folder());
        command
    }

    /// What the program says to these words, which ends with this exit code.
    #[track_caller]
    fn told(&self, line: &str, code: i32) -> String {
        let words: Vec<&str> = line.split(' ').collect();
        done(self.command("./gyradius", &words), code)
    }

    fn allow(&self, name: &str, mode: u32) {
        fs::set_permissions(self.scratch.path(name), Permissions::from_mode(mode)).unwrap();
    }

    /// A copy of a folder, of which all may do everything, under another name.
    fn copy(&self, folder: &str, to: &str) {
        let script = format!("rm -rf {to} && cp -r {folder} {to} && chmod -R a+rwX {to}");
        let output =
            Command::new("sh").args(["-c", &script]).current_dir(self.scratch.folder()).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{}", text(&output));
    }
}

/// In a study, complete or begun, each file and folder that may not be read or not be written: every command that needs it ends with exit
/// code 2 and names it and the reason, and writes nothing elsewhere.
#[test]
fn what_is_refused_is_named() {
    let Some(user) = User::new() else { return };
    user.scratch.done(&["study", "--runs", "50", "--out", "whole", "-q"], 0);
    for shard in ["1/2", "2/2"] {
        let study = ["study", "--runs", "50", "--out", "begun", "-q", "--shard", shard];
        user.scratch.done(&study, 0);
    }
    user.copy("whole", "drafted");
    fs::write(user.scratch.path("drafted/.gyradius/journal"), "\n{\"draft\":\"x\"}\n").unwrap();
    let table = "runs/naive/000000000-000000049.parquet";
    let (same, more) = ("study --runs 50 --out it -q", "study --runs 60 --out it -q");
    let (replay, page) = ("replay it --run 3 --out again", "report it --out page");
    let (status, json, report) = ("status it", "status --json it", "report it");
    let all = &[status, json, replay, page, report, same, more][..];
    // A study, the file or folder in it that is closed, what may be done with it, who needs it, and what it cannot be.
    for (study, closed, mode, commands, cannot) in [
        ("begun", ".gyradius/campaign", 0, all, "read"),
        ("begun", ".gyradius/campaign/identity.json", 0, all, "read"),
        ("begun", ".gyradius/campaign/mark", 0, all, "read"),
        ("begun", ".gyradius/campaign/record-2-of-2", 0, all, "read"),
        ("begun", ".gyradius/campaign/naive", 0, &[status, json, page, report, same], "read"),
        ("begun", ".gyradius/lock", 0o444, &[same, page, report], "written"),
        ("drafted", ".gyradius/journal", 0, &[replay, page, report, same, more], "read"),
        ("whole", ".gyradius/lock", 0o444, &[more, report], "written"),
        ("whole", ".gyradius/study.json", 0, all, "read"),
        ("whole", ".gyradius", 0, &[status, json, replay, page, report], "read"),
        ("whole", ".gyradius", 0o555, &[report, more], "written"),
        ("whole", "runs/naive", 0, &[status, json, same, more], "read"),
        ("whole", table, 0, &[same, more], "read"),
        ("whole", "runs/naive", 0o555, &[more], "written"),
        ("whole", "figures", 0o555, &[more], "written"),
        ("whole", "campaign.json", 0, &[status, json, same, more], "read"),
        ("whole", "summary.json", 0, all, "read"),
        ("whole", "", 0, all, "read"),
        ("whole", "", 0o444, all, "read"),
    ] {
        for command in commands {
            user.copy(study, "it");
            let path = format!("it/{closed}");
            let before = fs::metadata(user.scratch.path(&path)).unwrap().permissions().mode();
            user.allow(&path, mode);
            let told = user.told(command, 2);
            user.allow(&path, before & 0o777);
            let named = match closed {
                "" => "it".to_owned(),
                // Of the files that cannot be replaced in it, the first.
                "figures" => "figures/configuration.svg in it".to_owned(),
                closed => format!("{closed} in it"),
            };
            let reason =
                format!("it: {named} cannot be {cannot}: Permission denied (os error 13)\n");
            assert!(told.ends_with(&reason), "{command}, {path} {mode:o}: {told}");
            for new in ["page", "again"] {
                assert!(!user.scratch.path(new).exists(), "{command}, {path} {mode:o}");
            }
        }
    }
}

/// Files and studies in a folder that may be written but not read are there, whole, and that is no error.
#[test]
fn a_folder_that_cannot_be_read_can_be_written_to() {
    let Some(user) = User::new() else { return };
    fs::create_dir(user.scratch.path("box")).unwrap();
    user.allow("box", 0o333);
    for (command, file) in [
        ("draw -n 3 -o box/draws.csv", "draws.csv"),
        ("slurm --shards 2 --time 1:00:00 --runs 100 -o box/array.sh --out box/of", "array.sh"),
        ("study --runs 20 -q --out box/study", "study/summary.json"),
    ] {
        user.told(command, 0);
        user.allow("box", 0o777);
        assert!(user.scratch.path("box").join(file).is_file(), "{command}");
        user.allow("box", 0o333);
    }
    user.allow("box", 0o777);
}
