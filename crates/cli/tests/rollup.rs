//! `gyradius rollup` as a user meets it: the published example, what is refused, the page.

use serde_json::Value;
use std::fs;

use crate::scratch::Scratch;

const SAWE: &str = include_str!("tables/sawe-3360.csv");
const PAGE: &str = include_str!("../../../docs/rollup.md");

fn furnished() -> Scratch {
    let shell = Scratch::new();
    fs::write(shell.path("parts.csv"), SAWE).unwrap();
    shell
}

impl Scratch {
    #[track_caller]
    fn rollup(&self, arguments: &[&str]) -> String {
        let output = self.run(&[&["rollup"], arguments].concat());
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && message.is_empty(), "{arguments:?}: {message}");
        String::from_utf8(output.stdout).unwrap()
    }

    #[track_caller]
    fn no_rollup(&self, arguments: &[&str]) -> String {
        let output = self.run(&[&["rollup"], arguments].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty() && message.starts_with("error: "), "{message}");
        message
    }
}

/// Every row of the table of shapes in the documentation is read, with its sizes.
#[test]
fn the_documented_shapes_are_read() {
    let page = include_str!("../../../docs/rollup.md");
    let table = page.split("### Shapes").nth(1).unwrap().split("## ").next().unwrap();
    let words =
        |cell: &str| cell.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>();
    let shell = Scratch::new();
    let mut count = 0;
    for row in table.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.split('|').collect();
        for shape in words(cells[1]) {
            let sizes = words(cells[2]);
            let is_outer =
                |size: &str| size.starts_with("outer") || size.starts_with("centre_line");
            let value =
                |size: &String| match (cells[2].contains("(three)"), cells[2].contains("(two)")) {
                    (true, _) => "1 1 1",
                    (_, true) => "1 1",
                    _ if is_outer(size) => "2",
                    _ => "1",
                };
            let heads: String = sizes.iter().map(|size| format!(",{size}")).collect();
            let values: String = sizes.iter().map(|size| format!(",{}", value(size))).collect();
            let spelled = shape[..1].to_uppercase() + &shape[1..].replace('_', " ");
            let text = format!("name,mass,Cx,Cy,Cz,shape{heads}\nit,1,0,0,0,{spelled}{values}\n");
            fs::write(shell.path("parts.csv"), text).unwrap();
            shell.done(&["rollup", "parts.csv", "--draws", "1000"], 0);
            count += 1;
        }
    }
    assert_eq!(count, 22);
}

#[test]
fn the_page_shows_what_is_printed() {
    let shell = furnished();
    let out = shell.rollup(&["parts.csv"]);
    assert!(PAGE.contains(out.trim_end()), "docs/rollup.md should show\n{out}");
    let list = SAWE.lines().filter(|line| !line.starts_with('#')).collect::<Vec<_>>().join("\n");
    assert!(PAGE.contains(&list));
}

/// A dash stands where one of two numbers is constant, drawn or to first order, and nowhere else.
#[test]
fn what_is_constant_correlates_with_nothing() {
    let shell = Scratch::new();
    let header = "part,mass_kg,mass_sigma,cx,cy,cz,i11,i22,i33\n";
    // Both centres in one plane, or on one line: what is out of it is constant.
    for (centres, varying) in [
        (
            ["0.3,0.1,0", "1,0.5,0"],
            &["mass_kg", "centre_1", "centre_2", "i11", "i22", "i33", "i12"][..],
        ),
        (["0.3,0,0", "1,0,0"], &["mass_kg", "centre_1", "i22", "i33"]),
        (["0.3,0.1,2", "1,0.5,-1"], &["mass_kg", "centre_1", "centre_2", "centre_3", "i"]),
        (["1,2,3", "1,2,3"], &["mass_kg"]),
    ] {
        let rows =
            format!("{header}a,10,0.1,{},1,2,2.5\nb,5,0,{},0.5,0.6,0.7\n", centres[0], centres[1]);
        fs::write(shell.path("parts.csv"), rows).unwrap();
        for draws in ["0", "1000"] {
            let out = shell.rollup(&["parts.csv", "-n", draws]);
            let rows: Vec<Vec<&str>> = out
                .lines()
                .skip_while(|line| !line.starts_with("correlations by"))
                .skip(1)
                .take(9)
                .map(|line| line.split_whitespace().collect())
                .collect();
            let names: Vec<&str> =
                ["mass_kg"].into_iter().chain(rows.iter().map(|row| row[0])).collect();
            let varies = |i: usize| varying.iter().any(|name| names[i].contains(name));
            for (i, row) in rows.iter().enumerate().map(|(i, row)| (i + 1, row)) {
                assert_eq!(row.len(), i + 1, "{out}");
                for j in 0..i {
                    assert_eq!(row[j + 1] != "-", varies(i) && varies(j), "{i} {j}: {out}");
                }
            }
        }
    }
}

