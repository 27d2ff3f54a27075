//! Which layers carry walls, by name.

use super::names::Pattern;
use super::own_layers::is_own;
use super::roles::{Role, role_by_name};
use enfilade_report::{Error, Place};

/// Decides by name which layers carry walls.
#[derive(Clone, Debug)]
pub struct WallLayers {
    user: Vec<(String, Pattern)>,
    keeps_classes: bool,
}

/// Classes of a building that are walls unless the user chooses among them.
const WALL_CLASSES: [&str; 5] =
    ["IfcWall", "IfcWallStandardCase", "IfcWallElementedCase", "IfcColumn", "IfcColumnStandardCase"];

impl WallLayers {
    /// `globs`: the user's patterns (case-insensitive, `*` and `?`); empty for the default words.
    ///
    /// # Errors
    /// [`Error::Usage`] for a pattern that cannot be read.
    pub fn new(globs: &[String]) -> Result<Self, Error> {
        let compile = |glob: &String| {
            Pattern::new(glob).map(|p| (glob.clone(), p)).map_err(|e| {
                let text =
                    format!("--wall-layer {glob:?}: {e}; expected a layer name in which * and ? may stand");
                Error::usage("wall-layer-pattern", Place::default(), text)
            })
        };
        Ok(Self { user: globs.iter().map(compile).collect::<Result<_, _>>()?, keeps_classes: false })
    }

    /// The same for a building, whose file says outright what is a wall: walls and columns stay walls beside what the user
    /// names, unless that is one of their own classes.
    #[must_use]
    pub fn of_building(self) -> Self {
        let names_one = self.user.iter().any(|(_, m)| WALL_CLASSES.iter().any(|c| m.is_match(c)));
        Self { keeps_classes: !names_one, ..self }
    }

    /// Whether the user chose the layers.
    pub fn is_by_user(&self) -> bool {
        !self.user.is_empty()
    }

    /// Why `layer` carries walls, or `None` if it does not.
    pub fn reason(&self, layer: &str) -> Option<String> {
        if is_own(layer) {
            return None;
        }
        if self.is_by_user() {
            let is_named =
                |m: &Pattern| [layer, base_name(layer), class_name(layer)].into_iter().any(|n| m.is_match(n));
            let hit = self.user.iter().find(|(_, m)| is_named(m));
            let own = || {
                let is_own = self.keeps_classes && WALL_CLASSES.contains(&class_name(layer));
                is_own.then(|| "a wall by its class, beside what --wall-layer names".to_string())
            };
            return hit.map(|(glob, _)| format!("matches --wall-layer {glob}")).or_else(own);
        }
        let (role, why) = role_by_name(layer);
        matches!(role, Role::Wall | Role::Column).then_some(why)
    }
}

/// The layer's name without the prefix of a bound (`xref$0$A-WALL`) or attached (`xref|A-WALL`)
/// external reference.
pub fn base_name(layer: &str) -> &str {
    let after_bar = layer.rsplit('|').next().unwrap_or(layer);
    match after_bar.rmatch_indices('$').next() {
        Some((i, _)) if after_bar[..i].contains('$') => &after_bar[i + 1..],
        _ => after_bar,
    }
}

/// The class alone of a layer that readers of buildings make: `IfcWall` of `IfcWall (window at knee height)`.
fn class_name(layer: &str) -> &str {
    if layer.starts_with("Ifc") { layer.split(" (").next().unwrap_or(layer) } else { layer }
}

/// The words of a layer's name, lower case: runs of letters, parted where capitals begin.
pub fn words(name: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut last_lower = false;
    for c in name.chars() {
        if !c.is_alphabetic() {
            out.push(String::new());
        } else {
            if c.is_uppercase() && last_lower {
                out.push(String::new());
            }
            if let Some(word) = out.last_mut() {
                word.extend(c.to_lowercase());
            }
        }
        last_lower = c.is_lowercase();
    }
    out.retain(|w| !w.is_empty());
    out
}

/// Whether a word of a name is a listed one, both lower case. One that begins with `*` may end a longer word, and one of a
/// script that writes without blanks may stand anywhere in one.
pub fn is_word(word: &str, listed: &str) -> bool {
    match listed.strip_prefix('*') {
        Some(end) => word.ends_with(end),
        None => word == listed || (is_joined(listed) && word.contains(listed)),
    }
}

