"""Machine files from other controllers' settings: text in; tables, and an account of every setting, out."""

from __future__ import annotations

from trochia.errors import ConfigError, Source
from trochia.machine.importers.grbl import GRBL
from trochia.machine.importers.klipper import KLIPPER
from trochia.machine.importers.linuxcnc import LINUXCNC
from trochia.machine.importers.report import NO_PLACE, Imported, Importer, Setting, Unmapped

#: asked in this order when nobody says what a file is
IMPORTERS: dict[str, Importer] = {importer.kind: importer for importer in (GRBL, KLIPPER, LINUXCNC)}


def detect(text: str, file: str) -> Importer:
    """Return the importer that recognises a text.

    Raises
    ------
    ConfigError
        When none does.
    """
    for importer in IMPORTERS.values():
        if importer.recognises(text):
            return importer
    known = "; ".join(importer.title for importer in IMPORTERS.values())
    raise ConfigError(f"expected settings of a known controller ({known})", source=Source(file, 1),
                      hint=f"Say what it is: --from {'|'.join(IMPORTERS)}.")  # fmt: skip


__all__ = ["IMPORTERS", "NO_PLACE", "Imported", "Importer", "Setting", "Unmapped", "detect"]
