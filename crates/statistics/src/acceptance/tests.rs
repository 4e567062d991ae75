//! temp
use super::*;
use crate::*;
#[test]
fn extreme() {
    for p in [1e-9, 0.01, 0.5, 0.9973, 1.0 - 1e-6, 1.0 - 1e-9] {
        for c in [0.5, 0.9, 1.0 - 1e-9] {
            let rule = Acceptance::new(p, Confidence::new(c).unwrap()).unwrap();
            let seq = SequentialAcceptance::new(rule);
            let t = std::time::Instant::now();
            for k in [0, 1, 1000, 1_000_000, 900_000_000] {
                let n = rule.least_runs(k);
                print!("p {p} c {c} k {k} n {n:?} {:?} ", t.elapsed());
                println!("{:?} {:?}", seq.least_runs(k), t.elapsed());
            }
            for n in [1, 1000, 1_000_000_000, 1_000_000_000_000_000] {
                println!(
                    "  n {n}: {:?} {:?} {:?} {:?} {:?}",
                    rule.allowed_failures(n),
                    rule.refused_failures(n),
                    seq.allowed_failures(n),
                    seq.refused_failures(n),
                    t.elapsed()
                );
            }
            for (k, n) in [
                (0, 0),
                (0, 1000),
                (5, 1000),
                (2_000_000, 1_000_000_000),
                (500_000_000, 1_000_000_000),
            ] {
                println!(
                    "  {k}/{n} {:?} {:?} {:?} {:?}",
                    rule.verdict(k, n),
                    seq.verdict(k, n),
                    seq.interval(k, n).unwrap(),
                    t.elapsed()
                );
            }
        }
    }
}
