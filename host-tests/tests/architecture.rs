//! Do imports go the way that `ARCHITECTURE.md` says? Its tables are read here, so that page and code cannot part.
//!
//! A module is read from its `mod name;` on, as the compiler does; what stands under `#[cfg(test)]` is left out. A name
//! that a module re-exports counts as an import of the file that defines it, and the front page of a crate re-exports
//! without importing.

use host_tests::project::{root, shown, text};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// Files that are still in a circle. The list may only become shorter.
const KNOWN_CIRCLES: &[&str] = &[];

/// A path in a file: `crate::model::track::Track`.
struct Import {
    line: usize,
    path: Vec<String>,
}

/// What a file says of imports.
#[derive(Default)]
struct Source {
    /// Modules that stand in files of their own, with the path that an attribute gives.
    modules: Vec<(String, Option<String>)>,
    /// Modules of tests.
    tests: Vec<String>,
    imports: Vec<Import>,
    /// Types that it defines.
    types: Vec<String>,
    /// By the name that a `use` gives.
    names: HashMap<String, Vec<String>>,
    is_front: bool,
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|a| {
        a.path().is_ident("cfg") && a.parse_args::<syn::Path>().is_ok_and(|condition| condition.is_ident("test"))
    })
}

impl Source {
    fn declares(&self, module: &str) -> bool {
        self.modules.iter().any(|(name, _)| name == module)
    }

    fn take(&mut self, path: Vec<String>, line: usize) {
        if path.len() > 1 {
            self.imports.push(Import { line, path });
        }
    }

    fn take_tree(&mut self, tree: &syn::UseTree, before: &[String], counts: bool) {
        let with = |ident: &syn::Ident| [before, &[ident.to_string()]].concat();
        let (path, name, ident) = match tree {
            syn::UseTree::Path(path) => return self.take_tree(&path.tree, &with(&path.ident), counts),
            syn::UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.take_tree(tree, before, counts));
            }
            // `{self}` names what stands before it.
            syn::UseTree::Name(name) if name.ident == "self" => (before.to_vec(), before.last().cloned(), &name.ident),
            syn::UseTree::Name(name) => (with(&name.ident), Some(name.ident.to_string()), &name.ident),
            syn::UseTree::Rename(rename) => (with(&rename.ident), Some(rename.rename.to_string()), &rename.ident),
            syn::UseTree::Glob(star) => {
                let line = star.star_token.spans[0].start().line;
                return if counts {
                    self.take([before, &["*".to_owned()]].concat(), line)
                };
            }
        };
        let line = ident.span().start().line;
        self.names.extend(name.map(|name| (name, path.clone())));
        if counts {
            self.take(path, line);
        }
    }

    fn take_tokens(&mut self, tokens: proc_macro2::TokenStream) {
        use proc_macro2::TokenTree;
        let (mut path, mut colons, mut line) = (Vec::new(), 0, 0);
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.take(std::mem::take(&mut path), line);
                    }
                    (colons, line) = (0, ident.span().start().line);
                    path.push(ident.to_string());
                    continue;
                }
                TokenTree::Punct(mark) if mark.as_char() == ':' && !path.is_empty() => {
                    colons += 1;
                    continue;
                }
                TokenTree::Group(group) => self.take_tokens(group.stream()),
                _ => {}
            }
            self.take(std::mem::take(&mut path), line);
            colons = 0;
        }
        self.take(path, line);
    }

    /// The types that a macro is given to define, or defines under a name of its own.
    fn take_types(&mut self, tokens: proc_macro2::TokenStream) {
        use proc_macro2::TokenTree;
        let mut is_type = false;
        for token in tokens {
            match token {
                TokenTree::Ident(ident) if is_type => {
                    self.types.push(ident.to_string());
                    is_type = false;
                }
                TokenTree::Ident(ident) => is_type = ident == "struct" || ident == "enum",
                TokenTree::Group(group) => {
                    self.take_types(group.stream());
                    is_type = false;
                }
                _ => is_type = false,
            }
        }
    }
}

