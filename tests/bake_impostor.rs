//! Impostors against slow and obvious twins: where a ray meets a plane, which pixels overlap, what a camera sees.

#![cfg(feature = "bake")]

use glam::{DVec2, DVec3, Vec3};
use lod_budget::bake::chain::{Accuracy, Chain, Plan, quietly};
use lod_budget::bake::impostor::{
    AtlasOptions, Facing, Impostor, ImpostorError, Kind, NotJoined, Options, Sides,
};
use lod_budget::bake::write::{LevelOut, glb};
use lod_budget::bake::{Mesh, Surface, shapes};
use proptest::prelude::*;
use serde_json::{Value, json};

fn mesh_of(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh { name: "it".into(), ..Surface { positions, triangles }.into() }
}

fn knot() -> Mesh {
    Mesh { name: "knot".into(), ..shapes::torus_knot(20, 4).into() }
}

/// Upright and thin: 1 wide, 4 high, 0.5 deep, far off its own origin.
fn tree() -> Mesh {
    let place = |p: &Vec3| *p * Vec3::new(0.5, 2.0, 0.25) + Vec3::new(3.0, 2.0, -7.0);
    let ball = shapes::icosphere(3);
    mesh_of(ball.positions.iter().map(place).collect(), ball.triangles)
}

fn kinds() -> Vec<Kind> {
    let billboards = [Facing::Viewer, Facing::Axis]
        .into_iter()
        .flat_map(|facing| [1, 6].map(|frames| Kind::Billboard { facing, frames }));
    let crosses = [(2, false), (3, true), (8, false)];
    let octahedra = [(3, false), (5, true), (7, false)];
    billboards
        .chain(crosses.map(|(planes, horizontal)| Kind::CrossQuads { planes, horizontal }))
        .chain(octahedra.map(|(frames, hemisphere)| Kind::Octahedral { frames, hemisphere }))
        .collect()
}

fn baked(kind: Kind, mesh: &Mesh) -> Impostor {
    Options::new(kind).bake(mesh).expect("it can be baked")
}

fn points(mesh: &Mesh) -> impl Iterator<Item = DVec3> {
    mesh.positions.iter().map(|p| p.as_dvec3())
}

