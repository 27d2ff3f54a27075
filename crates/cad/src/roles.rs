//! What a layer is for, by its name: words of many languages, office standards' codes.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::names::{base_name, is_joined, is_word, words};
use super::things::ThingKind;

/// What the entities of a layer stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// Walls of full height: block sight and way.
    Wall,
    /// Parapets, half walls: block the way, and sight at knee level.
    LowWall,
    /// Fixed glass: blocks the way, and sight at knee level.
    Glazing,
    /// Columns.
    Column,
    /// Doors and other ways through.
    Door,
    /// Windows.
    Window,
    /// Stairs and ramps.
    Stair,
    /// Furniture, fixtures, equipment.
    Furniture,
    /// Texts and tags.
    Text,
    /// Dimensions.
    Dimension,
    /// Hatches and fills.
    Hatch,
    /// Axes, grids, construction lines.
    Grid,
    /// Terrain, plants, roads.
    Site,
    /// Roofs, ceilings, beams, what is projected from above.
    Roof,
    /// Footings and what lies below the floor.
    Foundation,
    /// Room areas.
    Room,
    /// The name says nothing.
    Unknown,
}

impl Role {
    /// The role in plain words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Wall => "walls",
            Self::LowWall => "low walls",
            Self::Glazing => "glazing",
            Self::Column => "columns",
            Self::Door => "doors",
            Self::Window => "windows",
            Self::Stair => "stairs",
            Self::Furniture => "furniture",
            Self::Text => "text",
            Self::Dimension => "dimensions",
            Self::Hatch => "hatches",
            Self::Grid => "axes and construction lines",
            Self::Site => "the site",
            Self::Roof => "what lies above",
            Self::Foundation => "foundations",
            Self::Room => "rooms",
            Self::Unknown => "nothing known",
        }
    }

    /// The role as `enfilade.check/2` names it.
    pub fn code(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::LowWall => "railing",
            Self::Glazing | Self::Window => "window",
            Self::Column => "column",
            Self::Door => "door",
            Self::Stair => "stair",
            Self::Furniture => "furniture",
            Self::Text => "annotation",
            Self::Dimension => "dimension",
            Self::Hatch => "hatch",
            Self::Grid => "grid",
            Self::Site => "outside",
            Self::Roof | Self::Foundation | Self::Room | Self::Unknown => "other",
        }
    }

    /// Whether it stops a look at eye level: what is measured as a wall.
    pub fn stops_sight(self) -> bool {
        matches!(self, Self::Wall | Self::Column)
    }

    /// Whether it stops a person but not a look at eye level.
    pub fn is_low(self) -> bool {
        matches!(self, Self::LowWall | Self::Glazing)
    }
}

