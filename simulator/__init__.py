"""From a scene to a recording with exact truth."""
