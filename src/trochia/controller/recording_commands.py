"""The commands that start and end a recording.  They are taken in every state and change none: nothing moves by them.

In: a command, the folder of recordings.  Out: its answer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.controller.recording import Take
from trochia.errors import TrochiaError
from trochia.messages import Ack
from trochia.messages.command import Record

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.controller.controller import Controller
    from trochia.controller.recording import Recorder
    from trochia.messages.command import RecordStop


def taken_by(recorder: Recorder, command: Record | RecordStop, folder: Path | None, controller: Controller) -> Ack:
    """Start or end a recording; return the answer."""
    if not isinstance(command, Record):
        path = recorder.stop()
        if path is None:
            return Ack(id=command.id, ok=False, reason="nothing is being recorded")
        controller.note("recording", text="ended", path=str(path))
        return Ack(id=command.id, ok=True, told=path.name)
    if folder is None:
        return Ack(id=command.id, ok=False, reason="there is no folder for recordings: start with --recordings FOLDER")
    path = folder / (command.name or free_name(folder))
    if path.exists():
        return Ack(id=command.id, ok=False, reason=f"there is a recording {path.name} already")
    try:
        take = Take(path=path, channels=command.channels, triggers=command.triggers, before=command.before,
                    after=command.after, limit=command.limit)  # fmt: skip
        recorder.start(take, program="" if controller.loaded is None else controller.loaded[0])
    except (TrochiaError, OSError) as error:
        return Ack(id=command.id, ok=False, reason=str(error))
    controller.note("recording", text="begun", path=str(path))
    return Ack(id=command.id, ok=True, told=path.name)


def free_name(folder: Path) -> str:
    """Return the first ``recording-N`` behind all there are."""
    numbers = [int(entry.name.removeprefix("recording-")) for entry in folder.glob("recording-*")
               if entry.name.removeprefix("recording-").isdigit()] if folder.is_dir() else []  # fmt: skip
    return f"recording-{max(numbers, default=0) + 1}"
