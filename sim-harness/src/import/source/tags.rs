//! Names with paths, as of signals, `VEH1.TRC.SpeedAct`, or of keys in objects, `gps.lat`: the last part says what it
//! is.
//!
//! A name that is known as it stands goes first. Of several tags with the same last part those count that have most of
//! their path in common with the place or the speed, as those of one vehicle have; what two tags of one vehicle say is
//! nobody's to choose.

use super::row::Header;
use crate::import::meaning::{Meaning, plain};

/// Words in a path or a name that make a speed or a location another one than that of the train: what is asked for,
/// what is allowed, and what else moves.
const OTHERS: &str = "set|setpoint|soll|sollwert|target|ziel|limit|max|maximum|min|minimum|permitted|allowed|zulassig|\
                      demand|demanded|required|ref|reference|cmd|command|desired|ceiling|advised|advisory|recommended|\
                      vorgabe|vmax|vsoll|vzul|vlim|vset|vtarget|vziel|sollgeschwindigkeit|zielgeschwindigkeit|\
                      vorgabegeschwindigkeit|hochstgeschwindigkeit|maxima|maximale|massima|consigne|cible|limite|\
                      consigna|objetivo|obiettivo|dest|destination|next|last|wind|fan|engine|motor|door|blower|\
                      compressor|pump|rotor|luefter|lufter|turbine|camera";

/// So many speeds are compared with as many places.
const MOST_PAIRED: usize = 200;

/// A tag of which the last part, or all, is known.
struct Tag {
    /// What stands before the last part; nothing where the whole name is known.
    path: Vec<String>,
    header: Header,
    meaning: Meaning,
}

/// A speed or a location of this name is asked for or allowed, or of another thing: none of the train.
pub fn is_of_another(name: &str) -> bool {
    let words = plain(&apart(name));
    words.split(' ').any(|word| OTHERS.split('|').any(|other| other == word))
}

/// `SpeedAct` as `Speed Act`.
fn apart(name: &str) -> String {
    let mut apart = String::new();
    for (at, letter) in name.char_indices() {
        if letter.is_uppercase() && name[..at].ends_with(char::is_lowercase) {
            apart.push(' ');
        }
        apart.push(letter);
    }
    apart
}

impl Tag {
    fn of(whole: &Header) -> Option<Self> {
        if let Some(meaning) = Meaning::of_name(&whole.name) {
            return Some(Self { path: Vec::new(), header: whole.clone(), meaning });
        }
        let is_of_another = is_of_another(&whole.written);
        // Before a unit: it may have a slash.
        let name = if whole.unit.is_some() { &whole.name } else { &whole.written };
        let parts: Vec<&str> = name.split(['.', '/', '\\', ':', '|']).map(str::trim).collect();
        let (last, before) = parts.split_last()?;
        let of_two = before.last().map_or(String::new(), |before| format!("{before} {last}"));
        // `Lok17_Weg`, but no `target_speed`.
        let numbered = last.split_once('_').filter(|(before, _)| before.ends_with(|c: char| c.is_ascii_digit()));
        let (number, of_number) = numbered.unwrap_or_default();
        let spelled = [(*last, ""), (&apart(last), ""), (&of_two, ""), (of_number, number)];
        spelled.into_iter().find_map(|(name, number)| {
            let mut header = Header::new(name);
            let moves = |meaning: &Meaning| matches!(meaning, Meaning::Speed | Meaning::Location);
            let meaning = Meaning::of_name(&header.name).filter(|meaning| !(is_of_another && moves(meaning)))?;
            header.unit = whole.unit.clone().or(header.unit);
            header.written.clone_from(&whole.written);
            let path = before.iter().chain([&number]).filter(|part| !part.is_empty());
            Some(Self { path: path.map(|part| (*part).to_owned()).collect(), header, meaning })
        })
    }

    /// The vehicle, where there are several.
    fn root(&self) -> Option<&String> {
        self.path.first()
    }

    /// How much of their paths is the same, and how short they are.
    fn nearness(&self, other: Option<&Self>) -> (usize, isize) {
        let others = other.map_or(&[][..], |other| &other.path);
        let common = self.path.iter().zip(others).take_while(|(a, b)| a == b).count();
        (common, -((self.path.len() + others.len()) as isize))
    }
}

