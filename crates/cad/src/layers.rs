//! Which layers carry walls, by name.

use super::names::{Pattern, base_name, class_name};
use super::own_layers::is_own;
use super::roles::role_by_name;
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
        role.stops_sight().then_some(why)
    }
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
