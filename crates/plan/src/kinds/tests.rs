use super::*;

#[test]
fn kinds_are_read_back() {
    for kind in RoomKind::ALL {
        assert_eq!(kind.name().parse(), Ok(kind));
    }
    assert_eq!("Bad".parse(), Ok(RoomKind::Bath));
    assert!("blue".parse::<RoomKind>().is_err());
}
