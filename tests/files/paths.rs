//! Camera paths as CSV and TUM text.

use glam::{DVec3, Quat};
use lod_budget::files::{BreakKind, CameraPath, FileError, Pose};
use proptest::prelude::*;

use crate::mangle;

const DRIVE: &str = "time_s,x,y,z,qx,qy,qz,qw,speed_m_s\n\
                     0,1,2,3,0,0,0,1,0\n\
                     0.5,1.5,2,3,0,0.6,0,0.8,1\n\
                     1,2,2,3,0,0.6,0,0.8,1\n";

const HAND: &str = "# ground truth\n# timestamp tx ty tz qx qy qz qw\n\
                    1311868163.8697 -0.1357 -1.4217 1.4764 0.6453 -0.5498 0.3363 -0.4101\n\
                    1311868163.8731\t-0.1357  -1.4218 1.4764 0.6454 -0.5497 0.3361 -0.4102\n";

fn read(text: &str) -> Result<CameraPath, FileError> {
    CameraPath::from_text(text.as_bytes(), "drive.csv")
}

#[track_caller]
fn refused(text: &str, old: &str, new: &str, message: &str) {
    assert!(text.contains(old), "'{old}' must be there");
    let error = read(&text.replacen(old, new, 1)).expect_err("must be refused");
    assert_eq!(error.to_string(), format!("drive.csv: {message}"));
}

#[test]
fn malformed_csv_is_refused_by_line_and_rule() {
    refused(DRIVE, "qw,", "w,", "line 1: the header must name a column 'qw'");
    refused(DRIVE, "0.5,1.5", "-0.5,1.5", "line 3: time must not go back: -0.5 after 0");
    refused(DRIVE, "0.5,1.5", "0,1.5", "line 3: there must be only one pose at a time");
    refused(DRIVE, "1.5,", "NaN,", "line 3: its numbers must be finite");
    refused(DRIVE, "1.5,", "1e999,", "line 3: its numbers must be finite");
    refused(DRIVE, ",0.6,", ",1e39,", "line 3: its numbers must be finite");
    refused(DRIVE, "1.5,", "fast,", "line 3: x must be a number, not 'fast'");
    refused(DRIVE, "1.5,", ",", "line 3: x must be a number, not ''");
    refused(DRIVE, "0,0,0,1,0", "0,0,0,0,0", "line 2: its rotation must have a length");
    refused(DRIVE, "1.5,2,", "1.5,", "line 3: a line must have the 9 fields of the header, not 8");
    let header = DRIVE.lines().next().expect("a header");
    assert_eq!(read(header).expect_err("no pose").to_string(), "drive.csv: it must have at least one pose");
}

#[test]
fn malformed_tum_text_is_refused_by_line_and_rule() {
    refused(HAND, " -0.4101", "", "line 3: a pose must be 8 numbers, not 7");
    refused(HAND, " -0.4101", " -0.4101 7", "line 3: a pose must be 8 numbers, not 9");
    refused(
        HAND,
        "1311868163.8731",
        "1311868163.86",
        "line 4: time must not go back: 1311868163.86 after 1311868163.8697",
    );
    refused(HAND, "-1.4218", "inf", "line 4: its numbers must be finite");
    refused(HAND, "-1.4218", "1,5", "line 4: y must be a number, not '1,5'");
    for empty in ["", "\n\n", "# nothing\n", "\u{feff}"] {
        assert_eq!(
            read(empty).expect_err("no pose").to_string(),
            "drive.csv: it must have at least one pose"
        );
    }
}

#[test]
fn text_may_come_from_windows_but_not_as_utf16() {
    for text in [DRIVE, HAND] {
        let marked = CameraPath::from_text(&mangle::marked_crlf(text), "drive.csv");
        assert_eq!(marked, read(text));
        let error = CameraPath::from_text(&mangle::utf16(text), "drive.csv").expect_err("UTF-16");
        assert!(error.rule.contains("UTF-16"));
    }
}

#[test]
fn the_extension_goes_before_the_content() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("it can be written");
        CameraPath::read(&path)
    };
    assert_eq!(file("a.csv", DRIVE).map(|p| p.poses().len()), Ok(3));
    assert_eq!(file("a.txt", DRIVE).map(|p| p.poses().len()), Ok(3));
    assert_eq!(file("b.txt", HAND).map(|p| p.poses().len()), Ok(2));
    assert!(file("b.csv", HAND).is_err() && file("a.tum", DRIVE).is_err());
    assert!(CameraPath::read(&folder.path().join("none.csv")).is_err());
}

#[test]
fn a_cut_path_never_panics_and_is_never_longer() {
    for text in [DRIVE, HAND] {
        let whole = read(text).expect("a good path").poses().len();
        for end in 0..text.len() {
            let cut = read(&text[..end]).map_or(0, |p| p.poses().len());
            assert!(cut <= whole);
        }
    }
}

#[test]
fn a_recording_with_a_rescue_and_a_dropout_is_broken_there() {
    let mut text = String::from("qw,qz,qy,qx,z,y,x,time_s\n");
    for i in 0..100 {
        let (teleport, dropout) = (if i < 40 { 0.0 } else { 62.8 }, if i < 70 { 0.0 } else { 12.0 });
        let (x, time_s) = (f64::from(i) * 1.5 + teleport, f64::from(i) * 0.1 + dropout);
        text += &format!("1,0,0,0,0,0,{x},{time_s}\n");
    }
    let path = read(&text).expect("a good path");
    let breaks: Vec<_> = path.breaks().iter().map(|b| (b.pose, b.kind)).collect();
    assert_eq!(breaks, [(40, BreakKind::Jump), (70, BreakKind::Gap)]);
    assert_eq!(path.sample(3.95).position, path.poses()[39].position);
    assert_eq!(path.sample(10.0).position, path.poses()[69].position);
}

fn poses() -> impl Strategy<Value = Vec<Pose>> {
    let pose = (1e-9f64..1e3, prop::array::uniform3(-1e9f64..1e9), prop::array::uniform4(-1.0f32..1.0));
    prop::collection::vec(pose, 1..20).prop_map(|poses| {
        let mut time_s = 0.0;
        let pose = |(dt, [x, y, z], [a, b, c, d]): (f64, [f64; 3], [f32; 4])| {
            time_s += dt;
            Pose { time_s, position: DVec3::new(x, y, z), rotation: Quat::from_xyzw(a, b, c, d + 2.0) }
        };
        poses.into_iter().map(pose).collect()
    })
}

proptest! {
    #[test]
    fn a_path_reads_back_as_it_was_written(poses in poses()) {
        let path = CameraPath::new("again", poses).expect("a good path");
        let text = path.to_csv();
        prop_assert_eq!(CameraPath::from_text(text.as_bytes(), "again.csv"), Ok(path));
    }

    #[test]
    fn a_spoiled_path_is_refused_or_still_a_path(edits in mangle::edits(), tum in any::<bool>()) {
        let text = if tum { HAND } else { DRIVE };
        if let Ok(path) = CameraPath::from_text(&mangle::spoiled(text.as_bytes(), &edits), "spoiled.txt") {
            prop_assert!(path.poses().windows(2).all(|w| w[0].time_s < w[1].time_s));
            prop_assert!(path.poses().iter().all(|p| p.rotation.is_normalized() && p.position.is_finite()));
        }
    }

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        for read in [CameraPath::from_text, CameraPath::from_csv, CameraPath::from_tum] {
            prop_assert!(read(&bytes, "noise.txt").is_err());
        }
    }
}
