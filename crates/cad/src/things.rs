//! What stands in rooms, by what the file calls it: sanitary ware, furniture, machines.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::names::{bare, is_joined, words};

/// What a thing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ThingKind {
    /// A toilet.
    Toilet,
    /// A urinal.
    Urinal,
    /// A tub or a shower.
    Tub,
    /// A washbasin or a bidet.
    Basin,
    /// A sink of which nothing says whether it is one of a kitchen.
    Sink,
    /// Sanitary ware of which nothing says what it is.
    Sanitary,
    /// A stove, an oven, a dishwasher, kitchen units.
    Kitchen,
    /// A refrigerator.
    Fridge,
    /// A washing machine, a boiler, a meter.
    Machine,
    /// A bed, a bedside table.
    Bed,
    /// A sofa, an armchair, a television set.
    Sofa,
    /// A wardrobe.
    Wardrobe,
    /// A desk, a computer.
    Desk,
    /// A table.
    Table,
    /// A chair.
    Chair,
    /// A blackboard.
    Board,
    /// A shelf, a sideboard, a chest of drawers: it tells nothing of its room.
    Shelf,
    /// A car.
    Car,
    /// A flight of stairs.
    Stair,
    /// A lift.
    Lift,
}

impl ThingKind {
    /// Whether it can stand elsewhere in its room: no water, no hearth, nothing of the building.
    pub fn is_furniture(self) -> bool {
        use ThingKind::{Bed, Board, Chair, Desk, Shelf, Sofa, Table, Wardrobe};
        matches!(self, Bed | Board | Chair | Desk | Shelf | Sofa | Table | Wardrobe)
    }

    /// What a name says that a thing is, by the first pattern that fits.
    pub fn of_name(name: &str) -> Option<Self> {
        fitting(name).map(|pattern| pattern.kind).next()
    }

    /// The word by which a layer's name says that it holds what stands in rooms.
    pub fn word_of_layer(name: &str) -> Option<&'static str> {
        fitting(name).find(|pattern| pattern.names_layers).map(|pattern| pattern.said)
    }
}

