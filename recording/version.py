"""The version of the installed distribution, as every result carries it."""

from importlib.metadata import version

VERSION = version("unocclude")