/// Words that decide, lower case, in the order of their say: the first role with a word in the name
/// wins (`A-WALL-PATT` is a hatch). Names are compared by [`is_word`]: German, Dutch and the Nordic languages join words, and
/// so do Chinese, Japanese and Korean; of words of these that lie within each other the longest counts.
const WORDS: &[(Role, &str)] = &[
    (
        Role::Text,
        "text texts txt texte texto textos testo testi anno annotation iden note notes tag tags label labels \
         beschriftung notiz tekst tekster teksty yazi текст тексты 文字 文本 注释 说明 索引 图框 図枠 注記 문자 글자 텍스트 ttlb titleblock titolo rahmen plankopf \
         cartouche cajetin",
    ),
    (
        Role::Dimension,
        "dim dims dimension dimensions bemassung bemaßung vermassung vermaßung masse maße cotes cote cotation cota \
         cotas quote quota quotatura maten maat maatvoering mått wymiary kóty koty ölçü olcu размер размеры 寸法 尺寸 标注 치수",
    ),
    (
        Role::Hatch,
        "hatch hatching patt pattern fill texture schraffur schraffuren hachure hachures sombreado rayado \
         campitura campiture retino hachura arcering skravering kreskowanie tarama штриховка ハッチ 填充 해치",
    ),
    (Role::Wall, "壁 間仕切 墙 牆 隔断 隔斷 벽 벽체 내벽 외벽"),
    (Role::Column, "柱 기둥"),
    (
        Role::Grid,
        "grid grids axis axes dote achse achsen raster axe ejes eje assi asse eixo eixos griglia trame stramien \
         akser osie osi aks оси ось グリッド 通り芯 基準線 中心線 壁芯 壁心 柱芯 柱网 轴 軸 중심선 기준선 그리드 construction hilfslinie hilfslinien",
    ),
    (
        Role::Glazing,
        "glaz glazing curtain curtwall vitrage vetrata curtainwall glasfassade *glaswand vidrio 幕墙 玻璃 ガラス 유리",
    ),
    (
        Role::Door,
        "door doors opening openings doorswindows doorwindow doorwindows windowsdoors windowdoor windowdoors tür türen tuer tueren tuere porte portes puerta puertas porta portas \
         infissi serramenti carpinteria deur deuren dör dörrar dør dører ovi ovet drzwi dveře dvere kapi kapı \
         дверь двери ドア 扉 建具 门 門 문 방문 출입문 도어 header sliding *tür *türen *tuer",
    ),
    (
        Role::Window,
        "window windows fenster fenêtre fenêtres fenetre fenetres ventana ventanas finestra finestre janela \
         janelas esquadrias raam ramen kozijn kozijnen fönster vindu vinduer vindue ikkuna okno okna pencere \
         окно окна 窗 窓 サッシ 창 창문 창호 *fenster",
    ),
    (
        Role::Roof,
        "roof roofs clng ceiling ceilings projection dach dächer decke decken toiture toit plafond techo \
         cubierta tetto copertura soffitto telhado forro dak tak tag dach střecha çatı крыша 屋根 天井 屋顶 天花 吊顶 梁 지붕 천장 beam \
         beams träger unterzug querbalken stahlträger stahltraeger above overhead",
    ),
    (
        Role::Foundation,
        "foundation foundations fndn footing footings footer stem slab fundament fundamente cimentacion \
         cimientos fondazioni fondation fondations fundação 基礎 基础 楼板 기초",
    ),
    (
        Role::Stair,
        "stair stairs strs ramp treppe treppen escalier escaliers escalera escaleras scala scale escada \
         escadas trap trappen trappa trapp schody schodiště merdiven лестница лестницы 階段 楼梯 台阶 踏步 계단",
    ),
    (
        Role::Furniture,
        "furn furniture furnitures furnishing equipment eqpm flor lvtry casework case benches möbel moebel möblierung mobilier meubles mobiliario muebles \
         mobili arredo arredi mobília mobilia meubilair inredning møbler kalusteet meble nábytek mobilya мебель 家具 什器 厨具 设备 設備 가구",
    ),
    (
        Role::Site,
        "site topography topo topographie terrain gelände gelaende plants plant garden landscape tree trees \
         vegetation vegetacion verde terreno lageplan umgebung arbres jardin 外構 敷地 植栽 绿化 景观 道路 nivel",
    ),
    (
        Role::Room,
        "virtual room rooms raum räume area areas offices toilets piece pieces habitacion vano locali sala salas 面积 面積 室名 房间 部屋 실명 면적",
    ),
    (
        Role::Hatch,
        "demo demol demolish demolished demolition demolitions demoli demolis demolie demolies demolir démoli démolis \
         démolie démolies démolir démolition démolitions demolido demolidos demolida demolidas demoler demolicion \
         demolición demolicao demolição derribo derribos demolire demolito demoliti demolizione demolizioni abbruch \
         *abbruch abbruchwand abbruchwände abbruchwaende abbruchmauer abbruchmauern abriss *abriss abriß rückbau \
         rueckbau *rückbau *rueckbau sloop sloopwerk slopen rivning riving nedrivning wyburzenie wyburzenia rozbiórka \
         bourání demolice old removed wallpaper 拆除 撤去 解体 철거",
    ),
    (
        Role::Wall,
        "wall walls partition partitions wand wände wande waende mauer mauern mauerwerk mur murs cloison \
         cloisons maçonnerie muro muri muros muratura murature tramezzo tramezzi parete pareti pianta tabique \
         tabiques tabiqueria pared paredes parede alvenaria alvenarias muur muren wanden binnenwand vegg vegger \
         vägg väggar væg vægge seinä seinät ściana ściany sciana sciany stena stěna stěny steny zeď zdivo fal falak \
         duvar duvarlar стена стены перегородка перегородки *wand *wände *waende *mauer *mauern *muur *vegg *vägg",
    ),
    (
        Role::Column,
        "column columns col cols pillar pillars stütze stützen stuetze stuetzen pfeiler säule säulen poteau \
         poteaux pilastro pilastri pilar pilares kolom kolommen pelare søyle słup słupy sloup kolon колонна колонны",
    ),
];

