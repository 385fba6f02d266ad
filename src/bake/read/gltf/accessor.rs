//! Rows of numbers out of buffers.

use ::gltf::json;
use ::gltf::json::accessor::{ComponentType, Type};
use ::gltf::json::validation::Checked;

use super::document::Document;

/// An accessor, checked against its buffers: every row that it counts is there.
pub(super) struct Rows<'a> {
    pub(super) count: usize,
    /// `None` for rows of zeros.
    base: Option<Packed<'a>>,
    sparse: Option<Sparse<'a>>,
    unit: f64,
}

/// Rows that replace others. Their indices rise.
struct Sparse<'a> {
    count: usize,
    indices: Packed<'a>,
    values: Packed<'a>,
}

/// Rows of components in bytes.
#[derive(Clone, Copy)]
struct Packed<'a> {
    bytes: &'a [u8],
    stride: usize,
    kind: ComponentType,
    parts: usize,
}

impl<'a> Rows<'a> {
    /// The accessor, whose rows must have one of these numbers of parts.
    pub(super) fn of(document: &'a Document<'_>, index: usize, parts: &[usize]) -> Result<Self, String> {
        let within = |rule: String| format!("accessor {index}: {rule}");
        let accessor = document.accessors.get(index).ok_or_else(|| format!("accessor {index} is unknown"))?;
        Self::open(document, accessor, parts).map_err(within)
    }

    fn open(document: &'a Document<'_>, accessor: &json::Accessor, parts: &[usize]) -> Result<Self, String> {
        let (Checked::Valid(shape), Checked::Valid(kind)) = (accessor.type_, accessor.component_type) else {
            return Err("its type and component type must be known".to_owned());
        };
        let (shape, kind) = (parts_of(shape), kind.0);
        if !parts.contains(&shape) {
            return Err(format!("it must have {parts:?} components, not {shape}"));
        }
        let limit = document.bytes.min(u64::from(u32::MAX) - 1);
        let count = accessor.count.0;
        let count = usize::try_from(count).ok().filter(|_| count <= limit);
        let count =
            count.ok_or_else(|| format!("it must not have more rows than the file has bytes: {limit}"))?;
        let base = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                Some(Packed::open(document, view.value(), offset, (kind, shape), count)?)
            }
            None if accessor.sparse.is_some() => None,
            None => return Err("it must have a buffer view".to_owned()),
        };
        let sparse = accessor.sparse.as_ref();
        let sparse = sparse.map(|s| Sparse::open(document, s, (kind, shape))).transpose()?;
        let unit = if accessor.normalized { unit_of(kind) } else { 1.0 };
        Ok(Self { count, base, sparse, unit })
    }

    /// The row, 0 where it has fewer than four parts.
    ///
    /// # Panics
    /// Where `row` is not below [`Rows::count`].
    pub(super) fn row(&self, row: usize) -> [f64; 4] {
        let replaced = self.sparse.as_ref().and_then(|sparse| sparse.find(row));
        let raw = replaced.unwrap_or_else(|| self.base.map_or([0.0; 4], |base| base.row(row)));
        if self.unit == 1.0 { raw } else { raw.map(|part| (part * self.unit).max(-1.0)) }
    }

    /// As [`Rows::row`], in single precision.
    pub(super) fn floats(&self, row: usize) -> [f32; 4] {
        self.row(row).map(|part| part as f32)
    }
}

impl<'a> Sparse<'a> {
    fn open(
        document: &'a Document<'_>,
        sparse: &json::accessor::sparse::Sparse,
        (kind, parts): (ComponentType, usize),
    ) -> Result<Self, String> {
        let Checked::Valid(index_kind) = sparse.indices.component_type else {
            return Err("the type of its sparse indices must be known".to_owned());
        };
        let count = usize::try_from(sparse.count.0).map_err(|_| "it has too many sparse rows".to_owned())?;
        let (indices, values) = (&sparse.indices, &sparse.values);
        let index_shape = (index_kind.0, 1);
        let indices =
            Packed::open(document, indices.buffer_view.value(), indices.byte_offset.0, index_shape, count)?;
        let values =
            Packed::open(document, values.buffer_view.value(), values.byte_offset.0, (kind, parts), count)?;
        Ok(Self { count, indices, values })
    }

    fn find(&self, row: usize) -> Option<[f64; 4]> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            match self.indices.row(middle)[0] as usize {
                index if index < row => low = middle + 1,
                index if index > row => high = middle,
                _ => return Some(self.values.row(middle)),
            }
        }
        None
    }
}

impl<'a> Packed<'a> {
    /// Checks that all rows are within the view.
    fn open(
        document: &'a Document<'_>,
        view: usize,
        offset: u64,
        (kind, parts): (ComponentType, usize),
        count: usize,
    ) -> Result<Self, String> {
        let (bytes, stride) = document.view(view)?;
        let size = kind.size() * parts;
        let stride = stride.unwrap_or(size);
        let bytes = usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..)).unwrap_or_default();
        let end = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        if stride < size || end.is_none_or(|end| end > bytes.len()) {
            return Err(format!("its {count} rows of {size} bytes must fit buffer view {view}"));
        }
        Ok(Self { bytes, stride, kind, parts })
    }

    fn row(&self, row: usize) -> [f64; 4] {
        let size = self.kind.size();
        let start = row * self.stride;
        let mut parts = [0.0; 4];
        for (i, part) in parts.iter_mut().enumerate().take(self.parts) {
            *part = number(self.kind, &self.bytes[start + i * size..][..size]);
        }
        parts
    }
}

fn number(kind: ComponentType, bytes: &[u8]) -> f64 {
    let mut four = [0; 4];
    four[..bytes.len()].copy_from_slice(bytes);
    let [a, b, ..] = four;
    match kind {
        ComponentType::I8 => f64::from(a as i8),
        ComponentType::U8 => f64::from(a),
        ComponentType::I16 => f64::from(i16::from_le_bytes([a, b])),
        ComponentType::U16 => f64::from(u16::from_le_bytes([a, b])),
        ComponentType::U32 => f64::from(u32::from_le_bytes(four)),
        ComponentType::F32 => f64::from(f32::from_le_bytes(four)),
    }
}

/// At most four: matrices are not rows that a mesh has.
fn parts_of(shape: Type) -> usize {
    match shape {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 => 4,
        Type::Mat2 | Type::Mat3 | Type::Mat4 => 0,
    }
}

/// What a step of a normalised integer is worth.
fn unit_of(kind: ComponentType) -> f64 {
    match kind {
        ComponentType::I8 => 1.0 / 127.0,
        ComponentType::U8 => 1.0 / 255.0,
        ComponentType::I16 => 1.0 / 32767.0,
        ComponentType::U16 => 1.0 / 65535.0,
        ComponentType::U32 | ComponentType::F32 => 1.0,
    }
}
