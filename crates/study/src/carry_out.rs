//! A scenario carried out: its runs to their number, or until a rule ends them, and what comes of them.

use gyradius_campaign::{Doing, Progress};

use crate::{
    Notice, Options, Scenario, Study, StudyError, study::do_what_is_left, subject::Subject,
    until::run_to_the_end,
};

impl Study {
    /// Runs a scenario and writes its folder: the resolved scenario, run tables, summary, figures
    /// and report.
    ///
    /// # Errors
    /// The folder holds another study and `force` is not set, or something cannot be written. What
    /// was there stays as it was.
    pub fn run(
        scenario: &Scenario,
        options: &Options,
        progress: Progress<'_>,
    ) -> Result<Self, StudyError> {
        carry_out(scenario, options, progress, &|_| {})
    }
}

/// Does the runs that are to be done, to their number or until a rule ends them, and puts together what is there then.
pub(crate) fn carry_out<C: Subject>(
    scenario: &C,
    options: &Options,
    progress: Progress<'_>,
    say: &dyn Fn(Notice),
) -> Result<Study<C::Summary>, StudyError> {
    match run_to_the_end(scenario, options, progress, say)? {
        Some((scenario, ended)) => {
            let doing = (Doing::All, Some(ended));
            do_what_is_left(&scenario, options, doing, progress, &|_| {})
        }
        None => do_what_is_left(scenario, options, (Doing::All, None), progress, say),
    }
}
