//! Accessors: numbers in buffers, of any component type, interleaved, normalised or sparse.
//!
//! For: [`Accessors`], [`Numbers`].

use super::super::error::SceneError;
use super::super::json::JsonPath;
use super::super::scalar::{Kind, Scalar};
use super::bytes::{self, Document, broken};
use gltf_json::accessor::sparse::Sparse;
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
    pub document: &'a Document<'a>,
    read: HashMap<usize, Rc<Numbers>>,
    /// Numbers that may still be read: more than a file with any use needs, so that accessors that overlap,
    /// or that have no data, cannot take more memory than the file's size accounts for.
    left: usize,
}

/// What is wrong with an accessor.
type Fault = &'static str;
const OUTSIDE: Fault = "the accessor reaches beyond its buffer";
const TOO_MANY: Fault = "the accessor has more elements than the file has bytes for";
const UNKNOWN_TYPE: Fault = "the accessor has an unknown type";

impl<'a> Accessors<'a> {
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { document, read: HashMap::new(), left: 1024 + 8 * bytes::total(document.buffers) }
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
            return Err(broken(place, what));
        }
        if let Some(at) = numbers.values.iter().position(|value| !value.is_finite()) {
            let element = at / numbers.components;
            return Err(broken(place, format!("the value of element {element} is not a number")));
        }
        Ok(numbers)
    }

    /// Indices of vertices.
    pub fn indices(&mut self, index: usize, place: &JsonPath) -> Result<Rc<Numbers>, SceneError> {
        let numbers = self.numbers(index, place)?;
        let whole = |value: &f64| *value >= 0.0 && value.fract() == 0.0;
        if numbers.components != 1 || !numbers.values.iter().all(whole) {
            return Err(broken(place, "these are not indices of vertices"));
        }
        Ok(numbers)
    }

    fn numbers(&mut self, index: usize, place: &JsonPath) -> Result<Rc<Numbers>, SceneError> {
        if let Some(known) = self.read.get(&index) {
            return Ok(Rc::clone(known));
        }
        let Some(accessor) = self.document.root.accessors.get(index) else {
            return Err(broken(place, format!("there is no accessor {index}")));
        };
        let numbers = self
            .decode(accessor)
            .map_err(|fault| broken(&self.document.source.root().key("accessors").item(index), fault))?;
        let numbers = Rc::new(numbers);
        self.read.insert(index, Rc::clone(&numbers));
        Ok(numbers)
    }

    /// Takes from the numbers that may still be read.
    fn take(&mut self, count: usize, components: usize) -> Result<usize, Fault> {
        let length = count.checked_mul(components).filter(|&length| length <= self.left).ok_or(TOO_MANY)?;
        self.left -= length;
        Ok(length)
    }

    fn decode(&mut self, accessor: &Accessor) -> Result<Numbers, Fault> {
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_)
        else {
            return Err(UNKNOWN_TYPE);
        };
        let components = match kind {
            Type::Scalar => 1,
            Type::Vec2 => 2,
            Type::Vec3 => 3,
            Type::Vec4 => 4,
            // No attribute of a mesh has one.
            Type::Mat2 | Type::Mat3 | Type::Mat4 => return Err(UNKNOWN_TYPE),
        };
        let count = usize::try_from(accessor.count.0).map_err(|_| TOO_MANY)?;
        let length = self.take(count, components)?;
        let layout = Layout::new(component.0, components, accessor.normalized);
        let mut values = match accessor.buffer_view {
            Some(view) => {
                self.elements(view.value(), accessor.byte_offset.unwrap_or_default().0, count, layout)?
            }
            None if accessor.sparse.is_some() => vec![0.0; length],
            None => return Err(OUTSIDE),
        };
        if let Some(Sparse { count, indices, values: replaced, .. }) = &accessor.sparse {
            let count = usize::try_from(count.0).map_err(|_| TOO_MANY)?;
            self.take(count, components + 1)?;
            let Checked::Valid(component) = indices.component_type else { return Err(UNKNOWN_TYPE) };
            let of_indices = Layout::new(component.0, 1, false);
            let indices =
                self.elements(indices.buffer_view.value(), indices.byte_offset.0, count, of_indices)?;
            let replaced =
                self.elements(replaced.buffer_view.value(), replaced.byte_offset.0, count, layout)?;
            for (&element, new) in indices.iter().zip(replaced.chunks_exact(components)) {
                let start = element as usize * components;
                values.get_mut(start..start + components).ok_or(OUTSIDE)?.copy_from_slice(new);
            }
        }
        Ok(Numbers { count, components, values })
    }

    /// Elements of a buffer view, from a byte of it on.
    fn elements(&self, view: usize, offset: u64, count: usize, layout: Layout) -> Result<Vec<f64>, Fault> {
        let (view, bytes) = self.document.view(view).ok_or(OUTSIDE)?;
        let offset = usize::try_from(offset).map_err(|_| OUTSIDE)?;
        let bytes = bytes.get(offset..).ok_or(OUTSIDE)?;
        let size = layout.size();
        let stride = view.byte_stride.map_or(size, |stride| stride.0);
        // The last element needs no stride.
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|bytes| bytes.checked_add(size)),
        };
        if stride < size || needed.is_none_or(|needed| needed > bytes.len()) {
            return Err(OUTSIDE);
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
    scalar: Scalar,
    components: usize,
    normalized: bool,
}

impl Layout {
    fn new(component: ComponentType, components: usize, normalized: bool) -> Self {
        let kind = match component {
            ComponentType::I8 | ComponentType::I16 => Kind::Signed,
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32 => Kind::Unsigned,
            ComponentType::F32 => Kind::Real,
        };
        Self { scalar: Scalar { kind, bytes: component.size() }, components, normalized }
    }
    /// Bytes of an element.
    fn size(self) -> usize {
        self.components * self.scalar.bytes
    }
    /// Appends the components of an element.
    fn read(self, bytes: &[u8], values: &mut Vec<f64>) {
        let components = bytes.chunks_exact(self.scalar.bytes).map(|bytes| self.scalar.read(bytes));
        match self.normalized {
            true => values.extend(components.map(|value| (value / self.scalar.largest()).max(-1.0))),
            false => values.extend(components),
        }
    }
}
