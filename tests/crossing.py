"""A small scene that several tests look at: two people cross behind a wall."""

CROSSING = """
name = "small"
frames = 40
fps = 15
[camera]
width = 96
height = 72
position = [0, -5, 1.2]
look_at = [0, 0, 1]
horizontal_fov_deg = 60
[[people]]
body = "man"
waypoints = [[-2, 0.3], [2, 0.3]]
speed = 1.4
[[people]]
body = "woman"
waypoints = [[2, 1.4], [-2, 1.4]]
speed = 1.4
[[obstacles]]
shape = "box"
size = [0.8, 0.1, 2.0]
position = [0, -0.8, 0]
"""
