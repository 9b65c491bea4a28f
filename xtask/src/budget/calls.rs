//! Who calls whom in an image: callers of `core::panicking`, the deepest stack, and what smells of a heap.

use super::thumb::{Step, steps};
use emulator::Image;
use rustc_demangle::demangle;
use std::collections::{BTreeMap, BTreeSet};

/// Functions whose call of a panic cannot be reached: the log's own check that it is not entered twice (only the
/// firmware's log lines come there, the library has none).
const NEVER: [&str; 2] = ["_defmt_acquire", "_defmt_release"];

/// A function of the image.
pub struct Function {
    /// Without its hash.
    pub name: String,
    /// Bytes of code.
    pub size: u64,
    /// Bytes of stack that it takes itself.
    pub frame: u64,
    /// Where it goes while its frame is there.
    calls: BTreeSet<u64>,
    /// Where it goes when its frame is gone.
    instead: BTreeSet<u64>,
    /// A frame or a call whose size or target is known only when it runs.
    pub unknown: bool,
}

/// All functions by their address.
pub struct Graph(BTreeMap<u64, Function>);

/// The deepest path of calls from some function.
#[derive(Clone, Debug, Default)]
pub struct Deepest {
    /// Bytes.
    pub bytes: u64,
    /// Functions on the path with their frames.
    pub path: Vec<(String, u64)>,
    /// Functions that may come back to themselves, so that there is no bound.
    pub recursive: BTreeSet<String>,
    /// Functions on any path with a call or a frame that stands in a register.
    pub unknown: BTreeSet<String>,
}

impl Graph {
    /// Reads the code.
    pub fn read(image: &Image) -> Self {
        let (at, code) = (image.code.0, &image.code.1);
        let mut marks: Vec<(u64, bool)> = image
            .symbols()
            .filter(|(name, ..)| name.starts_with("$d") || name.starts_with("$t"))
            .map(|(name, address, _)| (address & !1, name.starts_with("$t")))
            .collect();
        marks.sort_unstable();
        let symbols: BTreeMap<u64, (String, u64)> = image
            .symbols()
            .filter(|(_, address, size)| *size > 0 && (at..at + code.len() as u64).contains(address))
            .map(|(name, address, size)| (address & !1, (plain(name), size)))
            .collect();
        let functions = symbols.iter().map(|(&start, (name, size))| {
            let mut function = Function {
                name: name.clone(),
                size: *size,
                frame: 0,
                calls: BTreeSet::new(),
                instead: BTreeSet::new(),
                unknown: false,
            };
            let bytes = |from: u64, to: u64| code.get((from - at) as usize..(to - at) as usize).unwrap_or_default();
            let mut constants_from = start;
            for (from, to) in pieces(&marks, start, start + size) {
                function.may_call(bytes(constants_from, from), &symbols);
                for step in steps(bytes(from, to), from) {
                    function.take(step, start, &symbols);
                }
                constants_from = to;
            }
            function.may_call(bytes(constants_from, start + size), &symbols);
            (start, function)
        });
        Self(functions.collect())
    }

    /// The functions.
    pub fn functions(&self) -> impl Iterator<Item = &Function> {
        self.0.values()
    }

    /// Functions that contain a call of something in `core::panicking`.
    pub fn to_panics(&self) -> Vec<String> {
        // A method of an option or a result that may panic calls a function beside it.
        let is_method =
            |name: &str| name.starts_with("core::option::Option<") || name.starts_with("core::result::Result<");
        let is_panic = |name: &str| {
            name.starts_with("core::panicking::")
                || name.starts_with("core::option::")
                || name.starts_with("core::result::")
                || name.starts_with("core::slice::index::")
        };
        let is_panic = |name: &str| is_panic(name) && !is_method(name);
        let mut doomed: BTreeSet<u64> =
            self.0.iter().filter(|(_, function)| is_panic(&function.name)).map(|(&at, _)| at).collect();
        let mut callers = BTreeSet::new();
        // Again with what the compiler's outliner has taken out of functions, until nothing new comes.
        loop {
            let before = doomed.len();
            for (&at, function) in &self.0 {
                let mut goes = function.calls.union(&function.instead);
                if is_panic(&function.name) || !goes.any(|to| doomed.contains(to)) {
                    continue;
                }
                if function.name.starts_with("OUTLINED_FUNCTION") {
                    doomed.insert(at);
                } else if !NEVER.contains(&function.name.as_str()) {
                    callers.insert(function.name.clone());
                }
            }
            if doomed.len() == before {
                return callers.into_iter().collect();
            }
        }
    }

