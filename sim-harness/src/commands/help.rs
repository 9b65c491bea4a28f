//! Help is wrapped once, to the width of the terminal, and an item of a list goes on below its text.
//!
//! The texts below the options stand in the source with lines of up to 120 columns, so the line breaks inside a
//! paragraph are taken out first. What clap breaks goes on below the name of an item; so clap breaks nothing, and the
//! whole help is broken here.

use super::Arguments;
use clap::error::{ContextKind, ErrorKind};
use clap::{Arg, Command, CommandFactory};
use std::any::TypeId;
use std::io::Write;
use std::path::PathBuf;
use textwrap::core::display_width;
use textwrap::{Options, WordSplitter, fill};

/// A line of this width or less fits every terminal and stays as it is.
const NARROW: usize = 80;
/// Lines that are longer are hard to read on any terminal.
const WIDEST: usize = 100;
/// A command line of an example stands this deep, and goes on so much deeper.
const EXAMPLE: &str = "    ";
/// What has no room behind its name begins below it, this deep.
const BELOW: &str = "          ";

/// The command, and all below it, with every paragraph in one line.
pub(super) fn unbroken(command: Command) -> Command {
    let command = command.term_width(0).mut_subcommands(unbroken);
    let [short, long] = [command.get_after_help(), command.get_after_long_help()]
        .map(|text| text.map(|text| unwrapped(&text.to_string())));
    let command = short.into_iter().fold(command, Command::after_help);
    long.into_iter().fold(command, Command::after_long_help)
}

/// Ends the process: help was asked for, or the arguments are wrong.
pub(super) fn exit(error: &clap::Error) -> ! {
    let help = [ErrorKind::DisplayHelp, ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand];
    let said = error.render().ansi().to_string();
    let text = if help.contains(&error.kind()) { lines(&said, width()) } else { expected(said) + &tip(error) };
    // Whoever closed the other end wants no more.
    let _ = match error.use_stderr() {
        true => anstream::stderr().write_all(text.as_bytes()),
        false => anstream::stdout().write_all(text.as_bytes()),
    };
    std::process::exit(error.exit_code())
}

/// What helps where logs stand where other commands take them: the option of this one.
fn tip(error: &clap::Error) -> String {
    let of = |kind| error.get(kind).map(ToString::to_string).unwrap_or_default();
    let (found, usage) = (of(ContextKind::InvalidArg), of(ContextKind::Usage));
    let is_word = error.kind() == ErrorKind::UnknownArgument && !found.starts_with('-');
    let command = Arguments::command();
    // Of `simulate` it is a number.
    let is_path = |argument: &Arg| argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
    let takes_runs = |one: &&Command| one.get_arguments().any(|one| one.get_long() == Some("runs") && is_path(one));
    let is_used = |one: &&Command| usage.contains(&format!("rundown {} ", one.get_name()));
    let has_option = command.get_subcommands().filter(takes_runs).any(|one| is_used(&one));
    if is_word && has_option {
        format!("\n  tip: logs and their folders are given with --runs {found}\n")
    } else {
        String::new()
    }
}

/// An error with what was expected, where the standard library says what it found.
fn expected(said: String) -> String {
    const NUMBERS: [(&str, &str); 5] = [
        ("invalid digit found in string", "expected a whole number"),
        ("cannot parse integer from empty string", "expected a whole number"),
        ("invalid float literal", "expected a number"),
        ("cannot parse float from empty string", "expected a number"),
        ("number too large to fit in target type", "expected a smaller number"),
    ];
    NUMBERS.iter().fold(said, |said, (found, expected)| said.replace(found, expected))
}

/// Columns of the terminal, or what `COLUMNS` says where there is none.
fn width() -> usize {
    let terminal = terminal_size::terminal_size().map(|(width, _)| usize::from(width.0));
    let said = || std::env::var("COLUMNS").ok()?.parse().ok();
    terminal.or_else(said).map_or(WIDEST, |width| width.min(WIDEST))
}

/// A text in lines of this width; clap fills empty ones with spaces.
fn lines(text: &str, width: usize) -> String {
    text.lines().map(|line| line_of(line.trim_end(), width) + "\n").collect()
}

/// A paragraph, an item or a command in lines of this width.
fn line_of(line: &str, width: usize) -> String {
    if display_width(line) <= width {
        return line.to_owned();
    }
    let indent = &line[..line.len() - line.trim_start().len()];
    if indent == EXAMPLE {
        // A shell takes it in this form, too.
        let broken = broken(line.trim_start(), width.saturating_sub(" \\".len()), indent, &indent.repeat(2));
        return broken.replace('\n', " \\\n");
    }
    let Some(at) = text_of_item(line) else { return broken(line.trim_start(), width, indent, indent) };
    let (name, text) = line.split_at(at);
    match display_width(name) {
        deep if deep > width / 2 => format!("{}\n{}", name.trim_end(), broken(text, width, BELOW, BELOW)),
        deep => broken(text, width, name, &" ".repeat(deep)),
    }
}

/// Where the text of an item begins: behind its name and two spaces or more, of a value behind `- value: `, of the
/// usage behind `Usage: `.
fn text_of_item(line: &str) -> Option<usize> {
    let text = line.trim_start();
    let behind = |end: usize| text[end..].len() - text[end..].trim_start().len() + end;
    let usage = text.find("Usage:").filter(|at| display_width(&text[..*at]) == 0);
    let end = match usage {
        Some(at) => at + text[at..].find(' ')?,
        None if text.starts_with("- ") => text.find(": ")? + 1,
        None => text.find("  ")?,
    };
    Some(line.len() - text.len() + behind(end))
}

