//! The same rover in every format: read, judged, repaired, and mutilated.

use gyradius_formats::{
    FileBody, InertiaFile, Products, Remedy, RepairError, TOLERANCE, copy_path, judge, write_copy,
};
use gyradius_inertia::InertiaMatrix;
use proptest::prelude::*;
use std::{fs, path::Path};

const SAMPLES: [(&str, &[u8]); 6] = [
    ("rover.urdf", include_bytes!("data/rover.urdf")),
    ("rover.xml", include_bytes!("data/rover.xml")),
    ("rover.sdf", include_bytes!("data/rover.sdf")),
    ("rover.csv", include_bytes!("data/rover.csv")),
    ("rover.toml", include_bytes!("data/rover.toml")),
    ("rover.json", include_bytes!("data/rover.json")),
];

fn parse(name: &str, bytes: &[u8], products: Products) -> InertiaFile {
    InertiaFile::parse(Path::new(name), bytes.to_vec(), products).unwrap()
}

fn nearest(indices: &[usize]) -> Vec<(usize, Remedy)> {
    indices.iter().map(|i| (*i, Remedy::Nearest)).collect()
}

fn impossible(file: &InertiaFile) -> Vec<usize> {
    (0..file.bodies().len())
        .filter(|i| {
            let body = &file.bodies()[*i];
            body.inertia()
                .is_ok_and(|m| !judge(m, body.mass_kg(), TOLERANCE).report().is_realizable())
        })
        .collect()
}

/// The text with every number replaced by a mark.
fn without_numbers(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let words = text.split(|c: char| c.is_ascii_digit() || "+-.eE".contains(c));
    words.filter(|word| !word.is_empty()).collect::<Vec<_>>().join("#")
}

#[test]
fn every_format_says_the_same() {
    for (name, bytes) in SAMPLES {
        let file = parse(name, bytes, Products::TensorEntries);
        let names: Vec<_> = file.bodies().iter().map(FileBody::name).collect();
        assert_eq!(names, ["chassis", "strut", "wheel"], "{name}");
        let masses: Vec<_> = file.bodies().iter().map(FileBody::mass_kg).collect();
        assert_eq!(masses, [Some(12.5), Some(3.0), Some(1.5)], "{name}");
        let chassis = file.bodies()[0].inertia().unwrap();
        let rows = [[0.4, 0.01, -0.02], [0.01, 0.5, 0.0], [-0.02, 0.0, 0.7]];
        assert_eq!(chassis, &nalgebra::Matrix3::from_fn(|i, j| rows[i][j]), "{name}");
        assert_eq!(impossible(&file), [2], "{name}");
        let wheel = judge(file.bodies()[2].inertia().unwrap(), None, TOLERANCE);
        assert!((wheel.report().excess_percent().unwrap() - 50.0).abs() < 1e-9, "{name}");
        let line = file.bodies()[2].line();
        let text = String::from_utf8_lossy(bytes);
        let line = text.lines().nth(line - 1).unwrap();
        assert!(line.contains("inertia") || line.starts_with("wheel"), "{name}: {line}");
    }
}

/// The strut is a body with products as tensor entries, and none with their signs flipped.
#[test]
fn the_sign_of_products_matters_in_every_format() {
    for (name, bytes) in SAMPLES {
        assert_eq!(impossible(&parse(name, bytes, Products::Integrals)), [1, 2], "{name}");
    }
    let (name, bytes) = SAMPLES[4];
    let stated = [b"products = \"integrals\"\n", bytes].concat();
    assert_eq!(impossible(&parse(name, &stated, Products::TensorEntries)), [1, 2]);
    let stated = [b"products = \"tensor\"\n", bytes].concat();
    assert_eq!(impossible(&parse(name, &stated, Products::Integrals)), [2], "the file knows");
}

