//! Does a text look as if it was read with the wrong code page?
//!
//! Windows-1252 gives every byte a meaning, so a text of another code page is read without an error: `prędkość`
//! (Windows-1250) as `prêdkoœæ`, `время` (Windows-1251) as `âðåìÿ`.

/// The encoding that is taken where a text is neither UTF-8 nor UTF-16.
pub const ASSUMED: &str = "windows-1252";

/// What to do where letters look wrong.
pub const REMEDY: &str = "it was read as Windows-1252; if letters are wrong, say the code page: source = [{ layout.encoding = \"windows-1250\" }] (or another one)";

/// A sign within a word, a control character, or two different letters beyond ASCII side by side; German `öß` is none.
pub fn are_strange(text: &str) -> bool {
    let letters: Vec<char> = text.chars().collect();
    let is_foreign = |c: char| c.is_alphabetic() && !c.is_ascii();
    let is_pair = |pair: &[char]| {
        let [a, b] = [pair[0], pair[1]];
        is_foreign(a) && is_foreign(b) && !a.to_lowercase().eq(b.to_lowercase()) && a != 'ß' && b != 'ß'
    };
    let is_sign = |c: char| !c.is_ascii() && !c.is_alphabetic() && c != '²' && c != '°';
    let is_sign_within = |three: &[char]| three[0].is_alphabetic() && is_sign(three[1]) && three[2].is_alphabetic();
    letters.iter().any(|c| ('\u{80}'..='\u{9f}').contains(c))
        || letters.windows(2).any(is_pair)
        || letters.windows(3).any(is_sign_within)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn as_windows_1252(label: &str, text: &str) -> String {
        let bytes = encoding_rs::Encoding::for_label(label.as_bytes()).unwrap().encode(text).0;
        encoding_rs::WINDOWS_1252.decode(&bytes).0.into_owned()
    }

    #[test]
    fn other_code_pages_are_strange() {
        for (label, text) in [
            ("windows-1250", "prędkość [km/h]"),
            ("windows-1250", "położenie"),
            ("windows-1251", "время"),
            ("windows-1253", "ταχύτητα"),
        ] {
            let read = as_windows_1252(label, text);
            assert!(are_strange(&read), "{text}: {read}");
        }
    }

    #[test]
    fn western_words_are_not() {
        for text in ["Größe", "créée à", "vêtesse (m/s²)", "Årstid °C", "kørtøj", "päätös", "velocità"] {
            let read = as_windows_1252("windows-1252", text);
            assert!(!are_strange(&read), "{text}: {read}");
        }
    }
}
