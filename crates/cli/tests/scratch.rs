//! A folder of its own in which the program runs, and what is in a folder.

use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};
use tempfile::TempDir;

/// A folder in which the program runs.
pub(crate) struct Scratch(TempDir);

impl Scratch {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn folder(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gyradius"));
        command.current_dir(self.0.path()).args(arguments).stdin(Stdio::null());
        command
    }

    /// What the program says to these arguments, which ends with this exit code.
    #[track_caller]
    pub(crate) fn done(&self, arguments: &[&str], code: i32) -> String {
        done(self.command(arguments), code)
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }
}

/// Every file below a folder with its content, hidden ones too.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// Every file of a study with its content, but for the lock.
pub(crate) fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = files(folder);
    files.remove(".gyradius/lock");
    files
}

/// What a command wrote, to standard output and then to standard error.
pub(crate) fn text(output: &Output) -> String {
    String::from_utf8_lossy(&[output.stdout.as_slice(), &output.stderr].concat()).into_owned()
}

/// What the command says, which ends with this exit code.
#[track_caller]
pub(crate) fn done(mut command: Command, code: i32) -> String {
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(code), "{command:?}: {}", text(&output));
    text(&output)
}

/// The built-in scenario as it is written.
pub(crate) fn peck_2003() -> String {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../study/src/scenario/peck-2003.toml");
    fs::read_to_string(file).unwrap()
}

/// The same with its first model alone.
pub(crate) fn one_model() -> String {
    let text = peck_2003();
    let (head, rest) = text.split_once("# The law behind").unwrap();
    let (_, source) = rest.split_once("# What the paper prints").unwrap();
    format!("{head}#{source}")
}

/// The summary of a study in a folder.
pub(crate) fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("summary.json")).unwrap()).unwrap()
}

/// The judgements in a JSON text, without the names that differ.
pub(crate) fn judged(json: &Value) -> Vec<Value> {
    let mut all = json["requirements"].as_array().unwrap().clone();
    for judged in &mut all {
        let judged = judged.as_object_mut().unwrap();
        judged.remove("model");
        // What a study alone knows: what was drawn, and when a rule looked.
        judged.remove("unusual");
        judged.remove("counted_at_looks");
        judged["requirement"].as_object_mut().unwrap().remove("name");
    }
    all
}