#[test]
fn repairs_touch_nothing_but_the_numbers_of_the_body() {
    for (name, bytes) in SAMPLES {
        let crlf = String::from_utf8(bytes.to_vec()).unwrap().replace('\n', "\r\n").into_bytes();
        let marked = [b"\xef\xbb\xbf", crlf.as_slice()].concat();
        for dressed in [bytes, &crlf, &marked] {
            for products in [Products::TensorEntries, Products::Integrals] {
                let file = parse(name, dressed, products);
                let bad = impossible(&file);
                let copy = file.repaired(&nearest(&bad)).unwrap();
                assert_ne!(copy, dressed, "{name}");
                assert_eq!(without_numbers(&copy), without_numbers(dressed), "{name}");
                let again = parse(name, &copy, products);
                assert!(impossible(&again).is_empty(), "{name}");
                for (i, (before, after)) in file.bodies().iter().zip(again.bodies()).enumerate() {
                    let matrix = InertiaMatrix::new(*after.inertia().unwrap()).unwrap();
                    assert!(matrix.is_realizable(), "{name}: at the strict rule");
                    if !bad.contains(&i) {
                        assert_eq!(before, after, "{name}: the others are as they were");
                    }
                }
                assert_eq!(again.repaired(&[]).unwrap(), copy, "nothing left to repair");
            }
        }
    }
}

#[test]
fn a_repaired_wheel_is_the_nearest_one() {
    for (name, bytes) in SAMPLES {
        let file = parse(name, bytes, Products::TensorEntries);
        let again = parse(name, &file.repaired(&nearest(&[2])).unwrap(), Products::TensorEntries);
        let wheel = again.bodies()[2].inertia().unwrap();
        for (i, expected) in [4.0 / 3e3, 4.0 / 3e3, 8.0 / 3e3].into_iter().enumerate() {
            assert!((wheel[(i, i)] / expected - 1.0).abs() < 1e-8, "{name}: {wheel}");
        }
    }
}

/// A table in g·mm² is judged in kg·m² and repaired in g·mm².
#[test]
fn a_copy_keeps_the_units_of_the_file() {
    let csv = "name,mass [g],ixx [g mm2],iyy [g mm2],izz [g mm2]\nwheel,2,1000,1000,3000\n";
    let file = parse("a.csv", csv.as_bytes(), Products::TensorEntries);
    assert_eq!(file.bodies()[0].mass_kg(), Some(2e-3));
    assert!((file.bodies()[0].inertia().unwrap()[(2, 2)] - 3e-6).abs() < 1e-20);
    let copy = String::from_utf8(file.repaired(&nearest(&[0])).unwrap()).unwrap();
    assert!(copy.ends_with("wheel,2,1333.333344,1333.333344,2666.6666773\n"), "{copy}");
}

#[test]
fn other_encodings_are_kept() {
    let urdf =
        b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><robot><!-- R\xe4der \xb2 --><link \
                 name=\"r\xe4d\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" \
                 izz=\"3\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link></robot>";
    let file = parse("a.urdf", urdf, Products::TensorEntries);
    let copy = file.repaired(&nearest(&[0])).unwrap();
    assert!(copy.windows(8).any(|w| w == b"R\xe4der \xb2 "));
    let csv = b"Name;Ixx [kg m\xb2];Iyy [kg m\xb2];Izz [kg m\xb2]\r\nR\xe4d;1;1;3\r\n";
    let file = parse("a.csv", csv, Products::TensorEntries);
    assert_eq!(impossible(&file), [0]);
    assert!(file.repaired(&nearest(&[0])).unwrap().starts_with(&csv[..45]));
}

#[test]
fn what_is_not_written_cannot_be_repaired() {
    let sdf =
        "<sdf><link name='a'><inertial><inertia><ixx>5</ixx></inertia></inertial></link></sdf>";
    let file = parse("a.sdf", sdf.as_bytes(), Products::TensorEntries);
    assert_eq!(impossible(&file), [0]);
    let error = file.repaired(&nearest(&[0])).unwrap_err().to_string();
    assert!(error.contains("line 1: \"a\": an entry that must change is not written"), "{error}");
}

/// Numbers of any size, and every way of being wrong.
#[test]
fn hard_inertias_are_repaired() {
    for moments in [
        "1e-300 1e-300 3e-300",
        "1e300 1e300 3e300",
        "0 0 1",
        "-1 5 5",
        "1 -1 0",
        "1e-9 1 1e9",
        "1 1 2.00001",
        "-2.4e-35 0 2.4e-35",
    ] {
        for products in ["0 0 0", "0.3 -0.2 1e-5"] {
            let xml = format!(
                "<mujoco><body><inertial mass='1' fullinertia='{moments} {products}'/></body></mujoco>"
            );
            let file = parse("a.xml", xml.as_bytes(), Products::TensorEntries);
            let bad = impossible(&file);
            let copy = file.repaired(&nearest(&bad)).unwrap_or_else(|e| panic!("{xml}: {e}"));
            assert!(
                impossible(&parse("a.xml", &copy, Products::TensorEntries)).is_empty(),
                "{xml}"
            );
        }
    }
}

