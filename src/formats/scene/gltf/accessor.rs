//! Accessors: numbers in buffers, of any component type, interleaved, normalised or sparse.
//!
//! For: [`Accessors`], [`Numbers`].

use super::super::error::SceneError;
use super::super::json::{JsonPath, Source};
use super::bytes::{self, Buffer};
use gltf_json::Root;
use gltf_json::accessor::{Accessor, ComponentType, Type};
use gltf_json::validation::Checked;
use std::collections::HashMap;
use std::rc::Rc;

/// The elements of an accessor, component by component.
pub struct Numbers {
    pub count: usize,
    components: usize,
    pub values: Vec<f64>,
}

impl Numbers {
    /// The first components of an element. Domain: the element exists and has that many.
    pub fn at<const N: usize>(&self, element: usize) -> [f64; N] {
        let start = element * self.components;
        std::array::from_fn(|component| self.values[start + component])
    }
}

/// A file's accessors, each read once.
pub struct Accessors<'a> {
    source: &'a Source<'a>,
    root: &'a Root,
    buffers: &'a [Buffer],
    read: HashMap<usize, Rc<Numbers>>,
    /// Numbers that may still be read: more than a file with any use needs, so that accessors that overlap,
    /// or that have no data, cannot take more memory than the file's size accounts for.
    left: usize,
}

/// What an accessor cannot be read for.
enum Fault {
    /// Beyond its buffer view, or without one.
    Outside,
    TooMany,
    Type,
}