/// A text in lines, with what stands before the first one and before the others.
fn broken(text: &str, width: usize, first: &str, others: &str) -> String {
    let whole_words = Options::new(width).break_words(false).word_splitter(WordSplitter::NoHyphenation);
    fill(text, whole_words.initial_indent(first).subsequent_indent(others))
}

/// Paragraphs and items, one line each.
fn unwrapped(text: &str) -> String {
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
    // What stands deeper below a sentence is the command that it is about.
    let command = line.strip_prefix(EXAMPLE).is_some_and(|line| line.starts_with("rundown "));
    full && !command && if item { deeper } else { indentation(line) == indentation(before) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_no_number_is_refused_by_what_was_expected() {
        let said = |arguments: &[&str]| {
            expected(Arguments::command().try_get_matches_from(arguments).unwrap_err().render().to_string())
        };
        assert!(said(&["rundown", "study", "--seed", "abc"]).contains("'--seed <SEED>': expected a whole number"));
        assert!(said(&["rundown", "tune", "--seed", "1e99"]).contains("expected a whole number"));
        assert!(said(&["rundown", "study", "--seed", "99999999999999999999"]).contains("expected a smaller number"));
        let floats = said(&["rundown", "study", "--experiment", "wind", "--values", "a,b"]);
        assert!(floats.contains("expected a number"), "{floats}");
    }

    #[test]
    fn logs_without_the_option_that_takes_them_are_refused_with_its_name() {
        let said =
            |arguments: &[&str]| tip(&unbroken(Arguments::command()).try_get_matches_from(arguments).unwrap_err());
        let models = ["--train", "t.toml", "--track", "k.toml"];
        for command in ["gap", "study", "tune"] {
            let found = said(&[&["rundown", command, "--out", "o", "set/runs"][..], &models].concat());
            assert!(found.ends_with("with --runs set/runs\n"), "{command}: {found}");
        }
        assert_eq!(said(&["rundown", "gap", "--rums", "set/runs"]), "");
        assert_eq!(said(&["rundown", "simulate", "set/runs"]), "");
    }

    #[test]
    fn sentences_are_joined_and_items_and_examples_are_not() {
        let full = "x".repeat(90);
        let text = format!(
            "{full}\nrest\n    rundown a\n  {full}\n    rundown b\n\n  a.csv  {full}\n         more\n    rundown {full}\n    rundown b\n  next"
        );
        let expected = format!(
            "{full} rest\n    rundown a\n  {full}\n    rundown b\n\n  a.csv  {full} more\n    rundown {full}\n    rundown b\n  next"
        );
        assert_eq!(unwrapped(&text), expected);
    }

    #[test]
    fn items_go_on_below_their_text_and_commands_as_a_shell_reads_them() {
        let pairs = [
            ("Usage: a b c d --dddddddd", "Usage: a b c d\n       --dddddddd\n"),
            ("  a.csv   one two three four", "  a.csv   one two three\n          four\n"),
            ("    rundown gap --runs runs", "    rundown gap --runs \\\n        runs\n"),
            ("  in many more words of a list", "  in many more words of\n  a list\n"),
            ("      - up: one two three", "      - up: one two\n            three\n"),
        ];
        for (line, expected) in pairs {
            assert_eq!(lines(line, 24), expected);
        }
        assert_eq!(
            lines("  --a-long-name <X>  one two three four", 20),
            format!("  --a-long-name <X>\n{BELOW}one two\n{BELOW}three four\n")
        );
    }

    /// Short and long help of all commands, each paragraph in a line.
    fn helps() -> Vec<(String, String)> {
        let mut command = unbroken(Arguments::command());
        command.build();
        let both = |one: &mut Command| {
            let name = one.get_name().to_owned();
            [
                (format!("{name} -h"), one.render_help().to_string()),
                (format!("{name} --help"), one.render_long_help().to_string()),
            ]
        };
        let own = both(&mut command);
        own.into_iter().chain(command.get_subcommands_mut().flat_map(both)).collect()
    }

    #[test]
    fn every_help_fits_its_terminal_and_every_item_goes_on_below_its_text() {
        let helps = helps();
        assert!(helps.len() > 30, "{}", helps.len());
        let words =
            |line: &str| line.split_whitespace().filter(|word| *word != "\\").map(String::from).collect::<Vec<_>>();
        let indent = |line: &str| line.len() - line.trim_start().len();
        let mut further = 0;
        for width in [60, 80, 100, 140] {
            for (name, whole) in &helps {
                let help = lines(whole, width);
                let mut printed = help.lines();
                for paragraph in whole.lines() {
                    let deeper = match text_of_item(paragraph) {
                        _ if indent(paragraph) == EXAMPLE.len() => 2 * EXAMPLE.len(),
                        Some(at) if at > width / 2 => BELOW.len(),
                        Some(at) => at,
                        None => indent(paragraph),
                    };
                    let mut said = words(printed.next().unwrap());
                    while said.len() < words(paragraph).len() {
                        let line = printed.next().unwrap();
                        assert_eq!(indent(line), deeper, "{name}, {width} columns: {line:?} of {paragraph:?}");
                        said.extend(words(line));
                        further += 1;
                    }
                    assert_eq!(said, words(paragraph), "{name}, {width} columns");
                }
                assert_eq!(printed.next(), None, "{name}, {width} columns");
                let wide = help.lines().find(|line| line.chars().count() > width);
                assert_eq!(wide, None, "{name}, {width} columns");
            }
        }
        assert!(further > 500, "{further}");
    }
}
