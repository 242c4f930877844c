"""What went wrong or looks wrong, as Python objects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Tuple


@dataclass(frozen=True)
class Diagnostic:
    """One message with its place: an error or a warning."""

    severity: str
    """``"error"`` or ``"warning"``."""
    kind: str
    """Whose fault it is: ``"script"``, ``"input"``, ``"output"``, ``"limit"``, ``"denied"``, ``"cancelled"`` or
    ``"internal"``."""
    code: str
    """The class, which stays where words change: ``"unknown-function"``."""
    message: str
    """What is wrong, in one line."""
    file: Optional[str]
    """The file, under the name it was given or named by."""
    line: Optional[int]
    """The line, from 1."""
    column: Optional[int]
    """The column in characters, from 1."""
    source_line: Optional[str]
    """The text of that line."""
    notes: Tuple[str, ...]
    """Further facts, such as the calls that led here."""
    hints: Tuple[str, ...]
    """What to write instead."""
    text: str
    """All of it, as a compiler writes it."""

    def __str__(self) -> str:
        return self.text


class Error(Exception):
    """Why there is no picture. ``str(error)`` has all errors with their places, notes and hints."""

    def __init__(self, diagnostics: Tuple[Diagnostic, ...], warnings: Tuple[Diagnostic, ...] = ()) -> None:
        super().__init__(diagnostics, warnings)
        self.diagnostics = diagnostics
        """All errors: what ended the run, then what else is wrong with the script."""
        self.warnings = warnings
        """Warnings that came before."""

    def __str__(self) -> str:
        return "\n".join(diagnostic.text for diagnostic in self.diagnostics)

    @property
    def kind(self) -> str:
        """Whose fault the first error is; see :class:`Diagnostic`."""
        return self.diagnostics[0].kind

    @property
    def code(self) -> str:
        """The class of the first error."""
        return self.diagnostics[0].code

    @property
    def message(self) -> str:
        """What is wrong, in one line."""
        return self.diagnostics[0].message

    @property
    def file(self) -> Optional[str]:
        """The file of the first error."""
        return self.diagnostics[0].file

    @property
    def line(self) -> Optional[int]:
        """Its line, from 1."""
        return self.diagnostics[0].line

    @property
    def column(self) -> Optional[int]:
        """Its column in characters, from 1."""
        return self.diagnostics[0].column

    @property
    def notes(self) -> Tuple[str, ...]:
        """Further facts about it."""
        return self.diagnostics[0].notes

    @property
    def hints(self) -> Tuple[str, ...]:
        """What to write instead."""
        return self.diagnostics[0].hints
