//! Formats numbers and nouns, in one style for the whole program.

use std::fmt::Display;

/// Formats a number with thousands separators: 1,234,567. Decimals are unchanged.
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

/// Formats a number and its noun, singular or plural: 1 node, 2,000 nodes.
pub fn counted(number: impl Display, one: &str, many: &str) -> String {
    let text = grouped(number);
    let noun = if text == "1" { one } else { many };
    format!("{text} {noun}")
}
