//! Camera paths as text: CSV (the project's own) and the format of the TUM RGB-D benchmark.
//!
//! **CSV**: a header, then one pose a line. Columns are found by name, in any order: `time_s`, `x`, `y`, `z`, `qx`,
//! `qy`, `qz`, `qw`; further columns are passed over.
//! ```csv
//! time_s,x,y,z,qx,qy,qz,qw
//! 0,4.5,1.7,-2,0,0,0,1
//! 0.1,4.6,1.7,-2,0,0.0087,0,0.99996
//! ```
//! Times are in seconds, positions in world units (right-handed, metres by convention). The quaternion rotates from
//! camera to world; the camera looks along −Z with +Y up. Quaternions need not be of unit length.
//!
//! **TUM** (Sturm et al., "A Benchmark for the Evaluation of RGB-D SLAM Systems", 2012): eight numbers a line,
//! separated by white space, `timestamp tx ty tz qx qy qz qw`; lines that begin with `#` are comments. There the
//! camera looks along +Z with +Y *down*, so every rotation is turned by 180° about the camera's own X axis to look
//! along −Z with +Y up. The world is left as it is: in TUM recordings Z points up.
//!
//! In both, times must grow. A pose at the time of the one before, at about the same place, is left out and counted
//! ([`CameraPath::dropped`]): time stamps are rounded, and the recordings of the benchmark have such neighbours. Two
//! poses more than 1 cm or about 5° apart at one time are refused.

use std::fmt::Write;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};
use glam::{DVec3, Quat};

use super::path::broken_numbers;
use super::{CameraPath, FileError, Pose, disk};

const COLUMNS: [&str; 8] = ["time_s", "x", "y", "z", "qx", "qy", "qz", "qw"];

/// Poses at one time must be this close, in world units …
const SAME_PLACE: f64 = 0.01;
/// … and the cosine of half the angle between them this great (5.1°).
const SAME_WAY: f32 = 0.999;

impl CameraPath {
    /// Reads a path: `.csv` is CSV and `.tum` TUM; of other files the first line that is no comment decides, by
    /// whether it has a comma.
    ///
    /// # Errors
    /// A file that cannot be read or is malformed, naming the line.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let bytes = disk::read_bytes(path)?;
        let file = path.display().to_string();
        match disk::extension(path).as_str() {
            "csv" => Self::from_csv(&bytes, &file),
            "tum" => Self::from_tum(&bytes, &file),
            _ => Self::from_text(&bytes, &file),
        }
    }

    /// Reads either format: CSV where the first line that is no comment has a comma, else TUM. `file` names it in
    /// errors.
    ///
    /// # Errors
    /// Malformed text, naming the line.
    pub fn from_text(bytes: &[u8], file: &str) -> Result<Self, FileError> {
        let text = disk::text_of(bytes, file)?;
        let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
        match first {
            Some(line) if line.contains(',') => Self::from_csv(bytes, file),
            _ => Self::from_tum(bytes, file),
        }
    }

    /// Reads CSV. `file` names it in errors.
    ///
    /// # Errors
    /// Malformed text, naming the line.
    pub fn from_csv(bytes: &[u8], file: &str) -> Result<Self, FileError> {
        let text = disk::text_of(bytes, file)?;
        let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|e| csv_error(&e, file))?;
        let columns = find_columns(header).map_err(|rule| FileError::at(file, "line 1", rule))?;
        let mut rows = Rows::new(file);
        for record in reader.records() {
            let record = record.map_err(|e| csv_error(&e, file))?;
            let line = record.position().map_or(0, csv::Position::line);
            rows.push(line, columns.map(|i| &record[i]), |pose| pose)?;
        }
        rows.into_path()
    }

    /// Reads TUM text. `file` names it in errors.
    ///
    /// # Errors
    /// Malformed text, naming the line.
    pub fn from_tum(bytes: &[u8], file: &str) -> Result<Self, FileError> {
        let mut rows = Rows::new(file);
        for (line, text) in (1..).zip(disk::text_of(bytes, file)?.lines()) {
            let fields: Vec<&str> = text.split_whitespace().collect();
            if fields.first().is_none_or(|first| first.starts_with('#')) {
                continue;
            }
            let fields = <[&str; 8]>::try_from(fields).map_err(|fields| {
                let rule = format!("a pose must be 8 numbers, not {}", fields.len());
                FileError::at(file, format!("line {line}"), rule)
            })?;
            rows.push(line, fields, from_optical)?;
        }
        rows.into_path()
    }

    /// The path as CSV: reading it back gives equal poses.
    pub fn to_csv(&self) -> String {
        let mut text = COLUMNS.join(",") + "\n";
        for Pose { time_s, position: p, rotation: q } in self.poses() {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{time_s},{},{},{},{},{},{},{}", p.x, p.y, p.z, q.x, q.y, q.z, q.w);
        }
        text
    }

    /// Writes the path as CSV, replacing the file as a whole.
    ///
    /// # Errors
    /// What the file system refuses; an older file is then as it was.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        disk::write_atomically(path, self.to_csv().as_bytes())
    }
}

fn csv_error(error: &csv::Error, file: &str) -> FileError {
    let place = error.position().map(|p| format!("line {}", p.line()));
    let rule = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("a line must have the {expected_len} fields of the header, not {len}")
        }
        _ => error.to_string(),
    };
    FileError { file: file.to_owned(), place, rule }
}

