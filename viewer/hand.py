"""What a user says of segments and links by hand: each word of it is solved at once, and can be taken back."""

from typing import Literal

from recording.corrections import Anchor, Correction, CorrectionKind, Corrections
from recording.errors import InputError
from recording.motions import Link
from viewer.marks import mark_on
from viewer.session import Session


class Hand:
    """Makes corrections of what is marked in a session, and keeps them."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._before: list[Corrections] = []

    def say(self, kind: Literal["same", "different"]) -> None:
        """Both marked segments are of the same object, or of different ones."""
        one, other = self._session.marks.slots
        if one is None or other is None:
            self._session.say("mark two segments first")
            return
        self._add(Correction(kind=kind, one=one.anchor, other=other.anchor))

    def say_of(self, link: Link) -> None:
        """A link that was made is none, and one that was not is one."""
        answer = self._session.answer
        ends = [mark_on(answer.motions, end) if answer else None for end in (link.before, link.after)]
        one, other = (mark.anchor if mark is not None else None for mark in ends)
        if one is not None and other is not None:
            self._add(Correction(kind="forbid" if link.chosen else "force", one=one, other=other))

    def take_back(self, index: int) -> None:
        """Say one of the corrections no longer."""
        self._become(self._session.corrections.without(index))

    def clear(self) -> None:
        """Say none of them any longer."""
        self._become(self._session.corrections.model_copy(update={"correction": ()}))

    def undo(self) -> None:
        """Be where one was before the last change."""
        while self._before:
            before = self._before.pop()
            if before != self._session.corrections:  # A correction that was refused has changed nothing.
                self._session.correct(before)
                return

    def save(self) -> None:
        """Write them into their file, and tell where that is, or why not."""
        session = self._session
        if session.file is None:
            return
        try:
            session.file.save(session.corrections)
        except InputError as error:
            session.say(str(error))
        else:
            session.say(f"saved to {session.file.path}")
            session.corrections_changed()

    def _add(self, correction: Correction) -> None:
        if correction in self._session.corrections.correction:
            self._session.say("this has been said already")
            return
        self._become(self._session.corrections.plus(correction))

    def _become(self, corrections: Corrections) -> None:
        self._before.append(self._session.corrections)
        self._session.correct(corrections)


def described(correction: Correction) -> str:
    """A correction in few words, with the numbers that the segments had when they were marked."""
    one, other = _place(correction.one), _place(correction.other)
    if correction.kind in ("force", "forbid"):
        return f"{correction.kind} {one} \u2192 {other}"
    return f"{correction.kind}: {one}, {other}"


def verb(link: Link) -> CorrectionKind:
    """What can be said of a link."""
    return "forbid" if link.chosen else "force"


def _place(anchor: Anchor) -> str:
    at = f"frame {anchor.frame}"
    return at if anchor.segment is None else f"{anchor.segment} ({at})"