fn direction(impostor: &Impostor, yaw_deg: f64, elevation_deg: f64) -> DVec3 {
    let ((sin, cos), (rise, reach)) = (yaw_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
    let right = impostor.up.cross(impostor.front);
    reach * (cos * impostor.front + sin * right) + rise * impostor.up
}

/// Where the ray from the eye through a point meets the plane through the middle across the line of sight.
fn on_screen(impostor: &Impostor, eye: DVec3, point: DVec3) -> DVec3 {
    let sight = (impostor.center - eye).normalize();
    let ray = point - eye;
    eye + ray * ((impostor.center - eye).dot(sight) / ray.dot(sight))
}

/// The largest distance on the screen, as the runtime projects errors: by the nearest point of the bound.
fn off_at_most(impostor: &Impostor, mesh: &Mesh, direction: DVec3, distance: f64) -> f64 {
    let eye = impostor.center + direction * distance;
    let nearest = (distance - impostor.radius) / distance;
    let mut most = 0.0_f64;
    for sight in impostor.sights(direction) {
        for p in points(mesh) {
            let shown = impostor.placed(sight.frame, p, direction);
            let off = on_screen(impostor, eye, shown).distance(on_screen(impostor, eye, p));
            most = most.max(off * nearest);
        }
    }
    most
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// The bound of a view is no less than what is found point by point, and that of all views no less than that.
    #[test]
    fn nothing_is_farther_off_than_the_bound(
        yaw in -1.0..1.0_f64,
        elevation in 0.0..1.0_f64,
        farther in 1.0..50.0_f64,
        shape in 0..3_usize,
    ) {
        let mesh = [knot(), tree(), mesh_of(vec![Vec3::X, Vec3::Y, Vec3::new(3.0, -2.0, 5.0)], vec![[0, 1, 2]])][shape].clone();
        for kind in kinds() {
            let impostor = baked(kind, &mesh);
            let [low, high] = impostor.validity.elevation_deg;
            let view = direction(&impostor, yaw * impostor.validity.yaw_deg, low + (high - low) * elevation);
            let distance = impostor.validity.nearest * farther;
            let off = off_at_most(&impostor, &mesh, view, distance);
            let texel = 2_f64.sqrt() / impostor.atlas.texels_per_unit;
            let bound = impostor.error_at(view, distance);
            prop_assert!(off + texel <= bound * (1.0 + 1e-9), "{kind:?}: {off} + {texel} > {bound}");
            prop_assert!(bound <= impostor.error * (1.0 + 1e-9), "{kind:?}: {bound} > {}", impostor.error);
        }
    }

    /// Outside of what is valid, too, where the error may grow.
    #[test]
    fn the_bound_of_a_view_holds_from_anywhere(yaw in -180.0..180.0_f64, elevation in -89.0..89.0_f64, radii in 2.0..40.0_f64) {
        let mesh = tree();
        for kind in kinds() {
            let impostor = baked(kind, &mesh);
            let view = direction(&impostor, yaw, elevation);
            let distance = radii * impostor.radius;
            let off = off_at_most(&impostor, &mesh, view, distance);
            prop_assert!(off <= impostor.error_at(view, distance), "{kind:?}");
        }
    }

    /// A camera sees every position inside its rectangle, at the pixel that the texture coordinates name.
    #[test]
    fn cameras_map_every_position_into_its_rectangle(
        at in prop::array::uniform3(-1e4..1e4_f32),
        stretch in prop::array::uniform3(0.0..20.0_f32),
        up in prop::array::uniform3(-1.0..1.0_f64),
        mips in 0..4_u32,
    ) {
        let up = DVec3::from_array(up);
        prop_assume!(up.length() > 0.1 && Vec3::from(stretch).max_element() > 1.0);
        let place = |p: &Vec3| *p * Vec3::from(stretch) + Vec3::from(at);
        let mesh = mesh_of(knot().positions.iter().map(place).collect(), knot().triangles);
        for kind in kinds() {
            let options = Options { up, atlas: AtlasOptions { mips, ..Default::default() }, ..Options::new(kind) };
            let impostor = options.bake(&mesh).expect("it can be baked");
            prop_assert!(impostor.to_json().is_ok());
            for (i, frame) in impostor.frames.iter().enumerate() {
                let (view, projection) = impostor.camera(i);
                let size = DVec2::new(f64::from(frame.rectangle_px.width), f64::from(frame.rectangle_px.height));
                let corner = DVec2::new(f64::from(frame.rectangle_px.x), f64::from(frame.rectangle_px.y));
                let atlas = DVec2::new(f64::from(impostor.atlas.width_px), f64::from(impostor.atlas.height_px));
                for p in points(&mesh) {
                    let clip = projection * view * p.extend(1.0);
                    prop_assert!((0.0..=1.0).contains(&clip.z));
                    let pixel = DVec2::new(clip.x + 1.0, 1.0 - clip.y) * 0.5 * size;
                    prop_assert!(pixel.cmpge(DVec2::splat(0.49)).all() && pixel.cmple(size - 0.49).all());
                    prop_assert!((impostor.uv(i, p) * atlas - corner).distance(pixel) < 1e-3);
                }
            }
        }
    }

    /// Every pixel of every mip level has one owner at most, its gutter with it.
    #[test]
    fn frames_keep_apart_in_all_mip_levels(size_px in 8.0..80.0_f64, mips in 0..4_u32, any in any::<bool>()) {
        for kind in kinds() {
            let sides = if any { Sides::Any } else { Sides::PowersOfTwo };
            let atlas = AtlasOptions { mips, sides, ..Default::default() };
            let impostor = Options { size_px, atlas, ..Options::new(kind) }.bake(&tree()).expect("it can be baked");
            let (width, height) = (impostor.atlas.width_px, impostor.atlas.height_px);
            prop_assert!(width <= 2048 && height <= 2048);
            prop_assert!(any || width.is_power_of_two() && height.is_power_of_two());
            let mut owners = vec![usize::MAX; ((width >> mips) * (height >> mips)) as usize];
            for (i, frame) in impostor.frames.iter().enumerate() {
                let r = frame.rectangle_px;
                let [left, top] = [r.x, r.y].map(|at| (at >> mips) - 1);
                let [right, bottom] = [r.x + r.width, r.y + r.height].map(|end| ((end - 1) >> mips) + 1);
                for pixel in (top..=bottom).flat_map(|y| (left..=right).map(move |x| y * (width >> mips) + x)) {
                    prop_assert_eq!(owners[pixel as usize], usize::MAX, "frame {}", i);
                    owners[pixel as usize] = i;
                }
            }
        }
    }

    /// No document that differs in one place makes anything panic, and what is read fits together.
    #[test]
    fn documents_that_are_changed_are_read_or_refused(at in 0..10_000_usize, with in prop::sample::select(b"0-9.e,]}x\"".to_vec())) {
        let impostor = baked(Kind::CrossQuads { planes: 2, horizontal: false }, &tree());
        let mut text = impostor.to_json().expect("it can be written").into_bytes();
        let at = at % text.len();
        text[at] = with;
        match Impostor::from_json(&text, "tree.json") {
            Ok(read) => prop_assert!(read.to_json().is_ok()),
            Err(error) => prop_assert!(error.to_string().starts_with("tree.json: ") && !error.rule.is_empty()),
        }
    }
}

#[test]
fn what_is_drawn_covers_what_is_seen() {
    for (mesh, kind) in
        [knot(), tree()].iter().flat_map(|mesh| kinds().into_iter().map(move |kind| (mesh, kind)))
    {
        let impostor = baked(kind, mesh);
        let [low, high] = impostor.validity.elevation_deg;
        for k in 0..40 {
            let view = direction(&impostor, f64::from(k) * 77.0, low + (high - low) * f64::from(k) / 39.0);
            let eye = impostor.center + view * impostor.validity.nearest;
            let right = impostor
                .up
                .cross(view - view.dot(impostor.up) * impostor.up)
                .normalize_or(impostor.up.cross(impostor.front));
            let up = view.cross(right);
            for (sight, p) in impostor.sights(view).iter().flat_map(|s| points(mesh).map(move |p| (s, p))) {
                let at = on_screen(&impostor, eye, impostor.placed(sight.frame, p, view)) - impostor.center;
                let [width, height] = impostor.cover;
                assert!(
                    at.dot(right).abs() <= width && at.dot(up).abs() <= height,
                    "{kind:?} {at} {:?}",
                    impostor.cover
                );
            }
        }
    }
}

#[test]
fn a_flat_mesh_is_exact_from_the_front_but_for_its_texels() {
    let card = mesh_of(
        vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 2.0, 0.0), Vec3::new(0.0, 2.0, 0.0)],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    for facing in [Facing::Viewer, Facing::Axis] {
        let kind = Kind::Billboard { facing, frames: 1 };
        let options = Options { yaw_deg: 1e-9, elevation_deg: [0.0, 0.0], ..Options::new(kind) };
        let impostor = options.bake(&card).expect("it can be baked");
        let texels = 2_f64.sqrt() / impostor.atlas.texels_per_unit;
        assert!(impostor.error >= texels && impostor.error < 1.02 * texels, "{}", impostor.error);
        assert!(impostor.rms < texels);
        let finer = Options { size_px: 1000.0, ..options }.bake(&card).expect("it can be baked");
        assert!(finer.error < 0.07 * impostor.error);
    }
}

