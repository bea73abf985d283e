"""The viewer: a server, a session, the scene and the panels, and the thread in which all of it happens."""

import asyncio
from contextlib import suppress
from typing import Any

from recording.cache import Cache
from recording.motions import Motions
from recording.recording import Recording
from viewer.keeping import CorrectionsFile
from viewer.panels.catalogue import PANELS, first_panel
from viewer.panels.desk import Desk
from viewer.scene import Scene
from viewer.server import opened_server
from viewer.session import Session


class Viewer:
    """A recording in a browser; `run` serves it until it is stopped."""

    def __init__(
        self,
        recording: Recording,
        motions: Motions | None = None,
        *,
        host: str = "127.0.0.1",
        port: int = 8080,
        cache: Cache | None = None,
        file: CorrectionsFile | None = None,
    ) -> None:
        self.server = opened_server(host=host, port=port, label=recording.metadata.name or "unocclude")
        self._clock = asyncio.new_event_loop()
        self._clock.set_exception_handler(self._fail)
        self._failure: BaseException | None = None
        self.session = Session(recording, motions, clock=self._clock, cache=cache, file=file)
        self.scene = Scene(self.server, self.session)
        desk = Desk(gui=self.server.gui, session=self.session, scene=self.scene)
        first_panel(desk)
        tabs = self.server.gui.add_tab_group()
        for name, panel in PANELS.items():
            with tabs.add_tab(name):
                panel(desk)
        self._clock.call_soon(self.session.begin)

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        host = self.server.get_host()
        shown = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(host, host)
        return f"http://{shown}:{self.server.get_port()}"

    def run(self) -> None:
        """Serve until `stop`, or until the program is interrupted, which is how a viewer usually ends."""
        with suppress(KeyboardInterrupt):
            self._clock.run_forever()
        self.server.stop()
        self._clock.close()
        if self._failure is not None:
            raise self._failure

    def stop(self) -> None:
        """End `run`; any thread may ask for it."""
        self._clock.call_soon_threadsafe(self._clock.stop)

    def _fail(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """A defect ends the viewer: nothing goes on half."""
        self._failure = context.get("exception") or RuntimeError(context["message"])
        loop.stop()
