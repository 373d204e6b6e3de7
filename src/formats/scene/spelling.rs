//! Suggestions for misspelt names.
//!
//! For: [`nearest`].

/// Longest name that is compared, in bytes: the time grows with the product of two lengths.
const LONGEST: usize = 200;

/// The known name nearest to a misspelt one, if any is within a third of its length; else the one known name
/// that a word of two letters or more abbreviates: that begins with it (`rough`), holds it (`fov`), or begins
/// what is written (`roughness_of_metal`).
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > LONGEST {
        return None;
    }
    let limit = (name.chars().count() / 3).max(1);
    let known: Vec<&str> = known.into_iter().filter(|known| known.len() <= LONGEST).collect();
    known
        .iter()
        .map(|&known| (distance(&name.to_lowercase(), &known.to_lowercase()), known))
        .filter(|&(distance, _)| distance <= limit)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, known)| known)
        .or_else(|| abbreviated(name, &known))
}

/// The name that a word abbreviates, if it is the only one.
fn abbreviated<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
    if name.chars().count() < 2 {
        return None;
    }
    let rules: [&dyn Fn(&str) -> bool; 3] =
        [&|known| known.starts_with(&name), &|known| known.contains(&name), &|known| {
            known.len() > 2 && name.starts_with(known)
        }];
    rules.iter().find_map(|rule| {
        let mut fitting = known.iter().filter(|known| rule(&known.to_lowercase()));
        fitting.next().filter(|_| fitting.next().is_none()).copied()
    })
}

/// Levenshtein distance: the fewest insertions, deletions and replacements that turn one word into the other.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, a) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &b) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_one_slip_and_refuses_another_word() {
        assert_eq!(nearest("crome", ["clay", "chrome"]), Some("chrome"));
        assert_eq!(nearest("Clay", ["clay", "chrome"]), Some("clay"));
        assert_eq!(nearest("velvet", ["clay", "chrome"]), None);
    }

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

    #[test]
    fn distance_equals_hand_counts() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("abc", "abc"), 0);
    }
}