#[test]
fn more_frames_are_nearer_to_the_mesh() {
    let errors: Vec<f64> = [5, 9, 17]
        .map(|frames| {
            let options = Options::new(Kind::Octahedral { frames, hemisphere: false });
            Options {
                size_px: 512.0,
                atlas: AtlasOptions { side_px: 16_384, ..Default::default() },
                ..options
            }
            .bake(&knot())
            .expect("it can be baked")
            .error
        })
        .to_vec();
    assert!(errors.is_sorted_by(|a, b| *a > 1.4 * *b), "{errors:?}");
}

#[test]
fn an_atlas_that_is_too_small_makes_texels_larger_and_then_is_refused() {
    let kind = Kind::Octahedral { frames: 9, hemisphere: true };
    let bake = |side_px| {
        Options { atlas: AtlasOptions { side_px, ..Default::default() }, ..Options::new(kind) }.bake(&knot())
    };
    let (large, small) = (bake(2048).expect("it fits"), bake(256).expect("it fits"));
    assert!(small.atlas.texels_per_unit < large.atlas.texels_per_unit && small.error > large.error);
    assert_eq!(small.validity.size_px, 2.0 * small.radius * small.atlas.texels_per_unit);
    assert_eq!(bake(64), Err(ImpostorError::Atlas { frames: 81, side_px: 64 }));
}