/// Words that make a wall a low one when they stand beside a wall word; alone where [`LOW_ALONE`].
const LOW: &[&str] = &[
    "low", "half", "niedrig", "bas", "bajo", "basso", "baixo", "lav", "laag", "parapet", "腰", "半高", "矮",
];

/// Words that name low walls by themselves.
const LOW_ALONE: &[&str] = &[
    "parapet",
    "parapets",
    "brüstung",
    "brüstungen",
    "muret",
    "murets",
    "murete",
    "muretto",
    "腰壁",
    "栏杆",
    "栏板",
    "女儿墙",
    "手摺",
    "난간",
];

/// What a layer of walls holds besides walls, by a word after the one for walls: minor groups of the AIA and NCS lists,
/// in full as well (`A-WALL-CNTR`, `WALL CENTERLINE`).
const BESIDE_WALLS: &[(Role, &str)] = &[
    (Role::Grid, "cntr center centre centerline centreline centerlines centrelines mittellinie mittelachse"),
    (Role::LowWall, "prht"),
    (Role::Door, "head"),
];

/// The minor group that a name has after its word for walls, and what it stands for.
fn beside_walls<'w>(words: &'w [String], wall: &str) -> Option<(Role, &'w String)> {
    let after = words.iter().skip_while(|w| *w != wall).skip(1);
    let role = |w: &str| BESIDE_WALLS.iter().find(|(_, list)| list.split_ascii_whitespace().any(|x| x == w));
    after.filter_map(|w| Some((role(w)?.0, w))).next()
}

/// Words of names that hold doors and windows alike, lower case.
const OPENING_WORDS: &[&str] = &[
    "opening",
    "openings",
    "doorswindows",
    "doorwindow",
    "doorwindows",
    "windowsdoors",
    "windowdoor",
    "windowdoors",
    "header",
    "infissi",
    "serramenti",
    "carpinteria",
    "建具",
    "门窗",
    "門窗",
    "창호",
    "sliding",
];

/// Whether a name of doors is one of windows too.
pub fn is_of_windows_too(name: &str) -> bool {
    let is_window = |w: &str| role_by_name(w).0 == Role::Window;
    words(name).iter().any(|w| OPENING_WORDS.iter().any(|listed| is_word(w, listed)) || is_window(w))
}

/// What a layer's name says it is for, and why. [`Role::Unknown`] where it says nothing.
pub fn role_by_name(layer: &str) -> (Role, String) {
    if let Some((class, role)) = by_class(layer) {
        return (role, format!("its elements are of the class {class} ({})", role.words()));
    }
    let name = base_name(layer);
    let words = words(name);
    let has = |list: &[&str]| words.iter().find(|w| list.iter().any(|listed| is_word(w, listed)));
    if let Some(word) = has(LOW_ALONE) {
        return (Role::LowWall, format!("its name has the word {word:?} (low walls)"));
    }
    let ranks = words.iter().filter_map(|w| Some((rank(w)?, w)));
    // Of equals the first: the order of the words in the name.
    if let Some((first, word)) = ranks.min_by_key(|(rank, _)| *rank) {
        let role = WORDS[first].0;
        if role == Role::Wall
            && let Some((role, minor)) = beside_walls(&words, word)
        {
            return (role, format!("its name has the words {word:?} and {minor:?} ({})", role.words()));
        }
        if role == Role::Wall
            && let Some(low) = has(LOW)
        {
            return (Role::LowWall, format!("its name has the words {word:?} and {low:?} (low walls)"));
        }
        return (role, format!("its name has the word {word:?} ({})", role.words()));
    }
    // After all others: a plumbing partition is a partition.
    if let Some(said) = ThingKind::word_of_layer(name) {
        return (Role::Furniture, format!("its name has the word {said:?} ({})", Role::Furniture.words()));
    }
    match by_code(name) {
        Some((role, code)) => (role, format!("its name has the element code {code} ({})", role.words())),
        None => (Role::Unknown, "its name has no word for walls".into()),
    }
}

