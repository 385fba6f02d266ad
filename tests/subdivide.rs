//! Levels upwards, from files to tables.
#![cfg(feature = "bake")]

use glam::{Vec2, Vec3};
use lod_budget::bake::Mesh;
use lod_budget::bake::chain::{Accuracy, BakeError, Chain, Length, quietly};
use lod_budget::bake::read::obj::read_control;
use lod_budget::bake::shapes;
use lod_budget::bake::subdivide::{
    ControlFile, ControlMesh, FOREVER_SHARP, Placement, Scheme, SharpEdge, SharpVertex, SubdivideError,
    Upward, load,
};

const CUBE: &str = "\
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

fn read(text: &str) -> ControlFile {
    let file = read_control(text.as_bytes(), "a.obj").unwrap_or_else(|e| panic!("{e}"));
    file.mesh.check().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(file.origins.numbers.len(), file.mesh.ends.len());
    file
}

fn refusal(text: &str) -> String {
    read_control(text.as_bytes(), "a.obj").expect_err("refused").to_string()
}

fn cube() -> ControlMesh {
    read(CUBE).mesh
}

fn baked(mesh: &ControlMesh, upward: &Upward) -> Chain {
    let chain = upward.bake(mesh, &mut quietly).unwrap_or_else(|e| panic!("{e}"));
    chain.levels.iter().for_each(|level| assert_eq!(level.mesh.check(), Ok(())));
    chain
}

fn triangles(levels: &[Mesh]) -> Vec<usize> {
    levels.iter().map(|mesh| mesh.triangles.len()).collect()
}

#[test]
fn polygons_are_read_as_they_are() {
    let mesh = cube();
    assert_eq!((mesh.positions.len(), mesh.ends.len(), mesh.is_triangles()), (8, 6, false));
    let mixed =
        read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 2 3 4\no fin\nusemtl red\nf 2 5 3\n").mesh;
    assert_eq!(mixed.ends, [4, 7]);
    let groups: Vec<_> =
        mixed.groups.iter().map(|g| (g.name.as_str(), g.material.as_deref(), g.faces.clone())).collect();
    assert_eq!(groups, [("", None, 0..1), ("fin", Some("red"), 1..2)]);
}

#[test]
fn what_cannot_be_a_face_is_left_out_and_named() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nv nan 0 0\nf 1 2 5 3\nf 1 2 3\nf 2 3 5\nf 1 2 6\nf 1 3 4\n";
    let file = read(text);
    assert_eq!((file.mesh.ends.len(), file.mesh.positions.len()), (2, 5));
    let said: Vec<String> = file.findings.iter().map(ToString::to_string).collect();
    assert_eq!(said[0], "1 faces with two corners in one place, left out: line 7");
    assert_eq!(said[1], "1 faces that repeat another, left out: line 9");
    assert_eq!(said[2], "1 faces with a position that is not finite, left out: line 10");
}

#[test]
fn creases_are_read_as_opensubdiv_writes_them() {
    let file = read(&format!(
        "{CUBE}t crease 3/1/0 0 1 2 2.5\nt corner 1/1/0 7 1\nt crease 2/1/0 0 6 1\nt hole 1/0/0 1\n"
    ));
    let edge = |a, b| SharpEdge { ends: [a, b], sharpness: 2.5 };
    assert_eq!(file.mesh.sharp_edges, [edge(0, 1), edge(1, 2)]);
    assert_eq!(file.mesh.sharp_vertices, [SharpVertex { position: 7, sharpness: 1.0 }]);
    let said: Vec<String> = file.findings.iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        ["1 unknown statements, passed over: line 18 ('t')", "1 creases along no edge, passed over: line 17"]
    );
    assert_eq!(refusal("t crease 2/1/0 0 x 1"), "a.obj: line 1: 'x' must be a vertex, from 0 on");
    assert_eq!(refusal("t crease 2/1/0 0 1 -1"), "a.obj: line 1: a sharpness must be at least 0, not -1");
    assert_eq!(refusal("t crease 2/1/0 0 1 nan"), "a.obj: line 1: a sharpness must be at least 0, not NaN");
    for wrong in [
        "t crease",
        "t crease 2/1/0 0 1",
        "t crease 9/1/0 0 1 2",
        "t corner 2/1/0 0 1 2",
        "t crease 2/2/0 0 1 2",
    ] {
        assert!(refusal(wrong).contains("line 1: a tag must be as in"), "{wrong}");
    }
    let huge = format!("t crease {}/1/0 0 1 2", usize::MAX);
    assert!(refusal(&huge).contains("a tag must be as in"));
}

