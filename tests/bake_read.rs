//! Meshes written by a small obvious writer and read again are the same, and no change of a file's bytes makes a reader
//! panic or believe what is not there.
#![cfg(feature = "bake")]

use glam::{Vec2, Vec3};
use lod_budget::bake::read::from_bytes;
use lod_budget::bake::repair::repair;
use lod_budget::bake::{Format, Mesh};
use proptest::prelude::*;

/// Triangles with attributes per corner, of which each is a column in the file.
#[derive(Clone, Debug)]
struct Soup {
    corners: Vec<Corner>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    position: Vec3,
    normal: Vec3,
    uv: Vec2,
}

/// Which attributes a format carries.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Carries {
    All,
    Positions,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Obj,
    ObjBackwards,
    PlyText,
    PlyLittle,
    PlyBig,
    Off,
    StlText,
    StlBinary,
    Glb,
}

const KINDS: [Kind; 9] = [
    Kind::Obj,
    Kind::ObjBackwards,
    Kind::PlyText,
    Kind::PlyLittle,
    Kind::PlyBig,
    Kind::Off,
    Kind::StlText,
    Kind::StlBinary,
    Kind::Glb,
];

impl Kind {
    fn format(self) -> Format {
        match self {
            Self::Obj | Self::ObjBackwards => Format::Obj,
            Self::PlyText | Self::PlyLittle | Self::PlyBig => Format::Ply,
            Self::Off => Format::Off,
            Self::StlText | Self::StlBinary => Format::Stl,
            Self::Glb => Format::Gltf,
        }
    }

    fn carries(self) -> Carries {
        if self.format() == Format::Stl { Carries::Positions } else { Carries::All }
    }

    fn write(self, soup: &Soup) -> Vec<u8> {
        match self {
            Self::Obj => obj(soup, false),
            Self::ObjBackwards => obj(soup, true),
            Self::PlyText => ply_text(soup),
            Self::PlyLittle => ply_binary(soup, "binary_little_endian", |bytes| bytes.to_vec()),
            Self::PlyBig => {
                ply_binary(soup, "binary_big_endian", |bytes| bytes.iter().rev().copied().collect())
            }
            Self::Off => off(soup),
            Self::StlText => stl_text(soup),
            Self::StlBinary => stl_binary(soup),
            Self::Glb => glb(soup),
        }
    }
}

fn words(numbers: &[f32]) -> String {
    numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}

fn row(c: &Corner) -> Vec<f32> {
    [&c.position.to_array()[..], &c.normal.to_array(), &c.uv.to_array()].concat()
}

/// Every corner with lines of its own; indices from the front or from the back.
fn obj(soup: &Soup, backwards: bool) -> Vec<u8> {
    let mut text = String::from("# written for a test\r\n");
    for (t, triangle) in soup.corners.chunks(3).enumerate() {
        for c in triangle {
            let (v, n, uv) =
                (words(&c.position.to_array()), words(&c.normal.to_array()), words(&c.uv.to_array()));
            text += &format!("v {v}\nvn\t{n}\nvt {uv}\n");
        }
        let corner = |i: i32| if backwards { i - 3 } else { t as i32 * 3 + 1 + i };
        let face =
            (0..3).map(|i| [corner(i).to_string(), corner(i).to_string(), corner(i).to_string()].join("/"));
        text += &format!("f {}\n", face.collect::<Vec<_>>().join(" \\\n "));
    }
    text.into_bytes()
}

fn ply_header(format: &str, soup: &Soup) -> String {
    let properties: String =
        ["x", "y", "z", "nx", "ny", "nz", "s", "t"].map(|p| format!("property float {p}\n")).concat();
    let (vertices, faces) = (soup.corners.len(), soup.corners.len() / 3);
    format!(
        "ply\nformat {format} 1.0\nelement vertex {vertices}\n{properties}element face {faces}\n\
         property list uchar int vertex_indices\nend_header\n"
    )
}

