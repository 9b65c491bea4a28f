//! Files that are read in the same way, put together by equal headers. These need not be of one recorder: those that
//! deny what the others say are read by themselves.

use super::analysis::Group;
use super::mapping::{Mapping, SourceMapping};
use super::source::SourceFile;
use rundown_files::refusal::ReadError;
use std::path::PathBuf;

/// What can be read, and the errors of what cannot.
pub fn analyse(files: &[PathBuf], mapping: &Mapping) -> (Vec<Group>, Vec<ReadError>) {
    let mut refusals = Vec::new();
    let mut same_header: Vec<(SourceMapping, Vec<SourceFile>)> = Vec::new();
    for path in files {
        let said = mapping.of_file(path);
        let named: Vec<String> =
            said.columns.values().map(|column| column.name.clone()).filter(|name| !name.is_empty()).collect();
        match SourceFile::open(path, &said.layout, &named) {
            Ok(source) => {
                let same = same_header.iter_mut().find(|(other, sources)| {
                    let first = sources.first();
                    let equal =
                        first.is_some_and(|first| first.layout == source.layout && first.headers == source.headers);
                    equal && other.columns == said.columns && other.zone == said.zone && other.unit == said.unit
                });
                match same {
                    Some((_, sources)) => sources.push(source),
                    None => same_header.push((said, vec![source])),
                }
            }
            Err(error) => refusals.push(error),
        }
    }
    let mut found = Vec::new();
    for (said, sources) in same_header {
        match groups(sources, &said) {
            Ok(groups) => found.extend(groups),
            Err(error) => refusals.push(error),
        }
    }
    (found, refusals)
}

/// Groups of files with the same header that say the same.
///
/// # Errors
/// What the mapping asks for and the files do not have.
fn groups(sources: Vec<SourceFile>, mapping: &SourceMapping) -> Result<Vec<Group>, ReadError> {
    let group = Group::new(sources, mapping.clone())?;
    if group.sources.len() < 2 {
        return Ok(vec![group]);
    }
    if group.question.is_some() {
        return apart(group.sources, mapping);
    }
    let (others, rest): (Vec<_>, Vec<_>) = partition(group.sources.clone(), &group.denied);
    if others.is_empty() || rest.is_empty() {
        return Ok(vec![group]);
    }
    Ok([groups(rest, mapping)?, groups(others, mapping)?].concat())
}

/// Files that are no group as they are: those that know alone what they hold, then those that agree with these, then
/// the others by what is asked of them.
fn apart(sources: Vec<SourceFile>, mapping: &SourceMapping) -> Result<Vec<Group>, ReadError> {
    let each: Vec<Group> =
        sources.into_iter().map(|source| Group::new(vec![source], mapping.clone())).collect::<Result<_, _>>()?;
    let (mut sure, asking): (Vec<Group>, Vec<Group>) = each.into_iter().partition(|group| group.question.is_none());
    let mut found: Vec<Vec<SourceFile>> = Vec::new();
    while !sure.is_empty() {
        let first = sure.remove(0);
        let denied = first.deny(&files_of(&sure))?;
        let (others, alike) = partition(sure, &denied);
        sure = others;
        found.push([first.sources, files_of(&alike)].concat());
    }
    let mut left = asking;
    if let Some(files) = found.first_mut() {
        let known = Group::new(files.clone(), mapping.clone())?;
        if known.question.is_none() {
            let denied = known.deny(&files_of(&left))?;
            let (others, alike) = partition(left, &denied);
            left = others;
            files.extend(files_of(&alike));
        }
    }
    let mut asked: Vec<(String, Vec<SourceFile>)> = Vec::new();
    for Group { sources, question, .. } in left {
        // What is to be done about it: figures before that differ from file to file.
        let question = question.unwrap_or_default();
        let remedy = question.rsplit("; ").next().unwrap_or_default().to_owned();
        match asked.iter_mut().find(|(other, _)| *other == remedy) {
            Some((_, files)) => files.extend(sources),
            None => asked.push((remedy, sources)),
        }
    }
    let all = found.into_iter().chain(asked.into_iter().map(|(_, files)| files));
    all.map(|files| Group::new(files, mapping.clone())).collect()
}

fn files_of(groups: &[Group]) -> Vec<SourceFile> {
    groups.iter().flat_map(|group| group.sources.clone()).collect()
}

/// Those that are denied, and the others.
fn partition<T>(all: Vec<T>, denied: &[bool]) -> (Vec<T>, Vec<T>) {
    let (yes, no): (Vec<_>, Vec<_>) = all.into_iter().zip(denied).partition(|(_, denied)| **denied);
    let without_flags = |pairs: Vec<(T, &bool)>| pairs.into_iter().map(|(one, _)| one).collect();
    (without_flags(yes), without_flags(no))
}