/// Classes of IFC: exact, so that their names are not taken apart (`IfcWallStandardCase` is no case).
const CLASSES: &[(&str, Role)] = &[
    ("IfcWall", Role::Wall),
    ("IfcColumn", Role::Column),
    ("IfcCurtainWall", Role::Glazing),
    ("IfcPlate", Role::Glazing),
    ("IfcRailing", Role::LowWall),
    ("IfcDoor", Role::Door),
    ("IfcWindow", Role::Window),
    ("IfcStair", Role::Stair),
    ("IfcSpace", Role::Room),
    ("IfcSlab", Role::Foundation),
    ("IfcRoof", Role::Roof),
    ("IfcFurni", Role::Furniture),
    ("IfcSystemFurnitureElement", Role::Furniture),
];

/// The class that a layer is named after, and what it is for.
fn by_class(layer: &str) -> Option<(&str, Role)> {
    let is_class = layer.strip_prefix("Ifc")?.starts_with(|c: char| c.is_ascii_uppercase());
    let role = CLASSES.iter().find(|(class, _)| layer.starts_with(class)).map_or(Role::Unknown, |c| c.1);
    is_class.then_some((layer, role))
}

/// The first line of [`WORDS`] that has a word, looked up so that a hundred thousand layers are no trouble.
fn rank(word: &str) -> Option<usize> {
    static WHOLE: LazyLock<HashMap<&str, usize>> = LazyLock::new(|| {
        let lines = WORDS.iter().enumerate().rev();
        lines.flat_map(|(i, (_, list))| list.split_ascii_whitespace().map(move |w| (w, i))).collect()
    });
    static ENDS: LazyLock<Vec<(&str, usize)>> = LazyLock::new(|| {
        let lines = WORDS.iter().enumerate();
        let all = lines.flat_map(|(i, (_, list))| list.split_ascii_whitespace().map(move |w| (w, i)));
        all.filter_map(|(w, i)| Some((w.strip_prefix('*')?, i))).collect()
    });
    static JOINED: LazyLock<Vec<(&str, usize)>> =
        LazyLock::new(|| WHOLE.iter().filter(|(w, _)| is_joined(w)).map(|(w, i)| (*w, *i)).collect());
    let end = ENDS.iter().filter(|(end, _)| word.ends_with(end)).map(|e| e.1).min();
    let within: Vec<&(&str, usize)> = match word.is_ascii() {
        true => Vec::new(),
        false => JOINED.iter().filter(|(w, _)| word.contains(w)).collect(),
    };
    let is_part = |w: &str| within.iter().any(|(longer, _)| longer.len() > w.len() && longer.contains(w));
    let joined = within.iter().filter(|(w, _)| !is_part(w)).map(|w| w.1);
    WHOLE.get(word).copied().into_iter().chain(end).chain(joined).min()
}

