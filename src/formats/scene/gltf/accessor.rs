//! Reads accessors: numbers in buffers, of any component type, interleaved, normalised or sparse.

use super::super::error::SceneError;
use super::super::json::JsonPath;
use super::super::scalar::{Kind, Scalar};
use super::bytes::{self, Document, broken};
use super::schema::{Accessor, Whole};
use std::collections::HashMap;
use std::rc::Rc;

/// The elements of an accessor, component by component.
pub struct Numbers {
    pub count: usize,
    pub components: usize,
    pub values: Vec<f64>,
}

impl Numbers {
    /// Returns the first components of an element. Domain: the element exists and has that many.
    pub fn element<const N: usize>(&self, element: usize) -> [f64; N] {
        let start = element * self.components;
        std::array::from_fn(|component| self.values[start + component])
    }
}

/// A file's accessors, each of which is read once.
pub struct Accessors<'a> {
    pub document: &'a Document<'a>,
    read: HashMap<usize, Rc<Numbers>>,
    /// How many numbers may still be read: more than a useful file has. The size of the file so bounds the
    /// memory of accessors that overlap or have no data.
    left: usize,
}

impl<'a> Accessors<'a> {
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { document, read: HashMap::new(), left: 1024 + 8 * bytes::total(document.buffers) }
    }

    /// Reads the values of a vertex attribute, which must have one of these numbers of components.
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

    /// Reads indices of vertices.
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
        let document = self.document;
        let accessor = document.get(&document.root.accessors, "accessors", index, place)?;
        let root = document.source.root();
        let numbers = Rc::new(self.decode(accessor, &root.key("accessors").item(index))?);
        self.read.insert(index, Rc::clone(&numbers));
        Ok(numbers)
    }

    /// Returns how many numbers so many elements have, and subtracts it from those that may still be read.
    fn reserve(&mut self, count: usize, components: usize, place: &JsonPath) -> Result<usize, SceneError> {
        let length = count.checked_mul(components).filter(|&length| length <= self.left);
        self.left -= length.unwrap_or(0);
        length.ok_or_else(|| broken(place, "the accessor has more elements than the file has bytes for"))
    }

    fn decode(&mut self, accessor: &Accessor, place: &JsonPath) -> Result<Numbers, SceneError> {
        let components = match accessor.kind.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            // Attributes of meshes are no matrices.
            other => {
                let what = format!("a mesh has no numbers of the type `{other}`");
                return Err(place.key("type").error(what, "write SCALAR, VEC2, VEC3 or VEC4"));
            }
        };
        let count = accessor.count.0;
        let length = self.reserve(count, components, place)?;
        let layout = Layout::new(accessor.component_type, components, accessor.normalized, place)?;
        let mut values = match accessor.buffer_view {
            Some(view) => self.elements([view, accessor.byte_offset], count, layout, place)?,
            None => vec![0.0; length],
        };
        if let Some(sparse) = &accessor.sparse {
            let place = place.key("sparse");
            let count = sparse.count.0;
            self.reserve(count, components + 1, &place)?;
            let part = place.key("indices");
            let index_layout = Layout::new(sparse.indices.component_type, 1, false, &part)?;
            let indices = [sparse.indices.buffer_view, sparse.indices.byte_offset];
            let indices = self.elements(indices, count, index_layout, &part)?;
            let replaced = [sparse.values.buffer_view, sparse.values.byte_offset];
            let replaced = self.elements(replaced, count, layout, &place.key("values"))?;
            for (&element, new) in indices.iter().zip(replaced.chunks_exact(components)) {
                let start = element as usize * components;
                let old = values.get_mut(start..start + components);
                let outside = || broken(&part, format!("the accessor has no element {element}"));
                old.ok_or_else(outside)?.copy_from_slice(new);
            }
        }
        Ok(Numbers { count, components, values })
    }

    /// Reads elements of a buffer view, from a byte of it on.
    fn elements(
        &self,
        [view, offset]: [Whole; 2],
        count: usize,
        layout: Layout,
        place: &JsonPath,
    ) -> Result<Vec<f64>, SceneError> {
        let mend = "put the files that the model names beside it, or export it again, as .glb";
        let (view, bytes) = self.document.view(view.0).map_err(|why| place.error(why, mend))?;
        let size = layout.size();
        let stride = view.byte_stride.map_or(size, |stride| stride.0);
        if stride < size {
            let what = format!("its elements of {size} bytes overlap: one begins every {stride} bytes");
            return Err(broken(place, what));
        }
        // The last element may be shorter than the stride.
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|bytes| bytes.checked_add(size)),
        };
        let bytes = bytes.get(offset.0..).filter(|bytes| needed.is_some_and(|needed| needed <= bytes.len()));
        let bytes = bytes.ok_or_else(|| broken(place, "the accessor reaches beyond its buffer view"))?;
        let mut values = Vec::with_capacity(count * layout.components);
        for element in 0..count {
            layout.read(&bytes[element * stride..][..size], &mut values);
        }
        Ok(values)
    }
}

/// The storage of an element.
#[derive(Clone, Copy)]
struct Layout {
    scalar: Scalar,
    components: usize,
    normalized: bool,
}

impl Layout {
    fn new(
        Whole(component): Whole,
        components: usize,
        normalized: bool,
        place: &JsonPath,
    ) -> Result<Self, SceneError> {
        let (kind, bytes) = match component {
            5120 => (Kind::Signed, 1),
            5121 => (Kind::Unsigned, 1),
            5122 => (Kind::Signed, 2),
            5123 => (Kind::Unsigned, 2),
            5125 => (Kind::Unsigned, 4),
            5126 => (Kind::Real, 4),
            _ => {
                let what = format!("the component type {component} is unknown");
                let mend = "write 5120, 5121, 5122, 5123, 5125 or 5126";
                return Err(place.key("componentType").error(what, mend));
            }
        };
        Ok(Self { scalar: Scalar { kind, bytes }, components, normalized: normalized && kind != Kind::Real })
    }
    /// Returns the number of bytes of an element.
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