/// The three parts that add most to a variance stand by name, and all others together; what is constant has no line.
#[test]
fn parts_stand_by_what_they_add() {
    let shell = Scratch::new();
    let mut rows = String::from("name,mass_kg,sigma_mass_kg,cx,cy,cz,sigma_centre_x_m,shape\n");
    // Variances of 1, 4, 9, 16, 25 and 36 kg², and one part alone moves.
    for (i, name) in ["a", "b", "c", "d", "e", "f"].iter().enumerate() {
        let moved = if *name == "b" { "0.1" } else { "" };
        rows += &format!("{name},100,{},0,0,0,{moved},point\n", i + 1);
    }
    fs::write(shell.path("parts.csv"), &rows).unwrap();
    let out = shell.rollup(&["parts.csv", "-n", "0"]);
    let lines: Vec<&str> =
        out.lines().skip_while(|l| !l.starts_with("which parts")).skip(1).take(3).collect();
    let mass = "  mass_kg          f 40 %, e 27 %, d 18 %, 3 others 15 %";
    assert_eq!(lines, [mass, "  mass_centre_1_m  b 100 %", ""], "{out}");
    // Of four, the last is named; of one, nothing is said.
    for (parts, line) in [(5, "d 53 %, c 30 %, b 13 %, a 3 %"), (3, "b 80 %, a 20 %")] {
        let some: Vec<&str> = rows.lines().take(parts).collect();
        fs::write(shell.path("parts.csv"), some.join("\n")).unwrap();
        let out = shell.rollup(&["parts.csv", "-n", "0"]);
        assert!(out.contains(&format!("  mass_kg          {line}\n")), "{out}");
    }
    fs::write(shell.path("parts.csv"), rows.lines().take(2).collect::<Vec<_>>().join("\n"))
        .unwrap();
    assert!(!shell.rollup(&["parts.csv", "-n", "0"]).contains("which parts"));
}

