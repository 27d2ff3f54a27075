//! What stands in rooms and tells what they are for: sanitary ware, furniture, machines, by what the file calls it.

use std::collections::{BTreeMap, HashMap};
use std::sync::LazyLock;

use glam::DVec2;

use super::super::Plan;
use super::super::hidden::Hidden;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Editable, SourceRef};
use enfilade_cad::names::bare;
use enfilade_cad::names::{is_joined, words};
use enfilade_cad::own_layers::is_own;
use enfilade_cad::plane::box_of;
use enfilade_cad::roles::Role;
use enfilade_engine::geometry::PointUm;

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
}

/// Words of names, in the order of their say: `sofa bed` is a sofa, `desk chair` a chair. `_` joins words that follow one
/// another, `*` begins what may end a longer word.
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
        "sofa sofas sofabed sofa_bed couch couches loveseat settee armchair arm_chair lounge recliner television tv tvset coffee_table coffeetable fernseher sessel canape fauteuil divano poltrona divani sillon butaca butacas \
         poltrona bank zetel kanapa fotel диван кресло телевизор pohovka kreslo koltuk kanepe 沙发 电视 电视柜 茶几 ソファ 소파",
    ),
    (
        ThingKind::Chair,
        "chair chairs stool stools seat armless seating stuhl stuhle burostuhl *stuhl hocker chaise chaises tabouret sedia sedie sgabello silla sillas taburete cadeira cadeiras stoel stoelen krzeslo krzesla стул zidle sandalye 椅 椅子 餐椅 イス 의자",
    ),
    (
        ThingKind::Bed,
        "bed beds doublebed singlebed queenbed kingbed bunk cot crib mattress bedside nightstand night_stand night_table headboard bett betten *bett doppelbett einzelbett nachttisch lit lits chevet letto letti comodino \
         cama camas camita beliche bedden *bed lozko lozka кровать кровати тумба_прикроватная postel luzko yatak karyola 床 双人床 单人床 床头柜 ベッド 침대",
    ),
    (
        ThingKind::Wardrobe,
        "wardrobe wardrobes armoire closet robe coats kleiderschrank schrank garderobe guardaroba armadio ropero placard guarda_roupa kledingkast szafa шкаф skrin gardirop dolap 衣柜 クローゼット 옷장",
    ),
    (
        ThingKind::Board,
        "blackboard whiteboard chalkboard smartboard lectern schultafel tafel lavagna pizarra lousa tableau_noir tablica доска 黑板 白板 黒板 칠판",
    ),
    (
        ThingKind::Desk,
        "desk desks workstation work_station computer pc monitor schreibtisch *schreibtisch arbeitstisch bureau scrivania escritorio secretaria_mesa bureautafel biurko psaci_stul calisma_masasi 书桌 办公桌 デスク 机 책상",
    ),
    (
        ThingKind::Table,
        "table tables dining esstisch tisch *tisch tavolo tavoli mesa mesas tafels eettafel stol stoly стол stul masa 餐桌 桌 テーブル 식탁",
    ),
    (
        ThingKind::Shelf,
        "sideboard shelf shelves shelving bookcase bookcases bookshelf bookshelves dresser locker lockers filing_cabinet filecabinet regal regale *regal bucherregal kommode anrichte aktenschrank etagere etageres \
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
        "sanitary sanitaryterminal sanitar* sanr plumbing plumb plfx fixture fixtures bathroom toiletten sanitaire sanitaires sanitari sanitarios sanitair сантехника 洁具 卫浴 衛生 위생기구",
    ),
];

/// Something that stands in a room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thing {
    /// What it is.
    pub kind: ThingKind,
    /// The lower left and the upper right corner of its box, drawing frame, micrometres.
    pub extent: [PointUm; 2],
}

impl Thing {
    /// The middle of its box.
    pub fn at(&self) -> PointUm {
        let [lo, hi] = self.extent;
        [i64::midpoint(lo[0], hi[0]), i64::midpoint(lo[1], hi[1])]
    }
}

/// What is longer than this is no thing that stands in a room, metres of a person.
const LONGEST_M: f64 = 6.5;

/// A straight stair is no longer than this, metres of a person: 25 treads of 0.29 m climb a storey of 4.4 m, and a landing of
/// 1.2 m parts them (DIN 18065 wants one after 18 risers).
const LONGEST_FLIGHT_M: f64 = 9.0;

/// What is shorter than this tells nothing, metres of a person: a symbol on a sheet.
const SHORTEST_M: f64 = 0.15;

enum Fit {
    Whole,
    End,
    Start,
    Joined,
}

/// Words of a pattern, and what it stands for.
type Pattern = (ThingKind, Vec<(Fit, String)>);

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
    let of = |(kind, list): &(ThingKind, &str)| {
        let kind = *kind;
        list.split_ascii_whitespace().map(|t| (kind, t.split('_').map(word).collect())).collect::<Vec<_>>()
    };
    WORDS.iter().flat_map(of).collect()
});

/// What a name says that a thing is.
pub(super) fn kind_of_thing(name: &str) -> Option<ThingKind> {
    let words: Vec<String> = words(name).iter().map(|w| bare(w)).collect();
    let fits = |word: &str, (fit, listed): &(Fit, String)| match fit {
        Fit::Whole => word == listed,
        Fit::End => word.ends_with(listed.as_str()),
        Fit::Start => word.starts_with(listed.as_str()),
        Fit::Joined => word.contains(listed.as_str()),
    };
    let is_here = |(_, pattern): &&Pattern| {
        words.windows(pattern.len()).any(|w| w.iter().zip(pattern).all(|(w, p)| fits(w, p)))
    };
    PATTERNS.iter().find(is_here).map(|p| p.0)
}

