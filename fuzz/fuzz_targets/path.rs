//! Camera paths, CSV and TUM text: what is read is in order of time, can be sampled anywhere, and can be written and
//! read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::files::CameraPath;

fuzz_target!(|bytes: &[u8]| {
    for read in [CameraPath::from_text, CameraPath::from_csv, CameraPath::from_tum] {
        let Ok(path) = read(bytes, "fuzz.txt") else { continue };
        assert!(path.poses().windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
        for time_s in [f64::NEG_INFINITY, path.start_s(), path.start_s() * 0.5 + path.end_s() * 0.5, f64::NAN]
        {
            assert!(path.sample(time_s).rotation.is_normalized());
        }
        let again = CameraPath::from_csv(path.to_csv().as_bytes(), "again.csv")
            .expect("what was read can be written");
        assert_eq!(again.poses(), path.poses());
    }
});
