//! Where a frame's picture and its text stand: in a window, or in a terminal.

/// The largest centred rectangle of a picture's aspect ratio in a window: left, top, width, height.
pub fn fit([width, height]: [u32; 2], window: [u32; 2]) -> [u32; 4] {
    let [across, down] = window;
    if width == 0 || height == 0 || across == 0 || down == 0 {
        return [0; 4];
    }
    let (w, h) = (u64::from(width), u64::from(height));
    let (wide, high) = (u64::from(across), u64::from(down));
    let [shown, tall] =
        if w * high <= h * wide { [(high * w / h).max(1), high] } else { [wide, (wide * h / w).max(1)] };
    [((wide - shown) / 2) as u32, ((high - tall) / 2) as u32, shown as u32, tall as u32]
}

/// Wraps a line into pieces of at most `room` characters, between words where possible.
pub fn wrap(line: &str, room: usize) -> impl Iterator<Item = &str> {
    let mut rest = Some(line);
    std::iter::from_fn(move || {
        let line = rest?;
        let Some((end, _)) = line.char_indices().nth(room) else { return rest.take() };
        // A word that does not fit goes to the next line, unless it takes more than half a line.
        let cut = line[..end].rfind(' ').filter(|&space| space > end / 2).map_or(end, |space| space + 1);
        rest = Some(&line[cut..]);
        Some(line[..cut].trim_end())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_fill_what_they_are_in_and_keep_their_shape() {
        assert_eq!(fit([240, 135], [960, 540]), [0, 0, 960, 540]);
        assert_eq!(fit([1, 16_000], [10, 10]), [4, 0, 1, 10]);
    }

    #[test]
    fn lines_are_wrapped_between_words_where_there_are_some() {
        let wrapped = |line, room| wrap(line, room).collect::<Vec<_>>();
        assert_eq!(wrapped("", 5), [""]);
        assert_eq!(wrapped("abcde", 5), ["abcde"]);
        assert_eq!(wrapped("abc def ghi", 8), ["abc def", "ghi"]);
        assert_eq!(wrapped("abcdefghij", 4), ["abcd", "efgh", "ij"]);
        assert_eq!(wrapped("×··× ··", 4), ["×··×", " ··"]);
    }
}