/// Something found, by its box in drawing units.
struct Found {
    kind: ThingKind,
    extent: [DVec2; 2],
    /// Where it stands in the file and how it is written back, if it is drawn as one.
    whole: Option<(SourceRef, Editable)>,
}

/// What INSERTs show, by the records that show it.
type Boxes = BTreeMap<Vec<usize>, Found>;

/// Pieces drawn without a block that lie no farther from one another are of one thing, metres of a person.
const BESIDE_M: f64 = 0.1;

/// Where so many pieces of one kind lie loose they are not counted: there is one of them in a room, or none.
const LOOSE_MAX: usize = 1_500;

/// What stands in the rooms of a plan, by names of blocks and layers, and by what the file calls it.
pub fn find(drawing: &Drawing, plan: &Plan) -> Vec<Thing> {
    found(drawing, plan).iter().filter_map(|f| thing(plan, f)).collect()
}

/// Furniture that the file has as one and that can stand elsewhere: what it is, where it stands in the file, and how it is
/// written back.
pub fn furniture(drawing: &Drawing, plan: &Plan) -> Vec<(Thing, SourceRef, Editable)> {
    let of = |f: &Found| {
        let (source, editable) = f.whole.clone().filter(|_| f.kind.is_furniture())?;
        Some((thing(plan, f)?, source, editable))
    };
    found(drawing, plan).iter().filter_map(of).collect()
}

fn found(drawing: &Drawing, plan: &Plan) -> Vec<Found> {
    let hidden = Hidden::new(drawing);
    let mut kinds: HashMap<&str, Option<ThingKind>> = HashMap::new();
    let mut blocks = Boxes::new();
    let mut loose: BTreeMap<ThingKind, Vec<[DVec2; 2]>> = BTreeMap::new();
    for (i, e) in drawing.entities.iter().enumerate() {
        if is_own(&e.layer) || hidden.entity(e) {
            continue;
        }
        let Some(extent) = box_of(control_points(&e.shape).into_iter()) else { continue };
        let mut kind_of = |name| *kinds.entry(name).or_insert_with(|| kind_of_thing(name));
        let shown = e.blocks.iter().enumerate().find_map(|(k, b)| Some((k, kind_of(b.as_str())?)));
        if let Some((k, kind)) = shown.filter(|(k, _)| e.origin.inserts.len() > *k) {
            // What the outermost INSERT shows moves with it.
            let whole = (k == 0 && e.editable.moves_whole()).then(|| (e.source.clone(), e.editable.clone()));
            let new = || Found { kind, extent, whole };
            let of = blocks.entry(e.origin.inserts[..=k].to_vec()).or_insert_with(new);
            of.extent = [of.extent[0].min(extent[0]), of.extent[1].max(extent[1])];
            continue;
        }
        let is_stair = plan.reading.role(i) == Role::Stair;
        let kind = if is_stair { Some(ThingKind::Stair) } else { kind_of(e.layer.as_str()) };
        kind.iter().for_each(|kind| loose.entry(*kind).or_default().push(extent));
    }
    let metres = plan.frame.metres_per_unit / plan.human_scale;
    let loose = loose.into_iter().flat_map(|(kind, pieces)| {
        let boxes = joined(pieces, BESIDE_M / metres).into_iter();
        boxes.map(move |extent| Found { kind, extent, whole: None })
    });
    let called = drawing.called.iter().filter_map(|c| {
        let whole = c.source.clone().map(|source| (source, Editable::WithInsert { turnable: true }));
        Some(Found { kind: kind_of_thing(&c.words)?, extent: c.extent, whole })
    });
    blocks.into_values().chain(called).chain(loose).collect()
}

/// Boxes that lie no farther than `near` from one another as one.
fn joined(mut pieces: Vec<[DVec2; 2]>, near: f64) -> Vec<[DVec2; 2]> {
    let mut at = 0;
    while pieces.len() <= LOOSE_MAX && at < pieces.len() {
        let [lo, hi] = pieces[at];
        let is_beside = |[l, h]: &[DVec2; 2]| (*l - near).cmple(hi).all() && (*h + near).cmpge(lo).all();
        match (at + 1..pieces.len()).find(|k| is_beside(&pieces[*k])) {
            Some(other) => {
                let [l, h] = pieces.swap_remove(other);
                pieces[at] = [lo.min(l), hi.max(h)];
            }
            None => at += 1,
        }
    }
    pieces
}

fn thing(plan: &Plan, &Found { kind, extent, .. }: &Found) -> Option<Thing> {
    let longer_m = (extent[1] - extent[0]).max_element() * plan.frame.metres_per_unit / plan.human_scale;
    let longest_m = if kind == ThingKind::Stair { LONGEST_FLIGHT_M } else { LONGEST_M };
    let is_thing = (SHORTEST_M..=longest_m).contains(&longer_m);
    is_thing.then_some(Thing { kind, extent: extent.map(|p| plan.frame.um_from_file(p)) })
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
            assert_eq!(kind_of_thing(name), kind, "{name}");
        }
    }
}