#[test]
fn levels_have_four_times_the_triangles_and_keep_their_vertices() {
    for (mesh, levels) in [
        (cube(), cube().catmull_clark(3)),
        (
            ControlMesh::from(&Mesh::from(shapes::icosphere(1))),
            ControlMesh::from(&Mesh::from(shapes::icosphere(1))).loop_subdivided(3),
        ),
    ] {
        let levels = levels.expect("a mesh");
        let coarsest = levels[3].triangles.len();
        assert_eq!(triangles(&levels), [64 * coarsest, 16 * coarsest, 4 * coarsest, coarsest]);
        for pair in levels.windows(2) {
            assert_eq!(pair[0].positions[..pair[1].positions.len()], pair[1].positions);
        }
        assert_eq!(levels[3].positions.len(), mesh.positions.len());
        assert!(levels.iter().all(|level| level.check().is_ok()));
    }
}

#[test]
fn at_its_own_places_the_control_mesh_is_itself() {
    let levels = cube().subdivided(Scheme::CatmullClark, 1, Placement::Subdivision).expect("a mesh");
    assert_eq!(levels[1].positions, cube().positions);
    let sharp = ControlMesh { sharp_edges: all_edges(FOREVER_SHARP), ..cube() };
    let kept = sharp.catmull_clark(2).expect("a mesh");
    let on_cube = |p: &Vec3| p.to_array().iter().any(|&x| x == 0.0 || x == 1.0);
    assert!(kept[0].positions.iter().all(on_cube));
    assert_eq!(baked(&sharp, &Upward::default()).levels[3].deviation.attained, 0.0);
}

fn all_edges(sharpness: f32) -> Vec<SharpEdge> {
    let mut creased = cube();
    creased.sharpen(89.0, sharpness);
    assert_eq!(creased.sharp_edges.len(), 12);
    creased.sharp_edges
}

#[test]
fn edges_are_sharp_where_faces_meet_at_an_angle() {
    assert_eq!(cube().sharpen(91.0, 1.0), 0);
    assert_eq!(cube().sharpen(0.0, 1.0), 12);
    let flat = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n").mesh;
    assert_eq!(flat.clone().sharpen(1.0, 1.0), 0);
}

/// A texture that is laid on from above stays so where it has no border: it is smoothed as the surface is.
#[test]
fn textures_do_not_swim() {
    let n = 6;
    let height = |i: u32| ((i * 7) % 5) as f32 / 5.0;
    let positions: Vec<Vec3> =
        (0..n * n).map(|i| Vec3::new((i % n) as f32, (i / n) as f32, height(i))).collect();
    let quads: Vec<[u32; 4]> =
        (0..n * (n - 1)).filter(|i| i % n != n - 1).map(|i| [i, i + 1, i + n + 1, i + n]).collect();
    let quads: Vec<&[u32]> = quads.iter().map(<[u32; 4]>::as_slice).collect();
    let mut mesh = ControlMesh::of_faces(positions, &quads);
    mesh.uvs = vec![mesh.positions.iter().map(|p| p.truncate() / 8.0).collect()];
    mesh.sharp_vertices = [0, n - 1, n * n - n, n * n - 1]
        .map(|position| SharpVertex { position, sharpness: f32::MAX })
        .to_vec();
    for level in mesh.catmull_clark(2).expect("a mesh") {
        assert_eq!(level.uvs[0].len(), level.positions.len());
        for (uv, &position) in level.uvs[0].iter().zip(&level.wedges) {
            let above = level.positions[position as usize].truncate() / 8.0;
            assert!(uv.distance(above) < 1e-6, "{uv} {above}");
        }
    }
}

/// Two charts of a cube: along the seam nothing of either moves off the straight lines it had.
#[test]
fn borders_of_charts_are_linear() {
    let uvs = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let faces = "f 4/1 3/2 2/3 1/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\nf 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4/1 1/2 5/3 8/4\n";
    let mesh = read(&format!("{}{uvs}{faces}", CUBE.split("f ").next().expect("vertices"))).mesh;
    let levels = mesh.catmull_clark(2).expect("a mesh");
    let finest = &levels[0];
    // Each side of the cube is the whole square, and in even steps.
    let joined = mesh.corners.len() - mesh.wedges.len();
    assert_eq!((finest.positions.len(), finest.wedges.len()), (98, 6 * 25 - joined));
    let step = |x: f32| (4.0 * x - (4.0 * x).round()).abs() < 1e-6;
    let on_border = |uv: &&Vec2| uv.to_array().iter().any(|&x| x == 0.0 || x == 1.0);
    let border: Vec<&Vec2> = finest.uvs[0].iter().filter(on_border).collect();
    assert_eq!(border.len(), 6 * 16 - joined);
    assert!(border.iter().all(|uv| step(uv.x) && step(uv.y)));
}

