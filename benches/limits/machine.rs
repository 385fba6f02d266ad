//! What the figures were measured on.

use std::fs;
use std::process::Command;

/// Name and value, as far as the system tells.
pub fn description() -> Vec<(&'static str, String)> {
    let facts = [
        ("processor", cpu_field("model name")),
        ("cores", std::thread::available_parallelism().ok().map(|n| n.to_string())),
        ("caches", caches()),
        ("memory", memory_gib("MemTotal").map(|gib| format!("{gib:.0} GiB"))),
        ("compiler", rustc()),
        ("target", Some(format!("{}, {}", std::env::consts::ARCH, std::env::consts::OS))),
        ("target features", Some(features())),
    ];
    facts.into_iter().filter_map(|(name, value)| Some((name, value?))).collect()
}

/// Memory that can be had without swapping.
pub fn free_gib() -> Option<f64> {
    memory_gib("MemAvailable")
}

fn cpu_field(name: &str) -> Option<String> {
    field(&fs::read_to_string("/proc/cpuinfo").ok()?, name)
}

fn memory_gib(name: &str) -> Option<f64> {
    let value = field(&fs::read_to_string("/proc/meminfo").ok()?, name)?;
    Some(value.trim_end_matches(" kB").parse::<f64>().ok()? / f64::from(1 << 20))
}

/// The value of the first line `name : value`.
fn field(text: &str, name: &str) -> Option<String> {
    let (_, value) = text.lines().filter_map(|l| l.split_once(':')).find(|(n, _)| n.trim() == name)?;
    Some(value.trim().to_owned())
}

/// The caches of the first core, as "L1d 32K, L1i 32K, L2 1024K, L3 32768K".
fn caches() -> Option<String> {
    let read = |index: u32, what: &str| {
        let file = format!("/sys/devices/system/cpu/cpu0/cache/index{index}/{what}");
        fs::read_to_string(file).ok().map(|text| text.trim().to_owned())
    };
    let cache = |index| {
        let kind = match read(index, "type")?.as_str() {
            "Data" => "d",
            "Instruction" => "i",
            _ => "",
        };
        Some(format!("L{}{kind} {}", read(index, "level")?, read(index, "size")?))
    };
    let caches: Vec<String> = (0..8).map_while(cache).collect();
    (!caches.is_empty()).then(|| caches.join(", "))
}

fn rustc() -> Option<String> {
    let output = Command::new("rustc").arg("--version").output().ok()?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// The vector features that this build may use without asking at run time.
fn features() -> String {
    let all = [
        ("sse2", cfg!(target_feature = "sse2")),
        ("sse4.2", cfg!(target_feature = "sse4.2")),
        ("avx", cfg!(target_feature = "avx")),
        ("avx2", cfg!(target_feature = "avx2")),
        ("fma", cfg!(target_feature = "fma")),
        ("bmi2", cfg!(target_feature = "bmi2")),
        ("avx512f", cfg!(target_feature = "avx512f")),
        ("neon", cfg!(target_feature = "neon")),
    ];
    let names: Vec<&str> = all.into_iter().filter(|(_, on)| *on).map(|(name, _)| name).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(" ") }
}