/// CI/SfB element codes as BS 1192 and ISO 13567 layers carry them: `A-210-M`, `A22-…`, `A-G21---E`.
fn by_code(name: &str) -> Option<(Role, &str)> {
    let rest = name.strip_prefix(['A', 'S', 'a', 's'])?;
    let rest = rest.trim_start_matches(['-', '_']);
    let rest = rest.strip_prefix('G').unwrap_or(rest);
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let code = rest.get(..digits).filter(|c| (2..=3).contains(&c.len()))?;
    let role = match &code[..2] {
        "21" | "22" => Role::Wall,
        "23" | "27" | "35" | "37" => Role::Roof,
        "24" => Role::Stair,
        "28" => Role::Column,
        "31" => Role::Window,
        "32" => Role::Door,
        _ => return None,
    };
    Some((role, code))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_offices_and_languages() {
        use Role::*;
        for (layer, role) in [
            ("A-WALL-FULL", Wall),
            ("xref-Bishop-Overland-08$0$A-WALL", Wall),
            ("plan|WAND", Wall),
            ("Innenwände 2", Wall),
            ("trennwand", Wall),
            ("MURS", Wall),
            ("MURI", Wall),
            ("tabiques_10", Wall),
            ("PAREDES", Wall),
            ("ALVENARIA", Wall),
            ("binnenmuur", Wall),
            ("yttervägg", Wall),
            ("SCIANY", Wall),
            ("Duvar", Wall),
            ("Стены", Wall),
            ("_0-9_壁__窓", Wall),
            ("墙体", Wall),
            ("内墙线", Wall),
            ("BS-半高隔断", LowWall),
            ("幕墙", Glazing),
            ("窗线", Window),
            ("门线", Door),
            ("门墙窗标注", Dimension),
            ("柱网", Grid),
            ("使用面积线", Room),
            ("창문", Window),
            ("창고", Unknown),
            ("문자", Text),
            ("A-210 G - Existing Structure 4", Wall),
            ("A-320G - Permanent Solid Partitions 12", Wall),
            ("I-321G - Virtual Partition 18", Room),
            ("wall low", LowWall),
            ("Brüstung", LowWall),
            ("wall high", Wall),
            ("A-GLAZ", Glazing),
            ("IfcWallStandardCase", Wall),
            ("IfcColumnStandardCase", Column),
            ("IfcCurtainWall", Glazing),
            ("IfcFurnishingElement", Furniture),
            ("IfcSpace", Room),
            ("IfcBuildingElementProxy", Unknown),
            ("A-WALL-PATT", Hatch),
            ("A-WALL-CNTR", Grid),
            ("xref$0$A-WALL-CENTER-N", Grid),
            ("Wall Centerline", Grid),
            ("Center Wall", Wall),
            ("CENTRE-WALLS", Wall),
            ("A-WALL-PRHT", LowWall),
            ("A-WALL-HEAD", Door),
            ("Headwall", Unknown),
            ("A-WALL-JAMB", Wall),
            ("A-325G - Internal Doors 6", Door),
            ("doorswindows", Door),
            ("xref$0$S-STEM-WALL", Foundation),
            ("S-COLS", Column),
            ("_0-3_柱", Column),
            ("_0-1_基準線", Grid),
            ("INFISSI", Door),
            ("Fenster", Window),
            ("A-FLOR-STRS", Stair),
            ("Furniture 3", Furniture),
            ("COTAS", Dimension),
            ("TESTI", Text),
            ("MUR-DEMOLI", Hatch),
            ("Murs à démolir", Hatch),
            ("DÉMOLITION MURS", Hatch),
            ("muros_demolición", Hatch),
            ("PAREDES-DEMOLIDAS", Hatch),
            ("Muri demoliti", Hatch),
            ("wanden te slopen", Hatch),
            ("SLOOP-MUUR", Hatch),
            ("Wände Abbruch", Hatch),
            ("Mauerabbruch", Hatch),
            ("Wand_Rückbau", Hatch),
            ("RUECKBAU WAND", Hatch),
            ("Abriss Wand", Hatch),
            ("A-WALL-DEMOLITION", Hatch),
            ("Grundriss Wand", Wall),
            ("S-SLOUP", Column),
            ("DEMOLITEC", Unknown),
            ("topography", Site),
            ("0", Unknown),
            ("Layer 1 11", Unknown),
        ] {
            assert_eq!(role_by_name(layer).0, role, "{layer}");
        }
    }
}
