//! What the titles on a sheet say: plans, sections, elevations, in many languages.

/// What a title names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Title {
    /// The plan of the ground floor.
    GroundFloor,
    /// Another plan.
    Plan,
    /// A plan of the same rooms that shows something else: ceilings, foundations, services.
    Services,
    /// A roof plan or a site plan: no rooms in it.
    Outside,
    /// What stands small beside the drawings: a legend, a key plan, a title block.
    Beside,
    /// A section, an elevation, a detail, a view in space.
    NoPlan,
    /// No title.
    Unknown,
}

impl Title {
    /// What it adds to a view's claim to be the plan; 1 is what the most walls give.
    pub fn worth(self) -> f64 {
        match self {
            Self::GroundFloor => 1.2,
            Self::Plan => 1.0,
            Self::Services => 0.5,
            Self::Unknown => 0.0,
            Self::Outside => -1.0,
            Self::NoPlan | Self::Beside => -2.0,
        }
    }

    /// In plain words.
    pub fn words(self) -> &'static str {
        match self {
            Self::GroundFloor => "plan of the ground floor",
            Self::Plan => "plan",
            Self::Services => "plan of ceilings, foundations or services",
            Self::Outside => "roof or site plan",
            Self::Beside => "legend, key plan or title block",
            Self::NoPlan => "section, elevation or detail",
            Self::Unknown => "no title",
        }
    }
}

/// Longest text that can be a title; notes are longer.
const TITLE_CHARS_MAX: usize = 60;

/// Phrases by what they name, lower case, in the order of their say; a phrase stands as whole words,
/// those of ideographs anywhere.
const PHRASES: &[(Title, &[&str])] = &[
    (
        Title::NoPlan,
        &[
            "section",
            "sections",
            "detail",
            "details",
            "perspective",
            "schnitt",
            "detailschnitt",
            "coupe",
            "sección",
            "seccion",
            "corte",
            "sezione",
            "alcado",
            "doorsnede",
            "snitt",
            "leikkaus",
            "przekrój",
            "řez",
            "pohled",
            "kesit",
            "разрез",
            "断面",
            "剖面",
            "詳細",
        ],
    ),
    (
        Title::Outside,
        &[
            "roof plan",
            "site plan",
            "dachaufsicht",
            "dachdraufsicht",
            "lageplan",
            "plan de masse",
            "plan toiture",
            "planta de cubierta",
            "planta cubierta",
            "pianta copertura",
            "planta de cobertura",
            "dakplan",
            "takplan",
            "rzut dachu",
            "屋根伏",
            "配置図",
            "屋顶平面",
        ],
    ),
    (
        Title::Beside,
        &[
            "legend",
            "legende",
            "légende",
            "leyenda",
            "leggenda",
            "legenda",
            "key plan",
            "keyplan",
            "plan de repérage",
            "title block",
            "凡例",
            "图例",
        ],
    ),
    (
        Title::Services,
        &[
            "ceiling plan",
            "reflected ceiling",
            "rcp",
            "deckenspiegel",
            "plan de plafond",
            "faux plafond",
            "controsoffitti",
            "foundation plan",
            "footing plan",
            "fundamentplan",
            "plan de fondation",
            "plan de fondations",
            "plan des fondations",
            "planta de cimentación",
            "pianta fondazioni",
            "framing plan",
            "electrical plan",
            "lighting plan",
            "power plan",
            "plumbing plan",
            "mechanical plan",
            "hvac plan",
            "demolition plan",
            "abbruchplan",
            "天井伏",
            "基礎伏",
        ],
    ),
    (
        Title::GroundFloor,
        &[
            "ground floor",
            "ground level",
            "first floor plan",
            "level 0",
            "level 00",
            "erdgeschoss",
            "erdgeschoß",
            "eg",
            "rez-de-chaussée",
            "rez de chaussée",
            "rez-de-chaussee",
            "rdc",
            "planta baja",
            "pb",
            "piano terra",
            "pt",
            "rés-do-chão",
            "res-do-chao",
            "térreo",
            "begane grond",
            "bg",
            "bottenvåning",
            "plan 1",
            "stueplan",
            "stueetage",
            "parter",
            "přízemí",
            "zemin kat",
            "первый этаж",
            "план 1 этажа",
            "1階",
            "１階",
            "一层",
            "首层",
        ],
    ),
    (
        Title::Plan,
        &[
            "floor",
            "floor plan",
            "plan",
            "level",
            "storey",
            "story",
            "basement",
            "grundriss",
            "obergeschoss",
            "untergeschoss",
            "dachgeschoss",
            "og",
            "ug",
            "dg",
            "kg",
            "étage",
            "etage",
            "sous-sol",
            "niveau",
            "planta",
            "plantas",
            "piso",
            "nivel",
            "sótano",
            "pianta",
            "piano",
            "pavimento",
            "verdieping",
            "plattegrond",
            "våning",
            "plan 2",
            "pohja",
            "pohjapiirros",
            "rzut",
            "piętro",
            "půdorys",
            "podlaží",
            "kat planı",
            "план",
            "этаж",
            "平面",
            "階",
            "层平面",
        ],
    ),
];

