//! A bake on the terminal: a row per level, or per mesh where there are many, and what else there is to say.

use super::summary::{LevelRow, MeshRow, SceneRow, Status, Summary};
use crate::text::{self, count, counted, fixed, percent, plain, significant};

/// With more meshes than this there is a row for each, and not for each of its levels.
const FEW: usize = 8;

/// Odd things named for each mesh.
const FINDINGS: usize = 4;

/// The whole of it.
pub fn of(summary: &Summary) -> String {
    let meshes = &summary.meshes;
    if meshes.is_empty() {
        return String::new();
    }
    let table = if meshes.len() > FEW { mesh_table(meshes) } else { level_table(meshes) };
    let scenes = summary.scenes.iter().flat_map(scene_notes);
    notes(meshes).into_iter().chain(scenes).fold(table + "\n", |text, note| text + &note + "\n")
}

const HEADINGS: [&str; 11] = [
    "mesh",
    "level",
    "triangles",
    "vertices",
    "size\nkB",
    "Hausdorff\nunits",
    "error\n% diagonal",
    "RMS\n% diagonal",
    "normals\n° RMS",
    "silhouette\n% area",
    "accuracy",
];

fn level_table(meshes: &[MeshRow]) -> String {
    let rows: Vec<Vec<String>> =
        meshes.iter().flat_map(|mesh| mesh.levels.iter().map(|level| level_row(mesh, level))).collect();
    text::table(&HEADINGS.map(str::to_owned), &rows)
}

fn level_row(mesh: &MeshRow, level: &LevelRow) -> Vec<String> {
    let share = |distance: f64| significant(100.0 * distance / mesh.diagonal, 3);
    let seen = level.appearance.as_ref();
    let normals = seen.and_then(|seen| seen.normals_deg.as_ref()).map(|normals| fixed(normals.rms, 2));
    let area = seen.and_then(|seen| seen.area_change).map(|change| percent(change, 2));
    vec![
        if level.level == 0 { plain(&mesh.name) } else { String::new() },
        level.level.to_string(),
        count(level.triangles as u64),
        count(level.vertices as u64),
        significant(level.bytes as f64 / 1e3, 3),
        significant(level.hausdorff, 4),
        share(level.error),
        share(level.rms),
        normals.unwrap_or_default(),
        area.unwrap_or_default(),
        format!("{:.4}", level.accuracy),
    ]
}

fn mesh_table(meshes: &[MeshRow]) -> String {
    let headings =
        ["mesh", "levels", "finest\ntriangles", "coarsest\ntriangles", "error\n% diagonal", "seconds", ""];
    let rows: Vec<Vec<String>> = meshes.iter().map(mesh_row).collect();
    text::table(&headings.map(str::to_owned), &rows)
}

fn mesh_row(mesh: &MeshRow) -> Vec<String> {
    // A chain has level 0 at least.
    let triangles = |level: Option<&LevelRow>| level.map_or(0, |level| level.triangles as u64);
    let error = mesh.levels.last().map_or(0.0, |level| level.error);
    vec![
        plain(&mesh.name),
        mesh.levels.len().to_string(),
        count(triangles(mesh.levels.first())),
        count(triangles(mesh.levels.last())),
        significant(100.0 * error / mesh.diagonal, 3),
        format!("{:.2}", mesh.seconds + mesh.measure_seconds),
        if mesh.status == Status::Kept { "kept".to_owned() } else { String::new() },
    ]
}

/// What to make of it.
fn notes(meshes: &[MeshRow]) -> Vec<String> {
    let mut notes =
        if meshes.len() > FEW { vec![odd_note(meshes)] } else { meshes.iter().flat_map(odd_notes).collect() };
    notes.retain(|note| !note.is_empty());
    let kept = meshes.iter().filter(|mesh| mesh.status == Status::Kept).count();
    let seconds = |time: fn(&MeshRow) -> f64| {
        let baked = meshes.iter().filter(|mesh| mesh.status == Status::Baked);
        significant(baked.map(time).fold(0.0, |sum, time| sum + time), 3)
    };
    let (make, measure) = (seconds(|mesh| mesh.seconds), seconds(|mesh| mesh.measure_seconds));
    let baked = counted(meshes.len() - kept, "mesh").replace("meshs", "meshes");
    let kept = if kept > 0 { format!("; {kept} kept as baked before") } else { String::new() };
    notes.push(format!("{baked} baked: {make} s to make, {measure} s to measure{kept}."));
    notes.extend(meshes.iter().filter_map(|mesh| mesh.scene_file.clone().or(mesh.table_file.clone())));
    notes.dedup();
    notes
}

/// What was done to a scene, and what was not.
fn scene_notes(scene: &SceneRow) -> Vec<String> {
    let SceneRow { input, chains, chunks, measured, left, findings, .. } = scene;
    let name = plain(input);
    let mut notes: Vec<String> =
        findings.iter().take(FINDINGS).map(|finding| format!("{name}: {}", plain(finding))).collect();
    if findings.len() > FINDINGS {
        notes.push(format!("{name}: {} more", counted(findings.len() - FINDINGS, "finding")));
    }
    notes.push(format!(
        "{name}: {} have levels, {} among them.",
        counted(*chains, "part"),
        counted(*chunks, "chunk")
    ));
    if *measured > 0 {
        notes.push(format!("{name}: {} of the author's measured.", counted(*measured, "chain")));
    }
    notes.extend(
        left.iter()
            .take(FINDINGS)
            .map(|l| format!("{name}: {} is left alone: {}", plain(&l.place), l.reason)),
    );
    if left.len() > FINDINGS {
        notes.push(format!("{name}: {} more left alone", left.len() - FINDINGS));
    }
    notes
}

/// How many of many meshes are odd; nothing where none is.
fn odd_note(meshes: &[MeshRow]) -> String {
    match meshes.iter().filter(|mesh| !mesh.findings.is_empty()).count() {
        0 => String::new(),
        odd => format!("Something is odd about {odd} of {} meshes: --json says what.", meshes.len()),
    }
}

fn odd_notes(mesh: &MeshRow) -> Vec<String> {
    let name = plain(&mesh.name);
    let mut notes: Vec<String> =
        mesh.findings.iter().take(FINDINGS).map(|finding| format!("{name}: {}", plain(finding))).collect();
    if mesh.findings.len() > FINDINGS {
        notes.push(format!("{name}: {} more", counted(mesh.findings.len() - FINDINGS, "finding")));
    }
    notes.extend(mesh.impostor.as_ref().map(|impostor| format!("{name}: {}", impostor.note())));
    notes.extend(mesh.left_out.first().map(|first| {
        format!("{name}: {} left out, the first {}", counted(mesh.left_out.len(), "level"), first.reason)
    }));
    notes
}
