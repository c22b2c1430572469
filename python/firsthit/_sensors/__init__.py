"""What makes rays: cameras, and what other programs say of them. It knows no hits."""
