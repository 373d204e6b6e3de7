//! The paths that a source names: `use` trees, and paths in code of two names and more.

use super::sources::{Source, is_name};

/// The paths of a source, each with the module that names it: the file's own, or one inside it.
pub fn paths(source: &Source) -> Vec<(Vec<String>, Vec<String>)> {
    let tokens: Vec<&str> = source.tokens.iter().map(String::as_str).collect();
    let token = |at: usize| tokens.get(at).copied().unwrap_or("");
    let mut module = source.module.clone();
    // How many braces are open where an inner module begins.
    let (mut depth, mut inner) = (0, Vec::new());
    let mut paths = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        match tokens[at] {
            "{" => depth += 1,
            "}" => {
                depth -= 1;
                if inner.last() == Some(&depth) {
                    inner.pop();
                    module.pop();
                }
            }
            "mod" if token(at + 2) == "{" => {
                module.push(tokens[at + 1].into());
                inner.push(depth);
                depth += 1;
                at += 2;
            }
            // Not the `use<…>` of a type.
            "use" if token(at + 1) != "<" => {
                let end = at + tokens[at..].iter().position(|&token| token == ";").expect("a use ends");
                let mut used = Vec::new();
                read_use(&tokens[at + 1..end], &mut Vec::new(), &mut used);
                paths.extend(used.into_iter().map(|path| (module.clone(), path)));
                at = end;
            }
            name if is_name(name) => {
                let follows = at > 0 && ["::", "."].contains(&tokens[at - 1]);
                let mut path = vec![name.to_owned()];
                while token(at + 1) == "::" && is_name(token(at + 2)) {
                    path.push(token(at + 2).into());
                    at += 2;
                }
                if !follows && path.len() > 1 {
                    paths.push((module.clone(), path));
                }
            }
            _ => {}
        }
        at += 1;
    }
    paths
}

/// Adds the paths that a tree of a `use` names.
fn read_use(tree: &[&str], before: &mut Vec<String>, paths: &mut Vec<Vec<String>>) {
    let length = before.len();
    let start = tree.iter().position(|&token| token == "{").unwrap_or(tree.len());
    // The name after `as` is one of this source.
    let names = tree[..start].iter().take_while(|&&token| token != "as");
    // `::std` begins at the outer packages, like `std`; `a::{self}` is `a`.
    let is_name = |token: &&&str| **token != "::" && (**token != "self" || length == 0);
    before.extend(names.filter(is_name).map(|name| name.to_string()));
    if start == tree.len() {
        paths.extend((!before.is_empty()).then(|| before.clone()));
    } else {
        let (mut from, mut level) = (start + 1, 0);
        for (end, &token) in tree.iter().enumerate().skip(start) {
            level += i32::from(token == "{") - i32::from(token == "}");
            if (level == 1 && token == ",") || level == 0 {
                if end > from {
                    read_use(&tree[from..end], before, paths);
                }
                from = end + 1;
            }
        }
    }
    before.truncate(length);
}
