"""The panel of corrections: two segments are the same or not, a link is one or not; solved at once, kept in a file."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from viser import GuiButtonHandle, GuiDropdownHandle, GuiFolderHandle

from recording.motions import Link
from viewer.answer import Answer
from viewer.clock import Action
from viewer.hand import Hand, described, verb
from viewer.lines import links_of
from viewer.marks import mark_on, segment_frames
from viewer.panels.desk import Desk
from viewer.panels.solving import command_text, scores_table
from viewer.session import Session

_NONE = "none"
_SAME, _DIFFERENT = "the same object", "different"
_PICKS, _MARKS = "picks a motion", "marks a segment"
_MOST_LINKS = 12
"""Links that are listed, the surest first."""
_SLOTS = ("First", "Second")
_HELP = "Mark two segments by clicks on their points, or choose them here, and say what they are."


def corrections_panel(desk: Desk) -> None:
    """Marks and what is said of them, the picked motion's links, the corrections made, their file, and the scores."""
    hand = Hand(desk.session)
    _marking(desk, hand)
    _linking(desk, hand)
    _listing(desk, hand)
    _telling(desk, hand)


def _marking(desk: Desk, hand: Hand) -> None:
    gui, session = desk.gui, desk.session
    clicks = gui.add_dropdown("A click", (_PICKS, _MARKS), initial_value=_PICKS, hint="M: the other. " + _HELP)
    chosen = [gui.add_dropdown(slot, [_NONE], initial_value=_NONE, hint=_HELP) for slot in _SLOTS]
    hint = "Y: both are one object; N: they are not, which also parts one segment between two of its points"
    they_are = gui.add_button_group("They are", (_SAME, _DIFFERENT), visible=False, hint=hint)

    verdicts = {_SAME: partial(hand.say, "same"), _DIFFERENT: partial(hand.say, "different")}

    def marked() -> None:
        names = _names(session.answer)
        for dropdown, segment in zip(chosen, session.marks.segments, strict=True):
            _offer(desk, dropdown, [_NONE, *names.values()], _NONE if segment is None else names.get(segment, _NONE))
        they_are.visible = None not in session.marks.slots

    def switch() -> None:
        session.click_to("pick" if session.clicks == "mark" else "mark")

    desk.when_set(clicks, lambda words: session.click_to("mark" if words == _MARKS else "pick"))
    for slot, dropdown in enumerate(chosen):
        desk.when_set(dropdown, partial(_choose, session, slot))
    they_are.on_click(lambda event: session.post(verdicts[event.target.value]))
    session.clicks_changed.connect(lambda: desk.set(clicks, _MARKS if session.clicks == "mark" else _PICKS))
    session.marks.changed.connect(marked)
    session.answered.connect(marked)
    desk.on_key("Clicks mark segments, or pick motions", "M", switch)
    desk.on_key("Both marked segments are the same object", "Y", lambda: hand.say("same"))
    desk.on_key("The marked segments are different objects", "N", lambda: hand.say("different"))
    desk.on_key("Mark nothing any more", "escape", session.marks.clear, modifier="shift")
    marked()


def _choose(session: Session, slot: int, name: str) -> None:
    """Mark a segment by its name in the list, and go to where it is seen."""
    numbers = {words: segment for segment, words in _names(session.answer).items()}
    mark = mark_on(session.answer.motions, numbers[name]) if session.answer and name in numbers else None
    session.marks.put(slot, mark)
    if mark is not None:
        session.playback.go_to(mark.anchor.frame)


def _names(answer: Answer | None) -> dict[int, str]:
    """By segment how it is called in the lists."""
    found = segment_frames(answer.motions) if answer else {}
    return {segment: f"{segment}: frames {first} to {last}" for segment, (first, last) in found.items()}


def _offer(desk: Desk, dropdown: GuiDropdownHandle[str], names: list[str], chosen: str) -> None:
    if list(dropdown.options) != names:
        dropdown.options = names
    desk.set(dropdown, chosen)