impl<'a> Visit<'a> for Source {
    fn visit_item_mod(&mut self, item: &'a syn::ItemMod) {
        if is_test(&item.attrs) {
            return self.tests.push(item.ident.to_string());
        }
        if item.content.is_none() {
            let path = item.attrs.iter().find(|a| a.path().is_ident("path")).map(|a| match &a.meta {
                syn::Meta::NameValue(syn::MetaNameValue { value: syn::Expr::Lit(text), .. }) => match &text.lit {
                    syn::Lit::Str(text) => text.value(),
                    _ => panic!("a path is a text"),
                },
                _ => panic!("a path has a value"),
            });
            self.modules.push((item.ident.to_string(), path));
        }
        visit::visit_item_mod(self, item);
    }

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        if !is_test(&item.attrs) {
            let front = self.is_front && !matches!(item.vis, syn::Visibility::Inherited);
            self.take_tree(&item.tree, &[], !front);
        }
    }

    fn visit_item(&mut self, item: &'a syn::Item) {
        match item {
            syn::Item::Struct(syn::ItemStruct { ident, attrs, .. })
            | syn::Item::Enum(syn::ItemEnum { ident, attrs, .. })
            | syn::Item::Trait(syn::ItemTrait { ident, attrs, .. })
            | syn::Item::Type(syn::ItemType { ident, attrs, .. })
                if !is_test(attrs) =>
            {
                self.types.push(ident.to_string());
            }
            _ => {}
        }
        visit::visit_item(self, item);
    }

    fn visit_item_fn(&mut self, item: &'a syn::ItemFn) {
        if !is_test(&item.attrs) {
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_item_impl(&mut self, item: &'a syn::ItemImpl) {
        if !is_test(&item.attrs) {
            visit::visit_item_impl(self, item);
        }
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let line = path.segments[0].ident.span().start().line;
        self.take(path.segments.iter().map(|segment| segment.ident.to_string()).collect(), line);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'a syn::Macro) {
        self.take_tokens(item.tokens.clone());
        // It names a type that stands elsewhere.
        if !item.path.is_ident("plain") {
            self.take_types(item.tokens.clone());
        }
        visit::visit_macro(self, item);
    }
}

/// The modules of a library or a program by their paths, the root's is empty.
struct Target {
    modules: BTreeMap<Vec<String>, (PathBuf, Source)>,
}

impl Target {
    fn read(front: &Path) -> Self {
        let mut target = Self { modules: BTreeMap::new() };
        target.read_module(front, Vec::new());
        target
    }

    fn read_module(&mut self, file: &Path, module: Vec<String>) {
        let text = text(file);
        let mut source = Source { is_front: module.is_empty(), ..Source::default() };
        source.visit_file(&syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display())));
        let folder = file.parent().unwrap();
        let stem = file.file_stem().unwrap();
        let own = if module.is_empty() || stem == "mod" { folder.to_owned() } else { folder.join(stem) };
        if !module.is_empty() && own.is_dir() {
            // Those that a macro declares.
            let files = std::fs::read_dir(&own).unwrap().map(|entry| entry.unwrap().path());
            let names = files.filter(|file| file.extension().is_some_and(|e| e == "rs"));
            let names = names.map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned());
            let known = |name: &String| name == "mod" || source.tests.contains(name) || source.declares(name);
            let more: Vec<String> = names.filter(|name| !known(name)).collect();
            source.modules.extend(more.into_iter().map(|name| (name, None)));
        }
        for (name, path) in &source.modules {
            let candidates = match path {
                Some(path) => vec![folder.join(path)],
                None => vec![own.join(format!("{name}.rs")), own.join(name).join("mod.rs")],
            };
            let found = candidates.into_iter().find(|path| path.is_file());
            let found = found.unwrap_or_else(|| panic!("{}: no file of module {name}", file.display()));
            self.read_module(&found.canonicalize().unwrap(), [module.as_slice(), std::slice::from_ref(name)].concat());
        }
        self.modules.insert(module, (file.to_owned(), source));
    }

    /// The module that a path of `from` leads to; none outside of this target.
    fn resolve(&self, from: &[String], path: &[String], depth: usize) -> Option<Vec<String>> {
        let (first, mut rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" => Vec::new(),
            "self" => from.to_vec(),
            "super" => from.split_last()?.1.to_vec(),
            name => {
                let child = [from, &[name.to_owned()]].concat();
                match self.modules.get(from)?.1.names.get(name) {
                    _ if self.modules.contains_key(&child) => child,
                    Some(used) if depth > 0 && used[0] != *name => {
                        return self.resolve(from, &[used.as_slice(), rest].concat(), depth - 1);
                    }
                    _ => return None,
                }
            }
        };
        while let Some((name, after)) = rest.split_first() {
            let child = [at.as_slice(), std::slice::from_ref(name)].concat();
            if name == "super" {
                at.pop();
            } else if self.modules.contains_key(&child) {
                at = child;
            } else {
                let used = self.modules[&at].1.names.get(name).filter(|used| depth > 0 && used.as_slice() != path);
                let beyond = used.map(|used| self.resolve(&at, &[used.as_slice(), after].concat(), depth - 1));
                // A name of another crate that stands here under `use` is no import of this file.
                return beyond.unwrap_or(Some(at));
            }
            rest = after;
        }
        Some(at)
    }

    /// From file to file, with the line. What a module's own file holds is common to the modules inside it, so that
    /// they may use it.
    fn edges(&self) -> Vec<(PathBuf, usize, PathBuf)> {
        let mut edges = Vec::new();
        for (module, (file, source)) in &self.modules {
            for import in &source.imports {
                let found = self.resolve(module, &import.path, 8).filter(|to| !module.starts_with(to));
                edges.extend(found.map(|to| (file.clone(), import.line, self.modules[&to].0.clone())));
            }
        }
        edges
    }
}

