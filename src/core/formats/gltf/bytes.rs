//! The buffers of a glTF document and the numbers in them; every range is checked before it is read.

use std::borrow::Cow;
use std::path::{Component, Path};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use glam::{DVec2, DVec3};
use gltf::Document;
use gltf::accessor::sparse::IndexType;
use gltf::accessor::{Accessor, DataType, Dimensions};
use gltf::buffer::{Source, View};

use crate::core::fault::Fault;
use crate::core::formats::save::load;
use crate::core::formats::scan::{DAMAGED, TRUNCATED, shown};
use crate::core::kernel::percent;

/// The contents of the buffers, by index. The binary chunk of a `.glb` is borrowed.
#[derive(Default)]
pub(super) struct Buffers<'b>(Vec<Cow<'b, [u8]>>);

impl<'b> Buffers<'b> {
    /// Loads all buffers.
    pub fn load(
        name: &str,
        document: &Document,
        blob: Option<Cow<'b, [u8]>>,
        folder: Option<&Path>,
    ) -> Result<Buffers<'b>, Fault> {
        let mut blob = blob;
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            let fault = |what: String| Fault::new(format!("Buffer {} {what}", buffer.index())).at(name);
            let bytes = match buffer.source() {
                Source::Bin => {
                    blob.take().ok_or_else(|| fault("is the binary chunk of a .glb, but there is none".into()))?
                }
                Source::Uri(uri) => match uri.strip_prefix("data:") {
                    Some(data) => {
                        let text = data.split_once("base64,").map_or("", |(_, text)| text);
                        let lenient =
                            GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
                        let decoded = GeneralPurpose::new(&STANDARD, lenient).decode(text);
                        Cow::Owned(decoded.map_err(|error| fault(format!("is not valid base64: {error}")))?)
                    }
                    None => Cow::Owned(external(uri, folder).map_err(&fault)?),
                },
            };
            if bytes.len() < buffer.length() {
                let what = format!("has {} bytes instead of {}", bytes.len(), buffer.length());
                return Err(fault(what).remedy(TRUNCATED));
            }
            buffers.push(bytes);
        }
        Ok(Buffers(buffers))
    }

    /// Total size of all buffers in bytes.
    pub fn size(&self) -> usize {
        self.0.iter().map(|bytes| bytes.len()).sum()
    }

    /// `count` items of `size` bytes each.
    fn items<'s>(
        &'s self,
        view: &View<'_>,
        offset: usize,
        count: usize,
        size: usize,
    ) -> Option<impl Iterator<Item = &'s [u8]> + use<'s>> {
        let stride = view.stride().unwrap_or(size).max(size);
        let start = view.offset().checked_add(offset)?;
        let long = if count == 0 { 0 } else { stride.checked_mul(count - 1)?.checked_add(size)? };
        if offset.checked_add(long)? > view.length() {
            return None;
        }
        let bytes = self.0.get(view.buffer().index())?.get(start..start.checked_add(long)?)?;
        Some(bytes.chunks(stride).map(move |item| &item[..size]))
    }

    /// Appends the positions of an accessor, each three numbers in single precision, to `points`.
    pub fn positions(&self, name: &str, accessor: &Accessor, points: &mut Vec<DVec3>) -> Result<(), Fault> {
        let fault = |what: &str| Fault::new(format!("The positions of accessor {} {what}", accessor.index())).at(name);
        if accessor.data_type() != DataType::F32 || accessor.dimensions() != Dimensions::Vec3 {
            return Err(
                fault("are not in single precision with three components").remedy("Export it without quantization")
            );
        }
        let short = || fault("extend beyond the end of the buffer").remedy(DAMAGED);
        let read = |item: &[u8]| {
            let axis = |k: usize| f64::from(f32::from_le_bytes([item[k], item[k + 1], item[k + 2], item[k + 3]]));
            DVec3::new(axis(0), axis(4), axis(8))
        };
        let first = points.len();
        match accessor.view() {
            Some(view) => {
                points.extend(self.items(&view, accessor.offset(), accessor.count(), 12).ok_or_else(short)?.map(read))
            }
            // Without a view, all are zero except the sparse ones: no more of them than the buffers can address.
            None if accessor.count() <= self.size() => points.resize(first + accessor.count(), DVec3::ZERO),
            None => return Err(short()),
        }
        if let Some(sparse) = accessor.sparse() {
            let (indices, values) = (sparse.indices(), sparse.values());
            let size = indices.index_type().size();
            let indices = self.items(&indices.view(), indices.offset(), sparse.count(), size).ok_or_else(short)?;
            let values = self.items(&values.view(), values.offset(), sparse.count(), 12).ok_or_else(short)?;
            for (index, value) in indices.zip(values) {
                *points[first..].get_mut(whole(index) as usize).ok_or_else(short)? = read(value);
            }
        }
        Ok(())
    }

    /// Appends texture coordinates to `uv`: two numbers each, in single precision or as normalized integers. Ignores
    /// other types, since texture coordinates are optional.
    pub fn texture(&self, accessor: &Accessor, uv: &mut Vec<DVec2>) {
        let size = match accessor.data_type() {
            DataType::F32 => 4,
            DataType::U16 if accessor.normalized() => 2,
            DataType::U8 if accessor.normalized() => 1,
            _ => return,
        };
        if accessor.dimensions() != Dimensions::Vec2 || accessor.sparse().is_some() {
            return;
        }
        let Some(view) = accessor.view() else { return };
        let Some(items) = self.items(&view, accessor.offset(), accessor.count(), 2 * size) else { return };
        // Integers are not scaled, since charts are rescaled anyway.
        let number = |item: &[u8]| match *item {
            [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => f64::from(whole(item)),
        };
        uv.extend(items.map(|item| DVec2::new(number(&item[..size]), number(&item[size..]))));
    }

    /// Indices: unsigned integers of one, two or four bytes.
    pub fn indices<'s>(
        &'s self,
        name: &str,
        accessor: &Accessor,
    ) -> Result<impl Iterator<Item = u32> + use<'s>, Fault> {
        let fault = |what: &str| Fault::new(format!("The indices of accessor {} {what}", accessor.index())).at(name);
        let kind = match (accessor.data_type(), accessor.dimensions(), accessor.sparse()) {
            (DataType::U8, Dimensions::Scalar, None) => IndexType::U8,
            (DataType::U16, Dimensions::Scalar, None) => IndexType::U16,
            (DataType::U32, Dimensions::Scalar, None) => IndexType::U32,
            _ => return Err(fault("are not unsigned integers")),
        };
        let short = || fault("extend beyond the end of the buffer").remedy(DAMAGED);
        let view = accessor.view().ok_or_else(short)?;
        let items = self.items(&view, accessor.offset(), accessor.count(), kind.size()).ok_or_else(short)?;
        Ok(items.map(whole))
    }
}

