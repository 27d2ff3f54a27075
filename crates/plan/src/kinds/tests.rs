use super::*;
use RoomKind::*;

/// Words for the same rooms in one language a line: kitchen, living, dining, bedroom, bath, WC, corridor, hall, stair,
/// storage, office, meeting, class, plant, garage, balcony; `-` where none is asked for.
const LANGUAGES: [&str; 13] = [
    "Kitchen|Living Room|Dining|Bed 2|Master Bath|W.C.|Corridor|Entrance Hall|Stairs|Walk-in Closet|Study|Meeting Room|Classroom 3|Plant Room|Garage|Balcony",
    "KÜCHE|Wohnzimmer|Essen|Schlafzimmer|Kinderbad|Gäste-WC|Flur|Diele|Treppenhaus|Abstellraum|Büro 2|Besprechung|Klasse 5a|Haustechnik|Garage|Dachterrasse",
    "Cuisine|Séjour|Salle à manger|Chambre 1|Salle de bains|Toilettes|Dégagement|Entrée|Escalier|Cellier|Bureau|Salle de réunion|Salle de classe|Local technique|Garage|Balcon",
    "Cucina|Soggiorno|Sala da pranzo|Camera da letto|Bagno|WC|Corridoio|Ingresso|Scala|Ripostiglio|Ufficio|Sala riunioni|Aula|Locale tecnico|Autorimessa|Terrazza",
    "Cocina|Sala de estar|Comedor|Dormitorio 2|Baño|Aseo|Pasillo|Recibidor|Escalera|Trastero|Despacho|Sala de juntas|Aulas|Cuarto de máquinas|Garaje|Terraza",
    "Cozinha|Sala de Estar|Sala de Jantar|Quarto 1|Casa de Banho|Lavabo|Corredor|Entrada|Escada|Despensa|Escritório|Sala de Reuniões|Sala de Aula|Área Técnica|Garagem|Varanda",
    "Keuken|Woonkamer|Eetkamer|Slaapkamer 2|Badkamer|Toilet|Overloop|Hal|Trappenhuis|Berging|Kantoor|Vergaderruimte|Leslokaal|Technische ruimte|Garage|Terras",
    "Kuchnia|Pokój dzienny|Jadalnia|Sypialnia|Łazienka|Toaleta|Korytarz|Przedpokój|Klatka schodowa|Spiżarnia|Biuro|Sala konferencyjna|Sala lekcyjna|Kotłownia|Garaż|Taras",
    "Кухня|Гостиная|Столовая|Спальня|Ванная|Туалет|Коридор|Прихожая|Лестничная клетка|Кладовая|Кабинет|Переговорная|Класс|Котельная|Гараж|Балкон",
    "厨房|客厅|餐厅|主卧|主卧卫生间|洗手间|走廊|门厅|楼梯间|储藏室|办公室|会议室|教室|设备间|车库|阳台",
    "Kuchyně|Obývací pokoj|Jídelna|Ložnice|Koupelna|Záchod|Chodba|Předsíň|Schodiště|Komora|Kancelář|Zasedačka|Učebna|Kotelna|Garáž|Terasa",
    "Mutfak|Oturma Odası|Yemek Odası|YATAK ODASI|Banyo|Tuvalet|Koridor|Antre|Merdiven|Kiler|Ofis|Toplantı Odası|Derslik|Tesisat|Garaj|Balkon",
    "台所|リビング|ダイニング|寝室|浴室|トイレ|廊下|玄関|階段|収納|事務室|会議室|教室|機械室|車庫|バルコニー",
];

const ORDER: [RoomKind; 16] = [
    Kitchen, Living, Dining, Bedroom, Bath, Wc, Corridor, Hall, Stair, Storage, Office, Meeting, Class,
    Plant, Garage, Outside,
];

#[test]
fn rooms_are_known_by_their_names_in_many_languages() {
    for line in LANGUAGES {
        for (name, kind) in line.split('|').zip(ORDER) {
            let found = kind_of_name(name).map(|f| (f.kind, f.is_sure));
            assert_eq!(found, Some((kind, true)), "{name} in {line}");
        }
    }
}

#[test]
fn of_several_words_the_closer_or_the_more_private_counts() {
    for (name, kind) in [
        ("Living/Dining/Kitchen", Living),
        ("Bad/WC", Bath),
        ("Bedroom Closet", Storage),
        ("MASTER BEDROOM", Bedroom),
        ("Wohnküche", Living),
        ("Waschküche", Plant),
        ("Eingang", Hall),
        ("Schlafen 1", Bedroom),
        ("Speisesaal", Dining),
        ("с/у", Bath),
        ("BR 2", Bedroom),
        ("Kü", Kitchen),
        ("SZ", Bedroom),
        ("SdB", Bath),
        ("Teachers' room", Office),
        ("LivingRoom", Living),
        ("客餐厅", Dining),
        ("Water Closet", Wc),
        ("1.03 Stair hall", Stair),
        ("Umkleide Damen", Changing),
        ("Wartezimmer", Reception),
        ("Krankenzimmer", Ward),
    ] {
        assert_eq!(kind_of_name(name).map(|f| f.kind), Some(kind), "{name}");
    }
    assert_eq!(kind_of_name("Zimmer 3").map(|f| (f.kind, f.is_sure)), Some((Bedroom, false)));
    for name in ["Room 12", "D1", "W-02", "T3", "2.45", "A2", "Raum", "12.5 m²", "Sprinkler", "Abroad", ""] {
        assert_eq!(kind_of_name(name), None, "{name}");
    }
}

