"""The name of a body as scenes write it."""

from typing import Annotated

from pydantic import AfterValidator

from recording.checks import nearest_name
from simulator.body import body_names


def _known(body: str) -> str:
    if body not in body_names():
        raise ValueError(f"expected a body's name, {nearest_name(body, body_names())}")
    return body


BodyName = Annotated[str, AfterValidator(_known)]
"""The name of a body in `scenes/assets`; another one is an error that names the nearest."""