#[test]
fn groups_cover_the_faces_they_did() {
    let text = format!(
        "{}usemtl red\nf 4 1 5 8\n",
        CUBE.trim_end().strip_suffix("f 4 1 5 8").expect("the last side")
    );
    for level in read(&text).mesh.catmull_clark(2).expect("a mesh") {
        let per_side = level.triangles.len() / 6;
        let runs: Vec<_> =
            level.groups.iter().map(|g| (g.material.as_deref(), g.triangles.clone())).collect();
        assert_eq!(runs, [(None, 0..5 * per_side), (Some("red"), 5 * per_side..6 * per_side)]);
    }
}

#[test]
fn a_chain_upwards_is_a_chain() {
    let chain = baked(&cube(), &Upward { levels: 4, ..Upward::default() });
    let errors: Vec<f32> = chain.levels.iter().map(|level| level.error).collect();
    assert!(errors[0] > 0.0 && errors.is_sorted(), "{errors:?}");
    assert!(chain.levels.iter().all(|level| level.deviation.attained <= level.deviation.hausdorff));
    let table = chain.table(Accuracy::default()).expect("a table");
    assert_eq!((table.levels().len(), table.lint().len()), (5, 0));
    assert_eq!(
        baked(&cube(), &Upward { levels: 4, ..Upward::default() }).levels[2].mesh,
        chain.levels[2].mesh
    );
}

/// A bound that is no bound would be found out by levels that are much finer. How loose it may be for the finest level
/// is what comes of irregular vertices: quads made of triangles have them at every vertex.
#[test]
fn no_finer_level_is_farther_than_the_bound() {
    let torus = ControlMesh::from(&Mesh::from(shapes::torus(5, 4, 0.4)));
    let cases = [
        (cube(), Scheme::CatmullClark, 4.0),
        (torus.clone(), Scheme::Loop, 6.0),
        (torus, Scheme::CatmullClark, 20.0),
    ];
    for (mesh, scheme, loose) in cases {
        let upward = |levels| Upward { scheme: Some(scheme), levels, ..Upward::default() };
        let coarse = baked(&mesh, &upward(2));
        let fine = mesh.subdivided(scheme, 4, Placement::Limit).expect("a mesh");
        let truth = Chain::of_levels(fine, &upward(1).measure).expect("a chain").levels;
        for (level, same) in coarse.levels.iter().zip(&truth[2..]) {
            let (bound, attained) = (level.deviation.hausdorff, same.deviation.attained);
            assert!(bound >= attained, "{scheme}: {bound} < {attained}");
        }
        let ratio = coarse.levels[0].deviation.hausdorff / truth[2].deviation.attained;
        assert!(ratio < loose, "{scheme}: the finest level's bound is {ratio} times what it is");
    }
}

#[test]
fn it_ends_where_it_is_close_enough_or_large_enough() {
    let within = |error| baked(&cube(), &Upward { levels: 6, error: Some(error), ..Upward::default() });
    let (loose, tight) = (within(Length::OfDiagonal(0.05)), within(Length::OfDiagonal(0.002)));
    assert!(loose.levels.len() < tight.levels.len() && tight.levels.len() < 7);
    assert!(f64::from(tight.levels[0].error) <= 0.002 * 3f64.sqrt());
    assert!(f64::from(tight.levels[1].error) > 0.002 * 3f64.sqrt());
    let small = baked(&cube(), &Upward { levels: 6, most_triangles: 200, ..Upward::default() });
    assert_eq!(small.levels[0].triangles(), 192);
    let smallest = |most_triangles| Upward { levels: 6, most_triangles, ..Upward::default() };
    assert_eq!(baked(&cube(), &smallest(48)).levels[0].triangles(), 48);
    let refused = smallest(47).bake(&cube(), &mut quietly).expect_err("too many");
    assert_eq!(refused, SubdivideError::TooMany { triangles: 48, most: 47 });
}

