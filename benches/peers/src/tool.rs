//! Programs that are measured beside this one: how they are found, run and understood.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde::de::DeserializeOwned;

/// Where scripts and what they need are: the folder of this package.
pub fn home() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs a program and reads the JSON that it prints; where that fails, says why in a line.
pub fn ask<T: DeserializeOwned>(program: &Path, arguments: &[PathBuf]) -> Result<T, String> {
    let name = program.file_name().unwrap_or(program.as_os_str()).display();
    let output = Command::new(program).args(arguments).output().map_err(|_| format!("{name} is missing"))?;
    if !output.status.success() {
        return Err(format!("{name} fails: {}", complaint(&String::from_utf8_lossy(&output.stderr))));
    }
    serde_json::from_slice(&output.stdout)
        .map_err(|error| format!("{name} answers what is no answer: {error}"))
}

/// The line of an error's text that says most: the one with the error's name, or the last.
fn complaint(text: &str) -> String {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let named = lines.clone().find(|line| line.contains("Error"));
    named.or(lines.next_back()).unwrap_or("without a word").trim().to_owned()
}
