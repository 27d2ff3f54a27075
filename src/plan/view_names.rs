//! What the titles on a sheet say: plans, sections, elevations, in many languages.

/// What a title names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Title {
    /// The plan of the ground floor.
    GroundFloor,
    /// Another plan.
    Plan,
    /// A roof plan or a site plan: no rooms in it.
    Outside,
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
            Self::Unknown => 0.0,
            Self::Outside => -0.5,
            Self::NoPlan => -2.0,
        }
    }

    /// In plain words.
    pub fn words(self) -> &'static str {
        match self {
            Self::GroundFloor => "plan of the ground floor",
            Self::Plan => "plan",
            Self::Outside => "roof or site plan",
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
            "elevation",
            "detail",
            "details",
            "facade",
            "perspective",
            "schnitt",
            "ansicht",
            "ansichten",
            "detailschnitt",
            "coupe",
            "élévation",
            "façade",
            "sección",
            "seccion",
            "alzado",
            "alzados",
            "corte",
            "fachada",
            "sezione",
            "prospetto",
            "prospetti",
            "alçado",
            "alcado",
            "doorsnede",
            "gevel",
            "snitt",
            "fasad",
            "fasade",
            "facade",
            "leikkaus",
            "julkisivu",
            "przekrój",
            "elewacja",
            "řez",
            "pohled",
            "kesit",
            "görünüş",
            "разрез",
            "фасад",
            "立面",
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
    let words = format!(" {} ", words.split_whitespace().collect::<Vec<_>>().join(" "));
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
            ("Kitchen", None),
            ("", None),
        ] {
            assert_eq!(title_of(text), expected, "{text}");
        }
    }
}
