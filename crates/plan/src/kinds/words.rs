//! What rooms are called, as data.

use std::sync::LazyLock;

use super::RoomKind;
use enfilade_cad::names::{bare, folded};
use enfilade_cad::names::{is_joined, words};

/// Words of names, in the order in which one wins over another that stands beside it: `Bath / WC` is a bath, `Bedroom
/// closet` storage. What is private wins over what is not, but for kitchens and living rooms with a utility corner.
///
/// `_` joins the words of a phrase. `*` begins what may end a longer word, and ends what may begin one. `=` begins what
/// must be the whole name but for numbers. Of words within each other the longest counts. Words of Chinese, Japanese and
/// Korean stand anywhere.
const WORDS: &[(RoomKind, &str)] = &[
    (
        RoomKind::Outside,
        "outside outdoor outdoors exterior balcony balconies terrace terraces patio patios deck decks veranda verandah \
         porch porches courtyard courtyards court loggia lanai garden yard backyard atrium_open driveway \
         balkon balkone terrasse terrassen dachterrasse *terrasse hof innenhof garten laube vorplatz freisitz wintergarten_offen \
         balcon balcons jardin cour exterieur perron balcone balconi terrazza terrazzo terrazze cortile giardino portico esterno \
         terraza terrazas balcones jardin exterior porche azotea varanda varandas terraco sacada quintal jardim alpendre \
         balkons terras terrassen tuin binnenplaats buiten taras tarasy loggie ogrod dziedziniec weranda ganek podcien \
         терраса террасы балкон лоджия веранда крыльцо двор сад патио terasa lodzie zahrada dvur avlu bahce teras balkonu \
         阳台 露台 庭院 院子 花园 天井 入户花园 生活阳台 バルコニー ベランダ テラス ポーチ 庭 ウッドデッキ 발코니 테라스 베란다",
    ),
    (
        RoomKind::Storage,
        "storage stor store stores storeroom storerooms closet closets cupboard cupboards wardrobe pantry larder cellar cellars \
         archive archives archiv wic walk_in walkin linen broom cleaner cleaners cleaning janitor janitors custodian supply supplies shed \
         cold_store strong_room copy_store wine *storage \
         abstellraum abstellkammer abstell* abst abstr lager *lager lagerraum *lagerraum vorrat vorratsraum vorrats* speis speise* speisekammer kammer keller kellerraum \
         *keller putzraum putzmittel* reinigung schrankraum schrank aktenraum aktenlager reduit rumpelkammer besenkammer \
         rangement rangements placard placards dressing cellier cave debarras reserve stockage remise entrepot menage local_menage archives \
         ripostiglio ripostigli dispensa cantina deposito depositi magazzino guardaroba cabina_armadio armadio sgabuzzino archivio \
         trastero despensa almacen bodega armario vestidor deposito archivo cuarto_de_limpieza limpieza \
         arrumos arrecadacao arrumo despensa dispensa roupeiro armazem deposito arquivo closet adega \
         berging bergruimte kast voorraad magazijn opslag kelder provisiekast archief inloopkast werkkast \
         spizarnia magazyn schowek garderoba skladzik pomieszczenie_gospodarcze pom_gospodarcze pom_gosp piwnica archiwum komorka spizarka \
         кладовая кладов* гардероб* гардеробная склад чулан архив подсобное подсобка подсобн* погреб шкаф хранен* пуи \
         sklad komora spiz spizirna satna uklid uklidova archiv depo kiler arsiv ardiye \
         储藏 储藏室 储物 储物间 贮藏 库房 仓库 衣帽间 档案室 杂物间 收纳 収納 物入 押入 納戸 クローゼット クロゼット パントリー 倉庫 창고 팬트리 드레스룸",
    ),
    (
        RoomKind::Bath,
        "bath baths bathroom bathrooms bathrm bathrms shower showers ensuite en_suite powder_bath tub \
         bad baeder bader badezimmer badraum duschbad dusche duschen duschraum *bad *dusche nasszelle sanitarraum sanitaer* sanitar* \
         salle_de_bain salle_de_bains salles_de_bains salle_d_eau salle_de_douche bain bains douche douches sdb sde sd_b sd_e cabinet_de_toilette sanitaires \
         bagno bagni doccia docce servizio_igienico servizi_igienici =servizi stanza_da_bagno =wc_bagno \
         bano banos cuarto_de_bano aseo_completo ducha duchas sala_de_bano \
         banheiro banheiros casa_de_banho quarto_de_banho banho banhos chuveiro i_s instalacao_sanitaria instalacoes_sanitarias \
         badkamer badkamers doucheruimte natte_cel lazienka lazienki prysznic natrysk umywalnia \
         ванная ванна ванн* санузел сан_узел санузлы *узел душ душев* су совмещенный_санузел \
         koupelna koupelny sprcha banyo banyosu dus \
         浴室 卫生间 浴 卫浴 主卫 客卫 次卫 公卫 淋浴间 淋浴 盥洗室 洗面 洗面所 洗面室 脱衣 脱衣室 風呂 ユニットバス UB 욕실 화장실",
    ),
    (
        RoomKind::Wc,
        "wc wcs toilet toilets lavatory lavatories water_closet restroom restrooms rest_room washroom washrooms wash_room loo powder powder_room half_bath toil \
         urinal urinals cubicle ladies gents wc* *wc \
         toilette toiletten klo abort gastewc pissoir toilettes w_c toilettenraum \
         aseo aseos servicios bano_social lavabo lavabos sanitario sanitarios gabinetto gabinetti antibagno \
         sanita retrete toalete lavabo toiletruimte toaleta toalety ubikacja ustep туалет туалеты уборная \
         toaleta zachod zachody tuvalet tuvaletler hela 厕所 洗手间 女厕 男厕 公厕 便所 トイレ 便器 手洗",
    ),
    (
        RoomKind::Changing,
        "changing locker lockers dressing_room fitting_room cloak cloakroom cloaks coats \
         umkleide umkleiden umkleide* ankleide* ankleide garderobe garderoben *garderobe \
         vestiaire vestiaires spogliatoio spogliatoi vestuario vestuarios vestiario balneario_vestiario kleedkamer kleedruimte kleedkamers \
         szatnia szatnie przebieralnia раздевалка раздевал* раздевальная prevlekarna soyunma giyinme 更衣 更衣室 ロッカー室 탈의실",
    ),
    (
        RoomKind::Bedroom,
        "bed beds bedroom bedrooms bedrm bedrms bdrm bdrms bed_room sleeping master nursery guest_room guestroom child_room kids dormitory =br =mbr =m_br =mb =bd \
         schlafzimmer schlafraum schlafen schlaf eltern elternzimmer kind kinder kinderzimmer kizi gast gaste gastezimmer *schlafzimmer *kinderzimmer =sz =schl jugendzimmer madchen \
         chambre chambres chambre_d_amis dortoir coucher suite_parentale \
         camera camere camera_da_letto camera_matrimoniale cameretta camerette letto matrimoniale singola =cam \
         dormitorio dormitorios recamara recamaras alcoba alcobas dorm habitacion_principal habitacion habitaciones \
         quarto_de_casal quarto_casal dormitorio dormitorios quarto quartos \
         slaapkamer slaapkamers slapen ouderslaapkamer kinderkamer logeerkamer \
         sypialnia sypialnie sypialny pokoj_dziecka pokoj_dzieci pokoj_dzieciecy pokoj_goscinny pokoj_rodzicow \
         спальня спальни спальн* детская детск* гостевая_комната гостевая опочивальня \
         loznice detsky_pokoj pokoj_deti pokoj_pro_hosty yatak yatak_odasi cocuk_odasi misafir_odasi ebeveyn ebeveyn_yatak \
         卧室 主卧 次卧 客卧 客房 儿童房 老人房 主人房 小孩房 寝室 主寝室 子供室 子供部屋 客間 침실 안방 아이방",
    ),
    (
        RoomKind::Garage,
        "garage garages carport carports parking car_park garagen *garage tiefgarage stellplatz stellplatze stationnement autorimessa \
         posto_auto box_auto garaje garajes cochera aparcamiento garagem garagens estacionamento parkeren garaz garaze гараж гаражи парковка машиноместо \
         garaze otopark garaj 车库 停车 車庫 ガレージ 駐車場 주차장 차고",
    ),
    (
        RoomKind::Stair,
        "stair stairs staircase staircases stairway stairwell stairhall strs treppe treppen treppenhaus treppenraum *treppenhaus *treppe stiegenhaus stiege \
         escalier escaliers cage_d_escalier scala vano_scala vano_scale escalera escaleras caja_de_escaleras escada escadas caixa_de_escadas \
         trap trappen trappenhuis trapgat klatka klatka_schodowa schody лестница лестнич* лестничная_клетка schodiste schody merdiven merdiven_holu \
         楼梯 楼梯间 梯间 疏散楼梯 階段 階段室 계단 계단실",
    ),
    (
        RoomKind::Ward,
        "ward wards patient patients treatment examination exam consulting consultation surgery recovery \
         krankenzimmer patientenzimmer bettenzimmer behandlung behandlungsraum *behandlung untersuchung sprechzimmer \
         chambre_malade soins salle_de_soins degenza ambulatorio consulta consultorio enfermaria patientenkamer behandelkamer gabinet_lekarski sala_chorych \
         палата палаты процедурная смотровая pokoj_pacienta ordinace hasta_odasi muayene 病房 诊室 治疗室 病室 診察室 처치실 병실",
    ),
    (
        RoomKind::Class,
        "class classroom classrooms teaching lecture lesson seminar_room group_room klasse klassen klassenzimmer klassenraum *klassenzimmer unterricht* horsaal gruppenraum kursraum seminarraum \
         salle_de_classe salle_de_cours classe aula aule aula_didattica classe laboratorio_didattico aulas sala_de_aula salas_de_aula salon_de_clases klaslokaal lokaal leslokaal \
         klasa sala_lekcyjna sala_wykladowa sala_dydaktyczna класс классы учебный* учебн* аудитория trida ucebna derslik sinif 教室 课室 普通教室 강의실 교실",
    ),
    (
        RoomKind::Meeting,
        "meeting meetings conference conf boardroom board_room mtg huddle auditorium besprechung besprechungs* besprechungsraum *besprechung konferenz konferenz* sitzung* sitzungszimmer tagung* \
         salle_de_reunion salle_de_conference reunion reunions conference sala_riunioni riunioni sala_conferenze conferenze sala_de_reuniones sala_de_juntas reuniones juntas \
         sala_de_reunioes reunioes reuniao sala_de_reuniao vergader* vergaderzaal vergaderruimte spreekkamer sala_konferencyjna konferencyjna sala_spotkan narad sala_narad spotkan \
         переговорная переговор* конференц* совещан* zasedaci zasedacka jednaci toplanti toplanti_odasi 会议 会议室 洽谈 洽谈室 会議室 打合せ 応接 회의실",
    ),
    (
        RoomKind::Reception,
        "reception receptions waiting recept rezeption empfang wartezimmer wartebereich warte* warteraum accueil attente salle_d_attente salle_attente reception \
         sala_d_attesa sala_di_attesa sala_attesa attesa accettazione recepcion sala_de_espera espera recepcao receptie wachtkamer wachtruimte wachten recepcja poczekalnia \
         ресепшн ресепшен приемная приёмная ожидан* зал_ожидания recepce cekarna resepsiyon bekleme danisma 前台 接待 接待室 候诊 受付 待合 안내",
    ),
    (
        RoomKind::Office,
        "office offices study studies studio workroom work_room workspace workplace open_plan home_office staff staff_room teachers staffroom principal =off \
         buro buros buero bueros buroraum *buro *buero arbeitszimmer arbeiten arbeitsraum sekretariat lehrerzimmer lehrer verwaltung direktion direktor =az \
         bureau bureaux cabinet cabinets secretariat salle_des_professeurs salle_des_maitres direction ufficio uffici segreteria sala_professori sala_insegnanti direzione \
         oficina oficinas despacho despachos estudio secretaria direccion sala_de_profesores escritorio escritorios gabinete gabinetes secretaria sala_de_professores diretoria direcao \
         kantoor kantoren werkkamer studeerkamer lerarenkamer biuro biura gabinet gabinety pokoj_biurowy pracownia sekretariat pokoj_nauczycielski dyrektor \
         офис офисы кабинет кабинеты учительская рабочий_кабинет бухгалтерия директор секретариат kancelar kancelare pracovna kabinet sborovna reditelna ofis calisma calisma_odasi ogretmenler \
         办公 办公室 书房 教师办公室 经理室 事務室 書斎 オフィス 職員室 執務室 사무실 서재",
    ),
    (
        RoomKind::Living,
        "living livingroom living_room liv lounge family family_room great great_room sitting drawing_room den parlour parlor play playroom sunroom sun_room games_room living_dining living_kitchen \
         wohnen wohnzimmer wohnraum *wohnzimmer wohn wohnkuche wohnbereich *wohnen stube wohnesszimmer wintergarten =wz \
         sejour salon salons piece_a_vivre piece_de_vie salle_de_sejour veranda_fermee soggiorno soggiorni salotto salone zona_giorno living \
         sala sala_de_estar salas estar salon_comedor salon living estancia sala_de_estar_e_jantar sala_comum sala_de_tv \
         woonkamer woonkamers wonen zitkamer living leefruimte salon pokoj_dzienny salonik pokoj_dzienny_z_aneksem \
         гостиная гостин* зал кухня_гостиная общая_комната студия obyvaci obyvaci_pokoj obyvak oturma oturma_odasi salon \
         客厅 起居室 起居 起居厅 厅 居間 リビング LDK ldk 居室 茶の間 거실",
    ),
    (
        RoomKind::Dining,
        "dining dining_room diningroom dinette breakfast breakfast_room nook cafeteria canteen restaurant cafe mensa eating mess \
         esszimmer essen essplatz *esszimmer speisesaal kantine essbereich =ez salle_a_manger repas cantine refectoire sala_da_pranzo pranzo tinello refettorio comedor comedores cafetera \
         sala_de_jantar jantar refeitorio cantina_escolar copa eetkamer eten eethoek kantine jadalnia jadalnie stolowka столовая столовые обеденн* jidelna jidelni yemek yemek_odasi yemekhane \
         餐厅 饭厅 食堂 ダイニング 식당 다이닝",
    ),
    (
        RoomKind::Kitchen,
        "kitchen kitchens kitchenette kit kitch pantry_kitchen scullery cooking tea_kitchen tea_point kuche kuchen kueche kochen kochnische *kuche *kueche teekuche kochbereich =ku \
         cuisine cuisines kitchenette coin_cuisine cucina cucine angolo_cottura cucinino cocina cocinas cozinha cozinhas copa_cozinha keuken keukens pantry_keuken \
         kuchnia kuchnie aneks_kuchenny aneks кухня кухни кухн* kuchyne kuchyn kuchynsky kuchynsky_kout mutfak mutfagi 厨房 厨 西厨 中厨 茶水间 台所 キッチン 주방 부엌 탕비실",
    ),
    (
        RoomKind::Plant,
        "plant mechanical mech electrical elec technical utility utilities util wash it_room it_rm laundry laundries boiler furnace server servers data_room comms riser shaft shafts lift lifts elevator elevators duct switch_room meter machine_room machinery plant_room mud_laundry \
         technik technikraum haustechnik *technik hwr hauswirtschaft hauswirtschaftsraum hausanschluss* hausanschlussraum heizung heizraum heizungs* waschkuche waschraum waschmaschine serverraum *server schacht *schacht aufzug aufzuge fahrstuhl elektro* luftung* traforaum =hau =har \
         technique local_technique buanderie chaufferie chaudiere lingerie ascenseur gaine gaines local_poubelle locale_tecnico tecnico lavanderia caldaia centrale_termica ascensore cavedio vano_tecnico \
         cuarto_de_maquinas maquinas instalaciones lavadero lavanderia caldera ascensor ascensores cuarto_tecnico lavandaria area_tecnica casa_das_maquinas area_de_servico elevador elevadores \
         techniek technische technische_ruimte bijkeuken wasruimte cv installatie* meterkast lift liftschacht kotlownia pomieszczenie_techniczne pom_techniczne techniczne pralnia serwerownia winda szyb wentylatorownia \
         котельная топочная бойлерная техническое техническ* тех_помещение прачечная постирочная серверная щитовая электрощитовая лифт вентиляц* венткамера шахта \
         kotelna technicka technicka_mistnost pradelna strojovna vytah kazan kazan_dairesi camasir camasirlik camasir_odasi tesisat asansor makine_dairesi \
         设备 设备间 设备房 机房 配电 洗衣 洗衣房 电梯 电梯间 水井 电井 管道井 強電 弱电 机械室 機械室 電気室 サーバー室 エレベーター EV EPS PS 洗濯 ランドリー 기계실 세탁실 다용도실 보일러실",
    ),
    (
        RoomKind::Corridor,
        "corridor corridors corr passage passageway hallway hallways circulation aisle gang flur flure korridor *flur *gang couloir couloirs degagement degagements circulation corridoio corridoi disimpegno disimpegni \
         pasillo pasillos pasadizo distribuidor corredor corredores circulacao gang gangen overloop verkeersruimte korytarz korytarze komunikacja коридор коридоры chodba chodby koridor \
         走廊 过道 走道 廊下 通路 내부복도 복도",
    ),
    (
        RoomKind::Hall,
        "hall halls entry entrance entryway foyer vestibule lobby landing mudroom mud mud_room airlock ante anteroom \
         diele eingang *eingang windfang vorraum vorzimmer halle *halle eingangshalle entree entrees hall_d_entree sas palier vestibule ingresso ingressi atrio anticamera \
         entrada recibidor vestibulo zaguan hall_de_entrada atrio vestibulo hal halletje portaal entree inkom voorportaal hol przedpokoj przedpokoje sien wiatrolap przedsionek holl \
         прихожая прихож* холл тамбур вестибюль фойе сени predsin hala zadveri vstup antre giris hol sofa_hol 玄关 门厅 门廊 大厅 大堂 前室 玄関 ホール エントランス 현관 홀",
    ),
    (
        RoomKind::Other,
        "library libraries bibliothek bibliotheque biblioteca bibliotheek biblioteka библиотека knihovna kutuphane 图书室 図書室 gym fitness gallery exhibition ausstellung exposition museum \
         lab labs laboratory labor laboratoire laboratorio laboratorium лаборатория workshop werkstatt atelier shop laden magasin negozio tienda loja winkel sklep магазин obchod dukkan \
         factory production chapel kapelle pool sauna void luftraum vide 店 商铺 作業室",
    ),
];

