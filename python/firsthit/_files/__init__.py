"""Frames, and which channels go into which file. It knows no rays."""
