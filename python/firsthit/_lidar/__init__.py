"""Laser scanners, their scans, and files of these."""
