"""The looks of things: materials, lights, environments, shading. It knows no objects."""
