//! Suggestions for misspelt names.
//!
//! For: [`nearest`], [`did_you_mean`].

/// Longest name that is compared, in bytes: the time grows with the product of two lengths.
const LONGEST: usize = 200;

/// The known name nearest to a misspelt one, if any is within a third of its length; else the one known name
/// that a word of two letters or more abbreviates: that begins with it (`rough`), holds it (`fov`), or begins
/// what is written (`roughness_of_metal`).
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > LONGEST {
        return None;
    }
    let name = name.to_lowercase();
    let known: Vec<&str> = known.into_iter().filter(|known| known.len() <= LONGEST).collect();
    let limit = (name.chars().count() / 3).max(1);
    let near = known.iter().map(|&known| (strsim::levenshtein(&name, &known.to_lowercase()), known));
    let near = near.filter(|&(distance, _)| distance <= limit).min_by_key(|&(distance, _)| distance);
    near.map(|(_, known)| known).or_else(|| abbreviated(&name, &known))
}

/// The name that a word in small letters abbreviates, if it is the only one.
fn abbreviated<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    if name.chars().count() < 2 {
        return None;
    }
    let rules: [fn(&str, &str) -> bool; 3] = [
        |name, known| known.starts_with(name),
        |name, known| known.contains(name),
        |name, known| known.len() > 2 && name.starts_with(known),
    ];
    rules.iter().find_map(|rule| {
        let mut fitting = known.iter().filter(|known| rule(name, &known.to_lowercase()));
        fitting.next().filter(|_| fitting.next().is_none()).copied()
    })
}

/// The beginning of a remedy: the known name that may be meant; empty if none is near.
pub fn did_you_mean(name: &str, known: &[&str]) -> String {
    nearest(name, known.iter().copied()).map(|near| format!("did you mean `{near}`? ")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_what_a_word_abbreviates_unless_it_could_be_two() {
        let known = ["roughness", "vertical_fov", "texture", "texture_size", "translate"];
        for (name, wanted) in [
            ("rough", "roughness"),
            ("FOV", "vertical_fov"),
            ("roughness_of_metal", "roughness"),
            ("trans", "translate"),
        ] {
            assert_eq!(nearest(name, known), Some(wanted), "{name}");
        }
        assert_eq!([nearest("te", known), nearest("t", known), nearest("size_of", known)], [None; 3]);
    }
}
