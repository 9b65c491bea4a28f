//! Files that are read in the same way, put together by equal headers. These need not be of one recorder: those that deny what the others say are read by themselves.

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

/// Files that are no group as they are: those that know alone what they hold, then those that agree with these, then the others by what is asked of them.
fn apart(sources: Vec<SourceFile>, mapping: &SourceMapping) -> Result<Vec<Group>, ReadError> {
    let each: Vec<Group> =
        sources.into_iter().map(|source| Group::new(vec![source], mapping.clone())).collect::<Result<_, _>>()?;
    let (sure, asking): (Vec<Group>, Vec<Group>) = each.into_iter().partition(|group| group.question.is_none());
    let mut found = Vec::new();
    let mut sure: Vec<SourceFile> = sure.into_iter().flat_map(|group| group.sources).collect();
    while !sure.is_empty() {
        let first = Group::new(vec![sure.remove(0)], mapping.clone())?;
        let denied = first.deny(&sure)?;
        let (others, alike) = partition(sure, &denied);
        sure = others;
        found.push([first.sources, alike].concat());
    }
    let mut left: Vec<(String, Vec<SourceFile>)> = Vec::new();
    for Group { sources, question, .. } in asking {
        if let Some(files) = found.first_mut() {
            let known = Group::new(files.clone(), mapping.clone())?;
            if known.question.is_none() && !known.deny(&sources)?.contains(&true) {
                files.extend(sources);
                continue;
            }
        }
        // What is to be done about it: figures before that differ from file to file.
        let question = question.unwrap_or_default();
        let remedy = question.rsplit("; ").next().unwrap_or_default().to_owned();
        match left.iter_mut().find(|(other, _)| *other == remedy) {
            Some((_, files)) => files.extend(sources),
            None => left.push((remedy, sources)),
        }
    }
    found
        .into_iter()
        .chain(left.into_iter().map(|(_, files)| files))
        .map(|files| Group::new(files, mapping.clone()))
        .collect()
}

/// The files that are denied, and the others.
fn partition(sources: Vec<SourceFile>, denied: &[bool]) -> (Vec<SourceFile>, Vec<SourceFile>) {
    let (yes, no): (Vec<_>, Vec<_>) = sources.into_iter().zip(denied).partition(|(_, denied)| **denied);
    let files = |pairs: Vec<(SourceFile, &bool)>| pairs.into_iter().map(|(source, _)| source).collect();
    (files(yes), files(no))
}
