"""Frames, and which channels go into which file. It makes no rays."""
