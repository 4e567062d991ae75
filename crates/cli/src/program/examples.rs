//! What the help of the program ends with: examples and exit codes.

pub(crate) const EXIT_CODES: &str = "\
Exit code: 0 if all went well, 1 if something was found or is missing (check, fit, report, \
status, study, verdict), 2 if what was asked \
cannot be done, with a message on standard error. It is no error if the program that reads the \
output stops early, as head does; a full disk is one.";

pub(crate) const REPLAY_EXAMPLES: &str = "\
Examples:
  gyradius replay --run 1234
      Run 1234 of the first model of target/study/peck-2003, into
      target/replay/peck-2003/proposed-1234
  gyradius replay --run 1234 --model naive --out odd-one
      The same run of another model
  gyradius replay /tmp/quick --run 7 --coast 60
      A run of the study in /tmp/quick, and the minute after the last release
  gyradius replay my-vehicle.toml --run 7
      A run of a scenario file, which has no run table to be held against

Exit code: 0, for a run that failed as it did in the study too; 2 if there is no such run, if it is not \
what the table says, or if something could not be read or written.";

pub(crate) const DRAW_EXAMPLES: &str = "\
Examples:
  gyradius draw my-vehicle.toml -n 1e6 -o draws.parquet
      A million runs of each model, for pandas, polars or DuckDB
  gyradius draw my-vehicle.toml -n 1000 --model proposed -o draws.npy
      One model as a structured array, for numpy.load
  gyradius draw -n 5
      Five runs of each model of the built-in scenario, as CSV on the screen
  gyradius draw my-vehicle.toml --first 1e6 -n 1e6 -o more.parquet
      The next million
  gyradius draw my-vehicle.toml -n 1e9 --format jsonl | my-simulator
      One JSON object after the other, for a program of yours
  gyradius model body.toml -o law.toml
  gyradius draw law.toml -n 1000 --seed 7 -o bodies.csv
      A thousand bodies by the law that was made of statements; `gyradius fit` writes such a file, too
  gyradius draw robot.urdf -n 1000 --mass 10% --centre 5mm --moments 15% --axes 5deg --seed 7 -o robots
      A thousand robots, robots/robot-0000.urdf to robot-0999.urdf, in which only these numbers differ
  gyradius draw robot.xml -n 1e5 --mass 10% --links \"*arm*,base\" -o links.parquet
      A row for each link and draw, of the links of these names

The same scenario, seed and runs give the same bytes on any number of threads. A file appears whole or not at all.

Exit code: 0; 2 if something could not be read, drawn or written; 130 after an interrupt, 143 after SIGTERM.";

pub(crate) const REPORT_EXAMPLES: &str = "\
Examples:
  gyradius report /tmp/quick
      The report and the figures of the study in /tmp/quick, in their places
  gyradius report results/vehicle-a --out pages/vehicle-a
      The same in another folder

  gyradius report big
      After `gyradius study --out big --shard 1/8` to `8/8`: the whole study

Exit code: 0 if the report was made; 1 if runs are missing, and it is of those that are there; 2 if there is no study, if its files were changed after the study, or \
if something could not be read or written. What was there is then as it was.";

pub(crate) const SLURM_EXAMPLES: &str = "\
Examples:
  gyradius slurm --scenario my-vehicle.toml --runs 1e8 --out /shared/big -o big.sh
  bash big.sh
      The jobs of a study of 1e8 runs a model, and their submission
  gyradius slurm --runs 1e8 --out big --partition short --time 30 --max-tasks 20 | bash
      The same at once, with 20 tasks at a time, each of which is ended after 30 minutes
  gyradius status big
      What is done and missing meanwhile

Logs are in the folder big-slurm. Run the script again if runs are missing at the end.

Exit code: 0; 2 if something could not be read, forecast or written.";

pub(crate) const STATUS_EXAMPLES: &str = "\
Examples:
  gyradius status big
      Runs of each model that are done, missing and failed
  watch gyradius status big
      The same every two seconds

Exit code: 0 if all runs are done and put together, 1 if not, 2 if there is no study.";

