//! Direct labels: where they stand so that none covers another, and how their words are broken into lines.
//!
//! For: `spread`, `wrap`, `width`, `bold_width`.

/// Width of a letter, as a share of the size of the text: of the wider common sans-serif fonts, because the
/// viewer of a drawing has the font.
const LETTER: f64 = 0.6;
/// The same of bold letters.
const BOLD: f64 = 0.68;

/// The width of a text, not below that in common fonts.
pub(super) fn width(text: &str, size: i32) -> i32 {
    (text.chars().count() as f64 * LETTER * f64::from(size)).ceil() as i32
}

/// The width of a bold text.
pub(super) fn bold_width(text: &str, size: i32) -> i32 {
    (text.chars().count() as f64 * BOLD * f64::from(size)).ceil() as i32
}

/// Lines of at most so many letters, broken at spaces; a longer word has a line of its own.
pub(super) fn wrap(text: &str, letters: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("never empty");
        if line.is_empty() {
            line.push_str(word);
        } else if line.chars().count() + 1 + word.chars().count() <= letters {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

/// The middles of labels of these heights, as near as possible to where they are wanted (least squares), one
/// below the other in the order of their wishes, inside `low` to `high` where they fit.
///
/// Labels that would overlap form a block, which stands at the mean of their wishes: the *pool adjacent
/// violators* algorithm of isotonic regression (M. Ayer et al. 1955), after the heights have been subtracted.
pub(super) fn spread(wanted: &[f64], heights: &[f64], low: f64, high: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    // The middle of each label if all stood close together, the first at 0.
    let mut offsets = vec![0.0; wanted.len()];
    for pair in order.windows(2) {
        offsets[pair[1]] = offsets[pair[0]] + (heights[pair[0]] + heights[pair[1]]) / 2.0;
    }
    // Sum of the shifts, and number of labels, of each block.
    let mut blocks: Vec<(f64, usize)> = Vec::new();
    for &label in &order {
        blocks.push((wanted[label] - offsets[label], 1));
        while let [.., (above, many), (below, more)] = blocks[..]
            && above / many as f64 >= below / more as f64
        {
            blocks.truncate(blocks.len() - 2);
            blocks.push((above + below, many + more));
        }
    }
    let shifts = blocks.iter().flat_map(|&(sum, count)| std::iter::repeat_n(sum / count as f64, count));
    let mut middles = vec![0.0; wanted.len()];
    if let (Some(&first), Some(&last)) = (order.first(), order.last()) {
        // Shifts ascend, so limiting them keeps the order.
        let least = low + heights[first] / 2.0;
        let most = (high - heights[last] / 2.0 - offsets[last]).max(least);
        for (&label, shift) in order.iter().zip(shifts) {
            middles[label] = offsets[label] + shift.clamp(least, most);
        }
    }
    middles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_with_room_stand_where_they_are_wanted() {
        assert_eq!(spread(&[50.0, 10.0, 90.0], &[10.0; 3], 0.0, 100.0), [50.0, 10.0, 90.0]);
        assert!(spread(&[], &[], 0.0, 1.0).is_empty());
    }

    #[test]
    fn labels_that_would_overlap_share_the_deviation() {
        assert_eq!(spread(&[50.0, 50.0, 50.0], &[10.0; 3], 0.0, 100.0), [40.0, 50.0, 60.0]);
        assert_eq!(spread(&[52.0, 50.0], &[10.0, 30.0], 0.0, 100.0), [61.0, 41.0], "the order stays");
        assert_eq!(spread(&[99.0, 98.0], &[10.0; 2], 0.0, 100.0), [95.0, 85.0], "inside");
    }

    #[test]
    fn labels_never_overlap_and_stay_inside_wherever_they_are_wanted() {
        // A simple generator (Numerical Recipes): all cases are the same in every run.
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        for case in 0..2_000 {
            let count = 1 + case % 6;
            let heights: Vec<f64> = (0..count).map(|_| 10.0 + 20.0 * random()).collect();
            let near = random();
            let wanted: Vec<f64> = (0..count).map(|_| 240.0 * random() * near - 20.0).collect();
            let middles = spread(&wanted, &heights, 0.0, 200.0);
            for a in 0..count {
                let half = heights[a] / 2.0;
                assert!(
                    middles[a] - half > -1e-9 && middles[a] + half < 200.0 + 1e-9,
                    "{wanted:?} {middles:?}"
                );
                for b in 0..a {
                    let apart = (middles[a] - middles[b]).abs() + 1e-9;
                    assert!(apart >= (heights[a] + heights[b]) / 2.0, "{wanted:?} {middles:?}");
                }
            }
        }
    }

    #[test]
    fn words_are_broken_at_spaces() {
        assert_eq!(wrap("every primitive tested 3.2×", 15), ["every primitive", "tested 3.2×"]);
        assert_eq!(wrap("indivisible", 4), ["indivisible"]);
        assert_eq!(wrap("", 4), [""]);
    }
}
