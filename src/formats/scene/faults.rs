//! Finds all faults of keys and types in a text of a native format at once.

use super::error::{MAX_FAULTS, SceneError};
use super::json::{JsonPath, REMOVE_ONE, Source, data_fault, quoted, read};
use super::material;
use super::native::{MATERIAL, PORTAL, example};
use super::spelling::{advice, did_you_mean};
use serde::de::DeserializeOwned;
use serde_json::Value;
use serde_path_to_error::Segment;

/// Longest value that a message repeats, in characters.
const LONGEST: usize = 40;

#[derive(Clone, PartialEq)]
enum Step {
    Key(String),
    Item(usize),
}

/// Parses the text as `T`, and finds the faults of its keys and types. Each is mended in a copy, which is
/// read again: unknown keys and values of a wrong type are removed, missing ones are taken from [`example`].
pub fn read_all<T: DeserializeOwned>(source: &Source) -> Result<(T, Vec<SceneError>), SceneError> {
    let first = match read(source) {
        Ok(found) => return Ok((found, Vec::new())),
        Err(first) => first,
    };
    let Ok(mut value) = serde_json::from_str::<Value>(source.text) else { return Err(first) };
    let (mut faults, mut left_out) = (Vec::new(), Vec::new());
    while faults.len() < MAX_FAULTS {
        let error = match serde_path_to_error::deserialize(&value) {
            // `value` has only the second value of a key that occurs twice.
            Ok(found) if faults.is_empty() || first.mend.as_deref() == Some(REMOVE_ONE) => {
                faults.push(first);
                return Ok((found, faults));
            }
            Ok(found) => return Ok((found, faults)),
            Err(error) => error,
        };
        let steps = error.path().iter().filter_map(step).collect();
        let Some(fault) = mend(&mut value, steps, &error.inner().to_string(), &mut left_out) else { break };
        faults.extend(fault.map(|fault| fault.error(&source.root(), &fault.place)));
    }
    Err(SceneError::join(faults).unwrap_or(first))
}

/// Returns the fault of a value that is no `T`; `None` if it is one, or if there is no value.
pub fn fault<T: DeserializeOwned>(place: &JsonPath) -> Option<SceneError> {
    let mut deserializer = serde_json::Deserializer::from_str(place.value()?);
    let error = serde_path_to_error::deserialize::<_, T>(&mut deserializer).err()?;
    let message = error.inner().to_string();
    let (what, mend) = data_fault(&error.path().to_string(), message.split(" at line ").next()?);
    let steps: Vec<Step> = error.path().iter().filter_map(step).collect();
    Some(Fault { place: Vec::new(), what, mend }.error(place, &steps))
}

fn step(segment: &Segment) -> Option<Step> {
    match segment {
        Segment::Seq { index } => Some(Step::Item(*index)),
        Segment::Map { key } => Some(Step::Key(key.clone())),
        Segment::Enum { .. } | Segment::Unknown => None,
    }
}

struct Fault {
    place: Vec<Step>,
    what: String,
    mend: String,
}

impl Fault {
    /// Returns the error of the fault, to which `steps` lead from `place`.
    fn error(&self, place: &JsonPath, steps: &[Step]) -> SceneError {
        match steps.split_first() {
            Some((Step::Key(key), rest)) => self.error(&place.key(key), rest),
            Some((Step::Item(index), rest)) => self.error(&place.item(*index), rest),
            None => place.error(&self.what, self.mend.as_str()),
        }
    }
}

/// Mends the fault at `place` in `root`. `message` is serde's. Returns the fault, `Some(None)` if it only
/// follows from an earlier removal, or `None` if it cannot be mended.
fn mend(
    root: &mut Value,
    mut place: Vec<Step>,
    message: &str,
    left_out: &mut Vec<Vec<Step>>,
) -> Option<Option<Fault>> {
    let (word, mut known) = quoted(message);
    if message.starts_with("missing field") {
        let object = find(root, &place)?.as_object_mut()?;
        let mut key = place.clone();
        key.push(Step::Key(word.to_string()));
        let example = example_of(&key)?;
        object.insert(word.to_string(), serde_json::from_str(example).ok()?);
        let what = format!("the key `{word}` is missing");
        let mend = format!("add `{word}` to this object, such as \"{word}\": {example}");
        return Some((!left_out.contains(&key)).then_some(Fault { place, what, mend }));
    }
    let fault_place = place.clone();
    let is_unknown = message.starts_with("unknown field");
    // Removes the innermost value of which there is an example or, for an unknown word, the innermost key.
    let is_word = is_unknown || message.starts_with("unknown variant");
    let is_shown = |length: &usize| !is_word && example_of(&place[..*length]).is_some();
    let is_key = |length: &usize| matches!(place[*length - 1], Step::Key(_));
    let mut lengths = (1..=place.len()).rev();
    let length = lengths.clone().find(is_shown).or_else(|| lengths.find(is_key))?;
    place.truncate(length);
    let Step::Key(key) = place.last()?.clone() else { return None };
    let object = find(root, &place[..place.len() - 1])?.as_object_mut()?;
    let (what, mend) = if is_unknown {
        if is_in_material(&place)
            && let Some(Value::String(material_type)) = object.get("type")
        {
            known.retain(|key| material::has_key(material_type, key));
        }
        let guess = did_you_mean(word, &known);
        let of_material = known.contains(&"material") && guess.is_empty() && material::is_key(word);
        let hint = match guess.as_str() {
            _ if of_material => "it belongs to an entry of `materials`, which `material` names here; ".into(),
            "" => advice(word),
            _ => guess,
        };
        (format!("unknown key `{word}`"), format!("{hint}the keys known here are {}", known.join(", ")))
    } else if let Some(example) = example_of(&place).filter(|_| !is_word) {
        let value = object.get(&key)?.to_string();
        let shown: String = value.chars().take(LONGEST).collect();
        let cut = if shown.len() < value.len() { "…" } else { "" };
        (format!("`{key}` cannot be {shown}{cut}"), format!("write it as in \"{key}\": {example}"))
    } else {
        data_fault(&key, message)
    };
    object.remove(&key)?;
    left_out.push(place);
    Some(Some(Fault { place: fault_place, what, mend }))
}

/// Returns the value that steps lead to.
fn find<'a>(root: &'a mut Value, steps: &[Step]) -> Option<&'a mut Value> {
    steps.iter().try_fold(root, |value, step| match step {
        Step::Key(key) => value.get_mut(key),
        Step::Item(index) => value.get_mut(index),
    })
}

/// Tests whether the steps lead to a material or into one.
fn is_in_material(steps: &[Step]) -> bool {
    matches!(steps, [Step::Key(list), _, ..] if list == "materials")
}

/// Tests whether the steps lead into an entry of this list of the scene.
fn is_in_list(steps: &[Step], list: &str) -> bool {
    matches!(steps, [Step::Key(name), Step::Item(_), _, ..] if name == list)
}

/// Returns an example of the value that steps lead to.
fn example_of(steps: &[Step]) -> Option<&'static str> {
    match steps.last()? {
        Step::Key(_) if is_in_material(steps) && steps.len() == 2 => Some(MATERIAL),
        Step::Key(key) if key == "vertices" && matches!(&steps[0], Step::Key(list) if list == "portals") => {
            Some(PORTAL)
        }
        Step::Key(key) if key == "type" && is_in_list(steps, "lights") => Some("\"point\""),
        Step::Key(key) if ["lights", "camera"].contains(&key.as_str()) && is_in_list(steps, "meshes") => {
            Some("false")
        }
        Step::Key(key) => example(key),
        Step::Item(_) => None,
    }
}
