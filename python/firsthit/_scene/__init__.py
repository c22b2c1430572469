"""The class `Scene`, what changes it, and files that it comes from."""
