//! Messages of many files: the first few of each kind whole, the others counted.
//!
//! In: messages that read `file:line: field: expected X, found Y`. Of one kind are those that differ in the file, in
//! numbers and in what was found.

/// Messages of one kind that are said whole.
const SAID: usize = 3;

#[derive(Debug)]
struct MessageKind {
    key: String,
    /// What the first of them expected.
    expected: String,
    count: usize,
}

/// The first few of each kind, then a line for each kind that has more.
pub fn few(messages: impl IntoIterator<Item = impl AsRef<str>>) -> Vec<String> {
    let (mut kinds, mut said): (Vec<MessageKind>, _) = (Vec::new(), Vec::new());
    for message in messages {
        let message = message.as_ref();
        let expected = expected(message);
        let key: String = expected.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect();
        let at = kinds.iter().position(|kind| kind.key == key).unwrap_or_else(|| {
            kinds.push(MessageKind { key, expected: expected.to_owned(), count: 0 });
            kinds.len() - 1
        });
        kinds[at].count += 1;
        if kinds[at].count <= SAID {
            said.push(message.to_owned());
        }
    }
    let more = |kind: MessageKind| {
        let more = kind.count.checked_sub(SAID).filter(|more| *more > 0)?;
        Some(format!("and {more} more like this: {}", kind.expected))
    };
    said.extend(kinds.into_iter().filter_map(more));
    said
}

/// The first line without its file, up to what was found.
fn expected(message: &str) -> &str {
    let line = message.lines().next().unwrap_or_default();
    let behind = line.split_once(": ").map_or(line, |(_, behind)| behind);
    behind.split(", found ").next().unwrap_or(behind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_errors_of_a_kind_are_three_and_a_number() {
        let header = |i: usize| format!("logs/{i}.csv:1: expected a header with time_s, found \"a{i},b\"");
        let missing = "x.csv: cannot be read: No such file".to_owned();
        let said = few((0..335).map(header).chain([missing.clone()]));
        let expected = vec![
            header(0),
            header(1),
            header(2),
            missing,
            "and 332 more like this: expected a header with time_s".to_owned(),
        ];
        assert_eq!(said, expected);
    }

    #[test]
    fn what_is_said_once_of_each_stays() {
        let told = ["a.csv:1: expected X, found Y", "a.csv:2: expected Z, found Y", "no file here", "no other file"];
        assert_eq!(few(told), told);
    }
}
