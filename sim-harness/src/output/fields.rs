//! Fields of JSON files as the document of outputs has them: path, unit, meaning, null rule.

/// Path, unit, meaning, and when it is null.
pub type Field = [String; 4];

/// As they are.
pub fn owned(fields: &[[&str; 4]]) -> Vec<Field> {
    below("", fields)
}

/// With a prefix of their path.
pub fn below(prefix: &str, fields: &[[&str; 4]]) -> Vec<Field> {
    let field = |[path, unit, meaning, null]: &[&str; 4]| {
        [format!("{prefix}{path}"), (*unit).to_owned(), (*meaning).to_owned(), (*null).to_owned()]
    };
    fields.iter().map(field).collect()
}