#[test]
fn kinds_are_read_back() {
    for kind in RoomKind::ALL {
        assert_eq!(kind.name().parse(), Ok(kind));
    }
    assert_eq!("Bad".parse(), Ok(Bath));
    assert!("blue".parse::<RoomKind>().is_err());
}

#[test]
fn a_flat_is_named_with_its_number() {
    for (text, name) in [
        ("Wohnung 2", Some("wohnung 2")),
        ("FLAT B", Some("flat b")),
        ("Apt. 12", Some("apt 12")),
        ("кв. 5", Some("кв 5")),
        ("Flat roof", None),
        ("Bedroom 2", None),
    ] {
        assert_eq!(dwelling_of_name(text).as_deref(), name, "{text}");
    }
}

/// Rooms beside one another in a row, each of a width and 4 m deep, with what joins them and stands in them.
struct Row {
    rooms: Vec<Area>,
    names: Vec<Option<String>>,
    texts: Vec<Vec<String>>,
    ways: Vec<Way>,
    things: Vec<Thing>,
}

const DEEP_M: f64 = 4.0;

impl Row {
    fn of(rooms: &[(f64, &str)]) -> Self {
        let mut from = 0.0;
        let um = |m: f64| (m * 1e6).round() as i64;
        let mut area = |wide: f64| {
            let (a, b) = (um(from), um(from + wide));
            from += wide + 0.1;
            let outline = vec![[a, 0], [b, 0], [b, um(DEEP_M)], [a, um(DEEP_M)]];
            Area { outline, area_m2: wide * DEEP_M, ..Area::default() }
        };
        let named = |name: &str| Some(name.to_owned()).filter(|n| !n.is_empty());
        Self {
            rooms: rooms.iter().map(|r| area(r.0)).collect(),
            names: rooms.iter().map(|r| named(r.1)).collect(),
            texts: rooms.iter().map(|r| named(r.1).into_iter().collect()).collect(),
            ways: Vec::new(),
            things: Vec::new(),
        }
    }

    fn joins(mut self, kind: OpeningKind, pairs: &[[usize; 2]]) -> Self {
        let way = |pair: &[usize; 2]| Way { kind, beside: pair.map(Beside::Room) };
        self.ways.extend(pairs.iter().map(way));
        self
    }

    fn windows(mut self, rooms: &[usize]) -> Self {
        let way =
            |room: &usize| Way { kind: OpeningKind::Window, beside: [Beside::Room(*room), Beside::Outside] };
        self.ways.extend(rooms.iter().map(way));
        self
    }

    fn with(mut self, things: &[(usize, ThingKind)]) -> Self {
        for (room, kind) in things {
            let [x, y] = self.rooms[*room].outline[0];
            let lo = [x + 200_000, y + 300_000];
            self.things.push(Thing { kind: *kind, extent: [lo, [lo[0] + 500_000, lo[1] + 500_000]] });
        }
        self
    }

    fn found(&self, said: &[(usize, RoomKind)]) -> Vec<RoomKindFound> {
        kinds_of_rooms(&RoomsKnown {
            rooms: &self.rooms,
            names: &self.names,
            texts: &self.texts,
            ways: &self.ways,
            things: &self.things,
            said,
            human_scale: 1.0,
        })
    }

    fn kinds(&self) -> Vec<(RoomKind, bool)> {
        self.found(&[]).iter().map(|f| (f.kind, f.is_sure)).collect()
    }
}

#[test]
fn furniture_says_what_a_room_is_for() {
    use ThingKind as T;
    let row =
        Row::of(&[(1.0, ""), (2.0, ""), (3.5, ""), (2.5, ""), (6.0, ""), (4.0, ""), (9.0, "")]).with(&[
            (0, T::Toilet),
            (0, T::Basin),
            (1, T::Toilet),
            (1, T::Tub),
            (2, T::Bed),
            (2, T::Wardrobe),
            (3, T::Kitchen),
            (3, T::Fridge),
            (4, T::Sofa),
            (4, T::Table),
            (5, T::Desk),
            (5, T::Chair),
            (6, T::Toilet),
            (6, T::Bed),
        ]);
    let sure = [Wc, Bath, Bedroom, Kitchen, Living, Office].map(|k| (k, true));
    assert_eq!(row.kinds()[..6], sure);
    // A toilet beside a bed: the walls between them were not read.
    assert_eq!(row.kinds()[6], (Bedroom, false));
}