def _linking(desk: Desk, hand: Hand) -> None:
    gui, session = desk.gui, desk.session
    folder = gui.add_folder("Links")
    buttons = _Buttons(desk, folder, "Pick a motion to see its candidate links.")

    def listed() -> None:
        answer, motion = session.answer, session.picked
        links = links_of(answer.motions, motion)[:_MOST_LINKS] if answer and motion is not None else []
        folder.label = f"Links of {answer.name(motion)}: {len(links)}" if answer and motion is not None else "Links"
        buttons.become([(_told(link), partial(hand.say_of, link)) for link in links])

    session.picked_changed.connect(listed)
    session.judged.connect(listed)  # Which names motions.
    listed()


def _told(link: Link) -> str:
    made = "made" if link.chosen else "not made"
    return f"{verb(link).capitalize()} {link.before} \u2192 {link.after} ({made}, {link.confidence:.2f})"


def _listing(desk: Desk, hand: Hand) -> None:
    gui, session = desk.gui, desk.session
    folder = gui.add_folder("Corrections")
    with folder:
        ways = gui.add_button_group("Take back", ("last change", "all"), hint="Z: the last change")
    buttons = _Buttons(desk, folder, "Nothing has been said yet.")

    def listed() -> None:
        made = session.corrections.correction
        folder.label = f"Corrections: {len(made)}"
        entries = [
            (f"\u2715 {index + 1}. {described(each)}", partial(hand.take_back, index))
            for index, each in enumerate(made)
        ]
        buttons.become(entries)

    ways.on_click(lambda event: session.post(hand.clear if event.target.value == "all" else hand.undo))
    session.corrections_changed.connect(listed)
    desk.on_key("Take the last change of corrections back", "Z", hand.undo)
    listed()


class _Buttons:
    """Buttons in a folder that become others; words stand there while there are none."""

    def __init__(self, desk: Desk, folder: GuiFolderHandle, otherwise: str) -> None:
        self._desk, self._folder = desk, folder
        self._labels: list[str] = []
        self._buttons: list[GuiButtonHandle] = []
        with folder:
            self._words = desk.gui.add_markdown(f"*{otherwise}*")

    def become(self, entries: Sequence[tuple[str, Action]]) -> None:
        """Other buttons, by label with what they do; alike labels do alike."""
        labels = [label for label, _ in entries]
        self._words.visible = not entries
        if labels == self._labels:
            return
        for button in self._buttons:
            button.remove()
        with self._folder:
            self._buttons = [self._desk.gui.add_button(label, color="gray") for label in labels]
        for button, (_, action) in zip(self._buttons, entries, strict=True):
            button.on_click(partial(self._press, action))
        self._labels = labels

    def _press(self, action: Action, _: Any) -> None:
        self._desk.session.post(action)


def _telling(desk: Desk, hand: Hand) -> None:
    gui, session = desk.gui, desk.session
    status = gui.add_markdown("")
    save = gui.add_button("Save", disabled=session.file is None, hint="Replaces nothing that somebody else wrote")
    place = gui.add_markdown("")
    table = gui.add_markdown("")

    def told() -> None:
        status.content = f"*{session.status}*" if session.status else ""

    def scored() -> None:
        table.content = scores_table(session.opened, session.answer) + command_text(session)

    def kept() -> None:
        place.content = file_text(session)
        scored()

    save.on_click(lambda _: session.post(hand.save))
    session.status_changed.connect(told)
    session.corrections_changed.connect(kept)
    for signal in (session.judged, session.settings_changed):
        signal.connect(scored)
    told()
    kept()


def file_text(session: Session) -> str:
    """Where the corrections are kept, and whether they are, as Markdown."""
    if session.file is None:
        return "No file to keep them in: this recording has no folder."
    kept = session.file.known.correction if session.file.known is not None else ()
    state = "**not saved yet**" if kept != session.corrections.correction else "saved" if kept else "nothing to save"
    return f"`{session.file.path}`: {state}"
