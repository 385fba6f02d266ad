//! Pixels, and PNG.

use std::io;

use glam::Vec3;

/// A square of 8-bit sRGB.
pub(super) struct Image {
    side: usize,
    rgb: Vec<u8>,
}

impl Image {
    /// The mean of `per_pixel` × `per_pixel` samples, which are linear, for each pixel.
    pub(super) fn of_samples(samples: &[Vec3], side: usize, per_pixel: usize) -> Self {
        let pixels = side / per_pixel;
        let mean = |pixel: usize| {
            let (x, y) = (pixel % pixels * per_pixel, pixel / pixels * per_pixel);
            let rows = (y..y + per_pixel).map(|y| &samples[y * side + x..][..per_pixel]);
            rows.flatten().sum::<Vec3>() / (per_pixel * per_pixel) as f32
        };
        Self {
            side: pixels,
            rgb: (0..pixels * pixels).flat_map(|pixel| mean(pixel).to_array().map(encoded)).collect(),
        }
    }

    pub(super) fn png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut bytes, self.side as u32, self.side as u32);
        encoder.set_color(::png::ColorType::Rgb);
        encoder.set_compression(::png::Compression::Balanced);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// From linear light to sRGB (IEC 61966-2-1).
fn encoded(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let srgb = if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (srgb * 255.0).round() as u8
}

/// Base64 (RFC 4648) with padding.
pub(super) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |i: usize| u32::from(three.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        let letter = |i: usize| char::from(LETTERS[(bits >> (18 - 6 * i) & 63) as usize]);
        text.extend((0..4).map(|i| if i <= three.len() { letter(i) } else { '=' }));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_as_the_standard_shows_it() {
        for (plain, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(plain.as_bytes()), text);
        }
    }

    #[test]
    fn a_png_is_read_as_it_was() {
        let samples: Vec<Vec3> = (0..16).map(|i| if i % 4 < 2 { Vec3::ONE } else { Vec3::X }).collect();
        let png = Image::of_samples(&samples, 4, 2).png().expect("encoded");
        let mut reader = ::png::Decoder::new(io::Cursor::new(png)).read_info().expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        let info = reader.next_frame(&mut pixels).expect("an image");
        assert_eq!((info.width, info.height), (2, 2));
        assert_eq!(pixels, [255, 255, 255, 255, 0, 0].repeat(2));
    }
}
