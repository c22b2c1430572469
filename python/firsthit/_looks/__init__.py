"""What things look like: materials, lights, environments, shading. It knows no objects."""
