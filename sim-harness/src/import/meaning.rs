//! What a column means, by the name in its header: the words that recorders use in five languages.

use serde::{Deserialize, Serialize};

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Meaning {
    Time,
    Date,
    Location,
    Speed,
    Latitude,
    Longitude,
    Altitude,
    Effort,
    /// Of the brakes, in a column beside that of the traction.
    Braking,
    Temperature,
    Headwind,
    SpeedIsComputed,
    Unit,
    Run,
}

/// Columns of one dimension have the same units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    Time,
    Length,
    Speed,
    Angle,
    /// Over the rotating mass.
    Force,
    Temperature,
}

impl Meaning {
    pub const ALL: [Self; 14] = [
        Self::Time,
        Self::Date,
        Self::Location,
        Self::Speed,
        Self::Latitude,
        Self::Longitude,
        Self::Altitude,
        Self::Effort,
        Self::Braking,
        Self::Temperature,
        Self::Headwind,
        Self::SpeedIsComputed,
        Self::Unit,
        Self::Run,
    ];

    /// What it is measured in; none: words.
    pub const fn dimension(self) -> Option<Dimension> {
        match self {
            Self::Time => Some(Dimension::Time),
            Self::Location | Self::Altitude => Some(Dimension::Length),
            Self::Speed | Self::Headwind => Some(Dimension::Speed),
            Self::Latitude | Self::Longitude => Some(Dimension::Angle),
            Self::Effort | Self::Braking => Some(Dimension::Force),
            Self::Temperature => Some(Dimension::Temperature),
            Self::Date | Self::SpeedIsComputed | Self::Unit | Self::Run => None,
        }
    }

    /// A position on Earth.
    pub const fn is_angle(self) -> bool {
        matches!(self.dimension(), Some(Dimension::Angle))
    }

    /// In units of a speed.
    pub const fn is_speed(self) -> bool {
        matches!(self.dimension(), Some(Dimension::Speed))
    }

    /// A force, which a mass divides.
    pub const fn is_force(self) -> bool {
        matches!(self.dimension(), Some(Dimension::Force))
    }

