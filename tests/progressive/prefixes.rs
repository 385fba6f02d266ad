//! What prefixes are.

use lod_budget::bake::Mesh;
use lod_budget::bake::deviation::{Options as Measure, Ruler};
use lod_budget::bake::progressive::{Cursor, Progressive};
use lod_budget::bake::shapes::{icosphere, torus_knot};
use lod_budget::bake::simplify::{GarlandHeckbert, Simplifier, Target, Task, quietly};
use proptest::prelude::*;

use super::meshes::{any_mesh, any_method, bits, bumped, dressed, progressive, random, sheet, unnumbered};

/// The maximum alone, and no closer than the test needs.
fn quickly() -> Measure {
    Measure { max_samples: 200, relative: 0.1, ..Measure::default() }
}

/// Every prefix in turn, from the base mesh on.
fn prefixes(mesh: &Progressive) -> Vec<(Mesh, f32)> {
    let mut cursor = Cursor::new(mesh);
    let mut prefixes = vec![(cursor.mesh(mesh), cursor.error())];
    while cursor.refine(mesh).expect("a good file") {
        prefixes.push((cursor.mesh(mesh), cursor.error()));
    }
    prefixes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_original_comes_back_bit_for_bit(mesh in any_mesh(), method in any_method()) {
        let progressive = progressive(&mesh, method, 0);
        let back = progressive.original().expect("a good file").expect("it is whole");
        prop_assert_eq!(bits(&back), bits(&mesh));
    }

    /// Against the simplifier itself, which knows nothing of splits.
    #[test]
    fn a_prefix_is_what_simplification_leaves(mesh in any_mesh(), method in any_method(), shares in prop::array::uniform4(0.0..1.0f64)) {
        let progressive = progressive(&mesh, method, 0);
        let whole = progressive.full().triangles;
        for share in shares.into_iter().chain([0.0, 1.0]) {
            let target = Target::triangles(((whole as f64 * share) as usize).max(progressive.base().triangles));
            let simplified = method.simplify(&Task::new(&mesh, target), &mut quietly).expect("a good mesh");
            let extracted = progressive.extract(target).expect("a good file");
            prop_assert_eq!(extracted.mesh.check(), Ok(()));
            prop_assert_eq!(unnumbered(&extracted.mesh), unnumbered(&simplified.mesh));
        }
    }

    /// Against the deviation, measured anew for prefixes all along.
    #[test]
    fn no_prefix_is_farther_off_than_its_error(mesh in any_mesh(), method in any_method(), marks in 0..3u32) {
        let progressive = progressive(&mesh, method, marks);
        let ruler = Ruler::new(&mesh.surface()).expect("a good mesh");
        let mut finer = f32::INFINITY;
        for (k, (prefix, error)) in prefixes(&progressive).into_iter().enumerate() {
            if k > 24 && k % 7 > 0 {
                continue;
            }
            let deviation = ruler.deviation(&prefix.surface(), &quickly()).expect("a good mesh");
            prop_assert!(deviation.attained <= f64::from(error), "{} > {error}", deviation.attained);
            prop_assert!(error <= finer);
            finer = error;
        }
    }

    #[test]
    fn coarsening_undoes_refining(mesh in any_mesh(), method in any_method(), seed in any::<u32>()) {
        let progressive = progressive(&mesh, method, 0);
        let prefixes = prefixes(&progressive);
        let mut cursor = Cursor::new(&progressive);
        for step in 0..24 {
            let target = (random(seed, step) * prefixes.len() as f32) as usize;
            while cursor.splits() < target && cursor.refine(&progressive).expect("a good file") {}
            while cursor.splits() > target && cursor.coarsen() {}
            let (mesh, error) = &prefixes[cursor.splits()];
            prop_assert_eq!(bits(&cursor.mesh(&progressive)), bits(mesh));
            prop_assert_eq!(cursor.error(), *error);
        }
    }

    /// Targets mean the same to whoever is asked, wherever the cursor was before.
    #[test]
    fn a_cursor_goes_where_extraction_does(mesh in any_mesh(), seed in any::<u32>()) {
        let progressive = progressive(&mesh, GarlandHeckbert::default(), 1);
        let (whole, worst) = (progressive.full().triangles, Cursor::new(&progressive).error());
        let mut cursor = Cursor::new(&progressive);
        for step in 0..16 {
            let triangles = (random(seed, 2 * step) * whole as f32 * 1.1) as usize;
            let error = random(seed, 2 * step + 1) * worst;
            let target = match step % 3 {
                0 => Target::triangles(triangles),
                1 => Target::error(error),
                _ => Target { triangles, error },
            };
            cursor.go_to(&progressive, target).expect("a good file");
            let extracted = progressive.extract(target).expect("a good file");
            prop_assert_eq!(cursor.splits(), extracted.splits);
            prop_assert_eq!(bits(&cursor.mesh(&progressive)), bits(&extracted.mesh));
        }
    }
}

