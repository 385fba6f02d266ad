//! Simplifying: whatever mesh can be read and repaired, every method makes a mesh of it that is no larger, and its
//! progressive mesh leads back to it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::bake::Format;
use lod_budget::bake::progressive::{Options, Progressive};
use lod_budget::bake::read::from_bytes;
use lod_budget::bake::repair::repair;
use lod_budget::bake::simplify::{Method, Target, Task, quietly};

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut file) = from_bytes(bytes, "fuzz.obj", Format::Obj) else { return };
    repair(&mut file.mesh, &mut file.origins);
    let mesh = file.mesh;
    for method in Method::ALL {
        let task = Task::new(&mesh, Target::triangles(mesh.triangles.len() / 3));
        let Ok(less) = method.simplifier().simplify(&task, &mut quietly) else { continue };
        assert_eq!(less.mesh.check(), Ok(()));
        assert!(less.mesh.triangles.len() <= mesh.triangles.len());
        assert!(less.mesh.positions.iter().all(|p| p.is_finite()));
    }
    let unmeasured = Options { marks_per_halving: 0, ..Options::default() };
    let Ok(progressive) = Progressive::build(&mesh, &unmeasured, &mut quietly) else { return };
    assert_eq!(progressive.original().as_ref(), Ok(&Some(mesh)));
});