/// Words that mean a room of which nobody says what it is for: in a dwelling mostly one to sleep in.
const WEAK: &[(RoomKind, &str)] = &[(
    RoomKind::Bedroom,
    "zimmer *zimmer pokoj pokoje cuarto cuartos kamer kamers oda odasi комната комнаты жилая жилая_комната stanza stanze piece chambrette mistnost guest slaap suite suites \
     房间 洋室 和室 방",
)];

/// A word of a pattern.
enum Word {
    Whole(String),
    /// May end a longer one.
    End(String),
    /// May begin a longer one.
    Start(String),
    /// May stand anywhere in one.
    Joined(String),
}

impl Word {
    fn of(text: &str) -> Self {
        let word = bare(text.trim_matches('*'));
        match (text.starts_with('*'), text.ends_with('*')) {
            (true, _) => Self::End(word),
            (_, true) => Self::Start(word),
            _ if is_joined(&word) => Self::Joined(word),
            _ => Self::Whole(word),
        }
    }

    fn text(&self) -> &str {
        let (Self::Whole(w) | Self::End(w) | Self::Start(w) | Self::Joined(w)) = self;
        w
    }

    fn fits(&self, word: &str) -> bool {
        match self {
            Self::Whole(w) => word == w,
            Self::End(w) => word.ends_with(w.as_str()),
            Self::Start(w) => word.starts_with(w.as_str()),
            Self::Joined(w) => word.contains(w.as_str()),
        }
    }
}

