"""Plain data as TOML text: what a side-car needs, and no more."""

import math
from typing import Any, Dict, List

_SHORT = {"\b": "\\b", "\t": "\\t", "\n": "\\n", "\f": "\\f", "\r": "\\r", '"': '\\"', "\\": "\\\\"}


def dumps(table: Dict[str, Any]) -> str:
    """TOML of a table. Lists of tables become ``[[…]]``; ``None`` is left out."""
    lines: List[str] = []
    _table(lines, "", table)
    return "\n".join(lines).strip("\n") + "\n"


def _table(lines: List[str], path: str, table: Dict[str, Any]) -> None:
    inner = []
    for key, value in table.items():
        if isinstance(value, dict) or _is_tables(value):
            inner.append((key, value))
        elif value is not None:
            lines.append(f"{_key(key)} = {_value(value)}")
    for key, value in inner:
        name = f"{path}.{_key(key)}" if path else _key(key)
        for item in value if isinstance(value, list) else [value]:
            lines.append(f"\n[[{name}]]" if isinstance(value, list) else f"\n[{name}]")
            _table(lines, name, item)


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, dict) for v in value)


def _key(key: str) -> str:
    is_bare = key and all(c.isascii() and (c.isalnum() or c in "-_") for c in key)
    return key if is_bare else string(key)


def string(text: str) -> str:
    """A basic string."""
    out = []
    for c in text:
        if c in _SHORT:
            out.append(_SHORT[c])
        elif ord(c) < 0x20 or ord(c) == 0x7F or 0xD800 <= ord(c) <= 0xDFFF:
            out.append("\\uFFFD" if ord(c) >= 0xD800 else f"\\u{ord(c):04X}")
        else:
            out.append(c)
    return '"' + "".join(out) + '"'


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{value} has no place in a settings file")
        return repr(value)
    if isinstance(value, str):
        return string(value)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    raise TypeError(f"{type(value).__name__} has no TOML form here")
