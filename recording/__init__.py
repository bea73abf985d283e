"""The contract between simulator, algorithm and evaluation: camera, frames, truth, motions, and their files."""
