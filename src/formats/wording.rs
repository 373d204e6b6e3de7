//! Numbers and nouns as text, in one style for the whole program.

use std::fmt::Display;

/// A number with thousands separators: 1,234,567. Decimals are unchanged.
pub fn grouped(number: impl Display) -> String {
    let number = number.to_string();
    let whole = number.find('.').unwrap_or(number.len());
    let mut text = String::new();
    for (index, digit) in number[..whole].chars().enumerate() {
        if index > 0 && (whole - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text + &number[whole..]
}

/// A number and its noun, singular or plural: 1 node, 2,000 nodes.
pub fn counted(number: impl Display, one: &str, many: &str) -> String {
    let text = grouped(number);
    let noun = if text == "1" { one } else { many };
    format!("{text} {noun}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grouped_separates_thousands() {
        for (number, text) in [(0, "0"), (999, "999"), (1_000, "1,000"), (1_234_567, "1,234,567")] {
            assert_eq!(grouped(number), text);
        }
        assert_eq!(grouped(format!("{:.4}", 123_456.0)), "123,456.0000");
        assert_eq!(grouped(u64::MAX), "18,446,744,073,709,551,615");
    }

    #[test]
    fn counted_takes_the_noun_that_fits() {
        let nodes = [0, 1, 2, 1_000].map(|number| counted(number, "node", "nodes"));
        assert_eq!(nodes, ["0 nodes", "1 node", "2 nodes", "1,000 nodes"]);
    }
}
