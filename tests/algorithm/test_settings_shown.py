"""Settings show in a notebook what was changed, and what each of them means."""

from wellformed import read

from algorithm.settings import Settings, preset_settings


def test_what_differs_from_the_preset_comes_first() -> None:
    assert "eps3 = 4.0" in read(Settings(eps3=4)._repr_html_())[1]
    for name in ("default", "paper"):
        texts = read(preset_settings(name)._repr_html_())[1]
        assert texts[1:4] == [name, "changed", "nothing"]


def test_every_setting_is_there_with_its_value_and_its_meaning() -> None:
    texts = read(Settings()._repr_html_())[1]
    for name, field in Settings.model_fields.items():
        place = texts.index(name) if name != "preset" else len(texts) - 1 - texts[::-1].index(name)
        assert texts[place + 1 : place + 3] == [str(getattr(Settings(), name)), field.description]
