"""A recording and its motions in other tools' formats, one file a format."""