/// Words that stand in title blocks and in no room.
const TITLE_WORDS: &[&str] = &[
    "scale",
    "drawn",
    "maßstab",
    "massstab",
    "gezeichnet",
    "echelle",
    "échelle",
    "dessiné",
    "escala",
    "dibujado",
    "scala",
    "disegnato",
    "schaal",
    "getekend",
    "масштаб",
    "縮尺",
    "比例",
];

/// Whether a text alone says that what it stands in is a title block: such a word and what it introduces. A stair may
/// be called by one of the words, and a ramp may fall by 1:12.
pub fn is_of_title_block(text: &str) -> bool {
    text.contains([':', '=']) && text.to_lowercase().split_whitespace().any(is_title_word)
}

fn is_title_word(word: &str) -> bool {
    TITLE_WORDS.contains(&word.trim_end_matches([':', '.']))
}

/// Endings of compounds that name sections and elevations, and compounds that do not.
const ENDINGS: &[&str] =
    &["schnitt", "ansicht", "ansichten", "snitt", "doorsnede", "gevel", "fasad", "fasade"];
const NO_SECTIONS: &[&str] = &["abschnitt", "avsnitt"];

/// What an elevation is called by beside `elev`, which is a lift otherwise.
const SIDES: &[&str] =
    &["north", "south", "east", "west", "front", "rear", "back", "side", "left", "right", "street"];

/// What is built, and stands in sections: `RC. FLOOR SLAB`.
const BUILT: &[&str] = &["slab", "slabs"];

/// Words that point to another drawing.
const POINTERS: &[&str] = &["see", "refer", "siehe", "voir", "vedi", "zie"];

/// Whether words of a title, lower case, name a section or an elevation by a compound or by a short form.
fn is_section(words: &[&str]) -> bool {
    let is_compound =
        |w: &&str| ENDINGS.iter().any(|e| w.ends_with(e)) && !NO_SECTIONS.iter().any(|n| w.ends_with(n));
    // `SEC. A-A`, but not the room of a guard.
    let is_cut = |w: &str| match w.split_once('-') {
        Some((a, b)) => a == b && !a.is_empty() && a.chars().count() <= 2,
        None => w.chars().count() == 1,
    };
    let cuts = words.windows(2).any(|w| w[0] == "sec" && is_cut(w[1]));
    let sides = words.contains(&"elev") && words.iter().any(|w| SIDES.contains(w));
    words.iter().any(is_compound) || cuts || sides
}

/// Words of elevations, of their titles and of layers they are drawn on. Those of sections are names of layers in plans too.
const ELEVATIONS: &[&str] = &[
    "elevation",
    "elevations",
    "élévation",
    "facade",
    "façade",
    "ansicht",
    "ansichten",
    "alzado",
    "alzados",
    "fachada",
    "prospetto",
    "prospetti",
    "alçado",
    "gevel",
    "fasad",
    "fasade",
    "julkisivu",
    "elewacja",
    "görünüş",
    "фасад",
];

/// Whether a layer is named after elevations, or a title calls one.
pub fn is_of_elevations(name: &str) -> bool {
    let lower = name.to_lowercase();
    lower.split(|c: char| !c.is_alphanumeric()).any(|w| ELEVATIONS.contains(&w)) || lower.contains("立面")
}