/// Libraries and programs of a package.
fn targets(package: &Path) -> Vec<Target> {
    let mut fronts = vec![package.join("src/lib.rs"), package.join("src/main.rs")];
    if let Ok(programs) = std::fs::read_dir(package.join("src/bin")) {
        fronts.extend(programs.map(|program| program.unwrap().path().join("main.rs")));
    }
    fronts.iter().filter(|front| front.is_file()).map(|front| Target::read(front)).collect()
}

/// Groups of files that can be reached from each other.
fn circles(edges: &[(PathBuf, usize, PathBuf)]) -> BTreeSet<BTreeSet<PathBuf>> {
    let mut next: BTreeMap<&PathBuf, BTreeSet<&PathBuf>> = BTreeMap::new();
    for (from, _, to) in edges {
        next.entry(from).or_default().insert(to);
    }
    let mut reached: BTreeMap<&PathBuf, BTreeSet<&PathBuf>> = BTreeMap::new();
    for from in next.keys() {
        let (found, mut open) = (reached.entry(from).or_default(), vec![*from]);
        while let Some(file) = open.pop() {
            open.extend(next.get(file).into_iter().flatten().filter(|to| found.insert(to)));
        }
    }
    let group = |file| -> BTreeSet<PathBuf> {
        let back = |to: &&&PathBuf| reached.get(**to).is_some_and(|reached| reached.contains(file));
        reached[file].iter().filter(back).map(|to| (*to).clone()).collect()
    };
    reached.keys().map(|file| group(*file)).filter(|group| group.len() > 1).collect()
}

/// The rows of the table of `ARCHITECTURE.md` below a heading, each the names in backticks of its cells.
fn table(heading: &str) -> Vec<Vec<Vec<String>>> {
    let text = text("ARCHITECTURE.md");
    let (_, after) = text.split_once(&format!("## {heading}\n")).unwrap_or_else(|| panic!("no heading {heading}"));
    let lines = after.lines().skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
    let names = |cell: &str| cell.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    let rows: Vec<Vec<Vec<String>>> =
        lines.skip(2).map(|line| line.trim_matches('|').split('|').map(names).collect()).collect();
    assert!(!rows.is_empty(), "{heading}: no table");
    rows
}

/// Folder of each package of the table, by its name.
fn packages() -> BTreeMap<String, PathBuf> {
    let rows = table("Crates").into_iter();
    rows.map(|row| (row[0][0].clone(), root().join(&row[1][0]))).collect()
}

#[test]
fn crates_import_what_the_page_says() {
    let packages = packages();
    let members = text("Cargo.toml");
    let members = members.split_once("members = [").unwrap().1.split_once(']').unwrap().0;
    for member in members.split('"').skip(1).step_by(2) {
        let folder = root().join(member);
        assert!(
            packages.values().any(|known| known.components().eq(folder.components())),
            "ARCHITECTURE.md lacks the crate in {member}"
        );
    }
    for row in table("Crates") {
        let manifest = packages[&row[0][0]].join("Cargo.toml");
        let text = text(&manifest);
        let (mut section, mut found) = ("", [BTreeSet::new(), BTreeSet::new()]);
        for line in text.lines() {
            let name = line.split(['.', '=', ' ']).next().unwrap_or_default();
            if line.starts_with('[') {
                section = line.trim_matches(['[', ']']);
            } else if section.ends_with("dependencies")
                && !section.starts_with("workspace")
                && packages.contains_key(name)
            {
                found[usize::from(section.starts_with("dev-"))].insert(name.to_owned());
            }
        }
        for (found, said) in found.iter().zip(&row[2..]) {
            assert_eq!(*found, said.iter().cloned().collect(), "{}: found, said in ARCHITECTURE.md", shown(&manifest));
        }
    }
}

