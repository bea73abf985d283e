"""From a recording and motions to numbers and pictures."""