#[test]
fn hard_meshes_are_baked_or_refused_with_a_reason() {
    let bake =
        |mesh: &Mesh| kinds().into_iter().map(|kind| Options::new(kind).bake(mesh)).collect::<Vec<_>>();
    let is = |results: Vec<Result<Impostor, ImpostorError>>, error: ImpostorError| {
        results.into_iter().all(|result| result == Err(error.clone()))
    };
    assert!(is(bake(&Mesh::default()), ImpostorError::NoTriangles));
    let nowhere = mesh_of(vec![Vec3::ONE; 3], vec![[0, 1, 2]]);
    assert!(is(bake(&nowhere), ImpostorError::NoExtent));
    let wild = mesh_of(vec![Vec3::X, Vec3::NAN, Vec3::Y], vec![[0, 1, 2]]);
    assert!(is(bake(&wild), ImpostorError::Mesh("position 1 must be finite".into())));
    let unused = mesh_of(vec![Vec3::X, Vec3::NAN, Vec3::Y, Vec3::Z], vec![[0, 2, 3]]);
    let broken = mesh_of(vec![Vec3::X], vec![[0, 1, 2]]);
    assert!(bake(&broken).into_iter().all(|result| matches!(result, Err(ImpostorError::Mesh(_)))));
    let needle = mesh_of(vec![Vec3::ZERO, Vec3::Y * 9.0, Vec3::new(1e-6, 4.0, 0.0)], vec![[0, 1, 2]]);
    let line = mesh_of(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0], vec![[0, 1, 2]]);
    for mesh in [unused, needle, line] {
        for result in bake(&mesh) {
            let impostor = result.expect("it can be baked");
            assert!(impostor.rms.is_finite() && impostor.rms <= impostor.error && impostor.fill > 0.0);
            assert!(impostor.mesh().check().is_ok() && impostor.to_json().is_ok());
        }
    }
}

#[test]
fn a_mesh_far_from_the_origin_is_as_good_as_at_it() {
    let moved = |by: Vec3| {
        mesh_of(knot().positions.iter().map(|&p| (p * 1024.0).round() + by).collect(), knot().triangles)
    };
    let (near, far) = (moved(Vec3::ZERO), moved(Vec3::new(4e6, -8e6, 2e6)));
    for kind in kinds() {
        let (near, far) = (baked(kind, &near), baked(kind, &far));
        assert!((near.error / far.error - 1.0).abs() < 1e-12 && near.atlas == far.atlas);
    }
}

#[test]
fn options_out_of_range_are_refused_with_the_rule() {
    let good = Options::new(Kind::CrossQuads { planes: 2, horizontal: false });
    let bad = [
        Options { kind: Kind::CrossQuads { planes: 9, horizontal: false }, ..good },
        Options { kind: Kind::Octahedral { frames: 8, hemisphere: true }, ..good },
        Options { kind: Kind::Billboard { facing: Facing::Axis, frames: 0 }, ..good },
        Options { up: DVec3::ZERO, ..good },
        Options { size_px: f64::NAN, ..good },
        Options { nearest_radii: 1.0, ..good },
        Options { elevation_deg: [0.0, 90.0], ..good },
        Options { elevation_deg: [10.0, -10.0], ..good },
        Options { yaw_deg: 0.0, ..good },
        Options { atlas: AtlasOptions { mips: 7, ..good.atlas }, ..good },
        Options { atlas: AtlasOptions { side_px: 1 << 20, ..good.atlas }, ..good },
    ];
    for options in bad {
        assert!(
            matches!(options.bake(&knot()), Err(ImpostorError::Options(rule)) if rule.contains("must")),
            "{options:?}"
        );
    }
    assert!(good.bake(&knot()).is_ok());
}

/// A finely cut knot and its levels.
fn chain() -> Chain {
    let knot = Mesh { name: "knot".into(), ..shapes::torus_knot(120, 12).into() };
    let look = None;
    Plan { look, ..Plan::default() }.bake(&knot, &mut quietly).expect("it can be baked")
}