pub(crate) const VERDICT_EXAMPLES: &str = "\
Examples:
  gyradius verdict runs.csv --require \"tip_off_deg_per_s <= 1 in 99.73 % at 90 %\"
      Is the column at most 1 in 99.73 % of all runs, with 90 % confidence?
  gyradius verdict results/runs/proposed --require \"norm(payload_w1_rad_per_s, payload_w2_rad_per_s) <= 0.02 in 99 % at 90 %\"
      The length of a vector of columns, in the run table of a study
  gyradius verdict runs.parquet --require \"0.9 <= ratio <= 1.1 in 95 % at 95 %\" --require \"clearance_m >= 0.1 in 99.9 % at 90 %\"
      Two requirements, the first with two limits

Exit code: 0 if all are met, 1 if one is not met or not decided, 2 if the table or a requirement could not be read.";

pub(crate) const RARE_EXAMPLES: &str = "\
Examples:
  gyradius rare \"cone_deg >= 3\"
      How often the cone of the built-in study is 3 deg or more
  gyradius rare \"clearance_m <= 0\" --scenario my-vehicle.toml --per-level 5000
      How often the bodies touch, with more runs of a level
  gyradius rare \"clearance_m <= 0\" --scenario my-vehicle.toml --method importance --sample 50000
      The same by importance sampling: fewer runs where springs, masses and mass centres decide
  gyradius rare \"norm(payload_w1_rad_per_s, payload_w2_rad_per_s) >= 0.1\" --json
      The length of a vector of columns, for other programs

Exit code: 0 if it was estimated, also with warnings; 2 if it could not be.";

pub(crate) const MODEL_EXAMPLES: &str = "\
Examples:
  gyradius model payload.toml
      The report, as comments, and the fragment: all of it can be pasted into a scenario
  gyradius model stage.toml --body stage -o fragment.toml
      The report on the screen, report and fragment in a file

The file:
  [nominal]
  inertia_kg_m2 = [[5000.0, 20.0, 2.0], [20.0, 4000.0, -50.0], [2.0, -50.0, 3000.0]]
  mass_kg = 10000.0    # for mass in kg, and for centre
  [moments]            # about body axes, whatever the cause
  percent = 1.0        # or kg_m2; one number, or a list of three
  sigmas = 1           # how many standard deviations ± stands for
  [products]
  kg_m2 = 50.0
  sigmas = 3
  [axes]               # turns about principal axes
  deg = 2.0
  sigmas = 3           # of = \"total\": the angle of the whole turn
  [mass]
  percent = 1.0        # or kg
  sigmas = 3
  [centre]
  mm = 10.0
  sigmas = 3           # arm_m = [0.0, 0.0, 1.5]: from where it was measured to the centre

Exit code: 0, with warnings too; 2 if something could not be read or written.";

