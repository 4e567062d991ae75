//! `gyradius draw robot.urdf`: robots with other mass properties, or a table of these.

use gyradius_estimation::StatementWarning;
use gyradius_formats::{NewFile, RobotFile};
use gyradius_study::{
    CampaignError, LinkSummary, RobotDraw, RobotDrawError, RobotDrawOptions, RobotFolder,
    TableFormat,
};
use std::{
    collections::HashSet,
    error::Error,
    fs::File,
    io::{self, IsTerminal, Read, Write},
    path::Path,
    process::ExitCode,
};

use crate::program::{
    args::DrawArgs,
    draw_output::{format, refuse_input},
    number::short,
    output::{complain, file_of, print, say},
    progress,
    signals::Signals,
};

/// Links, warnings and paths that are listed at most.
const LISTED: usize = 40;

/// Whether what is to be drawn is a robot: by the name of the file, or by how it begins.
pub(crate) fn is_robot(path: &Path) -> bool {
    let mut begins = [0; 512];
    // What cannot be read is told by who reads it.
    let read = if path.is_file() {
        File::open(path).and_then(|mut file| file.read(&mut begins))
    } else {
        Ok(0)
    };
    RobotFile::is_one(path, &begins[..read.unwrap_or(0)])
}

/// Runs the verb for a robot.
pub(crate) fn draw_robot(arguments: &DrawArgs, path: &Path) -> Result<ExitCode, Box<dyn Error>> {
    if !arguments.models.is_empty() {
        return Err("--model is for scenarios: a robot has links, which --links picks".into());
    }
    if !arguments.stated.is_any() {
        return Err("nothing is stated of the links: --mass 10%, --centre 5mm, --moments 15% and --axes 5deg say \
                    what is uncertain"
            .into());
    }
    let Some(draws) = arguments.runs else {
        return Err("-n says how many robots are drawn".into());
    };
    let robot = RobotFile::read(path)?;
    let signals = Signals::watch()?;
    let options = RobotDrawOptions {
        statements: arguments.stated.statements()?,
        links: arguments.links.clone(),
        inside: arguments.inside,
        seed: arguments.seed.unwrap_or_default(),
        first: arguments.first,
        draws,
        threads: arguments.threads,
        stop: Some(signals.stop()),
    };
    let draw =
        RobotDraw::new(&robot, options).map_err(|error| format!("{}: {error}", path.display()))?;
    match write(arguments, path, &draw) {
        Err(error) if is_stopped(error.as_ref()) => {
            complain("stopped");
            Ok(signals.code())
        }
        Err(error) => Err(error),
        // The table is on standard output: what there is to say stands beside it.
        Ok(None) => {
            let links = draw.summaries();
            // Refused draws make deviations smaller than those that are stated.
            let told = if arguments.inside.is_some() {
                table_of(&draw, &links)
            } else {
                warnings_of(&links)
            };
            say((left_as_they_are(&robot, &draw) + &told).trim_end());
            Ok(ExitCode::SUCCESS)
        }
        Ok(Some(place)) => {
            print(&report(arguments, &robot, &draw, &place))?;
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// Writes a table, or robots into a folder, and says where.
fn write(
    arguments: &DrawArgs,
    input: &Path,
    draw: &RobotDraw<'_>,
) -> Result<Option<String>, Box<dyn Error>> {
    let file = file_of(arguments.output.as_deref());
    match file {
        Some(path) if arguments.format.is_some() || has_table_name(path) => {
            let format = format(arguments, file)?;
            refuse_input(path, input)?;
            let mut output = NewFile::create(path, arguments.force)?;
            table(draw, format, &mut output).map_err(|error| named(error, path))?;
            output.finish()?;
            Ok(Some(format!("wrote {}", path.display())))
        }
        // A folder is rarely called like a file: an extension that tells no table is a slip.
        Some(path) if path.extension().is_some() && !path.is_dir() && !ends_in_slash(path) => {
            let name = path.display();
            Err(format!(
                "{name}: the name of a table must end in .csv, .jsonl, .npy or .parquet; a folder of this name must be written as {name}/"
            )
            .into())
        }
        Some(folder) => {
            let robots = arguments.runs.unwrap_or_default();
            let written = progress::show(robots, "robots", |report| {
                draw.write_folder(folder, arguments.force, report)
            });
            let written = written.map_err(|error| match error {
                RobotDrawError::Robot(error) => format!("{}: {error}", input.display()).into(),
                other => Box::<dyn Error>::from(other),
            })?;
            warn_of_lost_paths(folder, &written);
            Ok(Some(placed(&written)))
        }
        None => {
            let format = format(arguments, None)?;
            let mut out = io::stdout();
            let written = if out.is_terminal() {
                // A bar would stand between the lines.
                draw.write_table(format, &mut out, &|_| {})
            } else {
                table(draw, format, &mut out)
            };
            let flushed = written
                .and_then(|()| Ok(out.flush().map_err(gyradius_study::FormatError::from)?));
            match flushed {
                // A reader that reads no further, as `head` does, has what it wanted.
                Err(RobotDrawError::Output(gyradius_study::FormatError::Io(error)))
                    if error.kind() == io::ErrorKind::BrokenPipe => {}
                Err(RobotDrawError::Output(error)) => {
                    return Err(format!("standard output: {error}").into());
                }
                other => other?,
            }
            Ok(None)
        }
    }
}

/// Whether a path is called like a table, and not like a folder.
fn has_table_name(path: &Path) -> bool {
    TableFormat::of_path(path).is_some() && !ends_in_slash(path)
}

fn ends_in_slash(path: &Path) -> bool {
    path.as_os_str().to_string_lossy().ends_with(std::path::is_separator)
}

fn table(
    draw: &RobotDraw<'_>,
    format: TableFormat,
    output: impl Write + Send,
) -> Result<(), RobotDrawError> {
    progress::show(draw.steps(format), "rows", |report| draw.write_table(format, output, report))
}

fn named(error: RobotDrawError, path: &Path) -> Box<dyn Error> {
    match error {
        RobotDrawError::Output(error) => format!("cannot write {}: {error}", path.display()).into(),
        other => other.into(),
    }
}

fn placed(folder: &RobotFolder) -> String {
    let (Some(first), Some(last)) = (&folder.first, &folder.last) else {
        return "wrote no robots".to_owned();
    };
    let last = last.file_name().unwrap_or_default().to_string_lossy();
    let (written, unchanged) = (folder.written, folder.unchanged);
    let already = match unchanged {
        0 => String::new(),
        _ => format!("; {unchanged} were there already"),
    };
    let robots = if written == 1 { "robot" } else { "robots" };
    format!("wrote {written} {robots}, {} to {last}{already}", first.display())
}

fn warn_of_lost_paths(folder: &Path, written: &RobotFolder) {
    let lost = &written.lost_paths;
    let Some(first) = lost.first() else { return };
    let more = if lost.len() > 1 { format!(" and {} more", lost.len() - 1) } else { String::new() };
    say(&format!(
        "warning: the robots name {first}{more} by paths that lead nowhere from {}: write them into the folder of the \
         original, or copy or link these files there",
        folder.display()
    ));
}

/// What has been drawn, for people.
fn report(arguments: &DrawArgs, robot: &RobotFile, draw: &RobotDraw<'_>, place: &str) -> String {
    let (links, draws) = (draw.links().len(), arguments.runs.unwrap_or_default());
    let seed = arguments.seed.unwrap_or_default();
    let sigmas = short(arguments.stated.sigmas());
    let deviations = if arguments.stated.sigmas() == 1.0 { "deviation" } else { "deviations" };
    let mut out = format!(
        "{place}\n{links} link{}, {draws} draw{}, seed {seed}; ± is {sigmas} standard {deviations}\n",
        if links == 1 { "" } else { "s" },
        if draws == 1 { "" } else { "s" }
    );
    if draws > 1 {
        out += &table_of(draw, &draw.summaries());
    }
    out + &left_as_they_are(robot, draw)
}

/// Links that are not drawn, and why, and what else makes the draws others than they seem.
fn left_as_they_are(robot: &RobotFile, draw: &RobotDraw<'_>) -> String {
    let mut out = String::new();
    for (name, why) in draw.left().iter().take(LISTED) {
        out += &format!("left as it is: {name}: {why}\n");
    }
    if draw.left().len() > LISTED {
        out += &format!("left as they are: {} more\n", draw.left().len() - LISTED);
    }
    for (name, defaults) in defaults_of(robot, draw).iter().take(LISTED) {
        let fields = defaults.join(", ");
        let of_mass = defaults.contains(&"mass").then_some("a mass of 1 kg");
        let of_inertia = defaults.iter().any(|field| *field != "mass");
        let of_inertia = of_inertia.then_some("moments of inertia of 1 kg·m²");
        let taken: Vec<&str> = of_mass.into_iter().chain(of_inertia).collect();
        out += &format!(
            "note: {name}: the file does not state {fields}: its draws are about the defaults of SDF, {}\n",
            taken.join(" and ")
        );
    }
    for gap in robot.gaps() {
        out += &format!("not drawn: {}:{}: {gap}\n", robot.path().display(), gap.line());
    }
    for doubt in robot.compiler_doubts() {
        out += &format!("warning: {doubt}\n");
    }
    out
}

/// Links that are drawn about defaults of their format, and of which fields.
fn defaults_of<'a>(
    robot: &'a RobotFile,
    draw: &RobotDraw<'_>,
) -> Vec<(&'a str, &'a [&'static str])> {
    let drawn: HashSet<&str> = draw.links().collect();
    let links = robot.links().iter().map(|link| (link.name(), link.defaults()));
    links.filter(|(name, defaults)| !defaults.is_empty() && drawn.contains(name)).collect()
}

/// Standard deviations that came out, and what is to be said of links.
fn table_of(draw: &RobotDraw<'_>, links: &[LinkSummary]) -> String {
    let width = links.iter().take(LISTED).map(|link| link.name.chars().count()).max();
    let width = width.unwrap_or(0).max(4);
    let percent = |x: f64| if x.is_finite() { format!("{x:.1} %") } else { "-".to_owned() };
    let first =
        if draw.has_more() { format!("first {} ", draw.summarized()) } else { String::new() };
    let mut out = format!(
        "\nstandard deviations of the {first}draws\n{:width$}  {:>8}  {:>20}  {:>8}  {:>8}  {:>8}\n",
        "link", "mass", "mass centre, mm", "I11", "I22", "I33"
    );
    for link in links.iter().take(LISTED) {
        let [x, y, z] = link.centre_m.map(|metres| format!("{:.2}", 1e3 * metres));
        let [i11, i22, i33] = link.moments_percent.map(percent);
        let (mass, centre) = (percent(link.mass_percent), format!("{x} {y} {z}"));
        out += &format!(
            "{:width$}  {mass:>8}  {centre:>20}  {i11:>8}  {i22:>8}  {i33:>8}\n",
            link.name
        );
    }
    if links.len() > LISTED {
        out += &format!("and {} more links\n", links.len() - LISTED);
    }
    out.push('\n');
    let (impossible, tried) = links
        .iter()
        .filter_map(|link| link.naive_impossible)
        .fold((0, 0), |sums, one| (sums.0 + one.0, sums.1 + one.1));
    if impossible > 0 {
        let share = 100.0 * impossible as f64 / tried as f64;
        out += &format!(
            "all of these inertias are possible; if each moment had been multiplied by a random factor of its own instead, {share:.1} % of \
             them would be impossible\n"
        );
    }
    out + &warnings_of(links)
}

/// The warnings of all links, those of a kind together: of the first link in full, and of others what is their own.
fn warnings_of(links: &[LinkSummary]) -> String {
    let mut kinds: Vec<Vec<(usize, &StatementWarning)>> = Vec::new();
    for (place, link) in links.iter().enumerate() {
        for warning in &link.warnings {
            match kinds.iter_mut().find(|kind| kind[0].1.is_like(warning)) {
                Some(kind) => kind.push((place, warning)),
                None => kinds.push(vec![(place, warning)]),
            }
        }
    }
    let mut out = String::new();
    for kind in kinds {
        let mut of_links = kind.chunk_by(|a, b| a.0 == b.0);
        for (place, warning) in of_links.next().into_iter().flatten() {
            out += &format!("warning: {}: {warning}\n", links[*place].name);
        }
        let others: Vec<String> = of_links
            .map(|of_link| {
                let name = links[of_link[0].0].name.as_str();
                let own: Vec<_> =
                    of_link.iter().filter_map(|(_, warning)| warning.figure()).collect();
                if own.is_empty() {
                    name.to_owned()
                } else {
                    format!("{name} ({})", own.join("; "))
                }
            })
            .collect();
        if !others.is_empty() {
            let (told, rest) = others.split_at(others.len().min(10));
            let more = match rest.len() {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            out += &format!("         also for {}{more}\n", told.join(", "));
        }
    }
    out
}

/// Whether a signal ended it.
fn is_stopped(error: &(dyn Error + 'static)) -> bool {
    let stopped = error.downcast_ref::<RobotDrawError>();
    matches!(stopped, Some(RobotDrawError::Campaign(CampaignError::Stopped)))
}
