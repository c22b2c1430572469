"""Shapes, objects, and what is built from them. It knows no sensors."""