pub(crate) const FIT_EXAMPLES: &str = "\
Examples:
  gyradius fit samples.csv
      The report, as comments, and the fragment: all of it can be pasted into a scenario
  gyradius fit samples.csv --body stage -o stage.toml
      The report on the screen, report and fragment in a file
  gyradius fit samples.json --format json > fit.json
      Everything as one JSON object
  gyradius fit bodies.csv
      With columns mass_kg,cx_m,cy_m,cz_m too: the joint law of the ten below the report
  gyradius fit posterior.csv --parameters linear
      m, m c (first_moment_1_kg_m…) and the inertia about the origin, as an identification has them
  gyradius fit --estimate phi.json -o law.json
      The realizable laws with a mean and covariance of ten parameters, and how far they had to move:
      {\"parameters\": \"linear\", \"mean\": [10], \"covariance\": [[10] x 10]}

Files are read as by `gyradius check`: a CSV with a header ixx,iyy,izz,ixy,ixz,iyz (or i11…), or \
JSON or TOML; kg·m² unless the header says otherwise. At least 13 samples.

Exit code: 0 if nothing speaks against the model, 1 if the samples do (the fragment is written \
all the same) or an estimate had to be moved or has no law with its moments, 2 if something could not be read, fitted or written.";

pub(crate) const COMPARE_EXAMPLES: &str = "\
Examples:
  gyradius compare
      Every model on four bodies, from 1 to 50 % of the largest moment
  gyradius compare --body 5000,4000,3000,20,2,-50 --levels 3,10 --out report
      Another body, with page, tables and figures in the folder report
  gyradius compare --scenario my-vehicle.toml --body payload
      The payload of a scenario, in that scenario's separation
  gyradius compare --reference entries --body slender-stage
      Six independent deviations of that size instead, as in common practice
  gyradius compare --models principal,entrywise --format csv > comparison.csv
      Two models, for another program

The same options and seed give the same numbers on any number of threads.

Exit code: 0; 2 if something could not be read, done or written.";

pub(crate) const CHECK_EXAMPLES: &str = "\
Examples:
  gyradius check robot.urdf
      The bodies of one file that cannot exist
  gyradius check robots/ parts.csv
      All files below a folder, and a table
  gyradius check --repair robot.urdf
      Write robot.repaired.urdf beside it: the nearest possible inertias, all else as it was
  xacro robot.urdf.xacro | gyradius check -
      What another program writes
  gyradius check --format json --all robots/ > inertias.json
      Every body, for another program

Folders are searched for .urdf .xacro .mjcf .sdf .world .xml .csv .toml .json. What may hold bodies and \
is not read (macros of xacro, included files, USD, .mjb) is passed over and named. Hidden files, \
*.repaired.* and caches are not looked at.

Exit code: 2 if a copy that --repair asks for could not be made or written; otherwise 1 if a body is impossible \
or has inertia on no mass; otherwise 2 if something could not be read, or no body was found; 0 if all bodies are \
possible.";

pub(crate) const EXAMPLES: &str = "\
Examples:
  gyradius study
      The study of Peck (2003): four models, 2,000 runs each, into target/study/peck-2003
  gyradius study --runs 200 --out /tmp/quick
      A quick look
  gyradius study --scenario my-vehicle.toml --seed 7 --threads 4
      Another vehicle. Start from the scenario.toml that any study writes
  mpirun -n 8 gyradius study --runs 1e8 --out big --threads 1 --shard auto/8
      Eight processes of MPI do a shard each, as tasks of Slurm, Kubernetes or HyperQueue do
  gyradius study --scenario my-fleet.toml --vehicles 500
      More vehicles of a scenario that says vehicles and flights in the place of runs
  gyradius study --seed 8 --force
      Replace the study in the folder by another one

The same scenario, runs and seed give the same numbers on any number of threads.

Exit code: 0; 1 if a requirement is not met or not decided, or if more runs of a model failed than \
--max-failed allows (the folder is written all the same); 2 if something could not be read, done or \
written; 130 or 143 after a signal, upon which the same command goes on.";

pub(crate) const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  mkdir -p ~/.local/share/bash-completion/completions
  gyradius completions bash > ~/.local/share/bash-completion/completions/gyradius
  gyradius completions zsh > ~/.zfunc/_gyradius
  gyradius completions fish > ~/.config/fish/completions/gyradius.fish

Exit code: 0, or 2 if the script could not be written.";

pub(crate) const MAN_EXAMPLES: &str = "\
Examples:
  gyradius man | man -l -
      The page of the program, as `man` shows it
  mkdir -p ~/.local/share/man/man1
  gyradius man study > ~/.local/share/man/man1/gyradius-study.1
      The page of a verb, for `man gyradius-study`

Exit code: 0; 2 if there is no such verb, or if the page could not be written.";

pub(crate) const ROLLUP_EXAMPLES: &str = "\
Examples:
  gyradius rollup parts.csv
      Mass, mass centre and inertia of the whole, their standard deviations by first order and by drawing
  gyradius rollup parts.csv -n 1e6 -o whole.parquet
      A million draws of the whole as a table
  gyradius rollup parts.csv -n 0
      First order alone
  gyradius rollup table.tsv --edges edges.tsv
      A table and a tree as the R package massProps has them

A list of parts, with units in the headings (docs/rollup.md says all columns):
  name,mass_kg,centre_x_m,centre_y_m,centre_z_m,ixx_kg_m2,iyy_kg_m2,izz_kg_m2,mass_percent
  bus,300,0,0,0.5,60,60,50,2
  tank,100,0,0,1.3,4,4,4,5

Exit code: 0; 2 if something could not be read, put together or written; 130 after an interrupt, 143 after SIGTERM.";