fn ply_text(soup: &Soup) -> Vec<u8> {
    let vertices: String = soup.corners.iter().map(|c| words(&row(c)) + "\n").collect();
    let faces = (0..soup.corners.len() / 3).map(|t| format!("3 {} {} {}\n", 3 * t, 3 * t + 1, 3 * t + 2));
    (ply_header("ascii", soup) + &vertices + &faces.collect::<String>()).into_bytes()
}

fn ply_binary(soup: &Soup, format: &str, order: fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let mut bytes = ply_header(format, soup).into_bytes();
    for number in soup.corners.iter().flat_map(row) {
        bytes.extend(order(&number.to_le_bytes()));
    }
    for t in 0..soup.corners.len() as i32 / 3 {
        bytes.push(3);
        (0..3).for_each(|i| bytes.extend(order(&(3 * t + i).to_le_bytes())));
    }
    bytes
}

fn off(soup: &Soup) -> Vec<u8> {
    let vertices: String = soup.corners.iter().map(|c| words(&row(c)) + "\n").collect();
    let faces =
        (0..soup.corners.len() / 3).map(|t| format!("3 {} {} {} 1 0 0\n", 3 * t, 3 * t + 1, 3 * t + 2));
    let counts = format!("STNOFF\n# counts\n{} {} 0\n", soup.corners.len(), soup.corners.len() / 3);
    (counts + &vertices + &faces.collect::<String>()).into_bytes()
}

fn stl_text(soup: &Soup) -> Vec<u8> {
    let facet = |t: &[Corner]| {
        let corners: String =
            t.iter().map(|c| format!("vertex {}\n", words(&c.position.to_array()))).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    format!("solid\n{}endsolid\n", soup.corners.chunks(3).map(facet).collect::<String>()).into_bytes()
}

fn stl_binary(soup: &Soup) -> Vec<u8> {
    let mut bytes = vec![b'-'; 80];
    bytes.extend((soup.corners.len() as u32 / 3).to_le_bytes());
    for triangle in soup.corners.chunks(3) {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|c| c.position.to_array()).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn glb(soup: &Soup) -> Vec<u8> {
    let count = soup.corners.len();
    let accessor = |offset: usize, kind: &str| {
        format!(
            r#"{{"bufferView":0,"byteOffset":{offset},"componentType":5126,"count":{count},"type":"{kind}"}}"#
        )
    };
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}}}}]}}],
        "nodes":[{{"mesh":0}}],"buffers":[{{"byteLength":{0}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{0},"byteStride":32}}],"accessors":[{1},{2},{3}]}}"#,
        count * 32,
        accessor(0, "VEC3"),
        accessor(12, "VEC3"),
        accessor(24, "VEC2")
    );
    let blob: Vec<u8> = soup.corners.iter().flat_map(row).flat_map(f32::to_le_bytes).collect();
    let mut json = json.into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunk = |kind: &[u8], bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), kind, bytes].concat();
    let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", &blob)].concat();
    [b"glTF".as_slice(), &2u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

/// Few values, so that corners meet and seams arise, and some that are hard to write.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => (-3i8..4).prop_map(f32::from),
        1 => prop::num::f32::NORMAL | prop::num::f32::SUBNORMAL | prop::num::f32::ZERO,
    ]
}

fn soup() -> impl Strategy<Value = Soup> {
    let corner = prop::array::uniform8(number()).prop_map(|[x, y, z, a, b, c, u, v]| Corner {
        position: Vec3::new(x, y, z),
        normal: Vec3::new(a, b, c),
        uv: Vec2::new(u, v),
    });
    let triangle = prop::collection::vec(corner, 3);
    prop::collection::vec(triangle, 1..30).prop_map(|triangles| Soup { corners: triangles.concat() })
}

/// The corners of a mesh, triangle by triangle.
fn corners(mesh: &Mesh) -> Vec<Corner> {
    let corner = |&wedge: &u32| {
        let wedge = wedge as usize;
        Corner {
            position: mesh.positions[mesh.wedges[wedge] as usize],
            normal: mesh.normals.get(wedge).copied().unwrap_or_default(),
            uv: mesh.uvs.first().map(|set| set[wedge]).unwrap_or_default(),
        }
    };
    mesh.triangles.iter().flatten().map(corner).collect()
}

