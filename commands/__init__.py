"""The commands of `unocclude`, one file a group of them; unocclude.py gives them their names."""