impl<'a> Accessors<'a> {
    pub fn new(source: &'a Source<'a>, root: &'a Root, buffers: &'a [Buffer]) -> Self {
        let left = 1024 + 8 * bytes::total(buffers);
        Self { source, root, buffers, read: HashMap::new(), left }
    }
    pub fn root(&self) -> &'a Root {
        self.root
    }

    /// The values of a vertex attribute, which has one of these numbers of components.
    pub fn vertices(
        &mut self,
        index: usize,
        components: &[usize],
        place: &JsonPath,
    ) -> Result<Rc<Numbers>, SceneError> {
        let numbers = self.numbers(index, place)?;
        if !components.contains(&numbers.components) {
            let what = format!("the values have {} components, not {}", numbers.components, components[0]);
            return Err(self.source.error(place, what, "export the model again"));
        }
        if let Some(at) = numbers.values.iter().position(|value| !value.is_finite()) {
            let what = format!("the value of element {} is not a number", at / numbers.components);
            return Err(self.source.error(place, what, "export the model again"));
        }
        Ok(numbers)
    }

    /// Indices of vertices.
    pub fn indices(&mut self, index: usize, place: &JsonPath) -> Result<Rc<Numbers>, SceneError> {
        let numbers = self.numbers(index, place)?;
        let whole = |value: &f64| *value >= 0.0 && value.fract() == 0.0;
        if numbers.components != 1 || !numbers.values.iter().all(whole) {
            let what = "these are not indices of vertices";
            return Err(self.source.error(place, what, "export the model again"));
        }
        Ok(numbers)
    }

    fn numbers(&mut self, index: usize, place: &JsonPath) -> Result<Rc<Numbers>, SceneError> {
        if let Some(known) = self.read.get(&index) {
            return Ok(Rc::clone(known));
        }
        let Some(accessor) = self.root.accessors.get(index) else {
            let what = format!("there is no accessor {index}");
            return Err(self.source.error(place, what, "export the model again"));
        };
        let numbers = self.decode(accessor).map_err(|fault| {
            let what = match fault {
                Fault::Outside => "reaches beyond its buffer",
                Fault::TooMany => "has more elements than the file has bytes for",
                Fault::Type => "has an unknown type",
            };
            let (root, mend) = (JsonPath::Root, "export the model again");
            self.source.error(&root.key("accessors").item(index), format!("the accessor {what}"), mend)
        })?;
        let numbers = Rc::new(numbers);
        self.read.insert(index, Rc::clone(&numbers));
        Ok(numbers)
    }

    fn decode(&mut self, accessor: &Accessor) -> Result<Numbers, Fault> {
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_)
        else {
            return Err(Fault::Type);
        };
        let components = match kind {
            Type::Scalar => 1,
            Type::Vec2 => 2,
            Type::Vec3 => 3,
            Type::Vec4 => 4,
            // No attribute of a mesh has one.
            Type::Mat2 | Type::Mat3 | Type::Mat4 => return Err(Fault::Type),
        };
        let count = usize::try_from(accessor.count.0).map_err(|_| Fault::TooMany)?;
        let length =
            count.checked_mul(components).filter(|&length| length <= self.left).ok_or(Fault::TooMany)?;
        self.left -= length;
        let layout = Layout { component: component.0, components, normalized: accessor.normalized };
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                self.elements(view.value(), offset, count, layout)?
            }
            None if accessor.sparse.is_some() => vec![0.0; length],
            None => return Err(Fault::Outside),
        };
        if let Some(sparse) = &accessor.sparse {
            let count = usize::try_from(sparse.count.0).map_err(|_| Fault::TooMany)?;
            let length = count.checked_mul(components + 1).filter(|&length| length <= self.left);
            self.left -= length.ok_or(Fault::TooMany)?;
            let Checked::Valid(component) = sparse.indices.component_type else { return Err(Fault::Type) };
            let of_indices = Layout { component: component.0, components: 1, normalized: false };
            let (indices, replaced) = (&sparse.indices, &sparse.values);
            let indices =
                self.elements(indices.buffer_view.value(), indices.byte_offset.0, count, of_indices)?;
            let replaced =
                self.elements(replaced.buffer_view.value(), replaced.byte_offset.0, count, layout)?;
            for (&element, new) in indices.iter().zip(replaced.chunks_exact(components)) {
                let start = element as usize * components;
                values.get_mut(start..start + components).ok_or(Fault::Outside)?.copy_from_slice(new);
            }
        }
        Ok(Numbers { count, components, values })
    }

    /// Elements of a buffer view, from a byte of it on.
    fn elements(&self, view: usize, offset: u64, count: usize, layout: Layout) -> Result<Vec<f64>, Fault> {
        let view = self.root.buffer_views.get(view).ok_or(Fault::Outside)?;
        let bytes = bytes::view(view, self.buffers).ok_or(Fault::Outside)?;
        let bytes =
            usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..)).ok_or(Fault::Outside)?;
        let size = layout.size();
        let stride = view.byte_stride.map_or(size, |stride| stride.0);
        // The last element needs no stride.
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|bytes| bytes.checked_add(size)),
        };
        if stride < size || needed.is_none_or(|needed| needed > bytes.len()) {
            return Err(Fault::Outside);
        }
        let mut values = Vec::with_capacity(count * layout.components);
        for element in 0..count {
            layout.read(&bytes[element * stride..][..size], &mut values);
        }
        Ok(values)
    }
}

/// How an element is stored.
#[derive(Clone, Copy)]
struct Layout {
    component: ComponentType,
    components: usize,
    normalized: bool,
}

impl Layout {
    /// Bytes of an element.
    fn size(self) -> usize {
        self.components * self.component.size()
    }
    /// Appends the components of an element.
    fn read(self, bytes: &[u8], values: &mut Vec<f64>) {
        for bytes in bytes.chunks_exact(self.component.size()) {
            let two = || [bytes[0], bytes[1]];
            let four = || [bytes[0], bytes[1], bytes[2], bytes[3]];
            let (value, largest) = match self.component {
                ComponentType::I8 => (f64::from(bytes[0] as i8), 127.0),
                ComponentType::U8 => (f64::from(bytes[0]), 255.0),
                ComponentType::I16 => (f64::from(i16::from_le_bytes(two())), 32_767.0),
                ComponentType::U16 => (f64::from(u16::from_le_bytes(two())), 65_535.0),
                ComponentType::U32 => (f64::from(u32::from_le_bytes(four())), 4_294_967_295.0),
                ComponentType::F32 => (f64::from(f32::from_le_bytes(four())), 1.0),
            };
            values.push(if self.normalized { (value / largest).max(-1.0) } else { value });
        }
    }
}
