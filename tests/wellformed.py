"""HTML that is to be well-formed: every tag is closed in its order, and nothing but the page's own tags is in it."""

from html.parser import HTMLParser

_EMPTY = {"img", "br"}


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.texts: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag not in _EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def read(page: str) -> tuple[set[str], list[str]]:
    """The tags in a piece of HTML, and its texts in their order."""
    reader = _Reader()
    reader.feed(page)
    reader.close()
    assert not reader.open
    return set(reader.tags), reader.texts
