"""The viewer, in the browser and in notebooks."""