    /// Bytes of code of a function and of all that it may call.
    pub fn code_below(&self, name: &str) -> Option<u64> {
        let (&start, _) = self.0.iter().find(|(_, function)| function.name == name)?;
        let (mut found, mut open) = (BTreeSet::new(), vec![start]);
        while let Some(at) = open.pop() {
            if let Some(function) = self.0.get(&at).filter(|_| found.insert(at)) {
                open.extend(function.calls.union(&function.instead));
            }
        }
        Some(found.iter().map(|at| self.0[at].size).sum())
    }

    /// The deepest stack below a function, itself included. Every path through the calls counts, whether it can be
    /// taken or not.
    pub fn deepest(&self, name: &str) -> Option<Deepest> {
        let (&start, _) = self.0.iter().find(|(_, function)| function.name == name)?;
        let mut known = BTreeMap::new();
        let mut all = Deepest::default();
        let (bytes, path) = self.below(start, &mut Vec::new(), &mut known, &mut all);
        Some(Deepest { bytes, path, ..all })
    }

    fn below(&self, at: u64, open: &mut Vec<u64>, known: &mut BTreeMap<u64, Below>, all: &mut Deepest) -> Below {
        let Some(function) = self.0.get(&at) else {
            return (0, Vec::new());
        };
        if let Some(found) = known.get(&at) {
            return found.clone();
        }
        if open.contains(&at) {
            all.recursive.insert(function.name.clone());
            return (0, Vec::new());
        }
        if function.unknown {
            all.unknown.insert(function.name.clone());
        }
        open.push(at);
        let mut deepest = (0, Vec::new());
        for &to in &function.calls {
            let found = self.below(to, open, known, all);
            if found.0 > deepest.0 {
                deepest = found;
            }
        }
        deepest.0 += function.frame;
        deepest.1.insert(0, (function.name.clone(), function.frame));
        for &to in &function.instead {
            let found = self.below(to, open, known, all);
            if found.0 > deepest.0 {
                deepest = found;
            }
        }
        open.pop();
        known.insert(at, deepest.clone());
        deepest
    }
}

/// Bytes and path below a function.
type Below = (u64, Vec<(String, u64)>);

impl Function {
    fn take(&mut self, step: Step, start: u64, symbols: &BTreeMap<u64, (String, u64)>) {
        match step {
            // All of them: a function has one entry, so this is what is taken, or more where only a part of it is.
            Step::Takes(bytes) => self.frame += bytes,
            Step::TakesUnknown | Step::CallsUnknown => self.unknown = true,
            Step::Calls(to) => {
                self.calls.insert(to);
            }
            Step::Jumps(to) => {
                let inside = (start..start + self.size).contains(&to);
                if !inside && symbols.contains_key(&to) {
                    self.instead.insert(to);
                }
            }
        }
    }

    /// Addresses of functions among its constants: what is called three times in a row, the compiler calls through a
    /// register, which is shorter.
    fn may_call(&mut self, constants: &[u8], symbols: &BTreeMap<u64, (String, u64)>) {
        let words = constants.chunks_exact(4).filter_map(|word| Some(u32::from_le_bytes(word.try_into().ok()?)));
        // The lowest bit of an address says that it is of Thumb code.
        let functions = words.filter(|word| word % 2 == 1).map(|word| u64::from(word - 1));
        self.calls.extend(functions.filter(|to| symbols.contains_key(to)));
    }
}

