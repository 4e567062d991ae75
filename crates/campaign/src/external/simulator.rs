//! A simulator that is ready: the processes of a program, or a function.

use std::cell::RefCell;

use super::{
    answer,
    child::Child,
    function::{Outputs, SimulatorFunction},
    inputs::RunInputs,
    processes::{Processes, Unasked},
    program::{Program, ProgramError},
    trouble::Trouble,
};
use crate::column::Column;

/// A simulator that is ready to do runs: the processes of a [`Program`], or a [`SimulatorFunction`].
///
/// Every thread that does runs has a process, which is kept. When the simulator is dropped, their standard input is
/// closed, and what has not ended one second later is killed with everything in its process group.
#[derive(Debug)]
pub struct Simulator(Way);

#[derive(Debug)]
enum Way {
    Processes(Processes),
    Function(SimulatorFunction),
}

/// What was said in a run that is told of: what was sent, and what came back.
#[derive(Debug, Default)]
pub(super) struct Said {
    pub(super) request: Option<String>,
    pub(super) answer: Option<String>,
}

impl Simulator {
    /// Whose processes are started when they are needed.
    #[must_use]
    pub fn new(program: Program) -> Self {
        Self(Way::Processes(Processes::new(program)))
    }

    /// Starts the first process, or finds the program if it is to be started for each run.
    ///
    /// # Errors
    /// The command cannot be started.
    pub fn start(program: Program) -> Result<Self, ProgramError> {
        let simulator = Self::new(program);
        simulator.check()?;
        Ok(simulator)
    }

    /// A function, which needs no process.
    #[must_use]
    pub fn function(function: SimulatorFunction) -> Self {
        Self(Way::Function(function))
    }

    /// Makes certain that a command can be started: starts the first process, or finds the program if it is to be started
    /// for each run.
    ///
    /// # Errors
    /// The command cannot be started, or its folder is not there.
    pub fn check(&self) -> Result<(), ProgramError> {
        match &self.0 {
            Way::Processes(processes) => processes.check(),
            Way::Function(_) => Ok(()),
        }
    }

    /// Its command; none of a function.
    #[must_use]
    pub fn program(&self) -> Option<&Program> {
        match &self.0 {
            Way::Processes(processes) => Some(processes.program()),
            Way::Function(_) => None,
        }
    }

    /// The places of the words of its command that name files which are there, with the SHA-256 of each file, in hexadecimal. They are
    /// those that were there when this was first asked, or when the first runs were done.
    pub fn files_sha256(&self) -> impl Iterator<Item = (usize, &str)> {
        let files = match &self.0 {
            Way::Processes(processes) => processes.files(),
            Way::Function(_) => &[],
        };
        files.iter().map(|file| (file.place, file.sha256.as_str()))
    }

    /// Why runs that it did do not count.
    pub(super) fn fault(&self) -> Option<String> {
        match &self.0 {
            Way::Processes(processes) => processes.fault(),
            Way::Function(_) => None,
        }
    }

    /// Whether it is a function.
    pub(super) fn is_function(&self) -> bool {
        matches!(self.0, Way::Function(_))
    }

    /// What its processes wrote to standard output that nobody had asked for, if they did.
    #[must_use]
    pub fn unasked(&self) -> Option<Unasked> {
        match &self.0 {
            Way::Processes(processes) => processes.unasked(),
            Way::Function(_) => None,
        }
    }

    /// A process that waits, if there is one.
    pub(super) fn take(&self) -> Option<Child> {
        match &self.0 {
            Way::Processes(processes) => processes.take(),
            Way::Function(_) => None,
        }
    }

    /// Keeps a process for runs to come.
    pub(super) fn keep(&self, child: Option<Child>) {
        match &self.0 {
            Way::Processes(processes) => processes.keep(child),
            Way::Function(_) => {}
        }
    }

    /// Does a run and gives the declared outputs in their order. `kept` is the process to ask, which is none afterwards if it had to
    /// be killed; `said` is told what was sent and what came back.
    pub(super) fn ask(
        &self,
        inputs: &RunInputs<'_>,
        outputs: &[Column],
        kept: &mut Option<Child>,
        said: Option<&RefCell<Said>>,
    ) -> Result<Vec<f64>, Trouble> {
        let line = || serde_json::to_vec(inputs).map_err(|error| Trouble::Files(error.into()));
        let sent = |line: &[u8]| {
            if let Some(said) = said {
                said.borrow_mut().request = Some(String::from_utf8_lossy(line).into_owned());
            }
        };
        let came = |answer: &dyn Fn() -> String| {
            if let Some(said) = said {
                said.borrow_mut().answer = Some(answer());
            }
        };
        match &self.0 {
            Way::Processes(processes) => {
                let mut line = line()?;
                sent(&line);
                line.push(b'\n');
                processes.ask(&line, kept, |answer| {
                    came(&|| String::from_utf8_lossy(answer).into_owned());
                    answer::read(answer, inputs.run(), processes.is_per_run(), outputs)
                })
            }
            Way::Function(function) => {
                if said.is_some() {
                    sent(&line()?);
                }
                function.ask(inputs, outputs, |answered, failed| came(&|| shown(answered, failed)))
            }
        }
    }
}

/// What a function returned, in the words of a process.
fn shown(outputs: &Outputs, failed: Option<&str>) -> String {
    let numbers = outputs.iter().map(|(name, number)| format!("{name:?}:{number:?}"));
    let numbers = format!("\"outputs\":{{{}}}", numbers.collect::<Vec<_>>().join(","));
    let error = failed.map(|text| format!("\"error\":{text:?}"));
    // Of a run that failed, the outputs are told that it has nevertheless.
    let numbers = (error.is_none() || !outputs.is_empty()).then_some(numbers);
    format!("{{{}}}", numbers.into_iter().chain(error).collect::<Vec<_>>().join(","))
}
