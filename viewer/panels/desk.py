"""What every panel is made of and with."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from viser import GuiApi, GuiEvent, GuiInputHandle

from viewer.scene import Scene
from viewer.session import Session

Value = TypeVar("Value")


@dataclass(frozen=True, kw_only=True, eq=False)
class Desk:
    """The page's controls, and what they act on."""

    gui: GuiApi
    session: Session
    scene: Scene

    def when_set(self, handle: GuiInputHandle[Value], action: Callable[[Value], None]) -> None:
        """Do something with the value of a control whenever somebody sets it; what the program sets does not count."""

        def heard(event: GuiEvent[Any]) -> None:
            if event.client is not None:
                self.session.post(lambda: action(handle.value))

        handle.on_update(heard)

    def set(self, handle: GuiInputHandle[Value], value: Value) -> None:
        """Show another value."""
        handle.value = value  # type: ignore[misc]  # viser's setter does not stand next to its getter.

    def on_key(self, label: str, key: Any, action: Callable[[], None], *, modifier: Any = None) -> None:
        """Do something when a key is pressed, or when it is chosen in the list of commands (Ctrl-K)."""
        command = self.gui.add_command(label, hotkey=key, modifier=modifier)
        command.on_trigger(lambda _: self.session.post(action))


Panel = Callable[[Desk], None]
"""Makes its controls in the container that is open, and connects them."""
