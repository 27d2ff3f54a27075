"""The error of this package."""

from __future__ import annotations

from typing import Optional


class Error(Exception):
    """A drawing, a setting or the machine keeps the program from going on. Nothing was written.

    Attributes:
        text: what was found, what was expected, what was done, with its place.
        code: stable name of the error, as ``"no-such-file"``; the book lists them under *Codes of findings*.
        file: the file that is meant; empty where none is.
        line: line of that file, from 1; ``None`` where none is meant.
        entity: the entity in the words of its format, as ``"LWPOLYLINE 2F3 layer A-WALL"``; else empty.
    """

    def __init__(
        self, text: str, code: str = "", file: str = "", line: Optional[int] = None, entity: str = ""
    ) -> None:
        super().__init__(text, code, file, line, entity)
        self.text, self.code, self.file, self.line, self.entity = text, code, file, line, entity

    def __str__(self) -> str:
        return self.text