/// A pattern of the tables.
struct Pattern {
    kind: RoomKind,
    is_sure: bool,
    words: Vec<Word>,
    letters: usize,
    is_whole: bool,
}

impl Pattern {
    fn new(kind: RoomKind, is_sure: bool, text: &str) -> Self {
        let words: Vec<Word> = text.trim_start_matches('=').split('_').map(Word::of).collect();
        let letters = words.iter().map(|w| w.text().chars().count()).sum();
        Self { kind, is_sure, words, letters, is_whole: text.starts_with('=') }
    }
}

/// What a name says of a room.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameFound {
    /// The kind.
    pub kind: RoomKind,
    /// Whether the name says it outright.
    pub is_sure: bool,
    /// The word that says it, without accents.
    pub word: String,
}

static PATTERNS: LazyLock<Vec<Pattern>> = LazyLock::new(|| {
    let lists = WORDS.iter().map(|w| (true, w)).chain(WEAK.iter().map(|w| (false, w)));
    let of = |(is_sure, (kind, list)): (bool, &(RoomKind, &'static str))| {
        let kind = *kind;
        list.split_ascii_whitespace().map(move |text| Pattern::new(kind, is_sure, text))
    };
    lists.flat_map(of).collect()
});

/// Where a kind stands in the order in which one wins over another.
pub(super) fn rank(kind: RoomKind) -> usize {
    WORDS.iter().position(|(k, _)| *k == kind).unwrap_or(WORDS.len())
}

/// The words of a name without accents; initials are one: `W.C.`, `w/c`.
fn words_of(name: &str) -> Vec<String> {
    let is_between = |c: char| c.is_whitespace() || "-–_,;:()[]+&\\".contains(c);
    let mut out = Vec::new();
    for part in name.split(is_between).filter(|p| !p.is_empty()) {
        let initials: Vec<&str> = part.split(['.', '/']).filter(|p| !p.is_empty()).collect();
        let are_initials = initials.len() > 1
            && initials.iter().all(|p| p.chars().count() == 1 && p.chars().all(char::is_alphabetic));
        match are_initials {
            true => out.push(bare(&initials.concat())),
            false => out.extend(words(part).iter().map(|w| bare(w))),
        }
    }
    out.retain(|w| !w.is_empty());
    out
}

/// A place where a pattern fits: its first word, and the one behind its last.
fn places<'p>(words: &'p [String], pattern: &'p Pattern) -> impl Iterator<Item = [usize; 2]> + 'p {
    let n = pattern.words.len();
    let last = if pattern.is_whole && words.len() != n { 0 } else { (words.len() + 1).saturating_sub(n) };
    let is_here = move |i: &usize| words[*i..*i + n].iter().zip(&pattern.words).all(|(w, p)| p.fits(w));
    (0..last).filter(is_here).map(move |i| [i, i + n])
}

/// What a name says a room is for; `None` where it has no word that is known.
pub fn kind_of_name(name: &str) -> Option<NameFound> {
    let words = words_of(name);
    let all: Vec<(&Pattern, [usize; 2])> =
        PATTERNS.iter().flat_map(|p| places(&words, p).map(move |at| (p, at))).collect();
    // Within one another: the longer phrase, then the longer word.
    let is_beaten = |(p, [from, to]): &(&Pattern, [usize; 2])| {
        all.iter().any(|(q, [f, t])| {
            let is_longer = (t - f, q.letters) > (to - from, p.letters);
            f <= from && to <= t && is_longer && !are_apart(&words[*f..*t], q, p)
        })
    };
    let best = all.iter().filter(|m| !is_beaten(m)).min_by_key(|(p, at)| (!p.is_sure, rank(p.kind), at[0]));
    best.map(|(p, [from, to])| NameFound {
        kind: p.kind,
        is_sure: p.is_sure,
        word: words[*from..*to].join(" "),
    })
}

/// Whether both of two words stand in one word of a script without blanks.
fn are_apart(words: &[String], longer: &Pattern, shorter: &Pattern) -> bool {
    match (words, &longer.words[..], &shorter.words[..]) {
        ([_], [Word::Joined(longer)], [Word::Joined(shorter)]) => !longer.contains(shorter.as_str()),
        _ => false,
    }
}

/// Most words of a text that names a room; what is longer, or ends with a colon, is a note.
const SHORT: usize = 3;

/// Whether a text may be a name rather than a note.
pub(super) fn is_short(text: &str) -> bool {
    !text.trim_end().ends_with(':') && words_of(text).len() <= SHORT
}

/// Words before or after which the number or letter of a dwelling stands.
const DWELLINGS: &str = "wohnung whg we wohneinheit top flat apartment apt appartement apartament appart logement lgt unit dwelling appartamento alloggio \
     piso vivienda apartamento departamento depto fraccao lakas mieszkanie lokal квартира кв appartements woning byt daire 户型 住戸 号室";

/// The dwelling that a text names: `wohnung 2`, `flat b`.
pub fn dwelling_of_name(text: &str) -> Option<String> {
    let text = folded(text);
    let tokens: Vec<&str> = text.split(|c: char| !c.is_alphanumeric()).filter(|t| !t.is_empty()).collect();
    let is_listed = |t: &str| DWELLINGS.split_ascii_whitespace().any(|w| bare(w) == bare(t));
    let is_mark = |t: &str| t.len() <= 4 && (t.chars().count() == 1 || t.chars().any(|c| c.is_ascii_digit()));
    tokens.windows(2).find(|w| is_listed(w[0]) && is_mark(w[1])).map(|w| format!("{} {}", w[0], w[1]))
}
