"""Rays to answers: hits, distances, sections, findings. It knows no pictures."""