/// The row of the paper, in its own signs, to its digits; its Izz is 0.29 from the sum of its own parts.
#[test]
fn the_published_example_comes_out() {
    let printed: [[f64; 10]; 2] = [
        [
            74.63, 109.8657, -0.1829, -0.0204, 7341.73, 42739.26, 44547.57, 1559.36, -1401.94,
            -1060.95,
        ],
        [
            2.1301, 0.9591, 0.2000, 0.0618, 387.4017, 2794.5468, 2820.5125, 1488.1857, 418.6320,
            125.3175,
        ],
    ];
    let shell = furnished();
    let found: Value =
        serde_json::from_str(&shell.rollup(&["parts.csv", "--format", "json", "-n", "2e4"]))
            .unwrap();
    let digits = [0.01, 1e-4, 1e-4, 1e-4, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01];
    for i in 0..10 {
        let sign = if i < 7 { 1.0 } else { -1.0 };
        let value = sign * found["first_order"]["nominal"][i].as_f64().unwrap();
        let deviation = found["first_order"]["deviation"][i].as_f64().unwrap();
        assert!((value - printed[0][i]).abs() <= 0.5001 * digits[i], "{i}: {value}");
        assert!((deviation - printed[1][i]).abs() <= 0.5001e-4, "{i}: {deviation}");
    }
    // 1.7308² and 1.2416² kg².
    for (place, part, share) in [(0, "2nd Part", 0.660_240), (1, "Widget", 0.339_760)] {
        assert_eq!(found["contributions"][place]["part"], part);
        let of_mass = found["contributions"][place]["share"][0].as_f64().unwrap();
        assert!((of_mass - share).abs() < 1e-6, "{part}: {of_mass}");
    }
    assert_eq!(found["drawn"]["impossible"], 0);
    assert!(found["drawn"]["naive"]["impossible_part"].as_f64().unwrap() > 18_000.0);
    let impossible: Vec<&Value> =
        found["findings"].as_array().unwrap().iter().filter(|f| f["impossible"] == true).collect();
    assert!(impossible.len() == 1 && impossible[0]["part"] == "2nd Part");
}

#[test]
fn draws_are_written_once_and_are_the_same_on_any_number_of_threads() {
    let shell = furnished();
    let out = shell.rollup(&["parts.csv", "-n", "500", "-o", "a.csv", "--threads", "1"]);
    assert!(out.contains("wrote 500 draws to a.csv"), "{out}");
    shell.rollup(&["parts.csv", "-n", "500", "-o", "b.csv", "--threads", "3"]);
    let read = |name: &str| fs::read(shell.path(name)).unwrap();
    assert_eq!(read("a.csv"), read("b.csv"));
    for name in ["a.parquet", "a.npy", "a.jsonl"] {
        shell.rollup(&["parts.csv", "-n", "500", "-o", name]);
        assert!(read(name).len() > 1000, "{name}");
    }
    assert!(shell.no_rollup(&["parts.csv", "-n", "5", "-o", "a.csv"]).contains("a.csv"));
    assert!(
        shell.no_rollup(&["parts.csv", "-o", "parts.csv", "--force"]).contains("not written over")
    );
    assert!(
        shell.no_rollup(&["parts.csv", "-o", "a.xls"]).contains("the extension tells no format")
    );
    assert_eq!(fs::read_to_string(shell.path("parts.csv")).unwrap(), SAWE);
    assert!(!shell.rollup(&["parts.csv", "-n", "0"]).contains("draws: mean"));
    // Of one draw there is a mean, and nothing else.
    let one = shell.rollup(&["parts.csv", "-n", "1"]);
    let row = one.lines().find(|line| line.starts_with("mass_kg")).unwrap();
    let words: Vec<&str> = row.split_whitespace().collect();
    assert!(words.len() == 5 && words[4] == "-" && words[3].starts_with('7'), "{one}");
    assert!(one.contains("correlations by first order"), "{one}");
    let one: Value =
        serde_json::from_str(&shell.rollup(&["parts.csv", "-n", "1", "--format", "json"])).unwrap();
    assert!(one["drawn"]["mean"][0].is_number() && one["drawn"]["deviation"].is_null());
    // Of two, nothing tells how far the deviation may be off.
    let two: Value =
        serde_json::from_str(&shell.rollup(&["parts.csv", "-n", "2", "--format", "json"])).unwrap();
    assert!(two["drawn"]["deviation"][0].is_number() && two["drawn"]["deviation_error"].is_null());
    let two = shell.rollup(&["parts.csv", "-n", "2"]);
    let row = two.lines().find(|line| line.starts_with("mass_kg")).unwrap();
    assert_eq!(row.matches('±').count(), 1, "{row}");
    let none = shell.rollup(&["parts.csv", "-n", "0", "-o", "none.csv"]);
    assert!(none.contains("wrote 0 draws") && !none.contains("Gaussian"), "{none}");
}

