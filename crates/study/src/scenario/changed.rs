//! The same scenario with something else: how many runs, from which seed, until when, and what is kept of them.

/// The methods of a type of scenarios by which something else is said; it has the fields `file`, `size` and `until`.
macro_rules! changed {
    ($scenario:ty, $file:ident) => {
        impl $scenario {
            /// The same scenario with another number of runs for each model.
            ///
            /// # Errors
            /// The number is zero or beyond a thousand million, or the scenario has vehicles.
            pub fn with_runs(self, runs: u64) -> Result<Self, ScenarioError> {
                let size = self.size.with_runs(runs)?;
                Ok(self.sized(size))
            }

            /// The same scenario with another number of vehicles, each with as many flights.
            ///
            /// # Errors
            /// The number is zero, or there are more than a thousand million runs then, or the scenario has no vehicles.
            pub fn with_vehicles(self, vehicles: u64) -> Result<Self, ScenarioError> {
                let size = self.size.with_vehicles(vehicles)?;
                Ok(self.sized(size))
            }

            /// As many as there may be, if its runs end by a rule.
            fn sized(self, size: Size) -> Self {
                let most = |until: UntilFile| until.with_most_runs(size.runs());
                let file = $file { until: self.file.until.map(most), ..self.file };
                let until = self.until.map(|until| until.with_most_runs(size.runs()));
                Self { file, until, ..self }.ended(size)
            }

            fn ended(self, size: Size) -> Self {
                let [runs, vehicles, flights] = size.keys();
                Self { file: $file { runs, vehicles, flights, ..self.file }, size, ..self }
            }

            /// The same, whose runs ended after so many, and were looked at first after so many, if that is said.
            pub(crate) fn ended_after(
                &self,
                runs: u64,
                first_look: Option<u64>,
            ) -> Result<Self, ScenarioError> {
                let mut ended = self.clone().ended(self.size.of_all(runs)?);
                ended.file.until = ended.file.until.map(|own| own.with_first_look(first_look));
                ended.until = ended.until.map(|own| own.with_first_look(first_look));
                Ok(ended)
            }

            /// The same scenario from another seed.
            ///
            /// # Errors
            /// The seed does not fit into a TOML integer.
            pub fn with_seed(self, seed: u64) -> Result<Self, ScenarioError> {
                check_seed(seed)?;
                Ok(Self { file: $file { seed, ..self.file }, ..self })
            }

            /// The same scenario, which keeps so much of its run tables.
            #[must_use]
            pub fn with_kept(self, kept: &Kept) -> Self {
                let (rows, columns) = (kept.rows(), kept.columns().map(<[_]>::to_vec));
                Self { file: $file { rows, columns, ..self.file }, ..self }
            }

            /// The same scenario, whose runs go on until a rule ends them, and are as many at most as they would be. They are
            /// looked at after `look_every` first, if that is said.
            ///
            /// # Errors
            /// The rule is about requirements, and there are none; `look_every` is zero, or not a whole number of vehicles.
            pub fn with_until(
                self,
                rule: StoppingRule,
                look_every: Option<u64>,
            ) -> Result<Self, ScenarioError> {
                let until = Some(UntilFile::new(rule, look_every));
                let mut file = $file { until, ..self.file };
                let until = file.until(self.size)?;
                Ok(Self { file, until, ..self })
            }

            /// The same scenario, of which it is found what drives the outcome, by so many base runs: each of them is done once for
            /// each group of inputs and twice more.
            ///
            /// # Errors
            /// There are fewer than 100, or more than ten million.
            pub fn with_drivers(self, base_runs: u64) -> Result<Self, ScenarioError> {
                let drivers = Some(base_runs);
                crate::scenario::base_runs(drivers)?;
                Ok(Self { file: $file { drivers, ..self.file }, ..self })
            }

            /// Base runs by which it is found what drives the outcome, if that is asked.
            #[must_use]
            pub fn drivers(&self) -> Option<u64> {
                self.file.drivers
            }

            /// Until when its runs go on, if not to their number.
            #[must_use]
            pub fn until(&self) -> Option<&Until> {
                self.until.as_ref()
            }

            /// What its runs are to show.
            #[must_use]
            pub fn requirements(&self) -> &[Requirement] {
                &self.file.requirements
            }

            /// What is kept of its run tables once all runs are done.
            #[must_use]
            pub fn kept(&self) -> Kept {
                Kept::new(self.file.rows, self.file.columns.clone())
            }
        }
    };
}
pub(crate) use changed;
