"""Pictures and optical flow."""