    /// The key in `import.toml`.
    pub fn key(self) -> &'static str {
        self.words().next().unwrap_or_default()
    }

    /// Words for it, the key first: the more usual ones earlier.
    fn words(self) -> impl Iterator<Item = &'static str> {
        let words = match self {
            Self::Time => {
                "time|timestamp|datetime|date time|date and time|date heure|fecha hora|data ora|zeit|uhrzeit|\
                 zeitstempel|datum uhrzeit|datum zeit|heure|temps|horodatage|hora|tiempo|ora|tempo|t|utc|gps time|utc time|\
                 local time|epoch|event time|log time|sample time|recording time|seconds|sekunden|ts|created at|elapsed|\
                 elapsed time|fecha y hora|data e ora|tijd|datum en tijd|cas|datum a cas|godzina|czas|data i godzina|tid|\
                 datum och tid|datum tijd|tijdstip|data i czas|znacznik czasu|tidpunkt|tidspunkt|tidsstampel|tidsstempel|\
                 klockslag|zeitpunkt|aufzeichnungszeit|klokkeslett|klokkeslaet|casova znacka|aika|kellonaika|ido|idopont"
            }
            Self::Date => "date|datum|tag|jour|fecha|data|giorno|day|dato|paivamaara|paivays",
            Self::Location => {
                "location|chainage|odometer|distance|mileage|position|milepost|odo|track position|line km|\
                 track km|weg|wegstrecke|strecke|streckenkilometer|kilometrierung|fahrweg|wegmesser|\
                 kilometerstand|ort|pk|point kilometrique|odometre|distance parcourue|distancia|\
                 punto kilometrico|odometro|posicion|ubicacion|distanza|progressiva|posizione|chilometrica|\
                 progressiva chilometrica|s|x|km|dist|distance travelled|distance traveled|travelled distance|\
                 strecken|strecken km|strecken kilometer|bahn km|bahnkilometer|km stand|kilometer|kilometre|\
                 kilometros|chilometri|line kilometre|line kilometer|kilometrering|afstand|draha|droga|vag|stracka|\
                 afgelegde afstand|kilometerpunt|positie|przebieg|kilometr|kilometraz|polozenie|ujeta draha|poloha|\
                 staniceni|vzdalenost|avstand|lage|strekning|straekning|posisjon|tilbakelagt vei|tilbagelagt vej|matka|\
                 kuljettu matka|sijainti|megtett ut|szelveny"
            }
            Self::Speed => {
                "speed|velocity|v|geschwindigkeit|v ist|ist geschwindigkeit|fahrgeschwindigkeit|tempo kmh|\
                 vitesse|velocidad|velocita|speed over ground|ground speed|gps speed|spd|v act|actual speed|\
                 train speed|vehicle speed|speed act|act speed|speed actual|v actual|speedometer|snelheid|rijsnelheid|rychlost|predkosc|hastighet|hastighed|fart|nopeus|\
                 sebesseg"
            }
            Self::Latitude => {
                "latitude|lat|breite|breitengrad|geografische breite|latitud|latitudine|gps lat|gps latitude|\
                 y wgs84"
            }
            Self::Longitude => {
                "longitude|lon|lng|long|lange|laenge|langengrad|laengengrad|geografische lange|longitud|\
                 longitudine|gps lon|gps long|gps longitude|x wgs84"
            }
            Self::Altitude => {
                "altitude|alt|elevation|ele|height|hohe|hoehe|seehohe|altitud|elevacion|altura|altitudine|quota|\
                 gps altitude"
            }
            Self::Effort => {
                "effort|tractive effort|traction force|force|zugkraft|zugkraft bremskraft|kraft|zug bremskraft|\
                 zug und bremskraft|tractive braking effort|traction braking effort|traction brake effort|\
                 effort de traction|effort traction|esfuerzo|esfuerzo de traccion|sforzo|sforzo di trazione|\
                 applied effort|zugkraft masse|zugkraft je masse|zugkraft pro masse|spezifische zugkraft|\
                 effort mass|force mass|specific effort|specific tractive effort|effort masse"
            }
            Self::Braking => {
                "braking|brake force|braking force|brake effort|braking effort|bremskraft|bremskraft masse|\
                 bremskraft je masse|bremskraft pro masse|spezifische bremskraft|dynamic brake effort|\
                 electric brake effort|electric brake force|elektrische bremskraft|ed bremskraft|\
                 effort de freinage|force de freinage|fuerza de freno|fuerza de frenado|esfuerzo de frenado|\
                 forza frenante|sforzo di frenatura|brake force mass|braking force mass|specific brake force"
            }
            Self::Temperature => {
                "temperature|ambient temperature|outside temperature|temperatur|aussentemperatur|\
                 temperature exterieure|temperatura|temperatura exterior|temperatura esterna|temp"
            }
            Self::Headwind => "headwind|gegenwind|vent contraire|viento en contra|vento contrario",
            Self::SpeedIsComputed => "speed is computed",
            Self::Unit => {
                "unit|vehicle|train unit|locomotive|loco|loco no|train set|einheit|fahrzeug|lok|loknummer|\
                 fahrzeugnummer|triebzug|rame|engin|locomotora|vehiculo|unidad|veicolo|locomotiva|unit id|\
                 vehicle id"
            }
            Self::Run => {
                "run|trip|train|train number|train no|run id|trip id|ride|journey|fahrt|fahrtnummer|zug|\
                 zugnummer|zugnr|train numero|course|trajet|marche|tren|viaje|recorrido|treno|corsa|viaggio|\
                 track"
            }
        };
        words.split('|')
    }

    /// How usual this name is for it: 0 the most, none where it is not its name.
    fn rank(self, name: &str) -> Option<usize> {
        self.words().position(|word| word == name)
    }

    /// What a column of this name, without its unit, holds.
    pub fn of_name(name: &str) -> Option<Self> {
        let name = plain(name);
        Self::ALL.into_iter().find(|meaning| meaning.rank(&name).is_some())
    }

    /// The column of each meaning among these names without their units; a column has one meaning, the more usual name
    /// wins.
    pub fn of_names(names: &[String]) -> Vec<(Self, usize)> {
        let names: Vec<String> = names.iter().map(|name| plain(name)).collect();
        let mut found: Vec<(Self, usize)> = Vec::new();
        for meaning in Self::ALL {
            let ranked = |(index, name): (usize, &String)| Some((meaning.rank(name)?, index));
            if let Some((_, index)) = names.iter().enumerate().filter_map(ranked).min() {
                found.push((meaning, index));
            }
        }
        found
    }
}