#[test]
fn folders_import_only_earlier_ones() {
    let mut order: HashMap<String, usize> = HashMap::new();
    for (place, row) in table("Folders of `src/`").into_iter().enumerate() {
        order.extend(row[0].iter().map(|folder| (folder.clone(), place)));
    }
    let source = root().join("src");
    let folder_of = |file: &Path| {
        let inside = file.strip_prefix(&source).unwrap();
        (inside.components().count() > 1).then(|| inside.iter().next().unwrap().to_str().unwrap().to_owned())
    };
    let mut wrong = Vec::new();
    let mut seen = BTreeSet::new();
    for (from, line, to) in targets(&root()).iter().flat_map(Target::edges) {
        // What stands at the top is common to all; the front page only re-exports.
        let (Some(folder), Some(other)) = (folder_of(&from), folder_of(&to)) else { continue };
        let place =
            |folder: &String| *order.get(folder).unwrap_or_else(|| panic!("ARCHITECTURE.md lacks src/{folder}"));
        seen.extend([folder.clone(), other.clone()]);
        if folder != other && place(&folder) <= place(&other) {
            wrong.push(format!("{}:{line}: imports src/{other}", shown(&from)));
        }
    }
    wrong.sort();
    wrong.dedup();
    assert!(wrong.is_empty(), "src/ reads from filter to bin:\n{}", wrong.join("\n"));
    assert!(seen.len() >= 6, "{seen:?}");
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let known: BTreeSet<String> = KNOWN_CIRCLES.iter().map(|file| (*file).to_owned()).collect();
    let (mut found, mut texts) = (BTreeSet::new(), Vec::new());
    for package in packages().values() {
        for edges in targets(package).iter().map(Target::edges) {
            for circle in circles(&edges) {
                let inside = edges.iter().filter(|(from, _, to)| circle.contains(from) && circle.contains(to));
                let lines: BTreeSet<String> =
                    inside.map(|(from, line, to)| format!("  {}:{line}: imports {}", shown(from), shown(to))).collect();
                let files: BTreeSet<String> = circle.iter().map(|file| shown(file)).collect();
                if !files.is_subset(&known) {
                    texts.push(format!("{} files:\n{}", files.len(), lines.into_iter().collect::<Vec<_>>().join("\n")));
                }
                found.extend(files);
            }
        }
    }
    assert!(texts.is_empty(), "{} circles:\n{}", texts.len(), texts.join("\n"));
    let gone: Vec<&String> = known.difference(&found).collect();
    assert!(gone.is_empty(), "in no circle any more, to be struck off: {gone:?}");
}

/// What may have one name in several modules: the arguments of each command, each candidate of the gap workflow.
const ONE_A_MODULE: &[&str] = &["Arguments", "This"];

#[test]
fn no_two_types_of_a_crate_share_a_name() {
    let mut shared = Vec::new();
    for (package, folder) in packages() {
        for target in targets(&folder) {
            let mut places: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
            for (file, source) in target.modules.values() {
                // One board of several is in an image.
                if package == "rundown" && file.starts_with(root().join("src/board")) {
                    continue;
                }
                for name in source.types.iter().filter(|name| !ONE_A_MODULE.contains(&name.as_str())) {
                    places.entry(name).or_default().insert(shown(file));
                }
            }
            let several = places.into_iter().filter(|(_, files)| files.len() > 1);
            shared.extend(several.map(|(name, files)| format!("{name}: {}", Vec::from_iter(files).join(", "))));
        }
    }
    assert!(shared.is_empty(), "one name, one type:\n{}", shared.join("\n"));
}

#[test]
fn a_circle_is_seen() {
    let edge = |from: &str, to: &str| (PathBuf::from(from), 1, PathBuf::from(to));
    let edges = [edge("a", "b"), edge("b", "c"), edge("c", "a"), edge("c", "d"), edge("e", "d")];
    let expected: BTreeSet<PathBuf> = ["a", "b", "c"].into_iter().map(PathBuf::from).collect();
    assert_eq!(circles(&edges), BTreeSet::from([expected]));
    assert!(circles(&edges[1..]).is_empty());
    let mut source = Source::default();
    let text = "use crate::a::{b, c as d}; fn f() { super::g::h(); println!(\"{}\", self::i::j()); } #[cfg(test)] mod t { use crate::k; }";
    source.visit_file(&syn::parse_file(text).unwrap());
    let mut found: Vec<String> = source.imports.iter().map(|import| import.path.join("::")).collect();
    found.sort();
    assert_eq!(found, ["crate::a::b", "crate::a::c", "self::i::j", "super::g::h"]);
}

#[test]
fn a_type_of_a_macro_is_seen() {
    let mut source = Source::default();
    let text = "errors! { pub enum A { B } } macro_rules! m { ($N:ident) => { struct $N; struct C; } } plain! { struct D { e } }";
    source.visit_file(&syn::parse_file(text).unwrap());
    assert_eq!(source.types, ["A", "C"]);
}
