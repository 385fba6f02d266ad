//! Sine and cosine from + − × ÷ alone: the last bit of the platform's own differs from one to the next.

/// Sine and cosine of an angle in degrees, good to 1e-12 for angles of a few turns.
pub(super) fn sin_cos_deg(degrees: f64) -> (f64, f64) {
    let quadrant = (degrees / 90.0).round();
    let x = (degrees - 90.0 * quadrant) * (std::f64::consts::PI / 180.0);
    let (sin, cos) = (x * series(x * x, 3.0), series(x * x, 2.0));
    match quadrant.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The Taylor series 1 − q/(k−1)k + q²/(k−1)k(k+1)(k+2) − …: the cosine for k = 2, the sine over x for k = 3.
fn series(q: f64, k: f64) -> f64 {
    (0..7).rev().map(|i| k + 2.0 * f64::from(i)).fold(1.0, |tail, k| 1.0 - tail * q / (k * (k - 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_agrees_with_the_platform() {
        for tenth in -7300..7300 {
            let degrees = f64::from(tenth) / 10.0;
            let (sin, cos) = sin_cos_deg(degrees);
            let (s, c) = degrees.to_radians().sin_cos();
            assert!((sin - s).abs() < 1e-12 && (cos - c).abs() < 1e-12, "{degrees}");
        }
    }
}
