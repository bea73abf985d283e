"""Recordings from what others have: depth images, arrays, point clouds, bags. One file a format."""