#[test]
fn what_makes_no_sense_is_refused() {
    let upward =
        |levels| Upward { levels, ..Upward::default() }.bake(&cube(), &mut quietly).expect_err("refused");
    assert_eq!(upward(0).to_string(), "a mesh must be subdivided 1 to 253 times, not 0");
    assert!(matches!(upward(254), SubdivideError::Options(_)));
    let error = |error| Upward { error: Some(error), ..Upward::default() }.bake(&cube(), &mut quietly);
    assert!(error(Length::Units(0.0)).is_err() && error(Length::OfDiagonal(f64::NAN)).is_err());
    assert_eq!(
        cube().loop_subdivided(1).expect_err("quads"),
        SubdivideError::NotTriangle { face: 0, corners: 4 }
    );
    assert_eq!(cube().catmull_clark(60).expect_err("much"), SubdivideError::TooLarge { level: 11 });
    assert!(matches!(cube().catmull_clark(usize::MAX).expect_err("more"), SubdivideError::TooLarge { .. }));
    let none = Upward::default().bake(&ControlMesh::default(), &mut quietly).expect_err("nothing");
    assert_eq!(none, SubdivideError::Bake(BakeError::NoTriangles));
    let point = ControlMesh { positions: vec![Vec3::ONE; 8], ..cube() };
    assert_eq!(
        Upward::default().bake(&point, &mut quietly).expect_err("a point"),
        BakeError::NoExtent.into()
    );
    assert_eq!(ControlMesh::default().catmull_clark(2).expect("nothing").len(), 3);
}

#[test]
fn a_control_mesh_that_is_none_is_refused_by_name() {
    let rule = |change: &dyn Fn(&mut ControlMesh)| {
        let mut mesh = cube();
        change(&mut mesh);
        mesh.catmull_clark(1).expect_err("refused").to_string()
    };
    assert_eq!(rule(&|m| m.corners[2] = 99), "corner 2 must be one of 8 wedges, not 99");
    assert_eq!(rule(&|m| m.corners[1] = m.corners[0]), "face 0 must not use position 3 twice");
    assert_eq!(rule(&|m| m.ends[1] = 6), "face 1 must have at least 3 of 24 corners");
    assert_eq!(rule(&|m| m.ends[5] = 23), "the faces must use all corners; 1 are left");
    assert_eq!(rule(&|m| m.positions[3].y = f32::NAN), "position 3 of face 0 must be finite");
    assert_eq!(rule(&|m| m.groups.clear()), "the groups must cover 6 faces, not 0");
    assert_eq!(rule(&|m| m.uvs.push(Vec::new())), "an attribute must have a row for each of 8 wedges, not 0");
    let edge = |ends, sharpness| SharpEdge { ends, sharpness };
    let no_edge = rule(&|m| m.sharp_edges.push(edge([0, 6], 1.0)));
    assert_eq!(no_edge, "the sharp edge from position 0 to 6 must be an edge of a face");
    assert!(rule(&|m| m.sharp_edges.push(edge([0, 1], f32::NAN))).contains("must not be below 0"));
}

#[test]
fn bad_faces_of_what_is_no_manifold_are_held_together() {
    let fin = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 5 5 5\nv 6 5 5\nv 5 6 5\nf 1 2 3\nf 2 1 4\nf 1 2 5\nf 6 7 8\n";
    let levels = read(fin).mesh.loop_subdivided(3).expect("a mesh");
    assert_eq!(triangles(&levels), [256, 64, 16, 4]);
    let middle = Vec3::new(0.5, 0.0, 0.0);
    assert!(
        levels[0].positions.iter().any(|p| p.distance(middle) < 1e-6),
        "the edge of three faces is straight"
    );
}

#[test]
fn files_of_triangles_are_control_meshes_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        load(&path)
    };
    let off = write("a.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n")
        .expect("a mesh");
    assert_eq!(Scheme::of(&off.mesh), Scheme::Loop);
    assert_eq!(off.mesh.loop_subdivided(1).expect("a mesh")[0].triangles.len(), 16);
    assert_eq!(Scheme::of(&write("a.obj", CUBE).expect("a mesh").mesh), Scheme::CatmullClark);
    assert!(
        write("b.obj", "v 0 0 0\n")
            .expect_err("nothing")
            .to_string()
            .ends_with("it must have a face that can be used")
    );
}
