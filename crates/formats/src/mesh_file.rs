//! The vertices of a mesh in an STL or OBJ file.

use std::{fs::File, io::Read, path::Path};

use crate::{MAX_BYTES, located::located};

/// Bytes before the triangles of a binary STL file: a title and their number.
const HEAD: usize = 84;
/// Bytes of a triangle there: a normal, three corners and two bytes.
const TRIANGLE: usize = 50;

/// The vertices of the mesh that a robot file names, in the units of the file.
pub(crate) fn vertices(uri: &str, robot: &Path) -> Result<Vec<[f64; 3]>, MeshFileError> {
    let fail = |why: String| MeshFileError { mesh: uri.to_owned(), why };
    let path = located(uri, robot, Path::is_file)
        .ok_or_else(|| fail("there is no such file".to_owned()))?;
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    if !matches!(extension.as_str(), "stl" | "obj") {
        return Err(fail("of meshes, STL and OBJ files are read".to_owned()));
    }
    let mut bytes = Vec::new();
    File::open(&path)
        .and_then(|file| file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes))
        .map_err(|error| fail(error.to_string()))?;
    if bytes.len() > MAX_BYTES {
        return Err(fail(format!("it is larger than {} MiB", MAX_BYTES >> 20)));
    }
    let vertices = match binary_stl(&bytes) {
        Some(vertices) if extension == "stl" => vertices,
        Some(_) | None => {
            let word = if extension == "stl" { "vertex" } else { "v" };
            text(&bytes, word)
                .ok_or_else(|| fail("a vertex of it is not three numbers".to_owned()))?
        }
    };
    if vertices.is_empty() {
        return Err(fail(
            if extension == "stl" {
                "it has no lines \"vertex x y z\", and not as many bytes as its number of triangles says"
            } else {
                "it has no lines \"v x y z\""
            }
            .to_owned(),
        ));
    }
    if vertices.iter().flatten().any(|x| !x.is_finite()) {
        return Err(fail("a vertex of it is not finite".to_owned()));
    }
    Ok(vertices)
}

/// The corners of the triangles of a binary STL file, if its length is that of one, or by less than a triangle more.
fn binary_stl(bytes: &[u8]) -> Option<Vec<[f64; 3]>> {
    let number = u32::from_le_bytes(bytes.get(HEAD - 4..HEAD)?.try_into().ok()?);
    let length = usize::try_from(number).ok()?.checked_mul(TRIANGLE)?.checked_add(HEAD)?;
    if bytes.len().checked_sub(length)? >= TRIANGLE {
        return None;
    }
    let mut corners = Vec::new();
    for triangle in bytes[HEAD..length].chunks_exact(TRIANGLE) {
        for corner in triangle[12..48].chunks_exact(12) {
            let number = |i: usize| -> Option<f64> {
                Some(f64::from(f32::from_le_bytes(corner.get(4 * i..4 * i + 4)?.try_into().ok()?)))
            };
            corners.push([number(0)?, number(1)?, number(2)?]);
        }
    }
    Some(corners)
}

/// What follows a word, in large or small letters, at the beginning of a line; nothing if that is not three numbers once.
fn text(bytes: &[u8], word: &str) -> Option<Vec<[f64; 3]>> {
    let text = String::from_utf8_lossy(bytes);
    let mut vertices = Vec::new();
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        if !words.next().is_some_and(|first| first.eq_ignore_ascii_case(word)) {
            continue;
        }
        let mut number = || words.next()?.parse::<f64>().ok();
        vertices.push([number()?, number()?, number()?]);
    }
    Some(vertices)
}

/// Why a mesh cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("its mesh {mesh}: {why}")]
pub struct MeshFileError {
    mesh: String,
    why: String,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// A tetrahedron in every form, found in every way.
    #[test]
    fn meshes_are_found_and_read() {
        let scratch = tempfile::tempdir().unwrap();
        let package = scratch.path().join("arm");
        fs::create_dir_all(package.join("meshes")).unwrap();
        fs::create_dir(package.join("urdf")).unwrap();
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 1.25]];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mut binary = vec![b's'; 80];
        binary.extend(4_u32.to_le_bytes());
        let mut ascii = "solid a\n".to_owned();
        for face in faces {
            binary.extend([0; 12]);
            ascii += " facet normal 0 0 0\n outer loop\n";
            for corner in face.map(|i: usize| corners[i]) {
                corner.iter().for_each(|x: &f64| binary.extend((*x as f32).to_le_bytes()));
                ascii += &format!("  vertex {} {:e} {}\n", corner[0], corner[1], corner[2]);
            }
            binary.extend([0; 2]);
            ascii += " endloop\n endfacet\n";
        }
        let object: String =
            corners.iter().map(|[x, y, z]| format!("v {x} {y} {z} 1.0\nvn 0 0 1\n")).collect();
        fs::write(package.join("meshes/large.stl"), ascii.to_uppercase()).unwrap();
        fs::write(package.join("meshes/more.stl"), [&binary[..], &[7; 8]].concat()).unwrap();
        let mut fewer = binary.clone();
        fewer[80] = 3;
        for (name, bytes) in [("cut.stl", &binary[..binary.len() - 1]), ("fewer.stl", &fewer[..])] {
            fs::write(package.join("meshes").join(name), bytes).unwrap();
            let error = vertices(&format!("meshes/{name}"), &package.join("arm.urdf")).unwrap_err();
            assert!(error.to_string().contains("number of triangles"), "{error}");
        }
        fs::write(package.join("meshes/b.stl"), binary).unwrap();
        fs::write(package.join("meshes/a.STL"), ascii).unwrap();
        fs::write(package.join("meshes/c.obj"), object).unwrap();
        let robot = package.join("urdf/arm.urdf");
        for name in ["b.stl", "a.STL", "large.stl", "more.stl", "c.obj"] {
            for uri in [
                format!("../meshes/{name}"),
                format!("package://arm/meshes/{name}"),
                format!("model://arm/meshes/{name}"),
                format!("file://{}", package.join("meshes").join(name).display()),
            ] {
                let mut found = vertices(&uri, &robot).unwrap();
                found.sort_by(|a, b| a.partial_cmp(b).unwrap());
                found.dedup();
                let mut expected = corners.to_vec();
                expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
                assert_eq!(found, expected, "{uri}");
            }
        }
        for (name, content) in
            [("d.stl", "solid\nvertex 1 2\n"), ("e.obj", ""), ("f.dae", "v 1 2 3")]
        {
            fs::write(package.join(name), content).unwrap();
            assert!(vertices(&format!("../{name}"), &robot).is_err(), "{name}");
        }
        assert!(vertices("package://leg/meshes/b.stl", &robot).is_err());
    }
}