/// Whether others join on to a word without a blank: Han characters, and kana or Hangul from two letters on.
pub fn is_joined(word: &str) -> bool {
    let is_han = |c: char| ('\u{4e00}'..='\u{9fff}').contains(&c);
    let is_syllable =
        |c: char| ('\u{3040}'..='\u{30ff}').contains(&c) || ('\u{ac00}'..='\u{d7a3}').contains(&c);
    word.chars().all(|c| is_han(c) || is_syllable(c))
        && (word.chars().any(is_han) || word.chars().nth(1).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_of_many_offices() {
        let walls = [
            "WALLS",
            "A-WALL",
            "A-WALL-FULL-2",
            "xref-Bishop$0$A-WALL",
            "plan|Wand",
            "Wand (neu)",
            "MURS",
            "wall high",
        ];
        let more = ["Wall_2", "innenWand", "Pillars", "S-COLS", "PIANTA", "_0-9_壁__窓", "Außenwände"];
        let default = WallLayers::new(&[]).unwrap();
        for layer in walls {
            assert!(default.reason(layer).is_some(), "{layer}");
        }
        for (layer, expected) in more.into_iter().zip([true; 7]) {
            assert_eq!(default.reason(layer).is_some(), expected, "{layer}");
        }
        for layer in [
            "0",
            "Doors",
            "A-WALL-PATT",
            "A-DOOR",
            "EF-MOVE",
            "Wallpaper",
            "A-GLAZ-WALL-TEXT",
            "dimension walls",
        ] {
            assert!(default.reason(layer).is_none(), "{layer}");
        }
    }

    #[test]
    fn the_users_pattern_replaces_the_words() {
        let chosen = WallLayers::new(&["0".into(), "*open*".into()]).unwrap();
        assert!(chosen.reason("0").is_some() && chosen.reason("x$0$A-OPENING").is_some());
        assert!(chosen.reason("WALLS").is_none() && chosen.reason("EF-MOVE-open").is_none());
        assert!(WallLayers::new(&["[".into()]).is_err());
        let of_class = WallLayers::new(&["IfcWall".into(), "plan".into()]).unwrap();
        assert!(of_class.reason("IfcWall (window at knee height)").is_some());
        assert!(of_class.reason("IfcWallStandardCase").is_none() && of_class.reason("Plan (old)").is_none());
    }

    /// Who names glass or furniture in a building does not say that its walls are none; who names walls chooses among them.
    #[test]
    fn walls_of_a_building_stay_walls_beside_what_the_user_names() {
        let walls = |globs: &[&str], is_building: bool| -> Vec<&str> {
            let chosen = WallLayers::new(&globs.iter().map(ToString::to_string).collect::<Vec<_>>()).unwrap();
            let chosen = if is_building { chosen.of_building() } else { chosen };
            let all = [
                "IfcWall",
                "IfcWall (window at knee height)",
                "IfcColumn",
                "IfcCurtainWall",
                "IfcDoor",
                "Wall",
            ];
            all.into_iter().filter(|l| chosen.reason(l).is_some()).collect()
        };
        let kept = ["IfcWall", "IfcWall (window at knee height)", "IfcColumn"];
        assert_eq!(walls(&["ifccurtain*"], true), [&kept[..], &["IfcCurtainWall"]].concat());
        assert_eq!(
            walls(&["IfcDoor", "IfcCurtainWall"], true),
            [&kept[..], &["IfcCurtainWall", "IfcDoor"]].concat()
        );
        assert_eq!(walls(&["IfcCurtainWall"], false), ["IfcCurtainWall"]);
        assert_eq!(
            walls(&["IfcWall", "IfcDoor"], true),
            ["IfcWall", "IfcWall (window at knee height)", "IfcDoor"]
        );
        assert_eq!(walls(&["IfcColumn"], true), ["IfcColumn"]);
        assert_eq!(walls(&["AUSSENWÄNDE", "wall"], true), [&kept[..], &["Wall"]].concat());
    }
}