#[test]
fn edges_may_stand_apart_and_errors_name_file_and_line() {
    let shell = furnished();
    let list = SAWE.replace("name,parent,", "name,other,").replace("Combined,,,", "#");
    fs::write(shell.path("list.csv"), &list).unwrap();
    fs::write(shell.path("edges.csv"), "child,parent\nWidget,Combined\n2nd Part,Combined\n")
        .unwrap();
    let whole = |text: String| text.lines().skip(2).take(11).collect::<Vec<_>>().join("\n");
    let apart = whole(shell.rollup(&["list.csv", "--edges", "edges.csv"]));
    assert_eq!(apart, whole(shell.rollup(&["parts.csv"])));
    fs::write(shell.path("edges.csv"), "child,parent\nWidget,Combined\n").unwrap();
    let message = shell.no_rollup(&["list.csv", "--edges", "edges.csv"]);
    assert!(
        message.contains("edges.csv: ") && message.contains("2 rows belong to nothing"),
        "{message}"
    );
    fs::write(shell.path("parts.csv"), SAWE.replace("57.83", "heavy")).unwrap();
    let message = shell.no_rollup(&["parts.csv"]);
    assert!(
        message.contains("parts.csv: line 5: Widget: mass = \"heavy\" is not a number"),
        "{message}"
    );
    fs::write(shell.path("parts.csv"), SAWE.replace("integrals", "")).unwrap();
    assert!(shell.no_rollup(&["parts.csv"]).contains("ixy is not zero, and nothing says"));
    assert!(
        shell.rollup(&["parts.csv", "-n", "0", "--products", "integrals"]).contains("-1559.359")
    );
    assert!(shell.no_rollup(&["nowhere.csv"]).contains("nowhere.csv"));
}

/// With a table of edges, what is wrong with it names it, and what is wrong with the list names that.
#[test]
fn errors_name_the_table_that_they_are_in() {
    let shell = Scratch::new();
    let write = |name: &str, text: &str| fs::write(shell.path(name), text).unwrap();
    let list = "name,mass,cx,cy,cz,shape\na,1,0,0,0,point\nb,1,1,0,0,point\n";
    write("list.csv", list);
    let edges = ["list.csv", "--edges", "edges.csv"];
    for (text, expected) in [
        (
            "child,parent\na,v\nb,v\nv,w\nw,v\n",
            "edges.csv: line 4: \"v\" belongs to \"w\" belongs to \"v\": no row",
        ),
        ("child,parent\nv,v\na,v\nb,v\n", "edges.csv: line 2: \"v\" belongs to \"v\": no row"),
        ("child,parent\na,v\nb,w\n", "edges.csv: line 3: 2 rows belong to nothing"),
        ("child,parent\na,v\n", "edges.csv: line 2: 2 rows belong to nothing"),
        ("child,parent\na,v\nb,v\nx,v\n", "edges.csv: line 4: \"x\" has neither numbers nor parts"),
        ("child,parent\na,v,x\n", "edges.csv: line 2: the row has 3 values: there must be 2"),
        ("kid,parent\na,v\n", "edges.csv: line 1: no column is called child"),
        ("", "edges.csv: it is empty"),
        ("child,parent\nb,a\n", "list.csv: line 2: \"a\" has numbers of its own"),
    ] {
        write("edges.csv", text);
        let message = shell.no_rollup(&edges);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
    write("edges.csv", "child,parent\na,v\nb,v\n");
    for (text, expected) in [
        (format!("{list}a,1,0,0,0,point\n"), "list.csv: line 4: name \"a\" stands twice"),
        (format!("{list},1,0,0,0,point\n"), "list.csv: line 4: name is missing"),
        (format!("{list}c,-1,0,0,0,point\n"), "list.csv: line 4: c: mass = -1"),
    ] {
        write("list.csv", &text);
        let message = shell.no_rollup(&edges);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
    write("list.csv", &format!("{list},,,,,\n,,,,,,,,\n"));
    shell.rollup(&edges);
}