/// A sofa among offices is for those who wait.
#[test]
fn furniture_means_what_the_building_is_for() {
    use ThingKind as T;
    let row =
        Row::of(&[(5.0, "Office 1"), (5.0, "Office 2"), (5.0, "Office 3"), (6.0, ""), (6.0, "")]).with(&[
            (3, T::Sofa),
            (3, T::Sofa),
            (4, T::Table),
            (4, T::Chair),
            (4, T::Chair),
            (4, T::Chair),
            (4, T::Chair),
        ]);
    assert_eq!(row.kinds()[3..], [(Reception, false), (Meeting, false)]);
}

#[test]
fn names_overrule_furniture_and_the_user_all() {
    let row = Row::of(&[(3.0, "Office"), (3.0, "Zimmer"), (3.0, "XYZ hall of fame"), (3.0, "")]).with(&[
        (0, ThingKind::Bed),
        (1, ThingKind::Kitchen),
        (3, ThingKind::Bed),
    ]);
    assert_eq!(row.kinds(), [(Office, true), (Kitchen, true), (Hall, true), (Bedroom, true)]);
    let found = row.found(&[(0, Plant), (0, Bath)]);
    assert_eq!(
        (found[0].kind, found[0].is_private(), &found[0].evidence[..]),
        (Bath, true, &[Evidence::Said][..])
    );
}

/// A flat of which nothing but one bath is known: what may be a bedroom is taken for one, unsurely.
#[test]
fn rooms_without_names_are_guessed_by_size_doors_and_windows() {
    // Hall, bath, two rooms, a living room, a closet.
    let row = Row::of(&[(2.0, ""), (1.5, "Bad"), (3.2, ""), (3.6, ""), (7.0, ""), (0.6, "")])
        .joins(OpeningKind::Door, &[[0, 1], [0, 2], [0, 3], [0, 4], [0, 5]])
        .windows(&[2, 3, 4]);
    let kinds = row.kinds();
    assert_eq!(kinds[0], (Hall, true));
    assert_eq!(kinds[2..], [(Bedroom, false), (Bedroom, false), (Living, false), (Storage, false)]);
    assert_eq!(row.found(&[]).iter().filter(|f| f.dwelling == Some(0)).count(), 6);
}

#[test]
fn a_long_room_with_many_doors_is_a_corridor_and_offices_lie_beside_it() {
    let mut row = Row::of(&[(12.0, ""), (4.0, "Office 1"), (4.0, ""), (4.0, ""), (0.7, "")])
        .joins(OpeningKind::Door, &[[0, 1], [0, 2], [0, 3], [0, 4]])
        .windows(&[1, 2, 3]);
    // The corridor is 1.5 m wide.
    row.rooms[0].outline[2][1] = 1_500_000;
    row.rooms[0].outline[3][1] = 1_500_000;
    row.rooms[0].area_m2 = 18.0;
    let kinds = [(Corridor, true), (Office, true), (Office, false), (Office, false), (Storage, false)];
    assert_eq!(row.kinds(), kinds);
    assert!(row.found(&[]).iter().all(|f| f.dwelling.is_none()));
}

#[test]
fn two_flats_at_a_landing_are_two_dwellings() {
    let names =
        ["Stair", "Hall", "Kitchen", "Bath", "Bedroom", "Hall", "Kitchen", "Bath", "Bedroom", "Landing"];
    let rooms: Vec<(f64, &str)> = names.iter().map(|n| (3.0, *n)).collect();
    let pairs = [[0, 9], [9, 1], [1, 2], [1, 3], [1, 4], [9, 5], [5, 6], [5, 7], [5, 8]];
    let row = Row::of(&rooms).joins(OpeningKind::Door, &pairs);
    let dwellings = |row: &Row| row.found(&[]).iter().map(|f| f.dwelling).collect::<Vec<_>>();
    let (a, b) = (Some(0), Some(1));
    assert_eq!(dwellings(&row), [None, a, a, a, a, b, b, b, b, None]);
    // By what is written in their halls.
    let mut named = row;
    named.texts[1].push("Wohnung 1".into());
    named.texts[5].push("Wohnung 2".into());
    assert_eq!(dwellings(&named), [None, a, a, a, a, b, b, b, b, None]);
}

/// The upper storey of a pair of houses: no door joins their halves.
#[test]
fn halves_of_a_floor_that_no_door_joins_are_two_dwellings() {
    let rooms: Vec<(f64, &str)> =
        ["Hall", "Bedroom", "Bath", "Hall", "Bedroom", "Bath"].iter().map(|n| (3.0, *n)).collect();
    let row = Row::of(&rooms).joins(OpeningKind::Door, &[[0, 1], [0, 2], [3, 4], [3, 5]]);
    let dwellings: Vec<_> = row.found(&[]).iter().map(|f| f.dwelling).collect();
    assert_eq!(dwellings, [Some(0), Some(0), Some(0), Some(1), Some(1), Some(1)]);
}