/// Whether a title that means the ground floor by itself calls it the first one, which is another where both are drawn.
pub fn is_first_floor(title: &str) -> bool {
    title.to_lowercase().contains("first floor")
}

/// What a text says of the drawing it stands by; `None` if it is no title.
pub fn title_of(text: &str) -> Option<Title> {
    let text = text.trim();
    if text.is_empty() || text.chars().count() > TITLE_CHARS_MAX {
        return None;
    }
    let lower = text.to_lowercase();
    let words: String =
        lower.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { ' ' }).collect();
    // `1.OG` and `EG` as words of their own, `1 og` too.
    let list: Vec<&str> = words.split_whitespace().collect();
    if list.first().is_some_and(|w| POINTERS.contains(w)) || list.iter().any(|w| BUILT.contains(w)) {
        return None;
    }
    if is_section(&list) || is_of_elevations(&lower) {
        return Some(Title::NoPlan);
    }
    // Kilograms.
    if list.windows(2).any(|w| w[1] == "kg" && w[0].ends_with(|c: char| c.is_ascii_digit())) {
        return None;
    }
    let words = format!(" {} ", list.join(" "));
    let has = |phrase: &str| {
        let is_ideographic = phrase.chars().any(|c| c >= '\u{3000}');
        if is_ideographic { lower.contains(phrase) } else { words.contains(&format!(" {phrase} ")) }
    };
    PHRASES.iter().find(|(_, list)| list.iter().any(|p| has(p))).map(|(title, _)| *title)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn title_blocks_are_known_by_their_words() {
        for (text, expected) in [
            ("SCALE: 1/4\" = 1'-0\"", true),
            ("Drawn by: AB", true),
            ("Scala 1:50", true),
            ("Scala", false),
            ("1:100", false),
            ("ramp 1:12", false),
            ("A-101", false),
        ] {
            assert_eq!(is_of_title_block(text), expected, "{text}");
        }
    }

    #[test]
    fn layers_of_elevations_are_known_by_their_words() {
        for (layer, expected) in [
            ("FRONT-ELEVATION", true),
            ("A_Ansicht Nord", true),
            ("ELEV", false),
            ("DETAILS", false),
            ("SECTION-A", false),
        ] {
            assert_eq!(is_of_elevations(layer), expected, "{layer}");
        }
    }

    #[test]
    fn titles_of_many_languages() {
        for (text, expected) in [
            ("GROUND FLOOR", Some(Title::GroundFloor)),
            ("PLANTA BAJA", Some(Title::GroundFloor)),
            ("EG", Some(Title::GroundFloor)),
            ("Grundriss EG M 1:100", Some(Title::GroundFloor)),
            ("1.OG", Some(Title::Plan)),
            ("Section A-A", Some(Title::NoPlan)),
            ("ALZADO PRINCIPAL", Some(Title::NoPlan)),
            ("Schnitt B-B", Some(Title::NoPlan)),
            ("1階平面図", Some(Title::GroundFloor)),
            ("南立面図", Some(Title::NoPlan)),
            ("Roof plan", Some(Title::Outside)),
            ("FLOOR PLAN", Some(Title::Plan)),
            ("FIRST FLOOR PLAN", Some(Title::GroundFloor)),
            ("Längsschnitt", Some(Title::NoPlan)),
            ("Grundriss Bauabschnitt 2", Some(Title::Plan)),
            ("Voorgevel", Some(Title::NoPlan)),
            ("SEC. A-A", Some(Title::NoPlan)),
            ("SEC. 1", Some(Title::NoPlan)),
            ("SEC. OFFICE", None),
            ("ELEV. NORTH", Some(Title::NoPlan)),
            ("ELEV.", None),
            ("ELEV. LOBBY", None),
            ("ELEV. +3.20", None),
            ("See detail 4", None),
            ("RC. FLOOR SLAB.", None),
            ("LEGEND", Some(Title::Beside)),
            ("KEY PLAN", Some(Title::Beside)),
            ("REFLECTED CEILING PLAN", Some(Title::Services)),
            ("FOUNDATION PLAN", Some(Title::Services)),
            ("FURNITURE PLAN", Some(Title::Plan)),
            ("Lageplan", Some(Title::Outside)),
            ("Kitchen", None),
            ("", None),
        ] {
            assert_eq!(title_of(text), expected, "{text}");
        }
    }
}