#[test]
fn copies_never_replace_originals_or_links() {
    let folder = tempfile::tempdir().unwrap();
    let original = folder.path().join("robot.urdf");
    fs::write(&original, "original").unwrap();
    let copy = copy_path(&original);
    assert!(copy.ends_with("robot.repaired.urdf"));
    assert!(write_copy(&copy, b"one", &[], false).unwrap());
    assert!(!write_copy(&copy, b"one", &[], false).unwrap(), "the same is there");
    let error = write_copy(&copy, b"two", &[], false).unwrap_err().to_string();
    assert!(error.contains("exists: --force"), "{error}");
    assert!(write_copy(&copy, b"two", &[], true).unwrap());
    let canonical = fs::canonicalize(&copy).unwrap();
    assert!(write_copy(&copy, b"three", &[canonical], true).is_err());
    assert_eq!(fs::read(&copy).unwrap(), b"two");
    #[cfg(unix)]
    {
        fs::remove_file(&copy).unwrap();
        std::os::unix::fs::symlink(&original, &copy).unwrap();
        assert!(write_copy(&copy, b"four", &[], false).is_err());
        assert!(write_copy(&copy, b"four", &[], true).is_err());
        assert_eq!(fs::read_to_string(&original).unwrap(), "original");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "no drafts are left");
}

#[test]
fn sizes_are_limited() {
    let refusal = |name: &str, bytes: Vec<u8>| {
        InertiaFile::parse(Path::new(name), bytes, Products::default()).unwrap_err().to_string()
    };
    assert!(refusal("a.urdf", vec![b' '; (64 << 20) + 1]).contains("larger than 64 MiB"));
    assert!(refusal("a.toml", vec![b' '; (8 << 20) + 1]).contains("larger than 8 MiB"));
    let list = format!("{{\"bodies\": [{}0]}}", "0,".repeat(1_000_001));
    assert!(refusal("a.json", list.into_bytes()).contains("1000000 bodies"));
    let rows = "1,1,1\n".repeat(1_000_001);
    assert!(
        refusal("a.csv", format!("ixx,iyy,izz\n{rows}").into_bytes()).contains("1000000 bodies")
    );
    let deep = format!("<robot>{}", "<a>".repeat(100_000));
    assert!(refusal("a.urdf", deep.into_bytes()).contains("deeper than 256"));
}

fn exercise(name: &str, bytes: Vec<u8>) {
    let Ok(file) = InertiaFile::parse(Path::new(name), bytes, Products::TensorEntries) else {
        return;
    };
    let bad = impossible(&file);
    if let Ok(copy) = file.repaired(&nearest(&bad)) {
        assert!(impossible(&parse(name, &copy, Products::TensorEntries)).is_empty());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Samples with bytes changed, cut out, repeated and put in: read or refused, never a panic,
    /// and what is repaired is repaired.
    #[test]
    fn mutilated_files_do_not_panic(
        sample in 0..SAMPLES.len(),
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0_usize..40, 0_usize..4), 1..6),
        noise in prop::collection::vec(
            prop::sample::select(b"<>/=\"'&;-#[]{},.:e0919\n\r \0\xff$n".to_vec()), 8),
    ) {
        let (name, bytes) = SAMPLES[sample];
        let mut bytes = bytes.to_vec();
        for (i, (at, length, kind)) in cuts.into_iter().enumerate() {
            if bytes.is_empty() {
                break;
            }
            let start = at.index(bytes.len());
            let end = (start + length).min(bytes.len());
            match kind {
                0 => drop(bytes.drain(start..end)),
                1 => {
                    let part = bytes[start..end].to_vec();
                    bytes.splice(start..start, part);
                }
                2 => bytes.insert(start, noise[i]),
                _ => bytes[start] = noise[i],
            }
        }
        exercise(name, bytes);
    }
}

