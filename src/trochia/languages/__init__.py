"""Front ends that read part programs: each language is a folder with ``read`` (text in, canonical program out)."""
