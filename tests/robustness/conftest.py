"""What the tests of this folder share."""

import pytest
from jaxtyping import config


@pytest.fixture
def _without_type_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    """The checker looks into sequences at random, hence reads frames before anyone asks for them."""
    monkeypatch.setattr(config, "jaxtyping_disable", True)
