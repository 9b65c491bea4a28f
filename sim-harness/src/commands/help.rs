//! Help is wrapped once, to the width of the terminal.
//!
//! The texts below the options stand in the source with lines of up to 120 columns. A narrower terminal would break each of these lines once more and
//! leave ragged ones; so the line breaks inside a paragraph are taken out before clap puts in its own.

/// A line of this width or less fits every terminal and stays as it is.
const NARROW: usize = 80;

/// Paragraphs and items, one line each.
pub(super) fn unwrapped(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    // The last line as it stands in the source.
    let mut before = "";
    for line in text.lines() {
        match lines.last_mut() {
            Some(last) if continues(before, line) => {
                last.push(' ');
                last.push_str(line.trim_start());
            }
            _ => lines.push(line.to_owned()),
        }
        before = line;
    }
    lines.join("\n")
}

/// Whether `line` is the rest of a sentence whose line was full.
fn continues(before: &str, line: &str) -> bool {
    let indentation = |line: &str| line.chars().take_while(|c| *c == ' ').count();
    // An item of a list: a name, two spaces, what it is. Its further lines stand deeper.
    let item = before.trim().contains("  ");
    let full = before.chars().count() > NARROW && !before.ends_with(':') && !line.trim().is_empty();
    let deeper = indentation(line) > indentation(before);
    full && (deeper || !item && indentation(line) == indentation(before))
}

/// The command with all its texts unwrapped.
pub(super) fn wrapped_once(command: clap::Command) -> clap::Command {
    command.mut_subcommands(|command| {
        let [short, long] = [command.get_after_help(), command.get_after_long_help()]
            .map(|text| text.map(|text| unwrapped(&text.to_string())));
        let command = short.into_iter().fold(command, clap::Command::after_help);
        long.into_iter().fold(command, clap::Command::after_long_help)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_are_joined_and_items_and_examples_are_not() {
        let full = "x".repeat(90);
        let text =
            format!("{full}\nrest\n\n  a.csv  {full}\n         more\n  b.csv  short\n    rundown {full}\n  next");
        let expected = format!("{full} rest\n\n  a.csv  {full} more\n  b.csv  short\n    rundown {full}\n  next");
        assert_eq!(unwrapped(&text), expected);
    }
}
