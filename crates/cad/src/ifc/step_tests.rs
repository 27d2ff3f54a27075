use proptest::prelude::*;

use super::*;

/// The instances and faults of a text, by the way that knows no cuts and nothing plain.
fn slowly(bytes: &[u8]) -> Result<(Vec<Instance>, Vec<Fault>), Fault> {
    let mut scan = Scan { bytes, at: 0 };
    let (mut instances, mut broken) = (Vec::new(), Vec::new());
    loop {
        scan.skip_blank()?;
        let at = scan.at;
        if scan.peek() != Some(b'#') {
            return Ok((instances, broken));
        }
        let end = scan.statement()?;
        match instance(bytes, at..end) {
            Ok(instance) => instances.push(instance),
            Err(fault) => broken.push(fault),
        }
    }
}

/// Pieces of STEP in any order, with line ends inside and outside texts.
fn text() -> impl Strategy<Value = Vec<u8>> {
    let whole = [
        "\n#1=IFCWALL('a',#2,$,*,(1.,-2.5E-3),.T.,IFCLABEL('b'));",
        "\r\n#12 = IFCX ( ( #1 , #2 ) , \n () );",
        "\n#3=IFCX('it''s \\X2\\00E4\\X0\\ \\S\\'';\n#4=IFCY(');",
        "\n#5=(IFCA(1)IFCB(2.));",
        "\n#6=ifcx(/* ; */1,\"0F\",.true.);",
    ];
    let pieces = [
        "#", "7", "=", "IFCX", "(", ")", ";", ",", "'", "''", "\\", "\\S\\", "\n#", "\n", " ", "$", "*",
        ".T.", "1.", "-", "E5", "1E400", ".5", "+1", "/*", "*/", "\"", "\0", "x",
    ];
    let of = |list: Vec<&'static str>| prop::sample::select(list);
    let part = prop_oneof![3 => of(whole.to_vec()), 1 => of(pieces.to_vec())];
    prop::collection::vec(part, 0..40).prop_map(|parts| {
        // Something that is no blank ends every text: what follows the last instance is another's business.
        let text: String = parts.concat();
        text.trim_start().as_bytes().to_vec()
    })
}

proptest! {
    /// What is taken apart in one go, and in parts, is what the slow way says.
    #[test]
    fn parts_are_the_whole(bytes in text(), cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..4)) {
        let slow = slowly(&bytes);
        let one = Part::read(&bytes, 0, bytes.len());
        match (&slow, &one.end) {
            (Ok((instances, broken)), Ok(_)) => {
                prop_assert_eq!(&one.instances, instances);
                prop_assert_eq!(&one.broken, broken);
            }
            (Err(a), Err(b)) => prop_assert_eq!(a, b),
            other => prop_assert!(false, "{:?}", other),
        }
        for cut in cuts.iter().filter(|_| !bytes.is_empty()).map(|c| c.index(bytes.len())) {
            let first = Part::read(&bytes, 0, cut);
            let Ok(end) = first.end else { continue };
            let rest = Part::read(&bytes, end, bytes.len());
            if end >= cut {
                let both = [first.instances, rest.instances].concat();
                prop_assert_eq!(&both, &one.instances);
            }
        }
    }
}

proptest! {
    /// Numbers read in one go are those that are nearest.
    #[test]
    fn plain_numbers_are_exact(word in "-?[0-9]{0,17}\\.?[0-9]{0,17}") {
        if let Some(found) = plain_real(word.as_bytes()) {
            prop_assert_eq!(found.to_bits(), word.parse::<f64>().unwrap().to_bits());
        }
        prop_assert_eq!(real(word.as_bytes()), word.parse::<f64>().ok());
    }
}

#[test]
fn a_cut_inside_a_text_is_no_cut() {
    let long = "x".repeat(PART_BYTES_MIN / 8);
    let one = |i: usize| {
        // Lines within a text that look like instances, where cuts may fall.
        let inside: String = (0..16).map(|k| format!("\n#{k}=IFCFALSE('';{long}")).collect();
        format!("\n#{}=IFCWALL('{inside}',$);\n#{}=IFCX(1.);", 2 * i + 1, 2 * i + 2)
    };
    let data: String = (0..12).map(one).collect();
    let file = format!("ISO-10303-21;HEADER;ENDSEC;DATA;{data}\nENDSEC;END-ISO-10303-21;");
    assert!(cuts(file.as_bytes(), 32).len() == PARTS);
    let step = Step::read(file.as_bytes()).unwrap();
    assert!(step.broken.is_empty(), "{:?}", step.broken);
    let ids: Vec<u64> = step.instances.iter().map(|i| i.id).collect();
    assert_eq!(ids, (1..=24).collect::<Vec<_>>());
    assert_eq!(step.data_end, file.len() - "ENDSEC;END-ISO-10303-21;".len());
}
