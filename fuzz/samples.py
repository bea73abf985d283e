"""Valid files as text, which the tests of wrong inputs damage, too."""

SWEEP = """name = "few"
recordings = ["small"]
[axes]
eps3 = [1.0, 2.0]
eps4 = {from = 1, to = 9, steps = 3}
"""
BVH = """HIERARCHY
ROOT Hips
{
OFFSET 0 0 0
CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
End Site
{
OFFSET 0 10 0
}
}
MOTION
Frames: 2
Frame Time: 0.033
0 90 0 0 0 0
0 90 1 0 0 0
"""
