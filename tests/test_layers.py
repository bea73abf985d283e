"""The layers: `recording` knows nobody, `simulator` and `algorithm` only it; each later one knows those before it."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
MAY_IMPORT = {
    "recording": set(),
    "simulator": {"recording", "scenes"},
    "importing": {"recording"},
    "algorithm": {"recording"},
    "evaluation": {"recording", "simulator", "algorithm"},
    "exporting": {"recording"},
    "viewer": {"recording", "simulator", "algorithm", "evaluation"},
    "commands": {"recording", "simulator", "importing", "algorithm", "evaluation", "exporting", "viewer"},
}
LAYERS = {*MAY_IMPORT, "scenes", "unocclude"}


def imported_modules(path: Path) -> set[str]:
    """The full names of all modules that a file imports, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import hides the layer"
            found |= {str(node.module)} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


@pytest.mark.parametrize("layer", MAY_IMPORT)
def test_a_layer_imports_only_what_lies_below_it(layer: str) -> None:
    for path in (ROOT / layer).rglob("*.py"):
        others = {name.split(".")[0] for name in imported_modules(path)} & LAYERS - {layer}
        assert others <= MAY_IMPORT[layer], f"{path.relative_to(ROOT)} imports {sorted(others - MAY_IMPORT[layer])}"


def test_only_the_ray_caster_knows_mitsuba() -> None:
    knowing = {
        path.relative_to(ROOT).as_posix()
        for layer in MAY_IMPORT
        for path in (ROOT / layer).rglob("*.py")
        if {name.split(".")[0] for name in imported_modules(path)} & {"mitsuba", "drjit"}
    }
    assert knowing == {"simulator/raycast.py"}


def test_no_module_imports_itself_in_a_circle() -> None:
    modules = {
        path.relative_to(ROOT).with_suffix("").as_posix().replace("/", "."): path
        for layer in MAY_IMPORT
        for path in (ROOT / layer).rglob("*.py")
    }
    waiting = {name: imported_modules(path) & modules.keys() - {name} for name, path in modules.items()}
    while free := {name for name, needs in waiting.items() if not needs & waiting.keys()}:
        waiting = {name: needs for name, needs in waiting.items() if name not in free}
    assert not waiting, f"modules import each other in a circle: {sorted(waiting)}"