/// Words of names, in the order of their say: `sofa bed` is a sofa, `desk chair` a chair. `_` joins words that follow one
/// another, `*` begins what may end a longer word. After those with a `+` layers are named: most of the others name rooms too
/// (`lounge`, `bureau`, `bathroom`, `LAV`), whose walls would be lost, or are parts of longer words.
const WORDS: &[(ThingKind, &str)] = &[
    (
        ThingKind::Fridge,
        "fridge refrigerator freezer refrig kuhlschrank *kuhlschrank gefrierschrank frigo refrigerateur frigorifero frigorifico nevera geladeira koelkast lodowka холодильник lednice buzdolabi 冰箱 冷蔵庫 냉장고",
    ),
    (
        ThingKind::Machine,
        "washer dryer drier washing_machine washingmachine waschmaschine trockner boiler water_heater waterheater furnace lave_linge lavatrice lavadora secadora caldera caldaia wasmachine pralka стиральная котел \
         pracka camasir_makinesi 洗衣机 洗濯機 热水器 세탁기",
    ),
    (
        ThingKind::Urinal,
        "urinal urinals urinoir urinario orinatoio mictorio pisuar писсуар pissoir 小便器 小便斗",
    ),
    (
        ThingKind::Kitchen,
        "stove cooker hob oven range cooktop cook_top dishwasher kitchen kitchensink kitchen_sink microwave herd kochfeld backofen spulmaschine geschirrspuler kuche kuchen* spule *spule cuisine cuisiniere \
         evier plaque_cuisson lave_vaisselle cucina fornello lavello lavastoviglie cocina fregadero lavavajillas fogao cozinha pia keuken gootsteen fornuis kuchnia kuchenka zlewozmywak zlew \
         плита кухня кухонная мойка dishwash drez kuchyne sporak ocak mutfak eviye burner worktop counter_top countertop 灶 炉灶 燃气灶 厨具 水槽 洗菜盆 流し コンロ キッチン 싱크대 가스",
    ),
    (
        ThingKind::Tub,
        "bath tub bathtub bath_tub shower showers jacuzzi whirlpool badewanne wanne dusche duschwanne *wanne baignoire douche vasca doccia banera ducha banheira chuveiro badkuip bad ligbad wanna prysznic brodzik \
         ванна душ душевая vana sprchovy sprcha kuvet dus dusakabin duschtasse 浴缸 淋浴 淋浴房 浴槽 シャワー 욕조 샤워",
    ),
    (
        ThingKind::Toilet,
        "toilet toilets wc wcs watercloset water_closet toiletpan wcseat commode toilette klo klosett *wc cuvette inodoro retrete sanita vaso_sanitario cisterna sedes miska_ustepowa унитаз toalet klozet zachod cistern \
         坐便器 马桶 便器 大便器 蹲便器 座便器 洋便器 양변기 변기",
    ),
    (
        ThingKind::Basin,
        "basin basins washbasin wash_basin washhandbasin wash_hand lavatory lavatories lav lavabo lavabos lavabi bidet vanity vanities waschbecken waschtisch handwaschbecken lavamanos lavatorio wastafel umywalka \
         умывальник раковина биде umyvadlo 洗脸盆 洗手盆 台盆 洗面器 洗面台 세면대 세면기",
    ),
    (ThingKind::Sink, "sink sinks zlewozmywak_maly kitchen_or_bath"),
    (
        ThingKind::Sofa,
        "+sofa +sofas sofabed sofa_bed +couch +couches loveseat settee armchair arm_chair lounge recliner television tv tvset coffee_table coffeetable fernseher sessel canape fauteuil divano poltrona divani sillon butaca butacas \
         poltrona bank zetel kanapa fotel диван кресло телевизор pohovka kreslo koltuk kanepe 沙发 电视 电视柜 茶几 ソファ 소파",
    ),
    (
        ThingKind::Chair,
        "+chair +chairs stool stools seat armless seating stuhl stuhle burostuhl *stuhl hocker chaise chaises tabouret sedia sedie sgabello silla sillas taburete cadeira cadeiras stoel stoelen krzeslo krzesla стул zidle sandalye 椅 椅子 餐椅 イス 의자",
    ),
    (
        ThingKind::Bed,
        "+bed +beds doublebed singlebed queenbed kingbed bunk cot crib mattress bedside nightstand night_stand night_table headboard bett betten *bett doppelbett einzelbett nachttisch lit lits chevet letto letti comodino \
         cama camas camita beliche bedden *bed lozko lozka кровать кровати тумба_прикроватная postel luzko yatak karyola 床 双人床 单人床 床头柜 ベッド 침대",
    ),
    (
        ThingKind::Wardrobe,
        "+wardrobe +wardrobes armoire closet robe coats kleiderschrank schrank garderobe guardaroba armadio ropero placard guarda_roupa kledingkast szafa шкаф skrin gardirop dolap 衣柜 クローゼット 옷장",
    ),
    (
        ThingKind::Board,
        "blackboard whiteboard chalkboard smartboard lectern schultafel tafel lavagna pizarra lousa tableau_noir tablica доска 黑板 白板 黒板 칠판",
    ),
    (
        ThingKind::Desk,
        "+desk +desks workstation work_station computer pc monitor schreibtisch *schreibtisch arbeitstisch bureau scrivania escritorio secretaria_mesa bureautafel biurko psaci_stul calisma_masasi 书桌 办公桌 デスク 机 책상",
    ),
    (
        ThingKind::Table,
        "+table +tables dining esstisch tisch *tisch tavolo tavoli mesa mesas tafels eettafel stol stoly стол stul masa 餐桌 桌 テーブル 식탁",
    ),
    (
        ThingKind::Shelf,
        "sideboard +shelf +shelves shelving bookcase bookcases bookshelf bookshelves dresser locker lockers filing_cabinet filecabinet regal regale *regal bucherregal kommode anrichte aktenschrank etagere etageres \
         bibliotheque buffet libreria scaffale credenza estante estanteria aparador cajonera boekenkast dressoir regal_na_ksiazki komoda полка стеллаж комод regal_knihovna kitaplik 书架 书柜 棚 本棚 책장",
    ),
    (
        ThingKind::Car,
        "car cars auto pkw vehicle voiture coche carro macchina автомобиль 汽车 小汽车 自動車 자동차",
    ),
    (
        ThingKind::Lift,
        "elevator elevators lift aufzug ascenseur ascensore ascensor elevador winda лифт vytah asansor 电梯 エレベーター",
    ),
    (
        ThingKind::Stair,
        "ifcstair ifcstairflight stair stairs staircase treppe escalier escalera escada trap schody лестница 楼梯 階段",
    ),
    (
        ThingKind::Sanitary,
        "+sanitary +sanitaryterminal sanitar* +sanr +plumbing +plumb +plfx +fixture +fixtures bathroom toiletten sanitaire sanitaires sanitari sanitarios sanitair +сантехника +洁具 +卫浴 衛生 +위생기구",
    ),
];

