"""Results as one self-contained page, and as a video."""