/// The slow twin: of all prefixes the one that the words say.
#[test]
fn a_target_is_the_finest_of_so_few_triangles_or_the_coarsest_so_near() {
    let mesh = dressed(bumped(icosphere(5), 0.05, 3), 1);
    let progressive = progressive(&mesh, GarlandHeckbert::default(), 2);
    let all = prefixes(&progressive);
    for k in (0..all.len()).step_by(3) {
        let (prefix, error) = &all[k];
        let few = progressive.extract(Target::triangles(prefix.triangles.len())).expect("a good file");
        let finest = all.iter().rposition(|(m, _)| m.triangles.len() <= prefix.triangles.len());
        assert_eq!(Some(few.splits), finest);
        let near = progressive.extract(Target::error(*error)).expect("a good file");
        assert_eq!(Some(near.splits), all.iter().position(|(_, e)| e <= error));
        assert!(near.error <= *error);
    }
}

/// Flat parts and straight borders cost nothing, and errors say so: bounds are not lengths of edges.
#[test]
fn what_stays_flat_has_next_to_no_error() {
    let flat = sheet(24, 24, false).into();
    for marks in [0, 2] {
        let progressive = progressive(&flat, GarlandHeckbert::default(), marks);
        let coarse = progressive.extract(Target::triangles(200)).expect("a good file");
        assert!(coarse.error < 1e-3, "{}", coarse.error);
    }
}

/// Marks are as tight as measuring is; what is between them is off by a small factor.
#[test]
fn errors_are_near_what_is_measured() {
    let knot: Mesh = torus_knot(120, 12).into();
    let progressive = progressive(&knot, GarlandHeckbert::default(), 4);
    let ruler = Ruler::new(&knot.surface()).expect("a good mesh");
    let worst = [2000, 1400, 1000, 600, 300].map(|triangles| {
        let coarse = progressive.extract(Target::triangles(triangles)).expect("a good file");
        let measured = ruler.deviation(&coarse.mesh.surface(), &quickly()).expect("a good mesh");
        f64::from(coarse.error) / measured.hausdorff
    });
    assert!(worst.iter().all(|&ratio| (1.0..8.0).contains(&ratio)), "{worst:?}");
}

#[test]
fn a_table_has_the_levels_that_extraction_makes() {
    let knot: Mesh = torus_knot(60, 8).into();
    let progressive = progressive(&knot, GarlandHeckbert::default(), 1);
    let accuracy = lod_budget::bake::chain::Accuracy::default();
    let table = progressive.table(40, accuracy, &quickly()).expect("a good mesh");
    assert!(table.levels().len() > 30 && table.lint().is_empty(), "{:?}", table.lint());
    for level in table.levels() {
        let extracted =
            progressive.extract(Target::triangles(level.triangles as usize)).expect("a good file");
        assert_eq!(extracted.mesh.triangles.len(), level.triangles as usize);
        assert_eq!(extracted.mesh.wedges.len(), level.vertices as usize);
        let ruler = Ruler::new(&knot.surface()).expect("a good mesh");
        let deviation = ruler.deviation(&extracted.mesh.surface(), &quickly()).expect("a good mesh");
        assert!(level.error.is_some_and(|e| deviation.attained <= f64::from(e)));
    }
    let one = progressive.table(1, accuracy, &quickly()).expect("a good mesh");
    assert_eq!(one.levels().len(), 1);
}
