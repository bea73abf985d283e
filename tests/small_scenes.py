"""Small scenes that tests simulate: people who walk past a camera, and boxes that hide them for a while."""


def small_scene(*things: str, frames: int, width: int = 64, away_m: float = 4.0) -> str:
    """A scene of that many frames with some things in it; the camera is so far from the middle, and looks along y."""
    return f"""
name = "small"
frames = {frames}
fps = 15
[camera]
width = {width}
height = {3 * width // 4}
position = [0, {-away_m}, 1.2]
look_at = [0, 0, 1]
horizontal_fov_deg = 60
""" + "".join(things)


def walker(*, begin_m: float, end_m: float, beyond_m: float = 0.0, speed: float = 1.4, body: str = "man") -> str:
    """Somebody who walks along x, so far beyond the middle."""
    waypoints = [[begin_m, beyond_m], [end_m, beyond_m]]
    return f'[[people]]\nbody = "{body}"\nwaypoints = {waypoints}\nspeed = {speed}\n'


def box(*, width_m: float, height_m: float, before_m: float) -> str:
    """A thin box on the ground, so far before the middle."""
    return f'[[obstacles]]\nshape = "box"\nsize = [{width_m}, 0.1, {height_m}]\nposition = [0, {-before_m}, 0]\n'


CROSSING = small_scene(
    walker(begin_m=-2, end_m=2, beyond_m=0.3),
    walker(begin_m=2, end_m=-2, beyond_m=1.4, body="woman"),
    box(width_m=0.8, height_m=2.0, before_m=0.8),
    frames=40,
    width=96,
    away_m=5,
)
"""Two people cross behind a wall."""
PASSING = small_scene(walker(begin_m=-1, end_m=1, speed=1.2), frames=12)
"""Somebody passes, and nothing hides him."""