enum Fit {
    Whole,
    End,
    Start,
    Joined,
}

struct Pattern {
    kind: ThingKind,
    /// As it is listed.
    said: &'static str,
    names_layers: bool,
    words: Vec<(Fit, String)>,
}

static PATTERNS: LazyLock<Vec<Pattern>> = LazyLock::new(|| {
    let word = |text: &str| {
        let plain = bare(text.trim_matches('*'));
        let fit = match (text.starts_with('*'), text.ends_with('*')) {
            (true, _) => Fit::End,
            (_, true) => Fit::Start,
            _ if is_joined(&plain) => Fit::Joined,
            _ => Fit::Whole,
        };
        (fit, plain)
    };
    let pattern = |kind: ThingKind, listed: &'static str| {
        let said = listed.trim_start_matches('+');
        let words = said.split('_').map(word).collect();
        Pattern { kind, said, names_layers: said != listed, words }
    };
    let listed = WORDS.iter().flat_map(|(kind, list)| list.split_ascii_whitespace().map(|t| (*kind, t)));
    listed.map(|(kind, listed)| pattern(kind, listed)).collect()
});

/// Where patterns are found, by their numbers.
#[derive(Default)]
struct Index {
    /// By their first word, where that is a whole one.
    by_first: HashMap<&'static str, Vec<usize>>,
    /// Those that begin with a part of a word.
    parts: Vec<usize>,
}

static INDEX: LazyLock<Index> = LazyLock::new(|| {
    let mut index = Index::default();
    for (i, pattern) in PATTERNS.iter().enumerate() {
        match pattern.words.first() {
            Some((Fit::Whole, word)) => index.by_first.entry(word).or_default().push(i),
            _ => index.parts.push(i),
        }
    }
    index
});

/// The patterns that fit a name, in the order of their say. A hundred thousand names are no trouble.
fn fitting(name: &str) -> impl Iterator<Item = &'static Pattern> {
    let words: Vec<String> = words(name).iter().map(|w| bare(w)).collect();
    let fits = |word: &str, (fit, listed): &(Fit, String)| match fit {
        Fit::Whole => word == listed,
        Fit::End => word.ends_with(listed.as_str()),
        Fit::Start => word.starts_with(listed.as_str()),
        Fit::Joined => word.contains(listed.as_str()),
    };
    let is_here = |i: &usize| {
        let pattern = &PATTERNS[*i].words;
        words.windows(pattern.len()).any(|w| w.iter().zip(pattern).all(|(w, p)| fits(w, p)))
    };
    let by_word = words.iter().filter_map(|w| INDEX.by_first.get(w.as_str())).flatten();
    let mut found: Vec<usize> = by_word.chain(&INDEX.parts).copied().filter(is_here).collect();
    found.sort_unstable();
    found.into_iter().map(|i| &PATTERNS[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_blocks_say_what_stands_there() {
        use ThingKind::*;
        for (name, kind) in [
            ("WC-01", Some(Toilet)),
            ("Toilet-Domestic-3D", Some(Toilet)),
            ("M_Bed-Standard", Some(Bed)),
            ("BED-180", Some(Bed)),
            ("Sofa Bed", Some(Sofa)),
            ("Desk Chair", Some(Chair)),
            ("Kitchen Sink", Some(Kitchen)),
            ("SINK", Some(Sink)),
            ("Waschbecken 60", Some(Basin)),
            ("Doppelbett", Some(Bed)),
            ("Badewanne", Some(Tub)),
            ("унитаз", Some(Toilet)),
            ("双人床", Some(Bed)),
            ("P-SANR-FIXT", Some(Sanitary)),
            ("A-FURN", None),
            ("DOOR-885", None),
        ] {
            assert_eq!(ThingKind::of_name(name), kind, "{name}");
        }
    }

    #[test]
    fn layers_are_named_after_what_stands_in_rooms() {
        for (name, word) in [
            ("SANITARY", Some("sanitary")),
            ("WC sanitary", Some("sanitary")),
            ("CHAIRS", Some("chairs")),
            ("洁具", Some("洁具")),
            ("KITCHEN", None),
            ("LOUNGE", None),
            ("BUREAU", None),
            ("Bathroom", None),
            ("embed", None),
            ("机房", None),
            ("lift", None),
            ("wall", None),
        ] {
            assert_eq!(ThingKind::word_of_layer(name), word, "{name}");
        }
    }
}