/// Gives tags the name of their last part.
pub fn name(headers: &mut [Header]) {
    let tags: Vec<Option<Tag>> = headers.iter().map(Tag::of).collect();
    let of = |meaning: Meaning| -> Vec<usize> {
        let all = tags
            .iter()
            .enumerate()
            .filter_map(|(i, tag)| Some((i, tag.as_ref().filter(|tag| tag.meaning == meaning)?)));
        let all: Vec<(usize, &Tag)> = all.collect();
        let is_whole = all.iter().any(|(_, tag)| tag.path.is_empty());
        all.into_iter().filter(|(_, tag)| tag.path.is_empty() == is_whole).map(|(i, _)| i).collect()
    };
    let place = [Meaning::Location, Meaning::Latitude].into_iter().find(|meaning| !of(*meaning).is_empty());
    let (speeds, places) = (of(Meaning::Speed), place.map(of).unwrap_or_default());
    let or_none = |found: &[usize]| -> Vec<Option<usize>> {
        let some = found.iter().take(MOST_PAIRED).copied().map(Some);
        if found.is_empty() { vec![None] } else { some.collect() }
    };
    let tag = |index: Option<usize>| index.and_then(|index| tags[index].as_ref());
    let places_or_none = or_none(&places);
    let pairs = or_none(&speeds).into_iter().flat_map(|speed| places_or_none.iter().map(move |place| [speed, *place]));
    let near = |pair: &[Option<usize>; 2]| {
        let [a, b] = pair.map(tag);
        a.or(b).map_or((0, 0), |one| one.nearness(if a.is_some() { b } else { None }))
    };
    let pairs: Vec<[Option<usize>; 2]> = pairs.collect();
    let Some(best) = pairs.iter().map(near).max() else { return };
    let best: Vec<[Option<usize>; 2]> = pairs.into_iter().filter(|pair| near(pair) == best).collect();
    let chosen = best[0];
    let root = chosen.iter().find_map(|index| tag(*index)?.root());
    let is_chosen = |side: usize| {
        let is_rival = |pair: &[Option<usize>; 2]| {
            pair[side] != chosen[side] && tag(pair[side]).and_then(Tag::root) == tag(chosen[side]).and_then(Tag::root)
        };
        chosen[side].filter(|_| !best.iter().any(is_rival))
    };
    let mut named: Vec<usize> = (0..2).filter_map(is_chosen).collect();
    for meaning in Meaning::ALL.into_iter().filter(|meaning| *meaning != Meaning::Speed && Some(*meaning) != place) {
        let all = of(meaning);
        let of_root = all.iter().find(|index| tag(Some(**index)).is_some_and(|tag| tag.root() == root));
        named.extend(of_root.or(all.first()));
    }
    for index in named {
        if let Some(tag) = &tags[index] {
            headers[index] = tag.header.clone();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which of these tags have the speed and the location.
    fn found(tags: &[&str]) -> [Option<usize>; 2] {
        let mut headers: Vec<Header> = tags.iter().map(|tag| Header::new(tag)).collect();
        name(&mut headers);
        let names: Vec<String> = headers.iter().map(|header| header.name.clone()).collect();
        let meanings = Meaning::of_names(&names);
        [Meaning::Speed, Meaning::Location]
            .map(|meaning| meanings.iter().find(|(found, _)| *found == meaning).map(|(_, index)| *index))
    }

    #[test]
    fn the_last_part_of_a_path_says_what_it_is() {
        assert_eq!(found(&["VEH1.TRC.SpeedAct", "VEH1.ODO.Location"]), [Some(0), Some(1)]);
        assert_eq!(found(&["T1/Weg [km]", "T1/Geschwindigkeit [km/h]"]), [Some(1), Some(0)]);
        assert_eq!(found(&["Lok17_Geschwindigkeit", "Lok17_Weg"]), [Some(0), Some(1)]);
        assert_eq!(found(&["T1.Speed.Act", "T1.location_m"]), [Some(0), Some(1)]);
        assert_eq!(found(&["odo", "limit.speed", "speed"]), [Some(2), Some(0)]);
    }

    #[test]
    fn what_is_asked_for_and_what_else_moves_is_no_speed_of_the_train() {
        for other in
            ["Target/Speed", "T1.Set.Speed", "T1.Speed.Set", "T1.TargetSpeed", "T1.Limit.Speed", "T1.Fan.Speed"]
        {
            assert_eq!(found(&[other, "T1.Location"]), [None, Some(1)], "{other}");
            assert_eq!(found(&[other, "T1.Act.Speed", "T1.Location"]), [Some(1), Some(2)], "{other}");
        }
        // Neither says which of them it is.
        assert_eq!(found(&["T1.A.Speed", "T1.B.Speed", "T1.Location"]), [None, Some(2)]);
        assert_eq!(found(&["T1.ATO.Speed", "T1.Speed", "T1.Location"]), [Some(1), Some(2)]);
    }

    #[test]
    fn speed_and_location_are_those_of_one_vehicle() {
        assert_eq!(found(&["4022.Location", "4021.Speed", "4021.Location", "4022.Speed"]), [Some(1), Some(2)]);
        assert_eq!(found(&["Lok2_Weg", "Lok1_Weg", "Lok1_v", "Lok2_v"]), [Some(2), Some(1)]);
    }
}