#[test]
fn an_impostor_is_the_last_level_and_never_better_than_the_one_before() {
    let chain = chain();
    for accuracy in [Accuracy::Rms, Accuracy::Hausdorff] {
        let all = chain.table(accuracy).expect("a table");
        for kind in kinds() {
            let impostor = baked(kind, &chain.levels[0].mesh);
            let joined = impostor.join(&chain, accuracy).expect("a table");
            if let Some(reason) = joined.left_out {
                assert_eq!((joined.table, joined.kept), (all.clone(), chain.levels.len()));
                let quads = matches!(kind, Kind::CrossQuads { .. });
                assert!(reason == NotJoined::TooFar || quads && reason == NotJoined::NotCheaper, "{kind:?}");
                continue;
            }
            let (levels, last) = (joined.table.levels(), joined.kept);
            assert_eq!(levels.len(), last + 1);
            assert_eq!(joined.table.lint(), [], "{kind:?}");
            assert!(levels[last].accuracy < levels[last - 1].accuracy && levels[last].accuracy > 0.0);
            assert!(all.levels()[last..].iter().all(|level| level.accuracy <= levels[last].accuracy));
            let error = levels[last].error.map(f64::from);
            assert!(error >= Some(impostor.error) && levels[last].bytes >= impostor.atlas.bytes);
            let mesh = impostor.mesh();
            assert!(mesh.triangles.len() <= levels[last].triangles as usize && mesh.check().is_ok());
        }
    }
}

#[test]
fn an_impostor_that_is_no_cheaper_is_left_out() {
    let triangle = mesh_of(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let chain = Chain::of_levels(vec![triangle.clone()], &Default::default()).expect("a chain");
    let joined = baked(Kind::CrossQuads { planes: 2, horizontal: false }, &triangle)
        .join(&chain, Accuracy::Rms)
        .expect("a table");
    assert_eq!((joined.left_out, joined.kept), (Some(NotJoined::NotCheaper), 1));
}

#[test]
fn the_quads_have_the_pixels_of_their_frames() {
    for kind in kinds() {
        let impostor = baked(kind, &tree());
        let mesh = impostor.mesh();
        let frames: Vec<usize> = match kind {
            Kind::CrossQuads { .. } => (0..impostor.frames.len()).collect(),
            _ => vec![impostor.sights(impostor.front)[0].frame],
        };
        let corners = frames.iter().flat_map(|&f| impostor.frames[f].outline.iter().map(move |_| f));
        for (wedge, frame) in corners.enumerate() {
            let place = mesh.positions[mesh.wedges[wedge] as usize].as_dvec3();
            let uv = impostor.uv(frame, place);
            assert!(uv.distance(mesh.uvs[0][wedge].as_dvec2()) < 1e-5);
            let px = uv * DVec2::new(f64::from(impostor.atlas.width_px), f64::from(impostor.atlas.height_px));
            let r = impostor.frames[frame].rectangle_px;
            let inside = |at: f64, from: u32, length: u32| {
                at > f64::from(from) - 1e-2 && at < f64::from(from + length) + 1e-2
            };
            assert!(inside(px.x, r.x, r.width) && inside(px.y, r.y, r.height));
        }
    }
}

#[test]
fn what_is_seen_is_the_mesh_on_its_quads() {
    let mesh = tree();
    for kind in kinds() {
        let impostor = baked(kind, &mesh);
        let view = direction(&impostor, 25.0, 20.0);
        let seen = impostor.seen(&mesh, view);
        assert_eq!(seen.check(), Ok(()));
        let copies = if matches!(kind, Kind::CrossQuads { .. }) { impostor.frames.len() } else { 1 };
        assert_eq!(seen.triangles.len(), copies * mesh.triangles.len());
        let normal = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|wedge| seen.positions[seen.wedges[wedge as usize] as usize].as_dvec3());
            (b - a).cross(c - a)
        };
        assert!(seen.triangles.iter().all(|t| normal(t).dot(view) > -1e-6), "{kind:?} shows its back");
    }
}