/// An unsigned little-endian integer of one, two or four bytes.
fn whole(item: &[u8]) -> u32 {
    item.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))
}

/// Reads an external buffer from the document's folder or below it; a document must not open files elsewhere.
fn external(uri: &str, folder: Option<&Path>) -> Result<Vec<u8>, String> {
    let Some(folder) = folder else {
        return Err(format!("is the file {}, but external files cannot be read here", shown(uri.as_bytes())));
    };
    let path = percent::decoded(uri).ok_or_else(|| format!("has the invalid address {}", shown(uri.as_bytes())))?;
    let inside = Path::new(&path).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !inside || path.contains(':') || path.contains('\\') {
        return Err(format!("is {}, which is outside the document's folder", shown(uri.as_bytes())));
    }
    let file = folder.join(path);
    // A link in the folder may still lead out of it.
    let real = |path: &Path| path.canonicalize().ok();
    if let (Some(file), Some(folder)) =
        (real(&file), real(if folder.as_os_str().is_empty() { Path::new(".") } else { folder }))
        && !file.starts_with(&folder)
    {
        return Err(format!("is a link to {} outside the document's folder", shown(uri.as_bytes())));
    }
    load(&file).map_err(|fault| format!("cannot be read: {fault}").trim_end_matches('.').to_owned())
}