/// The stretches of code between the constants, by the linker's marks.
fn pieces(marks: &[(u64, bool)], start: u64, end: u64) -> Vec<(u64, u64)> {
    let first = marks.partition_point(|(at, _)| *at <= start);
    let mut is_code = first.checked_sub(1).and_then(|before| marks.get(before)).is_none_or(|(_, is_code)| *is_code);
    let mut from = start;
    let mut pieces = Vec::new();
    for &(at, next_is_code) in marks.iter().skip(first).take_while(|(at, _)| *at < end) {
        if is_code {
            pieces.push((from, at));
        }
        (from, is_code) = (at, next_is_code);
    }
    if is_code {
        pieces.push((from, end));
    }
    pieces
}

/// Symbols of an allocator.
pub fn allocators(image: &Image) -> Vec<String> {
    image
        .symbols()
        .map(|(name, ..)| plain(name))
        .filter(|name| name.contains("__rust_alloc") || name.contains("__rg_alloc") || name.starts_with("alloc::"))
        .collect()
}

/// The name without its hash.
fn plain(name: &str) -> String {
    format!("{:#}", demangle(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_between_the_code_are_left_out() {
        let marks = [(0, true), (10, false), (14, true), (30, false)];
        assert_eq!(pieces(&marks, 0, 20), [(0, 10), (14, 20)]);
        assert_eq!(pieces(&marks, 16, 30), [(16, 30)]);
        assert_eq!(pieces(&marks, 12, 14), []);
        assert_eq!(pieces(&[], 2, 6), [(2, 6)]);
    }

    fn function(name: &str, frame: u64, calls: &[u64], instead: &[u64]) -> Function {
        Function {
            name: name.to_owned(),
            size: 2,
            frame,
            calls: calls.iter().copied().collect(),
            instead: instead.iter().copied().collect(),
            unknown: false,
        }
    }

    #[test]
    fn a_function_whose_address_is_a_constant_may_be_called() {
        let symbols = BTreeMap::from([(0x0800_0100, ("called".to_owned(), 8)), (0x0800_0200, ("data".to_owned(), 8))]);
        let mut caller = function("caller", 0, &[], &[]);
        let constants = [0x0800_0101_u32, 0x0800_0200, 0x0800_0301, 7].map(u32::to_le_bytes);
        caller.may_call(constants.as_flattened(), &symbols);
        assert_eq!(caller.calls, BTreeSet::from([0x0800_0100]));
    }

    #[test]
    fn the_deepest_path_counts_frames_that_are_there_together() {
        let graph = Graph(BTreeMap::from([
            (0, function("start", 10, &[2, 4], &[6])),
            (2, function("leaf", 30, &[], &[])),
            (4, function("middle", 5, &[2], &[])),
            (6, function("instead", 44, &[], &[])),
            (8, function("again", 1, &[8], &[])),
        ]));
        let found = graph.deepest("start").unwrap();
        // start + middle + leaf = 45, more than what comes in place of start.
        assert_eq!(found.bytes, 45);
        let names: Vec<&str> = found.path.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["start", "middle", "leaf"]);
        assert!(found.recursive.is_empty());
        assert!(graph.deepest("again").unwrap().recursive.contains("again"));
        // start, leaf, middle, instead: each once.
        assert_eq!(graph.code_below("start"), Some(8));
        assert_eq!(graph.code_below("again"), Some(2));
        assert_eq!(graph.code_below("nobody"), None);
    }

    #[test]
    fn a_panic_behind_an_outlined_function_is_its_callers() {
        let graph = Graph(BTreeMap::from([
            (0, function("core::panicking::panic_fmt", 0, &[], &[])),
            (2, function("OUTLINED_FUNCTION_1", 0, &[], &[4])),
            (4, function("OUTLINED_FUNCTION_2", 0, &[], &[0])),
            (6, function("caller", 0, &[2], &[])),
            (8, function("other", 0, &[6], &[])),
        ]));
        assert_eq!(graph.to_panics(), ["caller"]);
    }
}
