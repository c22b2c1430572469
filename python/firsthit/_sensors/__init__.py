"""Sensors, which make rays: cameras, scanners, and files of them. It knows no hits."""
