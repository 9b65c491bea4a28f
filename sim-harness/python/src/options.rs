//! Options of the command, as messages name them, as arguments of Python: `--force` is `force=True`.
//!
//! Messages are written once, for the command; here they pass on their way to Python. What stands between backticks is
//! a whole command, to be typed, and stays as it is. The tests run from `sim-harness/tests/python_options.rs`, as a
//! test program of the module would need the library of an interpreter.

/// Options without a value; those that begin with `no-` are known by that.
const FLAGS: [&str; 4] = ["as-recorded", "force", "skip-bad-rows", "strict"];

/// Words that are values, where they follow their option. Others are a sentence that goes on.
const WORDS: [(&str, &[&str]); 3] = [
    ("chainage", &["as-is", "stops", "line", "align"]),
    ("direction", &["auto", "up", "down"]),
    ("mode", &["paper", "gated", "measured"]),
];

/// The text with arguments of Python in the place of options.
pub fn in_python(text: &str) -> String {
    let part = |(index, part): (usize, &str)| if index % 2 == 0 { arguments(part) } else { part.to_owned() };
    text.split('`').enumerate().map(part).collect::<Vec<_>>().join("`")
}

fn arguments(text: &str) -> String {
    let (mut done, mut rest) = (String::new(), text);
    while let Some((before, option)) = rest.split_once("--") {
        done.push_str(before);
        let end = option.find(|c: char| !c.is_ascii_lowercase() && c != '-').unwrap_or(option.len());
        let (name, after) = option.split_at(end);
        let begins = done.chars().next_back().is_none_or(|c| c.is_whitespace() || c == '(');
        if begins && name.starts_with(|c: char| c != '-') {
            let (argument, after) = argument(name, after);
            done.push_str(&argument);
            rest = after;
        } else {
            done.push_str("--");
            rest = option;
        }
    }
    done + rest
}

/// An option as an argument, and the text after its value. Without a value it ends with `=`.
fn argument<'text>(name: &str, after: &'text str) -> (String, &'text str) {
    let named = name.replace('-', "_");
    if let Some(named) = named.strip_prefix("no_") {
        return (format!("{named}=False"), after);
    }
    if FLAGS.contains(&name) {
        return (format!("{named}=True"), after);
    }
    let word = after.strip_prefix(' ').and_then(|after| after.split_whitespace().next()).unwrap_or_default();
    let word = word.trim_end_matches([',', ';', ':', '.', ')']);
    let is_word = WORDS.iter().any(|(option, words)| *option == name && words.contains(&word));
    let value = if name == "set" && !word.is_empty() {
        let (field, value) = word.split_once('=').unwrap_or((word, "VALUE"));
        format!("{{\"{field}\": {value}}}")
    } else if is_word || word.ends_with(".toml") {
        format!("\"{word}\"")
    } else if word.starts_with(|c: char| c.is_ascii_digit()) {
        word.to_owned()
    } else {
        return (format!("{named}="), after);
    };
    (format!("{named}={value}"), &after[1 + word.len()..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_messages_are_arguments() {
        for (text, expected) in [
            ("overwrite with --force", "overwrite with force=True"),
            ("leave such rows out with --skip-bad-rows; all in", "leave such rows out with skip_bad_rows=True; all in"),
            ("--strict: expected nothing", "strict=True: expected nothing"),
            ("a replay made with --no-carry", "a replay made with carry=False"),
            ("--mode measured learns from it", "mode=\"measured\" learns from it"),
            ("no location: --chainage line", "no location: chainage=\"line\""),
            (
                "--chainage as-is keeps them, --track K.toml places them",
                "chainage=\"as-is\" keeps them, track=\"K.toml\" places them",
            ),
            ("--hold-out 10: an analysis needs", "hold_out=10: an analysis needs"),
            ("add --set mass_kg=VALUE", "add set={\"mass_kg\": VALUE}"),
            ("--set r0: expected a train", "set={\"r0\": VALUE}: expected a train"),
            ("(see --direction)", "(see direction=)"),
            ("a file for --mapping", "a file for mapping="),
        ] {
            assert_eq!(in_python(text), expected);
        }
    }

    #[test]
    fn what_is_no_option_stays() {
        for text in [
            "",
            "between `rundown import --chainage align` backticks",
            "a--force.csv: found \"--force\" --- -- end--",
            "2 -- 3, -1--2",
        ] {
            assert_eq!(in_python(text), text);
        }
        assert_eq!(in_python("`--out` --out `--out"), "`--out` out= `--out");
    }
}