#[test]
fn a_glb_has_the_impostor_as_a_level_with_all_that_is_known_of_it() {
    let mesh = tree();
    let impostor = baked(Kind::Octahedral { frames: 5, hemisphere: true }, &mesh);
    let quads = impostor.mesh();
    let levels = [LevelOut::new(&mesh), LevelOut { impostor: Some(&impostor), ..LevelOut::new(&quads) }];
    let glb = glb(&levels).expect("it can be written");
    let length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    let json: Value = serde_json::from_slice(&glb[20..20 + length]).expect("JSON");
    assert_eq!(json["meshes"][1]["name"], "it_LOD1");
    let said = json["meshes"][1]["extras"]["lod_impostor"].to_string();
    assert_eq!(Impostor::from_json(said.as_bytes(), "it.glb"), Ok(impostor.clone()));
    assert_eq!(json["materials"][0]["doubleSided"], true);
    assert_eq!(json["materials"][0]["name"], "it_impostor");
    let back = Impostor::from_json(impostor.to_json().expect("JSON").as_bytes(), "it.json");
    assert_eq!(back, Ok(impostor));
}

#[test]
fn a_document_that_is_malformed_is_refused_with_file_place_and_rule() {
    let impostor = baked(Kind::CrossQuads { planes: 2, horizontal: false }, &tree());
    let good: Value = serde_json::from_str(&impostor.to_json().expect("JSON")).expect("JSON");
    let refused = |pointer: &str, value: Value| {
        let mut changed = good.clone();
        *changed.pointer_mut(pointer).expect("a field") = value;
        Impostor::from_json(changed.to_string().as_bytes(), "a.json").expect_err(pointer).to_string()
    };
    let frame = |i: usize, field: &str| format!("/impostor/frames/{i}/{field}");
    let cases = [
        (
            "/format".to_owned(),
            json!("lod-budget scene"),
            "a.json: its \"format\" must be \"lod-budget impostor\"",
        ),
        ("/version".to_owned(), json!(2), "a.json: its \"version\" must be 1, not 2"),
        ("/impostor/radius".to_owned(), json!(-1.0), "a.json: radius: it must be finite and above 0"),
        (
            "/impostor/front".to_owned(),
            json!([0.0, 1.0, 0.0]),
            "a.json: front: up and front must be of length 1",
        ),
        ("/impostor/kind/cross_quads/planes".to_owned(), json!(3), "a.json: frames: there must be as many"),
        (
            "/impostor/kind/cross_quads/planes".to_owned(),
            json!(4_000_000_000_u32),
            "a.json: kind: cross-quads must",
        ),
        ("/impostor/atlas/gutter_px".to_owned(), json!(3), "a.json: atlas: mips must be at most 6"),
        ("/impostor/validity/nearest".to_owned(), json!(0.0), "a.json: validity: nearest must be finite"),
        (
            frame(1, "right"),
            json!([2.0, 0.0, 0.0]),
            "a.json: frame 1: right, up and direction must be of length 1",
        ),
        (
            frame(1, "rectangle_px/x"),
            json!(4_000_000_000_u32),
            "a.json: frame 1: its rectangle must have pixels",
        ),
        (frame(0, "rectangle_px/width"), json!(1), "a.json: frame 0: its window must have the size"),
        (frame(1, "outline/0"), json!([99.0, 0.0]), "a.json: frame 1: its outline must be in its window"),
        (frame(1, "depth"), json!([1.0, -1.0]), "a.json: frame 1: depths must be finite and rise"),
    ];
    for (pointer, value, message) in cases {
        let error = refused(&pointer, value);
        assert!(error.starts_with(message), "{error}");
    }
    let other = good.pointer("/impostor/frames/0/rectangle_px").expect("a field").clone();
    let mut alike = good.clone();
    let width = |v: &Value| v.pointer("/impostor/frames/0/rectangle_px/width").cloned();
    alike["impostor"]["frames"][1] = good["impostor"]["frames"][0].clone();
    assert_eq!(width(&alike), Some(other["width"].clone()));
    let error =
        Impostor::from_json(alike.to_string().as_bytes(), "a.json").expect_err("overlaps").to_string();
    assert_eq!(error, "a.json: frame 1: it must be clear of frame 0 and its gutter");
    let mut unknown = good.clone();
    unknown["impostor"]["atlas"]["colour"] = json!(1);
    let error =
        Impostor::from_json(unknown.to_string().as_bytes(), "a.json").expect_err("unknown").to_string();
    assert!(
        error.starts_with("a.json: line 1, column ") && error.contains("unknown field `colour`"),
        "{error}"
    );
    let cut = &impostor.to_json().expect("JSON").into_bytes()[..300];
    let error = Impostor::from_json(cut, "a.json").expect_err("cut off").to_string();
    assert!(error.starts_with("a.json: line ") && error.contains("EOF"), "{error}");
}
