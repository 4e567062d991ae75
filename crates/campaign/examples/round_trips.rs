//! What a run of a simulator costs that answers at once: `round_trips [RUNS [THREADS [COMMAND...]]]`. Without a command it
//! asks a copy of itself that adds up its inputs.

use gyradius_campaign::{
    Column, ExternalSimulation, Failure, Inputs, Program, Simulator, run, threads,
};
use std::{
    error::Error,
    io::{BufRead, Write, stdin, stdout},
    path::Path,
    time::Instant,
};

/// Twenty numbers.
struct Twenty;

impl Inputs for Twenty {
    fn columns(&self) -> Vec<Column> {
        (0..20).map(|i| Column::number(format!("x{i}"), "1", "A number.")).collect()
    }

    fn draw(&self, run: u64, numbers: &mut Vec<Option<f64>>) -> Result<(), Failure> {
        numbers.extend((0..20_u32).map(|i| Some((run as f64 + f64::from(i)).sqrt())));
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.first().is_some_and(|first| first == "answer") {
        return answer();
    }
    let number = |place: usize, otherwise: u64| {
        arguments.get(place).map_or(Ok(otherwise), |argument| argument.parse())
    };
    let (runs, on) = (number(0, 100_000)?, number(1, 1)? as usize);
    let own = [std::env::current_exe()?.display().to_string(), "answer".to_owned()];
    let command = arguments.get(2..).filter(|words| !words.is_empty()).unwrap_or(&own);
    let simulator = Simulator::start(Program::new(command, Path::new("."))?)?;
    let sum = Column::number("sum", "1", "Sum of the numbers.");
    let simulation = ExternalSimulation::new(&simulator, 1, "any", Twenty, vec![sum]);
    let threads = threads(Some(on))?;
    // Processes have started when they have answered.
    run(&simulation, "any", 1000, &threads, &|_| {})?;
    let start = Instant::now();
    let table = run(&simulation, "any", runs, &threads, &|_| {})?;
    let each = start.elapsed().as_secs_f64() * on as f64 / runs as f64;
    let failed = table.failures().len();
    println!("{:.1} µs a run and thread; {failed} of {runs} runs failed", each * 1e6);
    if let Some((run, failure)) = table.failures().next() {
        println!("run {run}: {failure}");
    }
    Ok(())
}

/// A simulator that answers at once.
fn answer() -> Result<(), Box<dyn Error>> {
    let (mut lines, mut out) = (stdin().lock().lines(), stdout().lock());
    while let Some(line) = lines.next().transpose()? {
        let asked: serde_json::Value = serde_json::from_str(&line)?;
        let inputs = asked["inputs"].as_object().ok_or("no inputs")?;
        let sum: f64 = inputs.values().filter_map(serde_json::Value::as_f64).sum();
        writeln!(out, "{}", serde_json::json!({"run": asked["run"], "outputs": {"sum": sum}}))?;
        out.flush()?;
    }
    Ok(())
}