/// Small letters without accents; what is neither letter nor digit is one blank.
pub fn plain(name: &str) -> String {
    let letter = |c: char| match c {
        'à' | 'á' | 'â' | 'ä' | 'ã' | 'å' | 'ą' => 'a',
        'è' | 'é' | 'ê' | 'ë' | 'ę' | 'ě' => 'e',
        'ì' | 'í' | 'î' | 'ï' => 'i',
        'ò' | 'ó' | 'ô' | 'ö' | 'õ' | 'ø' | 'ő' => 'o',
        'ù' | 'ú' | 'û' | 'ü' | 'ů' | 'ű' => 'u',
        'ç' | 'č' | 'ć' => 'c',
        'ď' => 'd',
        'ñ' | 'ń' | 'ň' => 'n',
        'ř' => 'r',
        'š' | 'ś' => 's',
        'ť' => 't',
        'ž' | 'ź' | 'ż' => 'z',
        'ý' => 'y',
        'ł' | 'ľ' => 'l',
        c if c.is_alphanumeric() => c,
        _ => ' ',
    };
    let text: String = name.to_lowercase().replace('ß', "ss").replace('æ', "ae").replace('œ', "oe");
    let text: String = text.chars().map(letter).collect();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: &[&str]) -> Vec<(Meaning, usize)> {
        Meaning::of_names(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn headers_of_many_languages_are_recognised() {
        use Meaning::{Location, Speed, Time};
        for names in [
            ["Timestamp", "Odometer", "SPEED"],
            ["Uhrzeit", "Wegstrecke", "Geschwindigkeit"],
            ["Heure", "Point kilométrique", "Vitesse"],
            ["Hora", "Distancia", "Velocidad"],
            ["Ora", "Progressiva", "Velocità"],
            ["Zeit", "Strecken-km", "v-Ist"],
            ["Zeit", "km-Stand", "Geschwindigkeit"],
            ["Uhrzeit", "Kilometer", "v"],
            ["Event Time", "Milepost", "Speed"],
            ["Tijd", "Kilometrering", "Snelheid"],
            ["Čas", "Dráha", "Rychlost"],
            ["Godzina", "Droga", "Prędkość"],
            ["Tid", "Väg", "Hastighet"],
            ["Datum Tijd", "Afgelegde afstand", "Rijsnelheid"],
            ["Znacznik czasu", "Położenie", "Predkosc"],
            ["Datum a čas", "Ujetá dráha", "Rychlost"],
            ["Klockslag", "Läge", "Hastighet"],
            ["Tid", "Strækning", "Hastighed"],
            ["Čas", "Poloha", "Rýchlosť"],
            ["Čas", "Staničení", "Rychlost"],
            ["Aika", "Kuljettu matka", "Nopeus"],
            ["Tidspunkt", "Tilbakelagt vei", "Fart"],
            ["Időpont", "Megtett út", "Sebesség"],
        ] {
            assert_eq!(of(&names), [(Time, 0), (Location, 1), (Speed, 2)], "{names:?}");
        }
    }

    #[test]
    fn the_more_usual_name_wins() {
        assert_eq!(of(&["t", "time", "x", "location"]), [(Meaning::Time, 1), (Meaning::Location, 3)]);
        assert_eq!(of(&["colour"]), []);
    }
}