/// Where each of [`COLUMNS`] is.
fn find_columns(header: &StringRecord) -> Result<[usize; 8], String> {
    let mut found = [0; 8];
    for (place, name) in found.iter_mut().zip(COLUMNS) {
        *place = header
            .iter()
            .position(|column| column == name)
            .ok_or_else(|| format!("the header must name a column '{name}'"))?;
    }
    Ok(found)
}

/// From the camera of computer vision, which looks along +Z with +Y down, to ours: half a turn about its X axis.
/// The product with the quaternion (1, 0, 0, 0) only moves numbers, so that nothing is rounded.
fn from_optical(pose: Pose) -> Pose {
    let [x, y, z, w] = pose.rotation.to_array();
    Pose { rotation: Quat::from_xyzw(w, z, -y, -x), ..pose }
}

/// Poses as they are read, each checked against the one before.
struct Rows<'a> {
    file: &'a str,
    poses: Vec<Pose>,
    dropped: usize,
}

impl<'a> Rows<'a> {
    fn new(file: &'a str) -> Self {
        Self { file, poses: Vec::new(), dropped: 0 }
    }

    /// Fields in the order of [`COLUMNS`].
    fn push(&mut self, line: u64, fields: [&str; 8], convert: fn(Pose) -> Pose) -> Result<(), FileError> {
        let refused = |rule: String| FileError::at(self.file, format!("line {line}"), rule);
        let pose = convert(pose_of(fields).map_err(refused)?);
        if let Some(rule) = broken_numbers(&pose) {
            return Err(refused(rule.to_owned()));
        }
        match self.poses.last() {
            Some(before) if pose.time_s < before.time_s => {
                let rule = format!("time must not go back: {} after {}", pose.time_s, before.time_s);
                return Err(refused(rule));
            }
            Some(before) if pose.time_s == before.time_s && !is_near(&pose, before) => {
                return Err(refused("there must be only one pose at a time".to_owned()));
            }
            Some(before) if pose.time_s == before.time_s => self.dropped += 1,
            _ => self.poses.push(pose),
        }
        Ok(())
    }

    fn into_path(self) -> Result<CameraPath, FileError> {
        let path = CameraPath::new(disk::stem(self.file), self.poses);
        let path = path.map_err(|e| FileError::whole(self.file, e.rule))?;
        Ok(path.with_dropped(self.dropped))
    }
}

fn pose_of(fields: [&str; 8]) -> Result<Pose, String> {
    let number = |i: usize| number::<f64>(COLUMNS[i], fields[i]);
    let [qx, qy, qz, qw] = [4, 5, 6, 7].map(|i| self::number::<f32>(COLUMNS[i], fields[i]));
    Ok(Pose {
        time_s: number(0)?,
        position: DVec3::new(number(1)?, number(2)?, number(3)?),
        rotation: Quat::from_xyzw(qx?, qy?, qz?, qw?),
    })
}

fn number<T: std::str::FromStr>(name: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{name} must be a number, not '{text}'"))
}

fn is_near(a: &Pose, b: &Pose) -> bool {
    let cosine = a.rotation.dot(b.rotation).abs();
    let lengths = a.rotation.length() * b.rotation.length();
    a.position.distance(b.position) <= SAME_PLACE && cosine >= SAME_WAY * lengths
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_tum_camera_looks_along_its_plus_z_and_has_y_down() {
        let text = "# a comment\n\n 1.5\t1 2 3  0 0 0 1\n";
        let path = CameraPath::from_tum(text.as_bytes(), "a.txt").expect("one pose");
        let pose = path.poses()[0];
        assert_eq!(pose.position, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(pose.rotation * Vec3::NEG_Z, Vec3::Z);
        assert_eq!(pose.rotation * Vec3::Y, Vec3::NEG_Y);
        assert_eq!(pose.rotation * Vec3::X, Vec3::X);
    }

    #[test]
    fn turning_the_camera_frame_is_a_product_of_quaternions() {
        let q = Quat::from_xyzw(0.6453, -0.5498, 0.3363, -0.4101);
        let pose = Pose { time_s: 0.0, position: DVec3::ZERO, rotation: q };
        let product = q * Quat::from_xyzw(1.0, 0.0, 0.0, 0.0);
        assert!((from_optical(pose).rotation - product).length() < 1e-7);
    }

    #[test]
    fn columns_are_found_by_name() {
        let text = "speed,qw,qz,qy,qx,z,y,x,time_s\r\n9,1,0,0,0,3,2,1,0.25\r\n";
        let path = CameraPath::from_text(text.as_bytes(), "dir/drive.csv").expect("one pose");
        assert_eq!(path.name(), "drive");
        assert_eq!(path.poses()[0].position, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!((path.poses()[0].time_s, path.poses()[0].rotation), (0.25, Quat::IDENTITY));
    }

    #[test]
    fn a_repeated_time_is_dropped_where_the_pose_is_about_the_same() {
        let text = "1 0 0 0 0 0 0 1\n1 0.001 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n";
        let path = CameraPath::from_tum(text.as_bytes(), "a.txt").expect("two poses");
        assert_eq!((path.poses().len(), path.dropped()), (2, 1));
        let text = "1 0 0 0 0 0 0 1\n1 9 0 0 0 0 0 1\n";
        let error = CameraPath::from_tum(text.as_bytes(), "a.txt").expect_err("two places at once");
        assert_eq!(error.to_string(), "a.txt: line 2: there must be only one pose at a time");
    }
}