/// A change of a file: overwrite, insert, remove or cut.
#[derive(Clone, Debug)]
struct Change {
    what: u8,
    at: prop::sample::Index,
    with: u8,
}

fn change() -> impl Strategy<Value = Change> {
    let hard = prop::sample::select(b"0123456789-+./\\#eEnN \t\n\r\0\xff\xfe\x7f\x80{}[]\",".to_vec());
    let with = prop_oneof![hard, any::<u8>()];
    (0u8..6, any::<prop::sample::Index>(), with).prop_map(|(what, at, with)| Change { what, at, with })
}

fn changed(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    for Change { what, at, with } in changes {
        if bytes.is_empty() {
            break;
        }
        let at = at.index(bytes.len());
        match what {
            0 | 1 => bytes[at] = *with,
            2 => bytes[at] = bytes[at].wrapping_add(1),
            3 => bytes.insert(at, *with),
            4 => drop(bytes.remove(at)),
            _ if *with < 32 => bytes.truncate(at),
            _ => bytes[at] ^= 0x80,
        }
    }
    bytes
}

/// Reads, checks, repairs and checks again.
fn survives(bytes: &[u8], format: Format) -> Result<(), TestCaseError> {
    match from_bytes(bytes, "changed", format) {
        Err(error) => prop_assert!(error.to_string().starts_with("changed: ") && !error.rule.is_empty()),
        Ok(mut file) => {
            prop_assert_eq!(file.mesh.check(), Ok(()));
            prop_assert_eq!(file.origins.numbers.len(), file.mesh.triangles.len());
            repair(&mut file.mesh, &mut file.origins);
            prop_assert_eq!(file.mesh.check(), Ok(()));
            prop_assert!(file.mesh.positions.iter().all(|p| p.is_finite()));
            prop_assert!(file.mesh.triangles.len() <= bytes.len());
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn what_is_written_is_read(soup in soup()) {
        for kind in KINDS {
            let file = from_bytes(&kind.write(&soup), "a", kind.format());
            let file = file.map_err(|e| TestCaseError::fail(format!("{kind:?}: {e}")))?;
            prop_assert_eq!(file.mesh.check(), Ok(()));
            prop_assert!(file.findings.is_empty(), "{:?}: {:?}", kind, file.findings);
            let expected = soup.corners.iter().map(|&c| match kind.carries() {
                Carries::All => c,
                Carries::Positions => Corner { normal: Vec3::ZERO, uv: Vec2::ZERO, ..c },
            });
            prop_assert_eq!(corners(&file.mesh), expected.collect::<Vec<_>>(), "{:?}", kind);
        }
    }

    /// Welding and wedges come from the corners alone, so that a mesh is the same whatever format brought it.
    #[test]
    fn all_formats_make_the_same_mesh(soup in soup()) {
        let read = |kind: Kind| from_bytes(&kind.write(&soup), "a", kind.format()).map(|file| file.mesh);
        let Ok(first) = read(Kind::PlyText) else { return Err(TestCaseError::fail("refused")) };
        for kind in KINDS.into_iter().filter(|kind| kind.carries() == Carries::All) {
            let Ok(mut mesh) = read(kind) else { return Err(TestCaseError::fail("refused")) };
            mesh.groups.clone_from(&first.groups);
            prop_assert_eq!(&mesh, &first, "{:?}", kind);
        }
    }

    #[test]
    fn no_change_of_bytes_makes_a_reader_panic(
        soup in soup(),
        changes in prop::collection::vec(change(), 1..12),
    ) {
        for kind in KINDS {
            survives(&changed(kind.write(&soup), &changes), kind.format())?;
        }
    }

    #[test]
    fn no_bytes_make_a_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        for kind in KINDS {
            survives(&bytes, kind.format())?;
        }
    }
}
