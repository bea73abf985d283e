"""The interactive viewer: a recording and its motions in a browser, in three dimensions over time."""