/// Six numbers in each format, with products as the file has them.
fn written(format: usize, six: &[f64; 6]) -> (&'static str, String) {
    let [xx, yy, zz, xy, xz, yz] = six;
    match format {
        0 => (
            "a.urdf",
            format!(
                "<robot><link name='b'><inertial><mass value='1'/><inertia ixx='{xx}' iyy='{yy}' \
                 izz='{zz}' ixy='{xy}' ixz='{xz}' iyz='{yz}'/></inertial></link></robot>"
            ),
        ),
        1 => (
            "a.xml",
            format!(
                "<mujoco><body name='b'><inertial mass='1' fullinertia='{xx} {yy} {zz} {xy} {xz} \
                 {yz}'/></body></mujoco>"
            ),
        ),
        2 => (
            "a.csv",
            format!(
                "name,ixx [g mm2],iyy,izz,ixy,ixz,iyz\nb,{xx:e},{yy:e},{zz:e},{xy:e},{xz:e},{yz:e}\n"
            ),
        ),
        _ => (
            "a.toml",
            format!(
                "[b]\ninertia_kg_m2 = [[{xx:?}, {xy:?}, {xz:?}], [{xy:?}, {yy:?}, {yz:?}], \
                 [{xz:?}, {yz:?}, {zz:?}]]"
            ),
        ),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    /// What a change says is what the copy has, and how far that is; flipped products are flipped and
    /// nothing else where that is enough; and nothing but a body without inertia is left unrepaired.
    #[test]
    fn changes_are_those_of_the_copy(
        moments in prop::array::uniform3(-0.5..3.0_f64),
        products in prop::array::uniform3(-1.5..1.5_f64),
        format in 0_usize..4,
        integrals in any::<bool>(),
        flip in any::<bool>(),
    ) {
        let [xx, yy, zz] = moments;
        let [xy, xz, yz] = products;
        let (name, text) = written(format, &[xx, yy, zz, xy, xz, yz]);
        let products = if integrals { Products::Integrals } else { Products::TensorEntries };
        let file = parse(name, text.as_bytes(), products);
        let remedy = if flip { Remedy::FlipProducts } else { Remedy::Nearest };
        let before = *file.bodies()[0].inertia().unwrap();
        let flipped = before.map_with_location(|i, j, x| if i == j { x } else { -x });
        if InertiaMatrix::new(before).unwrap().is_realizable() {
            return Ok(());
        }
        let change = match file.change(0, remedy) {
            // The polar cone of the inertias tr(S) 1 − S with S ≽ 0: no eigenvalue of tr(A) 1 − A is above zero, which are the
            // sums of two of A.
            Err(RepairError::NothingLeft { .. }) => {
                let eigenvalues = before.symmetric_eigenvalues();
                prop_assert!(eigenvalues.sum() - eigenvalues.min() < 1e-6 * before.amax(), "{before}");
                return Ok(());
            }
            change => change.unwrap().unwrap(),
        };
        let copy = parse(name, &file.repaired(&[(0, remedy)]).unwrap(), products);
        let after = *copy.bodies()[0].inertia().unwrap();
        prop_assert_eq!(change.before(), &before);
        prop_assert!((change.after() - after).amax() <= 1e-15 * after.amax());
        prop_assert!(InertiaMatrix::new(after).unwrap().is_realizable());
        let distance = (after - before).norm();
        prop_assert!((change.distance_kg_m2() - distance).abs() <= 1e-12 * distance);
        let percent = 100.0 * distance / before.norm();
        prop_assert!((change.distance_percent() - percent).abs() <= 1e-10 * percent);
        if flip && InertiaMatrix::new(flipped).unwrap().is_realizable() {
            prop_assert!((after - flipped).amax() <= 1e-15 * flipped.amax(), "{after} {flipped}");
        } else if !flip {
            // No realizable matrix that is found along the way to a ball is nearer.
            for share in [0.01, 0.1, 0.3] {
                let ball = nalgebra::Matrix3::from_diagonal_element(after.trace() / 3.0);
                let other = after + share * (ball - after);
                prop_assert!((other - before).norm() >= distance * (1.0 - 1e-6));
            }
        }
    }
}
