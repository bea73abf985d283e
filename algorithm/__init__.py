"""From a recording to motions: one file a step of the paper; `pipeline.py` is its Algorithm 1."""
